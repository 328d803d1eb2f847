//! Feasible problems whose contacts depend on each other, so that W is singular: no method diverges on one.
//!
//! 256 of each kind; `PROPTEST_CASES=10000 cargo test --release --package solver-tests hazards` for the long form.

use crate::problems::{first_problem, impulses, start};
use active_set::ActiveSet;
use analysis::Meter;
use apgd::Apgd;
use cg::{Cg, Preconditioner};
use contact::{Contact, Measure, Packing, Solver, Touch};
use mprgp::{Expansion, Mprgp};
use nalgebra::Vector2;
use nncg::Nncg;
use nsgs::Nsgs;
use proptest::collection::vec;
use proptest::prelude::*;
use runner::{Outcome, Status, Stop, solve};

/// Grains and what touches; masses, motion and impulses are for [`feasible`].
#[derive(Clone, Debug)]
struct Touching {
    position: Vec<Vector2<f64>>,
    contacts: Vec<(u32, Option<u32>, Vector2<f64>)>,
}

impl Touching {
    /// Discs of diameter 1 at `position` touch where they are that near; `walls` are distances along a normal into the scene.
    fn discs(position: Vec<Vector2<f64>>, walls: &[(Vector2<f64>, f64)]) -> Self {
        let near = |distance: f64| distance < 1.01;
        let mut contacts = Vec::new();
        for (i, x) in (0_u32..).zip(&position) {
            let touched = walls.iter().filter(|(normal, wall)| near(normal.dot(x) - wall + 0.5));
            contacts.extend(touched.map(|(normal, _)| (i, None, *normal)));
            for (j, other) in (0..i).zip(&position) {
                if near((x - other).norm()) {
                    contacts.push((i, Some(j), (x - other).normalize()));
                }
            }
        }
        Self { position, contacts }
    }
}

/// How the grains of a problem move in a solution that is known.
#[derive(Clone, Debug)]
enum Motion {
    /// They do not: V = 0 is admissible, exactly. Every `open`-th contact is a gap.
    Still { open: usize },
    /// All with their walls: the offsets are as good as round-off.
    Together(Vector2<f64>),
    /// Each on its own; every `open`-th contact opens, the others press by their share.
    Apart { velocity: Vec<Vector2<f64>>, press: Vec<f64>, open: usize },
}

fn vector(size: f64) -> impl Strategy<Value = Vector2<f64>> {
    (-size..size, -size..size).prop_map(|(x, y)| Vector2::new(x, y))
}

/// 10^x with x in ±`decades`/2; often all 1.
fn masses(grains: usize, decades: f64) -> impl Strategy<Value = Vec<f64>> {
    let spread = prop_oneof![Just(0.0), Just(decades)];
    (spread, vec(-0.5..0.5_f64, grains)).prop_map(|(decades, exponents)| {
        exponents.iter().map(|exponent| 10_f64.powf(decades * exponent)).collect()
    })
}

fn motion(grains: usize, contacts: usize) -> impl Strategy<Value = Motion> {
    let apart = (vec(vector(1.0), grains), vec(prop_oneof![Just(0.0), 0.0..1.0_f64], contacts), 2..6_usize);
    prop_oneof![
        3 => (2..20_usize).prop_map(|open| Motion::Still { open }),
        1 => vector(1.0).prop_map(Motion::Together),
        1 => apart.prop_map(|(velocity, press, open)| Motion::Apart { velocity, press, open }),
    ]
}

/// Free velocities: weight alone, or anything.
fn fall(grains: usize) -> impl Strategy<Value = Vec<Vector2<f64>>> {
    prop_oneof![Just(vec![-Vector2::y(); grains]), vec(vector(1.0), grains)]
}

