//! State and constants of a contact, and the split of u = −(W r + b) there.

use contact::law;

/// State of a contact. With the preconditioner, the unknowns are scaled by it.
pub(crate) struct Contact {
    pub(crate) r: f64,
    /// u = −(W r + b).
    pub(crate) u: f64,
    /// The direction.
    pub(crate) p: f64,
    /// r and u before the last step.
    pub(crate) r_before: f64,
    pub(crate) u_before: f64,
}

/// Constants of a contact, in the same unknowns.
pub(crate) struct Constants {
    pub(crate) b: f64,
    /// `W_αα`.
    pub(crate) diagonal: f64,
}

impl Contact {
    /// φ.
    #[inline]
    pub(crate) fn free(&self) -> f64 {
        if self.r > 0.0 { self.u } else { 0.0 }
    }

    /// β.
    #[inline]
    pub(crate) fn chopped(&self) -> f64 {
        if self.r > 0.0 { 0.0 } else { law::non_negative(self.u) }
    }

    /// The terms of φ̃ᵗ φ and βᵗ β; `inverse_step` is 1/ᾱ.
    #[inline]
    pub(crate) fn split(&self, inverse_step: f64) -> [f64; 2] {
        let (free, chopped, least) = (self.free(), self.chopped(), -self.r * inverse_step);
        [free * if free < least { least } else { free }, chopped * chopped]
    }

    /// Returns the part that max(0, r) added to r + α p in the last step, of the `length` α.
    #[inline]
    pub(crate) fn added(&self, length: f64) -> f64 {
        law::non_negative(-(self.r_before + length * self.p))
    }
}
