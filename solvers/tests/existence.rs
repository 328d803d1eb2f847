//! Problems with friction that have no solution by construction, and problems that have one, in the plane and in space: what is
//! certified is a solution, and what is proved to have none has none.
//!
//! Some of each; `just fuzz` makes 10,000 and prints the table. The same seeds each time.

use active_set::ActiveSet;
use cg::Cg;
use contact::{Mechanics, Packing, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Solver, Touch, Vector};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use nsgs::Nsgs;
use proptest::prelude::ProptestConfig;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use reference::{Provable, certify, solve_rough};
use runner::{Status, Stop, solve};

/// A mechanics with friction in D dimensions.
trait Dimension<const D: usize>: Provable + Mechanics<Place = SVector<f64, D>> {
    fn contact(contact: RoughContact<D>) -> Self::Contact;

    fn velocity(translation: SVector<f64, D>, spin: [f64; 3]) -> Self::Velocity;

    fn impulse(normal: f64, tangential: [f64; 2]) -> Self::Impulse;

    /// The size of the tangential part.
    fn slip(v: Self::Impulse) -> f64;
}

impl Dimension<2> for RoughDiscs {
    fn contact(contact: RoughContact) -> Self::Contact {
        contact
    }

    fn velocity(translation: Vector2<f64>, spin: [f64; 3]) -> Vector3<f64> {
        translation.push(spin[2])
    }

    fn impulse(normal: f64, tangential: [f64; 2]) -> Vector2<f64> {
        Vector2::new(normal, tangential[0])
    }

    fn slip(v: Vector2<f64>) -> f64 {
        v.y.abs()
    }
}

impl Dimension<3> for RoughSpheres {
    fn contact(contact: RoughContact<3>) -> Self::Contact {
        contact
    }

    fn velocity(translation: Vector3<f64>, [x, y, z]: [f64; 3]) -> Vector6<f64> {
        Vector6::new(translation.x, translation.y, translation.z, x, y, z)
    }

    fn impulse(normal: f64, [first, second]: [f64; 2]) -> Vector3<f64> {
        Vector3::new(normal, first, second)
    }

    fn slip(v: Vector3<f64>) -> f64 {
        v.yz().norm()
    }
}

/// Contacts by their ends and normals, with impulses d ≥ 0 that balance (–).
struct Sketch<const D: usize> {
    grains: u32,
    contacts: Vec<(u32, Option<u32>, SVector<f64, D>, f64)>,
}

/// A number between −1 and 1.
fn any(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-1.0..1.0)
}

/// 10^x for an x between these.
fn power(random: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    10_f64.powf(random.random_range(low..high))
}

fn direction<const D: usize>(random: &mut ChaCha8Rng) -> SVector<f64, D> {
    loop {
        let x = SVector::<f64, D>::from_fn(|_, _| any(random));
        if (0.1..1.0).contains(&x.norm()) {
            return x.normalize();
        }
    }
}

fn axis<const D: usize>(k: usize) -> SVector<f64, D> {
    SVector::from_fn(|row, _| f64::from(u8::from(row == k)))
}

/// A unit vector, and others at a right angle to it and to each other.
fn frame<const D: usize>(random: &mut ChaCha8Rng) -> Vec<SVector<f64, D>> {
    let mut frame: Vec<SVector<f64, D>> = Vec::new();
    while frame.len() < D {
        let x: SVector<f64, D> = direction(random);
        let x = frame.iter().fold(x, |x, other| x - *other * other.dot(&x));
        if x.norm() > 0.3 {
            frame.push(x.normalize());
        }
    }
    frame
}

/// Two walls that face each other, as exactly as doubles do.
fn walls<const D: usize>(random: &mut ChaCha8Rng) -> Sketch<D> {
    let n = direction(random);
    Sketch { grains: 1, contacts: vec![(0, None, n, 1.0), (0, None, -n, 1.0)] }
}

