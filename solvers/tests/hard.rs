//! The reference on problems that are hard in floating point: dependent contacts, narrow wedges, masses over many decades, contacts
//! that are nearly active; with and without solution, judged by a linear programme or in exact arithmetic.
//!
//! 256 of each kind; `just fuzz` makes 10,000 and prints the table.

use crate::hazards::{chain, lattice, wedge};
use crate::infeasible::all_methods;
use crate::problems::first_problem;
use cases::{Frozen, Start};
use cg::Cg;
use contact::{Contact, Packing, Solver, Touch};
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
use nalgebra::Vector2;
use num_rational::BigRational;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use reference::Answer;
use runner::{Status, Stop, solve};
use std::path::Path;

/// What an answer is, in a word.
fn verdict(answer: &Answer) -> &'static str {
    match answer {
        Answer::Solution { .. } => "certified",
        Answer::Infeasible { .. } => "no solution",
        Answer::Unknown { .. } => "unknown",
    }
}

fn hard(name: &str) -> Packing {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("hard").join(name).with_extension("json");
    Frozen::read(&file).unwrap_or_else(|error| panic!("{error}")).problem
}

/// A lever of 3e-9 asks for impulses of 1e17 times what stops the approach, a mass of 1e17 for as many digits: neither is in
/// double precision, and neither is a proof.
#[test]
fn problems_that_are_hard_are_certified_or_proved_to_have_no_solution() {
    for (name, expected) in [
        ("almost-active", "certified"),
        ("mass-ratio-3e5", "certified"),
        ("lattice-b", "certified"),
        ("lattice-c", "certified"),
        ("lattice-mass-1e6", "certified"),
        ("infeasible-2-grains", "no solution"),
        ("infeasible-b", "no solution"),
        ("infeasible-c", "no solution"),
        ("lever-3e-9-feasible", "unknown"),
        ("mass-ratio-1e17-feasible", "unknown"),
    ] {
        let answer = reference::solve(&hard(name));
        assert_eq!(verdict(&answer), expected, "{name}: {answer:?}");
    }
    for case in ["two-discs", "almost-closing", "flat-arch"] {
        for h in ["0.07", "0.1", "0.2", "1"] {
            let answer = reference::solve(&first_problem(case, &[("scene.time_step_s", h)]).problem);
            assert_eq!(verdict(&answer), "certified", "{case}, time step {h} s: {answer:?}");
        }
    }
}

/// Two walls are opposite but for a lever of 2e-7, whose way out a third bars: sweeps meet that after a million iterations and more, and before
/// that claim nothing.
#[test]
fn methods_end_with_a_proof_or_at_their_limit_where_a_fine_lever_is_barred() {
    let problem = hard("infeasible-b");
    for (method, solver) in all_methods() {
        let sweeps = ["nsgs", "jacobi", "nsgs-dd"].contains(&method);
        let expected = if sweeps { Status::IterationLimit } else { Status::Infeasible };
        assert_eq!(run(&*solver, &problem, 20_000), expected, "{method}");
    }
}

/// What no impulses in double precision prove, no method may claim.
#[test]
fn no_method_denies_a_solution_that_is_beyond_double_precision() {
    for name in ["lever-3e-9-feasible", "mass-ratio-1e17-feasible"] {
        let problem = hard(name);
        for (method, solver) in all_methods() {
            let ended = run(&*solver, &problem, 5000);
            assert!(
                !matches!(ended, Status::Infeasible | Status::Converged),
                "{method} on {name}: {ended:?}"
            );
        }
    }
}

#[test]
fn the_first_time_steps_of_cases_are_certified() {
    let stop = Stop { tolerance: 1e-8, max_iterations: 3000, ..Stop::default() };
    let solver = Cg::preconditioned();
    for case in [
        "triangular",
        "balloon",
        "units",
        "impact",
        "copied-contacts",
        "long-time-step",
        "rollers",
        "compressed",
    ] {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(case).with_extension("toml");
        let case = cases::Case::read(&file, &[]).unwrap();
        let mut march = cases::March::<contact::Discs>::new(&case).unwrap();
        for _ in 0..4 {
            let step = march.next().unwrap();
            let answer = reference::solve(&step.frozen.problem);
            assert_eq!(verdict(&answer), "certified", "{}: {answer:?}", step.frozen.name);
            march.solve(&step, &solver, &stop, Start::Previous, &|| false).unwrap();
        }
    }
}

