//! Measures an iterate of a problem with friction: all is recomputed from its impulses alone, in mass-scaled unknowns, in two passes
//! over the contacts.

use super::{RoughColumn, RoughDiscs};
use crate::adjacency::Adjacency;
use crate::law;
use crate::measure::Measure;
use crate::measures::Measures;
use crate::mechanics::{Column, Mass, Mechanics, Touch, Vector};
use crate::meter::proof::{FAR, exceeds, least, stride};
use crate::meter::{Measuring, ratio};
use crate::problem::ContactProblem;
use crate::truth::Truth;
use nalgebra::{Vector2, Vector3};

/// A mechanics with Coulomb's law.
pub trait Rubbing: Mechanics {
    /// The places of candidate and antagonist; at a wall twice that of the candidate.
    fn places(column: &Self::Column) -> [u32; 2];

    /// H̃ᵗ y of the y of candidate and antagonist; the latter counts for nothing at a wall.
    fn between(column: &Self::Column, ends: [Self::Velocity; 2]) -> Self::Impulse;

    /// Returns the velocity change of one of its grains under an impulse s.
    fn push_at(column: &Self::Column, grain: u32, s: Self::Impulse) -> Self::Velocity;
}

/// Measures the iterates of runs on one problem.
pub struct RoughMeter<'p, M: Rubbing = RoughDiscs> {
    problem: &'p ContactProblem<M>,
    columns: Vec<M::Column>,
    /// √`W_αα` (kg^-½).
    unit: Vec<M::Impulse>,
    /// b/√`W_αα` (√J).
    b: Vec<M::Impulse>,
    adjacency: Adjacency,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    /// √(Σ b²/`W_αα`) (√J).
    size_of_b: f64,
    /// M^½ (V − `V_free`) of the iterate measured last (√J).
    pushed: Vec<M::Velocity>,
    /// s = √`W_αα` r of that iterate (√J).
    s: Vec<M::Impulse>,
    /// The natural map of the iterate measured last.
    natural_map: f64,
    solutions: Vec<Solution<M::Velocity>>,
}

/// A solution that errors are measured with.
struct Solution<V> {
    /// M^½ (V* − `V_free`) (√J).
    pushed: Vec<V>,
    /// Its size ‖V* − `V_free`‖_M (√J).
    distance: f64,
}

/// Sums that the measures beside the natural map are computed from.
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

impl Rubbing for RoughDiscs {
    fn places(column: &RoughColumn) -> [u32; 2] {
        column.places()
    }

    #[inline]
    fn between(column: &RoughColumn, ends: [Vector3<f64>; 2]) -> Vector2<f64> {
        column.between(ends)
    }

    fn push_at(column: &RoughColumn, grain: u32, s: Vector2<f64>) -> Vector3<f64> {
        column.push_at(grain, s)
    }
}

/// Component by component.
#[inline]
fn times<V: Vector>(a: V, b: V) -> V {
    a.with(b, |a, b| a * b)
}

