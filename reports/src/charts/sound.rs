//! Speed of sound of packings of rigid grains: after so many iterations a time step, a weight that begins to act is borne by the
//! floor only after a time.

use polars::df;
use polars::prelude::DataFrame;
use results::simulation::{Observed, SimulationEnding};

use crate::draw::{Curve, Look, MARKS, Panel, Plot, Scale, Side, Through, log, looks_in_time};
use crate::read::{Ending, Simulation, unique};
use crate::text::{Part, frame};

const KEY: &str = "sound";

/// Greatest distance of the time at which the floor first bears the whole weight from that until which it has borne less than half of it, over
/// the latter and but for a time step (–): of 59 simulations of the plan it is 0.19 or less in 54, and 0.3 to 1.7 in the others, in most of which
/// grains are thrown.
const APART: f64 = 0.2;

/// The theory of long waves, by which a contact is a spring; equations and tests: `solvers/tests/elasticity.rs`.
const NOTE: &str = "\nSpeed: the height, twice that of the centres of mass at the start, over the time until which the floor has borne less than half of \
                    the weight, which begins to act at once; in mean diameters and time steps. Where a wave carries it, the force at the \
                    floor grows like the time, and is then the weight. Exact contacts bear it in the first time step. Left out where the simulation exploded, and where the floor bears the whole weight a fifth sooner or later than that: \
                    iterations too few to damp what they amplify throw grains. Theory, of N iterations from the impulses of the step before, for waves much longer than they travel in a \
                    time step: in a column √(ωN/2) of jacobi, √(ωN/(2 − ω)) of nsgs, √(N(N + 5)/6) of nsgs with acceleration at ω = 1, √(κ(1 + μ(N − 1))) of latin-dd with relaxation \
                    μ and κ_l = κ; in a wide triangular lattice √(9/8) times as much.\n";

/// A simulation in which the floor came to bear the weight.
struct Loaded<'s> {
    simulation: &'s Simulation,
    case: &'s str,
    /// Mean diameters in a time step (–).
    speed: f64,
}

/// Returns the speed at which the weight came to the floor, in mean diameters a time step (–); `None` if it never did, did at once,
/// or not as a wave does.
fn speed(simulation: &Simulation) -> Option<f64> {
    let series = simulation.series();
    if simulation.status != SimulationEnding::Completed {
        return None;
    }
    let height = 2.0 * series.first()?.mean_height_m / simulation.mean_diameter_m;
    let weight = simulation.mass_kg * simulation.gravity_m_per_s2;
    // What the floor lacks of half the weight since the start (N·s).
    let mut borne = 0.0;
    let lack = |row: &Observed| {
        borne += row.floor_impulse_n_s;
        // The force of a time step is that at its end: between rows it changes as the time does.
        (row.time_s, 0.5 * weight * row.time_s - (borne - 0.5 * row.floor_impulse_n_s))
    };
    let lacks: Vec<(f64, f64)> = series.iter().map(lack).collect();
    let last = lacks.iter().rposition(|(_, lack)| *lack > 0.0)?;
    let ((before_s, before), (after_s, after)) = (lacks[last], *lacks.get(last + 1)?);
    let step_s = after_s - before_s;
    let time_s = before_s + before / (before - after) * step_s;
    let first = series.iter().find(|row| row.floor_impulse_n_s >= (1.0 - 1e-9) * weight * step_s)?;
    let is_wave = (first.time_s - time_s).abs() <= APART * time_s + step_s;
    is_wave.then_some(height * simulation.time_step_s / time_s)
}

fn loaded<'s>(all: &'s [Simulation]) -> Vec<Loaded<'s>> {
    let of = |simulation: &'s Simulation| {
        Some(Loaded { simulation, case: simulation.case(), speed: speed(simulation)? })
    };
    all.iter().filter(|simulation| simulation.is_run()).filter_map(of).collect()
}

/// The figure and the table `sound`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let loaded = loaded(all);
    let figure = (!loaded.is_empty()).then(|| Part::figure(KEY, figure(&loaded, &looks_in_time(all))));
    figure.into_iter().chain([Part::table(KEY, table(&loaded), NOTE)]).collect()
}

/// A panel for each case, against the iterations of a time step.
fn figure(loaded: &[Loaded], looks: &[(String, Look)]) -> String {
    let panel = |case: &str| {
        let curve = |((label, look), mark): (&(String, Look), _)| {
            let of = loaded.iter().filter(|one| one.case == case && one.simulation.label() == *label);
            let points = of
                .map(|one| (Ending::Converged, (log(one.simulation.max_iterations as f64), log(one.speed))));
            Curve::new(label.clone(), Look { mark, ..*look }, points.collect(), Through::Points)
        };
        let curves = looks.iter().zip(MARKS.into_iter().cycle()).map(curve).collect();
        let y = format!("{case}: speed of sound (mean diameters / time step)");
        Panel::new(Side::new(Scale::Ten, "iterations of a time step"), Side::new(Scale::Ten, y), curves)
    };
    let panels = unique(loaded.iter().map(|one| one.case)).into_iter().map(panel).collect();
    let title =
        vec!["Few iterations make rigid grains elastic: how fast a weight comes to the floor".to_owned()];
    Plot { title, panels, ..Plot::default() }.svg()
}

fn table(loaded: &[Loaded]) -> DataFrame {
    let of = |of: fn(&Loaded) -> u64| loaded.iter().map(of).collect::<Vec<_>>();
    frame(df!(
        "case" => loaded.iter().map(|one| one.case).collect::<Vec<_>>(),
        "grains" => of(|one| one.simulation.grains.into()),
        "method" => loaded.iter().map(|one| one.simulation.label()).collect::<Vec<_>>(),
        "iterations" => of(|one| one.simulation.max_iterations),
        "speed" => loaded.iter().map(|one| one.speed).collect::<Vec<_>>(),
    ))
}

#[cfg(test)]
mod tests;
