//! Conjugate projected gradient on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, the paper's reference \[2\].
//!
//! M. Renouf, P. Alart, Conjugate gradient type algorithms for frictional multi-contact problems: applications to
//! granular materials, Comput. Methods Appl. Mech. Engrg. 194 (2005) 2019-2041. Cost of an iteration: one product
//! with W, in two passes over the contacts; the blocks in which these are made are for the threads alone.
//!
//! The reference does not say what to do where W is singular, as it is where contacts depend on each other: a direction that the
//! grains hardly feel makes a step so long that what r ≥ 0 cuts off would throw them out. So q(r) never exceeds q(r₀): where the
//! step would make it do so, or where pᵗ W p is round-off, it goes as far as the first contact that it would open, and the method
//! begins anew with p = w; if that is next to nothing, it makes the step of the projected gradient. Packings ask for none of this.

mod block;
mod products;
mod rough;
mod state;

pub use product::Preconditioner;
pub use products::Products;
pub use rough::{ConeRun, RoughRun};
pub use state::State;

use analysis::{delassus_bound, scaled_delassus_bound};
use block::{Block, Pass};
use contact::{Iteration, Mechanics, Packing, SetupError, Smooth, Solver, Work, law};
use partition::{Distributed, Refused, Share, Team};
use product::Layout;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the conjugate gradient; by default the plain method of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cg {
    /// Scaling of the gradient before it becomes a direction.
    pub preconditioner: Preconditioner,
}

/// A run on one problem.
pub struct Run<const D: usize = 2> {
    layout: Layout<Smooth<D>>,
    blocks: Vec<Block<D>>,
    /// Λ ≥ λmax(W), or λmax(W_D⁻¹W) where the diagonal preconditions.
    greatest: f64,
    /// uᵗ p.
    descent: f64,
    /// pᵗ p.
    squared: f64,
    /// q(r₀) − q(r), or less (J).
    gain: f64,
    /// Size of the terms of u = −(W r + b), where r ≥ 0 does not block it, when it was last made from r: √(Σ b² + Σ (`W_αα` r)²).
    size: f64,
    iterations: u64,
    products: u64,
}

/// After so many iterations u is made from r. Between, it moves by −α W p, which β needs anyway, and by what the maximum adds, at
/// the few contacts around it: that costs a product with W less, and lets u and r part by round-off.
const WHOLE: u64 = 16;

impl<const D: usize> Run<D> {
    /// √(Σ `W_αα` (r − r⁺)²) of the iterate, from its gradient (√J): what the measure `natural_map` is a share of.
    pub fn left(&self) -> f64 {
        let [squared] = self.layout.sum(self.blocks.iter().map(|block| [block.squared_left()]));
        squared.sqrt()
    }

    /// One pass over all blocks, each of which then sends what it has of the grains it shares; returns the sums over the blocks,
    /// which no number of threads changes.
    fn send_after(&mut self, pass: Pass) -> [f64; 2] {
        self.layout.send(&mut self.blocks, |block, sent| {
            block.make(pass);
            let (columns, shared) = block.shared(pass);
            columns.send(shared, sent);
        });
        self.sums()
    }

    /// Makes a pass before which each block takes the sums of what all have sent.
    fn receive_before(&mut self, pass: Pass) -> [f64; 2] {
        self.layout.receive(&mut self.blocks, |block, sums| {
            let (columns, shared) = block.shared(pass);
            columns.take(shared, sums);
            block.make(pass);
        });
        self.sums()
    }

    fn sums(&self) -> [f64; 2] {
        self.layout.sum(self.blocks.iter().map(Block::parts))
    }

    /// r = max(0, r + α p) = r + α p + d and u = −(W r + b); returns wᵗ W p and −uᵗ d + ½ dᵗ W d, with the u of r + α p.
    fn step(&mut self, length: f64) -> [f64; 2] {
        let sums = self.send_after(Pass::Step { length });
        let corrects = self.layout.any(self.blocks.iter().any(Block::added));
        if corrects { self.receive_before(Pass::Correct) } else { sums }
    }

    /// u from r; returns wᵗ W p.
    fn renew(&mut self) -> f64 {
        self.products += 1;
        self.send_after(Pass::Whole);
        let [product, squared_size] = self.receive_before(Pass::Afresh);
        self.size = squared_size.sqrt();
        product
    }

    /// p = w + β z.
    fn turn(&mut self, beta: f64) {
        [self.descent, self.squared] = self.send_after(Pass::Turn { beta });
    }

