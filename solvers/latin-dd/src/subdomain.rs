//! One subdomain: its linear stage (1) (4) (5), and the local stage (2) (6) of its contacts.

use crate::assembly::{PlacedContact, Share, coupling, placed, shares};
use crate::directions::Directions;
use crate::sent::Sent;
use crate::stages::{Form, Stages};
use cholesky::{Factor, Order, Singular, Structure};
use contact::{Packing, SetupError, Vector};
use nalgebra::{SMatrix, SVector};
use partition::{Decomposition, Sums};
use std::sync::Arc;

/// A subdomain between two local stages. Grains are in the order of the factor.
pub(crate) struct Latin<M: Stages, const D: usize> {
    contacts: Vec<PlacedContact<M>>,
    shares: Vec<Share<D>>,
    directions: Directions,
    structure: Arc<Structure<D>>,
    pub(crate) factor: Factor<D>,
    /// `M_E V_free` − `H_E` l⁻ c, what does not change in the right-hand side (N·s).
    constant: Vec<SVector<f64, D>>,
    /// t = r̂ + l⁻ v̂ of each contact (N·s).
    t: Vec<M::Impulse>,
    /// r̂ of each contact, in the order of the subdomain's (N·s).
    pub(crate) r_hat: Vec<M::Impulse>,
    /// τ = F̂ + d⁻ V̂ of each grain, 0 where it is no boundary grain (N·s).
    tau: Vec<SVector<f64, D>>,
    /// `constant` + `H_E` t, and what was added to the walls, last (N·s).
    right_hand_side: Vec<SVector<f64, D>>,
    /// V_E of the linear stage, and the rest of the walls, last (m/s).
    velocity: Vec<SVector<f64, D>>,
    /// Places of its copies of boundary grains.
    pub(crate) boundary: Vec<u32>,
    /// Greatest |V_E − V̄| of the translations of these after the linear stage (m/s).
    pub(crate) velocity_jump: f64,
}

/// r and v of one unknown of a contact, or F and V of one unknown of a boundary grain, after the linear stage, each with the sizes
/// of the terms that it is the sum of, added up; all in √J.
#[derive(Clone, Copy)]
pub(crate) struct Iterate {
    pub(crate) r: f64,
    pub(crate) v: f64,
    pub(crate) terms_of_r: f64,
    pub(crate) terms_of_v: f64,
}

