//! One subdomain: its linear stage (1) (4) (5), and the local stage (2) (6) of its contacts.

use crate::assembly::{PlacedContact, Share, placed, shares};
use crate::directions::Directions;
use cholesky::{Factor, Order, Singular, Structure};
use contact::{Packing, SetupError, law};
use nalgebra::{Matrix2, Vector2};
use partition::{Decomposition, Sums};
use std::sync::Arc;

/// A subdomain between two local stages. Grains are in the order of the factor.
pub(crate) struct Latin {
    contacts: Vec<PlacedContact>,
    shares: Vec<Share>,
    directions: Directions,
    structure: Arc<Structure>,
    pub(crate) factor: Factor,
    /// `M_E V_free` − `H_E` l⁻ c, what does not change in the right-hand side (N·s).
    constant: Vec<Vector2<f64>>,
    /// t = r̂ + l⁻ v̂ of each contact (N·s).
    t: Vec<f64>,
    /// r̂ of each contact, in the order of the subdomain's (N·s).
    pub(crate) r_hat: Vec<f64>,
    /// τ = F̂ + d⁻ V̂ of each grain, 0 where it is no boundary grain (N·s).
    tau: Vec<Vector2<f64>>,
    /// `constant` + `H_E` t, and what was added to the walls, last (N·s).
    right_hand_side: Vec<Vector2<f64>>,
    /// V_E of the linear stage, and the rest of the walls, last (m/s).
    velocity: Vec<Vector2<f64>>,
    /// Places of its copies of boundary grains.
    pub(crate) boundary: Vec<u32>,
    /// Greatest |V_E − V̄| of these after the linear stage (m/s).
    pub(crate) velocity_jump: f64,
}

/// r and v of a contact, or F and V of a boundary grain along one axis, after the linear stage, each with the sizes of the
/// terms that it is the sum of, added up; all in √J.
#[derive(Clone, Copy)]
pub(crate) struct Iterate {
    pub(crate) r: f64,
    pub(crate) v: f64,
    pub(crate) terms_of_r: f64,
    pub(crate) terms_of_v: f64,
}

impl Latin {
    /// Factorises M_E + H_E l⁻ H_Eᵗ + d⁻_E of the subdomain `e`, and begins from the impulses `r0` and the velocities
    /// `start` that follow from them.
    pub(crate) fn new(
        problem: &Packing,
        decomposition: &Decomposition,
        e: usize,
        directions: &Directions,
        r0: &[f64],
        start: &[Vector2<f64>],
    ) -> Result<Self, SetupError> {
        let too_large = |why: Singular| {
            let value = format!("so large that a subdomain's matrix cannot be factorised ({why})");
            SetupError::new("kappa_l_minus", value, "smaller")
        };
        let subdomain = &decomposition.subdomains[e];
        let position: Vec<_> =
            subdomain.grains.iter().map(|grain| problem.position()[*grain as usize]).collect();
        let order = Order::fill_reducing(&position, &subdomain.ends).map_err(too_large)?;
        let structure = Arc::new(Structure::new(&subdomain.ends, &order));
        let contacts = placed(problem, subdomain, structure.position());
        let shares = shares(problem, decomposition, subdomain, structure.position());
        let factor = factorise(&structure, &shares, &contacts, *directions).map_err(too_large)?;
        let grains = shares.len();
        let mut latin = Self {
            directions: *directions,
            factor,
            constant: Vec::new(),
            t: vec![0.0; contacts.len()],
            r_hat: subdomain.contacts.iter().map(|contact| r0[*contact as usize]).collect(),
            tau: vec![Vector2::zeros(); grains],
            right_hand_side: vec![Vector2::zeros(); grains + 1],
            velocity: vec![Vector2::zeros(); grains + 1],
            boundary: subdomain.boundary.iter().map(|local| structure.position()[*local as usize]).collect(),
            velocity_jump: 0.0,
            structure,
            contacts,
            shares,
        };
        for (place, grain) in latin.structure.position().iter().zip(&subdomain.grains) {
            latin.velocity[*place as usize] = start[*grain as usize];
        }
        latin.begin();
        Ok(latin)
    }

