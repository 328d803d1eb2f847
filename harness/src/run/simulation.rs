//! A simulation of a study is made: its row and its series.

use crate::plan::rules::Rule;
use crate::plan::variants::Variant;
use crate::problems::scene::Scene;
use crate::run::execute::Conditions;
use crate::run::through_time::{End, Seen, through_time};
use crate::terminal::output::write_whole;
use anyhow::{Context, Result};
use cases::{Frozen, March};
use results::schema::{Provenance, Timing};
use results::simulation::{Observed, Simulated, Simulation};
use results::store::LAST_STATES;
use std::path::Path;
use std::time::Instant;

/// A simulation that is wanted.
pub(crate) struct Wanted<'a> {
    /// Name of the plan.
    pub(crate) plan: &'a str,
    pub(crate) scene: &'a Scene,
    pub(crate) variant: &'a Variant,
    pub(crate) rule: Rule,
    /// Its part in the study.
    pub(crate) role: &'a str,
    pub(crate) id: &'a str,
    /// As a user reads it.
    pub(crate) name: String,
}

/// One simulation; `None` if it was halted. One that explodes leaves the problem of its last good state in the folder of the
/// study.
pub(crate) fn run(wanted: &Wanted, conditions: &Conditions) -> Result<Option<Simulated>> {
    let clock = Instant::now();
    let Scene { case, time_steps, every, .. } = wanted.scene;
    let mut march = March::new(case)?;
    let timing = conditions.timing();
    let row = wanted_row(wanted, &march, conditions.provenance.restarted())?;
    let mut line = conditions.bars.line(wanted.name.clone());
    let mut series = Series { every: *every, rows: Vec::new(), since: None };
    let solver = &*wanted.variant.method.solver;
    let halt = conditions.halt;
    let (totals, end) = through_time(&mut march, solver, &wanted.rule, *time_steps, halt, &mut |seen| {
        series.see(seen);
        line.show_time_step(seen.totals.time_steps, *time_steps);
        Ok(())
    })?;
    let last_state = match (&end, conditions.folder) {
        (End::Interrupted(_), _) => return Ok(None),
        (End::Exploded { last, .. }, Some(folder)) => keep(last, folder, wanted.id)?,
        _ => String::new(),
    };
    let simulation = Simulation {
        status: end.status().to_owned(),
        reason: end.reason().to_owned(),
        last_state,
        totals,
        timing: Timing { wall_s: clock.elapsed().as_secs_f64(), ..timing },
        ..row
    };
    Ok(Some(Simulated { simulation, series: series.rows }))
}

/// Writes the problem of the last good state below the folder of the study, and returns its path there.
fn keep(last: &Frozen, folder: &Path, id: &str) -> Result<String> {
    let states = folder.join(LAST_STATES);
    std::fs::create_dir_all(&states).with_context(|| states.display().to_string())?;
    write_whole(&states.join(format!("{id}.json")), &last.to_json()?)?;
    Ok(format!("{LAST_STATES}/{id}.json"))
}

/// What is wanted, with nothing reached yet.
fn wanted_row(wanted: &Wanted, march: &March, provenance: Provenance) -> Result<Simulation> {
    let Wanted { scene, variant, rule, .. } = wanted;
    let problem = march.next()?.frozen.problem;
    let mut settings = scene.settings.clone();
    settings.insert("case".to_owned(), scene.case.name.as_str().into());
    Ok(Simulation {
        id: wanted.id.to_owned(),
        plan: wanted.plan.to_owned(),
        scene: scene.name.clone(),
        scene_settings: settings,
        scene_hash: scene.hash.clone(),
        role: wanted.role.to_owned(),
        grains: problem.grain_count() as u32,
        mass_kg: problem.mass().iter().sum(),
        mean_diameter_m: march.mean_diameter(),
        gravity_m_per_s2: scene.case.scene.gravity_m_per_s2,
        time_step_s: scene.case.scene.time_step_s,
        duration_s: scene.duration_s,
        method: variant.method.name.to_owned(),
        settings: variant.method.settings.clone(),
        variant: variant.name.clone(),
        warm_start: rule.warm_start,
        stop_on: rule.stop.on.name().to_owned(),
        tolerance: rule.stop.tolerance,
        max_iterations: rule.stop.max_iterations,
        provenance,
        ..Simulation::default()
    })
}

/// The series of a simulation, thinned: a row for every so many time steps.
struct Series {
    every: u64,
    rows: Vec<Observed>,
    /// The row that is being gathered.
    since: Option<Observed>,
}

impl Series {
    fn see(&mut self, seen: &Seen) {
        let now = row(seen);
        let row = self.since.take().map_or(now, |since| joined(&since, now));
        if seen.totals.time_steps.is_multiple_of(self.every) {
            self.rows.push(row);
        } else {
            self.since = Some(row);
        }
    }
}

/// What a time step shows.
pub(crate) fn row(seen: &Seen) -> Observed {
    let o = seen.observables;
    let [floor_impulse_n_s, left_impulse_n_s, right_impulse_n_s] = o.wall_impulses;
    Observed {
        time_step: seen.totals.time_steps,
        time_s: o.time,
        contacts: o.contacts as u32,
        iterations: seen.totals.iterations,
        kinetic_energy_j: o.kinetic_energy,
        mean_height_m: o.mean_height,
        greatest_overlap_m: o.greatest_overlap,
        mean_overlap_m: o.mean_overlap,
        greatest_speed_m_per_s: o.greatest_speed,
        floor_impulse_n_s,
        left_impulse_n_s,
        right_impulse_n_s,
    }
}

/// The later row, with the impulses of both and their extremes.
fn joined(earlier: &Observed, later: Observed) -> Observed {
    Observed {
        greatest_overlap_m: earlier.greatest_overlap_m.max(later.greatest_overlap_m),
        greatest_speed_m_per_s: earlier.greatest_speed_m_per_s.max(later.greatest_speed_m_per_s),
        floor_impulse_n_s: earlier.floor_impulse_n_s + later.floor_impulse_n_s,
        left_impulse_n_s: earlier.left_impulse_n_s + later.left_impulse_n_s,
        right_impulse_n_s: earlier.right_impulse_n_s + later.right_impulse_n_s,
        ..later
    }
}
