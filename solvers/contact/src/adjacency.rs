//! Lists of the members of groups: the contacts that touch each grain; colours of contacts that share no grain; and their levels, for the order
//! of a sweep.

use std::ops::Range;

/// The members of each of some groups, by rising index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Groups {
    /// Group g has the members `members[first[g]..first[g + 1]]`.
    first: Vec<u32>,
    members: Vec<u32>,
}

impl Groups {
    /// From each member and its group, by rising member; there are so many `groups`.
    pub fn new(memberships: impl Iterator<Item = (u32, usize)> + Clone, groups: usize) -> Self {
        let mut first = vec![0; groups + 1];
        memberships.clone().for_each(|(_, group)| first[group + 1] += 1);
        for group in 0..groups {
            first[group + 1] += first[group];
        }
        let mut next = first.clone();
        let mut members = vec![0; first[groups] as usize];
        for (member, group) in memberships {
            members[next[group] as usize] = member;
            next[group] += 1;
        }
        Self { first, members }
    }

    /// The members of some groups, one group after the other.
    #[inline]
    pub fn of(&self, groups: Range<usize>) -> &[u32] {
        &self.members[self.first[groups.start] as usize..self.first[groups.end] as usize]
    }
}

/// The contacts around each grain, in rising order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency(Groups);

impl Adjacency {
    /// From the `ends` of each contact, candidate and antagonist, `None` for a wall; there are so many `grains`.
    pub fn new(ends: impl Iterator<Item = (u32, Option<u32>)> + Clone, grains: usize) -> Self {
        let touches = (0_u32..).zip(ends).flat_map(|(contact, (i, j))| {
            std::iter::once(i).chain(j).map(move |grain| (contact, grain as usize))
        });
        Self(Groups::new(touches, grains))
    }

    /// The contacts around a grain.
    #[inline]
    pub fn around(&self, grain: usize) -> &[u32] {
        self.0.of(grain..grain + 1)
    }

    /// Number of grains.
    pub fn grain_count(&self) -> usize {
        self.0.first.len() - 1
    }
}

/// Greedy colouring: each of the `items`, in their order, takes the least colour that none before it with a common grain has.
/// An item gives the grains that it has, of so many `grains` in all.
pub fn greedy_colours<I>(items: impl Iterator<Item = I>, grains: usize) -> Vec<u32>
where
    I: Iterator<Item = u32> + Clone,
{
    // Whether each colour is taken at each grain.
    let mut taken: Vec<Vec<bool>> = vec![Vec::new(); grains];
    let colour_of = |own: I| {
        let is_taken = |colour: usize| {
            own.clone().any(|grain| taken[grain as usize].get(colour).is_some_and(|taken| *taken))
        };
        let mut colour = 0;
        while is_taken(colour) {
            colour += 1;
        }
        for grain in own {
            let taken = &mut taken[grain as usize];
            taken.resize(taken.len().max(colour + 1), false);
            taken[colour] = true;
        }
        colour as u32
    };
    items.map(colour_of).collect()
}

/// Contacts that are put in levels together: their columns and grains fit into the nearest caches, so that a grain is
/// still there when its next contact comes.
const WINDOW: usize = 1024;

/// The order in which a sweep is fast and gives the bits that it gives in the order of the list: level by level, window after
/// window of the list.
///
/// The level of a contact is one above the greatest of those before it with which it shares a grain, and above those of all
/// windows before. So contacts that share a grain keep their order; those of one level share none, and none waits for another.
pub fn by_levels(ends: impl Iterator<Item = (u32, Option<u32>)>, places: usize) -> Vec<u32> {
    let mut reached = vec![0_u32; places];
    let (mut greatest, mut below) = (0, 0);
    let level: Vec<u32> = ends
        .enumerate()
        .map(|(k, (i, j))| {
            if k % WINDOW == 0 {
                below = greatest;
            }
            let (i, j) = (i as usize, j.unwrap_or(i) as usize);
            let level = reached[i].max(reached[j]).max(below) + 1;
            (reached[i], reached[j]) = (level, level);
            greatest = greatest.max(level);
            level
        })
        .collect();
    let mut order: Vec<u32> = (0..level.len() as u32).collect();
    order.sort_by_key(|contact| level[*contact as usize]);
    order
}

#[cfg(test)]
mod tests;
