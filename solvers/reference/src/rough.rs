//! Solutions of problems with friction: certified by what they leave of the law, and several, since neither impulses nor
//! velocities are unique.

use crate::certificate::{Certificate, Certified, certify};
use crate::{Answer, Existence, Isolation, existence, isolation, solve};
use active_set::{ActiveSet, Start};
use analysis::proves_infeasible;
use contact::{
    ContactProblem, Frictional, Mechanics, Packing, Rough, RoughContact, RoughMass, Smooth, Solver, Touch,
    Truth, Vector, greatest, law,
};
use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::RangeInclusive;

/// A mechanics with friction whose problems may be proved to have a solution, or none.
pub trait Provable: Certified<Mass = RoughMass> {
    /// Returns normal impulses (N·s) that prove that `problem` has no solution: where no velocity keeps the contacts from approaching,
    /// friction does not help. `None` says nothing.
    fn ray(problem: &Packing<Self>) -> Option<Vec<f64>>;

    /// Reports whether normal impulses (N·s) prove that `problem` has no solution.
    fn proves_infeasible(problem: &Packing<Self>, ray: &[f64]) -> bool;

    /// Returns the reason why `problem` is known to have a solution: [`existence`].
    fn existence(problem: &Packing<Self>) -> Option<Existence>;

    /// Returns the isolation of a solution `r` (N·s) from others: [`isolation`].
    fn isolation(problem: &Packing<Self>, r: &[f64]) -> Isolation;

    /// Returns `problem` with all offsets so many `times` as large, if these are numbers.
    fn with_offsets(problem: &Packing<Self>, times: f64) -> Option<Packing<Self>>;
}

impl<const D: usize, const N: usize> Provable for Rough<D>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    fn ray(problem: &Packing<Self>) -> Option<Vec<f64>> {
        ray(&problem.without_friction().ok()?, problem.position())
    }

    fn proves_infeasible(problem: &Packing<Self>, ray: &[f64]) -> bool {
        problem.without_friction().is_ok_and(|normal| proves_infeasible(&normal, ray))
    }

    fn existence(problem: &Packing<Self>) -> Option<Existence> {
        existence(problem)
    }

    fn isolation(problem: &Packing<Self>, r: &[f64]) -> Isolation {
        isolation(problem, r)
    }

    fn with_offsets(problem: &Packing<Self>, times: f64) -> Option<Packing<Self>> {
        let contact = |at: &RoughContact<D>| RoughContact { offset: at.offset * times, ..*at };
        let contacts = problem.contacts().iter().map(contact).collect();
        let (mass, position) = (problem.mass().to_vec(), problem.position().to_vec());
        Packing::new(mass, position, problem.free_velocity().to_vec(), contacts).ok()
    }
}

/// Returns impulses (N·s) that prove that a problem without friction has no solution, where it is not one that nothing moves.
fn ray<const D: usize>(
    problem: &ContactProblem<Smooth<D>>,
    position: &[SVector<f64, D>],
) -> Option<Vec<f64>> {
    if problem.contacts().iter().all(|contact| contact.offset >= 0.0) {
        return None;
    }
    let (mass, free) = (problem.mass().to_vec(), problem.free_velocity().to_vec());
    let packing = Packing::new(mass, position.to_vec(), free, problem.contacts().to_vec()).ok()?;
    match solve(&packing) {
        Answer::Infeasible { ray } => Some(ray),
        Answer::Solution { .. } | Answer::Unknown { .. } => None,
    }
}

/// A certified solution of a problem with friction, one of some.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughSolution {
    /// [`r_n`, `r_t`] of each contact, in space [`r_n`, `r_t1`, `r_t2`], a flat list (N·s).
    pub impulses: Vec<f64>,
    /// Their certificate.
    pub certificate: Certificate,
}

/// Two solutions are the same if their velocities differ by less than this, over what the impulses change of them (–).
const SAME: f64 = 1e-8;

/// Iterations of a try to find a solution.
const MANY: u32 = 300_000;

