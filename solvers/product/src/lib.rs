//! W p = (M^-½ H)ᵗ (M^-½ H p) in two passes over mass-scaled contacts, block by block in threads: one kernel for the methods
//! that are made of products, so that their seconds compare the methods.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod layout;

pub use layout::{Columns, Layout};
pub use partition::Subdomain;

use contact::{Adjacency, Discs, Mechanics, Packing, SetupError, Smooth, Vector, Visited};
use nalgebra::SVector;
use pulp::Arch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Scaling of the impulses, and with them of the gradient, of a method that is made of products.
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
pub struct Product<C, M: Mechanics = Discs> {
    layout: Layout<M>,
    blocks: Vec<Block<C, M>>,
}

struct Block<C, M: Mechanics> {
    columns: Columns<M>,
    states: Vec<C>,
    /// M^-½ H p; of grains that blocks share, each has the sum after it has been received.
    y: Vec<M::Velocity>,
    /// Contribution of the block to the sums that the last pass was for.
    parts: [f64; SUMS],
    /// The contacts around each grain, where [`Product::pull_around`] is wanted.
    adjacency: Option<Adjacency>,
}

/// As many sums as a pass may be for.
const SUMS: usize = 4;

/// `N` sums where there is room for [`SUMS`].
fn parts<const N: usize>(sums: [f64; N]) -> [f64; SUMS] {
    const { assert!(N <= SUMS, "a pass has room for no more sums") };
    std::array::from_fn(|k| if k < N { sums[k] } else { 0.0 })
}

impl<C: Send + Sync, M: Mechanics> Product<C, M> {
    /// The contacts of `problem`, each with a unit, 1 or √`W_αα` if they are `scaled`; `state` makes what the method knows of
    /// a contact from its index in the problem and its unit.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn new(
        problem: &Packing<M>,
        scaled: bool,
        state: impl Fn(usize, M::Impulse) -> C + Sync,
    ) -> Result<Self, SetupError> {
        Ok(Self::over(Layout::new(problem)?, problem, scaled, state))
    }

    /// Returns the product on the blocks of a layout, whose contacts and grains are those of `problem`.
    pub fn over(
        layout: Layout<M>,
        problem: &Packing<M>,
        scaled: bool,
        state: impl Fn(usize, M::Impulse) -> C + Sync,
    ) -> Self {
        let blocks = layout.blocks(problem, scaled, |columns, subdomain| Block {
            states: columns.units().map(|(contact, unit)| state(contact, unit)).collect(),
            y: vec![M::Velocity::ZERO; subdomain.grains.len()],
            columns,
            parts: [0.0; SUMS],
            adjacency: None,
        });
        Self { layout, blocks }
    }

    /// Returns the product, ready for [`Product::pull_around`].
    #[must_use]
    pub fn with_neighbours(mut self) -> Self {
        for (block, subdomain) in self.blocks.iter_mut().zip(self.layout.subdomains()) {
            block.adjacency = Some(Adjacency::new(subdomain.ends.iter().copied(), subdomain.grains.len()));
        }
        self
    }

    /// First half of the product, y = M^-½ H p: `p` gives the p of each contact. Returns pᵗ p.
    pub fn push(&mut self, p: impl Fn(&mut C) -> M::Impulse + Sync) -> f64 {
        let [squared] = self.push_sums(|at| {
            let p = p(at);
            (p, [p.dot_product(p)])
        });
        squared
    }

    /// [`push`](Self::push), where `p` also gives the terms of sums over the contacts, which take the place of pᵗ p.
    pub fn push_sums<const N: usize>(
        &mut self,
        p: impl Fn(&mut C) -> (M::Impulse, [f64; N]) + Sync,
    ) -> [f64; N] {
        self.layout.send(&mut self.blocks, |block, sent| {
            Arch::new().dispatch(|| block.push(&p));
            block.columns.send(&block.y, sent);
        });
        self.sums()
    }

    /// [`push`](Self::push) of a `p` that is 0 at most contacts, which then cost next to nothing.
    pub fn push_few(&mut self, p: impl Fn(&C) -> M::Impulse + Sync) {
        self.layout.send(&mut self.blocks, |block, sent| {
            Arch::new().dispatch(|| block.push_few(&p));
            block.columns.send(&block.y, sent);
        });
    }

    /// Second half: `take` is given (W p)_α of each contact.
    pub fn pull(&mut self, take: impl Fn(&mut C, M::Impulse) + Sync) {
        let [] = self.pull_sums(|at, of_p| {
            take(at, of_p);
            []
        });
    }

    /// [`pull`](Self::pull), where `take` gives the terms of sums over the contacts.
    pub fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut C, M::Impulse) -> [f64; N] + Sync,
    ) -> [f64; N] {
        self.layout.receive(&mut self.blocks, |block, sums| {
            block.columns.take(&mut block.y, sums);
            Arch::new().dispatch(|| block.pull(&take));
        });
        self.sums()
    }

    /// pᵗ W p = |y|² of the p last pushed, without the second half.
    pub fn curvature(&mut self) -> f64 {
        self.layout.receive(&mut self.blocks, |block, sums| {
            block.columns.take(&mut block.y, sums);
            Arch::new().dispatch(|| block.square());
        });
        let [curvature] = self.sums();
        curvature
    }

    /// The sum of a `term` over the contacts.
    pub fn sum_of(&mut self, term: impl Fn(&C) -> f64 + Sync) -> f64 {
        let [sum] = self.sums_of(|at| [term(at)]);
        sum
    }

    /// The sums of several `terms` over the contacts.
    pub fn sums_of<const N: usize>(&mut self, terms: impl Fn(&C) -> [f64; N] + Sync) -> [f64; N] {
        self.layout.each(&mut self.blocks, |block| {
            block.parts = parts(block.states.iter().map(&terms).fold([0.0; N], add));
        });
        self.sums()
    }

    /// The least value at any contact; infinite without contact.
    pub fn least_of(&mut self, value: impl Fn(&C) -> f64 + Sync) -> f64 {
        self.layout.each(&mut self.blocks, |block| {
            block.parts = parts([block.states.iter().map(&value).fold(f64::INFINITY, f64::min)]);
        });
        self.layout.least(self.blocks.iter().map(|block| block.parts[0]).fold(f64::INFINITY, f64::min))
    }

    /// Changes each contact.
    pub fn each(&mut self, change: impl Fn(&mut C) + Sync) {
        self.layout.each(&mut self.blocks, |block| block.states.iter_mut().for_each(&change));
    }

    /// Puts the impulses that `r` reads from each contact in the problem's order (N·s).
    pub fn impulses(&self, r: impl Fn(&C) -> M::Impulse, impulses: &mut [f64]) {
        for block in &self.blocks {
            block.columns.impulses(block.states.iter().map(&r), impulses);
        }
    }

    fn sums<const N: usize>(&self) -> [f64; N] {
        self.layout.sum(self.blocks.iter().map(|block| std::array::from_fn(|k| block.parts[k])))
    }
}