impl<M: Stages<Velocity = SVector<f64, D>>, const D: usize> Latin<M, D> {
    /// Factorises M_E + H_E l⁻ H_Eᵗ + d⁻_E of the subdomain `e`, and begins from the impulses `r0` and the velocities
    /// `start` that follow from them.
    pub(crate) fn new(
        problem: &Packing<M>,
        decomposition: &Decomposition,
        e: usize,
        (directions, kappa_t): (&Directions, f64),
        r0: &[f64],
        start: &[SVector<f64, D>],
    ) -> Result<Self, SetupError> {
        let too_large = |why: Singular| {
            let value = format!("so large that a subdomain's matrix cannot be factorised ({why})");
            SetupError::new("kappa_l_minus", value, "smaller")
        };
        let subdomain = &decomposition.subdomains[e];
        let position: Vec<_> =
            subdomain.grains.iter().map(|grain| problem.position()[*grain as usize]).collect();
        let order = Order::fill_reducing(&position, &subdomain.ends)?;
        let structure = Structure::new(&subdomain.ends, &order)?;
        let contacts = placed(problem, subdomain, structure.position(), kappa_t);
        let shares = shares(problem, decomposition, subdomain, structure.position());
        let factor = factorise(&structure, &shares, &contacts, *directions).map_err(too_large)?;
        let grains = shares.len();
        let mut latin = Self {
            directions: *directions,
            factor,
            constant: Vec::new(),
            t: vec![M::Impulse::ZERO; contacts.len()],
            r_hat: subdomain.contacts.iter().map(|k| Vector::at(r0, *k as usize)).collect(),
            tau: vec![SVector::zeros(); grains],
            right_hand_side: vec![SVector::zeros(); grains + 1],
            velocity: vec![SVector::zeros(); grains + 1],
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
        let mut f_hat: Vec<SVector<f64, D>> =
            grains.map(|(share, v)| share.mass.component_mul(&(v - share.free_velocity))).collect();
        f_hat.push(SVector::zeros());
        for ((contact, r), t) in self.contacts.iter().zip(&self.r_hat).zip(&mut self.t) {
            contact.add(-*r, &mut f_hat);
            let v_hat = contact.form.beside(*r, contact.relative(&self.velocity));
            *t = *r + contact.l(l_minus, v_hat);
        }
        for (((tau, share), f_hat), v) in
            self.tau.iter_mut().zip(&self.shares).zip(&f_hat).zip(&self.velocity)
        {
            if share.on_boundary() {
                *tau = f_hat + (d_minus * share.mass).component_mul(v);
            }
        }
        self.assemble();
    }

    /// Assembles the constant part of the right-hand side, and the rest of it but τ.
    fn assemble(&mut self) {
        self.constant =
            self.shares.iter().map(|share| share.mass.component_mul(&share.free_velocity)).collect();
        self.constant.push(SVector::zeros());
        for contact in &self.contacts {
            contact.add(-contact.l(self.directions.l_minus, contact.offset), &mut self.constant);
        }
        self.right_hand_side.copy_from_slice(&self.constant);
        for (contact, t) in self.contacts.iter().zip(&self.t) {
            contact.add(*t, &mut self.right_hand_side);
        }
    }

    /// Returns the memory of its factor (B).
    pub(crate) fn factor_bytes(&self) -> u64 {
        self.structure.bytes()
    }

    /// The factor for other directions.
    pub(crate) fn factorise(&self, directions: &Directions) -> Result<Factor<D>, Singular> {
        factorise(&self.structure, &self.shares, &self.contacts, *directions)
    }

    /// Takes other directions with their factor; r̂, v̂ and F̂ stay, and V̂ is near V_E.
    pub(crate) fn turn(&mut self, directions: &Directions, factor: Factor<D>) {
        self.factor = factor;
        for (t, r_hat) in self.t.iter_mut().zip(&self.r_hat) {
            *t = *r_hat + (*t - *r_hat) * (directions.l_minus / self.directions.l_minus);
        }
        let change = directions.d_minus - self.directions.d_minus;
        for ((tau, share), v) in self.tau.iter_mut().zip(&self.shares).zip(&self.velocity) {
            if share.on_boundary() {
                *tau += (change * share.mass).component_mul(v);
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
    /// g = r − l⁺ v :  r̂ = max(g, 0),  v̂ = max(−g, 0)/l⁺ = (r̂ − g)/l⁺     (2) (6);   t ← t + μ (r̂ + l⁻ v̂ − t)
    ///
    /// With friction in r̂ the tangential g_t is clipped to μ r̂_n, (2′), and μ there is the coefficient of friction.
    pub(crate) fn local_stage(&mut self, relaxation: f64) {
        let Directions { l_minus, l_plus, .. } = self.directions;
        self.right_hand_side.copy_from_slice(&self.constant);
        for ((contact, t), r_hat) in self.contacts.iter().zip(&mut self.t).zip(&mut self.r_hat) {
            let g = *t - contact.l(l_minus + l_plus, contact.relative(&self.velocity));
            *r_hat = contact.form.admissible(g);
            *t += (*r_hat + (*r_hat - g) * (l_minus / l_plus) - *t) * relaxation;
            contact.add(*t, &mut self.right_hand_side);
        }
    }

    /// Writes the contributions of its copies of boundary grains to the sums over all copies: (d⁺ + d⁻) V_E − τ = d⁺ V_E − F_E (N·s) and
    /// V_E/m_i (m/s).
    pub(crate) fn send(&self, sent: &mut [Sent<D>]) {
        for (k, sent) in sent.iter_mut().enumerate() {
            let (v, tau, Share { mass, copies, .. }) = self.copy(k);
            let (d_minus, d_plus) = (self.directions.d_minus * mass, self.directions.d_plus * mass);
            *sent = Sent { impulse: (d_plus + d_minus).component_mul(&v) - tau, velocity: v / *copies };
        }
    }

    /// Local stage of the boundary grains, with F_E = τ − d⁻ V_E:
    /// V̂ = Σ_E (d⁺ V_E − F_E) / Σ_E d⁺,   F̂_E = F_E + d⁺ (V̂ − V_E);   τ ← τ + μ (F̂_E + d⁻ V̂ − τ)     (3) (7)
    pub(crate) fn interface(&mut self, relaxation: f64, sums: Sums<'_, Sent<D>>) {
        self.velocity_jump = 0.0;
        for (k, sum) in sums.enumerate() {
            let (v, tau, Share { mass, copies, .. }) = self.copy(k);
            let (d_minus, d_plus) = (self.directions.d_minus * mass, self.directions.d_plus * mass);
            let v_hat = sum.impulse.component_div(&(d_plus * *copies));
            let f_hat = tau - d_minus.component_mul(&v) + d_plus.component_mul(&(v_hat - v));
            let jump = (v - sum.velocity).rows(0, M::Place::LEN).norm();
            self.velocity_jump = self.velocity_jump.max(jump);
            self.tau[self.boundary[k] as usize] += relaxation * (f_hat + d_minus.component_mul(&v_hat) - tau);
        }
    }

    /// V_E (m/s), τ (N·s) and the share of copy k of a boundary grain.
    pub(crate) fn copy(&self, k: usize) -> (SVector<f64, D>, SVector<f64, D>, &Share<D>) {
        let place = self.boundary[k] as usize;
        (self.velocity[place], self.tau[place], &self.shares[place])
    }

    /// r and v of each unknown of a contact that has a direction, and F and V of each boundary grain, after the linear stage.
    pub(crate) fn linear_iterate(&self) -> impl Iterator<Item = Iterate> {
        let Directions { l_minus, d_minus, .. } = self.directions;
        let of = |mass: f64, kappa: f64, t: f64, v: f64, terms: f64| Iterate {
            r: (t - kappa * mass * v) / mass.sqrt(),
            v: v * mass.sqrt(),
            terms_of_r: (t.abs() + kappa * mass * terms) / mass.sqrt(),
            terms_of_v: terms * mass.sqrt(),
        };
        let contacts = self.contacts.iter().zip(&self.t).flat_map(move |(contact, t)| {
            let (v, terms) = (contact.relative(&self.velocity), contact.terms(&self.velocity));
            let directions = contact.direction.components().zip(t.components());
            let unknowns = directions.zip(v.components()).zip(terms.components());
            unknowns
                .filter(|(((mass, _), _), _)| *mass > 0.0)
                .map(move |(((mass, t), v), terms)| of(mass, l_minus, t, v, terms))
        });
        let grains = self.shares.iter().zip(&self.tau).zip(&self.velocity);
        let boundary =
            grains.filter(|((share, _), _)| share.on_boundary()).flat_map(move |((share, tau), v)| {
                (0..D).map(move |c| of(share.mass[c], d_minus, tau[c], v[c], v[c].abs()))
            });
        contacts.chain(boundary)
    }

    /// K_E⁻¹ d⁻ B_E for the T translations of `grains` (place, d⁻), with a factor of K_E.
    pub(crate) fn influence<const T: usize>(
        &self,
        factor: &Factor<D>,
        grains: &[(usize, f64)],
    ) -> Vec<SMatrix<f64, D, T>> {
        let mut influence = vec![SMatrix::<f64, D, T>::zeros(); self.shares.len()];
        for axis in 0..T {
            let mut x = vec![SVector::zeros(); self.shares.len()];
            for (place, d_minus) in grains {
                x[*place][axis] = *d_minus;
            }
            factor.solve(&mut x);
            influence.iter_mut().zip(&x).for_each(|(influence, x)| influence.set_column(axis, x));
        }
        influence
    }

    /// Σ F_E over `grains` (place, d⁻), with F_E = τ − d⁻ V_E (N·s).
    pub(crate) fn resultant<const T: usize>(&self, grains: &[(usize, f64)]) -> SVector<f64, T> {
        let of = |(place, d_minus): &(usize, f64)| {
            (self.tau[*place] - *d_minus * self.velocity[*place]).fixed_rows::<T>(0).into_owned()
        };
        grains.iter().map(of).sum()
    }

    /// Adds d⁻ w to τ of `grains`, and what that does to V_E.
    pub(crate) fn translate<const T: usize>(
        &mut self,
        grains: &[(usize, f64)],
        influence: &[SMatrix<f64, D, T>],
        w: SVector<f64, T>,
    ) {
        for (place, d_minus) in grains {
            let mut tau = self.tau[*place].fixed_rows_mut::<T>(0);
            tau += *d_minus * w;
        }
        for (v, influence) in self.velocity.iter_mut().zip(influence) {
            *v += influence * w;
        }
    }
}

/// The factor of M_E + H_E l⁻ H_Eᵗ + d⁻_E.
fn factorise<M: Stages<Velocity = SVector<f64, D>>, const D: usize>(
    structure: &Arc<Structure<D>>,
    shares: &[Share<D>],
    contacts: &[PlacedContact<M>],
    directions: Directions,
) -> Result<Factor<D>, Singular> {
    let mass = |place: usize| shares[place].on_diagonal(directions);
    Factor::new(Arc::clone(structure), mass, |contact| coupling(&contacts[contact], directions))
}
