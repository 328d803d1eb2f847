//! Direction of a step, and how far it goes: Newton's matrix, its factors and solves.

use super::Conic;
use crate::cone::reach;
use cholesky::{Coupling, Factor};
use contact::status::unit;
use contact::{Frictional, Mechanics, Rough, Visited};
use nalgebra::{SMatrix, SVector};

/// Direction of x and z.
pub(super) struct Direction<const D: usize> {
    pub(super) x: Vec<SVector<f64, D>>,
    pub(super) z: Vec<SVector<f64, D>>,
}

impl<const D: usize, const N: usize> Conic<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    pub(super) fn factorise(&mut self, square: &[SMatrix<f64, D, D>]) -> bool {
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += self.structure.work();
        let Self { layout, shape, structure, factor, .. } = self;
        let coupling = |contact: usize| {
            let column = &layout.columns[contact];
            let pushes: [_; D] = std::array::from_fn(|c| column.pushes(unit(c) * shape[contact][c]));
            let ends = [0, 1].map(|end| SMatrix::<f64, N, D>::from_columns(&pushes.map(|of| of[end])));
            Some(Coupling::product(ends, square[contact]))
        };
        let done = Factor::replace(factor, structure, |_| SVector::repeat(1.0), coupling);
        // Two solves, each with the factor and its transpose.
        self.work.triangular_solve_entries += if done { 4 * self.structure.entries() as u64 } else { 0 };
        done
    }

    /// Newton's direction towards dx + W² dz = `goal`:
    ///
    /// (1 + Σ H̃ T W² T H̃ᵗ) dy = Σ H̃ T (goal − W² apart),   dz = T H̃ᵗ dy + apart,   dx = goal − W² dz
    pub(super) fn towards(&self, square: &[SMatrix<f64, D, D>], goal: &[SVector<f64, D>]) -> Direction<D> {
        let apart = &self.apart;
        let contacts = || self.layout.columns.iter().zip(&self.shape).enumerate();
        let mut y = vec![SVector::zeros(); self.layout.free.len()];
        for (k, (column, shape)) in contacts() {
            column.push((goal[k] - square[k] * apart[k]).component_mul(shape), &mut y);
        }
        self.factor.iter().for_each(|factor| factor.solve(&mut y));
        let of = |(k, (column, shape)): (usize, (&<Rough<D> as Mechanics>::Column, &SVector<f64, D>))| {
            let dz = column.relative(&y).component_mul(shape) + apart[k];
            (goal[k] - square[k] * dz, dz)
        };
        let (x, z) = contacts().map(of).unzip();
        Direction { x, z }
    }

    /// Returns the lengths of the steps of x and of z: a `share` of the way to the boundaries of their cones, at most 1.
    pub(super) fn lengths(&self, way: &Direction<D>, share: f64) -> [f64; 2] {
        let least = |x: &[SVector<f64, D>], dx: &[SVector<f64, D>]| {
            x.iter().zip(dx).map(|(x, dx)| reach(x, dx)).fold(f64::INFINITY, f64::min)
        };
        [least(&self.x, &way.x), least(&self.z, &way.z)].map(|reach| (share * reach).min(1.0))
    }

    /// The mean of x · z after steps of these lengths.
    pub(super) fn mean(&self, way: &Direction<D>, [of_x, of_z]: [f64; 2]) -> f64 {
        let of = |k: usize| (self.x[k] + of_x * way.x[k]).dot(&(self.z[k] + of_z * way.z[k]));
        (0..self.x.len()).map(of).sum::<f64>() / self.x.len() as f64
    }
}
