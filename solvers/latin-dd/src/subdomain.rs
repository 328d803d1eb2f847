//! One subdomain: its linear stage (1) (4) (5), and the local stage (2) (6) of its contacts.

use crate::directions::Directions;
use crate::factor::Factor;
use contact::{ContactProblem, SetupError, law};
use faer::sparse::Triplet;
use nalgebra::Vector2;
use partition::Subdomain;

/// One contact, in local indices.
struct Row {
    candidate: u32,
    /// A wall is the last "grain", at rest: its own motion is in `offset`.
    antagonist: u32,
    normal: Vector2<f64>,
    offset: f64,
    /// l⁻ and l⁺ (kg).
    l_minus: f64,
    l_plus: f64,
}

/// A subdomain between two local stages.
pub(crate) struct Latin {
    rows: Vec<Row>,
    factor: Factor,
    /// `M_E V_free` − `H_E` l⁻ c, what does not change in the right-hand side (N·s).
    constant: Vec<f64>,
    /// t = r̂ + l⁻ v̂ of each contact (N·s).
    t: Vec<f64>,
    /// r̂ of each contact (N·s).
    r_hat: Vec<f64>,
    /// τ = F̂ + d⁻ V̂ of each grain, 0 where it is no boundary grain (N·s).
    tau: Vec<Vector2<f64>>,
    /// V_E of the linear stage, x and y in turn, a wall's zeros last (m/s).
    velocity: Vec<f64>,
}

impl Latin {
    /// Factorises M_E + H_E l⁻ H_Eᵗ + d⁻_E, and begins from the impulses `r0` and the velocities `start` that follow from
    /// them.
    pub(crate) fn new(
        problem: &ContactProblem,
        subdomain: &Subdomain,
        multiplicity: &[u32],
        directions: &Directions,
        r0: &[f64],
        start: &[Vector2<f64>],
    ) -> Result<Self, SetupError> {
        let grains = subdomain.grains.len();
        let rows: Vec<Row> = (0..subdomain.contacts.len())
            .map(|k| {
                let contact = problem.contacts()[subdomain.contacts[k] as usize];
                let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
                let w = inverse_mass(contact.candidate) + contact.antagonist.map_or(0.0, inverse_mass);
                Row {
                    candidate: subdomain.candidate[k],
                    antagonist: subdomain.antagonist[k].unwrap_or(grains as u32),
                    normal: contact.normal,
                    offset: contact.offset,
                    l_minus: directions.l_minus / w,
                    l_plus: directions.l_plus / w,
                }
            })
            .collect();
        let share = |grain: &u32| {
            let multiplicity = multiplicity[*grain as usize];
            (problem.mass()[*grain as usize] / f64::from(multiplicity), multiplicity > 1)
        };
        let mass: Vec<(f64, bool)> = subdomain.grains.iter().map(share).collect();
        let factor = Factor::new(2 * grains, &matrix(&rows, &mass, directions.d_minus))?;

        let r_hat: Vec<f64> = subdomain.contacts.iter().map(|contact| r0[*contact as usize]).collect();
        let mut constant = vec![0.0; 2 * (grains + 1)];
        for (local, (grain, (mass, _))) in subdomain.grains.iter().zip(&mass).enumerate() {
            let momentum = *mass * problem.free_velocity()[*grain as usize];
            constant[2 * local..2 * local + 2].copy_from_slice(momentum.as_slice());
        }
        // F̂ = (M_i/m_i) (V̂ − V_free) − H_E r̂ lets every copy move as its grain does; τ = F̂ + d⁻ V̂.
        let mut tau: Vec<Vector2<f64>> = subdomain
            .grains
            .iter()
            .zip(&mass)
            .map(|(grain, (mass, _))| {
                let (v, v_free) = (start[*grain as usize], problem.free_velocity()[*grain as usize]);
                *mass * (v - v_free) + directions.d_minus * *mass * v
            })
            .collect();
        let mut t = Vec::with_capacity(rows.len());
        for ((row, r), contact) in rows.iter().zip(&r_hat).zip(&subdomain.contacts) {
            row.add(-row.l_minus * row.offset, &mut constant);
            for (grain, sign) in [(row.candidate as usize, 1.0), (row.antagonist as usize, -1.0)] {
                if grain < grains {
                    tau[grain] -= sign * *r * row.normal;
                }
            }
            // v̂ = max(0, v) where r̂ = 0, else 0: what satisfies (2) beside r̂.
            let v = problem.contacts()[*contact as usize].relative(start) + row.offset;
            let v_hat = if *r > 0.0 { 0.0 } else { law::non_negative(v) };
            t.push(r + row.l_minus * v_hat);
        }
        for (tau, (_, boundary)) in tau.iter_mut().zip(&mass) {
            if !boundary {
                *tau = Vector2::zeros();
            }
        }
        constant.truncate(2 * grains);
        Ok(Self { rows, factor, constant, t, r_hat, tau, velocity: vec![0.0; 2 * (grains + 1)] })
    }

