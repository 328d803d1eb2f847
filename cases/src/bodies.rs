//! The bodies of a scene where contacts are sought: its walls, its drum, bumps, segments, and what a force drives.

pub(crate) mod bumps;
pub(crate) mod drawn;
pub(crate) mod driven;
pub(crate) mod joints;
pub(crate) mod seeker;

use crate::bodies::bumps::Bumps;
use crate::bodies::driven::{DrivenSegment, PlacedLid};
use crate::bodies::joints::{Joints, Line};
use crate::bodies::seeker::{Near, Seeker};
use crate::detect::{DetectedContact, Side, WALLS};
use crate::scene::Scene;
use crate::scene::drum::Drum;
use crate::scene::walls::{MovingWall, WallMotion};
use contact::Place;

/// Bodies of a scene.
pub(crate) struct Bodies<'s, P> {
    walls: [Option<MovingWall<P>>; 5],
    drum: Option<Drum>,
    bumps: Option<Bumps<P>>,
    line: Line<'s, P>,
    lid: Option<PlacedLid<'s, P>>,
    driven: Vec<DrivenSegment<'s, P>>,
}

/// Visitor of contacts, each with the motion of its body.
pub(crate) type Visit<'v, P> = dyn FnMut(&DetectedContact<P>, &WallMotion<P>) + 'v;

impl<'s, P: Place> Bodies<'s, P> {
    /// The bodies of a scene at a `time` (s), some time `since` contacts were sought last; those that a force drives are the last at
    /// these positions (m), and `came` gives their displacements since then (m).
    pub(crate) fn at(
        (scene, joints): (&'s Scene, &'s Joints),
        (time, since): (f64, f64),
        (position, radius): (&[P], &[f64]),
        came: &dyn Fn(u32) -> P,
    ) -> Self {
        let walls = scene.walls_from(time);
        Self {
            walls,
            drum: scene.drum,
            bumps: walls[0].and_then(|floor| Bumps::of_floor(scene, floor)),
            line: Line::at((scene, joints), walls, (time, since)),
            lid: PlacedLid::of(scene, position, radius),
            driven: DrivenSegment::all(scene, position, came),
        }
    }

    /// The contacts of a grain with bodies that move as given, in the order of a problem.
    fn fixed(&self, seeker: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        let walls = WALLS.into_iter().zip(self.walls).filter_map(move |(side, wall)| {
            let wall = wall?;
            let (gap, normal) = (wall.now.gap(seeker.place, seeker.radius), wall.now.normal);
            seeker.meets(side, (normal, gap), || wall.motion(seeker.place))
        });
        walls
            .chain(self.drum.and_then(|drum| in_drum(&drum, seeker)))
            .chain(self.bumps.into_iter().flat_map(move |bumps| bumps.near(seeker)))
            .chain(self.line.near(seeker))
    }

    /// Calls `visit` with every contact, by rising candidate: those of the seekers with bodies at rest or moved, their `pairs`, those with
    /// bodies that a force drives; then those of such bodies with their guides.
    pub(crate) fn each_contact(
        &self,
        seekers: &mut dyn Iterator<Item = Seeker<P>>,
        pairs: &[DetectedContact<P>],
        visit: &mut Visit<P>,
    ) {
        let mut rest = pairs;
        for seeker in seekers {
            self.fixed(&seeker).for_each(|(pair, motion)| visit(&pair, &motion));
            while let Some((pair, others)) =
                rest.split_first().filter(|(pair, _)| pair.candidate == seeker.grain)
            {
                visit(pair, &WallMotion::NONE);
                rest = others;
            }
            self.driven(&seeker).for_each(|(pair, motion)| visit(&pair, &motion));
        }
        self.guides().for_each(|(pair, motion)| visit(&pair, &motion));
    }

    /// The contacts of a grain with bodies that a force drives.
    fn driven(&self, seeker: &Seeker<P>) -> impl Iterator<Item = Near<P>> {
        let lid = self.lid.iter().flat_map(move |lid| lid.near(seeker));
        lid.chain(self.driven.iter().filter_map(move |segment| segment.near(seeker)))
    }

    /// The contacts of these bodies with their guides.
    fn guides(&self) -> impl Iterator<Item = Near<P>> {
        let of_lid = self.lid.iter().flat_map(PlacedLid::guides);
        of_lid.chain(self.driven.iter().flat_map(DrivenSegment::guides))
    }
}

/// The contact of a grain with the drum, which curves towards a grain that slides along it: a gap of none that only opens or stays as
/// the normal says would become an overlap of (h v)²/2(R − r). So the contact knows the gap where the free motion along the wall leads.
fn in_drum<P: Place>(drum: &Drum, seeker: &Seeker<P>) -> Option<Near<P>> {
    let (across, gap) = (Drum::across(seeker.place), drum.gap(seeker.place, seeker.radius));
    let distance = across.length();
    // At the centre there is no normal, and in a drum of some size no contact.
    let normal = if distance > 0.0 { -across / distance } else { P::of([0.0, 1.0, 0.0]) };
    // The surface at −R n moves at Ω R (n_y, −n_x).
    let tangent = P::of([normal[1], -normal[0], 0.0]);
    let sliding = tangent * (drum.spin_rad_per_s * drum.radius_m);
    let (room, along) = (drum.radius_m - seeker.radius, tangent.dot_product(seeker.ahead));
    // √(room² − along²) − distance.
    let there = (room * room - along * along).max(0.0).sqrt() - distance;
    seeker.meets(Side::Drum, (normal, gap), || WallMotion { opening: 0.0, sliding, ahead: Some(there) })
}
