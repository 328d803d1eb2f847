//! The contacts of a time step: which are near, which the law lets in, and their impulses of the time step before.

use super::{March, TimeStep};
use crate::bodies::bodies_near;
use crate::detect::{DetectedContact, Side, walls_near};
use crate::driven;
use crate::error::CaseError;
use crate::marched::Marched;
use crate::scene::{Law, Scene};
use crate::walls::{MovingWall, WallMotion};
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

    /// When contacts are sought (s), and the walls then.
    fn walls_at_detection(&self) -> (f64, [Option<MovingWall<M::Place>>; 5]) {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        // Gaps are advanced from one detection to the next, over [t + (1−θ)h, t + (2−θ)h].
        let detection = (self.done as f64 + 1.0 - theta) * h;
        (detection, self.scene.walls.as_ref().map_or([None; 5], |walls| walls.over(detection, h)))
    }

    /// The greatest gap that two bodies could close within the time step (m).
    pub(super) fn reach(&self, position: &[M::Place], free_velocity: &[M::Velocity]) -> f64 {
        let (_, walls) = self.walls_at_detection();
        let approach = greatest_approach::<M>(free_velocity, position, &walls);
        2.0 * self.scene.time_step_s * f64::max(approach, self.scene.fastest_segment())
    }

    /// The contacts with gaps of at most `reach` (m) that the law lets in, with their offsets c, and the pairs that they are.
    pub(super) fn contacts(
        &self,
        position: &[M::Place],
        free_velocity: &[M::Velocity],
        reach: f64,
    ) -> (Vec<M::Contact>, Vec<DetectedContact<M::Place>>) {
        let Scene { time_step_s: h, law, restitution, contact_copies, .. } = self.scene;
        let (detection, walls) = self.walls_at_detection();
        let (grains, period) = (self.grain_count(), self.scene.period());
        let mut neighbours = self.neighbours.borrow_mut();
        let pairs = neighbours.contacts(&position[..grains], &self.radius[..grains], reach, period);
        let (lid, driven) = (self.lid(position), self.scene.driven_at(position));
        let (mut contacts, mut near) = (Vec::with_capacity(pairs.len()), Vec::with_capacity(pairs.len()));
        let of_walls = self.scene.walls.as_ref().and_then(|walls| walls.friction);
        let rough = [self.scene.friction, of_walls.or(self.scene.friction)].map(|mu| mu.unwrap_or(0.0));
        let mut enter = |pair: &DetectedContact<M::Place>, motion: &WallMotion<M::Place>| {
            let of_segment = match pair.antagonist {
                Side::Segment(number) | Side::Driven(_, number) => {
                    self.scene.segments[number as usize].friction
                }
                _ => None,
            };
            // The guides of a lid and of driven segments are smooth.
            let is_guided = pair.candidate as usize >= grains;
            let friction = if is_guided { [0.0; 2] } else { of_segment.map_or(rough, |mu| [rough[0], mu]) };
            let mut contact = M::contact(pair, &self.radius, motion, friction);
            let enters = match law {
                Law::PredictedGap | Law::Newton => {
                    let b = contact.relative(free_velocity).first() + contact.offset().first();
                    pair.gap + h * b <= 0.0
                }
                Law::Iqs => true,
            };
            if enters {
                let own = match restitution {
                    None => law.gap_offset(pair.gap, h),
                    Some(e) => e * (contact.relative(&self.velocity) + contact.offset()).first(),
                };
                M::widen(&mut contact, own);
                for _ in 0..contact_copies {
                    contacts.push(contact);
                    near.push(*pair);
                }
            }
        };
        let mut ahead = &pairs[..];
        for (grain, (x, radius)) in (0_u32..).zip(position.iter().zip(&self.radius)).take(grains) {
            walls_near(&walls, grain, *x, *radius, reach).for_each(|(pair, motion)| enter(&pair, &motion));
            let bodies = bodies_near(&self.scene, (walls[0], detection), grain, (*x, *radius), reach);
            bodies.for_each(|(pair, motion)| enter(&pair, &motion));
            while let Some((pair, rest)) = ahead.split_first().filter(|(pair, _)| pair.candidate == grain) {
                enter(pair, &WallMotion::NONE);
                ahead = rest;
            }
            let below = lid.into_iter().flat_map(|lid| lid.near(grain, (*x, *radius), reach));
            below.for_each(|pair| enter(&pair, &WallMotion::NONE));
            let beside = driven.iter().filter_map(|segment| segment.near(grain, (*x, *radius), reach));
            beside.for_each(|pair| enter(&pair, &WallMotion::NONE));
        }
        let guides = lid.zip(self.scene.lid()).map(|(placed, lid)| placed.guides(lid.speed_m_per_s));
        guides.iter().flatten().for_each(|(pair, motion)| enter(pair, motion));
        driven.iter().flat_map(driven::Placed::guides).for_each(|pair| enter(&pair, &WallMotion::NONE));
        (contacts, near)
    }
}

impl Law {
    /// The gap term of c (m/s).
    pub(crate) fn gap_offset(self, gap: f64, h: f64) -> f64 {
        match self {
            Self::PredictedGap | Self::Newton => 0.0,
            Self::Iqs => gap.max(0.0) / h,
        }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PredictedGap => "predicted-gap",
            Self::Iqs => "iqs",
            Self::Newton => "newton",
        }
    }
}

/// The greatest free speed of a grain, and of a wall where it faces one (m/s). Twice this times h is as far as two
/// surfaces come together in a time step without impulses.
fn greatest_approach<M: Marched>(
    free_velocity: &[M::Velocity],
    position: &[M::Place],
    walls: &[Option<MovingWall<M::Place>>; 5],
) -> f64 {
    let grains = free_velocity.iter().map(|v| M::translation(*v).length());
    let facing = walls.iter().flatten().flat_map(|wall| position.iter().map(|x| wall.opening_rate(*x).abs()));
    grains.chain(facing).fold(0.0, f64::max)
}
