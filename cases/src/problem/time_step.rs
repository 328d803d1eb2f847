//! The contact problem of a time step: its antagonists, and the terms that the law adds.

use crate::detect::Side;
use crate::problem::frozen::Frozen;
use crate::scene::{Law, Scene};
use contact::{Discs, Mechanics, Touch, Vector};

/// The contact problem of a time step that is not solved yet.
#[derive(Clone, Debug)]
pub struct TimeStep<M: Mechanics = Discs> {
    /// The problem, with the impulses of the time step before as its start.
    pub frozen: Frozen<M>,
    /// The antagonist of each contact.
    pub sides: Vec<Side>,
    /// Terms that the law added to the offset of each.
    pub(crate) terms: Vec<Terms>,
}

impl<M: Mechanics> TimeStep<M> {
    /// Terms that the law added to the offset of each contact.
    pub(crate) fn terms(&self) -> &[Terms] {
        &self.terms
    }

    /// Returns the contacts that push one of the first `grains`, each with its antagonist, gap (m) and impulse, of all `r` (N·s).
    pub(crate) fn pushing<'t>(
        &'t self,
        grains: usize,
        r: &'t [f64],
    ) -> impl Iterator<Item = (&'t M::Contact, Side, f64, M::Impulse)> {
        let Frozen { problem, gap, .. } = &self.frozen;
        let all = problem.contacts().iter().zip(&self.sides).zip(gap).enumerate();
        all.map(|(k, ((contact, side), gap))| (contact, *side, *gap, M::Impulse::at(r, k)))
            .filter(move |(contact, .., r)| (contact.ends().0 as usize) < grains && r.first() > 0.0)
    }

    /// The candidate and the antagonist of each contact, by which it is known again.
    pub(crate) fn keys(&self) -> impl Iterator<Item = (u32, Side)> {
        self.frozen.problem.contacts().iter().zip(&self.sides).map(|(at, side)| (at.ends().0, *side))
    }
}

/// Terms that a law adds to the offset of a contact (m/s).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    /// Term for its gap, c_g.
    pub(crate) gap: f64,
    /// Term for its rebound, e v⁻.
    pub(crate) rebound: f64,
}

impl Terms {
    /// Returns the terms of a contact with a gap, which at a curved wall is another `ahead` (m), in a scene, with its `rebound` if the law
    /// has one (m/s). At a curved wall the gap ahead enters as it is: what the wall turns towards the grain, and what is left of an
    /// overlap. Elsewhere contacts recover from an overlap at the rate of the scene.
    pub(crate) fn of(scene: &Scene, (gap, ahead): (f64, Option<f64>), rebound: Option<f64>) -> Self {
        let h = scene.time_step_s;
        let gap = match (scene.law, ahead) {
            (Law::Iqs, None) => gap.max(0.0) / h + gap.min(0.0) * scene.recovery_per_s.unwrap_or(0.0),
            (Law::Iqs, Some(ahead)) => ahead / h,
            (Law::PredictedGap | Law::Newton, ahead) => ahead.map_or(0.0, |ahead| ahead.min(0.0) / h),
        };
        // Both are lower bounds of v⁺, with the sign turned: the greater counts.
        match rebound {
            Some(rebound) if gap >= rebound.min(0.0) => Self { gap: 0.0, rebound },
            _ => Self { gap, rebound: 0.0 },
        }
    }
}
