//! The contact problem of one time step as data, and what makes it valid.

use crate::error::{ProblemError, is_positive, shown};
use nalgebra::Vector2;

/// One contact α. v_α = n · (V_candidate − V_antagonist) + c_α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist grain; `None` for a wall, whose motion is in `offset`.
    pub antagonist: Option<u32>,
    /// Unit normal n, from antagonist to candidate (–).
    pub normal: Vector2<f64>,
    /// c_α: what the scene imposes: a wall's motion and the law's gap term (m/s).
    pub offset: f64,
}

/// The contact problem of one time step: v − W r = b (1), 0 ≤ v ⊥ r ≥ 0 (2).
///
/// Every value was validated by [`ContactProblem::new`], so a method need not check any.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactProblem {
    mass: Vec<f64>,
    free_velocity: Vec<Vector2<f64>>,
    contacts: Vec<Contact>,
}

impl ContactProblem {
    /// Checks and takes the data of a problem: `mass` (kg) and `free_velocity` V⁻ + M⁻¹Rᵈ (m/s) have one value per grain.
    ///
    /// # Errors
    /// Names the first item that has no meaning.
    pub fn new(
        mass: Vec<f64>,
        free_velocity: Vec<Vector2<f64>>,
        contacts: Vec<Contact>,
    ) -> Result<Self, ProblemError> {
        let grains = mass.len();
        ProblemError::unless_length("grains.free_velocity", &free_velocity, grains)?;
        ProblemError::unless_each("grains.mass", &mass, "positive and finite", |m| is_positive(*m))?;
        // A problem needs 1/m: that of 1e-320 kg is infinite.
        let expected = "at least 5.6e-309, or its inverse overflows";
        ProblemError::unless_each("grains.mass", &mass, expected, |m| m.recip().is_finite())?;
        ProblemError::unless_each("grains.free_velocity", &free_velocity, "finite", finite)?;
        for (index, contact) in contacts.iter().enumerate() {
            check_contact(contact, index, grains)?;
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

    /// M: one mass per grain (kg).
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// `V_free` = V⁻ + M⁻¹Rᵈ, the velocity without contact impulses (m/s).
    pub fn free_velocity(&self) -> &[Vector2<f64>] {
        &self.free_velocity
    }

    /// The contacts, in the order in which impulses are given and taken everywhere.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}

pub(crate) fn finite(v: &Vector2<f64>) -> bool {
    v.x.is_finite() && v.y.is_finite()
}

fn check_contact(contact: &Contact, index: usize, grains: usize) -> Result<(), ProblemError> {
    let Contact { candidate, antagonist, normal, offset } = *contact;
    let grain_range = || format!("the index of one of {grains} grains");
    // Normals come from files of other codes too: 1e-9 lets a normal of any careful code pass and stops a wrong one.
    let length = normal.norm();
    let (key, value, expected) = if candidate as usize >= grains {
        ("contacts.candidate", candidate.to_string(), grain_range())
    } else if let Some(j) = antagonist.filter(|j| *j as usize >= grains) {
        ("contacts.antagonist", j.to_string(), grain_range())
    } else if antagonist == Some(candidate) {
        ("contacts.antagonist", candidate.to_string(), "another grain than the candidate".to_owned())
    } else if !((length - 1.0).abs() <= 1e-9) {
        let value = format!("[{}, {}] of length {}", shown(normal.x), shown(normal.y), shown(length));
        ("contacts.normal", value, "of length 1 (to 1e-9)".to_owned())
    } else if !offset.is_finite() {
        ("contacts.offset", offset.to_string(), "finite".to_owned())
    } else {
        return Ok(());
    };
    Err(ProblemError::Value { key, index, value, expected })
}
