//! Overlaps refused when time begins: grains that lie in each other, in a wall or in a segment, and segments that would be in a grain, or
//! past it, before contacts are sought for the first time.

use super::March;
use crate::detect::{DetectedContact, OVERLAP, Side};
use crate::problem::marched::Marched;
use crate::sample::Sample;
use crate::scene::walls::WallMotion;
use contact::{Vector, shown};

impl<M: Marched> March<M> {
    /// Refuses an overlap that no contact can mend, unless the sample asks for it.
    pub(super) fn check_begin(&self, sample: &Sample) -> Result<(), String> {
        let of_segment =
            |pair: &DetectedContact<_>| matches!(pair.antagonist, Side::Segment(_) | Side::Driven(..));
        let own = matches!(sample, Sample::Triangular { overlap, .. } if *overlap > 0.0);
        let found = self.too_deep((0.0, 0.0), (&self.position, 0.0), &|pair| !own || of_segment(pair));
        if let Some((text, key)) = found {
            return Err(format!("{key}: {text} when time begins: move one of them"));
        }
        let (position, free_velocity) = self.free();
        let times = (self.detection(), self.since_detection());
        let reach = self.reach(&position, &free_velocity);
        match self.too_deep(times, (&position, reach), &of_segment) {
            Some((text, key)) => Err(format!(
                "{key}: {text} at {} s, when contacts are sought for the first time: shorten `scene.time_step_s`, or let it begin farther away",
                shown(times.0)
            )),
            None => Ok(()),
        }
    }

    /// The first pair that overlaps by more than what another code may leave, in words, and the key of its antagonist.
    fn too_deep(
        &self,
        times: (f64, f64),
        (position, reach): (&[M::Place], f64),
        judged: &dyn Fn(&DetectedContact<M::Place>) -> bool,
    ) -> Option<(String, String)> {
        let mut found = None;
        let mut visit = |pair: &DetectedContact<M::Place>, _: &WallMotion<M::Place>| {
            let radius = |grain: u32| self.radius[grain as usize];
            let own = radius(pair.candidate);
            let smaller = if let Side::Grain(other) = pair.antagonist { own.min(radius(other)) } else { own };
            if found.is_none() && pair.gap < -OVERLAP * smaller && judged(pair) {
                let (grain, place) = (pair.candidate, position[pair.candidate as usize].text());
                let other = match pair.antagonist {
                    Side::Grain(other) => format!("grain {other} at {} m", position[other as usize].text()),
                    _ => "it".to_owned(),
                };
                let text = format!(
                    "grain {grain}, of radius {} m at {place} m, overlaps {other} by {} m, more than {OVERLAP} of the smaller radius,",
                    shown(own),
                    shown(-pair.gap)
                );
                found = Some((text, key(pair.antagonist)));
            }
        };
        self.for_each_near(times, (position, &|_| M::Place::ZERO), reach, &mut visit);
        found
    }
}

/// The key of what grains touch.
fn key(side: Side) -> String {
    match side {
        Side::Grain(_) => "`sample`".to_owned(),
        Side::Floor | Side::Left | Side::Right | Side::Back | Side::Front | Side::Guide(_) => {
            "`scene.box`".to_owned()
        }
        Side::Bump(_) => "`scene.box.bump_radius_m`".to_owned(),
        Side::Lid(..) => "`scene.box.lid`".to_owned(),
        Side::Drum => "`scene.drum`".to_owned(),
        Side::Segment(number) | Side::Driven(_, number) => format!("`scene.segments[{number}]`"),
    }
}
