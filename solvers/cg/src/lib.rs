//! Conjugate projected gradient on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, the paper's reference \[2\].
//!
//! M. Renouf, P. Alart, Conjugate gradient type algorithms for frictional multi-contact problems: applications to
//! granular materials, Comput. Methods Appl. Mech. Engrg. 194 (2005) 2019-2041. Cost of an iteration: one product
//! with W, in two passes over the contacts; the blocks in which these are made are for the threads alone.

mod block;

use block::{Block, Pass};
use contact::{ContactProblem, Iteration, SetupError, Solver, Work, together};
use nalgebra::Vector2;
use partition::{Decomposition, Grid, Scheme, Subdomain};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the conjugate gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cg {
    /// What scales the gradient before it becomes a direction.
    pub preconditioner: Preconditioner,
}

/// The plain method of the reference.
impl Default for Cg {
    fn default() -> Self {
        Self { preconditioner: Preconditioner::None }
    }
}

/// What scales the gradient before it becomes a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// Nothing.
    None,
    /// `W_D`, the diagonal of W.
    Diagonal,
}

struct Run {
    decomposition: Decomposition,
    blocks: Vec<Block>,
    /// What blocks show each other of the grains they share.
    shown: Vec<Vec<Vector2<f64>>>,
    contacts: usize,
    /// uᵗ p.
    descent: f64,
    iterations: u64,
}

/// After so many iterations u is made from r. Between, it moves by −α W p, which β needs anyway, and by what the maximum adds, at
/// the few contacts around it: that costs a product with W less, and lets u and r part by round-off.
const WHOLE: u64 = 16;

impl Run {
    /// One pass over all blocks, each of which then shows what it has of the grains it shares; returns the sum over the blocks,
    /// which no number of threads changes.
    fn show_after(&mut self, pass: Pass) -> f64 {
        let blocks = self.blocks.par_iter_mut().zip(&mut self.shown).enumerate();
        blocks.with_min_len(together(NS_PER_CONTACT * self.contacts)).for_each(|(e, (block, shown))| {
            block.make(pass);
            self.decomposition.show(e, block.shared(pass), shown);
        });
        self.blocks.iter().map(Block::part).sum()
    }

    /// The same, but each block first adds up what all have shown.
    fn assemble_before(&mut self, pass: Pass) -> f64 {
        let blocks = self.blocks.par_iter_mut().enumerate();
        blocks.with_min_len(together(NS_PER_CONTACT * self.contacts)).for_each(|(e, block)| {
            self.decomposition.assemble(e, &self.shown, block.shared(pass));
            block.make(pass);
        });
        self.blocks.iter().map(Block::part).sum()
    }

    /// r = max(0, r + α p) and u = −(W r + b); returns wᵗ W p.
    fn step(&mut self, length: f64) -> f64 {
        if self.iterations.is_multiple_of(WHOLE) {
            self.show_after(Pass::Whole { length });
            return self.assemble_before(Pass::Afresh);
        }
        let product = self.show_after(Pass::Step { length });
        if self.blocks.iter().any(Block::added) { self.assemble_before(Pass::Correct) } else { product }
    }

    /// p = w + β z.
    fn turn(&mut self, beta: f64) {
        self.descent = self.show_after(Pass::Turn { beta });
    }
}

impl Iteration for Run {
    fn advance(&mut self) {
        // pᵗ W p is 0 at a solution, where p = 0; and on a problem without one, along a p of which grains feel nothing:
        // there the iterate stays.
        let curvature = self.assemble_before(Pass::Curvature);
        let ratio = |numerator: f64| if curvature == 0.0 { 0.0 } else { numerator / curvature };

        // α = uᵗ p / pᵗ W p
        self.iterations += 1;
        let product = self.step(ratio(self.descent));

        // p = w + β z,  z = p on the set of w, else 0,  β = −wᵗ W p / pᵗ W p
        self.turn(-ratio(product));
    }

    fn impulses(&self, r: &mut [f64]) {
        self.blocks.iter().for_each(|block| block.impulses(r));
    }

    fn work(&self) -> Work {
        // W p in each iteration; W r before the first, and where u is made from r. What the maximum adds is no product.
        let products = self.iterations + self.iterations / WHOLE + 1;
        Work { delassus_products: products, ..Work::default() }
    }
}

/// What a pass takes per contact, about (ns).
const NS_PER_CONTACT: usize = 3;

/// Contacts of a block, about: few enough that some threads have work where there is work for them, so many that blocks
/// share few grains.
const BLOCK: usize = 8192;

/// Columns and rows of blocks, of equal numbers of contacts.
fn grid(contacts: usize) -> Grid {
    let blocks = contacts.div_ceil(BLOCK).max(1);
    let n = (blocks - 1).isqrt() as u32 + 1;
    Grid { nx: n, ny: n }
}

impl Solver for Cg {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let partition = Scheme::Balanced.partition(problem, grid(problem.contact_count()))?;
        let decomposition = Decomposition::new(problem, &partition);
        let (b, preconditioned) = (problem.b(), self.preconditioner == Preconditioner::Diagonal);
        let subdomains = &decomposition.subdomains;
        let multiplicity = &decomposition.multiplicity;
        let block =
            |subdomain: &Subdomain| Block::new(problem, subdomain, multiplicity, preconditioned, &b, r0);
        let shown =
            decomposition.copies_by_subdomain().map(|copies| vec![Vector2::zeros(); copies]).collect();
        let mut run = Run {
            blocks: subdomains.par_iter().map(block).collect(),
            shown,
            contacts: problem.contact_count(),
            decomposition,
            descent: 0.0,
            iterations: 0,
        };
        // p = 0 so far: u of r0, and p = w.
        run.step(0.0);
        run.turn(0.0);
        Ok(Box::new(run))
    }
}
