//! From what the harness holds to the rows of the results.

use crate::plan::{Plan, Variant};
use crate::problems::{Given, Known, Problem, Studied};
use crate::run::{OneProblem, Task, first_at};
use analysis::Meter;
use cases::Frozen;
use contact::{Adjacency, Measure, Mechanics, Place, Touch, Vector, Work};
use partition::{Decomposition, Grid, Partition, Scheme};
use results::schema::{ContactRow, End, GrainRow, Provenance, Run, Sample};
use runner::Outcome;
use serde_json::{Map, Value};

/// The row of impulses that another code gave: measured as ours are, with nothing run.
pub(crate) fn given_row<M: Studied>(
    plan: &Plan,
    problem: &Problem<M>,
    given: &Given,
    known: &Known<M>,
    provenance: Provenance,
) -> Run {
    let meter = Meter::new(&problem.frozen.problem);
    let mut meter = known.truths().iter().fold(meter, Meter::against);
    let measures = meter.measure_after(&[], &given.impulse, 0.0);
    Run {
        method: "given".to_owned(),
        variant: given.from.clone(),
        status: "given".to_owned(),
        end: End { measures, work: Work::default() },
        ..nothing_done(plan, problem, known, provenance)
    }
}

/// The row of a run that has reached nothing yet.
pub(crate) fn nothing_done<M: Studied>(
    plan: &Plan,
    problem: &Problem<M>,
    known: &Known<M>,
    provenance: Provenance,
) -> Run {
    Run {
        known: known.solutions(&problem.frozen.problem),
        grains: problem.frozen.problem.grain_count() as u32,
        contacts: problem.frozen.problem.contact_count() as u32,
        ..asked(plan, problem, provenance)
    }
}

/// The row with the task that asks for it; skipped, as long as nothing else is said.
pub(crate) fn of_task<W>(task: &Task<W>, row: Run) -> Run {
    let Task { id, variant, .. } = task;
    Run {
        id: id.clone(),
        method: variant.method.name.to_owned(),
        settings: variant.method.settings.clone(),
        variant: variant.name.clone(),
        // A grid may have more subdomains than the column counts; every method refuses it, and its row stays.
        subdomains: variant
            .method
            .partition()
            .map_or(1, |(grid, _)| u32::try_from(grid.count()).unwrap_or(u32::MAX)),
        warm_start: variant.warm_start,
        status: "skipped".to_owned(),
        ..row
    }
}

/// Returns the row of a run with the request alone: plan, problem and stop rule.
pub(crate) fn asked(plan: &Plan, problem: &dyn OneProblem, provenance: Provenance) -> Run {
    Run {
        plan: plan.name.clone(),
        problem: problem.name().to_owned(),
        problem_hash: problem.hash().to_owned(),
        problem_settings: problem.settings().clone(),
        subdomains: 1,
        stop_on: plan.stop.on.name().to_owned(),
        tolerance: plan.stop.tolerance,
        max_iterations: plan.stop.max_iterations,
        setup_s: f64::NAN,
        iterating_s: f64::NAN,
        last_change_moves: f64::NAN,
        provenance,
        ..Run::default()
    }
}

/// The row with what the run reached.
pub(crate) fn ended_row<M: Mechanics>(row: Run, outcome: &Outcome<M>, curve: &[Sample]) -> Run {
    let first = |measure: Measure, tolerance| first_at(curve, measure, tolerance);
    let Sample { measures, work, .. } = curve[curve.len() - 1];
    Run {
        derived: derived(outcome),
        status: outcome.status.name().to_owned(),
        iterations: outcome.iterations,
        setup_s: outcome.setup.as_secs_f64(),
        iterating_s: outcome.iterating.as_secs_f64(),
        iterations_to_zeta_1e_3: first(Measure::Zeta, 1e-3),
        iterations_to_zeta_1e_4: first(Measure::Zeta, 1e-4),
        iterations_to_natural_map_1e_2: first(Measure::NaturalMap, 1e-2),
        iterations_to_natural_map_1e_4: first(Measure::NaturalMap, 1e-4),
        iterations_to_velocity_error_1e_2: first(Measure::VelocityError, 1e-2),
        iterations_to_velocity_error_1e_4: first(Measure::VelocityError, 1e-4),
        last_change_moves: outcome.last_change_moves,
        cycle_iterations: outcome.cycle,
        end: End { measures, work },
        ..row
    }
}

