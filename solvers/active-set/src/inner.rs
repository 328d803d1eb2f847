//! Linear solvers for the matrix K of an active set: K = 1 + Σ d h̃ h̃ᵗ, with weights d ≥ 0 of the contacts, in the mass-scaled velocities
//! of grains.

use cholesky::{Coupling, Factor, Order, Structure};
use contact::{Mechanics, Packing, SetupError, Smooth, Touch, Work};
use nalgebra::SVector;
use std::sync::Arc;

/// κ, the weight of the contacts against the masses (–). A solve leaves of an error in the impulses 1/(1 + κ λ), for each
/// eigenvalue λ of the active part of H̃ᵗ H̃; the lowest of a packing of a thousand discs are some 1e-5.
pub const PENALTY: f64 = 1e9;

/// Linear solver for K.
pub trait Inner<const D: usize> {
    /// κ of a closed contact (–).
    fn penalty(&self) -> f64 {
        PENALTY
    }

    /// The place of each grain in the vectors that it solves for.
    fn position(&self) -> &[u32];

    /// The problem's contacts, in the order in which their columns are to lie.
    fn contacts(&self) -> impl Iterator<Item = u32>;

    /// Takes K with what each of the problem's contacts adds to it, d h̃ h̃ᵗ, if it does; says whether it could factorise it.
    fn factorise(&mut self, coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync) -> bool;

    /// x ← K⁻¹ x; nothing without factors.
    fn solve(&mut self, x: &mut [SVector<f64, D>]);

    /// Returns the work done so far.
    fn work(&self) -> Work;

    /// Multiply-adds of a factorisation of the whole, and entries of its factor: they say when the start may end, and when it has taken too long.
    fn cost(&self) -> (u64, usize);
}

/// Candidate and antagonist of a contact; `None` for a wall.
type Ends = (u32, Option<u32>);

/// One sparse factor of the whole.
pub struct Whole<const D: usize = 2> {
    structure: Arc<Structure<D>>,
    factor: Option<Factor<D>>,
    work: Work,
}

impl<const D: usize> Whole<D> {
    /// Finds where the factors of `problem` have entries.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub fn new(problem: &Packing<Smooth<D>>) -> Result<Self, SetupError> {
        let (ends, order) = ordered(problem)?;
        let structure = Structure::new(&ends, &order)?;
        Ok(Self { structure, factor: None, work: Work::default() })
    }

    /// Returns the cost of a factor of `problem`, as [`Inner::cost`] says it.
    ///
    /// # Errors
    /// Where the problem is too large for that.
    pub fn cost_of(problem: &Packing<Smooth<D>>) -> Result<(u64, usize), SetupError> {
        let (ends, order) = ordered(problem)?;
        Ok(Structure::<D>::cost(&ends, &order))
    }
}

/// The ends of all contacts, and an order of the grains in which a factor has few entries.
pub(crate) fn ordered<M: Mechanics>(problem: &Packing<M>) -> Result<(Vec<Ends>, Order), SetupError> {
    let ends: Vec<Ends> = problem.contacts().iter().map(Touch::ends).collect();
    let order = Order::fill_reducing(problem.position(), &ends)?;
    Ok((ends, order))
}

impl<const D: usize> Inner<D> for Whole<D> {
    fn position(&self) -> &[u32] {
        self.structure.position()
    }

    fn contacts(&self) -> impl Iterator<Item = u32> {
        self.structure.couplings()
    }

    fn factorise(&mut self, coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync) -> bool {
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += self.structure.work();
        Factor::replace(&mut self.factor, &self.structure, |_| SVector::repeat(1.0), coupling)
    }

    fn solve(&mut self, x: &mut [SVector<f64, D>]) {
        let Some(factor) = &self.factor else { return };
        factor.solve(x);
        self.work.triangular_solve_entries += 2 * factor.entries() as u64;
    }

    fn work(&self) -> Work {
        self.work
    }

    fn cost(&self) -> (u64, usize) {
        (self.structure.work(), self.structure.entries())
    }
}
