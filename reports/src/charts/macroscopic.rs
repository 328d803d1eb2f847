//! Friction of a sheared packing: against that of its grains, and against the tolerance of the solver.

#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;
use results::simulation::SimulationEnding;

use crate::draw::{Curve, Look, MARKS, Mark, Panel, Plot, Scale, Side, Sign, Through, log, looks_in_time};
use crate::read::{Simulation, rising};
use crate::text::{Part, chosen};

const KEY: &str = "macroscopic";
/// Setting of a scene for the friction of its grains.
const FRICTION: &str = "scene.friction";
/// Distance between methods that share a place, over the width of an axis.
const APART: f64 = 0.012;
/// A simulation whose second half says something.
struct Sheared<'s> {
    simulation: &'s Simulation,
    /// μ of the grains (–).
    grains: f64,
    flow: Flow,
}

/// The second half of a series.
struct Flow {
    /// Mean and standard deviation in time of τ/σ (–).
    friction: f64,
    spread: f64,
    /// Distance of the mean of a quarter of it from that of the next: the possible error of a mean over so long a time (–).
    drift: f64,
    /// Contacts that push, per grain (–).
    coordination: f64,
}

/// Averages the rows after half of its time; `None` if it did not come to its end, or if nothing presses.
fn flow(simulation: &Simulation) -> Option<Flow> {
    let series = simulation.series();
    let half = &series[series.len() / 2..];
    if simulation.status != SimulationEnding::Completed || half.len() < 2 {
        return None;
    }
    let ratios: Vec<f64> = half.iter().map(|row| row.stress.ratio()).collect::<Option<_>>()?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let friction = mean(&ratios);
    let squares: Vec<f64> = ratios.iter().map(|ratio| (ratio - friction).powi(2)).collect();
    let (first, last) = ratios.split_at(ratios.len() / 2);
    let coordination: Vec<f64> = half.iter().map(|row| row.stress.coordination).collect();
    Some(Flow {
        friction,
        spread: mean(&squares).sqrt(),
        drift: (mean(last) - mean(first)).abs(),
        coordination: mean(&coordination),
    })
}

fn sheared<'s>(all: &'s [Simulation]) -> Vec<Sheared<'s>> {
    let of = |simulation: &'s Simulation| {
        let grains = simulation.scene_settings.get(FRICTION)?.as_f64()?;
        Some(Sheared { simulation, grains, flow: flow(simulation)? })
    };
    all.iter().filter(|simulation| simulation.is_run()).filter_map(of).collect()
}

/// The figure and the table `macroscopic`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let sheared = sheared(all);
    let table = Part::table(KEY, table(&sheared), format!("\n{MEANING}\n"));
    let solved: Vec<Sheared> = sheared.into_iter().filter(|s| s.simulation.is_solved()).collect();
    let drawn = solved.len();
    let left_out = all.iter().filter(|simulation| simulation.is_run()).count() - drawn;
    let figure =
        (!solved.is_empty()).then(|| Part::figure(KEY, figure(&solved, &looks_in_time(all), left_out)));
    figure.into_iter().chain([table]).collect()
}

const MEANING: &str = "Friction of the packing is the mean of shear over normal stress (Love-Weber) in the second half of the time, \
                       its spread the standard deviation in time, its drift the distance of the means of the third and of the \
                       fourth quarter of the time.";

fn table(sheared: &[Sheared]) -> DataFrame {
    let of = |value: fn(&Sheared) -> f64| sheared.iter().map(value).collect::<Vec<_>>();
    let own = df!(
        "method" => sheared.iter().map(|s| s.simulation.label()).collect::<Vec<_>>(),
        "friction_of_grains" => of(|s| s.grains),
        "friction_of_packing" => of(|s| s.flow.friction),
        "spread" => of(|s| s.flow.spread),
        "drift" => of(|s| s.flow.drift),
        "coordination" => of(|s| s.flow.coordination),
    );
    let names = "scene method tolerance friction_of_grains friction_of_packing spread drift coordination time_steps \
                 missed_time_steps iterations iterating_s";
    chosen(sheared.iter().map(|s| s.simulation), names, own)
}

/// Left, at the least tolerance met, against the μ of the grains; right, at the middle μ, against the tolerance.
fn figure(solved: &[Sheared], looks: &[(String, Look)], left_out: usize) -> String {
    let grains = rising(solved.iter().map(|s| s.grains));
    let middle = grains[grains.len() / 2];
    let tightest = |grains: f64| {
        let tolerances = solved.iter().filter(|s| s.grains == grains).map(|s| s.simulation.tolerance);
        tolerances.fold(f64::INFINITY, f64::min)
    };
    let of_grains = solved.iter().filter(|s| s.simulation.tolerance == tightest(s.grains));
    let of_tolerance = solved.iter().filter(|s| s.grains == middle);
    let words =
        "A point for each packing; lines join medians. Methods stand a little apart to be seen.".to_owned();
    let mut signs = vec![(Sign::Word, words)];
    if left_out > 0 {
        let text = format!(
            "Left out, not completed or with more than a tenth of their time steps missed: {left_out}."
        );
        signs.push((Sign::Word, text));
    }
    let title = vec![format!(
        "Friction of the packing: at the least tolerance met, against μ of its grains; with μ = {middle}, against the tolerance"
    )];
    let panels = vec![
        panel(
            &of_grains.map(|s| (s, s.grains)).collect::<Vec<_>>(),
            looks,
            "friction μ of the grains (–)",
            Scale::Share,
        ),
        panel(
            &of_tolerance.map(|s| (s, log(s.simulation.tolerance))).collect::<Vec<_>>(),
            looks,
            "tolerance of a time step (–)",
            Scale::Ten,
        ),
    ];
    Plot { title, panels, signs, ..Plot::default() }.svg()
}

fn panel(shown: &[(&Sheared, f64)], looks: &[(String, Look)], name: &str, scale: Scale) -> Panel {
    let values = rising(shown.iter().map(|(_, x)| *x));
    let wide = values[values.len() - 1] - values[0];
    let marks = [Mark::Disc, Mark::Diamond, Mark::Square].into_iter().chain(MARKS).cycle();
    let mut curves = Vec::new();
    for (n, ((label, look), mark)) in looks.iter().zip(marks).enumerate() {
        let beside = (n as f64 - 0.5 * (looks.len() - 1) as f64) * APART * wide;
        let own = shown.iter().filter(|(s, _)| s.simulation.label() == *label);
        let places = own.map(|(s, x)| (x + beside, s.flow.friction));
        curves.push(Curve::of(label.clone(), Look { mark, ..*look }, places, Through::Medians));
    }
    let y = Side::new(Scale::Share, "friction τ/σ of the packing (–)").holding([0.0]);
    Panel::new(Side::new(scale, name), y, curves)
}
