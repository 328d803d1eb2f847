//! Convex programmes, each with the σ of the grains that move: what finds the neighbourhood of a solution at rest.

use super::Halved;
use super::newton::Newton;
use crate::Best;
use crate::conic::Conic;
use crate::start::LOOK;
use contact::{Frictional, Packing, Rough, SetupError, Work};
use nalgebra::SVector;

/// Sweeps after a programme in which the residual must be halved, or they end. With a quarter of them two of 18 packings of 1,000 spheres
/// at rest take one more programme to 1e-6.
const SETTLING: u64 = 4 * LOOK;

/// Programmes one after the other, while each, with the sweeps that follow it, halves the residual.
pub(super) struct Programmes<const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    conic: Conic<D, N>,
    /// Best impulses so far.
    pub(super) best: Best,
}

impl<const D: usize, const N: usize> Programmes<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Begins the first, with σ = 0.
    ///
    /// # Errors
    /// Where the problem is too large for that.
    pub(super) fn new(problem: &Packing<Rough<D>>) -> Result<Self, SetupError> {
        let best = Best { left: f64::INFINITY, impulses: vec![0.0; problem.impulse_count()] };
        Ok(Self { conic: Conic::relaxation(problem)?, best })
    }

    /// Advances a programme by one step; at its end, makes sweeps. `false` where no further programme leads on.
    pub(super) fn advance(&mut self, newton: &mut Newton<D, N>) -> bool {
        if self.conic.step() {
            return true;
        }
        let before = self.best.left;
        let mut r = vec![0.0; self.best.impulses.len()];
        self.conic.impulses(&mut r);
        let mut s = newton.layout.scaled(&r);
        let mut halved = Halved::at(newton.left(Newton::ALONE, &s));
        self.best.take(halved.left, |best| best.copy_from_slice(&r));
        while halved.since < SETTLING {
            newton.sweep(&mut s, LOOK as u32);
            halved.since += LOOK;
            let left = newton.left(Newton::ALONE, &s);
            self.best.take(left, |r| newton.layout.impulses(&s, r));
            halved.look(left);
        }
        let leads_on = self.best.left <= 0.5 * before;
        if leads_on {
            self.conic.settle();
        }
        leads_on
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        self.conic.work()
    }
}
