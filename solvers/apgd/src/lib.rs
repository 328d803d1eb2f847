//! Accelerated projected gradient descent on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r.
//!
//! H. Mazhar, T. Heyn, D. Negrut, A. Tasora, Using Nesterov's method to accelerate multibody dynamics with friction and
//! contact, ACM Trans. Graph. 34 (2015) 32. Their cone is here r ≥ 0; their fall-back to the best iterate so far is left to
//! whoever measures. Cost of an iteration: one product with W for the gradient, one for each step length tried, most often
//! one.

use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the accelerated gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Apgd {
    /// Nesterov's extrapolation; without it q(r) never increases.
    pub acceleration: bool,
    /// The metric D in which steps are taken: r ≥ 0 acts on each component alone, so any diagonal one keeps the method.
    pub preconditioner: Preconditioner,
}

/// The reference's method.
impl Default for Apgd {
    fn default() -> Self {
        Self { acceleration: true, preconditioner: Preconditioner::None }
    }
}

/// The metric of the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// D = 1.
    None,
    /// D = `W_D`, the diagonal of W.
    Diagonal,
}

/// From one iteration to the next the step length may grow by 1/0.9, as in the reference.
const SHRINK: f64 = 0.9;

struct Run<'p> {
    problem: &'p ContactProblem,
    b: Vec<f64>,
    /// Diagonal of D.
    metric: Vec<f64>,
    acceleration: bool,
    r: Vec<f64>,
    /// y, the extrapolated impulses.
    y: Vec<f64>,
    /// g = W y + b, then W d in turn.
    g: Vec<f64>,
    w_d: Vec<f64>,
    /// r⁺ of the step tried, and d = r⁺ − y.
    r_plus: Vec<f64>,
    d: Vec<f64>,
    /// L, the estimate of the greatest eigenvalue of D⁻¹ W, and the least that it may become.
    lipschitz: f64,
    least_lipschitz: f64,
    theta: f64,
    scratch: Vec<Vector2<f64>>,
    products: u64,
}

impl Run<'_> {
    /// r⁺ = max(0, y − D⁻¹ g / L), with L doubled until dᵗ W d ≤ L dᵗ D d: then q(r⁺) is below its bound at y.
    fn projected_step(&mut self) {
        loop {
            for contact in 0..self.r.len() {
                let step = self.g[contact] / (self.metric[contact] * self.lipschitz);
                self.r_plus[contact] = law::non_negative(self.y[contact] - step);
                self.d[contact] = self.r_plus[contact] - self.y[contact];
            }
            self.problem.delassus_product(&self.d, &mut self.w_d, &mut self.scratch);
            self.products += 1;
            let curvature: f64 = self.d.iter().zip(&self.w_d).map(|(d, w_d)| d * w_d).sum();
            let length: f64 = self.d.iter().zip(&self.metric).map(|(d, metric)| metric * d * d).sum();
            // Written so that a NaN ends it too.
            if !(curvature > self.lipschitz * length) {
                return;
            }
            self.lipschitz *= 2.0;
        }
    }
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        // g = W y + b
        self.problem.delassus_product(&self.y, &mut self.g, &mut self.scratch);
        self.products += 1;
        self.g.iter_mut().zip(&self.b).for_each(|(g, b)| *g += b);
        self.projected_step();

        // θ⁺ = (−θ² + θ √(θ² + 4)) / 2,  β = θ (1 − θ) / (θ² + θ⁺),  y = r⁺ + β (r⁺ − r);
        // begun anew where the step goes uphill: gᵗ (r⁺ − r) > 0.
        let theta_squared = self.theta * self.theta;
        let theta_plus = 0.5 * (self.theta * (theta_squared + 4.0).sqrt() - theta_squared);
        let changes = || self.r_plus.iter().zip(&self.r).map(|(r_plus, r)| r_plus - r);
        let uphill = self.g.iter().zip(changes()).map(|(g, change)| g * change).sum::<f64>() > 0.0;
        let (beta, theta) = if uphill || !self.acceleration {
            (0.0, 1.0)
        } else {
            (self.theta * (1.0 - self.theta) / (theta_squared + theta_plus), theta_plus)
        };
        for ((y, r_plus), change) in self.y.iter_mut().zip(&self.r_plus).zip(changes()) {
            *y = r_plus + beta * change;
        }
        self.theta = theta;
        self.r.copy_from_slice(&self.r_plus);
        self.lipschitz = f64::max(SHRINK * self.lipschitz, self.least_lipschitz);
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl Solver for Apgd {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let contacts = problem.contact_count();
        let diagonal = problem.delassus_diagonal();
        let greatest = diagonal.iter().copied().fold(0.0, f64::max);
        // An entry of the diagonal is no more than the greatest eigenvalue, and unlike the reference's ‖W 1‖/‖1‖ never 0.
        let (metric, lipschitz) = match self.preconditioner {
            Preconditioner::None => (vec![1.0; contacts], greatest),
            Preconditioner::Diagonal => (diagonal, 1.0),
        };
        Ok(Box::new(Run {
            problem,
            b: problem.b(),
            metric,
            acceleration: self.acceleration,
            r: r0.to_vec(),
            y: r0.to_vec(),
            g: vec![0.0; contacts],
            w_d: vec![0.0; contacts],
            r_plus: vec![0.0; contacts],
            d: vec![0.0; contacts],
            lipschitz,
            least_lipschitz: f64::EPSILON * lipschitz,
            theta: 1.0,
            scratch: vec![Vector2::zeros(); problem.grain_count()],
            products: 0,
        }))
    }
}
