//! Initial impulses of a time step (§5): those of the time steps before, or none.

use super::March;
use crate::detect::Side;
use crate::problem::marched::{Marched, recalled};
use crate::problem::time_step::TimeStep;
use contact::Vector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Initial impulses of a time step. In files `false` and `true` are `nothing` and `previous`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub enum Start {
    /// No impulses.
    #[default]
    Nothing,
    /// The impulses r⁻ of the time step before.
    Previous,
    /// 2 r⁻ − r⁻⁻, what the last two time steps promise if impulses grow linearly, clipped into the cone of each contact; r⁻ at a
    /// contact that is younger.
    Extrapolated,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected true, false, \"nothing\", \"previous\" or \"extrapolated\"")]
enum Written {
    Warm(bool),
    Named(Name),
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Name {
    Nothing,
    Previous,
    Extrapolated,
}

impl From<Written> for Start {
    fn from(written: Written) -> Self {
        match written {
            Written::Warm(false) | Written::Named(Name::Nothing) => Self::Nothing,
            Written::Warm(true) | Written::Named(Name::Previous) => Self::Previous,
            Written::Named(Name::Extrapolated) => Self::Extrapolated,
        }
    }
}

impl From<Start> for Written {
    fn from(start: Start) -> Self {
        match start {
            Start::Nothing => Self::Warm(false),
            Start::Previous => Self::Warm(true),
            Start::Extrapolated => Self::Named(Name::Extrapolated),
        }
    }
}

impl Start {
    /// Reports whether it uses impulses of the time steps before.
    pub fn is_warm(self) -> bool {
        self != Self::Nothing
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Previous => "previous",
            Self::Extrapolated => "extrapolated",
        }
    }
}

impl<M: Marched> March<M> {
    /// The impulses from which the time step that [`March::next`] gave begins (N·s).
    pub fn start(&self, next: &TimeStep<M>, start: Start) -> Vec<f64> {
        if start != Start::Extrapolated {
            return next.frozen.start(start.is_warm());
        }
        let mut before = self.before.iter().peekable();
        let promised = self.last.iter().map(|(key, r)| {
            while before.next_if(|(known, _)| known < key).is_some() {}
            let known = before.next_if(|(known, _)| known == key);
            (*key, known.map_or(*r, |(_, older)| *r + (*r - *older)))
        });
        recall::<M>(&promised.collect::<Vec<_>>(), next.keys(), next.frozen.problem.contacts())
    }
}

/// The impulses of the contacts `keys` in a list of `last` ones, as the contacts admit them, 0 for a new one. Both lists rise.
pub(super) fn recall<M: Marched>(
    last: &[((u32, Side), M::Impulse)],
    keys: impl Iterator<Item = (u32, Side)>,
    contacts: &[M::Contact],
) -> Vec<f64> {
    let mut last = last.iter().peekable();
    let mut start = vec![0.0; M::Impulse::LEN * contacts.len()];
    for (k, key) in keys.enumerate() {
        while last.next_if(|(known, _)| *known < key).is_some() {}
        if let Some((_, r)) = last.next_if(|(known, _)| *known == key) {
            recalled::<M>(&contacts[k], *r).put(&mut start, k);
        }
    }
    start
}

#[cfg(test)]
mod tests;
