//! Kernel of measures of any mechanics, contact by contact in mass-scaled unknowns: the velocities that an iterate gives to the grains, and
//! the sums over contacts from which its measures are computed.
//!
//! The velocity y that impulses r add to the grains has the unit of the kernel: m/s, or √J where grains are mass-scaled. Impulses are
//! added up at each grain in the order of the contacts, whether contacts push one after the other or each grain gathers its own: the
//! operations and their order are the same with any number of threads, and a contact that is evaluated alone has the bits that it has
//! among all.

use crate::adjacency::Adjacency;
use crate::law::greatest;
use crate::mechanics::{Column, Ends, Gauge, Mass, Mechanics, Touch};
use crate::sums::Sums;
use crate::vector::Vector;
use crate::visit::Visited;
use std::ops::Range;

/// Mass-scaled columns of H̃ with the constants of their contacts. Its y is M^½ (V − `V_free`) (√J).
pub struct Scaled<M: Mechanics> {
    columns: Vec<M::Column>,
    /// √`W_αα` (kg^-½).
    unit: Vec<M::Impulse>,
    /// b/√`W_αα` (√J).
    b: Vec<M::Impulse>,
    adjacency: Adjacency,
}

/// Component by component.
#[inline]
fn times<V: Vector>(a: V, b: V) -> V {
    a.with(b, |a, b| a * b)
}

fn squared<V: Vector>(x: V) -> f64 {
    x.dot_product(x)
}

impl<M: Mechanics> Scaled<M> {
    /// s = √`W_αα` r of a contact (√J).
    #[inline]
    fn s(&self, contact: usize, r: &[f64]) -> M::Impulse {
        times(M::Impulse::at(r, contact), self.unit[contact])
    }
}

impl<M: Mechanics> Gauge<M> for Scaled<M> {
    fn new(
        mass: &[M::Mass],
        free_velocity: &[M::Velocity],
        of: &[M::Contact],
        contacts: impl Iterator<Item = (usize, Ends)> + Clone,
        grains: impl ExactSizeIterator<Item = usize>,
    ) -> Self {
        let inverse_mass = |grain: u32| mass[grain as usize].inverse(1.0);
        let column = |(k, ends)| M::Column::new(&of[k], ends, inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<M::Impulse>) = contacts.clone().map(column).unzip();
        let scaled = |((k, _), unit): ((usize, Ends), &M::Impulse)| {
            let contact = &of[k];
            (contact.relative(free_velocity) + contact.offset()).with(*unit, |b, unit| b / unit)
        };
        Self {
            b: contacts.clone().zip(&unit).map(scaled).collect(),
            adjacency: Adjacency::new(contacts.map(|(_, ends)| ends), grains.len()),
            columns,
            unit,
        }
    }

    fn places(&self) -> usize {
        self.adjacency.grain_count()
    }

    fn push(&self, r: &[f64], y: &mut [M::Velocity]) {
        y.fill(M::Velocity::ZERO);
        self.columns.iter().enumerate().for_each(|(k, column)| column.push(self.s(k, r), y));
    }

    fn gather(&self, place: usize, r: &[f64]) -> M::Velocity {
        let pushed = |contact: &u32| {
            let column = &self.columns[*contact as usize];
            let [candidate, antagonist] = column.pushes(self.s(*contact as usize, r));
            if column.places()[0] as usize == place { candidate } else { antagonist }
        };
        self.adjacency.around(place).iter().map(pushed).sum()
    }

    fn sums(&self, contacts: Range<usize>, r: &[f64], y: &[M::Velocity], alone: bool) -> Sums {
        let mut sums = Sums::default();
        for (place, k) in contacts.enumerate() {
            let (column, unit, b, s) = (&self.columns[k], self.unit[k], self.b[k], self.s(k, r));
            let v = column.relative(y) + b;
            let residual = column.residual(s, v);
            sums.natural_map += squared(residual);
            if !alone {
                // DV = W_αα (r⁺ − r) and WR = W_αα r, in m/s.
                let (dv, wr) = (times(residual, unit), times(s, unit));
                let (wr_plus, squared_dv) = (wr - dv, squared(dv));
                sums.dv += squared_dv;
                sums.wr_twice += squared(wr) + squared(wr_plus);
                sums.greatest_dv = greatest([sums.greatest_dv, squared_dv.sqrt()].into_iter());
                sums.active += f64::from(u8::from(wr.first() + wr_plus.first() > 0.0));
                sums.energy_twice += s.dot_product(v + b);
                sums.take_rate(-v.first() * unit.first(), Some(place));
            }
        }
        sums
    }

    fn alone(&self, contact: usize, r: &[f64]) -> (f64, f64) {
        let column = &self.columns[contact];
        let ends = column.places().map(|place| self.gather(place as usize, r));
        let v = column.between(ends) + self.b[contact];
        let residual = column.residual(self.s(contact, r), v);
        (squared(residual), -v.first() * self.unit[contact].first())
    }

    fn size(&self, r: &[f64]) -> f64 {
        (0..self.unit.len()).map(|k| squared(self.s(k, r))).sum::<f64>().sqrt()
    }

    fn size_of_b(&self) -> f64 {
        self.b.iter().map(|b| squared(*b)).sum::<f64>().sqrt()
    }

    fn scaled(mass: M::Mass, velocity: M::Velocity) -> M::Velocity {
        mass.root().times(velocity)
    }

    fn squared(&self, _: usize, y: M::Velocity) -> f64 {
        squared(y)
    }
}
