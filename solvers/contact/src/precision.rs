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
use crate::mechanics::{Column, Mechanics, Numbers, Visited, VisitedIn};
use crate::sweep::{Row, Sweep, push_all};
use bytemuck::Zeroable;
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
pub struct Mixed<C: Visited>
where
    <C::Impulse as Numbers>::Double: Lawful,
{
    column: C,
    coefficient: <<C::Impulse as Numbers>::Double as Lawful>::Friction,
}

impl<C: Visited> Visited for Mixed<C>
where
    <C::Impulse as Numbers>::Double: Lawful,
{
    type Velocity = C::Velocity;
    type Impulse = <C::Impulse as Numbers>::Double;

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
    fn coefficient(&self) -> <Self::Impulse as Lawful>::Friction {
        self.coefficient
    }
}

/// Velocities that are made anew from the impulses, which does away with the round-off of the sweeps so far.
pub(crate) struct Renewal<M: Mechanics, C: VisitedIn<M>> {
    from: Source<M, C>,
    times: u64,
}

enum Source<M: Mechanics, C: VisitedIn<M>> {
    /// y without impulses, in the precision of the sweep.
    Free(Vec<C::Velocity>),
    /// The contacts and y without impulses in double precision, and y with them.
    Exact { rows: Vec<Row<M::Column>>, free: Vec<M::Velocity>, y: Vec<M::Velocity> },
}

impl<M: Mechanics> Sweep<M> {
    /// Returns the same contacts, impulses and velocities in single precision.
    pub fn single(self) -> Sweep<M, Single<M>> {
        let nearest = |y: &Vec<M::Velocity>| y.iter().map(|y| Numbers::nearest(*y)).collect();
        let row =
            |row: &Row<M::Column>| Row { column: row.column.single(), offset: Numbers::nearest(row.offset) };
        Sweep {
            rows: self.rows.iter().map(row).collect(),
            s: self.s.iter().map(|s| Numbers::nearest(*s)).collect(),
            y: nearest(&self.y),
            renewal: Some(Renewal { from: Source::Free(nearest(&self.without_impulses())), times: 0 }),
            contacts: self.contacts,
            unit: self.unit,
            apart: self.apart,
            reach: self.reach,
        }
    }

    /// Returns the same contacts and impulses in mixed precision.
    pub fn mixed(self) -> Sweep<M, Mixed<Single<M>>> {
        let row = |row: &Row<M::Column>| Row {
            column: Mixed { column: row.column.single(), coefficient: row.column.coefficient() },
            offset: row.offset,
        };
        let (rows, free) = (self.rows.iter().map(row).collect(), self.without_impulses());
        let mut sweep = Sweep {
            rows,
            s: self.s,
            y: vec![Zeroable::zeroed(); self.y.len()],
            renewal: Some(Renewal { from: Source::Exact { rows: self.rows, free, y: self.y }, times: 0 }),
            contacts: self.contacts,
            unit: self.unit,
            apart: self.apart,
            reach: self.reach,
        };
        sweep.refine();
        sweep
    }
}

impl<M: Mechanics, C: VisitedIn<M>> Sweep<M, C> {
    /// Makes velocities anew from the impulses where they are in single precision; relative velocities, in mixed precision; nothing in
    /// double precision.
    pub fn refine(&mut self) {
        let Self { rows, s, y, renewal, .. } = self;
        let Some(Renewal { from, times }) = renewal else { return };
        *times += 1;
        match from {
            Source::Free(free) => {
                y.copy_from_slice(free);
                push_all(rows, s, 1.0, y);
            }
            Source::Exact { rows: exact, free, y: exact_y } => {
                exact_y.copy_from_slice(free);
                for (row, s) in exact.iter().zip(s) {
                    row.push(s.double(), exact_y);
                }
                for (row, exact) in rows.iter_mut().zip(exact) {
                    row.offset = Numbers::nearest(exact.relative(exact_y));
                }
                y.fill(Zeroable::zeroed());
            }
        }
    }

    /// Returns the products with W of all renewals; in single precision these are H s, half of one.
    pub fn renewal_products(&self) -> u64 {
        match &self.renewal {
            None => 0,
            Some(Renewal { from: Source::Free(_), times }) => times.div_ceil(2),
            Some(Renewal { from: Source::Exact { .. }, times }) => *times,
        }
    }
}