    /// t and τ from r̂ and the velocities: what satisfies (2) and (3) beside them.
    fn begin(&mut self) {
        let Directions { l_minus, d_minus, .. } = self.directions;
        // F̂ = (M_i/m_i) (V̂ − V_free) − H_E r̂ lets every copy move as its grain does.
        let grains = self.shares.iter().zip(&self.velocity);
        let mut f_hat: Vec<Vector2<f64>> =
            grains.map(|(share, v)| share.mass * (v - share.free_velocity)).collect();
        f_hat.push(Vector2::zeros());
        for ((contact, r), t) in self.contacts.iter().zip(&self.r_hat).zip(&mut self.t) {
            contact.add(-*r, &mut f_hat);
            let v = contact.relative(&self.velocity) + contact.offset;
            let v_hat = if *r > 0.0 { 0.0 } else { law::non_negative(v) };
            *t = r + l_minus * contact.inverse_delassus * v_hat;
        }
        for (((tau, share), f_hat), v) in
            self.tau.iter_mut().zip(&self.shares).zip(&f_hat).zip(&self.velocity)
        {
            if share.on_boundary() {
                *tau = f_hat + d_minus * share.mass * v;
            }
        }
        self.assemble();
    }

    /// What does not change in the right-hand side, and the rest of it but τ.
    fn assemble(&mut self) {
        self.constant = self.shares.iter().map(|share| share.mass * share.free_velocity).collect();
        self.constant.push(Vector2::zeros());
        for contact in &self.contacts {
            let l_minus = self.directions.l_minus * contact.inverse_delassus;
            contact.add(-l_minus * contact.offset, &mut self.constant);
        }
        self.right_hand_side.copy_from_slice(&self.constant);
        for (contact, t) in self.contacts.iter().zip(&self.t) {
            contact.add(*t, &mut self.right_hand_side);
        }
    }

    /// The factor for other directions.
    pub(crate) fn factorise(&self, directions: &Directions) -> Result<Factor, Singular> {
        factorise(&self.structure, &self.shares, &self.contacts, *directions)
    }

    /// Takes other directions with their factor; r̂, v̂ and F̂ stay, and V̂ is near V_E.
    pub(crate) fn turn(&mut self, directions: &Directions, factor: Factor) {
        self.factor = factor;
        for (t, r_hat) in self.t.iter_mut().zip(&self.r_hat) {
            *t = r_hat + directions.l_minus / self.directions.l_minus * (*t - r_hat);
        }
        let change = directions.d_minus - self.directions.d_minus;
        for ((tau, share), v) in self.tau.iter_mut().zip(&self.shares).zip(&self.velocity) {
            if share.on_boundary() {
                *tau += change * share.mass * v;
            }
        }
        self.directions = *directions;
        self.assemble();
    }

    /// (M_E + H_E l⁻ H_Eᵗ + d⁻_E) V_E = M_E V_free + H_E (t − l⁻ c) + τ     (1) (4) (5)
    pub(crate) fn linear_stage(&mut self) {
        let sums = self.velocity.iter_mut().zip(&self.right_hand_side).zip(&self.tau);
        for ((v, right_hand_side), tau) in sums {
            *v = right_hand_side + tau;
        }
        self.factor.solve(&mut self.velocity);
    }

    /// With v = H_Eᵗ V_E + c and r = t − l⁻ v of the linear stage, contact by contact:
    /// s = r − l⁺ v :  r̂ = max(s, 0),  v̂ = max(−s, 0)/l⁺     (2) (6);   t ← t + μ (r̂ + l⁻ v̂ − t)
    pub(crate) fn local_stage(&mut self, relaxation: f64) {
        let Directions { l_minus, l_plus, .. } = self.directions;
        self.right_hand_side.copy_from_slice(&self.constant);
        for ((contact, t), r_hat) in self.contacts.iter().zip(&mut self.t).zip(&mut self.r_hat) {
            let v = contact.relative(&self.velocity) + contact.offset;
            let s = *t - (l_minus + l_plus) * contact.inverse_delassus * v;
            *r_hat = law::non_negative(s);
            *t += relaxation * (*r_hat + l_minus / l_plus * law::non_negative(-s) - *t);
            contact.add(*t, &mut self.right_hand_side);
        }
    }

    /// What its copies of boundary grains add to the sums over all copies: (d⁺ + d⁻) V_E − τ = d⁺ V_E − F_E (N·s) and V_E/m_i
    /// (m/s).
    pub(crate) fn send(&self, sent: &mut [Matrix2<f64>]) {
        for (k, sent) in sent.iter_mut().enumerate() {
            let (v, tau, Share { mass, copies, .. }) = self.copy(k);
            let (d_minus, d_plus) = (self.directions.d_minus * mass, self.directions.d_plus * mass);
            *sent = Matrix2::from_columns(&[(d_plus + d_minus) * v - tau, v / *copies]);
        }
    }

