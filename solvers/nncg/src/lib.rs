//! Non-smooth non-linear conjugate gradient: sweeps of projected Gauss-Seidel, extrapolated by the rule of Fletcher and Reeves.
//!
//! M. Silcowitz, S. Niebe, K. Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force
//! problems, The Visual Computer 26 (2010) 893-901. The change that a sweep makes takes the place of the gradient. Cost of an
//! iteration: a sweep, and a few passes over impulses and velocities. Neither q(r) nor the error falls at each iteration.

use contact::sweep::Sweep;
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work};
use nalgebra::SVector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nncg {}

/// In mass-scaled unknowns, s = √`W_αα` r and y = M^½ V. The method stays that of the plain ones: its norm is weighted.
struct Run<const D: usize> {
    /// s after the last sweep, which is the answer, and y where the next begins.
    sweep: Sweep<Smooth<D>>,
    /// 1/`W_αα` (kg).
    inverse_delassus: Vec<f64>,
    /// s where the next sweep begins, extrapolated; may be below 0.
    ahead: Vec<f64>,
    /// The direction, √`W_αα` p, and M^-½ H p.
    p: Vec<f64>,
    y_p: Vec<SVector<f64, D>>,
    /// y where the sweep began.
    y_before: Vec<SVector<f64, D>>,
    /// |r_swept − r|² of the last sweep; infinite before the first, which makes β = 0.
    squared_change: f64,
    sweeps: u64,
}

impl<const D: usize> Run<D> {
    /// `s` from `ahead`: a sweep of NSGS. Returns |r⁺ − r|².
    fn sweep(&mut self) -> f64 {
        let Sweep { rows, s, y, .. } = &mut self.sweep;
        let mut squared_change = 0.0;
        for ((row, s), (ahead, inverse)) in
            rows.iter().zip(s).zip(self.ahead.iter().zip(&self.inverse_delassus))
        {
            *s = *ahead;
            let change = row.solve(s, y, 1.0);
            squared_change += inverse * change * change;
        }
        self.sweeps += 1;
        squared_change
    }
}

impl<const D: usize> Iteration for Run<D> {
    fn advance(&mut self) {
        self.y_before.copy_from_slice(&self.sweep.y);
        let squared_change = self.sweep();

        // −∇f = r_swept − r,  β = |∇f|² / |∇f_before|²;  β > 1 begins anew: p = 0, and no extrapolation;
        // else r ← r_swept + β p,  p ← β p − ∇f. y and M^-½ H p follow without a pass over the contacts.
        let beta = squared_change / self.squared_change;
        let go_on = beta <= 1.0;
        for ((ahead, p), s) in self.ahead.iter_mut().zip(&mut self.p).zip(&self.sweep.s) {
            let change = s - *ahead;
            (*ahead, *p) = if go_on { (s + beta * *p, beta * *p + change) } else { (*s, 0.0) };
        }
        for ((y, y_p), before) in self.sweep.y.iter_mut().zip(&mut self.y_p).zip(&self.y_before) {
            let change = *y - before;
            if go_on {
                *y += beta * *y_p;
                *y_p = beta * *y_p + change;
            } else {
                *y_p = SVector::zeros();
            }
        }
        self.squared_change = squared_change;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }

    fn work(&self) -> Work {
        Work { contact_updates: self.sweeps * self.p.len() as u64, ..Work::default() }
    }
}

impl<const D: usize> Solver<Smooth<D>> for Nncg {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let order: Vec<u32> = (0..problem.contact_count() as u32).collect();
        let sweep = Sweep::new(problem, &order, r0);
        Ok(Box::new(Run {
            inverse_delassus: sweep.unit.iter().map(|unit| 1.0 / (unit * unit)).collect(),
            ahead: sweep.s.clone(),
            p: vec![0.0; r0.len()],
            y_p: vec![SVector::zeros(); sweep.y.len()],
            y_before: sweep.y.clone(),
            sweep,
            squared_change: f64::INFINITY,
            sweeps: 0,
        }))
    }
}
