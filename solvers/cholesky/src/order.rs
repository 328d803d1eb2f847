//! Orders of the grains in which a factor stays sparse.

use contact::{Groups, Place, SetupError};

/// An order of grains.
#[derive(Clone, Debug)]
pub struct Order {
    /// The place of each grain.
    place: Vec<u32>,
}

/// Grains that are no longer parted.
const FEW: usize = 6;

/// Grains up to which a minimum degree order is the better one (–). On deposited boxes of 1e4 / 1e5 / 1e6 discs a factorisation
/// takes 2.3e7 / 1.29e9 / 5.6e10 multiply-adds in it, in a nested dissection 3.5e7 / 1.25e9 / 4.2e10, which is found faster.
const MANY: usize = 50_000;

impl Order {
    /// An order for a factor with few entries, of grains at these positions (m); `ends` gives candidate and antagonist of each
    /// contact, `None` for a wall.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn fill_reducing<P: Place>(position: &[P], ends: &[(u32, Option<u32>)]) -> Result<Self, SetupError> {
        if position.len() <= MANY {
            Self::minimum_degree(position.len(), ends)
        } else {
            Ok(Self::nested_dissection(position, ends))
        }
    }

    /// An approximate minimum degree order of so many `grains`.
    ///
    /// P. R. Amestoy, T. A. Davis, I. S. Duff, An approximate minimum degree ordering algorithm, SIAM J. Matrix Anal. Appl. 17
    /// (1996) 886-905.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn minimum_degree(grains: usize, ends: &[(u32, Option<u32>)]) -> Result<Self, SetupError> {
        // The lower half with its diagonal, each entry once.
        let pairs = ends.iter().filter_map(|(i, j)| Some((*i, (*j)?)));
        let mut entries: Vec<(u32, u32)> = pairs.map(|(i, j)| (i.max(j), i.min(j))).collect();
        entries.extend((0..grains as u32).map(|grain| (grain, grain)));
        entries.sort_unstable();
        entries.dedup();
        let first: Vec<_> =
            (0..=grains).map(|row| entries.partition_point(|at| (at.0 as usize) < row)).collect();
        let others: Vec<_> = entries.iter().map(|(_, column)| *column as usize).collect();
        let (_, place, _) = amd::order(grains, &first, &others, &amd::Control::default()).map_err(|why| {
            SetupError::new("problem", format!("{why:?}"), "one whose grains can be ordered")
        })?;
        let place = place.into_iter().map(|place| place as u32).collect();
        Ok(Self { place })
    }

    /// Nested dissection by the positions of the grains (m): a set of grains is cut at the median of the longest extent; the
    /// grains of one side that touch the other are the last, and each side is cut likewise.
    ///
    /// A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973) 345-363.
    pub fn nested_dissection<P: Place>(position: &[P], ends: &[(u32, Option<u32>)]) -> Self {
        let pairs = ends.iter().filter_map(|(i, j)| Some((*i, (*j)?)));
        let both = pairs.flat_map(|(i, j)| [(i, j as usize), (j, i as usize)]);
        let neighbours = Groups::new(both, position.len());
        let mut grains: Vec<u32> = (0..position.len() as u32).collect();
        let mut side = vec![0_u32; position.len()];
        let mut dissection = Dissection { position, neighbours: &neighbours, side: &mut side, cuts: 0 };
        dissection.order(&mut grains);
        let mut place = vec![0; position.len()];
        for (new, grain) in (0_u32..).zip(&grains) {
            place[*grain as usize] = new;
        }
        Self { place }
    }

    /// The place of each grain.
    pub fn places(&self) -> &[u32] {
        &self.place
    }
}

struct Dissection<'a, P> {
    position: &'a [P],
    neighbours: &'a Groups,
    /// The cut that last gave each grain a side, which are two numbers each.
    side: &'a mut [u32],
    cuts: u32,
}

impl<P: Place> Dissection<'_, P> {
    fn order(&mut self, grains: &mut [u32]) {
        if grains.len() <= FEW {
            return;
        }
        let position = self.position;
        let [least, greatest] = P::extent(grains.iter().map(|grain| position[*grain as usize]));
        // Of extents as long, the first.
        let longer = |axis: usize, other: usize| {
            let extent = |axis: usize| greatest[axis] - least[axis];
            if extent(other) > extent(axis) { other } else { axis }
        };
        let axis = (1..P::LEN).fold(0, longer);
        let half = grains.len() / 2;
        grains.select_nth_unstable_by(half, |i, j| {
            position[*i as usize][axis].total_cmp(&position[*j as usize][axis]).then(i.cmp(j))
        });
        self.cuts += 1;
        let [low_side, high_side] = [2 * self.cuts, 2 * self.cuts + 1];
        grains[..half].iter().for_each(|grain| self.side[*grain as usize] = low_side);
        grains[half..].iter().for_each(|grain| self.side[*grain as usize] = high_side);
        let touches = |grain: u32, side: u32| {
            let grain = grain as usize;
            self.neighbours.of(grain..grain + 1).iter().any(|other| self.side[*other as usize] == side)
        };
        let (inside_low, low): (Vec<u32>, Vec<u32>) =
            grains[..half].iter().partition(|grain| !touches(**grain, high_side));
        let (inside_high, high): (Vec<u32>, Vec<u32>) =
            grains[half..].iter().partition(|grain| !touches(**grain, low_side));
        let (first, second, between) = if low.len() <= high.len() {
            (inside_low, [inside_high, high].concat(), low)
        } else {
            ([inside_low, low].concat(), inside_high, high)
        };
        let (firsts, rest) = grains.split_at_mut(first.len());
        let (seconds, last) = rest.split_at_mut(second.len());
        firsts.copy_from_slice(&first);
        seconds.copy_from_slice(&second);
        last.copy_from_slice(&between);
        self.order(firsts);
        self.order(seconds);
    }
}
