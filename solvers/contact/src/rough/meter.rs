//! Measures an iterate of a problem with friction: all is recomputed from its impulses alone, in mass-scaled unknowns, in two passes
//! over the contacts.

use super::{RoughColumn, RoughDiscs};
use crate::adjacency::Adjacency;
use crate::law;
use crate::measure::Measure;
use crate::measures::Measures;
use crate::mechanics::{Column, Mass, Touch, Vector};
use crate::meter::proof::{FAR, exceeds, least, stride};
use crate::meter::{Measuring, ratio};
use crate::problem::ContactProblem;
use crate::truth::Truth;
use nalgebra::{Vector2, Vector3};

/// Measures the iterates of runs on one problem.
pub struct RoughMeter<'p> {
    problem: &'p ContactProblem<RoughDiscs>,
    columns: Vec<RoughColumn>,
    /// √`W_αα` (kg^-½).
    unit: Vec<Vector2<f64>>,
    /// b/√`W_αα` (√J).
    b: Vec<Vector2<f64>>,
    adjacency: Adjacency,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    /// √(Σ b²/`W_αα`) (√J).
    size_of_b: f64,
    /// M^½ (V − `V_free`) of the iterate measured last (√J).
    pushed: Vec<Vector3<f64>>,
    /// s = √`W_αα` r of that iterate (√J).
    s: Vec<Vector2<f64>>,
    /// The natural map of the iterate measured last.
    natural_map: f64,
    solutions: Vec<Solution>,
}

/// A solution that errors are measured with.
struct Solution {
    /// M^½ (V* − `V_free`) (√J).
    pushed: Vec<Vector3<f64>>,
    /// Its size ‖V* − `V_free`‖_M (√J).
    distance: f64,
}

/// What the measures beside the natural map are made of.
#[derive(Default)]
struct Sums {
    natural_map: f64,
    dv: f64,
    wr: f64,
    greatest_dv: f64,
    active: f64,
    rate: f64,
    worst: Option<usize>,
    energy: f64,
}

impl RoughMeter<'_> {
    /// s, and M^½ (V − `V_free`) = H̃ s.
    fn push(&mut self, r: &[f64]) {
        let Self { columns, unit, pushed, s, .. } = self;
        pushed.fill(Vector3::zeros());
        let (r, _) = r.as_chunks::<2>();
        for (((column, unit), r), s) in columns.iter().zip(unit).zip(r).zip(s) {
            *s = Vector2::from(*r).component_mul(unit);
            column.push(*s, pushed);
        }
    }

    /// The natural map of what was pushed last.
    fn natural_map(&mut self) -> f64 {
        let squared = |((column, s), b): ((&RoughColumn, &Vector2<f64>), &Vector2<f64>)| {
            column.residual(*s, column.relative(&self.pushed) + b).norm_squared()
        };
        let sum: f64 = self.columns.iter().zip(&self.s).zip(&self.b).map(squared).sum();
        self.natural_map = ratio(sum.sqrt(), self.scale.sqrt());
        self.natural_map
    }

    /// All sums over the contacts of what was pushed last.
    fn sums(&self) -> Sums {
        let mut sums = Sums::default();
        for (k, ((column, s), (b, unit))) in
            self.columns.iter().zip(&self.s).zip(self.b.iter().zip(&self.unit)).enumerate()
        {
            let v = column.relative(&self.pushed) + b;
            let left = column.residual(*s, v);
            sums.natural_map += left.norm_squared();
            // DV = W_αα (r⁺ − r) and WR = W_αα r, in m/s.
            let (dv, wr) = (left.component_mul(unit), s.component_mul(unit));
            let wr_plus = wr - dv;
            sums.dv += dv.norm_squared();
            sums.wr += 0.5 * (wr.norm_squared() + wr_plus.norm_squared());
            sums.greatest_dv = law::greatest([sums.greatest_dv, dv.norm()].into_iter());
            sums.active += f64::from(u8::from(wr.x + wr_plus.x > 0.0));
            sums.energy += 0.5 * s.dot(&(v + b));
            let rate = -v.x * unit.x;
            if !(rate <= sums.rate) && !sums.rate.is_nan() {
                (sums.rate, sums.worst) = (rate, Some(k));
            }
        }
        sums
    }

    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M of the nearest solution, of what was pushed last; NaN if none is known.
    fn velocity_error(&self) -> f64 {
        let error = |solution: &Solution| {
            let pairs = self.pushed.iter().zip(&solution.pushed);
            let sum: f64 = pairs.map(|(y, known)| (y - known).norm_squared()).sum();
            ratio(sum.sqrt(), solution.distance)
        };
        self.solutions.iter().map(error).reduce(f64::min).unwrap_or(f64::NAN)
    }

    /// The natural map's term of a contact whose grains are looked at alone (J).
    fn alone(&self, k: usize, r: &[f64]) -> f64 {
        let s = |k: usize| Vector2::at(r, k).component_mul(&self.unit[k]);
        let column = &self.columns[k];
        let [i, j] = column.places();
        let pushed = |grain: u32| -> Vector3<f64> {
            let around = self.adjacency.around(grain as usize).iter();
            around.map(|k| self.columns[*k as usize].push_at(grain, s(*k as usize))).sum()
        };
        let y = [pushed(i), if i == j { Vector3::zeros() } else { pushed(j) }];
        column.residual(s(k), column.between(y) + self.b[k]).norm_squared()
    }

    /// No |q(r)|, and no natural map's sum, is above this (J): λmax(W_D⁻¹ W) is at most its trace.
    fn energy_at_most(&self, r: &[f64]) -> f64 {
        let (pairs, _) = r.as_chunks::<2>();
        let squared: f64 = pairs
            .iter()
            .zip(&self.unit)
            .map(|(r, unit)| Vector2::from(*r).component_mul(unit).norm_squared())
            .sum();
        let s = r.len() as f64 * squared.sqrt() + self.size_of_b;
        2.0 * s * s
    }
}

