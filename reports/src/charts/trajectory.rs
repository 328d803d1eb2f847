//! Accuracy of the simulation: errors of the trajectory against seconds per simulated second.

mod error;
#[cfg(test)]
mod tests;

use std::ops::Deref;

use polars::df;
use polars::prelude::DataFrame;
use results::simulation::Role;

use crate::draw::{
    At, Curve, Guide, INK, LOWEST, Look, Mark, Panel, Pen, Plot, Scale, Side, Sign, TOLERANCE, Through, log,
    looks_in_time,
};
use crate::read::{Simulation, file_name, in_role, milliseconds, number, rising, span, unique};
use crate::text::{Part, chosen};
use error::{OBSERVABLES, errors};

/// Tells time steps apart, from the longest.
const MARKS: [Mark; 5] = [Mark::Ring, Mark::Square, Mark::Diamond, Mark::Triangle, Mark::Cross];
/// Two references that differ in their tolerance alone: below their distance no error means anything.
const TWINS: Pen = Pen { color: INK, width: 0.3, dash: &[0.4, 0.5] };
/// Least height of an axis (logarithm).
const LEAST: f64 = 1.0;

/// A simulation beside the reference of its scene.
struct Compared<'s> {
    simulation: &'s Simulation,
    errors: Option<[f64; 4]>,
}

impl Deref for Compared<'_> {
    type Target = Simulation;

    fn deref(&self) -> &Simulation {
        self.simulation
    }
}

impl Compared<'_> {
    /// The i-th error (logarithm).
    fn error(&self, i: usize) -> Option<f64> {
        self.errors.map(|errors| log(errors[i]).max(LOWEST))
    }

    /// Seconds per second (logarithm).
    fn cost(&self) -> Option<f64> {
        self.seconds_per_second().map(log)
    }
}

/// `trajectory-<scene>` for each scene, and the table `trajectory` with all errors.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let beside = |s: &Simulation| errors(s, in_role(all, &s.scene, Role::Reference)?);
    let compared: Vec<Compared> =
        all.iter().map(|simulation| Compared { simulation, errors: beside(simulation) }).collect();
    let looks = looks_in_time(all);
    let mut parts = Vec::new();
    for scene in unique(all.iter().map(|s| s.scene.as_str())) {
        let of_scene: Vec<&Compared> = compared.iter().filter(|c| c.scene == scene).collect();
        if of_scene.iter().any(|c| c.errors.is_some() && c.role != Role::Reference) {
            let name = format!("trajectory-{}", file_name(scene));
            parts.push(Part::figure(name, figure(scene, &of_scene, &looks)));
        }
    }
    parts.push(Part::table("trajectory", table(&compared), format!("\n{NORMS}\n")));
    parts
}

const NORMS: &str = "Errors over the common times of the series, beside the reference: root of the mean square, for the \
                     impulses of the walls and the kinetic energy over that of the reference, for the greatest overlap \
                     and the mean height in mean diameters d. Seconds are those in the method alone.";

fn table(compared: &[Compared]) -> DataFrame {
    let error = |i: usize| compared.iter().map(|c| c.errors.map(|e| e[i])).collect::<Vec<Option<f64>>>();
    let own = df!(
        "method" => compared.iter().map(|c| c.label()).collect::<Vec<_>>(),
        "wall_impulse" => error(0),
        "kinetic_energy" => error(1),
        "greatest_overlap_mean_diameters" => error(2),
        "mean_height_mean_diameters" => error(3),
        "seconds_per_second" => compared.iter().map(|c| c.seconds_per_second()).collect::<Vec<_>>(),
    );
    let names = "scene role time_step_s method warm_start tolerance max_iterations status wall_impulse kinetic_energy \
                 greatest_overlap_mean_diameters mean_height_mean_diameters seconds_per_second";
    chosen(compared.iter().map(|c| c.simulation), names, own)
}

