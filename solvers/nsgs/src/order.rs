//! Orders in which a sweep visits the contacts.

use contact::{ContactProblem, Packing};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Order in which a sweep visits the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// That of the problem's list.
    Natural,
    /// By rising height of the contact; among equals, that of the list.
    BottomUp,
    /// Shuffled once by the seed, then kept.
    Shuffled,
    /// Colour by colour; contacts of one colour share no grain, so a colour could be solved all at once.
    Coloured,
}

impl Order {
    /// The contacts of `problem` in this order.
    pub fn of(self, problem: &Packing, seed: u64) -> Vec<u32> {
        let mut order: Vec<u32> = (0..problem.contact_count() as u32).collect();
        match self {
            Self::Natural => {}
            Self::BottomUp => {
                let height =
                    |contact: &u32| problem.contact_position(&problem.contacts()[*contact as usize]).y;
                order.sort_by(|a, b| height(a).total_cmp(&height(b)));
            }
            Self::Shuffled => order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed)),
            Self::Coloured => {
                let colour = colours(problem);
                order.sort_by_key(|contact| colour[*contact as usize]);
            }
        }
        order
    }
}

/// Greedy colouring: each contact, in the order of the list, takes the least colour that its grains do not have yet.
pub fn colours(problem: &ContactProblem) -> Vec<u32> {
    // Colours already at each grain, 64 to a word.
    let mut taken: Vec<Vec<u64>> = vec![Vec::new(); problem.grain_count()];
    problem
        .contacts()
        .iter()
        .map(|contact| {
            let grains = contact.grains();
            let words = |grain: u32, word: usize| taken[grain as usize].get(word).copied().unwrap_or(0);
            let both = |word: usize| grains.clone().fold(0, |all, grain| all | words(grain, word));
            let mut word = 0;
            while both(word) == u64::MAX {
                word += 1;
            }
            let bit = both(word).trailing_ones();
            for grain in grains {
                let grain = &mut taken[grain as usize];
                grain.resize(grain.len().max(word + 1), 0);
                grain[word] |= 1 << bit;
            }
            64 * word as u32 + bit
        })
        .collect()
}
