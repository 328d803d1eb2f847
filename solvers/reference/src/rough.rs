//! Solutions of problems with friction: certified by what they leave of the law, and several, since neither impulses nor
//! velocities are unique.

use crate::certificate::{Residual, TERMS, worst};
use active_set::{ActiveSet, Start};
use contact::{
    ContactProblem, Mechanics, Packing, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Solver, Touch,
    Truth, Vector, greatest, law,
};
use nalgebra::{Vector2, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::fmt;
use std::ops::RangeInclusive;

/// What impulses r leave of (1) and Coulomb's law, computed from r and the problem alone. The scales are those of the certificate
/// without friction: the fastest approach without impulses, and the impulse that stops one contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoughCertificate {
    /// Greatest max(0, −`v_n`) (m/s).
    pub approach: Residual,
    /// Greatest max(0, −`r_n`) (N·s).
    pub pull: Residual,
    /// Greatest max(0, |`r_t`| − μ `r_n`): how far outside the cone (N·s).
    pub cone: Residual,
    /// Greatest |min(`w_n` `r_n`, `v_n`)| (m/s).
    pub complementarity: Residual,
    /// Greatest `w_t` |`r_t` − clip(`r_t` − `v_t`/`w_t`, μ `r_n`)|: what sticks and moves, or slides against too little (m/s).
    pub sliding: Residual,
    /// Greatest component of M (V − `V_free`) − H r, moments over the arms (N·s).
    pub momentum: Residual,
    /// √(Σ `W_αα` |r − r⁺|²) over √(Σ max(0, −`b_n`)²/`w_n`): all that is left, weighed as energy (√J).
    pub natural_map: Residual,
}

/// What a certified solution may leave of each (–).
const ROUND_OFF: f64 = 1e-12;

impl RoughCertificate {
    /// Names and residuals.
    pub fn residuals(&self) -> [(&'static str, Residual); 7] {
        [
            ("approach", self.approach),
            ("pull", self.pull),
            ("cone", self.cone),
            ("complementarity", self.complementarity),
            ("sliding", self.sliding),
            ("momentum", self.momentum),
            ("natural_map", self.natural_map),
        ]
    }

    /// Whether every one is at most 1e-12.
    pub fn certified(&self) -> bool {
        self.worst() <= ROUND_OFF
    }

    /// The greatest relative residual (–); NaN if one is.
    pub fn worst(&self) -> f64 {
        greatest(self.residuals().into_iter().map(|(_, left)| left.relative))
    }
}

impl fmt::Display for RoughCertificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.certified() { "certified" } else { "not certified" })?;
        for (name, residual) in self.residuals() {
            write!(f, ", {name} {:.1e}", residual.relative)?;
        }
        Ok(())
    }
}

/// A mechanics with Coulomb's law, whose solutions are certified.
pub trait Rough: Mechanics<Mass = RoughMass> {
    /// Translation and spin of a velocity (m/s, rad/s), or of a resultant (N·s, N·m·s).
    fn parts(velocity: &Self::Velocity) -> (&[f64], &[f64]);

    /// `R_i` and `R_j` (m), and μ (–).
    fn law(contact: &Self::Contact) -> (Vector2<f64>, f64);
}

impl Rough for RoughDiscs {
    fn parts(velocity: &Vector3<f64>) -> (&[f64], &[f64]) {
        velocity.as_slice().split_at(2)
    }

    fn law(contact: &RoughContact) -> (Vector2<f64>, f64) {
        (contact.arms, contact.friction)
    }
}

impl Rough for RoughSpheres {
    fn parts(velocity: &Vector6<f64>) -> (&[f64], &[f64]) {
        velocity.as_slice().split_at(3)
    }

    fn law(contact: &RoughContact<3>) -> (Vector2<f64>, f64) {
        (contact.arms, contact.friction)
    }
}

/// The greatest size of some numbers.
fn amax<'x>(numbers: impl IntoIterator<Item = &'x f64>) -> f64 {
    greatest(numbers.into_iter().map(|x| x.abs()))
}

/// The greatest size of a component.
fn greatest_of<V: Vector>(list: V) -> f64 {
    let mut found = 0.0;
    list.each(&mut |x| found = greatest([found, x.abs()].into_iter()));
    found
}

