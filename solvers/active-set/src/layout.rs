//! A packing with friction in mass-scaled unknowns, where every `W_αα` is 1.

use contact::law::admissible;
use contact::status::Status;
use contact::{Column, Cone, Frictional, Mass, Mechanics, Packing, Rough, Touch, Vector, Visited};
use nalgebra::SVector;

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// A contact in D dimensions.
pub(crate) type ColumnOf<const D: usize> = <Rough<D> as Mechanics>::Column;

/// The packing: v = H̃ᵗ (`free` + H̃ s) + `offset`. Velocities of grains have N components.
#[derive(Clone)]
pub(crate) struct Layout<const D: usize, const N: usize>
where
    Rough<D>: Mechanics,
{
    pub(crate) columns: Vec<ColumnOf<D>>,
    /// √`W_αα` (kg^-½).
    pub(crate) unit: Vec<SVector<f64, D>>,
    /// c/√`W_αα` (√J).
    pub(crate) offset: Vec<SVector<f64, D>>,
    /// M^½ `V_free` (√J).
    pub(crate) free: Vec<SVector<f64, N>>,
    /// √ of the sum of squares of the terms of which b is the sum, M^½ `V_free` of the grains and c of the contacts (√J).
    pub(crate) terms_of_b: f64,
}

impl<const D: usize, const N: usize> Layout<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Lays a packing out, with its grains in their own order.
    pub(crate) fn new(problem: &Packing<Rough<D>>) -> Self {
        Self::placed(problem, |grain| grain)
    }

    /// Lays a packing out, with its grains in other places.
    pub(crate) fn placed(problem: &Packing<Rough<D>>, place: impl Fn(u32) -> u32) -> Self {
        let inverse_mass = |grain: u32| Mass::<SVector<f64, N>>::inverse(problem.mass()[grain as usize], 1.0);
        let column = |contact: &<Rough<D> as Mechanics>::Contact| {
            let (i, j) = contact.ends();
            ColumnOf::<D>::new(contact, (place(i), j.map(&place)), inverse_mass, true)
        };
        let (columns, unit): (Vec<_>, Vec<_>) = problem.contacts().iter().map(column).unzip();
        let offset: Vec<_> =
            problem.contacts().iter().zip(&unit).map(|(at, unit)| at.offset.component_div(unit)).collect();
        let mut free = vec![SVector::zeros(); problem.grain_count()];
        let own = problem.scaled_velocity(&vec![0.0; problem.impulse_count()]);
        own.iter().zip(0..).for_each(|(y, grain)| free[place(grain) as usize] = *y);
        let of = |(column, c): (&ColumnOf<D>, &SVector<f64, D>)| {
            let terms = column.places().map(|place| free[place as usize].norm_squared());
            terms.iter().sum::<f64>() + c.norm_squared()
        };
        let terms_of_b = columns.iter().zip(&offset).map(of).sum::<f64>().sqrt();
        Self { columns, unit, offset, free, terms_of_b }
    }

    /// Grains.
    pub(crate) fn grains(&self) -> usize {
        self.free.len()
    }

    /// The impulses `r` (N·s) as s (√J).
    pub(crate) fn scaled(&self, r: &[f64]) -> Vec<SVector<f64, D>> {
        let of = |(k, unit): (usize, &SVector<f64, D>)| SVector::<f64, D>::at(r, k).component_mul(unit);
        self.unit.iter().enumerate().map(of).collect()
    }

    /// The nearest impulses to s that the law admits (√J).
    pub(crate) fn admitted(&self, s: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        s.iter().zip(&self.columns).map(|(s, column)| admissible(*s, column.friction())).collect()
    }

    /// The nearest impulses to s that the law admits (N·s).
    pub(crate) fn impulses(&self, s: &[SVector<f64, D>], r: &mut [f64]) {
        for (k, (s, unit)) in self.admitted(s).iter().zip(&self.unit).enumerate() {
            s.component_div(unit).put(r, k);
        }
    }

    /// `from` + H̃ s (√J).
    pub(crate) fn pushed(
        &self,
        mut from: Vec<SVector<f64, N>>,
        s: &[SVector<f64, D>],
    ) -> Vec<SVector<f64, N>> {
        self.columns.iter().zip(s).for_each(|(column, s)| column.push(*s, &mut from));
        from
    }

    /// v of s (√J).
    pub(crate) fn velocity(&self, s: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let y = self.pushed(self.free.clone(), s);
        self.columns.iter().zip(&self.offset).map(|(column, c)| column.relative(&y) + c).collect()
    }

    /// Makes sweeps of non-linear Gauss-Seidel.
    pub(crate) fn sweep(&self, s: &mut [SVector<f64, D>], sweeps: u32) {
        let mut y = self.pushed(self.free.clone(), s);
        self.sweep_held(&(0..self.columns.len()), |_| None, s, &mut y, sweeps);
    }

    /// Makes sweeps over `contacts` alone, with the velocities y of grains that go with s (√J); a grain for which `held` has a velocity
    /// keeps it.
    pub(crate) fn sweep_held(
        &self,
        contacts: &(impl Iterator<Item = usize> + Clone),
        held: impl Fn(usize) -> Option<SVector<f64, N>>,
        s: &mut [SVector<f64, D>],
        y: &mut [SVector<f64, N>],
        sweeps: u32,
    ) {
        for _ in 0..sweeps {
            for k in contacts.clone() {
                let column = &self.columns[k];
                let change = column.change(s[k], column.relative(y) + self.offset[k], 1.0);
                s[k] += change;
                column.push(change, y);
                for place in column.places().map(|place| place as usize) {
                    y[place] = held(place).unwrap_or(y[place]);
                }
            }
        }
    }

    /// Returns the residual of the law, weighed as energy: the natural map (√J).
    pub(crate) fn left(&self, s: &[SVector<f64, D>], v: &[SVector<f64, D>]) -> f64 {
        let of = |((s, v), column): ((&SVector<f64, D>, &SVector<f64, D>), &ColumnOf<D>)| {
            column.residual(*s, *v).norm_squared()
        };
        s.iter().zip(v).zip(&self.columns).map(of).sum::<f64>().sqrt()
    }

    /// Reports whether the residual `left` (√J) of the impulses s is round-off.
    pub(crate) fn is_round_off(&self, left: f64, s: &[SVector<f64, D>]) -> bool {
        left <= ROUND_OFF * (norm(s) + self.terms_of_b)
    }

    /// The statuses that s − v has.
    pub(crate) fn statuses(&self, s: &[SVector<f64, D>], v: &[SVector<f64, D>]) -> Vec<Status<D>> {
        let of = |((s, v), column): ((&SVector<f64, D>, &SVector<f64, D>), &ColumnOf<D>)| {
            Status::of(*s, *v, column.friction())
        };
        s.iter().zip(v).zip(&self.columns).map(of).collect()
    }
}

/// Proximal term that draws impulses to others: v + ε (s − centre) takes the place of v.
#[derive(Clone, Copy)]
pub(crate) struct Drawn<'a, const D: usize> {
    /// ε (–).
    pub(crate) epsilon: f64,
    /// Towards which ε draws (√J); to themselves, without.
    pub(crate) centre: Option<&'a [SVector<f64, D>]>,
}

impl<const D: usize> Drawn<'_, D> {
    /// v + ε (s − centre) (√J).
    pub(crate) fn velocity<const N: usize>(
        &self,
        layout: &Layout<D, N>,
        s: &[SVector<f64, D>],
    ) -> Vec<SVector<f64, D>>
    where
        Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
    {
        let mut v = layout.velocity(s);
        if let Some(centre) = self.centre {
            v.iter_mut().zip(s).zip(centre).for_each(|((v, s), c)| *v += self.epsilon * (s - c));
        }
        v
    }
}

/// √ of the sum of squares.
pub(crate) fn norm<const D: usize>(s: &[SVector<f64, D>]) -> f64 {
    s.iter().map(SVector::norm_squared).sum::<f64>().sqrt()
}

/// √ of the sum of squares of a − b.
pub(crate) fn distance<const D: usize>(a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt()
}
