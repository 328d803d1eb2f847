//! From what the harness holds to the rows of the results.

use crate::curve::{first_at, measured};
use crate::plan::{Plan, Variant};
use crate::problems::Problem;
use crate::study::{Study, Task};
use crate::truth::Given;
use cases::Frozen;
use contact::{Adjacency, Meter, Outcome, Truth, Work};
use nalgebra::Vector2;
use partition::{Decomposition, Grid, Partition, Scheme};
use results::schema::{ContactRow, GrainRow, Provenance, Run, Sample, Timing};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// What is asked of a run, with nothing reached yet: a skipped run, if it is not made. Its number in the tables comes
/// with them.
pub(crate) fn asked_row(study: &Study, task: &Task, provenance: &Provenance, timing: Timing) -> Run {
    // A grid may have more subdomains than the column counts; every method refuses it, and its row stays.
    let subdomains = |grid: Grid| u32::try_from(grid.count()).unwrap_or(u32::MAX);
    let variant = task.variant;
    Run {
        id: task.id.clone(),
        method: variant.method.name.to_owned(),
        settings: Value::Object(variant.method.settings.clone()).to_string(),
        variant: variant.name.clone(),
        subdomains: setting::<Grid>(variant, "subdomains").map_or(1, subdomains),
        warm_start: variant.warm_start,
        status: "skipped".to_owned(),
        timing,
        ..nothing_done(&study.asked.plan, task.problem, provenance)
    }
}

/// The row of impulses that another code gave: measured as ours are, with nothing run.
pub(crate) fn given_row(
    plan: &Plan,
    problem: &Problem,
    given: &Given,
    truth: Option<&Truth>,
    provenance: &Provenance,
) -> Run {
    let meter = Meter::new(&problem.frozen.problem);
    let mut meter = if let Some(truth) = truth { meter.against(truth) } else { meter };
    let measures = meter.measure(&given.impulse, 0.0);
    Run {
        method: "given".to_owned(),
        variant: given.from.clone(),
        status: "given".to_owned(),
        end: Sample { iteration: 0, iterating_s: f64::NAN, ..measured(&measures, &Work::default()) },
        ..nothing_done(plan, problem, provenance)
    }
}

fn nothing_done(plan: &Plan, problem: &Problem, provenance: &Provenance) -> Run {
    Run {
        run: 0,
        id: String::new(),
        plan: plan.name.clone(),
        problem: problem.frozen.name.clone(),
        problem_hash: problem.hash.clone(),
        problem_settings: problem.settings.clone(),
        grains: problem.frozen.problem.grain_count() as u32,
        contacts: problem.frozen.problem.contact_count() as u32,
        method: String::new(),
        settings: "{}".to_owned(),
        derived: "{}".to_owned(),
        spectrum: "{}".to_owned(),
        variant: String::new(),
        subdomains: 1,
        warm_start: false,
        stop_on: plan.stop.on.name().to_owned(),
        tolerance: plan.stop.tolerance,
        max_iterations: plan.stop.max_iterations,
        status: String::new(),
        reason: String::new(),
        iterations: 0,
        setup_s: f64::NAN,
        iterating_s: f64::NAN,
        iterations_to_zeta_1e_3: None,
        iterations_to_zeta_1e_4: None,
        iterations_to_natural_map_1e_2: None,
        iterations_to_natural_map_1e_4: None,
        iterations_to_velocity_error_1e_2: None,
        iterations_to_velocity_error_1e_4: None,
        timing: UNTIMED,
        end: NO_ITERATE,
        provenance: provenance.clone(),
    }
}

/// Before a run, and where there is none.
pub(crate) const UNTIMED: Timing = Timing {
    repeats: 0,
    timed_alone: false,
    setup_spread_s: f64::NAN,
    iterating_spread_s: f64::NAN,
    wall_s: f64::NAN,
    load_average: f64::NAN,
};

/// Nothing was done, and no measure is defined.
const NO_ITERATE: Sample = Sample {
    iteration: 0,
    iterating_s: f64::NAN,
    zeta: f64::NAN,
    natural_map: f64::NAN,
    penetration_rate_m_per_s: f64::NAN,
    quad_dv: f64::NAN,
    max_dv: f64::NAN,
    velocity_error: f64::NAN,
    energy_gap: f64::NAN,
    velocity_jump_m_per_s: f64::NAN,
    energy_j: f64::NAN,
    contact_updates: 0,
    delassus_products: 0,
    interface_values: 0,
    triangular_solve_entries: 0,
    factorisations: 0,
};

