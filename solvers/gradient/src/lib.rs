//! Projected gradient with a fixed step on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r: the smallest method there is, which
//! every other must beat, and the one to copy.
//!
//! A. A. Goldstein, Convex programming in Hilbert space, Bull. Amer. Math. Soc. 70 (1964) 709-710. Cost of an iteration:
//! one product with W, in two passes over the contacts. q(r) decreases at every iteration for 0 < s < 2.

use analysis::delassus_bound;
use contact::{Iteration, Packing, SetupError, Smooth, Solver, Work, law};
use product::Product;
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

struct Run<const D: usize> {
    /// At each contact r (N·s) and b (m/s).
    product: Product<f64, f64, Smooth<D>>,
    /// ρ (kg).
    step: f64,
    products: u64,
}

impl<const D: usize> Iteration for Run<D> {
    fn advance(&mut self) {
        // v = W r + b, the gradient of q;  r = max(0, r − ρ v)
        let step = self.step;
        self.product.push(|r| *r);
        self.product.pull(|r, b, of_r| *r = law::non_negative(*r - step * (of_r + b)));
        self.products += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.product.impulses(|r| *r, r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl<const D: usize> Solver<Smooth<D>> for Gradient {
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("step", self.step)?;
        let (b, greatest) = (problem.b(), delassus_bound(problem));
        Ok(Box::new(Run {
            product: Product::new(problem, false, |contact, _| (r0[contact], b[contact]))?,
            // Without contacts there is no step to make.
            step: if greatest > 0.0 { self.step / greatest } else { 0.0 },
            products: 0,
        }))
    }
}
