//! What the tests share: problems, and runs that are watched iterate by iterate.

use analysis::Meter;
use cases::{Case, Frozen, March, Marched};
use contact::{Contact, Iteration, Packing, Solver};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn cases_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
}

/// Names of the frozen packings.
pub(crate) const PACKINGS: [&str; 5] = [
    "settled-991",
    "shear-box-991-rest",
    "shear-box-991-onset",
    "shear-box-991-sheared",
    "lmgc90-shear-991-t1",
];

/// The path of a file among the frozen problems.
pub(crate) fn frozen_path(file: &str) -> PathBuf {
    cases_folder().join("frozen").join(file)
}

/// A frozen problem by name.
pub(crate) fn frozen(name: &str) -> Frozen {
    Frozen::read(&frozen_path(&format!("{name}.json"))).unwrap_or_else(|error| panic!("{error}"))
}

/// A frozen packing of any mechanics by name.
pub(crate) fn packing<M: Marched>(name: &str) -> Packing<M> {
    packing_at(&frozen_path(&format!("{name}.json")))
}

/// A packing of the collection by its id.
pub(crate) fn collected<M: Marched>(id: &str) -> Packing<M> {
    packing_at(&cases_folder().join("collection/problems").join(format!("{id}.json.gz")))
}

fn packing_at<M: Marched>(path: &Path) -> Packing<M> {
    let frozen: Frozen<M> = Frozen::read(path).unwrap_or_else(|error| panic!("{error}"));
    frozen.problem
}

/// The first contact problem of a case without friction, with some of its values replaced.
pub(crate) fn first_problem(case: &str, overrides: &[(&str, &str)]) -> Frozen {
    first_problem_of(case, overrides)
}

/// The same in the mechanics that is asked for.
pub(crate) fn first_problem_of<M: Marched>(case: &str, overrides: &[(&str, &str)]) -> Frozen<M> {
    let path = cases_folder().join(case).with_extension("toml");
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    let case = Case::read(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let step = March::new(&case).and_then(|march| march.next());
    step.unwrap_or_else(|error| panic!("{error}")).frozen
}

/// Starts `solver` on `problem` from r = 0.
pub(crate) fn start<'p>(solver: &dyn Solver, problem: &'p Packing) -> Box<dyn Iteration + 'p> {
    let r0 = vec![0.0; problem.contact_count()];
    solver.start(problem, &r0).unwrap_or_else(|error| panic!("{error}"))
}

/// The impulses of an iteration (N·s).
pub(crate) fn impulses(iteration: &dyn Iteration, problem: &Packing) -> Vec<f64> {
    let mut r = vec![f64::NAN; problem.contact_count()];
    iteration.impulses(&mut r);
    r
}

/// q(r) of every iterate from the start to `iterations` (J).
pub(crate) fn energies(solver: &dyn Solver, problem: &Packing, iterations: u64) -> Vec<f64> {
    let mut iteration = start(solver, problem);
    let mut meter = Meter::new(problem);
    (0..=iterations)
        .map(|k| {
            if k > 0 {
                iteration.advance();
            }
            meter.measure(&impulses(&*iteration, problem), 0.0).energy
        })
        .collect()
}

/// Round-off of q relative to its greatest size: sums of a few thousand terms of either sign (–).
const ROUND_OFF: f64 = 1e-12;

/// Asserts that each value is no more than the one before, round-off apart.
#[track_caller]
pub(crate) fn assert_never_increases(energies: &[f64], what: &str) {
    let scale = energies.iter().fold(0.0_f64, |scale, q| scale.max(q.abs()));
    for (k, pair) in energies.windows(2).enumerate() {
        let bound = pair[0] + ROUND_OFF * scale;
        assert!(
            pair[1] <= bound,
            "{what}: q goes from {:e} to {:e} in iteration {}",
            pair[0],
            pair[1],
            k + 1
        );
    }
}

/// Greatest |a − b| over greatest |a| (–).
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let scale = greatest(&mut a.iter().map(|a| a.abs()));
    greatest(&mut a.iter().zip(b).map(|(a, b)| (a - b).abs())) / scale.max(f64::MIN_POSITIVE)
}

/// A contact of one of so many grains with another one or a wall, with any normal.
pub(crate) fn any_contact(grains: u32) -> impl Strategy<Value = Contact> {
    (0..grains, 0..=grains, 0.0..std::f64::consts::TAU, -1.0..1.0_f64).prop_map(
        move |(candidate, other, angle, offset)| Contact {
            candidate,
            antagonist: (other < grains && other != candidate).then_some(other),
            normal: Vector2::new(angle.cos(), angle.sin()),
            offset,
        },
    )
}

/// Problems of up to 30 grains and 60 contacts in no order that a scene would give: masses over four decades, any
/// normals, several contacts on a pair, walls anywhere.
pub(crate) fn any_problem() -> impl Strategy<Value = Packing> {
    (2..30_u32, 1..60_usize).prop_flat_map(|(grains, contacts)| {
        let vector = |size: f64| (-size..size, -size..size).prop_map(|(x, y)| Vector2::new(x, y));
        let n = grains as usize;
        let masses = prop::collection::vec((-2.0..2.0_f64).prop_map(|exponent| 10_f64.powf(exponent)), n);
        let positions = prop::collection::vec(vector(10.0), n);
        let velocities = prop::collection::vec(vector(1.0), n);
        let contact = any_contact(grains);
        (masses, positions, velocities, prop::collection::vec(contact, contacts)).prop_map(
            |(masses, positions, velocities, contacts)| {
                Packing::new(masses, positions, velocities, contacts)
                    .unwrap_or_else(|error| panic!("{error}"))
            },
        )
    })
}
