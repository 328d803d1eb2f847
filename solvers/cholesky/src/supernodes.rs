//! The elimination tree of some pairs of places, and the supernodes that follow from it.
//!
//! J. W. H. Liu, The role of elimination trees in sparse factorization, SIAM J. Matrix Anal. Appl. 11 (1990) 134-172.

use contact::Groups;
use std::ops::Range;

/// A supernode as it grows: its own places, and the rows below.
pub(crate) struct Growing {
    pub(crate) own: Range<u32>,
    pub(crate) rows: Vec<u32>,
}

/// Zeros, as a share of a merged supernode's entries, that are worth fewer and larger supernodes, for those up to so many
/// own grains.
const WORTH_MERGING: [(u32, f64); 3] = [(2, 0.4), (8, 0.2), (24, 0.1)];

/// No place.
const NONE: u32 = u32::MAX;

impl Growing {
    /// The front's index of a place.
    pub(crate) fn index(&self, place: u32) -> u32 {
        if place < self.own.end {
            place - self.own.start
        } else {
            self.own.len() as u32 + self.rows.partition_point(|row| *row < place) as u32
        }
    }
}

/// Pairs of places that are coupled, the lower first, as often as they do.
pub(crate) fn pairs(ends: &[(u32, Option<u32>)], places: &[u32]) -> impl Iterator<Item = (u32, u32)> + Clone {
    let of = |(i, j): &(u32, Option<u32>)| Some((places[*i as usize], places[(*j)? as usize]));
    ends.iter().filter_map(of).map(|(i, j)| (i.min(j), i.max(j)))
}

/// The parent of each place in the elimination tree: the first above it in its column of the factor.
pub(crate) fn elimination_tree(pairs: impl Iterator<Item = (u32, u32)> + Clone, places: usize) -> Vec<u32> {
    let below = Groups::new(pairs.map(|(low, high)| (low, high as usize)), places);
    let (mut parent, mut ancestor) = (vec![NONE; places], vec![NONE; places]);
    for place in 0..places {
        for low in below.of(place..place + 1) {
            let mut at = *low as usize;
            while at != place {
                let next = std::mem::replace(&mut ancestor[at], place as u32);
                if next == NONE {
                    parent[at] = place as u32;
                    break;
                }
                at = next as usize;
            }
        }
    }
    parent
}

/// The place of each place when each comes right after its subtree.
pub(crate) fn postorder(parent: &[u32]) -> Vec<u32> {
    let places = parent.len();
    let (mut eldest, mut next, mut roots) = (vec![NONE; places], vec![NONE; places], NONE);
    for place in (0..places as u32).rev() {
        let list = match parent[place as usize] {
            NONE => &mut roots,
            parent => &mut eldest[parent as usize],
        };
        next[place as usize] = std::mem::replace(list, place);
    }
    let mut order = vec![NONE; places];
    let (mut at, mut count) = (roots, 0);
    while at != NONE {
        // Down to the first that has no child left, then to its brother or back up.
        while eldest[at as usize] != NONE {
            at = std::mem::replace(&mut eldest[at as usize], NONE);
        }
        order[at as usize] = count;
        count += 1;
        at = match next[at as usize] {
            NONE => parent[at as usize],
            brother => brother,
        };
    }
    order
}

/// The supernodes without any zero, by rising places, which are in postorder.
pub(crate) fn fundamental(pairs: impl Iterator<Item = (u32, u32)> + Clone, places: usize) -> Vec<Growing> {
    let above = Groups::new(pairs.map(|(low, high)| (high, low as usize)), places);
    let mut supernodes: Vec<Growing> = Vec::new();
    // The supernodes whose next row is not yet reached, the last on top; and who was last seen in which column.
    let mut waiting: Vec<usize> = Vec::new();
    let (mut seen, mut rows) = (vec![NONE; places], Vec::new());
    for place in 0..places as u32 {
        rows.clear();
        let mut take = |row: u32| {
            if row != place && std::mem::replace(&mut seen[row as usize], place) != place {
                rows.push(row);
            }
        };
        let at = place as usize;
        above.of(at..at + 1).iter().for_each(|row| take(*row));
        let (mut children, mut greatest) = (0, 0);
        while let Some(child) = waiting.pop_if(|child| supernodes[*child].rows.first() == Some(&place)) {
            supernodes[child].rows.iter().for_each(|row| take(*row));
            children += 1;
            greatest = greatest.max(supernodes[child].rows.len());
        }
        match supernodes.last_mut() {
            // The one before is the only child, and has no other rows: it goes on.
            Some(last) if children == 1 && greatest == rows.len() + 1 => {
                last.own.end = place + 1;
                last.rows.remove(0);
            }
            _ => {
                rows.sort_unstable();
                supernodes.push(Growing { own: place..place + 1, rows: rows.clone() });
            }
        }
        waiting.push(supernodes.len() - 1);
    }
    supernodes
}

/// Larger supernodes with some zeros in them: a child that comes right before its parent is joined to it where that is worth
/// it.
pub(crate) fn merged(supernodes: Vec<Growing>) -> Vec<Growing> {
    let mut merged: Vec<Growing> = Vec::with_capacity(supernodes.len());
    let mut zeros: Vec<u64> = Vec::with_capacity(supernodes.len());
    for mut node in supernodes {
        let mut own_zeros = 0;
        while let Some(child) = merged.last()
            && child.rows.first().is_some_and(|row| node.own.contains(row))
        {
            let size = |own: usize, rows: usize| (own * (own + 1) / 2 + own * rows) as u64;
            let (child_own, own) = (child.own.len(), child.own.len() + node.own.len());
            let entries = size(own, node.rows.len());
            let all_zeros = own_zeros + zeros.last().copied().unwrap_or(0) + entries
                - size(child_own, child.rows.len())
                - size(node.own.len(), node.rows.len());
            let allowed = WORTH_MERGING.iter().find(|(most, _)| own as u32 <= *most);
            if !allowed.is_some_and(|(_, share)| all_zeros as f64 <= share * entries as f64) && all_zeros > 0
            {
                break;
            }
            node.own.start = child.own.start;
            own_zeros = all_zeros;
            merged.pop();
            zeros.pop();
        }
        merged.push(node);
        zeros.push(own_zeros);
    }
    merged
}
