//! What a time step is started from (§5): the impulses of the time steps before, or none.

use super::March;
use crate::detect::Side;
use crate::problem::marched::Marched;
use crate::problem::time_step::TimeStep;
use contact::Vector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a time step is started from. In files `false` and `true` are `nothing` and `previous`.
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
    /// Whether it takes anything from the time steps before.
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
            M::recalled(&contacts[k], *r).put(&mut start, k);
        }
    }
    start
}

#[cfg(test)]
mod tests {
    use super::Start;
    use crate::{Case, March};
    use cg::{Cg, Preconditioner};
    use contact::{Discs, Measure};
    use runner::Stop;
    use std::path::Path;

    const TIGHT: Stop = Stop { on: Measure::NaturalMap, tolerance: 1e-13, max_iterations: 1000 };
    const LOOSE: Stop = Stop { tolerance: 1e-10, ..TIGHT };

    /// A column at rest after two time steps under each `gravity`, before one under the third: its impulses (N·s) are as gravity is.
    fn column(gravity: [f64; 3]) -> March {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("column.toml");
        let mut march = March::<Discs>::new(&Case::read(&path, &[]).unwrap()).unwrap();
        for g in &gravity[..2] {
            march.scene.gravity_m_per_s2 = *g;
            march.time_step(&solver(), &TIGHT).unwrap();
        }
        march.scene.gravity_m_per_s2 = gravity[2];
        march
    }

    fn solver() -> Cg {
        Cg { preconditioner: Preconditioner::Diagonal }
    }

    #[test]
    fn impulses_that_grow_linearly_are_known_before_any_iteration() {
        let iterations = |start| {
            let mut march = column([2.0, 5.0, 8.0]);
            let next = march.next().unwrap();
            march.solve(&next, &solver(), &LOOSE, start, &|| false).unwrap().0.iterations
        };
        assert_eq!(iterations(Start::Extrapolated), 0);
        assert!(iterations(Start::Previous) > 0 && iterations(Start::Nothing) > 0);
    }

    #[test]
    fn contacts_that_would_pull_begin_from_nothing_and_young_ones_from_what_they_have() {
        let march = column([8.0, 2.0, 2.0]);
        let next = march.next().unwrap();
        assert!(march.start(&next, Start::Extrapolated).iter().all(|r| *r == 0.0));
        let mut young = march.clone();
        young.before.truncate(5);
        let [start, previous] = [Start::Extrapolated, Start::Previous].map(|start| young.start(&next, start));
        assert!(previous.iter().all(|r| *r > 0.0));
        assert_eq!((&start[..5], &start[5..]), (&[0.0; 5][..], &previous[5..]));
    }

    #[test]
    fn starts_are_read_as_truth_values_and_as_names_and_written_as_before() {
        let read = |text: &str| serde_json::from_str::<Start>(text);
        for (text, start, written) in [
            ("true", Start::Previous, "true"),
            ("\"previous\"", Start::Previous, "true"),
            ("\"nothing\"", Start::Nothing, "false"),
            ("\"extrapolated\"", Start::Extrapolated, "\"extrapolated\""),
        ] {
            assert_eq!(read(text).unwrap(), start);
            assert_eq!(serde_json::to_string(&start).unwrap(), written);
        }
        let error = read("\"warm\"").unwrap_err().to_string();
        assert!(error.contains("\"extrapolated\""), "{error}");
    }
}