/// A problem with a solution by construction, with the first `copies` contacts twice.
fn feasible(
    touching: &Touching,
    mass: Vec<f64>,
    copies: usize,
    motion: &Motion,
    fall: Vec<Vector2<f64>>,
) -> Packing {
    let opens = |k: usize, every: usize| if k % every == every - 1 { 0.3 } else { 0.0 };
    let velocity = match motion {
        Motion::Still { .. } => vec![Vector2::zeros(); mass.len()],
        Motion::Together(velocity) => vec![*velocity; mass.len()],
        Motion::Apart { velocity, .. } => velocity.clone(),
    };
    let mut free = if let Motion::Apart { .. } = motion { velocity.clone() } else { fall };
    let mut contacts = Vec::new();
    for (k, (candidate, antagonist, normal)) in
        touching.contacts.iter().chain(touching.contacts.iter().take(copies)).enumerate()
    {
        let mut contact =
            Contact { candidate: *candidate, antagonist: *antagonist, normal: *normal, offset: 0.0 };
        // c = v − Hᵗ V, with v = 0 or the contact open
        let moves = contact.relative(&velocity);
        contact.offset = match motion {
            Motion::Still { open } => opens(k, *open),
            Motion::Together(_) => -moves,
            Motion::Apart { open, .. } => opens(k, *open) - moves,
        };
        // V_free = V − M⁻¹ H r
        if let Motion::Apart { press, open, .. } = motion
            && opens(k, *open) == 0.0
        {
            let impulse = *normal * press[k % press.len()];
            free[*candidate as usize] -= impulse / mass[*candidate as usize];
            if let Some(j) = antagonist {
                free[*j as usize] += impulse / mass[*j as usize];
            }
        }
        contacts.push(contact);
    }
    Packing::new(mass, touching.position.clone(), free, contacts).unwrap_or_else(|error| panic!("{error}"))
}

fn any_feasible(touching: Touching, decades: f64) -> impl Strategy<Value = Packing> {
    let (grains, contacts) = (touching.position.len(), touching.contacts.len());
    (masses(grains, decades), 0..4_usize, motion(grains, contacts), fall(grains))
        .prop_map(move |(mass, copies, motion, fall)| feasible(&touching, mass, copies, &motion, fall))
}

/// Rows of up to 12 discs from wall to wall, straight or with links turned to either side by up to 0.1; with or without floor.
pub(crate) fn chain() -> impl Strategy<Value = Packing> {
    let turn = prop_oneof![Just(0.0), (-12.0..-1.0_f64).prop_map(|exponent| 10_f64.powf(exponent))];
    (1..12_u32, turn, any::<bool>()).prop_flat_map(|(grains, turn, floor)| {
        let position = |k: u32| Vector2::new(f64::from(k) * turn.cos(), f64::from(k % 2) * turn.sin());
        let end = position(grains - 1).x;
        let mut walls = vec![(Vector2::x(), -0.5), (-Vector2::x(), -end - 0.5)];
        walls.extend(floor.then_some((Vector2::y(), -0.5)));
        any_feasible(Touching::discs((0..grains).map(position).collect(), &walls), 6.0)
    })
}

/// Square or triangular lattices of up to 5x5 discs in a box with or without lid.
pub(crate) fn lattice() -> impl Strategy<Value = Packing> {
    (1..6_u32, 1..6_u32, any::<bool>(), any::<bool>()).prop_flat_map(|(columns, rows, triangular, lid)| {
        let rise = if triangular { 0.75_f64.sqrt() } else { 1.0 };
        let shift = |row: u32| if triangular { 0.5 * f64::from(row % 2) } else { 0.0 };
        let position = |k: u32| {
            let (column, row) = (k % columns, k / columns);
            Vector2::new(f64::from(column) + shift(row), f64::from(row) * rise)
        };
        let position: Vec<_> = (0..columns * rows).map(position).collect();
        let high = position.iter().fold(Vector2::zeros(), |high: Vector2<f64>, x| high.sup(x));
        let mut walls = vec![(Vector2::y(), -0.5), (Vector2::x(), -0.5), (-Vector2::x(), -high.x - 0.5)];
        walls.extend(lid.then_some((-Vector2::y(), -high.y - 0.5)));
        any_feasible(Touching::discs(position, &walls), 6.0)
    })
}

/// One grain with 2 to 7 walls in any directions, some of them opposite to others or nearly so.
pub(crate) fn wedge() -> impl Strategy<Value = Packing> {
    let tiny = prop_oneof![2 => Just(0.0), 1 => (-16.0..-2.0_f64).prop_map(|exponent| 10_f64.powf(exponent))];
    let of_eight =
        (0..8_u32, tiny).prop_map(|(eighth, turn)| f64::from(eighth) * std::f64::consts::FRAC_PI_4 + turn);
    let angle = prop_oneof![of_eight, 0.0..std::f64::consts::TAU];
    vec(angle, 2..=7).prop_flat_map(|angles| {
        let wall = |angle: &f64| (0, None, Vector2::new(angle.cos(), angle.sin()));
        let position = vec![Vector2::zeros()];
        any_feasible(Touching { position, contacts: angles.iter().map(wall).collect() }, 6.0)
    })
}

