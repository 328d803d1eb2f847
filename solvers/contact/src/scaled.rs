//! The contacts in mass-scaled unknowns, as sweeps and products with W want them: no division and no root is left, and a
//! contact of discs is 32 bytes.
//!
//! With y = M^½ V (√J) and s = √`W_αα` r (√J), H̃ = M^-½ H W_D^-½ takes the place of H: relative velocities are
//! v/√`W_αα` = H̃ᵗ y + c/√`W_αα`, an impulse moves y by H̃ s, and the diagonal of H̃ᵗ H̃ is 1.
//!
//! The `unit` of a contact, here and wherever these columns are used, is s/r: √`W_αα` (kg^-½), with the masses that the column
//! has; or 1, where a method wants r as it is. Sweeps always have √`W_αα`.

use crate::lanes::Number;
use crate::law::Signorini;
use crate::visit::Visited;
use nalgebra::SVector;

/// A column of H̃: `normal` at the candidate, −`ratio`·`normal` at the antagonist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledContact<const D: usize = 2, N = f64> {
    pub(crate) candidate: u32,
    /// At a wall the candidate itself, which a ratio of 0 leaves out.
    pub(crate) antagonist: u32,
    /// n/√(`m_candidate` `W_αα`) (–).
    pub(crate) normal: SVector<N, D>,
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    pub(crate) ratio: N,
}

impl<const D: usize> ScaledContact<D> {
    /// The diagonal of H̃ᵗ H̃, which is 1, or of W.
    #[inline]
    pub fn squared(&self) -> f64 {
        self.normal.norm_squared() * (1.0 + self.ratio * self.ratio)
    }

    /// h̃_α at the candidate, and at the antagonist: 0 at a wall.
    #[inline]
    pub fn at_ends(&self) -> (SVector<f64, D>, SVector<f64, D>) {
        (self.normal, -self.ratio * self.normal)
    }
}

impl<const D: usize, N: Number> Visited for ScaledContact<D, N> {
    type Velocity = SVector<N, D>;
    type Impulse = N;
    type Law = Signorini;

    #[inline]
    fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    #[inline]
    fn between(&self, [i, j]: [SVector<N, D>; 2]) -> N {
        self.normal.dot(&(i - j * self.ratio))
    }

    #[inline]
    fn relative_of(&self, place: u32, y: SVector<N, D>) -> N {
        let along = self.normal.dot(&y);
        if place == self.candidate { along } else { -self.ratio * along }
    }

    #[inline]
    fn pushes(&self, s: N) -> [SVector<N, D>; 2] {
        let push = self.normal * s;
        [push, -(push * self.ratio)]
    }

    #[inline]
    fn law(&self) -> Signorini {
        Signorini
    }
}
