//! The proof that a problem has no solution: impulses that balance while contacts approach.

mod exact;
mod regular;

pub use exact::{Thrust, proves_exactly};

use contact::{Contact, ContactProblem, Mechanics, RoughDiscs, RoughSpheres, Smooth, law};
use nalgebra::SVector;

/// What impulses that balance leave at any grain, over the sum of their sizes at the grain that is pressed most (–): the
/// round-off of some thousand of them.
const BALANCED: f64 = 1e-12;

/// Whether the impulses `ray` prove that the problem has no solution (lemma of Farkas).
///
/// For d ≥ 0 and any admissible V, that is Hᵗ V + c ≥ 0, dᵗ (Hᵗ V + c) ≥ 0. If H d = 0 and bᵗ d < 0, there is no such V: the
/// impulses d balance at every grain, and on the whole they act against approach, whatever V. The proof is that of impulses near
/// the ray for which this [holds in exact arithmetic](proves_exactly): a lever as fine as round-off is one. It is tried where, in
/// double precision, H d is that of impulses that balance, to 1e-12 of their sizes, and −bᵗ d is above 1e-12 of its terms, of the
/// sizes of `V_i`, `V_j` and c.
pub fn proves_infeasible<const D: usize>(problem: &ContactProblem<Smooth<D>>, ray: &[f64]) -> bool {
    // The proof does not depend on the length of the ray; squares of small numbers would vanish.
    let greatest = ray.iter().copied().fold(0.0, f64::max);
    if !greatest.is_normal() {
        return false;
    }
    let ray: Vec<f64> = ray.iter().map(|d| d / greatest).collect();
    if !ray.iter().all(|d| *d >= 0.0) {
        return false;
    }
    let (grains, free) = (problem.grain_count(), problem.free_velocity());
    let (mut work, mut terms, mut sizes) = (0.0, 0.0, vec![0.0; grains]);
    for (contact, d) in problem.contacts().iter().zip(&ray) {
        work -= d * (contact.relative(free) + contact.offset);
        terms += d * contact.offset.abs();
        for grain in contact.grains() {
            terms += d * free[grain as usize].norm();
            sizes[grain as usize] += d;
        }
    }
    let mut resultant = vec![SVector::zeros(); grains];
    problem.resultant(&ray, &mut resultant);
    let left = resultant.iter().map(nalgebra::Matrix::amax).fold(0.0, f64::max);
    let pressed = sizes.iter().copied().fold(0.0, f64::max);
    left <= BALANCED * pressed && work > BALANCED * terms && {
        let thrust = |(contact, d): (&Contact<D>, &f64)| Thrust::new::<Smooth<D>>(contact, *d);
        proves_exactly(&problem.contacts().iter().zip(&ray).map(thrust).collect::<Vec<_>>())
    }
}

/// Whether one of the `rays`, as it is or balanced, [proves](proves_infeasible) that there is no solution.
pub fn any_proves_infeasible<const D: usize>(problem: &ContactProblem<Smooth<D>>, rays: &[Vec<f64>]) -> bool {
    let proves = |ray: &Vec<f64>| proves_infeasible(problem, ray);
    rays.iter().any(proves) || rays.iter().any(|ray| proves(&balanced(problem, ray)))
}

/// A mechanics in which impulses can prove that a problem has no solution.
pub trait Refutable: Mechanics {
    /// Whether some of the `rays`, or impulses near one, do; `false` says nothing.
    fn any_proves_infeasible(problem: &ContactProblem<Self>, rays: &[Vec<f64>]) -> bool;
}

impl<const D: usize> Refutable for Smooth<D> {
    fn any_proves_infeasible(problem: &ContactProblem<Self>, rays: &[Vec<f64>]) -> bool {
        any_proves_infeasible(problem, rays)
    }
}