/// The size of all components but the first, the normal one.
fn tangential<V: Vector>(list: V) -> f64 {
    let (mut squares, mut is_first) = (0.0, true);
    list.each(&mut |x| {
        squares += if is_first { 0.0 } else { x * x };
        is_first = false;
    });
    f64::sqrt(squares)
}

/// The certificate of impulses `r` (N·s), a flat list.
///
/// # Panics
/// If there are not as many numbers per contact as it has unknowns.
pub fn certify_rough<M: Rough>(problem: &ContactProblem<M>, r: &[f64]) -> RoughCertificate {
    assert_eq!(r.len(), problem.impulse_count(), "two numbers per contact, or three");
    let (b, w) = (problem.b(), problem.delassus_diagonal());
    let none = vec![M::Velocity::ZERO; problem.grain_count()];
    let (mut velocity, mut resultant, mut v) = (none.clone(), none, vec![0.0; r.len()]);
    problem.velocity(r, &mut velocity);
    problem.resultant(r, &mut resultant);
    problem.relative_velocity(&velocity, &mut v);
    let approaches = || b.iter().zip(&w).step_by(M::Impulse::LEN).map(|(b, w)| (law::non_negative(-b), w));
    let (speed, impulse) =
        (greatest(approaches().map(|(b, _)| b)), greatest(approaches().map(|(b, w)| b / w)));
    // The terms that V and v are sums of: a residual may be 1/256 of 1e-12 of these, sixteen units of their last digits.
    let (mut pushes, mut arms) = (vec![0.0; velocity.len()], vec![f64::INFINITY; velocity.len()]);
    for (k, contact) in problem.contacts().iter().enumerate() {
        let own = M::Impulse::at(r, k);
        for (grain, arm) in contact.grains().zip(M::law(contact).0.iter()) {
            pushes[grain as usize] += own.dot_product(own).sqrt();
            arms[grain as usize] = arm.min(arms[grain as usize]);
        }
    }
    let (free, mass) = (problem.free_velocity(), problem.mass());
    let speed_of = |velocity: &M::Velocity| amax(M::parts(velocity).0);
    let of_velocity = |grain: u32| {
        let k = grain as usize;
        pushes[k] / mass[k].mass + speed_of(&free[k])
    };
    let speeds = |contact: &M::Contact| {
        let terms = greatest_of(contact.offset()) + contact.grains().map(of_velocity).sum::<f64>();
        speed.max(TERMS * terms)
    };
    let momentum = (0..velocity.len()).map(|k| {
        let terms = mass[k].mass * (speed_of(&velocity[k]) + speed_of(&free[k])) + pushes[k];
        let change = velocity[k] - free[k];
        let ((translation, spin), (pushed, turned)) = (M::parts(&change), M::parts(&resultant[k]));
        let left = |inertia: f64, (change, pushed): (&f64, &f64)| (change * inertia - pushed).abs();
        let pushing = translation.iter().zip(pushed).map(|at| left(mass[k].mass, at));
        let turning = spin.iter().zip(turned).map(|at| left(mass[k].inertia, at) / arms[k]);
        Residual::new(greatest(pushing.chain(turning)), impulse.max(TERMS * terms))
    });
    let contacts = || {
        let at = |(k, contact)| (contact, M::Impulse::at(r, k), M::Impulse::at(&v, k), M::Impulse::at(&w, k));
        problem.contacts().iter().enumerate().map(at)
    };
    // W_αα (r − r⁺)
    let left = |(contact, r, v, w): (&M::Contact, M::Impulse, M::Impulse, M::Impulse)| {
        (r - contact.admissible(r, v, w)).with(w, |left, w| left * w)
    };
    let squares =
        contacts().map(|at| left(at).with(at.3, |left, w| left / w).dot_product(left(at))).sum::<f64>();
    RoughCertificate {
        approach: worst(contacts().map(|at| Residual::new(law::non_negative(-at.2.first()), speeds(at.0)))),
        pull: worst(contacts().map(|at| Residual::new(law::non_negative(-at.1.first()), impulse))),
        cone: worst(contacts().map(|(contact, r, ..)| {
            let bound = M::law(contact).1 * law::non_negative(r.first());
            Residual::new(law::non_negative(tangential(r) - bound), impulse.max(TERMS * bound))
        })),
        complementarity: worst(contacts().map(|at| Residual::new(left(at).first().abs(), speeds(at.0)))),
        sliding: worst(contacts().map(|at| Residual::new(tangential(left(at)), speeds(at.0)))),
        momentum: worst(momentum),
        natural_map: Residual::new(squares.sqrt(), problem.scale().sqrt()),
    }
}

