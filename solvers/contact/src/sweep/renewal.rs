//! Sweeps in single and in mixed precision, and how their velocities are made anew from the impulses.

use super::Sweep;
use crate::mechanics::{Column, Mechanics, VisitedIn};
use crate::precision::{Mixed, Single};
use crate::vector::Numbers;
use crate::visit::{Row, Visited, push_all};
use bytemuck::Zeroable;

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
    pub fn mixed(self) -> Sweep<M, Mixed<Single<M>, <M::Column as Visited>::Law>> {
        let row = |row: &Row<M::Column>| Row {
            column: Mixed { column: row.column.single(), law: row.column.law() },
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
