//! A grain that seeks its contacts with bodies.

use crate::detect::{DetectedContact, Side};
use crate::scene::walls::WallMotion;
use contact::Place;

/// A grain that seeks its contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seeker<P> {
    pub(crate) grain: u32,
    /// Its centre (m).
    pub(crate) place: P,
    /// Its radius (m).
    pub(crate) radius: f64,
    /// Displacement since contacts were detected last, or since time began (m).
    pub(crate) came: P,
    /// Displacement by the free velocity until the next detection (m).
    pub(crate) ahead: P,
    /// The greatest gap of a contact (m).
    pub(crate) reach: f64,
}

/// A contact, and how the body moves there.
pub(crate) type Near<P> = (DetectedContact<P>, WallMotion<P>);

impl<P: Place> Seeker<P> {
    /// Its contact with a surface at a gap (m), unless that is beyond its reach.
    pub(super) fn meets(
        &self,
        antagonist: Side,
        (normal, gap): (P, f64),
        motion: impl FnOnce() -> WallMotion<P>,
    ) -> Option<Near<P>> {
        let contact = DetectedContact { candidate: self.grain, antagonist, normal, gap };
        (gap <= self.reach).then(|| (contact, motion()))
    }
}
