//! MPRGP: its formulas written out, plain conjugate gradients where all contacts press, descent, and the end of it.

use crate::hazards::{chain, lattice, wedge};
use crate::layouts::moving_packing;
use crate::problems::{any_problem, difference, first_problem, frozen, impulses, start};
use analysis::Meter;
use analysis::{Spectrum, delassus_bound, scaled_delassus_bound};
use cg::Cg;
use contact::{Contact, Measure, Packing, SetupError, Solver, Touch};
use mprgp::{Expansion, Mprgp, Preconditioner};
use nalgebra::Vector2;
use nsgs::Nsgs;
use proptest::prelude::*;
use runner::{Outcome, Status, Stop, solve};

const EXPANSIONS: [Expansion; 2] = [Expansion::ProjectedCg, Expansion::FixedStep];
const PRECONDITIONERS: [Preconditioner; 2] = [Preconditioner::None, Preconditioner::Diagonal];

/// The method as the sources have it, with whole products, in the unknowns √D r; `unit` is √D.
struct Plain<'p> {
    problem: &'p Packing,
    settings: Mprgp,
    unit: Vec<f64>,
    /// ᾱ.
    step: f64,
    r: Vec<f64>,
    p: Vec<f64>,
    /// How often it went along φ, along β, and beyond.
    kinds: [u32; 3],
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<'p> Plain<'p> {
    fn new(problem: &'p Packing, settings: Mprgp, r0: &[f64]) -> Self {
        let scaled = settings.preconditioner == Preconditioner::Diagonal;
        let greatest = if scaled { scaled_delassus_bound(problem) } else { delassus_bound(problem) };
        let unit = |w: f64| if scaled { w.sqrt() } else { 1.0 };
        let unit: Vec<f64> = problem.delassus_diagonal().into_iter().map(unit).collect();
        let mut plain = Self {
            problem,
            settings,
            step: settings.step / greatest,
            r: r0.iter().zip(&unit).map(|(r, unit)| r * unit).collect(),
            unit,
            p: Vec::new(),
            kinds: [0; 3],
        };
        plain.p = plain.free();
        plain
    }

    fn product(&self, p: &[f64]) -> Vec<f64> {
        let p: Vec<f64> = p.iter().zip(&self.unit).map(|(p, unit)| p / unit).collect();
        let mut of_p = vec![0.0; p.len()];
        let mut scratch = vec![Vector2::zeros(); self.problem.grain_count()];
        self.problem.delassus_product(&p, &mut of_p, &mut scratch);
        of_p.iter().zip(&self.unit).map(|(of_p, unit)| of_p / unit).collect()
    }

    /// u = −(W r + b).
    fn u(&self) -> Vec<f64> {
        let b = self.problem.b().into_iter().zip(&self.unit).map(|(b, unit)| b / unit);
        self.product(&self.r).into_iter().zip(b).map(|(w_r, b)| -(w_r + b)).collect()
    }

    /// φ.
    fn free(&self) -> Vec<f64> {
        self.u().iter().zip(&self.r).map(|(u, r)| if *r > 0.0 { *u } else { 0.0 }).collect()
    }

    fn go(&mut self, length: f64, p: &[f64]) {
        self.r.iter_mut().zip(p).for_each(|(r, p)| *r = (*r + length * p).max(0.0));
    }

    fn advance(&mut self) {
        let (u, free) = (self.u(), self.free());
        let chopped: Vec<f64> =
            u.iter().zip(&self.r).map(|(u, r)| if *r > 0.0 { 0.0 } else { u.max(0.0) }).collect();
        let reduced: Vec<f64> = free.iter().zip(&self.r).map(|(free, r)| free.max(-r / self.step)).collect();
        let proportions = dot(&chopped, &chopped) > self.settings.gamma.powi(2) * dot(&reduced, &free);
        let p = if proportions { chopped } else { self.p.clone() };
        let w_p = self.product(&p);
        let (curvature, length) = (dot(&p, &w_p), dot(&u, &p) / dot(&p, &w_p));
        let opening = self.r.iter().zip(&p).filter(|(_, p)| **p < 0.0).map(|(r, p)| -r / p);
        let reach = opening.fold(f64::INFINITY, f64::min);
        self.kinds[if proportions { 1 } else { 2 * usize::from(length > reach) }] += 1;
        if length <= reach || self.settings.expansion == Expansion::ProjectedCg {
            self.go(length, &p);
        } else {
            self.go(reach, &p);
            let free = self.free();
            self.go(self.step, &free);
        }
        self.p = self.free();
        if !proportions && length <= reach {
            let beta = -dot(&self.p, &w_p) / curvature;
            let conjugate = |((next, p), r): ((&mut f64, &f64), &f64)| {
                *next += if *r > 0.0 { beta * p } else { 0.0 };
            };
            self.p.iter_mut().zip(&p).zip(&self.r).for_each(conjugate);
        }
    }
}