/// One wall more than dimensions, all around a grain.
fn corner<const D: usize>(random: &mut ChaCha8Rng) -> Sketch<D> {
    let mut contacts = Vec::new();
    let mut pushed = SVector::<f64, D>::zeros();
    for n in frame::<D>(random) {
        let d = random.random_range(0.2..1.0);
        pushed += n * d;
        contacts.push((0, None, n, d));
    }
    contacts.push((0, None, -pushed.normalize(), pushed.norm()));
    Sketch { grains: 1, contacts }
}

/// Two walls that face each other but for a lever, and a third that bars the way out.
fn lever<const D: usize>(random: &mut ChaCha8Rng) -> Sketch<D> {
    let turn = power(random, -12.0, -1.0);
    let first = random.random_range(0..D);
    let (along, out) = (axis::<D>(first), axis::<D>((first + 1) % D));
    let (one, other) = ((along + out * turn).normalize(), (-along + out * turn).normalize());
    let third = (one + other).dot(&out);
    Sketch { grains: 1, contacts: vec![(0, None, one, 1.0), (0, None, other, 1.0), (0, None, -out, third)] }
}

/// Grains in a row from wall to wall.
fn chain<const D: usize>(random: &mut ChaCha8Rng) -> Sketch<D> {
    let (grains, n) = (random.random_range(1..12), direction(random));
    let links = (1..grains).map(|k| (k, Some(k - 1), n, 1.0));
    let walls = [(0, None, n, 1.0), (grains - 1, None, -n, 1.0)];
    Sketch { grains, contacts: walls.into_iter().chain(links).collect() }
}

/// Grains in a ring, each pushed inwards by D walls around its way out.
fn ring<const D: usize>(random: &mut ChaCha8Rng) -> Sketch<D> {
    let (grains, frame) = (random.random_range(3..8_u32), frame::<D>(random));
    let turn = random.random_range(0.0..1.0);
    let angle = |k: u32| (f64::from(k) + turn) * std::f64::consts::TAU / f64::from(grains);
    let out = |k: u32| frame[0] * angle(k).cos() + frame[1] * angle(k).sin();
    let thrust = 2.0 * (std::f64::consts::PI / f64::from(grains)).sin();
    let mut contacts = Vec::new();
    for k in 0..grains {
        let next = (k + 1) % grains;
        contacts.push((next, Some(k), (out(next) - out(k)).normalize(), 1.0));
        let along = frame[1] * angle(k).cos() - frame[0] * angle(k).sin();
        for wall in 0..D {
            let around = wall as f64 * std::f64::consts::TAU / D as f64;
            let across = if D > 2 { frame[D - 1] * around.sin() } else { SVector::zeros() };
            let n = (across * 0.5 + along * (0.5 * around.cos()) - out(k)).normalize();
            contacts.push((k, None, n, thrust * 1.25_f64.sqrt() / D as f64));
        }
    }
    Sketch { grains, contacts }
}

/// Contacts that have no part in the proof: with walls anywhere.
fn others<const D: usize>(random: &mut ChaCha8Rng, sketch: &mut Sketch<D>) {
    for _ in 0..random.random_range(0..4) {
        sketch.contacts.push((random.random_range(0..sketch.grains), None, direction(random), 0.0));
    }
}

const KINDS: [&str; 5] = ["walls", "corners", "levers", "chains", "rings"];

fn sketch<const D: usize>(kind: &str, random: &mut ChaCha8Rng) -> Sketch<D> {
    let mut sketch = match kind {
        "walls" => walls(random),
        "corners" => corner(random),
        "levers" => lever(random),
        "chains" => chain(random),
        _ => ring(random),
    };
    others(random, &mut sketch);
    sketch
}

