//! The convex neighbour of Coulomb's law, and the fixed point over it: with σ = μ|`v_t`| of each contact frozen,
//!
//! 0 ≤ `v_n` + σ ± μ `v_t` ⊥ z± ≥ 0,    r = (z₊ + z₋, μ (z₊ − z₋))
//!
//! is a quadratic programme on the edges of the cones, for the active set and the interior point of problems without friction.
//! Where it leaves σ as it was, the law holds. Nothing moves along its tangent in a packing at rest: there σ = 0 does it at once.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175.

use crate::frictional::Layout;
use crate::interior::Interior;
use crate::scaled::Space;
use crate::set::Set;
use cholesky::{Coupling, Factor, Order, Structure};
use contact::{Column, Cone, Packing, RoughDiscs, SetupError, Touch, Vector, Work};
use nalgebra::{Vector2, Vector3};
use std::sync::Arc;

/// The edges of the cones as columns of unit length, two for each contact, one after the other; grains in the order of the factor.
struct Edges {
    structure: Arc<Structure<3>>,
    factor: Option<Factor<3>>,
    layout: Layout<2, 3>,
    /// √(1 + μ²) with the friction of the column: the length of an edge.
    length: Vec<f64>,
    /// σ/√`w_n` (√J).
    sigma: Vec<f64>,
    y: Vec<Vector3<f64>>,
    work: Work,
}

impl Edges {
    /// The impulse of a contact from those of its edges.
    fn impulse(&self, contact: usize, z: &[f64]) -> Vector2<f64> {
        let ([one, other], length) = ([z[2 * contact], z[2 * contact + 1]], self.length[contact]);
        Vector2::new(one + other, self.layout.columns[contact].friction() * (one - other)) / length
    }

    /// Returns the components of a relative velocity along the two edges.
    fn along(&self, contact: usize, v: Vector2<f64>) -> [f64; 2] {
        let tangential = self.layout.columns[contact].friction() * v.y;
        [(v.x + tangential) / self.length[contact], (v.x - tangential) / self.length[contact]]
    }

    /// h̃ of an edge at both grains.
    fn column(&self, edge: usize) -> [Vector3<f64>; 2] {
        let column = &self.layout.columns[edge / 2];
        let sign = if edge.is_multiple_of(2) { 1.0 } else { -1.0 };
        column.pushes(Vector2::new(1.0, sign * column.friction()) / self.length[edge / 2])
    }
}

impl Space for Edges {
    fn contacts(&self) -> usize {
        2 * self.layout.columns.len()
    }

    fn terms_of_b(&self) -> f64 {
        // Two edges.
        2.0 * self.layout.terms_of_b
    }

    fn velocities(&mut self, z: &[f64], v: &mut [f64]) {
        self.work.delassus_products += 1;
        self.y.copy_from_slice(&self.layout.free);
        for k in 0..self.layout.columns.len() {
            let s = self.impulse(k, z);
            self.layout.columns[k].push(s, &mut self.y);
        }
        for k in 0..self.layout.columns.len() {
            let along = self.layout.columns[k].relative(&self.y) + self.layout.offset[k];
            let along = self.along(k, along + Vector2::new(self.sigma[k], 0.0));
            v[2 * k..2 * k + 2].copy_from_slice(&along);
        }
    }

    fn factorise(&mut self, weight: impl Fn(usize) -> f64 + Sync) -> bool {
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += self.structure.work();
        let mut factor = self.factor.take();
        let coupling = |contact: usize| {
            let dyad = |edge: usize| {
                let [first, second] = self.column(edge);
                Coupling::dyad(weight(edge), first, second)
            };
            Some(dyad(2 * contact) + dyad(2 * contact + 1))
        };
        let ones = |_| Vector3::repeat(1.0);
        let done = Factor::replace(&mut factor, &self.structure, ones, coupling);
        self.factor = factor;
        done
    }

    fn solve(&mut self, p: impl Fn(usize) -> f64, mut take: impl FnMut(usize, f64)) {
        self.y.fill(Vector3::zeros());
        let pairs: Vec<f64> = (0..self.contacts()).map(p).collect();
        for k in 0..self.layout.columns.len() {
            let s = self.impulse(k, &pairs);
            self.layout.columns[k].push(s, &mut self.y);
        }
        let Some(factor) = &self.factor else { return };
        factor.solve(&mut self.y);
        self.work.triangular_solve_entries += 2 * factor.entries() as u64;
        for k in 0..self.layout.columns.len() {
            let [one, other] = self.along(k, self.layout.columns[k].relative(&self.y));
            take(2 * k, one);
            take(2 * k + 1, other);
        }
    }
}