    /// Local stage of the boundary grains, with F_E = τ − d⁻ V_E:
    /// V̂ = Σ_E (d⁺ V_E − F_E) / Σ_E d⁺,   F̂_E = F_E + d⁺ (V̂ − V_E);   τ ← τ + μ (F̂_E + d⁻ V̂ − τ)     (3) (7)
    pub(crate) fn interface(&mut self, relaxation: f64, sums: Sums<'_, Matrix2<f64>>) {
        self.velocity_jump = 0.0;
        for (k, sum) in sums.enumerate() {
            let (v, tau, Share { mass, copies, .. }) = self.copy(k);
            let (d_minus, d_plus) = (self.directions.d_minus * mass, self.directions.d_plus * mass);
            let v_hat = sum.column(0) / (d_plus * copies);
            let f_hat = tau - d_minus * v + d_plus * (v_hat - v);
            self.velocity_jump = self.velocity_jump.max((v - sum.column(1)).norm());
            self.tau[self.boundary[k] as usize] += relaxation * (f_hat + d_minus * v_hat - tau);
        }
    }

    /// V_E (m/s), τ (N·s) and the share of copy k of a boundary grain.
    pub(crate) fn copy(&self, k: usize) -> (Vector2<f64>, Vector2<f64>, &Share) {
        let place = self.boundary[k] as usize;
        (self.velocity[place], self.tau[place], &self.shares[place])
    }

    /// r and v of each contact, and F and V of each boundary grain, after the linear stage.
    pub(crate) fn linear_iterate(&self) -> impl Iterator<Item = Iterate> {
        let Directions { l_minus, d_minus, .. } = self.directions;
        let of = |mass: f64, kappa: f64, t: f64, v: f64, terms: f64| Iterate {
            r: (t - kappa * mass * v) / mass.sqrt(),
            v: v * mass.sqrt(),
            terms_of_r: (t.abs() + kappa * mass * terms) / mass.sqrt(),
            terms_of_v: terms * mass.sqrt(),
        };
        let contacts = self.contacts.iter().zip(&self.t).map(move |(contact, t)| {
            let v = contact.relative(&self.velocity) + contact.offset;
            let size = |grain: u32| self.velocity[grain as usize].norm();
            let terms = size(contact.candidate) + size(contact.antagonist) + contact.offset.abs();
            of(contact.inverse_delassus, l_minus, *t, v, terms)
        });
        let grains = self.shares.iter().zip(&self.tau).zip(&self.velocity);
        let boundary =
            grains.filter(|((share, _), _)| share.on_boundary()).flat_map(move |((share, tau), v)| {
                [(tau.x, v.x), (tau.y, v.y)].map(|(tau, v)| of(share.mass, d_minus, tau, v, v.abs()))
            });
        contacts.chain(boundary)
    }

    /// K_E⁻¹ d⁻ B_E for the two translations of `grains` (place, d⁻), with a factor of K_E.
    pub(crate) fn influence(&self, factor: &Factor, grains: &[(usize, f64)]) -> Vec<Matrix2<f64>> {
        let [along_x, along_y] = [Vector2::x(), Vector2::y()].map(|direction| {
            let mut x = vec![Vector2::zeros(); self.shares.len()];
            for (place, d_minus) in grains {
                x[*place] = *d_minus * direction;
            }
            factor.solve(&mut x);
            x
        });
        along_x.iter().zip(&along_y).map(|(x, y)| Matrix2::from_columns(&[*x, *y])).collect()
    }

    /// Σ F_E over `grains` (place, d⁻), with F_E = τ − d⁻ V_E (N·s).
    pub(crate) fn resultant(&self, grains: &[(usize, f64)]) -> Vector2<f64> {
        grains.iter().map(|(place, d_minus)| self.tau[*place] - *d_minus * self.velocity[*place]).sum()
    }

    /// Adds d⁻ w to τ of `grains`, and what that does to V_E.
    pub(crate) fn translate(&mut self, grains: &[(usize, f64)], influence: &[Matrix2<f64>], w: Vector2<f64>) {
        for (place, d_minus) in grains {
            self.tau[*place] += *d_minus * w;
        }
        for (v, influence) in self.velocity.iter_mut().zip(influence) {
            *v += influence * w;
        }
    }
}

/// The factor of M_E + H_E l⁻ H_Eᵗ + d⁻_E.
fn factorise(
    structure: &Arc<Structure>,
    shares: &[Share],
    contacts: &[PlacedContact],
    directions: Directions,
) -> Result<Factor, Singular> {
    let mass = |place: usize| shares[place].on_diagonal(directions);
    Factor::new(Arc::clone(structure), mass, |contact| Some(contacts[contact].coupling(directions)))
}