fn masses(random: &mut ChaCha8Rng, grains: u32) -> Vec<RoughMass> {
    let half = [0.0, 2.0, 4.0][random.random_range(0..3)];
    let mut of = |_| {
        let mass = power(random, -half - 1e-9, half + 1e-9);
        RoughMass { mass, inertia: mass * power(random, -1.0, 0.0) }
    };
    (0..grains).map(&mut of).collect()
}

/// μ from 0 to 5.
fn friction(random: &mut ChaCha8Rng) -> f64 {
    [0.0, 0.3, 5.0, random.random_range(0.0..5.0)][random.random_range(0..4)]
}

fn velocities<M: Dimension<D>, const D: usize>(
    random: &mut ChaCha8Rng,
    grains: u32,
    size: f64,
) -> Vec<M::Velocity> {
    let mut of = |_| {
        let translation = SVector::from_fn(|_, _| size * any(random));
        M::velocity(translation, [any(random), any(random), any(random)].map(|x| size * x))
    };
    (0..grains).map(&mut of).collect()
}

fn packing<M: Dimension<D>, const D: usize>(
    mass: Vec<RoughMass>,
    free: Vec<M::Velocity>,
    contacts: Vec<M::Contact>,
) -> Packing<M> {
    let position = vec![SVector::zeros(); mass.len()];
    Packing::new(mass, position, free, contacts).unwrap_or_else(|error| panic!("{error}"))
}

fn contact<const D: usize>(
    random: &mut ChaCha8Rng,
    (candidate, antagonist, normal, _): (u32, Option<u32>, SVector<f64, D>, f64),
) -> RoughContact<D> {
    let arms = Vector2::new(1.0, if antagonist.is_some() { 1.0 } else { 0.0 });
    RoughContact { candidate, antagonist, normal, arms, offset: SVector::zeros(), friction: friction(random) }
}

/// A problem whose contacts approach by a share of their speeds on the whole, Σ c d < 0, whatever moves; and its d.
fn without_solution<M: Dimension<D>, const D: usize>(
    kind: &str,
    random: &mut ChaCha8Rng,
) -> (Packing<M>, Vec<f64>) {
    let sketch = sketch::<D>(kind, random);
    let speed = power(random, -3.0, 3.0);
    let d: Vec<f64> = sketch.contacts.iter().map(|(.., d)| *d).collect();
    let mut c: Vec<f64> = d.iter().map(|_| any(random)).collect();
    let sum = |c: &[f64]| d.iter().zip(c).map(|(d, c)| d * c).sum::<f64>();
    let shift = random.random_range(0.1..1.0) + sum(&c) / d.iter().sum::<f64>();
    c.iter_mut().zip(&d).filter(|(_, d)| **d > 0.0).for_each(|(c, _)| *c -= shift);
    let mut contacts = Vec::new();
    for (at, c) in sketch.contacts.iter().zip(&c) {
        let offset = SVector::from_fn(|row, _| speed * if row == 0 { *c } else { any(random) });
        contacts.push(M::contact(RoughContact { offset, ..contact(random, *at) }));
    }
    let mass = masses(random, sketch.grains);
    let free = velocities::<M, D>(random, sketch.grains, speed);
    (packing(mass, free, contacts), d)
}