/// On several blocks, from r = 0, near the solution and nearer: through every kind of step; u is made from r twice each.
#[test]
fn mprgp_in_blocks_is_the_method_of_its_sources() {
    let problem = moving_packing();
    assert!(problem.contact_count() > 8192, "it has several blocks: {}", problem.contact_count());
    let mut near = start(&Cg::default(), &problem);
    let starts = [0, 60, 240].map(|iterations| {
        (0..iterations).for_each(|_| near.advance());
        impulses(&*near, &problem)
    });
    for settings in EXPANSIONS.iter().flat_map(|expansion| {
        PRECONDITIONERS.map(|preconditioner| Mprgp {
            preconditioner,
            expansion: *expansion,
            step: 1.5,
            ..Mprgp::default()
        })
    }) {
        let mut kinds = [0; 3];
        for r0 in &starts {
            let mut plain = Plain::new(&problem, settings, r0);
            let mut blocks = settings.start(&problem, r0).unwrap();
            for iteration in 1..=40 {
                plain.advance();
                blocks.advance();
                let r: Vec<f64> = plain.r.iter().zip(&plain.unit).map(|(r, unit)| r / unit).collect();
                let difference = difference(&r, &impulses(&*blocks, &problem));
                assert!(difference < 1e-12, "{settings:?}, iteration {iteration}: {difference}");
            }
            // W p in each, W (r⁺ − r) in the second half of an expansion, W r before the first and in every 16th.
            let second =
                if settings.expansion == Expansion::FixedStep { u64::from(plain.kinds[2]) } else { 0 };
            assert_eq!(blocks.work().delassus_products, 40 + second + 1 + 40 / 16, "{settings:?}");
            kinds.iter_mut().zip(plain.kinds).for_each(|(sum, count)| *sum += count);
        }
        assert!(kinds.iter().all(|count| *count > 0), "{settings:?}, every kind of step: {kinds:?}");
    }
}

/// A column of n discs, and impulses near its solution: so near that no iterate of conjugate gradients opens a contact.
fn pressed_column(n: usize) -> (Packing, Vec<f64>) {
    let problem = first_problem("column", &[("sample.grains", &n.to_string())]).problem;
    let reference::Answer::Solution { impulses, .. } = reference::solve(&problem) else {
        panic!("there is a solution")
    };
    // |r − r*| is at most √C times that of r₀, C = (4n/π)² the condition; the least r* is the weight of one disc.
    let least = impulses.iter().copied().fold(f64::INFINITY, f64::min);
    let off = 0.5 * least / (1.3 * (n as f64).powf(1.5));
    // In no eigenvector's way.
    let r = impulses.iter().enumerate().map(|(k, r)| r + off * (0.5 - (k as f64 * 0.618_034).fract()));
    (problem, r.collect())
}

fn run(solver: &dyn Solver, problem: &Packing, r0: &[f64], tolerance: f64, iterations: u64) -> Outcome {
    let stop = Stop { on: Measure::NaturalMap, tolerance, max_iterations: iterations };
    solve(solver, problem, r0, &stop, &mut |_| {}).unwrap()
}

#[test]
fn where_all_contacts_press_mprgp_is_the_conjugate_gradient_and_ends_in_n_iterations() {
    for n in [5_u64, 10, 20] {
        let (problem, r0) = pressed_column(n as usize);
        for preconditioner in PRECONDITIONERS {
            for expansion in EXPANSIONS {
                let settings = Mprgp { preconditioner, expansion, ..Mprgp::default() };
                let mut mprgp = settings.start(&problem, &r0).unwrap();
                let mut cg = Cg { preconditioner, ..Cg::default() }.start(&problem, &r0).unwrap();
                for iteration in 1..=n {
                    mprgp.advance();
                    cg.advance();
                    let difference = difference(&impulses(&*cg, &problem), &impulses(&*mprgp, &problem));
                    assert!(difference < 1e-12, "{settings:?}, n = {n}, iteration {iteration}: {difference}");
                }
                // Round-off in n iterations on a problem of condition n².
                let tolerance = 1e-14 * (n * n * n) as f64;
                let outcome = run(&settings, &problem, &r0, tolerance, 10 * n);
                assert_eq!((outcome.status, outcome.iterations), (Status::Converged, n), "{settings:?}");
                assert_eq!(outcome.work.delassus_products, 1 + n + n / 16);
            }
        }
    }
}

