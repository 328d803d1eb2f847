//! Coulomb's law: against another code's problem, its solution and its counts; against known answers; and without friction.

use crate::problems::frozen_path;
use cases::Frozen;
use contact::{Measure, Measuring, RoughDiscs, RoughMeter, Solver};
use nsgs::Nsgs;
use runner::{Status, Stop, solve};
use serde_json::Value;

fn rough(name: &str) -> Frozen<RoughDiscs> {
    Frozen::read_rough(&frozen_path(&format!("{name}.json"))).unwrap()
}

/// Impulses that another code gave, as a flat list.
fn given(solution: &Value) -> Vec<f64> {
    serde_json::from_value::<Vec<[f64; 2]>>(solution["impulse"].clone()).unwrap().concat()
}

#[test]
#[ignore = "some seconds"]
fn sweeps_are_those_of_another_code() {
    let frozen = rough("rough-991-mu08");
    for (tolerance, expected) in
        [(1e-2, 6150), (1e-3, 11710), (1e-4, 58_100), (1e-6, 103_000), (1e-8, 110_200)]
    {
        let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 200_000 };
        let clock = std::time::Instant::now();
        let outcome = solve(
            &Nsgs::default() as &dyn Solver<RoughDiscs>,
            &frozen.problem,
            &frozen.start(false),
            &stop,
            &mut |_| {},
        )
        .unwrap();
        println!(
            "{tolerance:e}: {} {:?} expected {expected}; {:?} of {:?}",
            outcome.iterations,
            outcome.status,
            outcome.iterating,
            clock.elapsed()
        );
        assert_eq!(outcome.status, Status::Converged);
    }
    let text = std::fs::read_to_string(frozen_path("rough-991-mu08.solution.json")).unwrap();
    let solution: Value = serde_json::from_str(&text).unwrap();
    let mut meter = RoughMeter::new(&frozen.problem);
    println!("{:e} {}", meter.measure_after(&[], &given(&solution), 0.0).natural_map, solution["residual"]);
}

#[test]
#[ignore = "for trials"]
fn trial() {
    let mut frozen = rough("rough-991-mu08");
    if let Ok(mu) = std::env::var("MU") {
        let mu: f64 = mu.parse().unwrap();
        let contacts = frozen
            .problem
            .contacts()
            .iter()
            .map(|at| contact::RoughContact { friction: mu, ..*at })
            .collect();
        frozen.problem = contact::Packing::new(
            frozen.problem.mass().to_vec(),
            frozen.problem.position().to_vec(),
            frozen.problem.free_velocity().to_vec(),
            contacts,
        )
        .unwrap();
    }
    for (name, solver) in [
        ("cg", Box::new(cg::Cg::default()) as Box<dyn Solver<RoughDiscs>>),
        ("cg diagonal", Box::new(cg::Cg { preconditioner: cg::Preconditioner::Diagonal })),
        ("active-set", Box::new(active_set::ActiveSet::default())),
    ] {
        let mut first = vec![];
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-12, max_iterations: 200_000 };
        let outcome = solve(&*solver, &frozen.problem, &frozen.start(false), &stop, &mut |progress| {
            if let Some(m) = progress.measures {
                for t in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
                    if m.natural_map <= t && !first.iter().any(|(u, _)| *u == t) {
                        first.push((t, progress.iteration));
                    }
                }
            }
        })
        .unwrap();
        println!(
            "{name}: {first:?} {} {:?} {:e} {:?}",
            outcome.iterations, outcome.status, outcome.measures.natural_map, outcome.iterating
        );
    }
}
