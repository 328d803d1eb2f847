//! Conjugate projected gradient on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, the paper's reference \[2\]; and with friction.
//!
//! M. Renouf, P. Alart, Conjugate gradient type algorithms for frictional multi-contact problems: applications to
//! granular materials, Comput. Methods Appl. Mech. Engrg. 194 (2005) 2019-2041. Cost of an iteration: one product
//! with W, in two passes over the contacts, with friction two; the blocks in which these are made are for the threads alone.
//!
//! The reference does not say what to do where W is singular, as it is where contacts depend on each other: a direction that the
//! grains hardly feel makes a step so long that what r ≥ 0 cuts off would throw them out. So q(r) never exceeds q(r₀): where the
//! step would make it do so, or where pᵗ W p is round-off, it goes as far as the first contact that it would open, and the method
//! begins anew with p = w; if that is next to nothing, it makes the step of the projected gradient. Packings ask for none of this.
//!
//! In single and in mixed precision, the columns of H and the velocities of a product are f32; impulses, gradients and directions are f64.
//! Each 16th iteration makes u from r: in mixed precision with columns and velocities in f64, so that u and r part by the round-off of
//! the steps between.

mod products;
mod run;
mod state;

pub use product::Preconditioner;
pub use products::Products;
pub use run::Run;
pub use state::{Constants, Law, State};

use analysis::Bounded;
use contact::precision::Precision;
use contact::{Iteration, Mechanics, Packing, SetupError, Solver, Touch, Vector, Visited, greatest};
use partition::{Distributed, Refused, Share, Team};
use product::{Layout, Product};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the conjugate gradient; by default the plain method of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cg {
    /// Scaling of the gradient before it becomes a direction.
    pub preconditioner: Preconditioner,
    /// Precision of products with W; with a W that is stored, `double` alone.
    pub precision: Precision,
}

/// A mechanics for which the method is: its contacts have the law that [`Law`] knows for their impulses.
pub trait Suited: Bounded<Impulse: Law> {}

impl<M> Suited for M
where
    M: Bounded<Impulse: Law>,
    M::Column: Visited<Law = <M::Impulse as Law>::OfContact>,
{
}

/// A run on the grains of a mechanics.
pub type GrainRun<M> = Run<GrainProduct<<M as Mechanics>::Impulse, M>, <M as Mechanics>::Impulse>;

type GrainProduct<I, M> = Product<State<I>, Constants<I>, M>;

impl Cg {
    /// The conjugate gradient with the diagonal of W as preconditioner.
    pub fn preconditioned() -> Self {
        Self { preconditioner: Preconditioner::Diagonal, ..Self::default() }
    }

    /// A run on `problem` from the impulses `r0` (N·s), for those who look into it.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn run<M: Suited>(&self, problem: &Packing<M>, r0: &[f64]) -> Result<GrainRun<M>, SetupError> {
        let greatest =
            if self.is_scaled() { M::scaled_delassus_bound(problem) } else { M::delassus_bound(problem) };
        Ok(self.over(Layout::new(problem)?, problem, greatest, r0))
    }

    fn is_scaled(self) -> bool {
        self.preconditioner == Preconditioner::Diagonal
    }

    /// A run on the blocks of a layout of `problem`, with Λ.
    fn over<M: Mechanics<Impulse: Law>>(
        self,
        layout: Layout<M>,
        problem: &Packing<M>,
        greatest: f64,
        r0: &[f64],
    ) -> GrainRun<M> {
        let (b, diagonal) = (problem.b(), problem.delassus_diagonal());
        let state = |contact: usize, unit: M::Impulse| {
            let at = |list: &[f64]| M::Impulse::at(list, contact);
            State::new(at(&b), at(r0), problem.contacts()[contact].friction(), at(&diagonal), unit)
        };
        let mut product = Product::over(layout, problem, self.is_scaled(), self.precision, state);
        if M::Impulse::MINIMISES {
            product = product.with_neighbours();
        }
        Run::new(product, greatest, self.precision)
    }
}

impl<M: Suited> Distributed<M> for Cg {
    fn start_in<'p>(
        &self,
        share: &'p Share<M>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let (layout, bound) = (Layout::of_share(share, team), share.whole.scaled_delassus_bound);
        let diagonal = || layout.greatest(greatest(share.problem.delassus_diagonal().into_iter()));
        let greatest = if self.is_scaled() { bound } else { bound * diagonal() };
        Ok(Box::new(self.over(layout, &share.problem, greatest, r0)))
    }
}

impl<M: Suited> Solver<M> for Cg {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.run(problem, r0)?))
    }
}
