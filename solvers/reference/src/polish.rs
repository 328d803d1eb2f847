//! From impulses near a solution to one at round-off: a primal-dual active set with a proximal term.
//!
//! M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set strategy as a semismooth Newton method, SIAM J. Optim.
//! 13 (2002) 865-888; R. T. Rockafellar, Augmented Lagrangians and applications of the proximal point algorithm in convex
//! programming, Math. Oper. Res. 1 (1976) 97-116. The proximal term keeps the matrix regular where more contacts are active
//! than equilibrium needs, and chooses among their impulses those nearest to the given ones.

use crate::constraint::Constraint;
use cholesky::{Factor, Order, Singular, Triplet};
use contact::{ContactProblem, law};
use nalgebra::Vector2;

/// κ, the weight of the contacts against the masses (–). An error in the impulses shrinks by 1 + κ λ in a solve, for each
/// eigenvalue λ of W̃; the lowest in a packing of a hundred layers are some 1e-5.
const PENALTY: f64 = 1e7;

/// Solves with one factor.
const SOLVES: u32 = 4;

/// What a polish needs beside the impulses.
pub(crate) struct Polish<'p> {
    problem: &'p ContactProblem,
    constraints: Vec<Constraint>,
    velocity: Vec<Vector2<f64>>,
    v: Vec<f64>,
    /// Matrices factorised.
    pub(crate) factorisations: u64,
    /// Entries of the factors that solves went through.
    pub(crate) solve_entries: u64,
    /// The order of the unknowns, found once for all contacts.
    order: Option<Order>,
}

impl<'p> Polish<'p> {
    pub(crate) fn new(problem: &'p ContactProblem, constraints: Vec<Constraint>) -> Self {
        Self {
            problem,
            v: vec![0.0; constraints.len()],
            constraints,
            velocity: vec![Vector2::zeros(); problem.grain_count()],
            factorisations: 0,
            solve_entries: 0,
            order: None,
        }
    }

    /// One factorisation: the contacts with r̃ > ṽ are held closed, the others let go. With K = 1 + κ H̃_A H̃_Aᵗ,
    ///
    /// K δy = −κ H̃_A ṽ_A − H̃_I r̃_I,   r̃_A ← r̃_A − κ (ṽ_A + H̃_Aᵗ δy),   r̃_I ← 0,
    ///
    /// a few times, and at last r ← max(0, r). The residual ṽ comes from r each time: no error of K stays. Returns what is
    /// left of the law, √(Σ min(r̃, ṽ)²) (√J).
    pub(crate) fn step(&mut self, r: &mut [f64]) -> f64 {
        self.measure(r);
        let constraints = &self.constraints;
        let active: Vec<bool> = (0..constraints.len())
            .map(|k| r[k] * constraints[k].root > self.v[k] / constraints[k].root)
            .collect();
        let Ok(mut factor) = self.factorise(&active) else { return f64::NAN };
        for _ in 0..SOLVES {
            let mut change = vec![0.0; factor.dimension()];
            for (k, constraint) in self.constraints.iter().enumerate() {
                let pull =
                    if active[k] { PENALTY * self.v[k] / constraint.root } else { r[k] * constraint.root };
                constraint.add(-pull, &mut change);
            }
            self.solve(&mut factor, &mut change);
            for (k, constraint) in self.constraints.iter().enumerate() {
                let v = self.v[k] / constraint.root + constraint.dot(&change);
                r[k] = if active[k] { r[k] - PENALTY * v / constraint.root } else { 0.0 };
            }
            self.measure(r);
        }
        for r in &mut *r {
            *r = law::non_negative(*r);
        }
        self.measure(r);
        let left = |(constraint, (r, v)): (&Constraint, (&f64, &f64))| {
            f64::min(r * constraint.root, v / constraint.root).powi(2)
        };
        self.constraints.iter().zip(r.iter().zip(&self.v)).map(left).sum::<f64>().sqrt()
    }

    /// Turns impulses near a proof of infeasibility into one: the change of those above 0 that is least in r̃ and after
    /// which they balance, H d = 0.
    pub(crate) fn balance(&mut self, d: &mut [f64]) {
        let greatest = d.iter().copied().fold(0.0, f64::max);
        // What is left of multipliers that should be 0.
        let active: Vec<bool> = d.iter().map(|d| *d > 1e-6 * greatest).collect();
        let Ok(mut factor) = self.factorise(&active) else { return };
        d.iter_mut().zip(&active).filter(|(_, active)| !**active).for_each(|(d, _)| *d = 0.0);
        for _ in 0..SOLVES {
            let mut unbalanced = vec![0.0; factor.dimension()];
            for (constraint, d) in self.constraints.iter().zip(&*d) {
                constraint.add(d * constraint.root, &mut unbalanced);
            }
            self.solve(&mut factor, &mut unbalanced);
            for ((constraint, d), _) in
                self.constraints.iter().zip(&mut *d).zip(&active).filter(|(_, active)| **active)
            {
                *d -= PENALTY * constraint.dot(&unbalanced) / constraint.root;
            }
        }
        for d in d {
            *d = law::non_negative(*d);
        }
    }

    /// v of the impulses.
    fn measure(&mut self, r: &[f64]) {
        self.problem.velocity(r, &mut self.velocity);
        self.problem.relative_velocity(&self.velocity, &mut self.v);
    }

    /// The factor of K = 1 + κ H̃_A H̃_Aᵗ, if numbers allow it.
    fn factorise(&mut self, active: &[bool]) -> Result<Factor, Singular> {
        let dimension = 2 * self.problem.grain_count();
        let order = if let Some(order) = self.order.take() {
            order
        } else {
            let all = self.constraints.iter().flat_map(|constraint| constraint.products(PENALTY));
            Order::minimum_degree(dimension, all.map(|(i, j, _)| (i, j)))?
        };
        let mut lower: Vec<_> = (0..dimension).map(|k| Triplet::new(k, k, 1.0)).collect();
        for (constraint, _) in self.constraints.iter().zip(active).filter(|(_, active)| **active) {
            lower.extend(constraint.products(PENALTY).map(|(i, j, value)| Triplet::new(i, j, value)));
        }
        self.factorisations += 1;
        Factor::new(dimension, &lower, self.order.insert(order))
    }

    fn solve(&mut self, factor: &mut Factor, x: &mut [f64]) {
        factor.solve(x);
        self.solve_entries += 2 * factor.entries() as u64;
    }
}
