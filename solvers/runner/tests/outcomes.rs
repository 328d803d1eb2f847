//! How runs end, and what is refused before they begin.

#![allow(clippy::unwrap_used)]

use contact::{Contact, Iteration, Measure, Packing, SetupError, Solver, Truth, Work};
use nalgebra::Vector2;
use runner::{Measured, Progress, Status, Stop, solve, solve_against};
use std::ops::ControlFlow;

/// A grain of 2 kg falling at 1 m/s onto a floor: W = ½, b = −1, so r = 2 N·s.
fn falling_on_a_floor() -> Packing {
    let contact = Contact { candidate: 0, antagonist: None, normal: Vector2::y(), offset: 0.0 };
    Packing::new(vec![2.0], vec![Vector2::zeros()], vec![Vector2::new(0.0, -1.0)], vec![contact]).unwrap()
}

/// A method that plays back given impulses, the same at every contact.
struct Recorded(Vec<f64>);

struct Playing {
    ahead: Vec<f64>,
    r: Vec<f64>,
}

impl Solver for Recorded {
    fn start<'p>(&self, _: &'p Packing, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(Playing { ahead: self.0.iter().rev().copied().collect(), r: r0.to_vec() }))
    }
}

impl Iteration for Playing {
    fn advance(&mut self) {
        let r = self.ahead.pop().expect("an iterate is left");
        self.r.fill(r);
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work::default()
    }
}

fn stop(max_iterations: u64) -> Stop {
    Stop { on: Measure::NaturalMap, tolerance: 1e-3, max_iterations }
}

#[test]
fn loop_stops_at_the_first_iterate_that_meets_the_tolerance() {
    let mut seen = Vec::new();
    let method = Recorded(vec![1.0, 1.9, 2.0, 2.0]);
    let outcome = solve(&method, &falling_on_a_floor(), &[0.0], &stop(9), &mut |progress| {
        seen.push(progress.iteration);
    });
    let outcome = outcome.unwrap();
    assert_eq!((outcome.status, outcome.iterations), (Status::Converged, 3));
    assert_eq!(outcome.impulses, [2.0]);
    assert_eq!(Truth::new(&falling_on_a_floor(), &outcome.impulses).velocity(), [Vector2::zeros()]);
    assert_eq!(seen, [0, 1, 2, 3]);
}

#[test]
fn loop_ends_at_its_limit() {
    let outcome =
        solve(&Recorded(vec![1.0; 5]), &falling_on_a_floor(), &[0.0], &stop(5), &mut |_| {}).unwrap();
    assert_eq!((outcome.status, outcome.iterations), (Status::IterationLimit, 5));
}

