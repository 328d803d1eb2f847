//! Random problems of the worst kind, met by every method: nothing panics, nothing lies, everything ends.
//!
//! 256 problems; `PROPTEST_CASES=10000 cargo test --release --package solver-tests fuzz` for the long form.

use active_set::{ActiveSet, Start};
use apgd::Apgd;
use cg::{Cg, Preconditioner};
use contact::{Contact, Measure, Packing, Solver, Touch};
use gradient::Gradient;
use jacobi::Jacobi;
use latin_dd::LatinDd;
use mprgp::{Expansion, Mprgp};
use nalgebra::Vector2;
use nncg::Nncg;
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Grid, Scheme};
use proptest::prelude::*;
use reference::InteriorPoint;
use runner::{Status, Stop, solve};

/// Every method by default, and the settings that are asking for trouble.
pub(crate) fn methods() -> Vec<(&'static str, Box<dyn Solver>)> {
    let grid = Grid::of(3, 2);
    let whole = NsgsDd { subdomains: grid, mass_splitting: false, ..NsgsDd::default() };
    let latin = LatinDd { subdomains: grid, ..LatinDd::default() };
    let kappa = |kappa: f64| LatinDd { kappa_l: Some(kappa), ..latin };
    vec![
        ("nsgs", Box::new(Nsgs::default())),
        ("nsgs, ω = 2.5", Box::new(Nsgs { relaxation: 2.5, order: Order::Coloured, ..Nsgs::default() })),
        ("jacobi", Box::new(Jacobi::default())),
        ("jacobi, ω = 3", Box::new(Jacobi { relaxation: 3.0, ..Jacobi::default() })),
        ("jacobi, bounded", Box::new(Jacobi { relaxation: 0.95, bounded: true, ..Jacobi::default() })),
        ("cg", Box::new(Cg::default())),
        ("cg, preconditioned", Box::new(Cg::preconditioned())),
        ("gradient", Box::new(Gradient::default())),
        ("gradient, s = 9", Box::new(Gradient { step: 9.0 })),
        ("apgd", Box::new(Apgd::default())),
        ("mprgp", Box::new(Mprgp::default())),
        (
            "mprgp, preconditioned",
            Box::new(Mprgp { preconditioner: Preconditioner::Diagonal, ..Mprgp::default() }),
        ),
        (
            "mprgp, fixed step, s = 2",
            Box::new(Mprgp { expansion: Expansion::FixedStep, step: 2.0, gamma: 1e3, ..Mprgp::default() }),
        ),
        ("nncg", Box::new(Nncg::default())),
        ("active-set", Box::new(ActiveSet::default())),
        ("active-set, cold", Box::new(ActiveSet { start: Some(Start::ColdSet), ..ActiveSet::default() })),
        (
            "active-set, from inside",
            Box::new(ActiveSet { start: Some(Start::InteriorPoint), ..ActiveSet::default() }),
        ),
        ("interior-point", Box::new(InteriorPoint::default())),
        ("nsgs-dd", Box::new(NsgsDd { subdomains: grid, partition: Scheme::Balanced, ..NsgsDd::default() })),
        ("nsgs-dd, whole masses", Box::new(whole)),
        ("nsgs-dd, in turn", Box::new(NsgsDd { exchange: Exchange::GaussSeidel, inner_sweeps: 5, ..whole })),
        ("latin-dd", Box::new(latin)),
        ("latin-dd, coarse", Box::new(LatinDd { coarse: true, ..latin })),
        ("latin-dd, κ = 1e-6", Box::new(kappa(1e-6))),
        ("latin-dd, κ = 1e6, μ = 1", Box::new(LatinDd { relaxation: 1.0, ..kappa(1e6) })),
    ]
}

/// A power of ten, up to `decades` either way.
fn power(decades: f64) -> impl Strategy<Value = f64> {
    (-decades..decades).prop_map(|exponent| 10_f64.powf(exponent))
}

/// 0, of order 1, or far beyond.
fn speed() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 4 => -1.0..1.0_f64, 1 => (-1.0..1.0_f64).prop_map(|v| 1e9 * v)]
}

