//! Messages between subdomains at a boundary grain, and their sums, (3).

use nalgebra::SVector;
use partition::Sendable;
use std::iter::Sum;
use std::ops::Add;

/// Message of a copy of a boundary grain.
#[derive(Clone, Copy)]
pub(crate) struct Sent<const D: usize> {
    /// d⁺ V_E − F_E (N·s).
    pub(crate) impulse: SVector<f64, D>,
    /// V_E/m_i (m/s).
    pub(crate) velocity: SVector<f64, D>,
}

impl<const D: usize> Default for Sent<D> {
    fn default() -> Self {
        Self { impulse: SVector::zeros(), velocity: SVector::zeros() }
    }
}

impl<const D: usize> Add for Sent<D> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { impulse: self.impulse + other.impulse, velocity: self.velocity + other.velocity }
    }
}

impl<const D: usize> Sum for Sent<D> {
    #[inline]
    fn sum<I: Iterator<Item = Self>>(sent: I) -> Self {
        sent.fold(Self::default(), Self::add)
    }
}

impl<const D: usize> Sendable for Sent<D> {
    const NUMBERS: usize = 2 * D;

    fn write(self, numbers: &mut Vec<f64>) {
        numbers.extend(self.impulse.iter().chain(self.velocity.iter()));
    }

    fn read(numbers: &[f64]) -> Self {
        let (impulse, velocity) = numbers.split_at(D);
        Self { impulse: SVector::from_column_slice(impulse), velocity: SVector::from_column_slice(velocity) }
    }
}
