//! Modified proportioning with reduced gradient projections, MPRGP, on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r: conjugate
//! gradients on the contacts that press, which end where q falls faster by letting others press.
//!
//! Z. Dostál, J. Schöberl, Minimizing quadratic functions subject to bound constraints with the rate of convergence and finite
//! termination, Comput. Optim. Appl. 30 (2005) 23-43; Z. Dostál, Optimal Quadratic Programming Algorithms, Springer 2009, ch. 5.
//! What is free and what is chopped of u = −(W r + b), minus the gradient of q,
//!
//! φ = u where r > 0, else 0;   β = max(0, u) where r = 0, else 0;   φ̃ = max(φ, −r/ᾱ)
//!
//! decides what an iteration is:
//!
//! - |β|² > Γ² φ̃ᵗ φ: *proportioning*, to the least q along p = β;
//! - else the least q along p, conjugate to the p before: a step of *conjugate gradients*;
//! - where that would make r negative, an *expansion* of the set of open contacts. The original goes as far along p as r ≥ 0 lets it,
//!   and from there to max(0, r + ᾱ φ). The other goes to max(0, r + α p), the projection of the whole step: J. Kružík, D. Horák,
//!   M. Čermák, L. Pospíšil, M. Pecha, Active set expansion strategies in MPRGP algorithm, Adv. Eng. Softw. 149 (2020) 102895.
//!
//! After all but the second, p = φ. Where W is regular, each iteration leaves of q − q* no more than the share
//!
//! 1 − α̂ λmin / (ϑ (1 + max(Γ, 1/Γ)²)),   α̂ = min(ᾱ, 2/λmax − ᾱ),   ϑ = 2 max(ᾱ λmax, 1)
//!
//! and there is a last one if no contact of the solution has both v = 0 and r = 0, or Γ is large enough. The proof does not cover
//! the projected step. So here that is taken only if q falls by ᾱ (1 − s/2) φ̃ᵗ φ at least, as it surely does along ᾱ φ̃; else the
//! original one is made in its place, after two products with W more.
//!
//! Cost of an iteration: one product with W, in two passes over the contacts. What the projection adds is none: it moves u at the
//! few contacts around. The expansion by a fixed step makes a second one, and so does every 16th iteration, for u from r.
//!
//! The sources have no flat directions, which W has where it is singular. Where pᵗ W p is round-off, p is followed up to the first
//! contact that it opens; if there is none, the step is that of the projected gradient with ᾱ. Where uᵗ p is round-off, r stays.

mod state;

pub use product::Preconditioner;

use analysis::{delassus_bound, scaled_delassus_bound};
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work, law};
use product::Product;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use state::{Constants, Contact};

/// Step taken where the conjugate step would make impulses negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Expansion {
    /// All of it, and then max(0, r).
    #[default]
    ProjectedCg,
    /// As much as r ≥ 0 lets, and then max(0, r + ᾱ φ).
    FixedStep,
}

/// Settings of MPRGP.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mprgp {
    /// Scaling of the unknowns: r ≥ 0 acts on each alone, so the method is the same in √D r.
    pub preconditioner: Preconditioner,
    /// Γ (–): the set of pressing contacts grows where |β|² > Γ² φ̃ᵗ φ.
    pub gamma: f64,
    /// s (–), above 0 and at most 2: the fixed step is ᾱ = s/Λ, where Λ ≥ λmax(W). The proof of 2005 takes s ≤ 1, that of 2009 s < 2.
    pub step: f64,
    /// Rule by which the set of open contacts grows.
    pub expansion: Expansion,
}

/// Γ = 1 as in the sources; s and the expansion are measured here: products with W to a natural map of 1e-6, in the geometric mean
/// over the seven frozen problems. Γ from 0.2 to 2 makes a difference of 5 %, and 10 takes 40 % more. With the original expansion
/// s = 1.9 takes the fewest of 0.5, 1, 1.5, 1.9 and 2, by 1 to 9 %; the projected step takes 22 % less than that.
impl Default for Mprgp {
    fn default() -> Self {
        Self {
            preconditioner: Preconditioner::None,
            gamma: 1.0,
            step: 1.9,
            expansion: Expansion::ProjectedCg,
        }
    }
}