    /// Reports whether uᵗ p is round-off: where p = w, no step can make q less.
    fn at_rest(&self) -> bool {
        !(self.descent > f64::EPSILON * self.size * self.squared.sqrt())
    }

    /// A step along p that keeps q below q(r₀), and the next direction; `false` and no step if there is none.
    fn conjugate_step(&mut self) -> bool {
        self.products += 1;
        let [curvature, _] = self.receive_before(Pass::Curvature);
        if self.at_rest() {
            return false;
        }
        if curvature > ROUND_OFF * ROUND_OFF * self.greatest * self.squared {
            // α = uᵗ p / pᵗ W p;  q changes by −½ α uᵗ p − uᵗ d + ½ dᵗ W d
            let length = self.descent / curvature;
            let [mut product, uphill] = self.step(length);
            let gain = self.gain + 0.5 * length * self.descent - uphill;
            if gain >= 0.0 {
                self.gain = gain;
                if self.iterations.is_multiple_of(WHOLE) {
                    product = self.renew();
                }
                // p = w + β z,  z = p on the set of w, else 0,  β = −wᵗ W p / pᵗ W p
                self.turn(-product / curvature);
                return true;
            }
            self.blocks.iter_mut().for_each(Block::withdraw);
        }
        // As far as no contact opens, d = 0 and q decreases all the way.
        let reach = self.blocks.iter().filter_map(Block::reach).fold(f64::INFINITY, f64::min);
        let reach = Some(self.layout.least(reach)).filter(|reach| reach.is_finite()).unwrap_or(0.0);
        let goes = reach * self.greatest >= 1.0;
        if goes {
            self.short_step(reach);
        }
        goes
    }

    /// A step along p that is no longer than it may be, and p = w.
    fn short_step(&mut self, length: f64) {
        self.step(length);
        if self.iterations.is_multiple_of(WHOLE) {
            self.renew();
        }
        self.turn(0.0);
    }
}

impl<const D: usize> Iteration for Run<D> {
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
        self.blocks.iter().for_each(|block| block.impulses(r));
    }

    fn work(&self) -> Work {
        // W p in each iteration, and for each direction begun anew; W r before the first, and where u is made from r. What the
        // maximum adds is no product.
        Work { delassus_products: self.products, ..Work::default() }
    }
}

/// Round-off, with a margin, of M^-½ H p relative to √Λ |p| (–): pᵗ W p says nothing below its square.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

impl Cg {
    /// A run on `problem` from the impulses `r0` (N·s), for those who look into it.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn run<const D: usize>(
        &self,
        problem: &Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Run<D>, SetupError> {
        let greatest =
            if self.is_scaled() { scaled_delassus_bound(problem) } else { delassus_bound(problem) };
        Ok(self.over(Layout::new(problem)?, problem, greatest, r0))
    }

    fn is_scaled(self) -> bool {
        self.preconditioner == Preconditioner::Diagonal
    }

    /// A run on the blocks of a layout of `problem`, with Λ.
    fn over<const D: usize>(
        self,
        layout: Layout<Smooth<D>>,
        problem: &Packing<Smooth<D>>,
        greatest: f64,
        r0: &[f64],
    ) -> Run<D> {
        let b = problem.b();
        let mut run = Run {
            blocks: layout.blocks(problem, self.is_scaled(), |columns, subdomain| {
                Block::new(columns, subdomain, &b, r0)
            }),
            greatest,
            layout,
            descent: 0.0,
            squared: 0.0,
            gain: 0.0,
            size: 0.0,
            iterations: 0,
            products: 0,
        };
        run.renew();
        run.turn(0.0);
        run
    }

    /// Λ of a problem of which `share` is a part, where `layout` is that of the share.
    fn greatest_of<M: Mechanics>(self, share: &Share<M>, layout: &Layout<M>) -> f64 {
        let bound = share.whole.scaled_delassus_bound;
        let greatest = || law::greatest(share.problem.delassus_diagonal().into_iter());
        if self.is_scaled() { bound } else { bound * layout.greatest(greatest()) }
    }
}

impl<const D: usize> Distributed<Smooth<D>> for Cg {
    fn start_in<'p>(
        &self,
        share: &'p Share<Smooth<D>>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let layout = Layout::of_share(share, team);
        let greatest = self.greatest_of(share, &layout);
        Ok(Box::new(self.over(layout, &share.problem, greatest, r0)))
    }
}

impl<const D: usize> Solver<Smooth<D>> for Cg {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.run(problem, r0)?))
    }
}
