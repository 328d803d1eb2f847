//! scratch
use crate::problems::first_problem;
use contact::{Contact, ContactProblem};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use reference::Answer;

fn one_grain(rng: &mut ChaCha8Rng, kind: u32) -> ContactProblem {
    let walls = rng.random_range(2..=7);
    let contacts = (0..walls)
        .map(|_| {
            let angle: f64 = match kind % 3 {
                0 => rng.random_range(0.0..std::f64::consts::TAU),
                1 => {
                    f64::from(rng.random_range(0..8u32)) * std::f64::consts::FRAC_PI_4
                        + 10f64.powf(rng.random_range(-12.0..0.0))
                }
                _ => f64::from(rng.random_range(0..8u32)) * std::f64::consts::FRAC_PI_4,
            };
            let offset = if kind % 2 == 0 { 0.0 } else { rng.random_range(-1.0..1.0) };
            Contact { candidate: 0, antagonist: None, normal: Vector2::new(angle.cos(), angle.sin()), offset }
        })
        .collect();
    let v = Vector2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
    ContactProblem::new(vec![1.0], vec![Vector2::zeros()], vec![v], contacts).unwrap()
}

fn lattice(rng: &mut ChaCha8Rng) -> ContactProblem {
    let (nx, ny) = (rng.random_range(1..5u32), rng.random_range(1..6u32));
    let decades: f64 = rng.random_range(0.0..6.0);
    let n = (nx * ny) as usize;
    let mass: Vec<f64> = (0..n)
        .map(|_| {
            785.0 * if rng.random_bool(0.3) { 10f64.powf(rng.random_range(-decades..=decades)) } else { 1.0 }
        })
        .collect();
    let position: Vec<_> = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| Vector2::new(0.5 + f64::from(i), 0.5 + f64::from(j))))
        .collect();
    let mut free = vec![Vector2::new(0.0, -0.04905); n];
    free[n - 1].y -= if rng.random_bool(0.3) { 1.0 } else { 0.0 };
    if rng.random_bool(0.2) {
        free[0].x += rng.random_range(-1.0..1.0)
    }
    let mut contacts = Vec::new();
    let mut add = |c, a, x: f64, y: f64| {
        contacts.push(Contact { candidate: c, antagonist: a, normal: Vector2::new(x, y), offset: 0.0 });
    };
    for j in 0..ny {
        for i in 0..nx {
            let k = j * nx + i;
            if j == 0 {
                add(k, None, 0.0, 1.0)
            } else {
                add(k, Some(k - nx), 0.0, 1.0)
            }
            if i == 0 {
                add(k, None, 1.0, 0.0)
            } else {
                add(k, Some(k - 1), 1.0, 0.0)
            }
            if i + 1 == nx {
                add(k, None, -1.0, 0.0)
            }
        }
    }
    ContactProblem::new(mass, position, free, contacts).unwrap()
}

fn report(what: &str, problems: impl Iterator<Item = ContactProblem>) {
    let (mut solved, mut infeasible, mut unknown, mut slow) = (0, 0, 0, 0.0f64);
    for (k, problem) in problems.enumerate() {
        let t = std::time::Instant::now();
        match reference::solve(&problem) {
            Answer::Solution { .. } => solved += 1,
            Answer::Infeasible { .. } => infeasible += 1,
            Answer::Unknown { certificate, why, .. } => {
                unknown += 1;
                if unknown < 12 {
                    println!("{what} {k} ({}): {why} {certificate}", problem.contact_count());
                }
            }
        }
        slow = slow.max(t.elapsed().as_secs_f64());
    }
    println!("{what}: solved {solved} infeasible {infeasible} unknown {unknown}, slowest {slow}");
}

#[test]
fn scratch() {
    let n = std::env::var("N").map_or(1000, |n| n.parse().unwrap());
    for kind in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(kind));
        report(&format!("one grain {kind}"), (0..n).map(|_| one_grain(&mut rng, kind)));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    report("lattice", (0..n).map(|_| lattice(&mut rng)));
}

#[test]
fn steps() {
    for case in [
        "triangular",
        "balloon",
        "units",
        "impact",
        "copied-contacts",
        "long-time-step",
        "rollers",
        "two-discs",
        "almost-closing",
        "flat-arch",
        "heavy-top",
        "islands",
        "bridge",
        "compressed",
        "column",
        "weightless",
        "squeezed-crystal",
        "radius-ratio",
        "intruder",
        "tall-column",
    ] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../cases")
            .join(case)
            .with_extension("toml");
        let case = cases::Case::read(&path, &[]).unwrap();
        let mut march = cases::March::new(&case).unwrap();
        let mut all = Vec::new();
        for _ in 0..20 {
            let Ok(step) = march.next() else { break };
            all.push(step.frozen.problem.clone());
            if march
                .make(
                    &step,
                    &cg::Cg { preconditioner: cg::Preconditioner::Diagonal },
                    &contact::Stop { tolerance: 1e-8, max_iterations: 3000, ..contact::Stop::default() },
                    true,
                )
                .is_err()
            {
                break;
            }
        }
        report(&case.name, all.into_iter());
    }
}
