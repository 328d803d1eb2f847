//! Stability in time: what became of each simulation, method and rule against scene and time step.

mod class;
#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    Canvas, FRAME, HPos, INK, INSIDE, LEADING, MARGIN, PAGE, Pen, Sign, Signs, TEXT, TICK_TEXT, VPos, WHITE,
    svg, text_width,
};
use results::simulation::Simulation as Row;

use crate::read::{Simulation, counted, in_role, milliseconds, number, unique};
use crate::text::{Part, chosen};
use class::{CREEP, Class, Drift, MORE_ENERGY, SHARE_OF_FALL, class, drift};

/// A simulation, judged.
struct Judged<'s> {
    simulation: &'s Simulation,
    class: Option<Class>,
    drift: Option<Drift>,
}

/// The figure and the table `atlas-in-time`, and `atlas-in-time-found` in words.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let judged: Vec<Judged> = all
        .iter()
        // The floors are as exact as their time step lets them: where they are not stable, no tolerance is to blame.
        .filter(|simulation| simulation.is_run() || simulation.role == "floor")
        .map(|simulation| {
            let reference = in_role(all, &simulation.scene, "reference");
            let drift = reference.and_then(|reference| drift(simulation, reference));
            Judged { simulation, class: class(simulation, reference), drift }
        })
        .collect();
    vec![
        Part::figure("atlas-in-time", figure(&judged)),
        Part::text("atlas-in-time-found", sentences(&judged)),
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
        "class" => judged.iter().map(|j| j.class.map(Class::name)).collect::<Vec<_>>(),
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

/// Height of a row and width of a column of the matrix, room for turned-in headings above (mm).
const ROW: f64 = 3.9;
const CELL: (f64, f64) = (5.0, 12.0);

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

    /// Names the settings that differ within the study; a tolerance of 0 is never met, so that the budget decides.
    fn text(&self, tolerances: bool, starts: bool) -> String {
        let mut words = vec![self.method.clone()];
        if self.tolerance == 0.0 {
            words.push(counted(self.max_iterations as usize, "iteration"));
        } else if tolerances {
            words.push(format!("≤ {}", number(self.tolerance, 1)));
        }
        if starts {
            words.push(if self.warm_start { "warm" } else { "cold" }.to_owned());
        }
        words.join(", ")
    }
}

fn figure(judged: &[Judged]) -> String {
    let lines = unique(judged.iter().map(|j| Line::of(j.simulation)));
    let tolerances = lines.windows(2).any(|pair| pair[0].tolerance != pair[1].tolerance);
    let starts = lines.windows(2).any(|pair| pair[0].warm_start != pair[1].warm_start);
    let short: Vec<String> = lines.iter().map(|line| line.text(tolerances, starts)).collect();
    let alone = |text: &String| short.iter().filter(|other| *other == text).count() == 1;
    let long = |(line, text): (&Line, &String)| format!("{text}, {} iterations", line.max_iterations);
    let of = |(line, text)| if alone(text) { text.clone() } else { long((line, text)) };
    let texts: Vec<String> = lines.iter().zip(&short).map(of).collect();
    let columns = unique(judged.iter().map(|j| (j.simulation.scene.as_str(), j.simulation.time_step_s)));
    let left = MARGIN + texts.iter().map(|text| text_width(text, TICK_TEXT)).fold(0.0, f64::max) + 1.5;
    let cell = ((PAGE - MARGIN - left) / columns.len().max(1) as f64).clamp(CELL.0, CELL.1);
    let scenes = unique(columns.iter().map(|(scene, _)| *scene));
    let top = MARGIN + LEADING * (1.5 + scenes.len() as f64 + 1.0) + 0.5;
    let bottom = top + ROW * lines.len() as f64;
    let key = key();
    let height = (bottom + 2.0 + key.height() + MARGIN).ceil();
    svg((PAGE, height), |canvas| {
        let title = "What became of each simulation, under each scene and time step h (ms)";
        canvas.text(title, (MARGIN, MARGIN), TEXT, (HPos::Left, VPos::Top));
        headings(canvas, &columns, &scenes, (left, top), cell);
        for (i, (line, text)) in lines.iter().zip(&texts).enumerate() {
            let y = top + ROW * i as f64;
            canvas.text(text, (left - 1.0, y + ROW / 2.0), TICK_TEXT, (HPos::Right, VPos::Center));
            for (k, column) in columns.iter().enumerate() {
                let here = |j: &&Judged| {
                    (j.simulation.scene.as_str(), j.simulation.time_step_s) == *column
                        && Line::of(j.simulation) == *line
                };
                let class = judged.iter().find(here).and_then(|j| j.class);
                let x = left + cell * k as f64;
                let outline = Pen::solid(WHITE, 0.25);
                Class::cell(class).draw(canvas, (x, y), (x + cell, y + ROW), outline);
            }
        }
        key.draw(canvas, (MARGIN, bottom + 2.0));
    })
}

