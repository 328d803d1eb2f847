//! The contacts of a sweep, in mass-scaled unknowns.

use contact::scaled::{ScaledContact, inverse_masses};
use contact::{ContactProblem, law};
use nalgebra::Vector2;

/// One contact as a sweep needs it.
pub(crate) struct Row {
    contact: ScaledContact,
    /// c/√`W_αα` (√J).
    offset: f64,
}

impl Row {
    /// (H̃ᵗ y)_α + c/√`W_αα` (√J).
    #[inline]
    pub(crate) fn relative(&self, y: &[Vector2<f64>]) -> f64 {
        self.contact.relative(y) + self.offset
    }

    /// y ← y + h̃_α Δs.
    #[inline]
    pub(crate) fn push(&self, change: f64, y: &mut [Vector2<f64>]) {
        self.contact.push(change, y);
    }

    /// v = Hᵗ V + c at α; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
    #[inline]
    pub(crate) fn solve(&self, s: &mut f64, y: &mut [Vector2<f64>], relaxation: f64) {
        let change = law::change(*s, self.relative(y), relaxation);
        self.push(change, y);
        *s += change;
    }
}

/// The row of a contact, and √`W_αα` (kg^-½). A grain has the `place` in y.
pub(crate) fn row(problem: &ContactProblem, contact: u32, place: impl Fn(u32) -> u32) -> (Row, f64) {
    let contact = &problem.contacts()[contact as usize];
    let (candidate, antagonist) = contact.ends();
    let (inverse_mass, unit) = inverse_masses(contact.ends(), |grain| 1.0 / problem.mass()[grain as usize]);
    let places = (place(candidate), antagonist.map(place));
    let scaled = ScaledContact::new(places, contact.normal, inverse_mass, unit);
    (Row { contact: scaled, offset: contact.offset / unit }, unit)
}
