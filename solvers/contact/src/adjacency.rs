//! Which contacts touch a grain, and colours of what shares none.

use crate::problem::{Contact, ContactProblem};

/// The contacts around each grain, in rising order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    /// Grain i has the contacts `contacts[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    contacts: Vec<u32>,
}

impl Adjacency {
    /// Of the contacts of `problem`.
    pub fn of(problem: &ContactProblem) -> Self {
        Self::new(problem.contacts().iter().map(Contact::ends), problem.grain_count())
    }

    /// From the `ends` of each contact, candidate and antagonist, `None` for a wall; there are so many `grains`.
    pub fn new(ends: impl Iterator<Item = (u32, Option<u32>)> + Clone, grains: usize) -> Self {
        let mut first = vec![0; grains + 1];
        touches(ends.clone()).for_each(|(_, grain)| first[grain + 1] += 1);
        for grain in 0..grains {
            first[grain + 1] += first[grain];
        }
        let mut next = first.clone();
        let mut contacts = vec![0; first[grains] as usize];
        for (contact, grain) in touches(ends) {
            contacts[next[grain] as usize] = contact;
            next[grain] += 1;
        }
        Self { first, contacts }
    }

    /// The contacts around a grain.
    #[inline]
    pub fn around(&self, grain: usize) -> &[u32] {
        &self.contacts[self.first[grain] as usize..self.first[grain + 1] as usize]
    }

    /// Number of grains.
    pub fn grain_count(&self) -> usize {
        self.first.len() - 1
    }
}

/// Every contact with each of its grains.
fn touches(ends: impl Iterator<Item = (u32, Option<u32>)>) -> impl Iterator<Item = (u32, usize)> {
    let ends = (0_u32..).zip(ends);
    ends.flat_map(|(contact, (i, j))| std::iter::once(i).chain(j).map(move |i| (contact, i as usize)))
}

/// Greedy colouring: each of the `items`, in their order, takes the least colour that none before it with a common grain has.
/// An item gives the grains that it has, of so many `grains` in all.
pub fn greedy_colours<I>(items: impl Iterator<Item = I>, grains: usize) -> Vec<u32>
where
    I: Iterator<Item = u32> + Clone,
{
    // Colours already at each grain, 64 to a word.
    let mut taken: Vec<Vec<u64>> = vec![Vec::new(); grains];
    let colour_of = |own: I| {
        let words = |grain: u32, word: usize| taken[grain as usize].get(word).copied().unwrap_or(0);
        let at_any = |word: usize| own.clone().fold(0, |all, grain| all | words(grain, word));
        let mut word = 0;
        while at_any(word) == u64::MAX {
            word += 1;
        }
        let bit = at_any(word).trailing_ones();
        for grain in own {
            let grain = &mut taken[grain as usize];
            grain.resize(grain.len().max(word + 1), 0);
            grain[word] |= 1 << bit;
        }
        64 * word as u32 + bit
    };
    items.map(colour_of).collect()
}

#[cfg(test)]
mod tests;
