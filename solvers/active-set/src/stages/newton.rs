//! Interface of the frictional stages to the plane and to space: Newton's method and proximal points.

use crate::Best;
use contact::{Mechanics, Packing, SetupError, Work};

/// Newton's method and proximal points, which differ between the plane and space.
pub(crate) trait Newton<'p>: Sized {
    type Mechanics: Mechanics;
    type Points;

    /// Lays the problem out.
    ///
    /// # Errors
    /// Where it is too large for that.
    fn new(problem: &'p Packing<Self::Mechanics>) -> Result<Self, SetupError>;

    /// Takes the impulses `r` (N·s); returns what they leave of the law (√J).
    fn begin(&mut self, r: &[f64]) -> f64;

    /// One step of Newton's method, from what was left `before` (√J).
    fn step(&mut self, before: f64, best: &mut Best) -> Step;

    /// Proximal points from the best impulses; none, where the problem is too large.
    fn points(&self, problem: &'p Packing<Self::Mechanics>, best: &Best) -> Option<Self::Points>;

    /// One proximal point, or a step towards it; what leaves at most `round_off` (√J) is nearly a solution.
    fn approach(&mut self, points: &mut Self::Points, best: &mut Best, round_off: f64) -> Approach;

    /// Work of proximal points, if it is not Newton's method's.
    fn work_of(_: &Self::Points) -> Work {
        Work::default()
    }

    /// Work so far.
    fn work(&self) -> Work;
}

/// Result of a step of Newton's method.
pub(crate) enum Step {
    /// Residual at round-off.
    Solved,
    /// It goes on from what is left (√J).
    On(f64),
    /// It made nothing better.
    InVain,
}

/// Result of a proximal point, or of a step towards it.
pub(crate) enum Approach {
    /// Residual at round-off.
    Solved,
    /// Newton's method ends it.
    Nearly,
    On,
    /// Nothing leads on.
    InVain,
}