/// What a judge says of whether a velocity satisfies all contacts.
#[derive(Clone, Copy, PartialEq)]
enum Judged {
    Feasible,
    Infeasible,
    /// Too near the edge for the judge.
    Open,
}

/// Scaled margins below this are the round-off of a linear programme (–).
const MARGIN: f64 = 1e-6;

/// max t with n·(`x_i` − `x_j`) + b/v₀ ≥ t over |x| ≤ 1e4, where x = (V − `V_free`)/v₀ and v₀ is the fastest approach.
fn by_linear_programme(problem: &Packing) -> Judged {
    let b = problem.b();
    let fastest = b.iter().fold(0.0, |fastest, b| f64::max(fastest, -b));
    if fastest == 0.0 {
        return Judged::Feasible;
    }
    let mut programme = Problem::new(OptimizationDirection::Maximize);
    let margin = programme.add_var(1.0, (-1e9, 1.0));
    let x: Vec<_> = (0..2 * problem.grain_count()).map(|_| programme.add_var(0.0, (-1e4, 1e4))).collect();
    for (contact, b) in problem.contacts().iter().zip(&b) {
        let mut terms = vec![(margin, -1.0)];
        for grain in contact.grains() {
            let sign = if grain == contact.candidate { 1.0 } else { -1.0 };
            let of_grain = 2 * grain as usize;
            terms
                .extend([(x[of_grain], sign * contact.normal.x), (x[of_grain + 1], sign * contact.normal.y)]);
        }
        programme.add_constraint(&terms[..], ComparisonOp::Ge, -b / fastest);
    }
    match programme.solve() {
        Ok(SolveOutcome::Solution(solution)) if solution[margin] > MARGIN => Judged::Feasible,
        Ok(SolveOutcome::Solution(solution)) if solution[margin] < -MARGIN => Judged::Infeasible,
        _ => Judged::Open,
    }
}

/// Decides whether one grain has an admissible velocity, however fast, in exact arithmetic: one unknown is eliminated after the other
/// (Fourier, Motzkin).
fn has_velocity(problem: &Packing) -> bool {
    let exact = |x: f64| BigRational::from_float(x).unwrap();
    let zero = exact(0.0);
    // a x + b y + c ≥ 0
    let mut rows: Vec<[BigRational; 3]> = problem
        .contacts()
        .iter()
        .map(|contact| {
            let (a, b) = (exact(contact.normal.x), exact(contact.normal.y));
            [a, b, exact(contact.offset)]
        })
        .collect();
    for unknown in [1, 0] {
        let (bounded, mut left): (Vec<_>, Vec<_>) = rows.into_iter().partition(|row| row[unknown] != zero);
        let (below, above): (Vec<_>, Vec<_>) = bounded.into_iter().partition(|row| row[unknown] > zero);
        for low in &below {
            for high in &above {
                let weights = (-&high[unknown], low[unknown].clone());
                left.push(std::array::from_fn(|k| &low[k] * &weights.0 + &high[k] * &weights.1));
            }
        }
        rows = left;
    }
    rows.iter().all(|row| row[2] >= zero)
}

/// Answers to many problems of a kind, and what a judge says of each; returns how many in a thousand are unknown.
fn answers(kind: &str, problems: impl Strategy<Value = Packing>, judge: impl Fn(&Packing) -> Judged) -> u32 {
    let config = ProptestConfig::default();
    let cases = config.cases;
    let mut runner = TestRunner::new(config);
    let (mut certified, mut proved, mut unknown) = (0, 0, Vec::new());
    for _ in 0..cases {
        let problem = problems.new_tree(&mut runner).unwrap().current();
        let judged = judge(&problem);
        match reference::solve(&problem) {
            Answer::Solution { .. } => certified += 1,
            Answer::Infeasible { .. } => {
                assert!(judged != Judged::Feasible, "{kind}: a solution is called none: {problem:?}");
                proved += 1;
            }
            Answer::Unknown { certificate, why, .. } => {
                let word = match judged {
                    Judged::Feasible => "a solution exists",
                    Judged::Infeasible => "none is near",
                    Judged::Open => "at the edge",
                };
                unknown.push(format!("  unknown, {word}: {why}; {certificate}"));
            }
        }
    }
    println!(
        "{kind}: {cases} problems, {certified} certified, {proved} without solution, {} unknown",
        unknown.len()
    );
    for unknown in &unknown {
        println!("{unknown}");
    }
    // Round-off, not the draw, decides how many there are.
    unknown.len() as u32 * 1000 / cases
}

