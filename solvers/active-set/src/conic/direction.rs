//! Direction of a step, and how far it goes: Newton's matrix, its factors and solves.

use super::Conic;
use super::shift::smoothed;
use crate::cone::reach;
use cholesky::{Coupling, Factor, Lu, OneWay};
use contact::law::tangential;
use contact::status::unit;
use contact::{Cone, Frictional, Mechanics, Rough, Visited};
use nalgebra::{SMatrix, SVector};

/// Factors of Newton's matrix.
pub(super) enum Factors<const N: usize> {
    /// With σ frozen.
    Symmetric(Option<Factor<N>>),
    /// With a σ that follows the velocities.
    General(Lu<N>),
}

/// Direction of x and z, and of v.
pub(super) struct Direction<const D: usize> {
    pub(super) x: Vec<SVector<f64, D>>,
    pub(super) z: Vec<SVector<f64, D>>,
    pub(super) v: Vec<SVector<f64, D>>,
}

impl<const D: usize, const N: usize> Conic<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Adds to `apart` by how much σ will differ from its slope after a step of so much `along` v, to a mean product of `delta`².
    pub(super) fn curve(&mut self, along: &[SVector<f64, D>], share: f64, delta: f64) {
        for (k, column) in self.layout.columns.iter().enumerate() {
            let step = share * along[k];
            let then = smoothed(column.friction(), tangential(self.v[k] + step).1, delta);
            self.apart[k][0] += self.shape[k][0] * (then - self.sigma[k] - self.slope[k].dot(&step));
        }
    }

    pub(super) fn factorise(&mut self, square: &[SMatrix<f64, D, D>]) -> bool {
        self.work.factorisations += 1;
        let Self { layout, shape, structure, factors, slope, work, .. } = self;
        let pushes = |contact: usize, shape: &SVector<f64, D>| {
            let pushes: [_; D] = std::array::from_fn(|c| layout.columns[contact].pushes(unit(c) * shape[c]));
            [0, 1].map(|end| SMatrix::<f64, N, D>::from_columns(&pushes.map(|of| of[end])))
        };
        let one = |_| SVector::repeat(1.0);
        let done = match factors {
            Factors::Symmetric(factor) => {
                work.factorisation_multiply_adds += structure.work();
                let coupling = |contact: usize| {
                    Some(Coupling::product(pushes(contact, &shape[contact]), square[contact]))
                };
                Factor::replace(factor, structure, one, coupling)
            }
            Factors::General(factors) => {
                work.factorisation_multiply_adds += 2 * structure.work();
                let coupling = |contact: usize| {
                    let ends = pushes(contact, &SVector::repeat(1.0));
                    let shape = &shape[contact];
                    let weights = square[contact].component_mul(&(shape * shape.transpose()));
                    let weights = weights + weights.column(0) * slope[contact].transpose();
                    Some(OneWay::product(ends.map(|end| end * weights), ends))
                };
                factors.renew(one, coupling).is_ok()
            }
        };
        // Two solves, each with the factor and its transpose.
        work.triangular_solve_entries += if done { 4 * structure.entries() as u64 } else { 0 };
        done
    }

    /// Newton's direction towards dx + W² dz = `goal`:
    ///
    /// (1 + Σ H̃ T W² T G H̃ᵗ) dy = Σ H̃ T (goal − W² apart),   dz = T G H̃ᵗ dy + apart,   dx = goal − W² dz
    pub(super) fn towards(&self, square: &[SMatrix<f64, D, D>], goal: &[SVector<f64, D>]) -> Direction<D> {
        let apart = &self.apart;
        let contacts = || self.layout.columns.iter().zip(&self.shape).enumerate();
        let mut y = vec![SVector::zeros(); self.layout.free.len()];
        for (k, (column, shape)) in contacts() {
            column.push((goal[k] - square[k] * apart[k]).component_mul(shape), &mut y);
        }
        match &self.factors {
            Factors::Symmetric(factor) => factor.iter().for_each(|factor| factor.solve(&mut y)),
            Factors::General(factors) => factors.solve(&mut y),
        }
        let v: Vec<_> = self.layout.columns.iter().map(|column| column.relative(&y)).collect();
        let of = |(k, (_, shape)): (usize, (&<Rough<D> as Mechanics>::Column, &SVector<f64, D>))| {
            let mut moved = v[k];
            moved[0] += self.slope[k].dot(&v[k]);
            let dz = moved.component_mul(shape) + apart[k];
            (goal[k] - square[k] * dz, dz)
        };
        let (x, z) = contacts().map(of).unzip();
        Direction { x, z, v }
    }

    /// Returns the lengths of the steps of x and of z: a `share` of the way to the boundaries of their cones, at most 1. Where σ follows v,
    /// and v follows x, both have the same.
    pub(super) fn lengths(&self, way: &Direction<D>, share: f64) -> [f64; 2] {
        let least = |x: &[SVector<f64, D>], dx: &[SVector<f64, D>]| {
            x.iter().zip(dx).map(|(x, dx)| reach(x, dx)).fold(f64::INFINITY, f64::min)
        };
        let [of_x, of_z] =
            [least(&self.x, &way.x), least(&self.z, &way.z)].map(|reach| (share * reach).min(1.0));
        match self.factors {
            Factors::Symmetric(_) => [of_x, of_z],
            Factors::General(_) => [of_x.min(of_z); 2],
        }
    }

    /// The mean of x · z after steps of these lengths.
    pub(super) fn mean(&self, way: &Direction<D>, [of_x, of_z]: [f64; 2]) -> f64 {
        let of = |k: usize| (self.x[k] + of_x * way.x[k]).dot(&(self.z[k] + of_z * way.z[k]));
        (0..self.x.len()).map(of).sum::<f64>() / self.x.len() as f64
    }
}
