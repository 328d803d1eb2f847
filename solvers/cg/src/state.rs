//! A contact of the conjugate gradient: its part of the iterate and of the direction, and what the law makes of a step and of a
//! gradient.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod coulomb;
mod signorini;

use contact::Vector;
use product::{At, Pulled};

/// State of a contact: all in the units of the product, the normal part first, then one tangential part in the plane and two in space.
pub struct State<I: Law> {
    pub(crate) r: I,
    /// u = −(W r + b).
    pub(crate) u: I,
    /// The direction.
    pub(crate) p: I,
    /// (W p)_α.
    pub(crate) of_p: I,
    pub(crate) status: I::Status,
}

/// Constants of a contact, in the same units.
pub struct Constants<I> {
    pub(crate) b: I,
    /// `W_αα`.
    pub(crate) diagonal: I,
}

/// A law of contact, by the impulse that it admits: how it projects a step, and which parts of a gradient it blocks.
pub trait Law: Vector {
    /// Law of a contact in mass-scaled unknowns.
    type OfContact;

    /// Numbers of the law at a contact, and the status of its impulse.
    type Status: Copy + Send + Sync;

    /// True where the law is the optimality of the least q(r): no step makes q greater than it was at first. Few contacts then change status
    /// in a step.
    const MINIMISES: bool;

    /// Returns the status of an impulse r in the `unit` of its contact, with μ of the problem, and `W_αα` in the unit.
    fn status(r: Self, friction: f64, diagonal: Self, unit: Self) -> Self::Status;

    /// r ← r + α p + d, admissible, where u is the gradient before the step. Returns d, unless it is 0.
    fn step(at: &mut State<Self>, length: f64) -> Option<Self>;

    /// Returns w: the part of u that the law does not block.
    fn w(at: &State<Self>) -> Self;

    /// Returns w + β z, with z the part of p that the law does not block.
    fn direction(at: &State<Self>, beta: f64) -> Self;

    /// Returns |r − r⁺|² where `W_αα` is 1.
    fn left(at: &State<Self>) -> f64;

    /// Returns the squared size of the terms of u, where the law does not block it; 0 where nothing is minimised.
    fn squared_size(_: &State<Self>, _: &Constants<Self>) -> f64 {
        0.0
    }

    /// Returns the longest step along p for which d = 0; infinite where nothing is minimised.
    fn reach(_: &State<Self>) -> f64 {
        f64::INFINITY
    }

    /// Gives r its value before the step; does nothing where nothing is minimised.
    fn withdraw(_: &mut State<Self>) {}
}

impl<I: Law> State<I> {
    /// A contact of the problem, with its b (m/s), r (N·s), μ (–), `diagonal` `W_αα` (1/kg) and `unit` (kg^-½, or 1).
    pub fn new(b: I, r: I, friction: f64, diagonal: I, unit: I) -> (Self, Constants<I>) {
        let r = r.with(unit, |r, unit| r * unit);
        let b = b.with(unit, |b, unit| b / unit);
        let diagonal = diagonal.with(unit, |diagonal, unit| diagonal / (unit * unit));
        let status = I::status(r, friction, diagonal, unit);
        (Self { r, u: I::ZERO, p: I::ZERO, of_p: I::ZERO, status }, Constants { b, diagonal })
    }

    /// r.
    pub fn impulse(&self) -> I {
        self.r
    }

    /// u = −(W r + b), from (W r)_α.
    #[inline]
    pub(crate) fn renew(&mut self, constants: &Constants<I>, of_r: I) {
        self.u = -(of_r + constants.b);
    }

    /// The term of wᵗ W p.
    #[inline]
    pub(crate) fn product(&self) -> f64 {
        I::w(self).dot_product(self.of_p)
    }
}

/// A step along p, of the length α: r ← r + α p + d, and u as if d were 0. Gives d, unless it is 0, and, where q is minimised, the terms of
/// wᵗ W p, of −uᵗ d and of the number of d.
#[derive(Clone, Copy)]
pub(crate) struct Step(pub(crate) f64);

impl<I: Law> At<State<I>, I, Pulled<I>> for Step {
    #[inline(always)]
    fn at(&self, at: &mut State<I>, of_p: I) -> Pulled<I> {
        let d = I::step(at, self.0);
        at.of_p = of_p;
        at.u -= of_p * self.0;
        let if_minimised = |term: f64| if I::MINIMISES { term } else { 0.0 };
        let terms = |d: I| [if_minimised(-at.u.dot_product(d)), if_minimised(1.0)];
        Pulled { next: d.map(|d| (d, terms(d))), term: if_minimised(at.product()) }
    }
}

/// The next direction p = w + β z. Gives p, and the terms of uᵗ p and pᵗ p.
#[derive(Clone, Copy)]
pub(crate) struct Turn(pub(crate) f64);

impl<I: Law> At<State<I>, (), (I, [f64; 2])> for Turn {
    #[inline(always)]
    fn at(&self, at: &mut State<I>, (): ()) -> (I, [f64; 2]) {
        at.p = I::direction(at, self.0);
        (at.p, [at.u.dot_product(at.p), at.p.dot_product(at.p)])
    }
}