/// Where no velocity keeps the contacts from approaching, friction does not help: the normal parts prove it.
impl Refutable for RoughDiscs {
    fn any_proves_infeasible(problem: &ContactProblem<Self>, rays: &[Vec<f64>]) -> bool {
        let normal = |ray: &Vec<f64>| ray.chunks_exact(2).map(|r| law::non_negative(r[0])).collect();
        let rays: Vec<Vec<f64>> = rays.iter().map(normal).collect();
        problem.without_friction().is_ok_and(|problem| any_proves_infeasible(&problem, &rays))
    }
}

/// Likewise.
impl Refutable for RoughSpheres {
    fn any_proves_infeasible(problem: &ContactProblem<Self>, rays: &[Vec<f64>]) -> bool {
        let normal = |ray: &Vec<f64>| ray.chunks_exact(3).map(|r| law::non_negative(r[0])).collect();
        let rays: Vec<Vec<f64>> = rays.iter().map(normal).collect();
        problem.without_friction().is_ok_and(|problem| any_proves_infeasible(&problem, &rays))
    }
}

/// What is left of a ray below this share of it is the round-off of its descent (–).
const LEFT: f64 = 1e-10;

/// Products W p of one descent towards balance, and descents.
const PRODUCTS: u32 = 200;
const DESCENTS: u32 = 3;

/// Impulses near `ray` that balance at every grain, if there are any: what is left of it when ½ dᵗ W d has fallen as far as it
/// can over the contacts with d > 0; those that would pull are let go, and it falls again. So what a method adds to its
/// impulses where there is no solution becomes a proof long before the rest of them is negligible.
fn balanced<const D: usize>(problem: &ContactProblem<Smooth<D>>, ray: &[f64]) -> Vec<f64> {
    let greatest = |d: &[f64]| d.iter().copied().fold(0.0, f64::max);
    let mut d = ray.to_vec();
    for _ in 0..DESCENTS {
        descend(problem, &mut d);
        let pulls = d.iter().any(|d| *d < 0.0);
        for d in &mut d {
            *d = law::non_negative(*d);
        }
        if !pulls {
            break;
        }
    }
    if greatest(&d) < LEFT * greatest(ray) {
        d.fill(0.0);
    }
    d
}

/// Conjugate gradients on ½ dᵗ W d over the contacts with d > 0, preconditioned by W_D.
fn descend<const D: usize>(problem: &ContactProblem<Smooth<D>>, d: &mut [f64]) {
    let diagonal = problem.delassus_diagonal();
    let presses: Vec<bool> = d.iter().map(|d| *d > 0.0).collect();
    let mut scratch = vec![SVector::zeros(); problem.grain_count()];
    let mut product = |p: &[f64], w_p: &mut [f64]| {
        problem.delassus_product(p, w_p, &mut scratch);
        w_p.iter_mut().zip(&presses).filter(|(_, presses)| !**presses).for_each(|(w_p, _)| *w_p = 0.0);
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut g, mut w_p) = (vec![0.0; d.len()], vec![0.0; d.len()]);
    product(d, &mut g);
    let scaled = |g: &[f64]| g.iter().zip(&diagonal).map(|(g, w)| g / w).collect::<Vec<f64>>();
    let mut z = scaled(&g);
    let mut p: Vec<f64> = z.iter().map(|z| -z).collect();
    let least = f64::EPSILON * f64::EPSILON * dot(&g, &z);
    for _ in 0..PRODUCTS {
        product(&p, &mut w_p);
        let (fall, curvature) = (dot(&g, &z), dot(&p, &w_p));
        // What is left is round-off, and a direction that moves no grain has no length.
        if !(curvature > 0.0 && fall > least) {
            return;
        }
        // d ← d + α p,  α = gᵗ z / pᵗ W p;  p ← −z + β p,  β = g⁺ᵗ z⁺ / gᵗ z
        let length = fall / curvature;
        for contact in 0..d.len() {
            d[contact] += length * p[contact];
            g[contact] += length * w_p[contact];
        }
        z = scaled(&g);
        let beta = dot(&g, &z) / fall;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = beta * *p - z);
    }
}

#[cfg(test)]
mod tests;
