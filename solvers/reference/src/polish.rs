//! From impulses near a solution to one at round-off: a primal-dual active set with a proximal term.
//!
//! M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set strategy as a semismooth Newton method, SIAM J. Optim.
//! 13 (2002) 865-888; R. T. Rockafellar, Augmented Lagrangians and applications of the proximal point algorithm in convex
//! programming, Math. Oper. Res. 1 (1976) 97-116. The proximal term keeps the matrix regular where more contacts are active
//! than equilibrium needs, and chooses among their impulses those nearest to the given ones.

use crate::factor::{Factor, Order};
use crate::row::Row;
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
    rows: Vec<Row>,
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
    pub(crate) fn new(problem: &'p ContactProblem, rows: Vec<Row>) -> Self {
        Self {
            problem,
            v: vec![0.0; rows.len()],
            rows,
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
        let rows = &self.rows;
        let active: Vec<bool> =
            (0..rows.len()).map(|k| r[k] * rows[k].root > self.v[k] / rows[k].root).collect();
        let Some(mut factor) = self.factorise(&active) else { return f64::NAN };
        for _ in 0..SOLVES {
            let mut change = vec![0.0; factor.dimension()];
            for (k, row) in self.rows.iter().enumerate() {
                let pull = if active[k] { PENALTY * self.v[k] / row.root } else { r[k] * row.root };
                row.add(-pull, &mut change);
            }
            self.solve(&mut factor, &mut change);
            for (k, row) in self.rows.iter().enumerate() {
                let v = self.v[k] / row.root + row.dot(&change);
                r[k] = if active[k] { r[k] - PENALTY * v / row.root } else { 0.0 };
            }
            self.measure(r);
        }
        for r in &mut *r {
            *r = law::non_negative(*r);
        }
        self.measure(r);
        let left = |(row, (r, v)): (&Row, (&f64, &f64))| f64::min(r * row.root, v / row.root).powi(2);
        self.rows.iter().zip(r.iter().zip(&self.v)).map(left).sum::<f64>().sqrt()
    }

    /// Turns impulses near a proof of infeasibility into one: the change of those above 0 that is least in r̃ and after
    /// which they balance, H d = 0.
    pub(crate) fn balance(&mut self, d: &mut [f64]) {
        let greatest = d.iter().copied().fold(0.0, f64::max);
        // What is left of multipliers that should be 0.
        let active: Vec<bool> = d.iter().map(|d| *d > 1e-6 * greatest).collect();
        let Some(mut factor) = self.factorise(&active) else { return };
        d.iter_mut().zip(&active).filter(|(_, active)| !**active).for_each(|(d, _)| *d = 0.0);
        for _ in 0..SOLVES {
            let mut unbalanced = vec![0.0; factor.dimension()];
            for (row, d) in self.rows.iter().zip(&*d) {
                row.add(d * row.root, &mut unbalanced);
            }
            self.solve(&mut factor, &mut unbalanced);
            for ((row, d), _) in self.rows.iter().zip(&mut *d).zip(&active).filter(|(_, active)| **active) {
                *d -= PENALTY * row.dot(&unbalanced) / row.root;
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

    /// The factor of K, if numbers allow it.
    fn factorise(&mut self, active: &[bool]) -> Option<Factor> {
        let dimension = 2 * self.problem.grain_count();
        if self.order.is_none() {
            self.order = Some(Order::of(dimension, self.rows.iter())?);
        }
        let rows = self.rows.iter().zip(active).filter(|(_, active)| **active).map(|(row, _)| row);
        self.factorisations += 1;
        Factor::new(dimension, rows, PENALTY, self.order.as_ref()?)
    }

    fn solve(&mut self, factor: &mut Factor, x: &mut [f64]) {
        factor.solve(x);
        self.solve_entries += 2 * factor.entries() as u64;
    }
}
