//! W p = (M^-½ H)ᵗ (M^-½ H p) in two passes over mass-scaled contacts, block by block in threads: one kernel for the methods
//! that are made of products, so that their seconds compare the methods.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod layout;
mod passes;

pub use layout::Layout;
pub use passes::{At, Pulled};

use bytemuck::Zeroable;
use contact::precision::{Precision, Single};
use contact::{
    Adjacency, Column, Discs, Mechanics, Numbers, Packing, SetupError, Vector, Visited, VisitedIn,
};
use layout::Units;
use partition::{Subdomain, Sums};
use passes::{Dispatched, Pass, Pull, PullAndPush, PullAround, Push, PushFew, SUMS, Square, parts};
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

/// Products with W, and at each contact a state of type `C`, which passes change, its p among it, and constants of type `K`, its b among
/// them: they are read only where they are asked for.
///
/// With the unit 1, impulses and velocities are r and v. With the unit √`W_αα`, √`W_αα` r and v/√`W_αα` stand in their place: a
/// method in these unknowns is the one preconditioned by the diagonal of W.
///
/// States and constants are in double precision. Columns of H and velocities of grains are in double or in single precision, as [`Precision`] says.
pub struct Product<C, K, M: Mechanics = Discs> {
    layout: Layout<M>,
    blocks: Vec<Block<C, K, M>>,
}

struct Block<C, K, M: Mechanics> {
    contacts: Contacts<C, K, M>,
    double: Columns<M::Column>,
    single: Columns<Single<M>>,
    /// True while products are made in single precision.
    is_single: bool,
}

/// Contacts of a block, whatever the precision.
struct Contacts<C, K, M: Mechanics> {
    units: Units<M>,
    states: Vec<C>,
    constants: Vec<K>,
    /// Contribution of the block to the sums that the last pass was for.
    parts: [f64; SUMS],
    /// The contacts around each grain, where [`Product::pull_around`] is wanted.
    adjacency: Option<Adjacency>,
}

/// Columns of M^-½ H, or of H̃, in one precision, and what a product needs between its halves.
struct Columns<C: Visited> {
    of_h: Vec<C>,
    /// M^-½ H p; of grains that blocks share, each has the sum after it has been received.
    y: Vec<C::Velocity>,
    /// M^-½ H of the next p, where that is made as this one is pulled.
    next: Vec<C::Velocity>,
}

