//! Facts about a problem, whatever its mechanics.

use crate::form::Form;
use contact::Vector;

/// Kind and size of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Name of the mechanics in files; `local` of W alone.
    pub mechanics: &'static str,
    /// True where contacts have friction.
    pub has_friction: bool,
    /// Components of a place; of W alone unknowns of a contact.
    pub dimensions: usize,
    /// Number of grains.
    pub grains: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Numbers of a grain among velocities.
    pub of_grain: usize,
    /// Numbers of a contact among impulses.
    pub of_contact: usize,
}

impl Facts {
    /// Returns the mechanics, as a reader would say it.
    pub fn in_words(&self) -> String {
        let grains = if self.dimensions > 2 { "spheres" } else { "discs" };
        format!("{grains} {} friction", if self.has_friction { "with" } else { "without" })
    }

    /// Returns the size, in words.
    pub fn size(&self) -> String {
        let Self { grains, contacts, dimensions, .. } = self;
        if *grains == 0 && self.of_grain == 0 {
            let plural = if *dimensions == 1 { "" } else { "s" };
            return format!("{contacts} contacts of {dimensions} unknown{plural}, W alone");
        }
        let between = if *dimensions > 2 { " between spheres" } else { "" };
        let friction = if self.has_friction { " with friction" } else { "" };
        format!("{grains} grains, {contacts} contacts{between}{friction}")
    }
}

/// A contact between grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// The candidate grain.
    pub candidate: u32,
    /// The antagonist; `None` for a wall.
    pub antagonist: Option<u32>,
    /// From the antagonist to the candidate (–).
    pub normal: [f64; 3],
    /// Gap at detection (m).
    pub gap: f64,
    /// μ (–); 0 without friction.
    pub friction: f64,
}

/// The kind and size of a problem of a mechanics.
pub(crate) fn facts<M: Form>(grains: usize, contacts: usize) -> Facts {
    Facts {
        mechanics: M::NAME,
        has_friction: M::HAS_FRICTION,
        dimensions: M::Place::LEN,
        grains,
        contacts,
        of_grain: M::Velocity::LEN,
        of_contact: M::Impulse::LEN,
    }
}