impl<C: Send + Sync, const D: usize> Product<C, Smooth<D>> {
    /// [`pull`](Self::pull) after [`push_few`](Self::push_few), of the contacts around the grains with y ≠ 0 alone: `take` is
    /// given what each of its grains adds to (W p)_α, one after the other. Returns pᵗ W p.
    ///
    /// # Panics
    /// If the contacts around the grains are not known: see [`with_neighbours`](Self::with_neighbours).
    pub fn pull_around(&mut self, take: impl Fn(&mut C, f64) + Sync) -> f64 {
        self.layout.receive(&mut self.blocks, |block, sums| {
            block.columns.take(&mut block.y, sums);
            block.pull_around(&take);
        });
        let [curvature] = self.sums();
        curvature
    }
}

impl<C, M: Mechanics> Block<C, M> {
    #[inline(always)]
    fn push<const N: usize>(&mut self, p: &impl Fn(&mut C) -> (M::Impulse, [f64; N])) {
        self.y.fill(M::Velocity::ZERO);
        let mut sums = [0.0; N];
        for (column, state) in self.columns.scaled.iter().zip(&mut self.states) {
            let (p, terms) = p(state);
            column.push(p, &mut self.y);
            sums = add(sums, terms);
        }
        self.parts = parts(sums);
    }

    #[inline(always)]
    fn push_few(&mut self, p: &impl Fn(&C) -> M::Impulse) {
        self.y.fill(M::Velocity::ZERO);
        for (column, state) in self.columns.scaled.iter().zip(&self.states) {
            let p = p(state);
            if p != M::Impulse::ZERO {
                column.push(p, &mut self.y);
            }
        }
    }

    #[inline(always)]
    fn pull<const N: usize>(&mut self, take: &impl Fn(&mut C, M::Impulse) -> [f64; N]) {
        let mut sums = [0.0; N];
        for (column, state) in self.columns.scaled.iter().zip(&mut self.states) {
            sums = add(sums, take(state, column.relative(&self.y)));
        }
        self.parts = parts(sums);
    }

    #[inline(always)]
    fn square(&mut self) {
        let squares = self.y.iter().zip(&self.columns.share).map(|(y, share)| share * y.dot_product(*y));
        self.parts = parts([squares.sum()]);
    }
}

impl<C, const D: usize> Block<C, Smooth<D>> {
    fn pull_around(&mut self, take: &impl Fn(&mut C, f64)) {
        let Some(adjacency) = &self.adjacency else { panic!("the contacts around the grains are not known") };
        let mut curvature = 0.0;
        for (grain, (y, share)) in self.y.iter().zip(&self.columns.share).enumerate() {
            if *y != SVector::<f64, D>::ZERO {
                curvature += share * y.norm_squared();
                for k in adjacency.around(grain) {
                    let column = &self.columns.scaled[*k as usize];
                    take(&mut self.states[*k as usize], column.relative_of(grain as u32, y));
                }
            }
        }
        self.parts = parts([curvature]);
    }
}

#[inline(always)]
fn add<const N: usize>(sums: [f64; N], terms: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| sums[k] + terms[k])
}