/// After so many iterations u is made from r. Between, it moves with r, and parts from it by round-off.
const WHOLE: u64 = 16;

/// Round-off, with a margin, of M^-½ H p relative to √Λ |p| (–): pᵗ W p says nothing below its square.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

struct Run<const D: usize> {
    product: Product<Contact, Constants, Smooth<D>>,
    expansion: Expansion,
    gamma: f64,
    /// ᾱ, and ᾱ (1 − s/2).
    step: f64,
    sure: f64,
    /// Λ ≥ λmax(W).
    greatest: f64,
    /// φ̃ᵗ φ and βᵗ β.
    free: f64,
    chopped: f64,
    /// True where p is β; true where it is conjugate to another.
    proportions: bool,
    conjugate: bool,
    /// uᵗ p and pᵗ p.
    descent: f64,
    squared: f64,
    /// Size of the terms of u, where r ≥ 0 does not block it, when it was last made from r: √(Σ b² + Σ (`W_αα` r)²).
    size: f64,
    iterations: u64,
    products: u64,
}

impl<const D: usize> Run<D> {
    /// u from r.
    fn renew(&mut self) {
        let inverse_step = 1.0 / self.step;
        self.products += 1;
        self.product.push(|at| at.r);
        let [squared_size, free, chopped] = self.product.pull_sums(|at, constants, of_r| {
            let Constants { b, diagonal } = constants;
            at.u = -(of_r + b);
            let pressed = diagonal * at.r;
            let is_blocked = !(at.r > 0.0 || at.u > 0.0);
            let squared_size = if is_blocked { 0.0 } else { b * b + pressed * pressed };
            let [free, chopped] = at.split(inverse_step);
            [squared_size, free, chopped]
        });
        (self.size, self.free, self.chopped) = (squared_size.sqrt(), free, chopped);
    }

    /// p = β, or φ + `weight` p.
    fn turn(&mut self, weight: f64) {
        self.proportions = self.chopped > self.gamma * (self.gamma * self.free);
        self.conjugate = !self.proportions && weight != 0.0;
        let of = |at: &mut Contact, p: f64| {
            at.p = p;
            (p, [at.u * p, p * p])
        };
        [self.descent, self.squared] = if self.proportions {
            self.product.push_sums(|at| of(at, at.chopped()))
        } else {
            self.product.push_sums(|at| of(at, if at.r > 0.0 { at.u + weight * at.p } else { 0.0 }))
        };
    }

    /// r = max(0, r + α p), and u as if the maximum added nothing; returns φᵗ W p and how much it added.
    fn advance_along(&mut self, length: f64) -> [f64; 2] {
        let inverse_step = 1.0 / self.step;
        let [product, free, chopped, added] = self.product.pull_sums(|at, _, of_p| {
            (at.r_before, at.u_before) = (at.r, at.u);
            at.r = law::non_negative(at.r + length * at.p);
            at.u -= length * of_p;
            let [free, chopped] = at.split(inverse_step);
            [at.free() * of_p, free, chopped, at.added(length)]
        });
        (self.free, self.chopped) = (free, chopped);
        [product, added]
    }

    /// u with what the maximum added to r; returns by how much less q fell for it.
    fn correct(&mut self, length: f64) -> f64 {
        // −uᵗ d + ½ dᵗ W d
        let uphill = -self.product.sum_of(|at| at.u * at.added(length));
        self.product.push_few(|at| at.added(length));
        let [_, curvature] = self.product.pull_around(|at, of_d| {
            at.u -= of_d;
            0.0
        });
        let inverse_step = 1.0 / self.step;
        [self.free, self.chopped] = self.product.sums_of(|at| at.split(inverse_step));
        uphill + 0.5 * curvature
    }

