//! A sample under a partition: its discs, its contacts, its walls.

use std::collections::BTreeSet;

use results::schema::{ContactRow, GrainRow};

use crate::read::run::defined;
use crate::read::{Scenes, find_or_push};

/// The discs and contacts of one figure.
#[derive(Default)]
pub(crate) struct Scene {
    pub(crate) grains: Vec<GrainRow>,
    pub(crate) contacts: Vec<ContactRow>,
}

/// The samples by problem and partition.
pub(crate) fn scenes(grains: &[GrainRow], contacts: &[ContactRow]) -> Scenes {
    let mut scenes = Scenes::new();
    for grain in grains {
        let name = (grain.problem.clone(), grain.partition.clone());
        scenes.entry(name).or_default().grains.push(grain.clone());
    }
    for contact in contacts {
        let name = (contact.problem.clone(), contact.partition.clone());
        scenes.entry(name).or_default().contacts.push(contact.clone());
    }
    scenes
}

impl Scene {
    /// The subdomains that hold contacts, in order.
    pub(crate) fn subdomains(&self) -> BTreeSet<u32> {
        self.contacts.iter().map(|contact| contact.subdomain).collect()
    }
}

/// The impulse of the reference solution, where one is known (N·s).
pub(crate) fn impulse(contact: &ContactRow) -> Option<f64> {
    defined(contact.impulse_n_s)
}

/// From the candidate's centre to the antagonist's, or to the wall (m).
pub(crate) fn ends(contact: &ContactRow) -> Wall {
    ((contact.x0_m, contact.y0_m), (contact.x1_m, contact.y1_m))
}

/// A straight piece of a wall (m).
pub(crate) type Wall = ((f64, f64), (f64, f64));

/// One piece per wall, from the first to the last place at which a grain touches it, and half a grain beyond. What no
/// grain touches is unknown to the tables.
pub(crate) fn walls(contacts: &[ContactRow]) -> Vec<Wall> {
    let mut sides: Vec<Side> = Vec::new();
    for contact in contacts.iter().filter(|contact| contact.wall) {
        let ((x0, y0), (x1, y1)) = ends(contact);
        let reach = (x0 - x1).hypot(y0 - y1);
        if !(reach > 0.0) {
            continue;
        }
        let normal = ((x0 - x1) / reach, (y0 - y1) / reach);
        let at = normal.0 * x1 + normal.1 * y1;
        let along = normal.0 * y1 - normal.1 * x1;
        let new = || Side { normal, at, low: f64::INFINITY, high: f64::NEG_INFINITY };
        let side = find_or_push(&mut sides, |side| side.holds(normal, at, reach), new);
        side.low = side.low.min(along - reach / 2.0);
        side.high = side.high.max(along + reach / 2.0);
    }
    sides.iter().map(|side| (side.place(side.low), side.place(side.high))).collect()
}

/// A line with a unit normal: its distance from the origin, and the part of it that is touched (m).
struct Side {
    normal: (f64, f64),
    at: f64,
    low: f64,
    high: f64,
}

impl Side {
    /// Reports whether a touched place is on the line; `reach` is the distance of the grain's centre (m).
    fn holds(&self, normal: (f64, f64), at: f64, reach: f64) -> bool {
        const PARALLEL: f64 = 1e-6;
        let turn = (self.normal.0 - normal.0).hypot(self.normal.1 - normal.1);
        turn < PARALLEL && (self.at - at).abs() < 0.05 * reach
    }

    fn place(&self, along: f64) -> (f64, f64) {
        let (x, y) = self.normal;
        (self.at * x - along * y, self.at * y + along * x)
    }
}

#[cfg(test)]
mod tests;
