//! Projected gradient with a fixed step on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r: the smallest method there is, which
//! every other must beat, and the one to copy.
//!
//! A. A. Goldstein, Convex programming in Hilbert space, Bull. Amer. Math. Soc. 70 (1964) 709-710. Cost of an iteration:
//! one product with W and two passes over the contacts. q(r) decreases at every iteration for 0 < s < 2.

use contact::spectrum::delassus_bound;
use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the projected gradient.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Gradient {
    /// s (–): the step is ρ = s/Λ, where Λ ≥ λmax(W). Any positive value is accepted, since where it fails is of
    /// interest.
    pub step: f64,
}

/// s = 1, for which q decreases most in the worst case.
impl Default for Gradient {
    fn default() -> Self {
        Self { step: 1.0 }
    }
}

struct Run<'p> {
    problem: &'p ContactProblem,
    b: Vec<f64>,
    /// ρ (kg).
    step: f64,
    r: Vec<f64>,
    /// v = W r + b, the gradient of q (m/s).
    v: Vec<f64>,
    scratch: Vec<Vector2<f64>>,
    products: u64,
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        // v = W r + b;  r = max(0, r − ρ v)
        self.problem.delassus_product(&self.r, &mut self.v, &mut self.scratch);
        self.products += 1;
        for (r, (v, b)) in self.r.iter_mut().zip(self.v.iter_mut().zip(&self.b)) {
            *v += b;
            *r = law::non_negative(*r - self.step * *v);
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl Solver for Gradient {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("step", self.step)?;
        let greatest = delassus_bound(problem);
        Ok(Box::new(Run {
            problem,
            b: problem.b(),
            // Without contacts there is no step to make.
            step: if greatest > 0.0 { self.step / greatest } else { 0.0 },
            r: r0.to_vec(),
            v: vec![0.0; r0.len()],
            scratch: vec![Vector2::zeros(); problem.grain_count()],
            products: 0,
        }))
    }
}