/// The fixed point: first the programme with σ = 0, the convex relaxation, then those with the σ that the one before leaves.
pub struct Convex {
    set: Set<Edges>,
    /// √(Σ max(0, −`b_n`)²/`w_n`) (√J).
    scale: f64,
}

/// Sets of one programme that may leave more than one before, or the interior point leads on.
const SETS: u32 = 8;

/// Residual of the interior point, over the problem's scale, where it has come near enough; and where it has come too far to be called
/// nearly solved (–). Where edges depend on each other it ends between the two.
const NEAR: f64 = 1e-10;
const NEARLY: f64 = 1e-3;

/// Level of round-off, over the problem's scale (–).
const ROUND_OFF: f64 = 1e-12;

impl Convex {
    /// Lays the problem out.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub fn new(problem: &Packing<RoughDiscs>) -> Result<Self, SetupError> {
        let ends: Vec<_> = problem.contacts().iter().map(Touch::ends).collect();
        let order = Order::fill_reducing(problem.position(), &ends)?;
        let structure = Structure::new(&ends, &order)?;
        let layout = Layout::placed(problem, |grain| structure.position()[grain as usize]);
        let edges = Edges {
            length: layout.columns.iter().map(|column| column.friction().hypot(1.0)).collect(),
            sigma: vec![0.0; layout.columns.len()],
            y: layout.free.clone(),
            factor: None,
            work: Work::default(),
            structure,
            layout,
        };
        Ok(Self { set: Set::on(edges), scale: problem.scale().sqrt() })
    }

    /// Asks of the next programme that `v_n` be above μ|`v_t`| by a margin at each contact (m/s).
    pub fn ask_for(&mut self, margin: f64) {
        let Edges { sigma, layout, .. } = &mut self.set.scaled;
        for (sigma, unit) in sigma.iter_mut().zip(&layout.unit) {
            *sigma = -margin / unit.x;
        }
    }

    /// Solves the programme for the present σ, from the impulses of the last; then takes σ = μ|`v_t`|. Whether it was solved, or
    /// nearly.
    pub fn advance(&mut self) -> bool {
        let solved = self.sets() || self.interior();
        let edges = &mut self.set.scaled;
        let mut v = vec![0.0; edges.contacts()];
        edges.velocities(&self.set.s, &mut v);
        for k in 0..edges.layout.columns.len() {
            // Along both edges v differs by 2 μ v_t.
            edges.sigma[k] = (0.5 * edges.length[k] * (v[2 * k] - v[2 * k + 1])).abs();
        }
        self.set.measure();
        solved
    }

    /// Sets, as long as they leave less; whether what is left is round-off.
    fn sets(&mut self) -> bool {
        let mut least = f64::INFINITY;
        for _ in 0..SETS {
            let changed = self.set.step();
            let left = self.set.left();
            if self.set.is_solved() || changed == Some(0) && left < ROUND_OFF * self.scale {
                return true;
            }
            if changed.is_none() || changed == Some(0) && !(left < least) {
                break;
            }
            least = least.min(left);
        }
        false
    }

    /// An interior point as near as it comes, and sets from there.
    fn interior(&mut self) -> bool {
        let edges = self.set.lend_factor();
        let mut interior = Interior::new(edges, self.scale);
        let mut best = (interior.left(), interior.s.clone());
        while best.0 > NEAR * self.scale && interior.step(edges) {
            if interior.left() < best.0 {
                best = (interior.left(), interior.s.clone());
            }
        }
        self.set.s.copy_from_slice(&best.1);
        self.set.measure();
        if self.sets() {
            return true;
        }
        self.set.s.copy_from_slice(&best.1);
        self.set.measure();
        best.0 <= NEARLY * self.scale
    }

    /// Work so far.
    pub fn work(&self) -> Work {
        self.set.scaled.work
    }

    /// Impulses in the problem's order (N·s), within the cones.
    pub fn impulses(&self, r: &mut [f64]) {
        let z: Vec<f64> = self.set.s.iter().map(|z| z.max(0.0)).collect();
        for (k, unit) in self.set.scaled.layout.unit.iter().enumerate() {
            self.set.scaled.impulse(k, &z).component_div(unit).put(r, k);
        }
    }
}

#[cfg(test)]
mod tests;