/// From r = 0 each contact of the column is closed by the one below it. If nothing weighs against it, proportioning closes one
/// after the other, which is a sweep; what is left is a plain conjugate gradient.
#[test]
fn proportioning_alone_is_a_sweep_of_the_column_and_then_n_iterations_are_left() {
    for n in [10_u64, 20, 30] {
        let problem = first_problem("column", &[("sample.grains", &n.to_string())]).problem;
        let settings = Mprgp { gamma: 1e-9, ..Mprgp::default() };
        let (mut mprgp, mut nsgs) = (start(&settings, &problem), start(&Nsgs::default(), &problem));
        (0..n).for_each(|_| mprgp.advance());
        nsgs.advance();
        let difference = difference(&impulses(&*nsgs, &problem), &impulses(&*mprgp, &problem));
        assert!(difference < 1e-13, "n = {n}: {difference}");
        let r0 = vec![0.0; problem.contact_count()];
        let outcome = run(&settings, &problem, &r0, 1e-15 * (n * n * n) as f64, 10 * n);
        assert_eq!((outcome.status, outcome.iterations), (Status::Converged, 2 * n));
    }
}

/// √(Σ v²/`W_αα`) over the contacts that press, and which these are.
fn left(problem: &Packing, r: &[f64]) -> (f64, Vec<bool>) {
    let (mut velocity, mut v) = (vec![Vector2::zeros(); problem.grain_count()], vec![0.0; r.len()]);
    problem.velocity(r, &mut velocity);
    problem.relative_velocity(&velocity, &mut v);
    let presses: Vec<bool> = r.iter().map(|r| *r > 0.0).collect();
    let terms = v.iter().zip(problem.delassus_diagonal()).zip(&presses);
    (terms.map(|((v, w), presses)| if *presses { v * v / w } else { 0.0 }).sum::<f64>().sqrt(), presses)
}

/// The set of pressing contacts stays from some iteration on. From then, the method is a conjugate gradient, and what is left is
/// below its bound 2 √C ((√C − 1)/(√C + 1))ᵏ, C the condition of these contacts, down to round-off.
#[test]
fn the_set_of_pressing_contacts_is_found_and_the_rest_is_a_conjugate_gradient() {
    for problem in [frozen("settled-60").problem, first_problem("triangular", &[]).problem] {
        for expansion in EXPANSIONS {
            let settings = Mprgp { expansion, preconditioner: Preconditioner::Diagonal, ..Mprgp::default() };
            let mut run = start(&settings, &problem);
            let (mut curve, mut set) = (Vec::new(), vec![false; problem.contact_count()]);
            for _ in 0..1000 {
                run.advance();
                let (left, presses) = left(&problem, &impulses(&*run, &problem));
                if presses != set {
                    curve.clear();
                    set = presses;
                }
                curve.push(left);
            }
            assert!(curve.len() > 500, "{settings:?}: found {} iterations ago", curve.len());
            let closed = Spectrum::of(&problem, Some(&set)).closed.unwrap();
            let root = (closed.greatest / closed.least).sqrt();
            let round_off = 1e-13 * problem.scale().sqrt();
            for (k, left) in (0..).zip(&curve) {
                let bound = 2.0 * root * ((root - 1.0) / (root + 1.0)).powi(k) * curve[0];
                assert!(*left <= bound + round_off, "{settings:?}, {k}: {left:e} left, {bound:e} allowed");
            }
            assert!(curve[curve.len() - 1] < round_off);
        }
    }
}

/// However much Γ asks for, proportioning comes when round-off is all that is left of φ.
#[test]
fn mprgp_solves_one_face_after_the_other_with_a_great_gamma() {
    let problem = frozen("settled-60").problem;
    let settings = Mprgp { gamma: 1e200, ..Mprgp::default() };
    let outcome = run(&settings, &problem, &vec![0.0; problem.contact_count()], 1e-9, 100_000);
    assert_eq!(outcome.status, Status::Converged, "{:?}", outcome.measures);
}