/// The methods that must not diverge where there is a solution.
pub(crate) fn methods() -> Vec<(&'static str, Box<dyn Solver>)> {
    let nsgs = |relaxation: f64| Box::new(Nsgs { relaxation, ..Nsgs::default() });
    let apgd = |preconditioner| Box::new(Apgd { preconditioner, ..Apgd::default() });
    let mprgp = |preconditioner, expansion| Box::new(Mprgp { preconditioner, expansion, ..Mprgp::default() });
    vec![
        ("cg", Box::new(Cg::default())),
        ("cg, preconditioned", Box::new(Cg::preconditioned())),
        ("apgd", apgd(apgd::Preconditioner::None)),
        ("apgd, preconditioned", apgd(apgd::Preconditioner::Diagonal)),
        ("mprgp", mprgp(Preconditioner::None, Expansion::ProjectedCg)),
        ("mprgp, preconditioned", mprgp(Preconditioner::Diagonal, Expansion::ProjectedCg)),
        ("mprgp, fixed step", mprgp(Preconditioner::None, Expansion::FixedStep)),
        ("nncg", Box::new(Nncg::default())),
        ("active-set", Box::new(ActiveSet::default())),
        ("nsgs", nsgs(1.0)),
        ("nsgs, ω = 0.2", nsgs(0.2)),
        ("nsgs, ω = 1.9", nsgs(1.9)),
    ]
}

fn run(solver: &dyn Solver, problem: &Packing, tolerance: f64, max_iterations: u64) -> Outcome {
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations };
    let r0 = vec![0.0; problem.contact_count()];
    solve(solver, problem, &r0, &stop, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"))
}

/// q(r), and what round-off may add to it: impulses that grow along the kernel of W cancel in it (J).
fn energy(problem: &Packing, r: &[f64]) -> (f64, f64) {
    let q = Meter::new(problem).measure(r, 0.0).energy;
    let terms = r.iter().zip(problem.b()).zip(problem.delassus_diagonal());
    let size: f64 = terms.map(|((r, b), w)| r * (b.abs() + w * r)).sum();
    (q, 64.0 * f64::EPSILON * size)
}

/// Long after it has converged, too: the tolerance is 0.
fn check(problem: &Packing) -> Result<(), TestCaseError> {
    for (name, solver) in methods() {
        let outcome = run(&*solver, problem, 0.0, 500);
        let wrong = matches!(outcome.status, Status::Diverged | Status::Infeasible);
        prop_assert!(!wrong, "{name}: {:?}, {:?}", outcome.status, outcome.measures);
    }
    Ok(())
}

proptest! {
    #[test]
    fn hazards_no_method_diverges_or_denies_the_solution_of_a_chain(problem in chain()) {
        check(&problem)?;
    }

    #[test]
    fn hazards_no_method_diverges_or_denies_the_solution_of_a_lattice(problem in lattice()) {
        check(&problem)?;
    }

    #[test]
    fn hazards_no_method_diverges_or_denies_the_solution_of_a_wedge(problem in wedge()) {
        check(&problem)?;
    }

    #[test]
    fn hazards_energy_of_the_conjugate_gradient_never_exceeds_that_of_its_start(
        problem in prop_oneof![chain(), lattice(), wedge()],
    ) {
        for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
            let mut iteration = start(&Cg { preconditioner, ..Cg::default() }, &problem);
            for k in 0..100 {
                iteration.advance();
                let (q, round_off) = energy(&problem, &impulses(&*iteration, &problem));
                prop_assert!(q <= round_off, "q goes to {q:e} in iteration {k}");
            }
        }
    }
}

/// The thrust between the walls has no effect on velocities, and its curvature pᵗ W p is nothing but round-off.
#[test]
fn conjugate_gradient_converges_where_contacts_depend_on_each_other() {
    let cases = [
        ("two-discs", "1"),
        ("almost-closing", "0.07"),
        ("almost-closing", "0.1"),
        ("almost-closing", "0.2"),
    ];
    let arches = [("flat-arch", "0.07"), ("flat-arch", "0.1"), ("flat-arch", "0.2")];
    for (case, time_step) in cases.into_iter().chain(arches) {
        let problem = first_problem(case, &[("scene.time_step_s", time_step)]).problem;
        for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
            let outcome = run(&Cg { preconditioner, ..Cg::default() }, &problem, 1e-10, 200);
            assert_eq!(outcome.status, Status::Converged, "{case}, {time_step} s: {:?}", outcome.measures);
        }
    }
}