#[test]
fn observer_ends_a_run_that_has_not_ended_yet() {
    let interrupted_at = |iteration| {
        let method = Recorded(vec![1.0, 1.9, 2.0, 2.0]);
        let mut observe = |progress: &Progress| {
            if progress.iteration == iteration { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        solve_against(None, &method, &falling_on_a_floor(), &[0.0], &stop(9), Measured::Needed, &mut observe)
            .unwrap()
    };
    let outcome = interrupted_at(2);
    assert_eq!((outcome.status, outcome.iterations), (Status::Interrupted, 2));
    assert_eq!(outcome.impulses, [1.9]);
    assert_eq!((interrupted_at(3).status, interrupted_at(3).iterations), (Status::Converged, 3));
}

#[test]
fn an_iterate_that_is_not_finite_or_of_endless_energy_has_diverged() {
    for bad in [f64::NAN, f64::INFINITY, 1e30, 1e200] {
        for on in Measure::ALL {
            let stop = Stop { on, tolerance: 1e-12, max_iterations: 9 };
            let (method, problem) = (Recorded(vec![1.0, bad, 2.0]), falling_on_a_floor());
            let truth = Truth::new(&problem, &[2.0]);
            let outcome =
                solve_against(Some(&truth), &method, &problem, &[0.0], &stop, Measured::Needed, &mut |_| {
                    ControlFlow::Continue(())
                })
                .unwrap();
            assert_eq!((outcome.status, outcome.iterations), (Status::Diverged, 2), "{bad} on {on}");
        }
    }
}

#[test]
fn where_no_contact_pushes_rest_is_the_answer_before_any_iteration() {
    let contact = Contact { candidate: 0, antagonist: None, normal: Vector2::y(), offset: 2.0 };
    let grain = (vec![2.0], vec![Vector2::zeros()], vec![Vector2::new(0.0, -1.0)]);
    for contacts in [vec![], vec![contact]] {
        let r0 = vec![7.0; contacts.len()];
        let problem = Packing::new(grain.0.clone(), grain.1.clone(), grain.2.clone(), contacts).unwrap();
        let truth = Truth::new(&problem, &vec![0.0; r0.len()]);
        for on in Measure::ALL {
            let stop = Stop { on, ..stop(9) };
            let method = Recorded(vec![]);
            let outcome =
                solve_against(Some(&truth), &method, &problem, &r0, &stop, Measured::Needed, &mut |_| {
                    ControlFlow::Continue(())
                })
                .unwrap();
            assert_eq!((outcome.status, outcome.iterations), (Status::Converged, 0));
            assert!(outcome.impulses.iter().all(|r| *r == 0.0));
            assert_eq!((outcome.measures.natural_map, outcome.measures.velocity_error), (0.0, 0.0));
        }
    }
}

#[test]
fn loop_stops_on_the_velocity_error_where_it_is_known_and_refuses_to_elsewhere() {
    let problem = falling_on_a_floor();
    let truth = Truth::new(&problem, &[2.0]);
    let stop = Stop { on: Measure::VelocityError, tolerance: 0.1, max_iterations: 9 };
    let method = Recorded(vec![1.0, 1.9, 2.0]);
    let outcome =
        solve_against(Some(&truth), &method, &problem, &[0.0], &stop, Measured::Needed, &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!((outcome.status, outcome.iterations), (Status::Converged, 2));
    let refused = solve(&method, &problem, &[0.0], &stop, &mut |_| {}).unwrap_err().to_string();
    assert!(refused.contains("`on` is velocity_error") && refused.contains("not known"), "{refused}");
}

/// A disc of 1 kg between two walls that close at 1 m/s; `tilt` (rad) of the second leaves a way out upwards.
fn between_walls(tilt: f64) -> Packing {
    let wall = |normal| Contact { candidate: 0, antagonist: None, normal, offset: -1.0 };
    let contacts = vec![wall(Vector2::x()), wall(Vector2::new(-tilt.cos(), tilt.sin()))];
    let at_rest = vec![Vector2::zeros()];
    Packing::new(vec![1.0], at_rest.clone(), at_rest, contacts).unwrap()
}

#[test]
fn impulses_that_grow_for_ever_end_the_loop_with_the_proof() {
    // Those after its limit tell whether the run goes round in a cycle.
    let growing: Vec<f64> = (1..=2032).map(f64::from).collect();
    let stop = Stop { max_iterations: 2000, ..stop(9) };
    let run = |tilt| {
        let outcome =
            solve(&Recorded(growing.clone()), &between_walls(tilt), &[0.0; 2], &stop, &mut |_| {}).unwrap();
        (outcome.status, outcome.iterations)
    };
    assert_eq!(run(0.0), (Status::Infeasible, 1024));
    assert_eq!(run(1e-3), (Status::IterationLimit, 2000));
}

#[test]
fn senseless_starts_and_stop_rules_are_refused_by_name() {
    let problem = falling_on_a_floor();
    let refused = |r0: &[f64], stop: Stop| {
        solve(&Recorded(vec![]), &problem, r0, &stop, &mut |_| {}).unwrap_err().to_string()
    };
    assert!(refused(&[], stop(1)).contains("`start`"));
    assert!(refused(&[-1.0], stop(1)).contains("-1 at contact 0"));
    assert!(refused(&[f64::NAN], stop(1)).contains("NaN at contact 0"));
    assert!(refused(&[0.0], Stop { tolerance: -1.0, ..stop(1) }).contains("`tolerance` is -1"));
    assert!(refused(&[0.0], Stop { tolerance: f64::NAN, ..stop(1) }).contains("`tolerance` is NaN"));
}

#[test]
fn impulses_that_stay_go_round_in_no_cycle_and_those_that_come_back_do() {
    let cycle = |after: [f64; 2]| {
        let before = (0..400).map(|k| if k % 2 == 0 { 1.0 } else { 0.5 });
        let all = before.chain((0..32).map(|k| after[k % 2])).collect();
        solve(&Recorded(all), &falling_on_a_floor(), &[0.0], &stop(400), &mut |_| {}).unwrap().cycle
    };
    assert_eq!(cycle([1.0, 0.5]), Some(2));
    assert_eq!(cycle([0.5, 0.5]), None);
    assert_eq!(cycle([1.0, 1.5]), None);
}
