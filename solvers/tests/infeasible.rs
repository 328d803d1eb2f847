//! Problems without solution: the reference proves it, and no method converges on a measure that sees it.

use crate::problems::first_problem;
use apgd::Apgd;
use cg::{Cg, Preconditioner};
use contact::{Measure, Solver, Status, Stop, proves_infeasible, solve};
use latin_dd::LatinDd;
use nncg::Nncg;
use nsgs::{Jacobi, Nsgs};
use nsgs_dd::NsgsDd;
use reference::{Answer, InteriorPoint};

/// Every method, as it is by default.
fn all_methods() -> [(&'static str, Box<dyn Solver>); 9] {
    [
        ("nsgs", Box::new(Nsgs::default())),
        ("jacobi", Box::new(Jacobi::default())),
        ("cg", Box::new(Cg::default())),
        ("cg, preconditioned", Box::new(Cg { preconditioner: Preconditioner::Diagonal })),
        ("latin-dd", Box::new(LatinDd::default())),
        ("nsgs-dd", Box::new(NsgsDd::default())),
        ("apgd", Box::new(Apgd::default())),
        ("nncg", Box::new(Nncg::default())),
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
    assert_eq!(promised.status, Status::Converged);
    assert!(promised.measures.penetration_rate >= 0.1, "{:?}", promised.measures);
    assert_eq!(run(Measure::NaturalMap, 1e-2).status, Status::Infeasible);
    assert_eq!(run(Measure::PenetrationRate, 1e-2).status, Status::Infeasible);
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

/// What is constant in the impulses hides the thrust that grows, so rays are balanced before they are judged. Between walls of
/// the crystal LATIN's directions adapt to ever larger impulses, and it diverges before the first look.
#[test]
fn every_method_names_what_has_no_solution() {
    for case in ["closing-walls", "squeezed-crystal"] {
        let problem = first_problem(case, &[]).problem;
        for (name, solver) in all_methods() {
            let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 5000 };
            let r0 = vec![0.0; problem.contact_count()];
            let ended = solve(&*solver, &problem, &r0, &stop, &mut |_| {}).unwrap().status;
            let diverges = name == "latin-dd" && case == "squeezed-crystal";
            let expected = ended == Status::Infeasible || diverges && ended == Status::Diverged;
            assert!(expected, "{name} on {case}: {ended:?}");
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