fn figure(scene: &str, compared: &[&Compared], looks: &[(String, Look)]) -> String {
    let sign = |(h, mark)| (Sign::Mark(mark, Pen::solid(INK, 0.3)), format!("h = {} ms", milliseconds(h)));
    let mut signs: Vec<(Sign, String)> = steps(compared).map(sign).collect();
    let tolerances: Vec<String> = falling(compared, |s| s.tolerance).iter().map(|t| number(*t, 2)).collect();
    let text = format!("Tolerances along a line, from loose to tight: {}.", tolerances.join(", "));
    signs.push((Sign::Word, text));
    signs.push((Sign::Word, "d: mean diameter of the grains.".to_owned()));
    let failed = of_role(compared, Role::Run).filter(|c| c.errors.is_none()).count();
    if failed > 0 {
        signs.push((Sign::Word, format!("Not drawn, since they did not come to the end: {failed}.")));
    }
    let title =
        vec![format!("{scene}: errors of the trajectory against seconds of the method per simulated second")];
    let panels = (0..OBSERVABLES.len()).map(|i| panel(compared, looks, i)).collect();
    Plot { title, panels, entries: looks.to_vec(), signs, ..Plot::default() }.svg()
}

/// Returns the distinct values of the runs, the greatest first.
fn falling(compared: &[&Compared], of: fn(&Simulation) -> f64) -> Vec<f64> {
    rising(of_role(compared, Role::Run).map(|c| of(c))).into_iter().rev().collect()
}

fn of_role<'c>(compared: &'c [&'c Compared<'c>], role: Role) -> impl Iterator<Item = &'c Compared<'c>> {
    compared.iter().copied().filter(move |c| c.role == role)
}

/// The time steps, each with its mark.
fn steps(compared: &[&Compared]) -> impl Iterator<Item = (f64, Mark)> {
    falling(compared, |s| s.time_step_s).into_iter().zip(MARKS.into_iter().cycle())
}

/// The i-th error, with a curve for each method and time step.
fn panel(compared: &[&Compared], looks: &[(String, Look)], i: usize) -> Panel {
    let mut curves = Vec::new();
    for ((label, look), (step, mark)) in looks.iter().flat_map(|look| steps(compared).map(move |s| (look, s)))
    {
        let here = of_role(compared, Role::Run).filter(|c| c.label() == *label && c.time_step_s == step);
        let mut points: Vec<_> = here.filter_map(|c| Some((c.tolerance, (c.cost()?, c.error(i)?)))).collect();
        points.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Two tolerances are no curve.
        let through = if points.len() < 3 { Through::Nothing } else { Through::Points };
        let points = points.into_iter().map(|(_, point)| point);
        curves.push(Curve::of("", Look { mark, ..*look }, points, through));
    }
    let floor = |floor: &Compared| {
        let guide = Guide::new(At::Y(floor.error(i)?), TOLERANCE, "error of the time step alone");
        Some(Guide { beside: format!("{} ms", milliseconds(floor.time_step_s)), ..guide })
    };
    let floors: Vec<Guide> = of_role(compared, Role::Floor).filter_map(floor).collect();
    let holds = || floors.iter().filter_map(|floor| if let At::Y(y) = floor.at { Some(y) } else { None });
    let errors = of_role(compared, Role::Run).filter_map(|c| c.error(i));
    let (low, high) = span(errors.chain(holds())).unwrap_or((0.0, 1.0));
    let high = high.max(low + LEAST);
    let uncertain = "uncertainty of the reference: smaller errors are not meaningful";
    let twins =
        of_role(compared, Role::Twin).filter_map(|c| c.error(i)).filter(|at| (low..=high).contains(at));
    let guides = twins.map(|at| Guide::new(At::Y(at), TWINS, uncertain)).chain(floors.clone());
    let y = Side::new(Scale::Ten, format!("error of the {}", OBSERVABLES[i])).holding([low, high]);
    Panel::new(Side::new(Scale::Ten, "seconds per simulated second"), y, curves).guided(guides)
}
