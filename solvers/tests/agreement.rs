//! All methods, and another code, reach the one velocity that a problem has.

use crate::problems::frozen;
use active_set::ActiveSet;
use analysis::Meter;
use analysis::greatest_eigenvalue;
use apgd::Apgd;
use cg::Cg;
use contact::{Measure, Packing, Solver};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use mprgp::{Expansion, Mprgp};
use nalgebra::Vector2;
use newton_schur::NewtonSchur;
use nncg::Nncg;
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Grid, Scheme};
use reference::InteriorPoint;
use runner::{Status, Stop, solve};

/// An answer: impulses, and the velocities that follow from them.
struct Answer {
    name: String,
    r: Vec<f64>,
    velocity: Vec<Vector2<f64>>,
    v: Vec<f64>,
}

impl Answer {
    fn new(name: String, problem: &Packing, r: Vec<f64>) -> Self {
        let mut velocity = vec![Vector2::zeros(); problem.grain_count()];
        problem.velocity(&r, &mut velocity);
        let mut v = vec![0.0; r.len()];
        problem.relative_velocity(&velocity, &mut v);
        Self { name, r, velocity, v }
    }

    fn of(solver: &dyn Solver, name: String, problem: &Packing, tolerance: f64) -> Self {
        let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: 200_000 };
        let outcome =
            solve(solver, problem, &vec![0.0; problem.contact_count()], &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{name}");
        Self::new(name, problem, outcome.impulses)
    }
}

/// How far two answers with r, s ≥ 0 can be apart, from what each leaves of the law alone:
/// ‖V − U‖²_M = (r − s)ᵗ (v − u) ≤ rᵗ max(0, v) + sᵗ max(0, u) + rᵗ max(0, −u) + sᵗ max(0, −v).
fn bound(a: &Answer, b: &Answer) -> f64 {
    let sum = |r: &[f64], v: &[f64], sign: f64| -> f64 {
        r.iter().zip(v).map(|(r, v)| r * (sign * v).max(0.0)).sum()
    };
    let (own, crossed) =
        (sum(&a.r, &a.v, 1.0) + sum(&b.r, &b.v, 1.0), sum(&a.r, &b.v, -1.0) + sum(&b.r, &a.v, -1.0));
    (own + crossed).sqrt()
}

fn assert_agree(problem: &Packing, a: &Answer, b: &Answer) {
    let scale = problem.velocity_distance(&b.velocity, problem.free_velocity());
    let distance = problem.velocity_distance(&a.velocity, &b.velocity) / scale;
    let tolerance = bound(a, b) / scale;
    let pair = format!("{} and {}", a.name, b.name);
    assert!(distance <= tolerance, "{pair}: {distance:e} apart, {tolerance:e} allowed");
    // The bound holds for any two answers, if H and W are right; it is what must be small: two digits of the change of
    // velocity.
    assert!(tolerance < 1e-2, "{pair}: the residuals allow {tolerance:e}");
}

