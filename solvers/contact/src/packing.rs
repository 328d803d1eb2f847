//! A contact problem and where its grains are. Operators, law, measures and proofs need the problem alone; places serve to cut
//! it into subdomains and to order its contacts.

use crate::discs::Discs;
use crate::error::ProblemError;
use crate::mechanics::{Mechanics, Touch};
use crate::problem::ContactProblem;
use crate::vector::Vector;
use std::ops::Deref;

/// Input of a method: a contact problem, which this stands for wherever places do not matter, and its geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing<M: Mechanics = Discs> {
    problem: ContactProblem<M>,
    position: Vec<M::Place>,
}

impl<M: Mechanics> Packing<M> {
    /// Checks and takes the data of a problem, see [`ContactProblem::new`], and the `position` of each mass centre (m).
    ///
    /// # Errors
    /// Names the first item that has no meaning.
    pub fn new(
        mass: Vec<M::Mass>,
        position: Vec<M::Place>,
        free_velocity: Vec<M::Velocity>,
        contacts: Vec<M::Contact>,
    ) -> Result<Self, ProblemError> {
        // The list is wrong whose length differs from that of both others.
        if position.len() == free_velocity.len() {
            ProblemError::unless_length("grains.mass", &mass, position.len())?;
        }
        ProblemError::unless_length("grains.position", &position, mass.len())?;
        ProblemError::unless_each("grains.position", &position, "finite", |x| x.is_finite())?;
        let problem = ContactProblem::new(mass, free_velocity, contacts)?;
        Ok(Self { problem, position })
    }

    /// Mass centres (m).
    pub fn position(&self) -> &[M::Place] {
        &self.position
    }

    /// Midpoint of the two mass centres; the grain's centre for a contact with a wall (§3) (m).
    pub fn contact_position(&self, contact: &M::Contact) -> M::Place {
        let (candidate, antagonist) = contact.ends();
        let candidate = self.position[candidate as usize];
        antagonist.map_or(candidate, |j| (candidate + self.position[j as usize]) * 0.5)
    }
}

impl<M: Mechanics> Deref for Packing<M> {
    type Target = ContactProblem<M>;

    fn deref(&self) -> &ContactProblem<M> {
        &self.problem
    }
}
