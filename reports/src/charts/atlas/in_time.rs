//! Stability in time: what became of each simulation, method and rule against scene and time step.

#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;
use results::simulation::{Role, Simulation as Row};

use super::class::{CREEP, Class, Drift, MORE_ENERGY, SHARE_OF_FALL, counts};
use crate::charts::grid::{Grid, Head, Tile};
use crate::read::{Simulation, counted, in_role, milliseconds, number, unique};
use crate::text::{Part, chosen};

/// Height of a row of the grid (mm).
const ROW: f64 = 3.9;

/// A simulation, judged.
struct Judged<'s> {
    simulation: &'s Simulation,
    class: Class,
    drift: Option<Drift>,
}

/// The figure and the table `atlas-in-time`, and the table `atlas-in-time-counts`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let judged: Vec<Judged> = all
        .iter()
        // The floors are as exact as their time step lets them: where they are not stable, no tolerance is to blame.
        .filter(|simulation| simulation.is_run() || simulation.role == Role::Floor)
        .map(|simulation| {
            let reference = in_role(all, &simulation.scene, Role::Reference);
            let drift = reference.and_then(|reference| Drift::of(simulation, reference));
            Judged { simulation, class: Class::in_time(simulation, reference), drift }
        })
        .collect();
    let methods = unique(judged.iter().map(|j| j.simulation.label())).into_iter().map(|method| {
        let of: Vec<&Judged> = judged.iter().filter(|j| j.simulation.label() == method).collect();
        let rules = unique(of.iter().map(|j| Line::of(j.simulation))).len();
        (method, rules, of.iter().map(|j| j.class).collect())
    });
    let methods: Vec<_> = methods.collect();
    vec![
        Part::figure("atlas-in-time", figure(&judged)),
        Part::table(
            "atlas-in-time-counts",
            counts(&methods, Class::all().filter(|class| class.is_in_time())),
            "",
        ),
        Part::table("atlas-in-time", table(&judged), format!("\n{}\n", rule())),
    ]
}

/// The rule of the classes, in words.
fn rule() -> String {
    format!(
        "Judged over the second half of the time, beside the reference of the scene: creeping, if the median mean height \
         is off or the median greatest overlap larger by more than {CREEP} mean diameters; else jittering, if the median \
         kinetic energy exceeds the reference's by more than {MORE_ENERGY} times it, and by more than that of grains at \
         {SHARE_OF_FALL} times the speed that free fall gives in a time step; else stable. Exploded: not finite, an overlap \
         above the radius of the smaller grain, or a grain that moves by more than its diameter within a time step; no \
         solution, solver diverged: it exploded because of that."
    )
}

fn table(judged: &[Judged]) -> DataFrame {
    let simulations = || judged.iter().map(|j| j.simulation);
    let drifts = |of: fn(&Drift) -> f64| judged.iter().map(|j| j.drift.as_ref().map(of)).collect::<Vec<_>>();
    let own = df!(
        "method" => simulations().map(Simulation::label).collect::<Vec<_>>(),
        "class" => judged.iter().map(|j| Some(j.class).filter(|class| class.is_in_time()).map(Class::text)).collect::<Vec<_>>(),
        "height_drift_mean_diameters" => drifts(|drift| drift.height),
        "overlap_excess_mean_diameters" => drifts(|drift| drift.overlap),
        "worst_overlap_mean_diameters" => simulations().map(worst_overlap).collect::<Vec<_>>(),
        "kinetic_energy_j" => drifts(|drift| drift.energies[0]),
        "kinetic_energy_of_reference_j" => drifts(|drift| drift.energies[1]),
        "seconds_per_second" => simulations().map(Simulation::seconds_per_second).collect::<Vec<_>>(),
    );
    let names = "scene time_step_s method warm_start tolerance max_iterations class height_drift_mean_diameters \
                 overlap_excess_mean_diameters worst_overlap_mean_diameters kinetic_energy_j \
                 kinetic_energy_of_reference_j time_steps missed_time_steps seconds_per_second";
    chosen(simulations(), names, own)
}

/// In mean diameters, over all time.
fn worst_overlap(simulation: &Simulation) -> f64 {
    let overlaps = simulation.series().iter().map(|row| row.greatest_overlap_m);
    overlaps.fold(0.0, f64::max) / simulation.mean_diameter_m
}

/// A row of the matrix.
#[derive(PartialEq)]
struct Line {
    method: String,
    warm_start: bool,
    tolerance: f64,
    max_iterations: u64,
}

impl Line {
    fn of(simulation: &Simulation) -> Self {
        let Row { warm_start, tolerance, max_iterations, .. } = **simulation;
        Self { method: simulation.label(), warm_start, tolerance, max_iterations }
    }

    /// Names the method and its rule; a tolerance of 0 is never met, so that the budget decides.
    fn text(&self) -> String {
        let rule = match self.tolerance {
            0.0 => counted(self.max_iterations as usize, "iteration"),
            tolerance => format!("≤ {}", number(tolerance, 1)),
        };
        format!("{}, {rule}, {}", self.method, if self.warm_start { "warm" } else { "cold" })
    }
}

fn figure(judged: &[Judged]) -> String {
    let lines = unique(judged.iter().map(|j| Line::of(j.simulation)));
    let texts: Vec<String> = lines.iter().map(Line::text).collect();
    let scenes = unique(judged.iter().map(|j| j.simulation.scene.as_str()));
    let steps = |scene: &str| {
        unique(judged.iter().filter(|j| j.simulation.scene == scene).map(|j| j.simulation.time_step_s))
    };
    let tile = |line: &Line, scene: &str, step: f64| {
        let here = |j: &&Judged| {
            j.simulation.scene == scene && j.simulation.time_step_s == step && Line::of(j.simulation) == *line
        };
        let class = judged.iter().find(here).map_or(Class::Unjudged, |j| j.class);
        Tile { cells: vec![class.cell()], marks: [false; 2] }
    };
    let head = |(i, scene): (usize, &&str)| {
        let steps: Vec<String> = steps(scene).into_iter().map(|h| milliseconds(h).to_string()).collect();
        Head { short: (i + 1).to_string(), long: Some(format!("{scene}, h = {} ms", steps.join(", "))) }
    };
    Grid {
        title: "What became of each simulation, under each scene and its time steps h from left to right"
            .to_owned(),
        notes: Vec::new(),
        rows: texts.iter().map(|text| (text.as_str(), "")).collect(),
        height: ROW,
        widest: super::WIDEST,
        columns: scenes.iter().enumerate().map(head).collect(),
        cells: Class::cells(),
        marks: [""; 2],
        tiles: &|row, column| {
            let scene = scenes[column];
            steps(scene).into_iter().map(|step| Some(tile(&lines[row], scene, step))).collect()
        },
    }
    .svg()
}
