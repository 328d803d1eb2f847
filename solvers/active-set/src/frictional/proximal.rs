//! Proximal points: ε draws the impulses to those of the point before, and Newton's method, its steps shortened where they make things
//! worse, leads from one to the next.
//!
//! Where more sticks than motion allows, impulses drift along the kernel of W at a constant speed until something opens or slides; a
//! proximal point goes 1/ε times as far at once. So ε falls while points are reached, and grows where one is not; where that does not
//! help, sweeps look for another beginning. In the plane a point is reached along an exact path; in space the law is not piecewise
//! linear, and sweeps after a step of Newton take back the statuses that it set too far from where it began.

use super::newton::{Newton, SMOOTHING};
use super::{Approach, Points};
use crate::Best;
use crate::layout::{Drawn, distance};
use nalgebra::Vector3;

/// Newton's method between spheres.
type InSpace = Newton<3, 6>;

/// ε of the first point, the least and the greatest (–).
const FIRST: f64 = 1e-3;
const LEAST: f64 = 1e-9;
const GREATEST: f64 = 0.1;

/// By how much ε falls after a point that took few steps of Newton, and how many are few; by how much it grows where none was reached.
/// Of some pairs tried on packings of 60 and 250 spheres, with friction of 0.1 to 0.8, these come furthest with as many factors.
const FALLS: f64 = 2.0;
const FEW: u32 = 6;
const GROWS: f64 = 3.0;

/// Steps of Newton for one point, at most.
const STEPS: u32 = 25;

/// Largest residual of a point over ε times the way to it (–).
const REACHED: f64 = 0.1;

/// Points in a row that were not reached, after which nothing leads on; after how many sweeps begin anew, and their number for each.
const IN_VAIN: u32 = 30;
const ANEW: u32 = 3;
const SWEEPS: u32 = 100;

/// Steps of Newton after which what is left must be half of what it was, or they lead nowhere.
const PATIENCE: u32 = 600;

/// The points.
pub(super) struct Proximal {
    epsilon: f64,
    /// √J.
    centre: Vec<Vector3<f64>>,
    /// √J.
    s: Vec<Vector3<f64>>,
    /// Steps of Newton from the centre.
    steps: u32,
    in_vain: u32,
    /// Residual when it was last halved (√J), and the steps since.
    halved: f64,
    since: u32,
}

impl Proximal {
    /// One step of Newton towards a point; returns what it leaves of the law (√J).
    fn step(&mut self, newton: &mut InSpace) -> f64 {
        let drawn = Drawn { epsilon: self.epsilon, centre: Some(&self.centre) };
        let before = newton.left(drawn, &self.s);
        let next = newton.shortened(drawn, &self.s, before);
        self.steps += 1;
        self.since += 1;
        let is_stuck = next.is_none();
        let (next, drawn_left) = next.unwrap_or_else(|| (self.s.clone(), before));
        self.s = next;
        let left = newton.left(Drawn { centre: None, ..drawn }, &self.s);
        if left <= 0.5 * self.halved {
            (self.halved, self.since) = (left, 0);
        }
        if drawn_left <= REACHED * self.epsilon * distance(&self.s, &self.centre)
            || newton.layout.is_round_off(drawn_left, &self.s)
        {
            self.reach(newton);
        } else if is_stuck || self.steps >= STEPS {
            self.turn_back(newton);
        }
        left
    }

    /// The point is reached: the next begins where a drift leads, if that leaves less than where it is.
    fn reach(&mut self, newton: &mut InSpace) {
        let before = self.epsilon;
        if self.steps <= FEW {
            self.epsilon = (self.epsilon / FALLS).max(LEAST);
        }
        (self.steps, self.in_vain) = (0, 0);
        let times = before / self.epsilon;
        let ahead: Vec<_> = self.s.iter().zip(&self.centre).map(|(s, c)| s + (s - c) * times).collect();
        let mut there = newton.layout.admitted(&ahead);
        self.centre.copy_from_slice(&self.s);
        let drawn = Drawn { epsilon: self.epsilon, centre: Some(&self.centre) };
        newton.sweep(drawn, &mut there, SMOOTHING);
        if newton.left(drawn, &there) < newton.left(drawn, &self.s) {
            self.s = there;
        }
    }

    /// The point was not reached: a nearer one is sought from the one before, at times after sweeps.
    fn turn_back(&mut self, newton: &mut InSpace) {
        self.steps = 0;
        self.in_vain += 1;
        self.s.copy_from_slice(&self.centre);
        if self.in_vain.is_multiple_of(ANEW) {
            newton.sweep(Drawn { epsilon: 0.0, centre: None }, &mut self.s, SWEEPS * self.in_vain);
            self.centre.copy_from_slice(&self.s);
        } else {
            self.epsilon = (self.epsilon * GROWS).min(GREATEST);
        }
    }
}

impl Points<3, 6> for Proximal {
    fn new(newton: &InSpace, best: &Best) -> Option<Self> {
        let s = newton.layout.scaled(&best.impulses);
        Some(Self { epsilon: FIRST, centre: s.clone(), s, steps: 0, in_vain: 0, halved: best.left, since: 0 })
    }

    fn advance(&mut self, newton: &mut InSpace, best: &mut Best, round_off: f64) -> Approach {
        let left = self.step(newton);
        best.take(left, |r| newton.layout.impulses(&self.s, r));
        if best.left <= round_off || newton.layout.is_round_off(left, &self.s) {
            Approach::Nearly
        } else if self.in_vain >= IN_VAIN || self.since > PATIENCE {
            Approach::InVain
        } else {
            Approach::On
        }
    }
}
