//! A problem in mass-scaled unknowns, s = √`W_αα` r and v/√`W_αα`, in which M = 1 and `W_αα` = 1. All in √J; contacts and grains
//! are in the order of what solves with K.

use crate::inner::{Inner, Whole};
use cholesky::Coupling;
use contact::{Column, Packing, ScaledContact, Smooth, Visited, Work, law};
use nalgebra::SVector;

/// The problem, and what solves with K = 1 + Σ d h̃ h̃ᵗ for some weights d ≥ 0 of the contacts.
pub(crate) struct Scaled<const D: usize = 2, K: Inner<D> = Whole<D>> {
    pub(crate) inner: K,
    /// h̃ of each contact, between two places of the factor.
    columns: Vec<ScaledContact<D>>,
    /// The problem's contact of each column, and back.
    contact: Vec<u32>,
    column: Vec<u32>,
    /// √`W_αα` (kg^-½).
    unit: Vec<f64>,
    /// c/√`W_αα`.
    offset: Vec<f64>,
    /// M^½ `V_free` of each place.
    free: Vec<SVector<f64, D>>,
    /// M^½ V, or a change of it.
    y: Vec<SVector<f64, D>>,
    /// √(Σ (|h̃ᵗ| |y| + |c|)²) of `V_free`: the terms of which v without impulses is the sum.
    pub(crate) terms_of_b: f64,
    products: u64,
}

impl<const D: usize, K: Inner<D>> Scaled<D, K> {
    /// Lays the problem out as `inner` wants it.
    pub(crate) fn new(problem: &Packing<Smooth<D>>, inner: K) -> Self {
        let place = inner.position();
        let contact: Vec<u32> = inner.contacts().collect();
        let mut column = vec![0; contact.len()];
        (0_u32..).zip(&contact).for_each(|(k, contact)| column[*contact as usize] = k);
        let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
        let of_contact = |contact: &u32| {
            let contact = &problem.contacts()[*contact as usize];
            let places = (place[contact.candidate as usize], contact.antagonist.map(|j| place[j as usize]));
            let (column, unit) = ScaledContact::new(contact, places, inverse_mass, true);
            (column, (unit, contact.offset / unit))
        };
        let (columns, (unit, offset)): (Vec<_>, (Vec<_>, Vec<_>)) = contact.iter().map(of_contact).unzip();
        let mut free = vec![SVector::zeros(); problem.grain_count()];
        for ((place, v_free), mass) in place.iter().zip(problem.free_velocity()).zip(problem.mass()) {
            free[*place as usize] = mass.sqrt() * v_free;
        }
        let sizes: Vec<_> = free.iter().map(SVector::abs).collect();
        let terms = columns.iter().zip(&offset).map(|(column, offset): (&ScaledContact<D>, &f64)| {
            let (first, second) = column.at_ends();
            let [i, j] = column.places().map(|place| &sizes[place as usize]);
            first.abs().dot(i) + second.abs().dot(j) + offset.abs()
        });
        let terms_of_b = terms.map(|terms| terms * terms).sum::<f64>().sqrt();
        let y = free.clone();
        Self { inner, columns, contact, column, unit, offset, free, y, terms_of_b, products: 0 }
    }

    /// Work so far.
    pub(crate) fn work(&self) -> Work {
        let mut work = self.inner.work();
        work.delassus_products += self.products;
        work
    }

    /// s of the impulses `r`, which are in the problem's order (N·s).
    pub(crate) fn scale(&self, r: &[f64]) -> Vec<f64> {
        self.unit.iter().zip(&self.contact).map(|(unit, contact)| unit * r[*contact as usize]).collect()
    }

    /// r = max(0, s)/√`W_αα` in the problem's order (N·s).
    pub(crate) fn impulses(&self, s: &[f64], r: &mut [f64]) {
        for ((s, unit), contact) in s.iter().zip(&self.unit).zip(&self.contact) {
            r[*contact as usize] = law::non_negative(s / unit);
        }
    }

    /// κ of a closed contact (–).
    pub(crate) fn penalty(&self) -> f64 {
        self.inner.penalty()
    }

    /// Number of contacts.
    pub(crate) fn contacts(&self) -> usize {
        self.columns.len()
    }

    /// v of the impulses `s`.
    pub(crate) fn velocities(&mut self, s: &[f64], v: &mut [f64]) {
        self.products += 1;
        self.y.copy_from_slice(&self.free);
        for (column, s) in self.columns.iter().zip(s) {
            column.push(*s, &mut self.y);
        }
        for ((column, v), offset) in self.columns.iter().zip(v).zip(&self.offset) {
            *v = column.relative(&self.y) + offset;
        }
    }

    /// Factorises K = 1 + Σ d h̃ h̃ᵗ with the `weight` d ≥ 0 of each contact; says whether it could.
    pub(crate) fn factorise(&mut self, weight: impl Fn(usize) -> f64 + Sync) -> bool {
        let Self { inner, columns, column, .. } = self;
        inner.factorise(|contact| {
            let k = column[contact] as usize;
            let (first, second) = columns[k].at_ends();
            let weight = weight(k);
            (weight != 0.0).then(|| Coupling::dyad(weight, first, second))
        })
    }

    /// δy = K⁻¹ H̃ p, for the `p` of each contact; then gives (H̃ᵗ δy)_α of each to `take`.
    pub(crate) fn solve(&mut self, p: impl Fn(usize) -> f64, mut take: impl FnMut(usize, f64)) {
        self.y.fill(SVector::zeros());
        for (k, column) in self.columns.iter().enumerate() {
            column.push(p(k), &mut self.y);
        }
        self.inner.solve(&mut self.y);
        for (k, column) in self.columns.iter().enumerate() {
            take(k, column.relative(&self.y));
        }
    }
}

/// √(Σ min(s, v)²): what is left of the law (√J).
pub(crate) fn left(s: &[f64], v: &[f64]) -> f64 {
    s.iter().zip(v).map(|(s, v)| if s < v { s * s } else { v * v }).sum::<f64>().sqrt()
}
