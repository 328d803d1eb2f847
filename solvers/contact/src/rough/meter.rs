//! Measures an iterate of a problem with friction: all is recomputed from its impulses alone, as without friction, in one loop.

use super::{RoughContact, RoughDiscs};
use crate::adjacency::Adjacency;
use crate::law;
use crate::measure::Measure;
use crate::measures::Measures;
use crate::mechanics::{Mass, Touch, Vector};
use crate::meter::proof::{exceeds, least, stride};
use crate::meter::{Measuring, ratio};
use crate::problem::ContactProblem;
use crate::truth::Truth;
use nalgebra::{Vector2, Vector3};

/// Measures the iterates of runs on one problem.
pub struct RoughMeter<'p> {
    problem: &'p ContactProblem<RoughDiscs>,
    adjacency: Adjacency,
    /// `W_αα` (1/kg).
    diagonal: Vec<Vector2<f64>>,
    b: Vec<Vector2<f64>>,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    /// √(Σ b²/`W_αα`) (√J).
    size_of_b: f64,
    /// V − `V_free` of the iterate measured last (m/s, rad/s).
    pushed: Vec<Vector3<f64>>,
    solutions: Vec<Solution>,
}

/// A solution that errors are measured with.
struct Solution {
    /// V* − `V_free` (m/s, rad/s).
    pushed: Vec<Vector3<f64>>,
    /// Its size ‖V* − `V_free`‖_M (√J).
    distance: f64,
}

/// What the measures are made of.
#[derive(Default)]
struct Sums {
    change: f64,
    product: f64,
    natural_map: f64,
    dv: f64,
    wr: f64,
    greatest_dv: f64,
    active: f64,
    rate: f64,
    worst: Option<usize>,
    energy: f64,
}

/// `W_αα` (r − r⁺) of both unknowns (m/s), in the form that does not cancel where r is large.
fn residual(contact: &RoughContact, r: Vector2<f64>, v: Vector2<f64>, w: Vector2<f64>) -> Vector2<f64> {
    let pressed = w.x * r.x;
    let normal = if v.x >= pressed { pressed } else { v.x };
    // r_t − clip(r_t − v_t/w_t, μ r_n): between what leads to either bound.
    let bound = contact.friction * law::non_negative(r.x);
    let (to_upper, to_lower) = (w.y * (r.y - bound), w.y * (r.y + bound));
    let tangential = if v.y < to_upper {
        to_upper
    } else if v.y > to_lower {
        to_lower
    } else {
        v.y
    };
    Vector2::new(normal, tangential)
}

impl RoughMeter<'_> {
    /// The sums over all contacts of the iterate `r`, from the velocities that it gives to the grains.
    fn sums(&mut self, before: &[f64], r: &[f64]) -> Sums {
        let Self { problem, diagonal, b, pushed, .. } = self;
        problem.resultant(r, pushed);
        pushed.iter_mut().zip(problem.mass()).for_each(|(v, mass)| *v = mass.divides(*v));
        let mut sums = Sums::default();
        for (k, contact) in problem.contacts().iter().enumerate() {
            let (r, w, b) = (Vector2::at(r, k), diagonal[k], b[k]);
            let v = Touch::relative(contact, pushed) + b;
            let dv = residual(contact, r, v, w);
            let (wr, wr_plus) = (w.component_mul(&r), w.component_mul(&r) - dv);
            sums.natural_map += dv.component_div(&w).dot(&dv);
            sums.dv += dv.norm_squared();
            sums.wr += 0.5 * (wr.norm_squared() + wr_plus.norm_squared());
            sums.greatest_dv = law::greatest([sums.greatest_dv, dv.norm()].into_iter());
            sums.active += f64::from(u8::from(wr.x + wr_plus.x > 0.0));
            sums.energy += 0.5 * r.dot(&(v + b));
            if !(-v.x <= sums.rate) && !sums.rate.is_nan() {
                (sums.rate, sums.worst) = (-v.x, Some(k));
            }
        }
        for (before, r) in before.iter().zip(r) {
            sums.change += (r - before) * (r - before);
            sums.product += r * before;
        }
        sums
    }

    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M of the nearest solution; NaN if none is known.
    fn velocity_error(&self) -> f64 {
        let error = |solution: &Solution| {
            let squared = |((v, known), mass): ((&Vector3<f64>, &Vector3<f64>), &super::RoughMass)| {
                mass.squared(v - known)
            };
            let sum: f64 =
                self.pushed.iter().zip(&solution.pushed).zip(self.problem.mass()).map(squared).sum();
            ratio(sum.sqrt(), solution.distance)
        };
        self.solutions.iter().map(error).reduce(f64::min).unwrap_or(f64::NAN)
    }

    /// The natural map's term of a contact whose grains are looked at alone (J).
    fn alone(&self, k: usize, r: &[f64]) -> f64 {
        let contact = &self.problem.contacts()[k];
        let pushed = |grain: u32| {
            let push = |k: &u32| {
                let k = *k as usize;
                let around = &self.problem.contacts()[k];
                around.at_ends(Vector2::at(r, k))[usize::from(around.candidate != grain)]
            };
            let resultant = self.adjacency.around(grain as usize).iter().map(push).sum();
            self.problem.mass()[grain as usize].divides(resultant)
        };
        let i = pushed(contact.candidate);
        let v = contact.between(i, contact.antagonist.map(pushed)) + self.b[k];
        let (r, w) = (Vector2::at(r, k), self.diagonal[k]);
        let dv = residual(contact, r, v, w);
        dv.component_div(&w).dot(&dv)
    }

    /// No |q(r)|, and no natural map's sum, is above this (J): λmax(W_D⁻¹ W) is at most its trace.
    fn energy_at_most(&self, r: &[f64]) -> f64 {
        let squared: f64 = self
            .diagonal
            .iter()
            .enumerate()
            .map(|(k, w)| Vector2::at(r, k).component_mul(w).dot(&Vector2::at(r, k)))
            .sum();
        let s = r.len() as f64 * squared.sqrt() + self.size_of_b;
        2.0 * s * s
    }
}

