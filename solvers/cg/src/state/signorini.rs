//! Without friction: r ≥ 0, and min over it of q(r).

use super::{Constants, Law, State};
use contact::law::{Signorini, non_negative};

/// Returns `value` where r > 0 or u > 0, so that r ≥ 0 does not block it; else 0.
#[inline]
#[expect(clippy::needless_bitwise_bool, reason = "no branch: which contacts are blocked is hard to predict")]
fn unblocked(at: &State<f64>, value: f64) -> f64 {
    if (at.r > 0.0) | (at.u > 0.0) { value } else { 0.0 }
}

impl Law for f64 {
    type OfContact = Signorini;

    /// r before the step.
    type Status = f64;

    const MINIMISES: bool = true;

    fn status(r: Self, _: f64, _: Self, _: Self) -> f64 {
        r
    }

    #[inline]
    fn step(at: &mut State<Self>, length: f64) -> Option<Self> {
        at.status = at.r;
        let moved = at.r + length * at.p;
        at.r = non_negative(moved);
        (moved < 0.0).then_some(-moved)
    }

    #[inline]
    fn w(at: &State<Self>) -> Self {
        unblocked(at, at.u)
    }

    #[inline]
    fn direction(at: &State<Self>, beta: f64) -> Self {
        unblocked(at, at.u + beta * at.p)
    }

    #[inline]
    fn left(at: &State<Self>) -> f64 {
        let left = if -at.u < at.r { -at.u } else { at.r };
        left * left
    }

    #[inline]
    fn squared_size(at: &State<Self>, constants: &Constants<Self>) -> f64 {
        let Constants { b, diagonal } = constants;
        let pressed = diagonal * at.r;
        unblocked(at, b * b + pressed * pressed)
    }

    fn reach(at: &State<Self>) -> f64 {
        if at.p < 0.0 { -at.r / at.p } else { f64::INFINITY }
    }

    fn withdraw(at: &mut State<Self>) {
        at.r = at.status;
    }
}