/// Several walls around a grain, in any direction or opposite to others, exactly or but for a turn; still or moving at any speed.
fn walls() -> impl Strategy<Value = Packing> {
    let turn = prop_oneof![2 => Just(0.0), 1 => (-16.0..-2.0_f64).prop_map(|exponent| 10_f64.powf(exponent))];
    let toward = |angle: f64| Vector2::new(angle.cos(), angle.sin());
    let of_eight = (0..4_u32, any::<bool>(), turn).prop_map(move |(eighth, is_opposite, turn)| {
        let normal = toward(f64::from(eighth) * std::f64::consts::FRAC_PI_4 + turn);
        if is_opposite { -normal } else { normal }
    });
    let wall = (prop_oneof![of_eight, (0.0..std::f64::consts::TAU).prop_map(toward)], -1.0..1.0_f64);
    let free = (-1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(x, y)| Vector2::new(x, y));
    (prop::collection::vec(wall, 2..=7), free).prop_map(|(walls, free)| {
        let contact = |(normal, offset): &(Vector2<f64>, f64)| Contact {
            candidate: 0,
            antagonist: None,
            normal: *normal,
            offset: *offset,
        };
        let contacts = walls.iter().map(contact).collect();
        Packing::new(vec![1.0], vec![Vector2::zeros()], vec![free], contacts).unwrap()
    })
}

/// The contacts of chains and lattices, with any offsets: mostly without solution.
fn squeezed() -> impl Strategy<Value = Packing> {
    prop_oneof![chain(), lattice()].prop_flat_map(|problem| {
        let offsets = prop::collection::vec(-0.3..1.0_f64, problem.contact_count());
        (Just(problem), offsets).prop_map(|(problem, offsets)| {
            let contacts = problem
                .contacts()
                .iter()
                .zip(offsets)
                .map(|(contact, offset)| Contact { offset, ..*contact });
            let (mass, position) = (problem.mass().to_vec(), problem.position().to_vec());
            Packing::new(mass, position, problem.free_velocity().to_vec(), contacts.collect()).unwrap()
        })
    })
}

#[test]
fn fuzz_chains_with_a_solution_are_certified() {
    assert_eq!(answers("chains", chain(), |_| Judged::Feasible), 0);
}

#[test]
fn fuzz_lattices_with_a_solution_are_certified() {
    assert_eq!(answers("lattices", lattice(), |_| Judged::Feasible), 0);
}

/// Some levers are finer than impulses in double precision can tell.
#[test]
fn fuzz_wedges_with_a_solution_are_certified() {
    assert!(answers("wedges", wedge(), |_| Judged::Feasible) <= 5);
}

/// Walls that close, and face each other but for a lever, leave a way out that is too fast for double precision.
#[test]
fn fuzz_walls_are_judged_as_by_exact_arithmetic() {
    let judge = |problem: &Packing| if has_velocity(problem) { Judged::Feasible } else { Judged::Open };
    assert!(answers("walls, exact arithmetic", walls(), judge) <= 40);
}

#[test]
fn fuzz_walls_are_judged_as_by_a_linear_programme() {
    assert!(answers("walls, linear programme", walls(), by_linear_programme) <= 40);
}

/// How a run to a natural map of 1e-6 ends.
fn run(solver: &dyn Solver, problem: &Packing, max_iterations: u64) -> Status {
    let stop = Stop { max_iterations, ..Stop::default() };
    solve(solver, problem, &vec![0.0; problem.contact_count()], &stop, &mut |_| {}).unwrap().status
}

proptest! {
    #[test]
    fn fuzz_no_method_contradicts_the_reference(problem in prop_oneof![walls(), squeezed()]) {
        let answer = reference::solve(&problem);
        for (name, solver) in all_methods() {
            let ended = run(&*solver, &problem, 300);
            let wrong = match answer {
                Answer::Solution { .. } => ended == Status::Infeasible,
                Answer::Infeasible { .. } => ended == Status::Converged,
                Answer::Unknown { .. } => false,
            };
            prop_assert!(!wrong, "{name}: {ended:?}, where the reference finds {}", verdict(&answer));
        }
    }
}

/// With a lever of 1e-9 a velocity may exist that is as far away, or none: neither is told.
#[test]
fn fuzz_squeezed_packings_are_judged_as_by_a_linear_programme() {
    assert!(answers("squeezed packings, linear programme", squeezed(), by_linear_programme) <= 20);
}
