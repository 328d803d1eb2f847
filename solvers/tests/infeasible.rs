//! Problems without solution: the reference proves it, and no method converges on a measure that sees it.

use crate::problems::{first_problem, frozen};
use active_set::ActiveSet;
use analysis::proves_infeasible;
use apgd::Apgd;
use cg::{Cg, Preconditioner};
use contact::{Measure, Solver, Truth};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use mprgp::Mprgp;
use nncg::Nncg;
use nsgs::Nsgs;
use nsgs_dd::NsgsDd;
use reference::{Answer, InteriorPoint};
use runner::{Measured, Progress, Status, Stop, solve, solve_against};
use std::ops::ControlFlow;

/// Every method, as it is by default.
pub(crate) fn all_methods() -> [(&'static str, Box<dyn Solver>); 12] {
    [
        ("nsgs", Box::new(Nsgs::default())),
        ("jacobi", Box::new(Jacobi::default())),
        ("cg", Box::new(Cg::default())),
        ("cg, preconditioned", Box::new(Cg::preconditioned())),
        ("latin-dd", Box::new(LatinDd::default())),
        ("nsgs-dd", Box::new(NsgsDd::default())),
        ("apgd", Box::new(Apgd::default())),
        ("mprgp", Box::new(Mprgp::default())),
        (
            "mprgp, preconditioned",
            Box::new(Mprgp { preconditioner: Preconditioner::Diagonal, ..Mprgp::default() }),
        ),
        ("nncg", Box::new(Nncg::default())),
        ("active-set", Box::new(ActiveSet::default())),
        ("interior-point", Box::new(InteriorPoint::default())),
    ]
}

#[test]
fn between_closing_walls_no_method_converges_on_what_sees_the_approach() {
    let problem = first_problem("closing-walls", &[]).problem;
    let Answer::Infeasible { ray } = reference::solve(&problem) else { panic!("there is no solution") };
    assert!(proves_infeasible(&problem, &ray));
    for (name, solver) in all_methods() {
        for on in [Measure::NaturalMap, Measure::PenetrationRate] {
            let stop = Stop { on, tolerance: 1e-6, max_iterations: 5000 };
            let r0 = vec![0.0; problem.contact_count()];
            let outcome = solve(&*solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
            let ended = outcome.status;
            assert!(
                matches!(ended, Status::Infeasible | Status::IterationLimit | Status::Diverged),
                "{name} on {on}: {ended:?}"
            );
        }
    }
}

/// ζᵢ is about 1/i while the walls still close at their full speed.
#[test]
fn between_closing_walls_zeta_promises_convergence_and_the_growth_of_impulses_disproves_it() {
    let problem = first_problem("closing-walls", &[]).problem;
    let run = |on, tolerance| {
        let stop = Stop { on, tolerance, max_iterations: 5000 };
        solve(&Nsgs::default(), &problem, &vec![0.0; problem.contact_count()], &stop, &mut |_| {}).unwrap()
    };
    let promised = run(Measure::Zeta, 1e-2);
    assert_eq!(promised.status, Status::FalseConvergence);
    assert!(promised.measures.penetration_rate >= 0.1, "{:?}", promised.measures);
    assert_eq!(run(Measure::NaturalMap, 1e-2).status, Status::Infeasible);
    assert_eq!(run(Measure::PenetrationRate, 1e-2).status, Status::Infeasible);
}

/// Iterations that change little, and impulses that balance ever better: each measure is met sooner or later. With a coarse
/// tolerance runs on the crystal end after some ten iterations, and their impulses prove nothing yet.
#[test]
fn no_method_converges_where_there_is_no_solution_whatever_measure_decides() {
    let mut promised = 0;
    for (case, tolerances) in [("closing-walls", &[1e-1, 1e-2, 1e-4][..]), ("squeezed-crystal", &[1e-4])] {
        let problem = first_problem(case, &[]).problem;
        let r0 = vec![0.0; problem.contact_count()];
        for (name, solver) in all_methods() {
            for on in [Measure::Zeta, Measure::QuadDv, Measure::MaxDv, Measure::PenetrationRate] {
                for tolerance in tolerances {
                    // A rate of a tenth of that of the walls is no promise.
                    let tolerance = if on == Measure::PenetrationRate { 0.1 * tolerance } else { *tolerance };
                    let stop = Stop { on, tolerance, max_iterations: 5000 };
                    let outcome = solve(&*solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
                    let ended = (outcome.status, outcome.iterations, outcome.measures);
                    assert_ne!(ended.0, Status::Converged, "{name} on {case}, {on} ≤ {tolerance}: {ended:?}");
                    promised += usize::from(ended.0 == Status::FalseConvergence);
                }
            }
        }
    }
    assert!(promised > 50, "{promised}");
}

/// The natural map of runs on LMGC90's norms may be some hundred tolerances on a packing, and they have converged for what
/// they ask.
#[test]
fn runs_on_packings_are_not_called_false_without_a_truth() {
    for name in ["settled-60", "settled-250"] {
        let problem = frozen(name).problem;
        let r0 = vec![0.0; problem.contact_count()];
        for (method, solver) in all_methods() {
            for on in Measure::ALL.into_iter().filter(|on| *on != Measure::VelocityError) {
                let stop = Stop { on, tolerance: 1e-3, max_iterations: 3000 };
                let ended = solve(&*solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
                let status = ended.status;
                assert_ne!(
                    status,
                    Status::FalseConvergence,
                    "{method} on {name}, {on}: {:?}",
                    ended.measures
                );
                assert_ne!(status, Status::Infeasible, "{method} on {name}, {on}");
            }
        }
    }
}

/// On a column the changes of one sweep say little of what is left. The truth tells, the natural map alone does not.
#[test]
fn truth_decides_where_it_is_known() {
    let problem = first_problem("column", &[("sample.grains", "100")]).problem;
    let Answer::Solution { impulses, .. } = reference::solve(&problem) else { panic!("there is a solution") };
    let truth = Truth::new(&problem, &impulses);
    let r0 = vec![0.0; problem.contact_count()];
    let ended = |truth: Option<&Truth>, on, tolerance| {
        let stop = Stop { on, tolerance, max_iterations: 100_000 };
        let go_on = &mut |_: &Progress| ControlFlow::Continue(());
        solve_against(truth, &Nsgs::default(), &problem, &r0, &stop, Measured::Grid, go_on).unwrap().status
    };
    assert_eq!(ended(Some(&truth), Measure::QuadDv, 1e-3), Status::FalseConvergence);
    assert_eq!(ended(None, Measure::QuadDv, 1e-3), Status::Converged);
    for on in [Measure::NaturalMap, Measure::PenetrationRate, Measure::VelocityError] {
        assert_eq!(ended(Some(&truth), on, 1e-4), Status::Converged, "{on}");
    }
}

/// Impulses that throw all discs upwards leave no approach.
#[test]
fn impulses_that_are_too_large_do_not_converge_on_the_penetration_rate() {
    let problem = first_problem("column", &[]).problem;
    let Answer::Solution { impulses, .. } = reference::solve(&problem) else { panic!("there is a solution") };
    let r0: Vec<f64> = impulses.iter().map(|r| 1e4 * r).collect();
    let stop = Stop { on: Measure::PenetrationRate, tolerance: 1e-6, max_iterations: 100 };
    let outcome = solve(&Nsgs::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!((outcome.status, outcome.iterations), (Status::FalseConvergence, 0), "{:?}", outcome.measures);
}

/// Rows of discs from wall to wall, held by hundreds of contacts that have nothing to do with the proof.
#[test]
fn squeezed_crystal_is_proved_to_have_no_solution() {
    let problem = first_problem("triangular", &[("scene.box.closing_speed_m_per_s", "0.1")]).problem;
    let Answer::Infeasible { ray } = reference::solve(&problem) else { panic!("there is no solution") };
    assert!(proves_infeasible(&problem, &ray));
    let without = |least: f64| ray.iter().map(|d| if *d > least { 0.0 } else { *d }).collect::<Vec<_>>();
    assert!(!proves_infeasible(&problem, &without(0.5 * ray.iter().copied().fold(0.0, f64::max))));
}

/// What is constant in the impulses hides the thrust that grows, so rays are balanced before they are judged.
#[test]
fn every_method_names_what_has_no_solution() {
    for case in ["closing-walls", "squeezed-crystal"] {
        let problem = first_problem(case, &[]).problem;
        for (name, solver) in all_methods() {
            let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 5000 };
            let r0 = vec![0.0; problem.contact_count()];
            let ended = solve(&*solver, &problem, &r0, &stop, &mut |_| {}).unwrap().status;
            assert_eq!(ended, Status::Infeasible, "{name} on {case}");
        }
    }
}

/// A light disc on rollers: a bad condition, and a solution.
#[test]
fn bad_condition_is_not_called_infeasible() {
    let problem = first_problem("balloon", &[("sample.rollers", "16")]).problem;
    let solver = Apgd { acceleration: false, ..Apgd::default() };
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 4096 };
    let r0 = vec![0.0; problem.contact_count()];
    let outcome = solve(&solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_ne!(outcome.status, Status::Infeasible, "{:?}", outcome.measures);
}

/// Slow is not without solution: on a column of 300 discs 5000 sweeps do not reach the answer.
#[test]
fn slow_methods_are_not_called_infeasible() {
    let problem = first_problem("column", &[("sample.grains", "300")]).problem;
    for solver in [&Nsgs::default() as &dyn Solver, &Jacobi::default(), &Nncg::default()] {
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-12, max_iterations: 5000 };
        let r0 = vec![0.0; problem.contact_count()];
        let outcome = solve(solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert_ne!(outcome.status, Status::Infeasible);
    }
}