fn assert_all_methods_agree_on(name: &str) {
    let problem = frozen(name).problem;
    let reference = Answer::of(&Cg::default(), "cg".into(), &problem, 1e-9);
    let grid = |nx, ny| NsgsDd { subdomains: Grid::of(nx, ny), ..NsgsDd::default() };
    let latin = |nx, ny| LatinDd { subdomains: Grid::of(nx, ny), ..LatinDd::default() };
    let schur = |interface| NewtonSchur { subdomains: Grid::of(4, 2), interface, ..NewtonSchur::default() };
    let methods: [(&str, &dyn Solver); 23] = [
        ("latin-dd 1x1", &latin(1, 1)),
        ("latin-dd 2x1", &latin(2, 1)),
        ("latin-dd 2x2, directions kept", &LatinDd { adaptive: Some(false), ..latin(2, 2) }),
        ("latin-dd 4x2", &latin(4, 2)),
        ("latin-dd 4x2, coarse", &LatinDd { coarse: true, ..latin(4, 2) }),
        ("latin-dd 8x8, balanced", &LatinDd { partition: Scheme::Balanced, ..latin(8, 8) }),
        ("cg, preconditioned", &Cg::preconditioned()),
        ("apgd", &Apgd::default()),
        ("apgd, preconditioned", &Apgd { preconditioner: apgd::Preconditioner::Diagonal, ..Apgd::default() }),
        ("mprgp", &Mprgp::default()),
        (
            "mprgp, preconditioned",
            &Mprgp { preconditioner: mprgp::Preconditioner::Diagonal, ..Mprgp::default() },
        ),
        ("mprgp, fixed step", &Mprgp { expansion: Expansion::FixedStep, ..Mprgp::default() }),
        ("nncg", &Nncg::default()),
        ("active-set", &ActiveSet::default()),
        ("newton-schur 4x2, direct", &schur(newton_schur::Interface::Direct)),
        ("newton-schur 4x2, cg", &schur(newton_schur::Interface::Cg)),
        ("interior-point", &InteriorPoint::default()),
        ("nsgs", &Nsgs::default()),
        (
            "nsgs, coloured, over-relaxed",
            &Nsgs { order: Order::Coloured, relaxation: 1.6, ..Nsgs::default() },
        ),
        ("jacobi", &Jacobi::default()),
        ("nsgs-dd 4x2", &grid(4, 2)),
        ("nsgs-dd 5x5, balanced", &NsgsDd { partition: Scheme::Balanced, ..grid(5, 5) }),
        (
            "nsgs-dd 5x5, Gauss-Seidel, whole masses",
            &NsgsDd { exchange: Exchange::GaussSeidel, mass_splitting: false, ..grid(5, 5) },
        ),
    ];
    for (method, solver) in methods {
        assert_agree(&problem, &Answer::of(solver, method.into(), &problem, 5e-6), &reference);
    }
}

#[test]
fn all_methods_agree_on_the_velocity_at_rest() {
    assert_all_methods_agree_on("shear-box-991-rest");
}

#[test]
fn all_methods_agree_on_the_velocity_at_the_onset_of_shear() {
    assert_all_methods_agree_on("shear-box-991-onset");
}

#[test]
fn all_methods_agree_on_the_velocity_of_the_sheared_box() {
    assert_all_methods_agree_on("shear-box-991-sheared");
}

#[test]
fn all_methods_agree_on_the_velocity_of_lmgc90s_box() {
    assert_all_methods_agree_on("lmgc90-shear-991-t1");
}

#[test]
fn lmgc90_gives_the_same_velocity() {
    let name = "lmgc90-shear-991-t1";
    let problem = frozen(name).problem;
    let text = std::fs::read_to_string(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../cases/frozen")
            .join(name)
            .with_extension("solution.json"),
    )
    .unwrap();
    let solution: serde_json::Value = serde_json::from_str(&text).unwrap();
    let r: Vec<f64> = serde_json::from_value(solution["impulse"].clone()).unwrap();
    // What LMGC90 left of the law, as told beside the file in cases/README.md: −2.4e-7 m/s at the worst contact.
    let measures = Meter::new(&problem).measure(&r, 0.0);
    assert!((measures.penetration_rate - 2.4e-7).abs() < 0.05e-7, "{:e} m/s", measures.penetration_rate);
    let lmgc90 = Answer::new("LMGC90".into(), &problem, r);
    let cg = Answer::of(&Cg::default(), "cg".into(), &problem, 1e-9);
    assert_agree(&problem, &lmgc90, &cg);
}

#[test]
fn jacobi_without_relaxation_diverges_on_a_packing() {
    let problem = frozen("settled-991").problem;
    assert!(greatest_eigenvalue(&problem) > 2.0);
    let stop = Stop { max_iterations: 100_000, ..Stop::default() };
    let r0 = vec![0.0; problem.contact_count()];
    let outcome =
        solve(&Jacobi { relaxation: 1.0, ..Jacobi::default() }, &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!(outcome.status, Status::Diverged);
}