fn contact(grains: u32) -> impl Strategy<Value = Contact> {
    // Few directions, and turned off them by little or nothing: parallel, opposite and nearly so.
    let angle = (0..8_u32, prop_oneof![Just(0.0), power(12.0).prop_map(|turn| turn.min(1.0))])
        .prop_map(|(eighth, turn)| f64::from(eighth) * std::f64::consts::FRAC_PI_4 + turn);
    (0..grains, 0..=grains, angle, speed()).prop_map(move |(candidate, other, angle, offset)| Contact {
        candidate,
        antagonist: (other < grains && other != candidate).then_some(other),
        normal: Vector2::new(angle.cos(), angle.sin()),
        offset,
    })
}

/// 1 to 12 grains, with masses over 16 decades; up to 30 contacts, of which the first come again.
pub(crate) fn worst_problem() -> impl Strategy<Value = Packing> {
    (1..=12_u32, 0..30_usize, 0..4_usize).prop_flat_map(|(grains, contacts, copies)| {
        let n = grains as usize;
        let masses = prop_oneof![
            prop::collection::vec(Just(1.0), n).boxed(),
            prop::collection::vec(power(8.0), n).boxed()
        ];
        let vectors = || prop::collection::vec((speed(), speed()).prop_map(|(x, y)| Vector2::new(x, y)), n);
        let contacts = prop::collection::vec(contact(grains), contacts);
        (masses, vectors(), vectors(), contacts).prop_map(
            move |(masses, positions, velocities, mut contacts)| {
                let again: Vec<Contact> = contacts.iter().take(copies).copied().collect();
                contacts.extend(again);
                Packing::new(masses, positions, velocities, contacts)
                    .unwrap_or_else(|error| panic!("{error}"))
            },
        )
    })
}

/// √( Σ (r − max(0, r − v/w))² w / Σ max(0, −b)²/w ), from the data and r alone, in the plainest way; and what round-off may
/// add to it: each v is a sum, in any order, of no more than 70 terms, known to as many rounding errors of their sizes.
fn residual(problem: &Packing, r: &[f64]) -> (f64, f64) {
    let inverse = |grain: u32| 1.0 / problem.mass()[grain as usize];
    let mut velocity = problem.free_velocity().to_vec();
    let mut size: Vec<f64> = velocity.iter().map(Vector2::norm).collect();
    for (contact, r) in problem.contacts().iter().zip(r) {
        for grain in contact.grains() {
            let sign = if grain == contact.candidate { 1.0 } else { -1.0 };
            velocity[grain as usize] += contact.normal * (sign * r * inverse(grain));
            size[grain as usize] += r * inverse(grain);
        }
    }
    let approach = |contact: &Contact, velocity: &[Vector2<f64>]| {
        let other = contact.antagonist.map_or(Vector2::zeros(), |j| velocity[j as usize]);
        contact.normal.dot(&(velocity[contact.candidate as usize] - other)) + contact.offset
    };
    let (mut left, mut round_off, mut scale) = (0.0, 0.0, 0.0);
    for (contact, r) in problem.contacts().iter().zip(r) {
        let w: f64 = contact.grains().map(inverse).sum();
        let (v, b) = (approach(contact, &velocity), approach(contact, problem.free_velocity()));
        let terms = contact.offset.abs() + contact.grains().map(|grain| size[grain as usize]).sum::<f64>();
        left += w * r.min(v / w).powi(2);
        round_off += (70.0 * f64::EPSILON * terms).powi(2) / w;
        scale += (-b).max(0.0).powi(2) / w;
    }
    if left == 0.0 { (0.0, 0.0) } else { ((left / scale).sqrt(), (round_off / scale).sqrt()) }
}

proptest! {
    #[test]
    fn fuzz_every_method_ends_and_what_converged_obeys_the_law(problem in worst_problem()) {
        let r0 = vec![0.0; problem.contact_count()];
        let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 300 };
        for (name, solver) in methods() {
            // More subdomains than contacts are refused.
            let Ok(outcome) = solve(&*solver, &problem, &r0, &stop, &mut |_| {}) else {
                prop_assert!(problem.contact_count() < 6, "{name}");
                continue;
            };
            prop_assert!(outcome.iterations <= stop.max_iterations);
            let r = &outcome.impulses;
            if outcome.status == Status::Converged {
                prop_assert!(r.iter().all(|r| *r >= 0.0 && r.is_finite()), "{name}: {r:?}");
                let (left, round_off) = residual(&problem, r);
                prop_assert!(left <= stop.tolerance + round_off, "{name}: {left:e} left of the law, {round_off:e} round-off");
            }
            if outcome.status == Status::Infeasible {
                prop_assert!(r.iter().all(|r| r.is_finite()), "{name}: {r:?}");
            }
        }
    }
}