    /// (M_E + H_E l⁻ H_Eᵗ + d⁻_E) V_E = M_E V_free + H_E (t − l⁻ c) + τ     (1) (4) (5)
    pub(crate) fn linear_stage(&mut self) {
        let dimension = self.constant.len();
        for ((v, constant), tau) in
            self.velocity.chunks_exact_mut(2).zip(self.constant.chunks_exact(2)).zip(&self.tau)
        {
            v[0] = constant[0] + tau.x;
            v[1] = constant[1] + tau.y;
        }
        for (row, t) in self.rows.iter().zip(&self.t) {
            row.add(*t, &mut self.velocity);
        }
        self.factor.solve(&mut self.velocity[..dimension]);
        // Walls do not move, whatever was added to them.
        self.velocity[dimension..].fill(0.0);
    }

    /// With v = H_Eᵗ V_E + c and r = t − l⁻ v of the linear stage, contact by contact:
    /// s = r − l⁺ v :  r̂ = max(s, 0),  v̂ = max(−s, 0)/l⁺     (2) (6);   t ← t + μ (r̂ + l⁻ v̂ − t)
    pub(crate) fn local_stage(&mut self, relaxation: f64) {
        for ((row, t), r_hat) in self.rows.iter().zip(&mut self.t).zip(&mut self.r_hat) {
            let v = row.relative(&self.velocity) + row.offset;
            let s = *t - (row.l_minus + row.l_plus) * v;
            *r_hat = law::non_negative(s);
            let v_hat = law::non_negative(-s) / row.l_plus;
            *t += relaxation * (*r_hat + row.l_minus * v_hat - *t);
        }
    }

    /// V_E and τ of a grain.
    pub(crate) fn boundary(&mut self, local: u32) -> (Vector2<f64>, &mut Vector2<f64>) {
        let local = local as usize;
        let velocity = Vector2::new(self.velocity[2 * local], self.velocity[2 * local + 1]);
        (velocity, &mut self.tau[local])
    }

    /// r̂, in the order of the subdomain's contacts (N·s).
    pub(crate) fn impulses(&self) -> &[f64] {
        &self.r_hat
    }

    /// Entries of the factor.
    pub(crate) fn factor_entries(&self) -> usize {
        self.factor.entries()
    }
}

impl Row {
    /// (Hᵗ V)_α.
    #[inline]
    fn relative(&self, velocity: &[f64]) -> f64 {
        let (i, j) = (2 * self.candidate as usize, 2 * self.antagonist as usize);
        self.normal.x * (velocity[i] - velocity[j]) + self.normal.y * (velocity[i + 1] - velocity[j + 1])
    }

    /// Adds h_α r.
    #[inline]
    fn add(&self, r: f64, resultant: &mut [f64]) {
        let (i, j) = (2 * self.candidate as usize, 2 * self.antagonist as usize);
        let (x, y) = (self.normal.x * r, self.normal.y * r);
        resultant[i] += x;
        resultant[i + 1] += y;
        resultant[j] -= x;
        resultant[j + 1] -= y;
    }
}

/// Lower triangle of M_E + H_E l⁻ H_Eᵗ + d⁻_E, two rows per grain. `mass` is M_i/m_i, and whether i is a boundary grain.
fn matrix(rows: &[Row], mass: &[(f64, bool)], kappa_d_minus: f64) -> Vec<Triplet<usize, usize, f64>> {
    let mut lower = Vec::with_capacity(2 * mass.len() + 10 * rows.len());
    for (local, (mass, boundary)) in mass.iter().enumerate() {
        let diagonal = if *boundary { *mass + kappa_d_minus * *mass } else { *mass };
        lower.extend([2 * local, 2 * local + 1].map(|k| Triplet::new(k, k, diagonal)));
    }
    for row in rows {
        let (n, grains) = (row.normal, mass.len());
        let block = [[n.x * n.x, n.x * n.y], [n.y * n.x, n.y * n.y]];
        let ends = [(row.candidate as usize, 1.0), (row.antagonist as usize, -1.0)];
        for (i, sign_i) in ends {
            for (j, sign_j) in ends {
                for (x, block) in block.iter().enumerate() {
                    for (y, entry) in block.iter().enumerate() {
                        let (from, to) = (2 * i + x, 2 * j + y);
                        if i < grains && j < grains && from >= to {
                            lower.push(Triplet::new(from, to, sign_i * sign_j * row.l_minus * entry));
                        }
                    }
                }
            }
        }
    }
    lower
}