/// A certified solution of a problem with friction, one of some.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughSolution {
    /// [`r_n`, `r_t`] of each contact, in space [`r_n`, `r_t1`, `r_t2`], a flat list (N·s).
    pub impulses: Vec<f64>,
    /// Their certificate.
    pub certificate: RoughCertificate,
}

/// Two solutions are the same if their velocities differ by less than this, over what the impulses change of them (–).
const SAME: f64 = 1e-8;

/// Iterations of a try to find a solution.
const MANY: u32 = 300_000;

/// Solutions of `problem` that are different, from these `starts`: 0 is r = 0, of the others each is a seed of impulses within the
/// cones, of up to twice the size that the problem's scale suggests. If none is certified, the impulses that leave least.
pub fn solve_rough<M: Rough>(
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
        take(problem, &mut solutions, from(problem, &start));
        seen();
    }
    solutions
}

/// Adds a solution that is not among them; one that is certified drives out one that is not.
pub fn take<M: Rough>(problem: &Packing<M>, solutions: &mut Vec<RoughSolution>, found: RoughSolution) {
    let certified = found.certificate.certified();
    match solutions.first() {
        Some(best) if !best.certificate.certified() => {
            if certified || found.certificate.worst() < best.certificate.worst() {
                *solutions = vec![found];
            }
        }
        Some(_) => {
            let is_known =
                |known: &RoughSolution| is_same(distance(problem, &known.impulses, &found.impulses));
            if certified && !solutions.iter().any(is_known) {
                solutions.push(found);
            }
        }
        None => solutions.push(found),
    }
}

/// Whether two solutions so far apart (–), see [`distance`], are one.
pub fn is_same(distance: f64) -> bool {
    distance <= SAME
}

/// Iterations of a polish: near enough, Newton's method ends in two or three.
const POLISH: u32 = 8;

/// The certified solution to which Newton's method leads from the impulses `r` (N·s) at which a run ended, if it does. It may be far
/// from them.
pub fn polished<M: Rough>(problem: &Packing<M>, r: &[f64]) -> Option<RoughSolution>
where
    ActiveSet: Solver<M>,
{
    let method = ActiveSet { start: Start::ColdSet, ..ActiveSet::default() };
    let mut newton = Solver::<M>::start(&method, problem, r).ok()?;
    let mut impulses = r.to_vec();
    for _ in 0..POLISH {
        newton.advance();
        newton.impulses(&mut impulses);
        let certificate = certify_rough(problem, &impulses);
        if certificate.certified() {
            return Some(RoughSolution { impulses, certificate });
        }
    }
    None
}

/// ‖V − V′‖_M of two impulses over ‖V − `V_free`‖_M of the first (–).
pub fn distance<M: Rough>(problem: &ContactProblem<M>, r: &[f64], other: &[f64]) -> f64 {
    let (one, other) = (Truth::new(problem, r), Truth::new(problem, other));
    let size = problem.velocity_distance(one.velocity(), problem.free_velocity());
    let apart = problem.velocity_distance(one.velocity(), other.velocity());
    if apart == 0.0 { 0.0 } else { apart / size }
}

/// Where the active set ends that begins from impulses `r0` with conjugate gradients.
fn from<M: Rough>(problem: &Packing<M>, r0: &[f64]) -> RoughSolution
where
    ActiveSet: Solver<M>,
{
    let mut impulses = r0.to_vec();
    let method = ActiveSet { warm: false, ..ActiveSet::default() };
    if let Ok(mut run) = Solver::<M>::start(&method, problem, r0) {
        for _ in 0..MANY {
            if run.stalled() {
                break;
            }
            run.advance();
        }
        run.impulses(&mut impulses);
    }
    RoughSolution { certificate: certify_rough(problem, &impulses), impulses }
}

/// Impulses within the cones, the same for the same seed.
fn drawn<M: Rough>(problem: &Packing<M>, seed: u64) -> Vec<f64> {
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
        r.extend(point.iter().map(|x| M::law(contact).1 * normal * x));
    }
    r
}
