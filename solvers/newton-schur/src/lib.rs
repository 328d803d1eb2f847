//! Newton outside, subdomains inside: the primal-dual active set, each of whose linear problems is solved by subdomains with their
//! Schur complements on the boundary grains.
//!
//! This is the order of things that LATIN-DD and NSGS-DD give up: there non-smoothness and decomposition are treated in one loop, here
//! one inside the other. A set asks for solves with K = 1 + κ Σ h̃ h̃ᵗ over its closed contacts, in mass-scaled velocities. K is the
//! sum of the K_E of the subdomains, with masses of boundary grains shared by their multiplicity and each contact in its own
//! subdomain. Interior grains are eliminated in each, S_E = K_bb − K_bi K_ii⁻¹ K_ib, and S u = g on the boundary grains, S = Σ S_E,
//! is solved by a factor, or by conjugate gradients preconditioned by Neumann-Neumann, Σ D_E S_E⁻¹ D_Eᵗ with D_E = (Σ K_bb)⁻¹ K_bb
//! grain by grain. S_E⁻¹ exists because every grain has a mass.
//!
//! With a factor of S the iterates are those of `active-set` begun by conjugate gradients, whatever the subdomains.
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §1 and its ref. \[6\]; the preconditioner is that of Y.-H. De Roeck,
//! P. Le Tallec, Analysis and test of a local domain decomposition preconditioner, Fourth International Symposium on Domain
//! Decomposition Methods, SIAM (1991) 112-128.

mod conjugate;
mod interface;
mod schur;
mod subdomain;

pub use schur::Schur;

use active_set::{ActiveSet, Start};
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work};
use partition::{Grid, Scheme};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Solver of the problem on the boundary grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interface {
    /// By a factor of the assembled Schur complement.
    Direct,
    /// By conjugate gradients.
    #[default]
    Cg,
}

/// Preconditioner of the conjugate gradients on the boundary grains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// Nothing.
    None,
    /// Answers of the subdomains alone, averaged with their stiffness at a grain.
    #[default]
    NeumannNeumann,
}

/// Settings of Newton by subdomains.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NewtonSchur {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// Scheme by which the contacts are distributed.
    pub partition: Scheme,
    /// Solver of the problem on the boundary grains.
    pub interface: Interface,
    /// Preconditioner of its conjugate gradients.
    pub preconditioner: Preconditioner,
    /// Coarse space: its conjugate gradients begin with the translations of all subdomains, and stay conjugate to them.
    pub coarse: bool,
    /// Residual of its conjugate gradients over the right-hand side (–).
    pub inner_accuracy: f64,
    /// κ (–), the weight of closed contacts against the masses.
    pub penalty: f64,
}

/// κ and the accuracy are a pair. Conjugate gradients come no nearer than round-off times κ; what they leave, times κ, is left of the
/// law. On five packings of 991 discs in 8 and 64 subdomains, κ = 1e7 with 1e-8 takes the sets that it takes with a factor of S, or one
/// more. With 1e-10, and with κ = 1e6 and 1e-6, there is one of these that takes more than 30; with κ = 1e9 no accuracy tried serves all.
/// Translations save at most a ninth of the iterations with Neumann-Neumann, in 2 to 64 subdomains of `shear-box-991-onset`,
/// `settled-991` and 10,000 deposited discs, for about as many exchanges.
impl Default for NewtonSchur {
    fn default() -> Self {
        Self {
            subdomains: Grid::ONE,
            partition: Scheme::Boxes,
            interface: Interface::Cg,
            preconditioner: Preconditioner::NeumannNeumann,
            coarse: false,
            inner_accuracy: 1e-8,
            penalty: 1e7,
        }
    }
}

/// A run: that of the active set, which does not know of subdomains.
struct Run<'p, const D: usize> {
    outer: active_set::Run<'p, D, Schur<D>>,
}

impl<const D: usize> Iteration for Run<'_, D> {
    fn advance(&mut self) {
        self.outer.advance();
    }

    fn impulses(&self, r: &mut [f64]) {
        self.outer.impulses(r);
    }

    fn stalled(&self) -> bool {
        self.outer.stalled()
    }

    fn derived(&self) -> Vec<(&'static str, f64)> {
        vec![("inner_iterations", self.outer.inner().inner_iterations() as f64)]
    }

    /// A product with W takes an exchange too: the resultants of the copies are added up.
    fn work(&self) -> Work {
        let mut work = self.outer.work();
        work.interface_values += work.delassus_products * self.outer.inner().exchange();
        work
    }
}

/// Returns the active set begun by conjugate gradients: subdomains can share their products, whereas sweeps go contact by contact.
fn begun() -> ActiveSet {
    ActiveSet { start: Some(Start::Cg), ..ActiveSet::default() }
}

impl<const D: usize> Solver<Smooth<D>> for NewtonSchur {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("inner_accuracy", self.inner_accuracy)?;
        SetupError::unless_positive("penalty", self.penalty)?;
        let outer = begun().run(problem, r0, Schur::new(self, problem)?)?;
        Ok(Box::new(Run { outer }))
    }
}
