//! Sweeps in single precision, and in single precision for corrections whose residuals are double.
//!
//! In single precision all that a visit reads and writes is f32: the columns of H̃, c/√`W_αα`, s and y. A visit adds Δs to s and H̃ Δs
//! to y, and rounds both: a Δs below ε |s|, with ε = 2⁻²⁴, moves y alone. So y parts from the impulses, sweep after sweep, and from time to
//! time y = `y_free` + H̃ s is made anew.
//!
//! In mixed precision a run keeps the impulses s in f64, and beside them the correction z of the velocities in f32. From time to time,
//! with y and the columns in f64,
//!
//! > y = `y_free` + H̃ s;  a = H̃ᵗ y + c/√`W_αα`;  z = 0
//!
//! and in between a visit takes v = a + H̃ᵗ z, changes s by the law, and z by H̃ Δs. That is iterative refinement: what is rounded is the
//! correction and not the solution, so that its error falls with it. The law does not split into a solution and a correction: a contact
//! that opens has s = 0, and one that slides lies on its cone, and not next to it. So the law takes s as a whole, in f64 with the coefficient
//! of friction in f64. A visit is the same expression in all three precisions.

use crate::law::Lawful;
use crate::mechanics::{Column, Mechanics};
use crate::vector::Numbers;
use crate::visit::Visited;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Precision of the numbers of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// All in f64.
    #[default]
    Double,
    /// All in f32: contacts, impulses and velocities.
    Single,
    /// Contacts and corrections of velocities in f32; impulses, the law and, from time to time, the relative velocities in f64.
    Mixed,
}

/// Column in single precision of a mechanics.
pub type Single<M> = <<M as Mechanics>::Column as Column<M>>::Single;

/// A contact that is visited with corrections of velocities in single precision, and impulses in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed<C, L> {
    pub(crate) column: C,
    /// Law in double precision.
    pub(crate) law: L,
}

impl<C: Visited, L: Lawful<<C::Impulse as Numbers>::Double>> Visited for Mixed<C, L> {
    type Velocity = C::Velocity;
    type Impulse = <C::Impulse as Numbers>::Double;
    type Law = L;

    #[inline]
    fn places(&self) -> [u32; 2] {
        self.column.places()
    }

    #[inline]
    fn between(&self, ends: [C::Velocity; 2]) -> Self::Impulse {
        self.column.between(ends).double()
    }

    #[inline]
    fn pushes(&self, s: Self::Impulse) -> [C::Velocity; 2] {
        self.column.pushes(C::Impulse::nearest(s))
    }

    #[inline]
    fn law(&self) -> L {
        self.law
    }
}