/// Returns the values that a method derived where its settings leave them open, and the critical path where there is one.
pub(crate) fn derived<M: Mechanics>(outcome: &Outcome<M>) -> Map<String, Value> {
    let critical_path = outcome.critical_path.map(|path| ("critical_path", path as f64));
    let all = outcome.derived.iter().copied().chain(critical_path);
    all.map(|(key, value)| (key.to_owned(), value.into())).collect()
}

/// The partitions that the methods of a plan use, by name, each once.
pub(crate) fn partitions(variants: &[Variant]) -> Vec<(String, Grid, Scheme)> {
    let mut partitions = Vec::new();
    for variant in variants {
        if let Some((grid, scheme)) = variant.method.partition() {
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

/// The grains and contacts of a problem under those of `partitions` that fit it, as they are drawn: a run with one that does
/// not fit was skipped.
pub(crate) fn scene_rows<M: Mechanics>(
    frozen: &Frozen<M>,
    partitions: &[(String, Grid, Scheme)],
    impulses: Option<&[f64]>,
) -> (Vec<GrainRow>, Vec<ContactRow>) {
    let problem = &frozen.problem;
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    let place = |grain: usize| problem.position()[grain].space();
    for (name, grid, scheme) in partitions {
        let Ok(partition) = Partition::of_contacts(problem, *scheme, *grid) else { continue };
        let decomposition = Decomposition::new(problem, &partition);
        let most_contacts = subdomain_of_grains(frozen, &partition);
        grains.extend((0..problem.grain_count()).map(|grain| GrainRow {
            problem: frozen.name.clone(),
            partition: name.clone(),
            grain: grain as u32,
            x_m: place(grain)[0],
            y_m: place(grain)[1],
            z_m: place(grain)[2],
            radius_m: frozen.radius[grain],
            subdomain: most_contacts[grain],
            multiplicity: decomposition.multiplicity[grain],
        }));
        contacts.extend((0..problem.contact_count()).map(|contact| {
            let [from, to] = ends(frozen, contact).map(Place::space);
            ContactRow {
                problem: frozen.name.clone(),
                partition: name.clone(),
                contact: contact as u32,
                x0_m: from[0],
                y0_m: from[1],
                z0_m: from[2],
                x1_m: to[0],
                y1_m: to[1],
                z1_m: to[2],
                wall: problem.contacts()[contact].ends().1.is_none(),
                subdomain: partition.subdomain[contact],
                impulse_n_s: impulses.map_or(f64::NAN, |r| M::Impulse::at(r, contact).first()),
            }
        }));
    }
    (grains, contacts)
}

/// Centre of the candidate, and centre of the antagonist; where there is none, or its centre is not where the normal leads, through a
/// periodic side or on a lid, the touched point (m).
fn ends<M: Mechanics>(frozen: &Frozen<M>, contact: usize) -> [M::Place; 2] {
    let (position, gap) = (frozen.problem.position(), frozen.gap[contact]);
    let contact = &frozen.problem.contacts()[contact];
    let (candidate, antagonist) = contact.ends();
    let from = position[candidate as usize];
    let touched = from - contact.normal() * (frozen.radius[candidate as usize] + gap);
    let is_along = |there: &M::Place| {
        let between = from - *there;
        between.dot_product(contact.normal()) >= 0.99 * between.length()
    };
    [from, antagonist.map(|j| position[j as usize]).filter(is_along).unwrap_or(touched)]
}

/// The subdomain with most of each grain's contacts, the first among equals.
pub(super) fn subdomain_of_grains<M: Mechanics>(
    frozen: &Frozen<M>,
    partition: &Partition,
) -> Vec<Option<u32>> {
    let adjacency = Adjacency::of(&frozen.problem);
    let most = |grain: usize| {
        let subdomains =
            || adjacency.around(grain).iter().map(|contact| partition.subdomain[*contact as usize]);
        let count = |e: u32| subdomains().filter(|other| *other == e).count();
        subdomains().max_by_key(|e| (count(*e), std::cmp::Reverse(*e)))
    };
    (0..adjacency.grain_count()).map(most).collect()
}