#[test]
fn settings_without_meaning_are_refused() {
    let problem = frozen("settled-60").problem;
    let r0 = vec![0.0; problem.contact_count()];
    let of = |gamma, step| Mprgp { gamma, step, ..Mprgp::default() };
    for (settings, key) in [
        (of(0.0, 1.0), "gamma"),
        (of(f64::NAN, 1.0), "gamma"),
        (of(1.0, 0.0), "step"),
        (of(1.0, 2.01), "step"),
    ] {
        let refused = settings.start(&problem, &r0).err();
        assert!(matches!(refused, Some(SetupError { key: found, .. }) if found == key), "{settings:?}");
    }
}

/// q(r), and what round-off may add to it (J): impulses that grow along the kernel of W cancel in it, as do the velocities that b is
/// made of.
fn energy(problem: &Packing, r: &[f64]) -> (f64, f64) {
    let q = Meter::new(problem).measure(r, 0.0).energy;
    let free = |contact: &Contact| -> f64 {
        contact.grains().map(|grain| problem.free_velocity()[grain as usize].norm()).sum()
    };
    let terms = r.iter().zip(problem.contacts()).zip(problem.delassus_diagonal());
    let of_contact =
        |((r, contact), w): ((&f64, &Contact), f64)| r * (contact.offset.abs() + free(contact) + w * r);
    let size: f64 = terms.map(of_contact).sum();
    (q, 64.0 * f64::EPSILON * size)
}

fn any_settings() -> impl Strategy<Value = Mprgp> {
    let expansion = prop_oneof![Just(Expansion::ProjectedCg), Just(Expansion::FixedStep)];
    let preconditioner = prop_oneof![Just(Preconditioner::None), Just(Preconditioner::Diagonal)];
    let settings = (preconditioner, -2.0..2.0_f64, prop_oneof![0.1..2.0_f64, Just(2.0)], expansion);
    settings.prop_map(|(preconditioner, exponent, step, expansion)| Mprgp {
        preconditioner,
        gamma: 10_f64.powf(exponent),
        step,
        expansion,
    })
}

proptest! {
    /// Of q − q* each iteration leaves no more than 1 − α̂ λmin / (ϑ (1 + max(Γ, 1/Γ)²)), with α̂ = min(ᾱ, 2/λmax − ᾱ) and
    /// ϑ = 2 max(ᾱ λmax, 1).
    #[test]
    fn mprgp_falls_as_fast_as_its_theorem_says(problem in any_problem(), settings in any_settings()) {
        let settings = Mprgp { preconditioner: Preconditioner::Diagonal, ..settings };
        let all = vec![true; problem.contact_count()];
        let closed = Spectrum::of(&problem, Some(&all)).closed.unwrap();
        let reference::Answer::Solution { impulses: solution, .. } = reference::solve(&problem) else {
            return Ok(());
        };
        if closed.redundant > 0 {
            return Ok(());
        }
        let step = settings.step / scaled_delassus_bound(&problem);
        let hat = step.min(2.0 / closed.greatest - step);
        let theta = 2.0 * f64::max(step * closed.greatest, 1.0);
        let factor = 1.0 - hat * closed.least / (theta * (1.0 + settings.gamma.max(1.0 / settings.gamma).powi(2)));
        let (least, mut iteration) = (energy(&problem, &solution), start(&settings, &problem));
        let mut before = energy(&problem, &vec![0.0; solution.len()]).0 - least.0;
        for k in 0..60 {
            iteration.advance();
            let (q, round_off) = energy(&problem, &impulses(&*iteration, &problem));
            let bound = factor * before + 2.0 * (least.1 + round_off);
            prop_assert!(q - least.0 <= bound, "{settings:?}, {factor}: {before:e} to {:e} in {k}", q - least.0);
            before = q - least.0;
        }
    }

    /// Round-off is that of the terms, which may grow along the kernel of W, and without bound where there is no solution.
    #[test]
    fn hazards_mprgp_never_increases_the_energy(
        problem in prop_oneof![any_problem(), chain(), lattice(), wedge()],
        settings in any_settings(),
    ) {
        let mut iteration = start(&settings, &problem);
        let (mut before, mut greatest) = (0.0, 0.0_f64);
        for k in 0..100 {
            iteration.advance();
            let (q, round_off) = energy(&problem, &impulses(&*iteration, &problem));
            greatest = greatest.max(round_off);
            prop_assert!(q <= before + greatest, "{settings:?}: q goes from {before:e} to {q:e} in iteration {k}");
            before = q;
        }
    }
}