impl<C: Send + Sync, K: Send + Sync, M: Mechanics> Product<C, K, M> {
    /// The contacts of `problem`, each with a unit, 1 or √`W_αα` if they are `scaled`; `contact` makes the state and the constants of
    /// one from its index in the problem and its unit.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn new(
        problem: &Packing<M>,
        scaled: bool,
        contact: impl Fn(usize, M::Impulse) -> (C, K) + Sync,
    ) -> Result<Self, SetupError> {
        Ok(Self::over(Layout::new(problem)?, problem, scaled, Precision::Double, contact))
    }

    /// Returns the product on the blocks of a layout, whose contacts and grains are those of `problem`.
    pub fn over(
        layout: Layout<M>,
        problem: &Packing<M>,
        scaled: bool,
        precision: Precision,
        contact: impl Fn(usize, M::Impulse) -> (C, K) + Sync,
    ) -> Self {
        let is_single = precision != Precision::Double;
        let blocks = layout.blocks(problem, scaled, |units, of_h, subdomain| {
            let (states, constants) = units.each().map(|(index, unit)| contact(index, unit)).unzip();
            Block {
                contacts: Contacts { units, states, constants, parts: [0.0; SUMS], adjacency: None },
                single: Columns::new(of_h.iter().filter(|_| is_single).map(Column::single), subdomain),
                double: Columns::new(of_h.into_iter().filter(|_| precision != Precision::Single), subdomain),
                is_single,
            }
        });
        Self { layout, blocks }
    }

    /// Returns the product, ready for [`Product::pull_around`].
    #[must_use]
    pub fn with_neighbours(mut self) -> Self {
        for (block, subdomain) in self.blocks.iter_mut().zip(self.layout.subdomains()) {
            block.contacts.adjacency =
                Some(Adjacency::new(subdomain.ends.iter().copied(), subdomain.grains.len()));
        }
        self
    }

    /// Makes the next products in double precision, or no longer, where precision is mixed.
    pub fn set_exact(&mut self, is_exact: bool) {
        for block in &mut self.blocks {
            block.is_single = !block.single.of_h.is_empty() && (!is_exact || block.double.of_h.is_empty());
        }
    }

    /// First half of the product, y = M^-½ H p: `p` gives the p of each contact. Returns pᵗ p.
    pub fn push(&mut self, p: impl Fn(&mut C) -> M::Impulse + Copy + Sync) -> f64 {
        let [squared] = self.push_sums(|at| {
            let p = p(at);
            (p, [p.dot_product(p)])
        });
        squared
    }

    /// [`push`](Self::push), where `p` also gives the terms of sums over the contacts, which take the place of pᵗ p.
    pub fn push_sums<const N: usize>(
        &mut self,
        p: impl Fn(&mut C) -> (M::Impulse, [f64; N]) + Copy + Sync,
    ) -> [f64; N] {
        self.push_by(move |at: &mut C, ()| p(at))
    }

    /// [`push_sums`](Self::push_sums), by a function of a contact.
    pub fn push_by<const N: usize>(&mut self, p: impl At<C, (), (M::Impulse, [f64; N])>) -> [f64; N] {
        self.send(&Push::<_, N>(p));
        self.sums()
    }

    /// [`push`](Self::push) of a `p` that is 0 at most contacts, which then cost next to nothing.
    pub fn push_few(&mut self, p: impl Fn(&C) -> M::Impulse + Sync) {
        self.send(&PushFew(p));
    }

    /// Second half of the product of one p, after [`curvature`](Self::curvature), and first half of that of the next: `take` is given (W p)_α
    /// of each contact, and gives the term of a sum over the contacts, and its next p with the terms of two more, unless that is 0.
    pub fn pull_and_push(&mut self, take: impl At<C, M::Impulse, Pulled<M::Impulse>>) -> [f64; 3] {
        self.send(&PullAndPush(take));
        self.sums()
    }

    /// Second half: `take` is given the constants and (W p)_α of each contact.
    pub fn pull(&mut self, take: impl Fn(&mut C, &K, M::Impulse) + Copy + Sync) {
        let [] = self.pull_sums(|at, constants, of_p| {
            take(at, constants, of_p);
            []
        });
    }

    /// [`pull`](Self::pull), where `take` gives the terms of sums over the contacts.
    pub fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut C, &K, M::Impulse) -> [f64; N] + Copy + Sync,
    ) -> [f64; N] {
        self.receive(&Pull(take));
        self.sums()
    }

    /// [`pull`](Self::pull) of a p that is 0 at most contacts, of the contacts around the grains with y ≠ 0 alone: `take` is given what each
    /// of its grains adds to (W p)_α, one after the other, and gives what that adds to the first sum of the pass before. Returns this sum, and
    /// pᵗ W p.
    ///
    /// # Panics
    /// If the contacts around the grains are not known: see [`with_neighbours`](Self::with_neighbours).
    pub fn pull_around(&mut self, take: impl Fn(&mut C, M::Impulse) -> f64 + Copy + Sync) -> [f64; 2] {
        self.receive(&PullAround(take));
        self.sums()
    }

    /// pᵗ W p = |y|² of the p last pushed, without the second half.
    pub fn curvature(&mut self) -> f64 {
        self.receive(&Square);
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
            block.contacts.parts = parts(block.contacts.states.iter().map(&terms).fold([0.0; N], add));
        });
        self.sums()
    }

    /// The sum of a `term` over the contacts, in eight sums that do not wait for each other.
    pub fn sum_apart(&self, term: impl Fn(&C) -> f64) -> f64 {
        let [sum] =
            self.layout.sum(self.blocks.iter().map(|block| [sum_apart(&block.contacts.states, &term)]));
        sum
    }

    /// The least value at any contact; infinite without contact.
    pub fn least_of(&mut self, value: impl Fn(&C) -> f64 + Sync) -> f64 {
        self.layout.each(&mut self.blocks, |block| {
            block.contacts.parts =
                parts([block.contacts.states.iter().map(&value).fold(f64::INFINITY, f64::min)]);
        });
        self.layout
            .least(self.blocks.iter().map(|block| block.contacts.parts[0]).fold(f64::INFINITY, f64::min))
    }

    /// Changes each contact.
    pub fn each(&mut self, change: impl Fn(&mut C) + Sync) {
        self.layout.each(&mut self.blocks, |block| block.contacts.states.iter_mut().for_each(&change));
    }

    /// Puts the impulses that `r` reads from each contact in the problem's order (N·s).
    pub fn impulses(&self, r: impl Fn(&C) -> M::Impulse, impulses: &mut [f64]) {
        for block in &self.blocks {
            block.contacts.units.impulses(block.contacts.states.iter().map(&r), impulses);
        }
    }

    /// A pass over all blocks, each of which then sends what it has of the grains it shares.
    fn send(&mut self, pass: &impl Pass<C, K, M>) {
        self.layout.send(&mut self.blocks, |block, sent| {
            Arch::new().dispatch(Dispatched(block, pass));
            let boundary = &block.contacts.units.boundary;
            if block.is_single {
                block.single.send::<M>(boundary, sent);
            } else {
                block.double.send::<M>(boundary, sent);
            }
        });
    }

    /// A pass before which each block takes the sums of what all have sent.
    fn receive(&mut self, pass: &impl Pass<C, K, M>) {
        self.layout.receive(&mut self.blocks, |block, sums| {
            let boundary = &block.contacts.units.boundary;
            if block.is_single {
                block.single.take::<M>(boundary, sums);
            } else {
                block.double.take::<M>(boundary, sums);
            }
            Arch::new().dispatch(Dispatched(block, pass));
        });
    }

    fn sums<const N: usize>(&self) -> [f64; N] {
        self.layout.sum(self.blocks.iter().map(|block| std::array::from_fn(|k| block.contacts.parts[k])))
    }
}

