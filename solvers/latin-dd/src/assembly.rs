//! From the contacts of a subdomain to the matrix of its linear stage, in the order of its factor.

use crate::directions::Directions;
use cholesky::Triplet;
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
}

impl Share {
    /// Whether other subdomains have a part of the grain.
    pub(crate) fn on_boundary(&self) -> bool {
        self.copies > 1.0
    }
}

pub(crate) fn placed(
    problem: &ContactProblem,
    subdomain: &Subdomain,
    position: &[u32],
) -> Vec<PlacedContact> {
    let place = |local: u32| position[local as usize];
    (0..subdomain.contacts.len())
        .map(|k| {
            let contact = problem.contacts()[subdomain.contacts[k] as usize];
            let (candidate, antagonist) = subdomain.ends[k];
            let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
            let w = inverse_mass(contact.candidate) + contact.antagonist.map_or(0.0, inverse_mass);
            PlacedContact {
                candidate: place(candidate),
                antagonist: antagonist.map_or(position.len() as u32, place),
                normal: contact.normal,
                offset: contact.offset,
                inverse_delassus: 1.0 / w,
            }
        })
        .collect()
}

/// The subdomain's parts of its grains, in the order of the factor.
pub(crate) fn shares(
    problem: &ContactProblem,
    decomposition: &Decomposition,
    subdomain: &Subdomain,
    position: &[u32],
) -> Vec<Share> {
    let mut shares: Vec<(u32, Share)> = position
        .iter()
        .zip(&subdomain.grains)
        .map(|(place, grain)| {
            let grain = *grain as usize;
            let copies = f64::from(decomposition.multiplicity[grain]);
            let mass = problem.mass()[grain] / copies;
            let free_velocity = problem.free_velocity()[grain];
            (*place, Share { mass, copies, free_velocity })
        })
        .collect();
    shares.sort_by_key(|(place, _)| *place);
    shares.into_iter().map(|(_, share)| share).collect()
}

/// Upper triangle of M_E + H_E l⁻ H_Eᵗ + d⁻_E, two rows per grain.
pub(crate) fn matrix(
    contacts: &[PlacedContact],
    shares: &[Share],
    directions: &Directions,
) -> Vec<Triplet<usize, usize, f64>> {
    let mut upper = Vec::with_capacity(3 * shares.len() + 10 * contacts.len());
    for (place, share) in shares.iter().enumerate() {
        let d_minus = if share.on_boundary() { directions.d_minus * share.mass } else { 0.0 };
        let (x, y) = (2 * place, 2 * place + 1);
        let mass = share.mass + d_minus;
        upper.extend([Triplet::new(x, x, mass), Triplet::new(x, y, 0.0), Triplet::new(y, y, mass)]);
    }
    for contact in contacts {
        let block =
            directions.l_minus * contact.inverse_delassus * contact.normal * contact.normal.transpose();
        let ends = [(contact.candidate as usize, 1.0), (contact.antagonist as usize, -1.0)];
        for (i, sign_i) in ends {
            for (j, sign_j) in ends {
                for (x, y) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (from, to) = (2 * i + x, 2 * j + y);
                    if j < shares.len() && from <= to {
                        upper.push(Triplet::new(from, to, sign_i * sign_j * block[(x, y)]));
                    }
                }
            }
        }
    }
    upper
}
