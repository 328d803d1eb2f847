//! Non-smooth non-linear conjugate gradient: sweeps of projected Gauss-Seidel, extrapolated by the rule of Fletcher and Reeves.
//!
//! M. Silcowitz, S. Niebe, K. Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force
//! problems, The Visual Computer 26 (2010) 893-901. The change that a sweep makes takes the place of the gradient. Cost of an
//! iteration: a sweep, and a few passes over impulses and velocities. Neither q(r) nor the error falls at each iteration.

use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nncg {}

struct Run<'p> {
    problem: &'p ContactProblem,
    /// 1/`W_αα` (kg).
    inverse_delassus: Vec<f64>,
    /// r after the last sweep (N·s): the answer.
    r: Vec<f64>,
    /// r where the next sweep begins, extrapolated, and its V = `V_free` + M⁻¹ H r; may be below 0.
    r_ahead: Vec<f64>,
    velocity: Vec<Vector2<f64>>,
    /// The direction p, and M⁻¹ H p.
    p: Vec<f64>,
    velocity_p: Vec<Vector2<f64>>,
    /// V where the sweep began.
    velocity_before: Vec<Vector2<f64>>,
    /// |r_swept − r|² of the last sweep; infinite before the first, which makes β = 0.
    squared_change: f64,
    sweeps: u64,
}

impl Run<'_> {
    /// `r` from `r_ahead`: at each contact r⁺ = max(0, r − v/`W_αα`), V ← V + M⁻¹ `h_α` (r⁺ − r). Returns |r⁺ − r|².
    fn sweep(&mut self) -> f64 {
        let mass = self.problem.mass();
        let mut squared_change = 0.0;
        for (alpha, contact) in self.problem.contacts().iter().enumerate() {
            let v = contact.relative(&self.velocity) + contact.offset;
            let before = self.r_ahead[alpha];
            let after = law::update(before, v, self.inverse_delassus[alpha], 1.0);
            let impulse = contact.normal * (after - before);
            let i = contact.candidate as usize;
            self.velocity[i] += impulse / mass[i];
            if let Some(j) = contact.antagonist {
                self.velocity[j as usize] -= impulse / mass[j as usize];
            }
            self.r[alpha] = after;
            squared_change += (after - before) * (after - before);
        }
        self.sweeps += 1;
        squared_change
    }
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        self.velocity_before.copy_from_slice(&self.velocity);
        let squared_change = self.sweep();

        // −∇f = r_swept − r,  β = |∇f|² / |∇f_before|²;  β > 1 begins anew: p = 0, and no extrapolation;
        // else r ← r_swept + β p,  p ← β p − ∇f. V and M⁻¹ H p follow without a pass over the contacts.
        let beta = squared_change / self.squared_change;
        let go_on = beta <= 1.0;
        for ((ahead, p), r) in self.r_ahead.iter_mut().zip(&mut self.p).zip(&self.r) {
            let change = r - *ahead;
            (*ahead, *p) = if go_on { (r + beta * *p, beta * *p + change) } else { (*r, 0.0) };
        }
        for ((velocity, velocity_p), before) in
            self.velocity.iter_mut().zip(&mut self.velocity_p).zip(&self.velocity_before)
        {
            let change = *velocity - before;
            if go_on {
                *velocity += beta * *velocity_p;
                *velocity_p = beta * *velocity_p + change;
            } else {
                *velocity_p = Vector2::zeros();
            }
        }
        self.squared_change = squared_change;
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.sweeps * self.r.len() as u64, ..Work::default() }
    }
}

impl Solver for Nncg {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let mut velocity = vec![Vector2::zeros(); problem.grain_count()];
        problem.velocity(r0, &mut velocity);
        Ok(Box::new(Run {
            problem,
            inverse_delassus: problem.delassus_diagonal().iter().map(|w| 1.0 / w).collect(),
            r: r0.to_vec(),
            r_ahead: r0.to_vec(),
            velocity_before: velocity.clone(),
            velocity,
            p: vec![0.0; r0.len()],
            velocity_p: vec![Vector2::zeros(); problem.grain_count()],
            squared_change: f64::INFINITY,
            sweeps: 0,
        }))
    }
}
