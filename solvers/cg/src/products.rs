//! Products with W that the conjugate gradient with friction needs: of grains, or of a W that is stored.

use crate::State;
use contact::Mechanics;
use nalgebra::SVector;
use product::Product;

/// Products with W, and a [`State`] at each contact, in units that make a cone of a cone: one for its normal, one for its tangents.
pub trait Products<const D: usize> {
    /// First half of the product W p: `p` gives the p of each contact.
    fn push(&mut self, p: impl Fn(&mut State<D>) -> SVector<f64, D> + Sync);

    /// Second half: `take` is given (W p)_α of each contact, and gives the terms of sums over the contacts.
    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<D>, SVector<f64, D>) -> [f64; N] + Sync,
    ) -> [f64; N];

    /// pᵗ W p of the p last pushed, without the second half.
    fn curvature(&mut self) -> f64;

    /// The sums of several `terms` over the contacts.
    fn sums_of<const N: usize>(&mut self, terms: impl Fn(&State<D>) -> [f64; N] + Sync) -> [f64; N];

    /// Changes each contact.
    fn each(&mut self, change: impl Fn(&mut State<D>) + Sync);

    /// Puts the impulses into the problem's order (N·s).
    fn impulses(&self, r: &mut [f64]);
}

impl<M: Mechanics<Impulse = SVector<f64, D>>, const D: usize> Products<D> for Product<State<D>, M> {
    fn push(&mut self, p: impl Fn(&mut State<D>) -> SVector<f64, D> + Sync) {
        self.push(p);
    }

    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<D>, SVector<f64, D>) -> [f64; N] + Sync,
    ) -> [f64; N] {
        self.pull_sums(take)
    }

    fn curvature(&mut self) -> f64 {
        self.curvature()
    }

    fn sums_of<const N: usize>(&mut self, terms: impl Fn(&State<D>) -> [f64; N] + Sync) -> [f64; N] {
        self.sums_of(terms)
    }

    fn each(&mut self, change: impl Fn(&mut State<D>) + Sync) {
        self.each(change);
    }

    fn impulses(&self, r: &mut [f64]) {
        self.impulses(State::impulse, r);
    }
}
