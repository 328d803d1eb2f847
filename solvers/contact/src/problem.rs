//! The contact problem of one time step as data, and what makes it valid.

use crate::adjacency::Adjacency;
use crate::discs::Discs;
use crate::error::{ProblemError, SetupError, shown};
use crate::mechanics::{Ends, Gauge, Mass, Mechanics, Touch};
use crate::vector::{Place, Vector};

/// The contact problem of one time step: v − W r = b (1), and the contact law (2).
///
/// Every value was validated by [`ContactProblem::new`], so a method need not check any.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactProblem<M: Mechanics = Discs> {
    mass: Vec<M::Mass>,
    free_velocity: Vec<M::Velocity>,
    contacts: Vec<M::Contact>,
}

impl<M: Mechanics> ContactProblem<M> {
    /// Checks and takes the data of a problem: `mass` (kg) and `free_velocity` V⁻ + M⁻¹Rᵈ (m/s) have one value per grain.
    ///
    /// # Errors
    /// Names the first item that has no meaning.
    pub fn new(
        mass: Vec<M::Mass>,
        free_velocity: Vec<M::Velocity>,
        contacts: Vec<M::Contact>,
    ) -> Result<Self, ProblemError> {
        let grains = mass.len();
        ProblemError::unless_length("grains.free_velocity", &free_velocity, grains)?;
        for (index, mass) in mass.iter().enumerate() {
            ProblemError::of_fault(mass.fault(), index)?;
        }
        ProblemError::unless_each("grains.free_velocity", &free_velocity, "finite", |v| v.is_finite())?;
        for (index, contact) in contacts.iter().enumerate() {
            check_contact::<M>(contact, index, grains)?;
        }
        Ok(Self { mass, free_velocity, contacts })
    }

    /// Number of grains.
    pub fn grain_count(&self) -> usize {
        self.mass.len()
    }

    /// Number of contacts.
    pub fn contact_count(&self) -> usize {
        self.contacts.len()
    }

    /// Length of a flat list of impulses or relative velocities.
    pub fn impulse_count(&self) -> usize {
        M::Impulse::LEN * self.contacts.len()
    }

    /// M: the mass of each grain (kg), and its moment of inertia (kg m²), if it spins.
    pub fn mass(&self) -> &[M::Mass] {
        &self.mass
    }

    /// `V_free` = V⁻ + M⁻¹Rᵈ, the velocity without contact impulses (m/s).
    pub fn free_velocity(&self) -> &[M::Velocity] {
        &self.free_velocity
    }

    /// The contacts, in the order in which impulses are given and taken everywhere.
    pub fn contacts(&self) -> &[M::Contact] {
        &self.contacts
    }

    /// Returns the contacts around each grain.
    pub fn adjacency(&self) -> Adjacency {
        Adjacency::new(self.contacts.iter().map(Touch::ends), self.grain_count())
    }

    /// Returns the kernel of the measures of some contacts, each by its index and its ends among the `grains`, which are given by their
    /// indices.
    pub fn gauge(
        &self,
        contacts: impl Iterator<Item = (usize, Ends)> + Clone,
        grains: impl ExactSizeIterator<Item = usize>,
    ) -> M::Gauge {
        M::Gauge::new(&self.mass, &self.free_velocity, &self.contacts, contacts, grains)
    }

    /// Accepts a warm start `r0` with one admissible impulse per contact (N·s).
    ///
    /// # Errors
    /// Names the first impulse that is not.
    pub fn unless_admissible(&self, r0: &[f64]) -> Result<(), SetupError> {
        let (found, expected) = (r0.len() / M::Impulse::LEN, self.contact_count());
        let all = format!("of one impulse per contact, {expected} in all");
        SetupError::unless(r0.len() == self.impulse_count(), "start", format!("{found} impulses"), all)?;
        for (index, contact) in self.contacts.iter().enumerate() {
            let r = M::Impulse::at(r0, index);
            if !contact.is_admissible(r) {
                let value = format!("{} at contact {index}", r.text());
                return Err(SetupError::new("start", value, M::Contact::ADMISSIBLE));
            }
        }
        Ok(())
    }
}

fn check_contact<M: Mechanics>(
    contact: &M::Contact,
    index: usize,
    grains: usize,
) -> Result<(), ProblemError> {
    let ((candidate, antagonist), normal) = (contact.ends(), contact.normal());
    let grain_range = || format!("the index of one of {grains} grains");
    // Normals come from files of other codes too: 1e-9 lets a normal of any careful code pass and stops a wrong one.
    let length = normal.length();
    let (key, value, expected) = if candidate as usize >= grains {
        ("contacts.candidate", candidate.to_string(), grain_range())
    } else if let Some(j) = antagonist.filter(|j| *j as usize >= grains) {
        ("contacts.antagonist", j.to_string(), grain_range())
    } else if antagonist == Some(candidate) {
        ("contacts.antagonist", candidate.to_string(), "another grain than the candidate".to_owned())
    } else if !((length - 1.0).abs() <= 1e-9) {
        let value = format!("{} of length {}", normal.text(), shown(length));
        ("contacts.normal", value, "of length 1 (to 1e-9)".to_owned())
    } else if !contact.offset().is_finite() {
        ("contacts.offset", contact.offset().text(), "finite".to_owned())
    } else {
        return ProblemError::of_fault(contact.fault(), index);
    };
    Err(ProblemError::Value { key, index, value, expected })
}