impl<'p> Measuring<'p, RoughDiscs> for RoughMeter<'p> {
    fn new(problem: &'p ContactProblem<RoughDiscs>) -> Self {
        let pairs =
            |list: &[f64]| (0..problem.contact_count()).map(|k| Vector2::at(list, k)).collect::<Vec<_>>();
        let (diagonal, b) = (pairs(&problem.delassus_diagonal()), pairs(&problem.b()));
        let size: f64 = b.iter().zip(&diagonal).map(|(b, w)| b.component_div(w).dot(b)).sum();
        Self {
            problem,
            adjacency: Adjacency::of(problem),
            scale: problem.scale(),
            size_of_b: size.sqrt(),
            pushed: vec![Vector3::zeros(); problem.grain_count()],
            solutions: Vec::new(),
            diagonal,
            b,
        }
    }

    fn against(mut self, truth: &Truth<RoughDiscs>) -> Self {
        let (problem, velocity) = (self.problem, truth.velocity());
        assert_eq!(velocity.len(), problem.grain_count(), "one true velocity per grain");
        self.solutions.push(Solution {
            pushed: velocity.iter().zip(problem.free_velocity()).map(|(v, free)| v - free).collect(),
            distance: problem.velocity_distance(problem.free_velocity(), velocity),
        });
        self
    }

    fn scale(&self) -> f64 {
        self.scale
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        let sums = self.sums(before, r);
        Measures {
            zeta: if sums.product > 0.0 { (sums.change / sums.product).sqrt() } else { f64::NAN },
            natural_map: ratio(sums.natural_map.sqrt(), self.scale.sqrt()),
            penetration_rate: sums.rate,
            worst_contact: sums.worst,
            quad_dv: ratio(sums.dv.sqrt(), sums.wr.sqrt()),
            max_dv: ratio(sums.greatest_dv, (sums.wr / sums.active.max(1.0)).sqrt()),
            velocity_error: self.velocity_error(),
            energy_gap: f64::NAN,
            velocity_jump,
            energy: sums.energy,
        }
    }

    fn goes_on(&mut self, on: Measure, tolerance: f64, energy: f64, (before, r): (&[f64], &[f64])) -> bool {
        self.energy_at_most(r) <= energy.min(f64::MAX)
            && match on {
                Measure::NaturalMap => {
                    let contacts = self.problem.contact_count();
                    exceeds(contacts, stride(contacts), least(tolerance, self.scale), |k| self.alone(k, r))
                        || ratio(self.sums(&[], r).natural_map.sqrt(), self.scale.sqrt()) > tolerance
                }
                Measure::VelocityError => {
                    self.sums(&[], r);
                    self.velocity_error() > tolerance
                }
                Measure::Zeta => {
                    let pairs = || before.iter().zip(r);
                    let product: f64 = pairs().map(|(before, r)| r * before).sum();
                    let change: f64 = pairs().map(|(before, r)| (r - before) * (r - before)).sum();
                    !((change / product).sqrt() <= tolerance) || product <= 0.0
                }
                Measure::PenetrationRate | Measure::QuadDv | Measure::MaxDv => false,
            }
    }
}
