//! From what the harness holds to the rows of the results.

use crate::plan::{Plan, Variant};
use crate::problems::{Known, Problem};
use crate::root::Root;
use crate::run::{Seen, Task, first_at};
use anyhow::Result;
use cases::Side;
use contact::{Measure, Work};
use lineup::{OneProblem, Posed, Settings, Touching};
use partition::{Grid, Partition, Scheme};
use results::contacts::{Body, ContactForce, ContactStatus};
use results::name::StopOn;
use results::schema::{ContactRow, End, Ending, GrainRow, Provenance, Run, Sample};
use runner::{Outcome, Status};

/// The row of what another code answered, if that lies beside the problem: measured as ours are, with nothing run.
pub(crate) fn given_row(
    plan: &Plan,
    problem: &Problem,
    root: &Root,
    provenance: Provenance,
) -> Result<Option<Run>> {
    let (Some(given), Posed::Grains(posed)) = (&problem.given, &problem.posed) else { return Ok(None) };
    let known = problem.known(root)?;
    let measures = posed.measures(&known.impulses, &given.impulse);
    Ok(Some(Run {
        method: "given".to_owned(),
        variant: given.from.clone(),
        status: Ending::Given,
        end: End { measures, work: Work::default() },
        ..nothing_done(plan, problem, known, provenance)
    }))
}

/// The row of a run that has reached nothing yet.
fn nothing_done(plan: &Plan, problem: &Problem, known: &Known, provenance: Provenance) -> Run {
    let facts = problem.posed.facts();
    Run {
        plan: plan.name.clone(),
        problem: problem.name.clone(),
        problem_hash: problem.hash.clone(),
        problem_settings: problem.settings.clone(),
        known: known.solutions(&problem.posed),
        grains: facts.grains as u32,
        contacts: facts.contacts as u32,
        subdomains: 1,
        stop_on: StopOn(plan.stop.on),
        tolerance: plan.stop.tolerance,
        max_iterations: plan.stop.max_iterations,
        setup_s: f64::NAN,
        iterating_s: f64::NAN,
        last_change_moves: f64::NAN,
        provenance,
        ..Run::default()
    }
}

/// The row of a run that was skipped, if it is not run.
pub(crate) fn skipped_row(plan: &Plan, task: &Task<&Problem>, known: &Known, provenance: Provenance) -> Run {
    let Task { id, variant, what: problem, .. } = task;
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
        status: Ending::Skipped,
        ..nothing_done(plan, problem, known, provenance)
    }
}

