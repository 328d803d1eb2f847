//! The contacts of a time step: which are near, which the law lets in, and their impulses of the time step before.

use super::March;
use crate::bodies::seeker::Seeker;
use crate::bodies::{Bodies, Visit};
use crate::detect::{DetectedContact, Side};
use crate::error::CaseError;
use crate::problem::marched::{Marched, parts, slides, translation};
use crate::problem::time_step::{Terms, TimeStep};
use crate::scene::walls::{MovingWall, WallMotion};
use crate::scene::{Law, Scene};
use contact::{Place, Touch, Vector};

impl<M: Marched> March<M> {
    /// The greatest gap of a contact of the next time step, as far as these grains tell (m).
    pub fn greatest_gap(&self) -> f64 {
        let (position, free_velocity) = self.free();
        self.reach(&position, &free_velocity)
    }

    /// The contact problem of the next time step, where others than these grains tell the greatest gap of a contact (m).
    ///
    /// # Errors
    /// Those of [`March::next`].
    pub fn next_up_to(&self, greatest_gap: f64) -> Result<TimeStep<M>, CaseError> {
        let (position, free_velocity) = self.free();
        self.next_within(greatest_gap, position, free_velocity)
    }

    /// Returns the time at which contacts are sought (s): gaps are advanced from one detection to the next, over [t + (1−θ)h, t + (2−θ)h].
    pub(super) fn detection(&self) -> f64 {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        (self.done as f64 + 1.0 - theta) * h
    }

    /// The greatest gap that two bodies could close within the time step (m).
    pub(super) fn reach(&self, position: &[M::Place], free_velocity: &[M::Velocity]) -> f64 {
        let walls = self.scene.walls_from(self.detection());
        let approach = greatest_approach::<M>(free_velocity, position, &walls);
        2.0 * self.scene.time_step_s * f64::max(approach, self.scene.fastest_segment())
    }

    /// The contacts with gaps of at most `reach` (m) that the law lets in, with their offsets c, and the pairs that they are.
    pub(super) fn contacts(
        &self,
        position: &[M::Place],
        free_velocity: &[M::Velocity],
        reach: f64,
    ) -> (Vec<M::Contact>, Vec<Entered<M::Place>>) {
        let Scene { time_step_s: h, law, restitution, contact_copies, .. } = self.scene;
        let (mut contacts, mut near) = (Vec::new(), Vec::new());
        let mut enter = |pair: &DetectedContact<M::Place>, motion: &WallMotion<M::Place>| {
            // The guides of a lid and of driven segments are smooth.
            let is_guided = pair.candidate as usize >= self.grain_count();
            let friction = if is_guided { 0.0 } else { self.friction(pair) };
            let mut parts = parts::<M>(pair, &self.radius, motion, friction);
            let contact = M::contact(&parts);
            let enters = match law {
                Law::PredictedGap | Law::Newton => {
                    let b = contact.relative(free_velocity).first() + contact.offset().first();
                    motion.ahead.unwrap_or(pair.gap) + h * b <= 0.0
                }
                Law::Iqs => true,
            };
            if enters {
                let rebound =
                    restitution.map(|e| e * (contact.relative(&self.velocity) + contact.offset()).first());
                let own = Terms::of(&self.scene, (pair.gap, motion.ahead), rebound);
                parts.offset[0] += own.gap + own.rebound;
                for _ in 0..contact_copies {
                    contacts.push(M::contact(&parts));
                    near.push((*pair, own));
                }
            }
        };
        let ahead = |grain: u32| translation::<M>(free_velocity[grain as usize]) * h;
        self.for_each_near((self.detection(), self.since_detection()), (position, &ahead), reach, &mut enter);
        (contacts, near)
    }

    /// Calls `visit` with every pair whose gap is at most `reach` (m) where the bodies are at a `time` (s), some time `since` contacts
    /// were sought last; its grains' free motion leads them `ahead` by so much (m).
    pub(super) fn for_each_near(
        &self,
        (time, since): (f64, f64),
        (position, ahead): (&[M::Place], &dyn Fn(u32) -> M::Place),
        reach: f64,
        visit: &mut Visit<M::Place>,
    ) {
        let (grains, period) = (self.grain_count(), self.scene.period());
        let came = |k: u32| translation::<M>(self.velocity[k as usize]) * since;
        let scene = (&self.scene, &self.joints);
        let bodies = Bodies::at(scene, (time, since), (position, &self.radius), &came);
        let mut neighbours = self.neighbours.borrow_mut();
        let pairs = neighbours.contacts(&position[..grains], &self.radius[..grains], reach, period);
        let seeker = |grain: u32| Seeker {
            grain,
            place: position[grain as usize],
            radius: self.radius[grain as usize],
            came: came(grain),
            ahead: ahead(grain),
            reach,
        };
        bodies.each_contact(&mut (0..grains as u32).map(seeker), &pairs, visit);
    }

    /// μ of a pair, by whether it slid in the time step before (–).
    fn friction(&self, pair: &DetectedContact<M::Place>) -> f64 {
        let slid = || self.sliding.binary_search(&(pair.candidate, pair.antagonist)).is_ok();
        let ratio = self.scene.static_friction_ratio.filter(|_| !slid());
        self.scene.friction_of(pair, &self.radius) * ratio.unwrap_or(1.0)
    }

    /// Returns the contacts of a time step that slide with its impulses `r` (N·s), in order; none where static friction is not another.
    pub(super) fn sliding(&self, time_step: &TimeStep<M>, r: &[f64]) -> Vec<(u32, Side)> {
        if self.scene.static_friction_ratio.is_none() {
            return Vec::new();
        }
        let contacts = time_step.frozen.problem.contacts();
        let slide = |(k, _): &(usize, _)| slides::<M>(&contacts[*k], M::Impulse::at(r, *k), ON_THE_CONE);
        let mut sliding: Vec<_> = time_step.keys().enumerate().filter(slide).map(|(_, key)| key).collect();
        sliding.sort_unstable();
        sliding
    }

    /// The time since contacts were sought last, or since time began (s).
    pub(super) fn since_detection(&self) -> f64 {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        if self.done == 0 { (1.0 - theta) * h } else { h }
    }
}

/// Distance of a tangential impulse from its bound that is round-off, over that (–).
const ON_THE_CONE: f64 = 1e-12;

/// A pair that the law lets in, and what that adds to its offset.
pub(super) type Entered<P> = (DetectedContact<P>, Terms);

/// The greatest free speed of a grain, and of a wall where it faces one (m/s). Twice this times h is as far as two
/// surfaces come together in a time step without impulses.
fn greatest_approach<M: Marched>(
    free_velocity: &[M::Velocity],
    position: &[M::Place],
    walls: &[Option<MovingWall<M::Place>>; 5],
) -> f64 {
    let grains = free_velocity.iter().map(|v| translation::<M>(*v).length());
    let facing = walls.iter().flatten().flat_map(|wall| position.iter().map(|x| wall.opening_rate(*x).abs()));
    grains.chain(facing).fold(0.0, f64::max)
}