/// Solutions of `problem` that are different, from these `starts`: 0 is r = 0, of the others each is a seed of impulses within the
/// cones, of up to twice the size that the problem's scale suggests. If none is certified, the impulses that leave least.
pub fn solve_rough<M: Provable>(
    problem: &Packing<M>,
    starts: RangeInclusive<u64>,
    mut seen: impl FnMut(),
) -> Vec<RoughSolution>
where
    ActiveSet: Solver<M>,
{
    let mut solutions: Vec<RoughSolution> = Vec::new();
    for seed in starts {
        let start = if seed == 0 { vec![0.0; problem.impulse_count()] } else { drawn(problem, seed) };
        take(&mut solutions, from(problem, &start), |a, b| distance(problem, a, b));
        seen();
    }
    solutions
}

/// Adds a solution that is not among them by its [`distance`]; one that is certified drives out one that is not.
pub fn take(
    solutions: &mut Vec<RoughSolution>,
    found: RoughSolution,
    distance: impl Fn(&[f64], &[f64]) -> f64,
) {
    let certified = found.certificate.certified();
    match solutions.first() {
        Some(best) if !best.certificate.certified() => {
            if certified || found.certificate.worst() < best.certificate.worst() {
                *solutions = vec![found];
            }
        }
        Some(_) => {
            let is_known = |known: &RoughSolution| is_same(distance(&known.impulses, &found.impulses));
            if certified && !solutions.iter().any(is_known) {
                solutions.push(found);
            }
        }
        None => solutions.push(found),
    }
}

/// Reports whether two solutions so far apart (–), see [`distance`], are one.
pub fn is_same(distance: f64) -> bool {
    distance <= SAME
}

/// Iterations of a polish: near enough, Newton's method ends in two or three.
const POLISH: u32 = 8;

/// The certified solution to which Newton's method leads from the impulses `r` (N·s) at which a run ended, if it does. It may be far
/// from them.
pub fn polished<M: Provable>(problem: &Packing<M>, r: &[f64]) -> Option<RoughSolution>
where
    ActiveSet: Solver<M>,
{
    let method = ActiveSet { start: Some(Start::ColdSet), ..ActiveSet::default() };
    let mut newton = Solver::<M>::start(&method, problem, r).ok()?;
    let mut impulses = r.to_vec();
    for _ in 0..POLISH {
        newton.advance();
        newton.impulses(&mut impulses);
        let certificate = certify(problem, &impulses);
        if certificate.certified() {
            return Some(RoughSolution { impulses, certificate });
        }
    }
    None
}

/// ‖V − V′‖_M of two impulses over ‖V − `V_free`‖_M of the first (–).
pub fn distance<M: Mechanics>(problem: &ContactProblem<M>, r: &[f64], other: &[f64]) -> f64 {
    let (one, other) = (Truth::new(problem, r), Truth::new(problem, other));
    let size = problem.velocity_distance(one.velocity(), problem.free_velocity());
    let apart = problem.velocity_distance(one.velocity(), other.velocity());
    if apart == 0.0 { 0.0 } else { apart / size }
}

/// Returns the solution at which the active set ends, begun from impulses `r0` with accelerated sweeps.
fn from<M: Provable>(problem: &Packing<M>, r0: &[f64]) -> RoughSolution
where
    ActiveSet: Solver<M>,
{
    let mut impulses = r0.to_vec();
    if let Ok(mut run) = Solver::<M>::start(&ActiveSet::default(), problem, r0) {
        for _ in 0..MANY {
            if run.stalled() {
                break;
            }
            run.advance();
        }
        run.impulses(&mut impulses);
    }
    RoughSolution { certificate: certify(problem, &impulses), impulses }
}

/// Impulses within the cones, the same for the same seed.
fn drawn<M: Provable>(problem: &Packing<M>, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (b, w) = (problem.b(), problem.delassus_diagonal());
    let greatest =
        greatest(b.iter().zip(&w).step_by(M::Impulse::LEN).map(|(b, w)| law::non_negative(-b) / w));
    let mut r = Vec::with_capacity(problem.impulse_count());
    for contact in problem.contacts() {
        let normal = 2.0 * greatest * random.random::<f64>();
        r.push(normal);
        // A point of the interval, or of the disc.
        let mut along =
            || (1..M::Impulse::LEN).map(|_| 2.0 * random.random::<f64>() - 1.0).collect::<Vec<_>>();
        let mut point = along();
        while point.iter().map(|x| x * x).sum::<f64>() > 1.0 {
            point = along();
        }
        r.extend(point.iter().map(|x| contact.friction() * normal * x));
    }
    r
}
