//! Proximal points: ε draws the impulses to those of the point before, and Newton's method, its steps shortened where they make things
//! worse, leads from one to the next.
//!
//! Where more sticks than motion allows, impulses drift along the kernel of W at a constant speed until something opens or slides; a
//! proximal point goes 1/ε times as far at once. So ε falls while points are reached, and grows where one is not; where that does not
//! help, sweeps look for another beginning. In the plane a point is reached along an exact path; in space the law is not piecewise
//! linear, and sweeps after a step of Newton take back the statuses that it set too far from where it began.

use super::layout::{admissible, norm};
use super::newton::{Drawn, Newton};
use nalgebra::Vector3;

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

/// A shorter step over the one before (–), and how many are tried.
const SHORTER: f64 = 0.2;
const SHORTENED: u32 = 3;

/// The share of a step that must come off what is left, times the length of the step (–).
const WORTH_IT: f64 = 0.1;

/// Sweeps after a step of Newton: they take a tenth of the time of its factor.
const SMOOTHING: u32 = 20;

/// Points in a row that were not reached, after which nothing leads on; after how many sweeps begin anew, and their number for each.
const IN_VAIN: u32 = 30;
const ANEW: u32 = 3;
const SWEEPS: u32 = 100;

/// Steps of Newton after which what is left must be half of what it was, or they lead nowhere.
const PATIENCE: u32 = 600;

/// The points.
pub(crate) struct Proximal {
    epsilon: f64,
    /// √J.
    centre: Vec<Vector3<f64>>,
    /// √J.
    pub(super) s: Vec<Vector3<f64>>,
    /// Steps of Newton from the centre.
    steps: u32,
    in_vain: u32,
    /// Residual when it was last halved (√J), and the steps since.
    halved: f64,
    since: u32,
}

impl Proximal {
    /// From impulses s that leave so much (√J).
    pub(super) fn new(s: Vec<Vector3<f64>>, left: f64) -> Self {
        Self { epsilon: FIRST, centre: s.clone(), s, steps: 0, in_vain: 0, halved: left, since: 0 }
    }

    /// One step of Newton towards a point; returns what it leaves of the law (√J).
    pub(super) fn advance(&mut self, newton: &mut Newton) -> f64 {
        let drawn = Drawn { epsilon: self.epsilon, centre: Some(&self.centre) };
        let before = newton.left(drawn, &self.s);
        let next = shortened(newton, drawn, &self.s, before);
        self.steps += 1;
        self.since += 1;
        let is_stuck = next.is_none();
        let (next, drawn_left) = next.unwrap_or_else(|| (self.s.clone(), before));
        self.s = next;
        let left = newton.left(Drawn { centre: None, ..drawn }, &self.s);
        if left <= 0.5 * self.halved {
            (self.halved, self.since) = (left, 0);
        }
        let way: Vec<_> = self.s.iter().zip(&self.centre).map(|(s, c)| s - c).collect();
        if drawn_left <= REACHED * self.epsilon * norm(&way)
            || newton.layout.is_round_off(drawn_left, &self.s)
        {
            self.reach(newton, &way);
        } else if is_stuck || self.steps >= STEPS {
            self.turn_back(newton);
        }
        left
    }

    /// The point is reached by this way: the next begins where a drift leads, if that leaves less than where it is.
    fn reach(&mut self, newton: &mut Newton, way: &[Vector3<f64>]) {
        let before = self.epsilon;
        if self.steps <= FEW {
            self.epsilon = (self.epsilon / FALLS).max(LEAST);
        }
        (self.steps, self.in_vain) = (0, 0);
        self.centre.copy_from_slice(&self.s);
        let ahead = |((s, way), column): ((&Vector3<f64>, &Vector3<f64>), &contact::SphereColumn)| {
            admissible(s + way * (before / self.epsilon), column.friction())
        };
        let mut there: Vec<_> = self.s.iter().zip(way).zip(&newton.layout.columns).map(ahead).collect();
        let drawn = Drawn { epsilon: self.epsilon, centre: Some(&self.centre) };
        newton.sweep(drawn, &mut there, SMOOTHING);
        if newton.left(drawn, &there) < newton.left(drawn, &self.s) {
            self.s = there;
        }
    }

    /// The point was not reached: a nearer one is sought from the one before, at times after sweeps.
    fn turn_back(&mut self, newton: &mut Newton) {
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

    /// Reports whether nothing leads on.
    pub(super) fn is_in_vain(&self) -> bool {
        self.in_vain >= IN_VAIN || self.since > PATIENCE
    }
}

/// A step of Newton from s, which leaves `before` (√J), with what it leaves: shortened until it leaves less. Where no part of it does,
/// none.
pub(super) fn shortened(
    newton: &mut Newton,
    drawn: Drawn,
    s: &[Vector3<f64>],
    before: f64,
) -> Option<(Vec<Vector3<f64>>, f64)> {
    let whole = newton.step(drawn, s)?;
    let mut share = 1.0;
    for _ in 0..=SHORTENED {
        let mut next: Vec<_> = s.iter().zip(&whole).map(|(s, whole)| s + share * (whole - s)).collect();
        if drawn.centre.is_some() {
            newton.sweep(drawn, &mut next, SMOOTHING);
        }
        let left = newton.left(drawn, &next);
        if left < before * (1.0 - WORTH_IT * share) {
            return Some((next, left));
        }
        share *= SHORTER;
    }
    None
}