impl<M: Rubbing> RoughMeter<'_, M> {
    /// s, and M^½ (V − `V_free`) = H̃ s.
    fn push(&mut self, r: &[f64]) {
        let Self { columns, unit, pushed, s, .. } = self;
        pushed.fill(M::Velocity::ZERO);
        for (k, ((column, unit), s)) in columns.iter().zip(unit).zip(s).enumerate() {
            *s = times(M::Impulse::at(r, k), *unit);
            column.push(*s, pushed);
        }
    }

    /// The natural map of what was pushed last.
    fn natural_map(&mut self) -> f64 {
        let squared = |((column, s), b): ((&M::Column, &M::Impulse), &M::Impulse)| {
            let left = column.residual(*s, column.relative(&self.pushed) + *b);
            left.dot_product(left)
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
            let v = column.relative(&self.pushed) + *b;
            let left = column.residual(*s, v);
            sums.natural_map += left.dot_product(left);
            // DV = W_αα (r⁺ − r) and WR = W_αα r, in m/s.
            let (dv, wr) = (times(left, *unit), times(*s, *unit));
            let (wr_plus, squared_dv) = (wr - dv, dv.dot_product(dv));
            sums.dv += squared_dv;
            sums.wr += 0.5 * (wr.dot_product(wr) + wr_plus.dot_product(wr_plus));
            sums.greatest_dv = law::greatest([sums.greatest_dv, squared_dv.sqrt()].into_iter());
            sums.active += f64::from(u8::from(wr.first() + wr_plus.first() > 0.0));
            sums.energy += 0.5 * s.dot_product(v + *b);
            let rate = -v.first() * unit.first();
            if !(rate <= sums.rate) && !sums.rate.is_nan() {
                (sums.rate, sums.worst) = (rate, Some(k));
            }
        }
        sums
    }

    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M of the nearest solution, of what was pushed last; NaN if none is known.
    fn velocity_error(&self) -> f64 {
        let error = |solution: &Solution<M::Velocity>| {
            let pairs = self.pushed.iter().zip(&solution.pushed);
            let apart = |(y, known): (&M::Velocity, &M::Velocity)| (*y - *known).dot_product(*y - *known);
            let sum: f64 = pairs.map(apart).sum();
            ratio(sum.sqrt(), solution.distance)
        };
        self.solutions.iter().map(error).reduce(f64::min).unwrap_or(f64::NAN)
    }

    /// The natural map's term of a contact whose grains are looked at alone (J).
    fn alone(&self, k: usize, r: &[f64]) -> f64 {
        let s = |k: usize| times(M::Impulse::at(r, k), self.unit[k]);
        let column = &self.columns[k];
        let [i, j] = M::places(column);
        let pushed = |grain: u32| -> M::Velocity {
            let around = self.adjacency.around(grain as usize).iter();
            around.map(|k| M::push_at(&self.columns[*k as usize], grain, s(*k as usize))).sum()
        };
        let y = [pushed(i), if i == j { M::Velocity::ZERO } else { pushed(j) }];
        let left = column.residual(s(k), M::between(column, y) + self.b[k]);
        left.dot_product(left)
    }

    /// No |q(r)|, and no natural map's sum, is above this (J): λmax(W_D⁻¹ W) is at most its trace.
    fn energy_at_most(&self, r: &[f64]) -> f64 {
        let squared = |(k, unit): (usize, &M::Impulse)| {
            let s = times(M::Impulse::at(r, k), *unit);
            s.dot_product(s)
        };
        let squared: f64 = self.unit.iter().enumerate().map(squared).sum();
        let s = r.len() as f64 * squared.sqrt() + self.size_of_b;
        2.0 * s * s
    }
}

impl<'p, M: Rubbing> Measuring<'p, M> for RoughMeter<'p, M> {
    fn new(problem: &'p ContactProblem<M>) -> Self {
        let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
        let column = |contact: &M::Contact| M::Column::new(contact, contact.ends(), inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<M::Impulse>) = problem.contacts().iter().map(column).unzip();
        let b = problem.b();
        let of = |(k, unit): (usize, &M::Impulse)| M::Impulse::at(&b, k).with(*unit, |b, unit| b / unit);
        let b: Vec<M::Impulse> = unit.iter().enumerate().map(of).collect();
        Self {
            problem,
            adjacency: Adjacency::of(problem),
            scale: problem.scale(),
            size_of_b: b.iter().map(|b| b.dot_product(*b)).sum::<f64>().sqrt(),
            pushed: vec![M::Velocity::ZERO; problem.grain_count()],
            s: vec![M::Impulse::ZERO; columns.len()],
            natural_map: f64::INFINITY,
            solutions: Vec::new(),
            columns,
            unit,
            b,
        }
    }

    fn against(mut self, truth: &Truth<M>) -> Self {
        let (problem, velocity) = (self.problem, truth.velocity());
        assert_eq!(velocity.len(), problem.grain_count(), "one true velocity per grain");
        let scaled =
            |((v, free), mass): ((&M::Velocity, &M::Velocity), &M::Mass)| mass.root().times(*v - *free);
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

/// ζ = √(|r − before|²/(rᵗ before)) (–) of two iterates; NaN from r = 0, or from none.
pub fn zeta(before: &[f64], r: &[f64]) -> f64 {
    let pairs = || before.iter().zip(r);
    let product: f64 = pairs().map(|(before, r)| r * before).sum();
    let change: f64 = pairs().map(|(before, r)| (r - before) * (r - before)).sum();
    if product > 0.0 { (change / product).sqrt() } else { f64::NAN }
}
