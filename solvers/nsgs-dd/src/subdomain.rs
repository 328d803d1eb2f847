//! The sweep of one subdomain: that of NSGS on the subdomain's contacts, with its own masses.

use contact::{ContactProblem, law};
use nalgebra::Vector2;
use partition::Subdomain;

/// One contact as the sweep needs it, in local indices.
struct Row {
    candidate: u32,
    /// A wall is the last "grain", of infinite mass and at rest: its own motion is in `offset`.
    antagonist: u32,
    normal: Vector2<f64>,
    offset: f64,
    /// 1/`W_αα` with the subdomain's masses (kg).
    inverse_delassus: f64,
    /// 1/mass of candidate and antagonist (1/kg).
    inverse_mass: [f64; 2],
}

/// The contacts of a subdomain with their impulses.
pub(crate) struct Sweeper {
    rows: Vec<Row>,
    r: Vec<f64>,
}

impl Sweeper {
    /// Takes the impulses from `r0`, and the share `M_i/m_i` of each mass if `multiplicity` is given.
    pub(crate) fn new(
        problem: &ContactProblem,
        subdomain: &Subdomain,
        multiplicity: Option<&[u32]>,
        r0: &[f64],
    ) -> Self {
        let wall = subdomain.grains.len() as u32;
        let inverse_mass = |grain: u32| {
            let share = multiplicity.map_or(1.0, |m| f64::from(m[grain as usize]));
            share / problem.mass()[grain as usize]
        };
        let row = |k: usize| {
            let contact = &problem.contacts()[subdomain.contacts[k] as usize];
            let inverse_mass =
                [inverse_mass(contact.candidate), contact.antagonist.map_or(0.0, inverse_mass)];
            Row {
                candidate: subdomain.candidate[k],
                antagonist: subdomain.antagonist[k].unwrap_or(wall),
                normal: contact.normal,
                offset: contact.offset,
                inverse_delassus: 1.0 / (inverse_mass[0] + inverse_mass[1]),
                inverse_mass,
            }
        };
        Self {
            rows: (0..subdomain.contacts.len()).map(row).collect(),
            r: subdomain.contacts.iter().map(|contact| r0[*contact as usize]).collect(),
        }
    }

    /// The impulses, in the order of the subdomain's contacts (N·s).
    pub(crate) fn impulses(&self) -> &[f64] {
        &self.r
    }

    /// Contact by contact: v = Hᵗ V + c; r⁺ = max(0, r − v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
    pub(crate) fn sweep(&mut self, velocity: &mut [Vector2<f64>]) {
        for (row, r) in self.rows.iter().zip(&mut self.r) {
            let (i, j) = (row.candidate as usize, row.antagonist as usize);
            let v = row.normal.dot(&(velocity[i] - velocity[j])) + row.offset;
            let r_plus = law::update(*r, v, row.inverse_delassus, 1.0);
            let impulse = row.normal * (r_plus - *r);
            velocity[i] += impulse * row.inverse_mass[0];
            velocity[j] -= impulse * row.inverse_mass[1];
            *r = r_plus;
        }
    }
}
