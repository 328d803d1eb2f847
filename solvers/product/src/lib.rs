//! W p = (M^-½ H)ᵗ (M^-½ H p) in two passes over mass-scaled contacts, block by block in threads: one kernel for the methods
//! that are made of products, so that their seconds compare the methods.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod layout;

pub use layout::{Columns, Layout};
pub use partition::Subdomain;

use contact::{Packing, SetupError};
use nalgebra::Vector2;
use pulp::Arch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What scales the impulses, and with them the gradient, of a method that is made of products.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// Nothing: D = 1.
    #[default]
    None,
    /// D = `W_D`, the diagonal of W.
    Diagonal,
}

/// Products with W, and a state of type `C` at each contact: what a method knows of it, its p among it.
///
/// With the unit 1, impulses and velocities are r and v. With the unit √`W_αα`, √`W_αα` r and v/√`W_αα` stand in their place: a
/// method in these unknowns is the one preconditioned by the diagonal of W.
pub struct Product<C> {
    layout: Layout,
    blocks: Vec<Block<C>>,
}

struct Block<C> {
    columns: Columns,
    states: Vec<C>,
    /// M^-½ H p; of grains that blocks share, each has the sum after it has been received.
    y: Vec<Vector2<f64>>,
    /// What the block adds to the sum that the last pass was for.
    part: f64,
}

impl<C: Send + Sync> Product<C> {
    /// The contacts of `problem`, each with a unit, 1 or √`W_αα` if they are `scaled`; `state` makes what the method knows of
    /// a contact from its index in the problem and its unit.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn new(
        problem: &Packing,
        scaled: bool,
        state: impl Fn(usize, f64) -> C + Sync,
    ) -> Result<Self, SetupError> {
        let layout = Layout::new(problem)?;
        let blocks = layout.blocks(problem, scaled, |columns, subdomain| Block {
            states: columns.units().map(|(contact, unit)| state(contact, unit)).collect(),
            y: vec![Vector2::zeros(); subdomain.grains.len()],
            columns,
            part: 0.0,
        });
        Ok(Self { layout, blocks })
    }

    /// First half of the product, y = M^-½ H p: `p` gives the p of each contact. Returns pᵗ p.
    pub fn push(&mut self, p: impl Fn(&mut C) -> f64 + Sync) -> f64 {
        self.layout.send(&mut self.blocks, |block, sent| {
            Arch::new().dispatch(|| block.push(&p));
            block.columns.send(&block.y, sent);
        });
        self.sum()
    }

    /// Second half: `take` is given (W p)_α of each contact.
    pub fn pull(&mut self, take: impl Fn(&mut C, f64) + Sync) {
        self.layout.receive(&mut self.blocks, |block, sums| {
            block.columns.take(&mut block.y, sums);
            Arch::new().dispatch(|| block.pull(&take));
        });
    }

    /// pᵗ W p = |y|² of the p last pushed, without the second half.
    pub fn curvature(&mut self) -> f64 {
        self.layout.receive(&mut self.blocks, |block, sums| {
            block.columns.take(&mut block.y, sums);
            Arch::new().dispatch(|| block.square());
        });
        self.sum()
    }

    /// The sum of a `term` over the contacts.
    pub fn sum_of(&mut self, term: impl Fn(&C) -> f64 + Sync) -> f64 {
        self.layout.each(&mut self.blocks, |block| block.part = block.states.iter().map(&term).sum());
        self.sum()
    }

    /// Puts the impulses that `r` reads from each contact in the problem's order (N·s).
    pub fn impulses(&self, r: impl Fn(&C) -> f64, impulses: &mut [f64]) {
        for block in &self.blocks {
            block.columns.impulses(block.states.iter().map(&r), impulses);
        }
    }

    fn sum(&self) -> f64 {
        self.blocks.iter().map(|block| block.part).sum()
    }
}

impl<C> Block<C> {
    #[inline(always)]
    fn push(&mut self, p: &impl Fn(&mut C) -> f64) {
        self.y.fill(Vector2::zeros());
        self.part = 0.0;
        for (column, state) in self.columns.scaled.iter().zip(&mut self.states) {
            let p = p(state);
            column.push(p, &mut self.y);
            self.part += p * p;
        }
    }

    #[inline(always)]
    fn pull(&mut self, take: &impl Fn(&mut C, f64)) {
        for (column, state) in self.columns.scaled.iter().zip(&mut self.states) {
            take(state, column.relative(&self.y));
        }
    }

    #[inline(always)]
    fn square(&mut self) {
        self.part = self.y.iter().zip(&self.columns.share).map(|(y, share)| share * y.norm_squared()).sum();
    }
}
