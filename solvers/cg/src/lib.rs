//! Conjugate projected gradient on min over r ≥ 0 of q(r) = ½ rᵗ W r + bᵗ r, the paper's reference \[2\].
//!
//! M. Renouf, P. Alart, Conjugate gradient type algorithms for frictional multi-contact problems: applications to
//! granular materials, Comput. Methods Appl. Mech. Engrg. 194 (2005) 2019-2041. Cost of an iteration: two products
//! with W and a few passes over the contacts.

use contact::{ContactProblem, Iteration, SetupError, Solver, Work, law};
use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the conjugate gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cg {
    /// What scales the gradient before it becomes a direction.
    pub preconditioner: Preconditioner,
}

/// The plain method of the reference.
impl Default for Cg {
    fn default() -> Self {
        Self { preconditioner: Preconditioner::None }
    }
}

/// What scales the gradient before it becomes a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    /// Nothing.
    None,
    /// `W_D`, the diagonal of W.
    Diagonal,
}

struct Run<'p> {
    problem: &'p ContactProblem,
    b: Vec<f64>,
    /// 1/`W_αα` (kg) with the preconditioner, 1 without.
    scaling: Vec<f64>,
    r: Vec<f64>,
    /// u = −(W r + b), minus the gradient of q (m/s).
    u: Vec<f64>,
    /// The direction.
    p: Vec<f64>,
    /// W p.
    w_p: Vec<f64>,
    /// The projected, scaled gradient.
    w: Vec<f64>,
    scratch: Vec<Vector2<f64>>,
    products: u64,
}

impl Run<'_> {
    /// u = −(W r + b), and w = u/`W_αα` where r > 0 or u > 0, else 0: the part of it that r ≥ 0 does not block.
    fn project_gradient(&mut self) {
        self.problem.delassus_product(&self.r, &mut self.u, &mut self.scratch);
        self.products += 1;
        for (contact, u) in self.u.iter_mut().enumerate() {
            *u = -(*u + self.b[contact]);
            self.w[contact] =
                if self.r[contact] > 0.0 || *u > 0.0 { *u * self.scaling[contact] } else { 0.0 };
        }
    }
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        self.problem.delassus_product(&self.p, &mut self.w_p, &mut self.scratch);
        self.products += 1;
        // pᵗ W p is 0 at a solution, where p = 0; and on a problem without one, along a p of which grains feel nothing:
        // there the iterate stays.
        let curvature = dot(&self.p, &self.w_p);
        let ratio = |numerator: f64| if curvature == 0.0 { 0.0 } else { numerator / curvature };

        // r = max(0, r + α p),  α = uᵗ p / pᵗ W p
        let length = ratio(dot(&self.u, &self.p));
        for (r, p) in self.r.iter_mut().zip(&self.p) {
            *r = law::non_negative(*r + length * p);
        }
        self.project_gradient();

        // p = w + β z,  z = p on the set of w, else 0,  β = −wᵗ W p / pᵗ W p
        let beta = -ratio(dot(&self.w, &self.w_p));
        for (contact, p) in self.p.iter_mut().enumerate() {
            let free = self.r[contact] > 0.0 || self.u[contact] > 0.0;
            *p = if free { self.w[contact] + beta * *p } else { 0.0 };
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn work(&self) -> Work {
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl Solver for Cg {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let contacts = problem.contact_count();
        let scaling = match self.preconditioner {
            Preconditioner::None => vec![1.0; contacts],
            Preconditioner::Diagonal => problem.delassus_diagonal().iter().map(|w| 1.0 / w).collect(),
        };
        let mut run = Run {
            problem,
            b: problem.b(),
            scaling,
            r: r0.to_vec(),
            u: vec![0.0; contacts],
            p: vec![0.0; contacts],
            w_p: vec![0.0; contacts],
            w: vec![0.0; contacts],
            scratch: vec![Vector2::zeros(); problem.grain_count()],
            products: 0,
        };
        run.project_gradient();
        run.p.copy_from_slice(&run.w);
        Ok(Box::new(run))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