/// The row with what the run reached.
pub(crate) fn ended_row(row: Run, outcome: &Outcome, curve: &[Sample]) -> Run {
    let first = |measure: Measure, tolerance| first_at(curve, measure, tolerance);
    let Sample { measures, work, .. } = curve[curve.len() - 1];
    Run {
        derived: derived(outcome),
        status: ending(outcome.status),
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

/// Returns the ending of a run that nobody interrupted.
fn ending(status: Status) -> Ending {
    match status {
        Status::Converged => Ending::Converged,
        Status::FalseConvergence => Ending::FalseConvergence,
        Status::IterationLimit => Ending::IterationLimit,
        Status::Stalled => Ending::Stalled,
        Status::Diverged => Ending::Diverged,
        Status::Infeasible => Ending::Infeasible,
        Status::Interrupted => unreachable!("a run that was interrupted has no row"),
    }
}

/// Returns the values that a method derived where its settings leave them open, and the critical path where there is one.
pub(crate) fn derived(outcome: &Outcome) -> Settings {
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
pub(crate) fn scene_rows(
    (name, problem): (&str, &dyn OneProblem),
    partitions: &[(String, Grid, Scheme)],
    impulses: Option<&[f64]>,
) -> (Vec<GrainRow>, Vec<ContactRow>) {
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    let (places, radii, touching) = (problem.places(), problem.radii(), problem.touching());
    let of_contact = problem.facts().of_contact;
    for (of, grid, scheme) in partitions {
        let Ok((partition, decomposition)) = problem.cut(*grid, *scheme) else { continue };
        let subdomains = subdomain_of_grains(places.len(), &touching, &partition);
        grains.extend(places.iter().enumerate().map(|(grain, [x_m, y_m, z_m])| GrainRow {
            problem: name.to_owned(),
            partition: of.clone(),
            grain: grain as u32,
            x_m: *x_m,
            y_m: *y_m,
            z_m: *z_m,
            radius_m: radii[grain],
            subdomain: subdomains[grain],
            multiplicity: decomposition.multiplicity[grain],
        }));
        contacts.extend(touching.iter().enumerate().map(|(contact, touching)| {
            let [[x0_m, y0_m, z0_m], [x1_m, y1_m, z1_m]] = ends(touching, &places, radii);
            ContactRow {
                problem: name.to_owned(),
                partition: of.clone(),
                contact: contact as u32,
                x0_m,
                y0_m,
                z0_m,
                x1_m,
                y1_m,
                z1_m,
                wall: touching.antagonist.is_none(),
                subdomain: partition.subdomain[contact],
                impulse_n_s: impulses.map_or(f64::NAN, |r| r[of_contact * contact]),
            }
        }));
    }
    (grains, contacts)
}

/// Centre of the candidate, and centre of the antagonist; where there is none, or its centre is not where the normal leads, through a
/// periodic side or on a lid, the touched point (m).
fn ends(contact: &Touching, places: &[[f64; 3]], radii: &[f64]) -> [[f64; 3]; 2] {
    let Touching { candidate, antagonist, normal, gap, .. } = contact;
    let from = places[*candidate as usize];
    let reach = radii[*candidate as usize] + gap;
    let touched = [0, 1, 2].map(|k| from[k] - normal[k] * reach);
    let is_along = |there: &[f64; 3]| {
        let between = [0, 1, 2].map(|k| from[k] - there[k]);
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        dot(&between, normal) >= 0.99 * dot(&between, &between).sqrt()
    };
    [from, antagonist.map(|j| places[j as usize]).filter(is_along).unwrap_or(touched)]
}

/// The subdomain with most of each grain's contacts, the first among equals.
pub(super) fn subdomain_of_grains(
    grains: usize,
    touching: &[Touching],
    partition: &Partition,
) -> Vec<Option<u32>> {
    let mut around = vec![Vec::new(); grains];
    for (contact, subdomain) in touching.iter().zip(&partition.subdomain) {
        for grain in [Some(contact.candidate), contact.antagonist].into_iter().flatten() {
            around[grain as usize].push(*subdomain);
        }
    }
    let most = |subdomains: &Vec<u32>| {
        let count = |e: u32| subdomains.iter().filter(|other| **other == e).count();
        subdomains.iter().copied().max_by_key(|e| (count(*e), std::cmp::Reverse(*e)))
    };
    around.iter().map(most).collect()
}

/// Returns the contacts of a time step of a simulation.
pub(crate) fn contact_forces(seen: &Seen) -> Vec<ContactForce> {
    let (problem, r) = (seen.problem, &seen.outcome.impulses[..]);
    let (places, radii, of_contact) = (problem.places(), problem.radii(), problem.facts().of_contact);
    let (tangential, statuses) = (problem.tangential(r), problem.statuses(r));
    let row = |(k, ((contact, side), impulse)): (usize, ((Touching, &Side), [f64; 3]))| {
        let Touching { candidate, antagonist, normal, gap, friction } = contact;
        let (place, radius) = (places[candidate as usize], radii[candidate as usize]);
        let [x_m, y_m, z_m] = [0, 1, 2].map(|axis| place[axis] - radius * normal[axis]);
        let [normal_x, normal_y, normal_z] = normal;
        let [impulse_x_n_s, impulse_y_n_s, impulse_z_n_s] = impulse;
        let (body, segment) = Body::of(*side);
        let normal_impulse_n_s = r[of_contact * k];
        let status = match statuses.as_ref().map(|statuses| statuses[k]) {
            None if normal_impulse_n_s > 0.0 => ContactStatus::Closed,
            None | Some(0) => ContactStatus::Open,
            Some(1) => ContactStatus::Sticks,
            Some(_) => ContactStatus::Slides,
        };
        ContactForce {
            time_step: seen.march.time_steps(),
            time_s: seen.march.time(),
            candidate,
            antagonist,
            body,
            segment,
            x_m,
            y_m,
            z_m,
            normal_x,
            normal_y,
            normal_z,
            gap_m: gap,
            friction,
            normal_impulse_n_s,
            tangential_impulse_n_s: tangential.as_ref().map_or(0.0, |along| along[k]),
            impulse_x_n_s,
            impulse_y_n_s,
            impulse_z_n_s,
            status,
        }
    };
    let contacts = problem.touching().into_iter().zip(seen.sides).zip(problem.on_candidates(r));
    contacts.enumerate().map(row).collect()
}
