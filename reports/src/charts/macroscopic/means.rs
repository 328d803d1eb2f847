//! Means over packings at each tolerance.

use polars::df;
use polars::prelude::DataFrame;

use super::{KEY, Sheared};
use crate::read::{Mean, OF_95, find_or_push};
use crate::text::{Part, frame};

/// The packings with a μ, by a method, at a tolerance.
struct Group<'s> {
    method: String,
    /// μ of the grains (–).
    grains: f64,
    tolerance: f64,
    /// Packings that met the tolerance in every time step, and the number of those that did not.
    solved: Vec<&'s Sheared<'s>>,
    missed: u64,
}

impl Group<'_> {
    fn mean(&self, value: fn(&Sheared) -> f64) -> Option<Mean> {
        Mean::of(&self.solved.iter().map(|s| value(s)).collect::<Vec<_>>(), OF_95)
    }
}

fn groups<'s>(sheared: &'s [Sheared<'s>]) -> Vec<Group<'s>> {
    let mut groups: Vec<Group> = Vec::new();
    for s in sheared {
        let (method, grains, tolerance) = (s.simulation.label(), s.grains, s.simulation.tolerance);
        let is =
            |group: &Group| (&group.method, group.grains, group.tolerance) == (&method, grains, tolerance);
        let new = || Group { method: method.clone(), grains, tolerance, solved: Vec::new(), missed: 0 };
        let group = find_or_push(&mut groups, is, new);
        if s.simulation.is_solved() {
            group.solved.push(s);
        } else {
            group.missed += 1;
        }
    }
    groups
}

/// The table `macroscopic-means`.
pub(super) fn part(sheared: &[Sheared]) -> Part {
    let note = "\nMeans over the packings that met the tolerance in every time step, of five or more; `missed`: those that did not. Low and \
                high: Student's interval of 95 %. Seconds: in the method, of a simulation.\n";
    Part::table(format!("{KEY}-means"), table(&groups(sheared)), note)
}

fn table(groups: &[Group]) -> DataFrame {
    let of = |value: fn(&Sheared) -> f64, end: fn(&Mean) -> f64| -> Vec<Option<f64>> {
        groups.iter().map(|group| group.mean(value).as_ref().map(end)).collect()
    };
    let middle = |mean: &Mean| mean.middle;
    let friction = |s: &Sheared| s.flow.friction;
    frame(df!(
        "method" => groups.iter().map(|group| group.method.as_str()).collect::<Vec<_>>(),
        "friction_of_grains" => groups.iter().map(|group| group.grains).collect::<Vec<_>>(),
        "tolerance" => groups.iter().map(|group| group.tolerance).collect::<Vec<_>>(),
        "packings" => groups.iter().map(|group| group.solved.len() as u64).collect::<Vec<_>>(),
        "missed" => groups.iter().map(|group| group.missed).collect::<Vec<_>>(),
        "friction" => of(friction, middle),
        "friction_low" => of(friction, |mean| mean.low),
        "friction_high" => of(friction, |mean| mean.high),
        "coordination" => of(|s| s.flow.coordination, middle),
        "solid_fraction" => of(|s| s.flow.solid_fraction, middle),
        "seconds" => of(|s| s.simulation.totals.setup_s + s.simulation.totals.iterating_s, middle),
    ))
}