impl<'p> Measuring<'p, RoughDiscs> for RoughMeter<'p> {
    fn new(problem: &'p ContactProblem<RoughDiscs>) -> Self {
        let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
        let column = |contact| RoughColumn::new(contact, Touch::ends(contact), inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<Vector2<f64>>) = problem.contacts().iter().map(column).unzip();
        let b = problem.b();
        let b: Vec<Vector2<f64>> =
            unit.iter().enumerate().map(|(k, unit)| Vector2::at(&b, k).component_div(unit)).collect();
        Self {
            problem,
            adjacency: Adjacency::of(problem),
            scale: problem.scale(),
            size_of_b: b.iter().map(Vector2::norm_squared).sum::<f64>().sqrt(),
            pushed: vec![Vector3::zeros(); problem.grain_count()],
            s: vec![Vector2::zeros(); columns.len()],
            natural_map: f64::INFINITY,
            solutions: Vec::new(),
            columns,
            unit,
            b,
        }
    }

    fn against(mut self, truth: &Truth<RoughDiscs>) -> Self {
        let (problem, velocity) = (self.problem, truth.velocity());
        assert_eq!(velocity.len(), problem.grain_count(), "one true velocity per grain");
        let scaled = |((v, free), mass): ((&Vector3<f64>, &Vector3<f64>), &super::RoughMass)| {
            mass.root().times(v - free)
        };
        self.solutions.push(Solution {
            pushed: velocity.iter().zip(problem.free_velocity()).zip(problem.mass()).map(scaled).collect(),
            distance: problem.velocity_distance(problem.free_velocity(), velocity),
        });
        self
    }

    fn scale(&self) -> f64 {
        self.scale
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        self.push(r);
        let sums = self.sums();
        self.natural_map = ratio(sums.natural_map.sqrt(), self.scale.sqrt());
        Measures {
            zeta: zeta(before, r),
            natural_map: self.natural_map,
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
                    let contacts = self.columns.len();
                    let bound = least(tolerance, self.scale);
                    self.natural_map > FAR * tolerance
                        && exceeds(contacts, stride(contacts), bound, |k| self.alone(k, r))
                        || {
                            self.push(r);
                            self.natural_map() > tolerance
                        }
                }
                Measure::VelocityError => {
                    self.push(r);
                    self.velocity_error() > tolerance
                }
                Measure::Zeta => !(zeta(before, r) <= tolerance),
                Measure::PenetrationRate | Measure::QuadDv | Measure::MaxDv => false,
            }
    }
}

/// √(|r − before|²/(rᵗ before)); NaN from r = 0.
fn zeta(before: &[f64], r: &[f64]) -> f64 {
    let pairs = || before.iter().zip(r);
    let product: f64 = pairs().map(|(before, r)| r * before).sum();
    let change: f64 = pairs().map(|(before, r)| (r - before) * (r - before)).sum();
    if product > 0.0 { (change / product).sqrt() } else { f64::NAN }
}
