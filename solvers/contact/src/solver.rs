//! Interface of a method: a value that holds its settings and starts on a problem; an iteration that advances.

use crate::discs::Discs;
use crate::error::SetupError;
use crate::mechanics::Mechanics;
use crate::packing::Packing;
use crate::work::Work;

/// A method with its parameters, not yet bound to a problem. The value *is* the settings.
pub trait Solver<M: Mechanics = Discs>: Send + Sync {
    /// Binds the method to a problem, which it sees with its geometry, from the impulses `r0` (N·s, a flat list,
    /// admissible).
    ///
    /// # Errors
    /// Names the setting that has no meaning, alone or for this problem.
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError>;
}

/// One run of a method on one problem. Knows no tolerance, no clock, no file.
pub trait Iteration {
    /// One iteration of the method.
    fn advance(&mut self);

    /// Writes the impulses (N·s) in the problem's contact order, a flat list.
    fn impulses(&self, r: &mut [f64]);

    /// Greatest |`V_E` − V̄| over the copies of the boundary grains before the last gluing (m/s); 0 without copies.
    fn velocity_jump(&self) -> f64 {
        0.0
    }

    /// Reports whether no further iteration will bring the impulses nearer to a solution: the run then ends.
    fn stalled(&self) -> bool {
        false
    }

    /// Values that the settings leave open, by the setting's name.
    fn derived(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// Multiply-adds of an iteration on the longest subdomain, where subdomains work at the same time.
    fn critical_path(&self) -> Option<u64> {
        None
    }

    /// Exact counts since `start`.
    fn work(&self) -> Work;
}