impl<C: Visited> Columns<C> {
    fn new(of_h: impl Iterator<Item = C>, subdomain: &Subdomain) -> Self {
        let of_h: Vec<C> = of_h.collect();
        let y = vec![C::Velocity::zeroed(); if of_h.is_empty() { 0 } else { subdomain.grains.len() }];
        Self { of_h, y, next: Vec::new() }
    }

    /// Copies what the block has of the grains that blocks share to `sent`.
    fn send<M: Mechanics>(&self, boundary: &[u32], sent: &mut [M::Velocity])
    where
        C: VisitedIn<M>,
    {
        for (place, sent) in boundary.iter().zip(sent) {
            *sent = self.y[*place as usize].double();
        }
    }

    /// Gives these grains the `sums` over the blocks.
    fn take<M: Mechanics>(&mut self, boundary: &[u32], sums: Sums<'_, M::Velocity>)
    where
        C: VisitedIn<M>,
    {
        for (place, sum) in boundary.iter().zip(sums) {
            self.y[*place as usize] = C::Velocity::nearest(sum);
        }
    }
}

/// The sum of a `term` over some states, in eight sums that do not wait for each other.
pub fn sum_apart<S>(states: &[S], term: impl Fn(&S) -> f64) -> f64 {
    let (eights, last) = states.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for states in eights {
        for k in 0..8 {
            sums[k] += term(&states[k]);
        }
    }
    for state in last {
        sums[0] += term(state);
    }
    sums.iter().sum()
}

/// The sums, with other terms added.
#[inline(always)]
pub fn add<const N: usize>(sums: [f64; N], terms: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| sums[k] + terms[k])
}
