//! Orders in which a sweep visits the contacts.

use contact::{Mechanics, Packing, Touch, greedy_colours};
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
    pub fn of<M: Mechanics>(self, problem: &Packing<M>, seed: u64) -> Vec<u32> {
        let mut order: Vec<u32> = (0..problem.contact_count() as u32).collect();
        match self {
            Self::Natural => {}
            Self::BottomUp => {
                let height =
                    |contact: &u32| problem.contact_position(&problem.contacts()[*contact as usize])[1];
                order.sort_by(|a, b| height(a).total_cmp(&height(b)));
            }
            Self::Shuffled => order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed)),
            Self::Coloured => {
                let contacts = problem.contacts().iter().map(Touch::grains);
                let colour = greedy_colours(contacts, problem.grain_count());
                order.sort_by_key(|contact| colour[*contact as usize]);
            }
        }
        order
    }
}