/// A problem with a solution, and its impulses: each contact is open, sticks, or slides.
fn with_solution<M: Dimension<D>, const D: usize>(
    kind: &str,
    random: &mut ChaCha8Rng,
) -> (Packing<M>, Vec<f64>) {
    let sketch = sketch::<D>(kind, random);
    let speed = power(random, -3.0, 3.0);
    let mass = masses(random, sketch.grains);
    let velocity = velocities::<M, D>(random, sketch.grains, speed);
    let least = mass.iter().map(|mass| mass.mass).fold(f64::INFINITY, f64::min);
    let (mut contacts, mut r) = (Vec::new(), Vec::new());
    for at in &sketch.contacts {
        let contact = contact(random, *at);
        let size = least * speed * random.random_range(0.01..1.0);
        let (mut v, mut own) = (M::Impulse::ZERO, M::Impulse::ZERO);
        let along = [any(random), if D > 2 { any(random) } else { 0.0 }].map(|x| 0.7 * x);
        match random.random_range(0..3) {
            0 => v = M::impulse(random.random_range(0.0..1.0), along) * speed,
            1 => own = M::impulse(1.0, along.map(|x| contact.friction * x)) * size,
            _ => {
                v = M::impulse(0.0, along) * speed;
                let against = M::impulse(0.0, along) * -(contact.friction / M::slip(M::impulse(0.0, along)));
                own = (M::impulse(1.0, [0.0; 2]) + against) * size;
            }
        }
        r.extend(own.components());
        let (moves, mut offset) = (M::contact(contact).relative(&velocity), SVector::<f64, D>::zeros());
        (v - moves).put(offset.as_mut_slice(), 0);
        contacts.push(M::contact(RoughContact { offset, ..contact }));
    }
    let pushed = packing::<M, D>(mass.clone(), vec![M::Velocity::ZERO; mass.len()], contacts.clone());
    let mut change = velocity.clone();
    pushed.velocity(&r, &mut change);
    let free = velocity.iter().zip(&change).map(|(v, change)| *v - *change).collect();
    (packing(mass, free, contacts), r)
}

/// A row of the table.
#[derive(Default)]
struct Row {
    problems: u32,
    false_certificates: u32,
    false_proofs: u32,
    unknown: u32,
    certified: u32,
    proved: u32,
}

/// The impulses with which methods end, and whether a method ends with a proof that there is no solution.
fn ends<M: Dimension<D>, const D: usize>(problem: &Packing<M>) -> (Vec<Vec<f64>>, bool)
where
    ActiveSet: Solver<M>,
    Nsgs: Solver<M>,
    Cg: Solver<M>,
{
    // A proof is looked for after 1024 iterations, and where a method has stalled.
    let methods: [(&dyn Solver<M>, u64); 3] =
        [(&ActiveSet::default(), 1024), (&Nsgs::default(), 1024), (&Cg::default(), 1024)];
    let r0 = vec![0.0; problem.impulse_count()];
    let ended = methods.map(|(solver, max_iterations)| {
        let stop = Stop { tolerance: 1e-13, max_iterations, ..Stop::default() };
        solve(solver, problem, &r0, &stop, &mut |_| {}).unwrap()
    });
    let proved = ended.iter().any(|end| end.status == Status::Infeasible);
    (ended.into_iter().map(|end| end.impulses).collect(), proved)
}

/// Impulses along d, of any size: they balance, and hide what approaches where residuals are weighed by their size.
fn huge<M: Dimension<D>, const D: usize>(problem: &Packing<M>, d: &[f64]) -> Vec<Vec<f64>> {
    let scale = problem.scale().sqrt();
    let along = |exponent: i32| {
        let mut r = vec![0.0; problem.impulse_count()];
        for (k, d) in d.iter().enumerate() {
            r[k * M::Impulse::LEN] = d * scale * 10_f64.powi(exponent);
        }
        r
    };
    (0..40).map(along).collect()
}

fn count_without<M: Dimension<D>, const D: usize>(kind: &str, count: u32) -> Row
where
    ActiveSet: Solver<M>,
    Nsgs: Solver<M>,
    Cg: Solver<M>,
{
    let mut row = Row { problems: count, ..Row::default() };
    for seed in 0..u64::from(count) {
        let (problem, d) = without_solution::<M, D>(kind, &mut ChaCha8Rng::seed_from_u64(seed));
        let (ends, is_proved) = ends(&problem);
        let mut claimed = ends.into_iter().chain(huge(&problem, &d));
        row.false_certificates += u32::from(claimed.any(|r| certify(&problem, &r).certified()));
        if is_proved || M::ray(&problem).is_some() {
            row.proved += 1;
        } else {
            row.unknown += 1;
        }
    }
    row
}