/// What was asked, and what the run reached.
pub(crate) fn ended_row(asked: Run, outcome: &Outcome, curve: &[Sample]) -> Run {
    let zeta = |tolerance| first_at(curve, |sample| sample.zeta, tolerance);
    let natural_map = |tolerance| first_at(curve, |sample| sample.natural_map, tolerance);
    let velocity_error = |tolerance| first_at(curve, |sample| sample.velocity_error, tolerance);
    Run {
        derived: json!(outcome.derived.iter().copied().collect::<BTreeMap<_, _>>()).to_string(),
        status: outcome.status.name().to_owned(),
        iterations: outcome.iterations,
        setup_s: outcome.setup.as_secs_f64(),
        iterating_s: outcome.iterating.as_secs_f64(),
        iterations_to_zeta_1e_3: zeta(1e-3),
        iterations_to_zeta_1e_4: zeta(1e-4),
        iterations_to_natural_map_1e_2: natural_map(1e-2),
        iterations_to_natural_map_1e_4: natural_map(1e-4),
        iterations_to_velocity_error_1e_2: velocity_error(1e-2),
        iterations_to_velocity_error_1e_4: velocity_error(1e-4),
        end: curve[curve.len() - 1],
        ..asked
    }
}

/// The partitions that the methods of a plan use, by name, each once.
pub(crate) fn partitions(variants: &[Variant]) -> Vec<(String, Grid, Scheme)> {
    let mut partitions = Vec::new();
    for variant in variants {
        let scheme = setting::<Scheme>(variant, "partition");
        if let (Some(grid), Some(scheme)) = (setting::<Grid>(variant, "subdomains"), scheme) {
            let name = match scheme {
                Scheme::Boxes => grid.to_string(),
                Scheme::Balanced => format!("{grid}-balanced"),
            };
            if !partitions.iter().any(|(known, _, _)| *known == name) {
                partitions.push((name, grid, scheme));
            }
        }
    }
    partitions
}

/// The grains and contacts of a problem under a partition, as they are drawn.
pub(crate) fn scene_rows(
    frozen: &Frozen,
    name: &str,
    partition: &Partition,
    impulses: Option<&[f64]>,
) -> (Vec<GrainRow>, Vec<ContactRow>) {
    let problem = &frozen.problem;
    let decomposition = Decomposition::new(problem, partition);
    let most_contacts = subdomain_of_grains(frozen, partition);
    let grains = (0..problem.grain_count())
        .map(|grain| GrainRow {
            problem: frozen.name.clone(),
            partition: name.to_owned(),
            grain: grain as u32,
            x_m: problem.position()[grain].x,
            y_m: problem.position()[grain].y,
            radius_m: frozen.radius[grain],
            subdomain: most_contacts[grain],
            multiplicity: decomposition.multiplicity[grain],
        })
        .collect();
    let contacts = (0..problem.contact_count())
        .map(|contact| {
            let (from, to) = ends(frozen, contact);
            ContactRow {
                problem: frozen.name.clone(),
                partition: name.to_owned(),
                contact: contact as u32,
                x0_m: from.x,
                y0_m: from.y,
                x1_m: to.x,
                y1_m: to.y,
                wall: problem.contacts()[contact].antagonist.is_none(),
                subdomain: partition.subdomain[contact],
                impulse_n_s: impulses.map_or(f64::NAN, |r| r[contact]),
            }
        })
        .collect();
    (grains, contacts)
}

/// Centre of the candidate, and centre of the antagonist or the touched point of a wall (m).
fn ends(frozen: &Frozen, contact: usize) -> (Vector2<f64>, Vector2<f64>) {
    let (position, gap) = (frozen.problem.position(), frozen.gap[contact]);
    let contact = &frozen.problem.contacts()[contact];
    let from = position[contact.candidate as usize];
    let to_wall = frozen.radius[contact.candidate as usize] + gap;
    (from, contact.antagonist.map_or(from - contact.normal * to_wall, |j| position[j as usize]))
}

/// The subdomain with most of each grain's contacts, the first among equals.
fn subdomain_of_grains(frozen: &Frozen, partition: &Partition) -> Vec<Option<u32>> {
    let adjacency = Adjacency::of(&frozen.problem);
    let most = |grain: usize| {
        let subdomains =
            || adjacency.around(grain).iter().map(|contact| partition.subdomain[*contact as usize]);
        let count = |e: u32| subdomains().filter(|other| *other == e).count();
        subdomains().max_by_key(|e| (count(*e), std::cmp::Reverse(*e)))
    };
    (0..adjacency.grain_count()).map(most).collect()
}

/// A setting of a variant, where its method has one of that name and type.
pub(crate) fn setting<T: DeserializeOwned>(variant: &Variant, key: &str) -> Option<T> {
    variant.method.settings.get(key).and_then(|value| T::deserialize(value).ok())
}
