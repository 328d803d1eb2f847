//! Products with W that the conjugate gradient needs: of grains, or of a W that is stored.

use crate::{Constants, Law, State};
use contact::{Mechanics, Vector};
use product::{At, Product, Pulled};

/// Products with W, and a [`State`] and [`Constants`] at each contact, in units that make a cone of a cone: one for its normal, one for its
/// tangents.
pub trait Products<I: Law> {
    /// First half of the product W p: `p` gives the p of each contact, and the terms of sums over the contacts.
    fn push_by<const N: usize>(&mut self, p: impl At<State<I>, (), (I, [f64; N])>) -> [f64; N];

    /// First half of the product W p: `p` gives the p of each contact.
    fn push(&mut self, p: impl Fn(&mut State<I>) -> I + Copy + Sync) {
        let [] = self.push_by(move |at: &mut State<I>, ()| (p(at), []));
    }

    /// pᵗ W p of the p last pushed, without the second half.
    fn curvature(&mut self) -> f64;

    /// Second half: `take` is given (W p)_α of each contact, and gives the terms of sums over the contacts.
    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<I>, &Constants<I>, I) -> [f64; N] + Copy + Sync,
    ) -> [f64; N];

    /// Second half, after `curvature`, and the first half of W d: `take` gives the d of each contact, unless it is 0, and the terms of sums.
    fn pull_and_push(&mut self, take: impl At<State<I>, I, Pulled<I>>) -> [f64; 3];

    /// Second half of W d: u ← u − W d. Returns wᵗ W p, which was the first sum of the pass before, as if d were 0, and dᵗ W d, or 0 where
    /// nothing is minimised.
    fn correct(&mut self) -> [f64; 2] {
        self.pull_sums(|at, _, of_d| {
            at.u -= of_d;
            [at.product(), 0.0]
        })
    }

    /// Makes the next products in double precision, or no longer, where precision is mixed.
    fn set_exact(&mut self, _is_exact: bool) {}

    /// The sum of a `term` over the contacts.
    fn sum_of(&self, term: impl Fn(&State<I>) -> f64) -> f64;

    /// The least value at any contact; infinite without contact.
    fn least_of(&mut self, value: impl Fn(&State<I>) -> f64 + Sync) -> f64;

    /// Puts the impulses into the problem's order (N·s).
    fn impulses(&self, r: &mut [f64]);
}

impl<M: Mechanics<Impulse: Law>> Products<M::Impulse>
    for Product<State<M::Impulse>, Constants<M::Impulse>, M>
{
    fn push_by<const N: usize>(
        &mut self,
        p: impl At<State<M::Impulse>, (), (M::Impulse, [f64; N])>,
    ) -> [f64; N] {
        self.push_by(p)
    }

    fn curvature(&mut self) -> f64 {
        self.curvature()
    }

    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<M::Impulse>, &Constants<M::Impulse>, M::Impulse) -> [f64; N] + Copy + Sync,
    ) -> [f64; N] {
        self.pull_sums(take)
    }

    fn pull_and_push(
        &mut self,
        take: impl At<State<M::Impulse>, M::Impulse, Pulled<M::Impulse>>,
    ) -> [f64; 3] {
        self.pull_and_push(take)
    }

    fn correct(&mut self) -> [f64; 2] {
        if M::Impulse::MINIMISES {
            self.pull_around(|at, of_d| {
                let before = M::Impulse::w(at);
                at.u -= of_d;
                (M::Impulse::w(at) - before).dot_product(at.of_p)
            })
        } else {
            self.pull_sums(|at, _, of_d| {
                at.u -= of_d;
                [at.product(), 0.0]
            })
        }
    }

    fn set_exact(&mut self, is_exact: bool) {
        self.set_exact(is_exact);
    }

    fn sum_of(&self, term: impl Fn(&State<M::Impulse>) -> f64) -> f64 {
        self.sum_apart(term)
    }

    fn least_of(&mut self, value: impl Fn(&State<M::Impulse>) -> f64 + Sync) -> f64 {
        self.least_of(value)
    }

    fn impulses(&self, r: &mut [f64]) {
        self.impulses(State::impulse, r);
    }
}
