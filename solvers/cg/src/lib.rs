//! Conjugate projected gradient on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, the paper's reference \[2\].
//!
//! M. Renouf, P. Alart, Conjugate gradient type algorithms for frictional multi-contact problems: applications to
//! granular materials, Comput. Methods Appl. Mech. Engrg. 194 (2005) 2019-2041. Cost of an iteration: two products
//! with W, in three passes over the contacts; the blocks in which these are made are for the threads alone.

mod block;

use block::Block;
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
    /// M^-½ H p, block by block in local indices; of grains that blocks share, each has the sum.
    y: Vec<Vec<Vector2<f64>>>,
    /// What a step adds to M^-½ H r beyond α y, likewise.
    change: Vec<Vec<Vector2<f64>>>,
    /// What blocks share of y or of the change, after the last assembly.
    sums: Vec<Vector2<f64>>,
    contacts: usize,
    /// What each block adds to a scalar product.
    parts: Vec<f64>,
    /// uᵗ p.
    descent: f64,
    iterations: u64,
    products: u64,
}

/// After so many iterations M^-½ H r is made from r. Between, it moves by M^-½ H α p and by what the maximum adds, which costs
/// a pass less and lets the two part by the round-off of r.
const WHOLE: u64 = 16;

impl Run {
    /// One pass over all contacts; returns the sum over the blocks, which no number of threads changes.
    fn pass(
        &mut self,
        pass: impl Fn(&mut Block, &mut [Vector2<f64>], &mut [Vector2<f64>]) -> f64 + Sync + Send,
    ) -> f64 {
        let y = self.y.par_iter_mut().zip(&mut self.change);
        let blocks = self.blocks.par_iter_mut().zip(y).zip(&mut self.parts);
        let together = together(NS_PER_CONTACT * self.contacts);
        blocks.with_min_len(together).for_each(|((block, (y, change)), part)| *part = pass(block, y, change));
        self.parts.iter().sum()
    }

    /// r = max(0, r + α p) and u = −(W r + b); returns wᵗ W p.
    fn step(&mut self, length: f64) -> f64 {
        let whole = self.iterations.is_multiple_of(WHOLE);
        self.pass(|block, _, change| {
            block.step(length, whole, change);
            0.0
        });
        self.decomposition.assemble(&mut self.change, &mut self.sums);
        self.pass(|block, y, change| block.gradient(length, whole, y, change))
    }

    /// p = w + β z.
    fn turn(&mut self, beta: f64) {
        self.descent = self.pass(|block, y, _| block.turn(beta, y));
        self.decomposition.assemble(&mut self.y, &mut self.sums);
    }
}

impl Iteration for Run {
    fn advance(&mut self) {
        // pᵗ W p is 0 at a solution, where p = 0; and on a problem without one, along a p of which grains feel nothing:
        // there the iterate stays.
        let curvature = self.pass(|block, y, _| block.curvature(y));
        let ratio = |numerator: f64| if curvature == 0.0 { 0.0 } else { numerator / curvature };

        // α = uᵗ p / pᵗ W p
        self.iterations += 1;
        let product = self.step(ratio(self.descent));
        self.products += 2;

        // p = w + β z,  z = p on the set of w, else 0,  β = −wᵗ W p / pᵗ W p
        self.turn(-ratio(product));
    }

    fn impulses(&self, r: &mut [f64]) {
        self.blocks.iter().for_each(|block| block.impulses(r));
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
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
        let zeros: Vec<_> =
            subdomains.iter().map(|block| vec![Vector2::zeros(); block.grains.len()]).collect();
        let mut run = Run {
            blocks: subdomains.iter().map(block).collect(),
            y: zeros.clone(),
            change: zeros,
            sums: vec![Vector2::zeros(); decomposition.boundary_count()],
            contacts: problem.contact_count(),
            parts: vec![0.0; subdomains.len()],
            decomposition,
            descent: 0.0,
            iterations: 0,
            products: 1,
        };
        // p = 0 so far: u of r0, and p = w.
        run.step(0.0);
        run.turn(0.0);
        Ok(Box::new(run))
    }
}
