//! Small simulations for the tests.

use crate::read;
use crate::tests::fixture;
use contact::Measure;
use results::name::StopOn;
use results::schema::Ending;
use results::simulation::Role;
use results::simulation::SimulationEnding;
use results::simulation::{Observed, Simulated, Simulation, Totals};

/// A simulation of `box` by `nsgs` with a mean diameter of 0.1 m and 10 kg, 1 s long with rows of 0.1 s; it lies still at a
/// height of 1 m and presses on the floor.
pub(crate) fn simulated(role: Role, time_step_s: f64, tolerance: f64) -> Simulated {
    let time_steps = (1.0 / time_step_s).round() as u64;
    let simulation = Simulation {
        id: "0".into(),
        plan: "time".into(),
        scene: "box".into(),
        scene_hash: "c0ffee".into(),
        role,
        grains: 5,
        mass_kg: 10.0,
        mean_diameter_m: 0.1,
        gravity_m_per_s2: 10.0,
        time_step_s,
        duration_s: 1.0,
        method: "nsgs".into(),
        warm_start: true,
        start: "previous".into(),
        stop_on: StopOn(Measure::NaturalMap),
        tolerance,
        max_iterations: 100,
        status: SimulationEnding::Completed,
        totals: Totals {
            time_steps,
            iterations: 7 * time_steps,
            setup_s: 0.1,
            iterating_s: 1e-3 / tolerance,
            ..Totals::default()
        },
        timing: fixture::run(0, "nsgs", "", Ending::Converged).timing,
        provenance: fixture::run(0, "nsgs", "", Ending::Converged).provenance,
        ..Simulation::default()
    };
    let row = |k: u64| Observed {
        time_step: k * time_steps / 10,
        time_s: 0.1 * k as f64,
        contacts: 4,
        iterations: 7 * k,
        kinetic_energy_j: 0.0,
        mean_height_m: 1.0,
        greatest_overlap_m: 0.0,
        mean_overlap_m: 0.0,
        greatest_speed_m_per_s: 0.0,
        floor_impulse_n_s: 10.0,
        left_impulse_n_s: 0.0,
        right_impulse_n_s: 0.0,
        ..Observed::default()
    };
    Simulated { simulation, series: (1..=10).map(row).collect() }
}

/// Changes every row of the series.
pub(crate) fn with(mut simulated: Simulated, change: impl Fn(&mut Observed)) -> Simulated {
    simulated.series.iter_mut().for_each(change);
    simulated
}

/// One that came to half its time.
pub(crate) fn exploded(mut simulated: Simulated) -> Simulated {
    simulated.series.truncate(5);
    simulated.simulation.status = SimulationEnding::Exploded;
    simulated.simulation.reason = "exploded in time step 6: a velocity is not finite".into();
    simulated
}

/// As the figures read them.
pub(crate) fn read(all: &[Simulated]) -> Vec<read::Simulation> {
    all.iter().map(read::Simulation::of).collect()
}