    /// r and u as they were before the step.
    fn withdraw(&mut self) {
        self.product.each(|at| (at.r, at.u) = (at.r_before, at.u_before));
    }

    /// As far along p as no contact opens, then to max(0, r + ᾱ φ); where none ever would, to max(0, r + ᾱ u).
    fn expand(&mut self) {
        let reach = self.product.least_of(|at| if at.p < 0.0 { -at.r / at.p } else { f64::INFINITY });
        let opens = reach.is_finite();
        if opens {
            self.advance_along(reach);
        }
        let step = self.step;
        self.products += 1;
        self.product.push(|at| {
            let p = step * if opens { at.free() } else { at.u };
            at.p = if p < -at.r { -at.r } else { p };
            at.p
        });
        self.advance_along(1.0);
    }

    /// A step along p, or an expansion; returns the weight of p in the next direction, or nothing where uᵗ p is round-off.
    fn step(&mut self) -> Option<f64> {
        if !(self.descent > f64::EPSILON * self.size * self.squared.sqrt()) {
            return None;
        }
        self.products += 1;
        let curvature = self.product.curvature();
        if curvature > ROUND_OFF * ROUND_OFF * self.greatest * self.squared {
            // α = uᵗ p / pᵗ W p;  q falls by ½ α uᵗ p
            let (length, sure) = (self.descent / curvature, self.sure * self.free);
            let [product, added] = self.advance_along(length);
            if added == 0.0 {
                // p = φ − (φᵗ W p / pᵗ W p) p
                return Some(if self.proportions { 0.0 } else { -product / curvature });
            }
            let projects = self.expansion == Expansion::ProjectedCg;
            if projects && 0.5 * length * self.descent - self.correct(length) >= sure {
                return Some(0.0);
            }
            self.withdraw();
            if projects {
                self.products += 1;
                self.product.push(|at| at.p);
            }
        }
        self.expand();
        Some(0.0)
    }
}

impl<const D: usize> Iteration for Run<D> {
    fn advance(&mut self) {
        self.iterations += 1;
        let mut weight = self.step();
        if weight.is_none() && self.conjugate {
            self.turn(0.0);
            weight = self.step();
        }
        if weight.is_none() {
            // Nothing is left of φ but round-off, which a great Γ takes for more than β.
            self.free = 0.0;
        }
        if self.iterations.is_multiple_of(WHOLE) {
            self.renew();
        }
        self.turn(weight.unwrap_or(0.0));
    }

    fn impulses(&self, r: &mut [f64]) {
        self.product.impulses(|at| at.r, r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl<const D: usize> Solver<Smooth<D>> for Mprgp {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("gamma", self.gamma)?;
        let has_meaning = self.step > 0.0 && self.step <= 2.0;
        SetupError::unless(has_meaning, "step", self.step, "above 0 and at most 2")?;
        let (b, diagonal) = (problem.b(), problem.delassus_diagonal());
        let scaled = self.preconditioner == Preconditioner::Diagonal;
        let greatest = if scaled { scaled_delassus_bound(problem) } else { delassus_bound(problem) };
        let step = if greatest > 0.0 { self.step / greatest } else { 0.0 };
        let contact = |contact: usize, unit: f64| {
            let constants = Constants { b: b[contact] / unit, diagonal: diagonal[contact] / (unit * unit) };
            let r = r0[contact] * unit;
            (Contact { r, u: 0.0, p: 0.0, r_before: 0.0, u_before: 0.0 }, constants)
        };
        let mut run = Run {
            product: Product::new(problem, scaled, contact)?.with_neighbours(),
            expansion: self.expansion,
            gamma: self.gamma,
            step,
            sure: step * (1.0 - 0.5 * self.step),
            greatest,
            free: 0.0,
            chopped: 0.0,
            proportions: false,
            conjugate: false,
            descent: 0.0,
            squared: 0.0,
            size: 0.0,
            iterations: 0,
            products: 0,
        };
        run.renew();
        run.turn(0.0);
        Ok(Box::new(run))
    }
}