fn count_with<M: Dimension<D>, const D: usize>(kind: &str, count: u32) -> Row
where
    ActiveSet: Solver<M>,
    Nsgs: Solver<M>,
    Cg: Solver<M>,
{
    let mut row = Row { problems: count, ..Row::default() };
    for seed in 0..u64::from(count) {
        let (problem, r) = with_solution::<M, D>(kind, &mut ChaCha8Rng::seed_from_u64(seed));
        let is_proved = ends(&problem).1 || M::ray(&problem).is_some();
        row.false_proofs += u32::from(is_proved);
        if certify(&problem, &r).certified() {
            row.certified += 1;
        } else {
            row.unknown += 1;
        }
    }
    row
}

/// Problems where `PROPTEST_CASES` does not say how many.
const FEW: u32 = 60;

/// Rows of all kinds, in the plane and in space, of as many problems as `PROPTEST_CASES` says in all.
fn table(what: &str, count: impl Fn(&str, bool, u32) -> Row) -> Row {
    let cases = match std::env::var_os("PROPTEST_CASES") {
        Some(_) => ProptestConfig::default().cases,
        None => FEW,
    };
    let cases = cases.div_ceil(2 * KINDS.len() as u32);
    let mut sum = Row::default();
    for in_space in [false, true] {
        for kind in KINDS {
            let Row { problems, false_certificates, false_proofs, unknown, certified, proved } =
                count(kind, in_space, cases);
            println!(
                "{what}, {kind} {}: {problems} problems, {false_certificates} false certificates, {false_proofs} false proofs, \
                 {unknown} unknown, {certified} certified, {proved} proved",
                if in_space { "in space" } else { "in the plane" }
            );
            sum.problems += problems;
            sum.false_certificates += false_certificates;
            sum.false_proofs += false_proofs;
            sum.unknown += unknown;
            sum.certified += certified;
            sum.proved += proved;
        }
    }
    sum
}

/// A grain between two walls that close, as a file has it.
#[test]
fn grain_between_closing_walls_has_no_solution_whatever_its_friction() {
    let normal = Vector2::new(-0.373_388_827_803_571_5, 0.927_674_934_053_666_7);
    let wall = |normal: Vector2<f64>, speed: f64| RoughContact {
        candidate: 0,
        antagonist: None,
        normal,
        arms: Vector2::new(0.5, 0.0),
        offset: Vector2::new(-speed, 0.0),
        friction: 0.3,
    };
    let contacts = vec![wall(normal, 0.512_666_738_842_781), wall(-normal, 0.943_648_343_265_755_1)];
    let mass = vec![RoughMass { mass: 1.0, inertia: 0.125 }];
    let problem = packing::<RoughDiscs, 2>(mass, vec![Vector3::zeros()], contacts);
    assert!(RoughDiscs::ray(&problem).is_some());
    for solution in solve_rough(&problem, 0..=3, || {}) {
        assert!(!solution.certificate.certified(), "{}", solution.certificate);
    }
}

#[test]
fn fuzz_no_problem_without_solution_is_certified() {
    let sum = table("no solution", |kind, in_space, count| {
        if in_space {
            count_without::<RoughSpheres, 3>(kind, count)
        } else {
            count_without::<RoughDiscs, 2>(kind, count)
        }
    });
    assert_eq!(sum.false_certificates, 0);
    assert!(sum.unknown * 20 <= sum.problems, "{} of {} are unknown", sum.unknown, sum.problems);
}

#[test]
fn fuzz_no_problem_with_a_solution_is_proved_to_have_none() {
    let sum = table("a solution", |kind, in_space, count| {
        if in_space {
            count_with::<RoughSpheres, 3>(kind, count)
        } else {
            count_with::<RoughDiscs, 2>(kind, count)
        }
    });
    assert_eq!(sum.false_proofs, 0);
    assert_eq!(sum.unknown, 0, "the solution that was made is certified");
}
