//! The loop on a problem that is W alone.

use crate::judge::Judge;
use crate::{Measured, Outcome, Progress, Stop, moving_share, run};
use contact::sums::Sums;
use contact::{ContactProblem, Discs, Measure, Measures, SetupError, law, ratio};
use local::{LocalProblem, Method};
use std::ops::ControlFlow;
use std::time::Instant;

/// A solution of a problem of W alone, which iterates are compared with.
#[derive(Clone, Debug)]
pub struct LocalTruth {
    /// r* (N·s).
    r: Vec<f64>,
    /// v* = W r* + q (m/s).
    v: Vec<f64>,
    /// r*ᵗ W r* (J).
    squared: f64,
    /// q(r*) (J).
    energy: f64,
}

impl LocalTruth {
    /// Returns the known solution with impulses r* (N·s); that they solve the problem is for others to say.
    pub fn new(problem: &LocalProblem, r: Vec<f64>) -> Self {
        let v = problem.velocity(&r);
        let squared = r.iter().zip(&v).zip(problem.q()).map(|((r, v), q)| r * (v - q)).sum();
        Self { energy: energy(problem, &r, &v), squared, r, v }
    }

    /// ‖r − r*‖_W / ‖r*‖_W (–), which is the velocity error of grains whose W it is.
    fn velocity_error(&self, r: &[f64], v: &[f64]) -> f64 {
        let apart = |k: usize| (r[k] - self.r[k]) * (v[k] - self.v[k]);
        // Round-off may leave less than nothing.
        ratio((0..r.len()).map(apart).sum::<f64>().max(0.0), self.squared).sqrt()
    }
}

/// q(r) (J).
fn energy(problem: &LocalProblem, r: &[f64], v: &[f64]) -> f64 {
    ContactProblem::<Discs>::energy(r, v, problem.q())
}

/// Judges by W.
struct OnW<'p> {
    problem: &'p LocalProblem,
    scale: f64,
    truth: Option<&'p LocalTruth>,
}

impl Judge for OnW<'_> {
    fn scale(&self) -> f64 {
        self.scale
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        let v = self.problem.velocity(r);
        let left = self.problem.left(r, &v);
        let energy = energy(self.problem, r, &v);
        let mut sums = Sums::of_change(before, r);
        sums.natural_map = left * left;
        sums.energy_twice = 2.0 * energy;
        sums.velocity_jump = velocity_jump;
        // Those of LMGC90 are for grains.
        (sums.dv, sums.greatest_dv) = (f64::NAN, f64::NAN);
        for (contact, v) in v.chunks(self.problem.dimension()).enumerate() {
            sums.take_rate(law::non_negative(-v[0]), Some(contact));
        }
        Measures {
            velocity_error: self.truth.map_or(f64::NAN, |truth| truth.velocity_error(r, &v)),
            energy_gap: self.truth.map_or(f64::NAN, |truth| (energy - truth.energy) / truth.energy.abs()),
            ..sums.measures(self.scale)
        }
    }

    fn goes_on(&mut self, on: Measure, tolerance: f64, _: f64, (_, r): (&[f64], &[f64])) -> bool {
        on == Measure::NaturalMap && self.problem.is_above(tolerance, r)
    }

    /// None is looked for: a direction that W does not feel may yet be blocked by the law along the tangents.
    fn any_proves_infeasible(&self, _: &[Vec<f64>]) -> bool {
        false
    }

    fn greatest_rate(&self) -> f64 {
        let q = self.problem.q().iter().step_by(self.problem.dimension());
        q.fold(0.0, |rate: f64, q| rate.max(-q))
    }

    fn has_one_velocity(&self) -> bool {
        self.problem.friction().iter().all(|mu| *mu == 0.0)
    }

    fn any(&self, here: bool) -> bool {
        here
    }
}

/// Runs `method` on a problem of W alone from r = 0 until `stop`, beside a solution if one is known; as of other runs, the observer
/// sees every iterate.
///
/// # Errors
/// Names the setting or the stop rule that has no meaning: of the measures, LMGC90's two are for grains.
pub fn solve_local(
    truth: Option<&LocalTruth>,
    method: Method,
    problem: &LocalProblem,
    stop: &Stop,
    measured: Measured,
    observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Outcome, SetupError> {
    stop.check()?;
    let is_known = match stop.on {
        Measure::QuadDv | Measure::MaxDv => false,
        Measure::VelocityError => truth.is_some(),
        Measure::Zeta | Measure::NaturalMap | Measure::PenetrationRate => true,
    };
    let expected = "a measure that is known where there is W alone";
    SetupError::unless(is_known, "on", stop.on, expected)?;
    let clock = Instant::now();
    let mut iteration = method.start(problem)?;
    let setup = clock.elapsed();
    let mut judge = OnW { problem, scale: problem.scale(), truth };
    let r0 = vec![0.0; problem.q().len()];
    let (end, before) = run(&mut judge, &mut *iteration, r0, stop, measured, observe);
    let product = |d: &[f64]| problem.delassus_product(d);
    let last_change_moves = moving_share(&before, &end.impulses, &problem.diagonal(), product);
    Ok(Outcome { setup, last_change_moves, ..end })
}
