//! From the contacts of a subdomain to the matrix of its linear stage, in the order of its factor.

use crate::directions::Directions;
use cholesky::Coupling;
use contact::ContactProblem;
use nalgebra::Vector2;
use partition::{Decomposition, Subdomain};

/// One contact between two places of the factor's order.
pub(crate) struct PlacedContact {
    pub(crate) candidate: u32,
    /// A wall is the last "grain", at rest: its own motion is in `offset`.
    pub(crate) antagonist: u32,
    pub(crate) normal: Vector2<f64>,
    pub(crate) offset: f64,
    /// 1/W_αα with the undivided masses (kg).
    pub(crate) inverse_delassus: f64,
}

/// The part of a grain in the subdomain.
#[derive(Clone, Copy, Default)]
pub(crate) struct Share {
    /// M_i/m_i (kg).
    pub(crate) mass: f64,
    /// m_i: how many subdomains have a part of it.
    pub(crate) copies: f64,
    /// V_free (m/s).
    pub(crate) free_velocity: Vector2<f64>,
}

impl PlacedContact {
    /// (Hᵗ V)_α.
    #[inline]
    pub(crate) fn relative(&self, velocity: &[Vector2<f64>]) -> f64 {
        self.normal.dot(&(velocity[self.candidate as usize] - velocity[self.antagonist as usize]))
    }

    /// Adds h_α r.
    #[inline]
    pub(crate) fn add(&self, r: f64, resultant: &mut [Vector2<f64>]) {
        let impulse = self.normal * r;
        resultant[self.candidate as usize] += impulse;
        resultant[self.antagonist as usize] -= impulse;
    }

    /// h_α l⁻ h_αᵗ.
    pub(crate) fn coupling(&self, directions: Directions) -> Coupling {
        Coupling::dyad(directions.l_minus * self.inverse_delassus, self.normal, -self.normal)
    }
}

impl Share {
    /// Whether other subdomains have a part of the grain.
    pub(crate) fn on_boundary(&self) -> bool {
        self.copies > 1.0
    }

    /// What the grain has on the diagonal of M_E + d⁻_E (kg).
    pub(crate) fn on_diagonal(&self, directions: Directions) -> f64 {
        self.mass + if self.on_boundary() { directions.d_minus * self.mass } else { 0.0 }
    }
}

/// The contacts of a subdomain between their places.
pub(crate) fn placed(
    problem: &ContactProblem,
    subdomain: &Subdomain,
    position: &[u32],
) -> Vec<PlacedContact> {
    let place = |local: u32| position[local as usize];
    let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
    let contact = |(contact, (candidate, antagonist)): (&u32, &(u32, Option<u32>))| {
        let contact = problem.contacts()[*contact as usize];
        let w = inverse_mass(contact.candidate) + contact.antagonist.map_or(0.0, inverse_mass);
        PlacedContact {
            candidate: place(*candidate),
            antagonist: antagonist.map_or(position.len() as u32, place),
            normal: contact.normal,
            offset: contact.offset,
            inverse_delassus: 1.0 / w,
        }
    };
    subdomain.contacts.iter().zip(&subdomain.ends).map(contact).collect()
}

/// The subdomain's parts of its grains, in the order of the factor.
pub(crate) fn shares(
    problem: &ContactProblem,
    decomposition: &Decomposition,
    subdomain: &Subdomain,
    position: &[u32],
) -> Vec<Share> {
    let mut shares = vec![Share::default(); position.len()];
    for (place, grain) in position.iter().zip(&subdomain.grains) {
        let grain = *grain as usize;
        let copies = f64::from(decomposition.multiplicity[grain]);
        let (mass, free_velocity) = (problem.mass()[grain] / copies, problem.free_velocity()[grain]);
        shares[*place as usize] = Share { mass, copies, free_velocity };
    }
    shares
}
