//! A run of the conjugate gradient, on products with any W and any law.

use crate::state::{Step, Turn};
use crate::{Law, Products, State};
use contact::precision::Precision;
use contact::{Iteration, Work};
use std::marker::PhantomData;

/// A run on one problem.
pub struct Run<P, I> {
    contacts: P,
    /// Λ ≥ λmax.
    greatest: f64,
    /// Least pᵗ W p that says something, over Λ |p|² (–): the square of round-off of M^-½ H p, with a margin.
    felt: f64,
    /// Round-off of u when it has been made from r (–).
    round_off: f64,
    /// uᵗ p and pᵗ p.
    descent: f64,
    squared: f64,
    /// q(r₀) − q(r), or less (J), where q is minimised.
    gain: f64,
    /// Size of the terms of u, where the law does not block it, when it was last made from r: √(Σ b² + Σ (`W_αα` r)²).
    size: f64,
    iterations: u64,
    products: u64,
    law: PhantomData<I>,
}

/// After so many iterations u is made from r. Between, it moves by −α W p, which β needs anyway, and by what the law adds; that lets u and
/// r part by round-off. Without friction the law adds at few contacts, so that a product with W less is made.
const WHOLE: u64 = 16;

/// Multiple of the unit round-off that M^-½ H p may be off, relative to √Λ |p| (–).
const MARGIN: f64 = 16.0;

impl<P: Products<I>, I: Law> Run<P, I> {
    /// Begins from the impulses that the contacts have; `greatest` is at least λmax of W in their units, and `precision` that of its products.
    pub fn new(contacts: P, greatest: f64, precision: Precision) -> Self {
        let single = f64::from(f32::EPSILON);
        let [of_product, of_gradient] = match precision {
            Precision::Double => [f64::EPSILON; 2],
            Precision::Mixed => [single, f64::EPSILON],
            Precision::Single => [single; 2],
        };
        let mut run = Self {
            contacts,
            greatest,
            felt: MARGIN * MARGIN * of_product * of_product,
            round_off: of_gradient,
            descent: 0.0,
            squared: 0.0,
            gain: 0.0,
            size: 0.0,
            iterations: 0,
            products: 0,
            law: PhantomData,
        };
        run.renew(|_| {});
        run.turn(0.0);
        run
    }

    /// √(Σ `W_αα` |r − r⁺|²) of the iterate, from its gradient (√J): what the measure `natural_map` is a share of, with the diagonal
    /// as preconditioner.
    pub fn left(&self) -> f64 {
        self.contacts.sum_of(I::left).sqrt()
    }

    /// u from r, after a change of each contact; returns wᵗ W p.
    fn renew(&mut self, change: fn(&mut State<I>)) -> f64 {
        self.products += 1;
        self.contacts.set_exact(true);
        self.contacts.push(|at| {
            change(at);
            at.r
        });
        let [product, squared_size] = self.contacts.pull_sums(|at, constants, of_r| {
            at.renew(constants, of_r);
            [at.product(), I::squared_size(at, constants)]
        });
        self.contacts.set_exact(false);
        self.size = squared_size.sqrt();
        product
    }

    /// p = w + β z, and the first half of W p.
    fn turn(&mut self, beta: f64) {
        [self.descent, self.squared] = self.contacts.push_by(Turn(beta));
    }

    /// r + α p + d, and u there; returns wᵗ W p, and by how much less q fell for d, if it is minimised.
    fn step(&mut self, length: f64) -> [f64; 2] {
        let is_due = self.iterations.is_multiple_of(WHOLE);
        let [mut product, mut uphill, added] = self.contacts.pull_and_push(Step(length));
        let mut of_d = 0.0;
        if is_due {
            if added > 0.0 {
                of_d = self.contacts.curvature();
            }
            product = self.renew(|_| {});
        } else if added > 0.0 || !I::MINIMISES {
            self.products += u64::from(!I::MINIMISES);
            [product, of_d] = self.contacts.correct();
        }
        // −uᵗ d + ½ dᵗ W d
        uphill += 0.5 * of_d;
        [product, uphill]
    }

    /// Reports whether uᵗ p is round-off: where p = w, no step can make q less.
    fn at_rest(&self) -> bool {
        !(self.descent > self.round_off * self.size * self.squared.sqrt())
    }

    /// A step along p and the next direction; `false` and no step where W hardly feels p, or p leads nowhere. Where q is minimised, it stays
    /// below q(r₀).
    fn conjugate_step(&mut self) -> bool {
        self.products += 1;
        let curvature = self.contacts.curvature();
        if self.at_rest() {
            return false;
        }
        if curvature > self.felt * self.greatest * self.squared {
            // α = uᵗ p / pᵗ W p;  q changes by −½ α uᵗ p − uᵗ d + ½ dᵗ W d
            let length = self.descent / curvature;
            let [product, uphill] = self.step(length);
            let gain = self.gain + 0.5 * length * self.descent - uphill;
            if gain >= 0.0 || !I::MINIMISES {
                self.gain = gain;
                // p = w + β z,  β = −wᵗ W p / pᵗ W p
                self.turn(-product / curvature);
                return true;
            }
            self.withdraw();
        }
        // As far as d = 0, where q decreases all the way.
        let reach = Some(self.contacts.least_of(I::reach)).filter(|reach| reach.is_finite()).unwrap_or(0.0);
        let goes = reach * self.greatest >= 1.0;
        if goes {
            self.short_step(reach);
        }
        goes
    }

    /// r and u as before the step, and the first half of W p.
    fn withdraw(&mut self) {
        self.renew(I::withdraw);
        self.contacts.push(|at| at.p);
        self.contacts.curvature();
    }

    /// A step along p that is no longer than it may be, and p = w.
    fn short_step(&mut self, length: f64) {
        self.step(length);
        self.turn(0.0);
    }
}

impl<P: Products<I>, I: Law> Iteration for Run<P, I> {
    fn advance(&mut self) {
        self.iterations += 1;
        if !self.conjugate_step() {
            self.turn(0.0);
            if !self.conjugate_step() {
                // The projected gradient's: q never increases on it. Where there is no solution, impulses grow by it.
                self.short_step(if self.at_rest() { 0.0 } else { 1.0 / self.greatest });
            }
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        self.contacts.impulses(r);
    }

    fn work(&self) -> Work {
        // W p in each iteration, and for each direction begun anew; W r before the first, and where u is made from r; with friction W d
        // elsewhere.
        Work { delassus_products: self.products, ..Work::default() }
    }
}