/// A bracket with its name over the columns of each scene, and the time steps below.
fn headings(canvas: &Canvas, columns: &[(&str, f64)], scenes: &[&str], (left, top): (f64, f64), cell: f64) {
    for (i, scene) in scenes.iter().enumerate() {
        let of_scene = |(k, column): (usize, &(&str, f64))| (column.0 == *scene).then_some(k);
        let first = columns.iter().enumerate().find_map(of_scene).unwrap_or(0);
        let count = columns.iter().filter(|column| column.0 == *scene).count();
        let x = (left + cell * first as f64 + 0.3, left + cell * (first + count) as f64 - 0.3);
        // Names may be longer than their columns are wide: each has a line of its own.
        let y = top - LEADING * (1.0 + (scenes.len() - i) as f64);
        canvas.text(scene, (x.0 + 0.8, y), TICK_TEXT, (HPos::Left, VPos::Top));
        let down = top - LEADING - 0.3;
        canvas.line(&[(x.0, y + 0.5), (x.0, down), (x.1, down)], Pen { color: INK, ..FRAME });
    }
    for (k, (_, h)) in columns.iter().enumerate() {
        let x = left + cell * (k as f64 + 0.5);
        canvas.text(&milliseconds(*h).to_string(), (x, top - 0.6), TICK_TEXT, (HPos::Center, VPos::Bottom));
    }
}

/// The classes, and what no cell has.
fn key() -> Signs {
    let classes = Class::ALL.map(|(class, name, ..)| (Some(class), name));
    let all = classes.into_iter().chain([(None, "not made, or nothing to judge it by")]);
    Signs::new(all.map(|(class, name)| (Sign::Cell(Class::cell(class)), name.to_owned())).collect(), INSIDE)
}

/// Summarises the rows: how many of each class, of each method, and what the start and the time step change.
fn sentences(judged: &[Judged]) -> String {
    let counts = |of: &dyn Fn(&Judged) -> bool| {
        let count = |class| judged.iter().filter(|j| of(j) && j.class == Some(class)).count();
        // Why one exploded, only where it is more than that.
        let counted = Class::ALL.map(|(class, name, ..)| (class, name, count(class)));
        let named = counted.into_iter().filter(|(class, _, count)| *class <= Class::Exploded || *count > 0);
        named.map(|(_, name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
    };
    let mut text = format!("Of {}: {}.\n", counted(judged.len(), "simulation"), counts(&|_| true));
    let all: Vec<&Simulation> = judged.iter().map(|j| j.simulation).collect();
    let mut methods: Vec<String> = all.iter().map(|s| s.label()).collect();
    methods.dedup();
    methods.sort();
    methods.dedup();
    for method in methods {
        text.extend([format!("{method}: {}.\n", counts(&|j| j.simulation.label() == method))]);
    }
    text + &of_starts(judged)
}

/// Pairs of simulations that differ in their start alone.
fn of_starts(judged: &[Judged]) -> String {
    let twin = |cold: &Judged| {
        let same = |warm: &&Judged| {
            let (a, b) = (warm.simulation, cold.simulation);
            let line = Line { warm_start: true, ..Line::of(b) };
            Line::of(a) == line && a.scene == b.scene && a.time_step_s == b.time_step_s
        };
        judged.iter().find(same).and_then(|warm| Some((warm.class?, cold.class?)))
    };
    let pairs: Vec<(Class, Class)> =
        judged.iter().filter(|j| !j.simulation.warm_start).filter_map(twin).collect();
    if pairs.is_empty() {
        return String::new();
    }
    let (worse, better) = (
        pairs.iter().filter(|(warm, cold)| cold > warm).count(),
        pairs.iter().filter(|(warm, cold)| cold < warm).count(),
    );
    format!(
        "Of {} that differ in their start alone, the cold one is of a worse class in {worse}, of a better one in {better}.\n",
        counted(pairs.len(), "pair")
    )
}
