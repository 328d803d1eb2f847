//! With friction: the stages that lead to where Newton's method ends, one after the other.
//!
//! Nothing is minimised, and no method is known that always leads to that neighbourhood. Accelerated sweeps of Gauss-Seidel come first.
//! Where their residual reaches the accuracy of the start, or a tenth of that of the last try, Newton's method is tried, and sweeps
//! resume where it stalls; a factor that takes longer than sweeps may stall waits until they have had its time since then, or stall.
//! Where sweeps stall, proximal points follow from the best impulses. An interior point, which begins far away and mostly comes near at
//! rest, has its turn once they have taken the time that it takes; points resume from what it finds, if that leaves a tenth of theirs: on small
//! packings and from a warm start they lead on by themselves. Where they stall too, that is the floor, and the end. Where factors do not
//! fit in memory, sweeps are the only stage.

mod exact;
mod matrix;
mod newton;
mod path;
mod points;
mod whole;

use crate::conic::Conic;
use crate::start::{ACCURACY_OF_DEARER, LOOK, RUNG, STEPS, Start, accelerated};
use crate::{ActiveSet, Best};
use contact::{Frictional, Iteration, Packing, Rough, RoughDiscs, RoughSpheres, SetupError, Solver, Work};
use exact::Exact;
use nalgebra::SVector;
use newton::{Newton, Step};
use points::{Approach, PointSolver, Points};
use whole::Whole;

/// Sweeps in which the residual must be halved, or the next stage follows.
const PATIENCE: u64 = 1000;

/// Steps towards proximal points after which an interior point has its turn: they take as long as its own.
const TURN: u32 = STEPS as u32;

/// Largest residual of the law at an end where no step reduces it, over the problem's scale (–): else it is no end.
const ROUND_OFF: f64 = 1e-12;

/// Phase of an iteration.
#[derive(Clone, Copy)]
enum Phase {
    /// Accelerated sweeps.
    Sweeps,
    /// An interior point.
    Interior,
    /// Proximal points.
    Proximal,
    /// Newton's method.
    Newton,
    /// No further iteration helps.
    Ended,
}

struct Run<'p, P, const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Accelerated sweeps, and how many.
    sweeps: Box<dyn Iteration + 'p>,
    swept: u64,
    /// Sweeps after which a factor may be made, once the time that it takes is known: it waits until sweeps have had as much.
    due: Option<u64>,
    /// Residual of the sweeps when it was last halved (√J), and after how many of them.
    halved: (f64, u64),
    newton: Newton<D, N>,
    problem: &'p Packing<Rough<D>>,
    /// Interior point on Coulomb's law, once it has begun.
    interior: Option<Conic<D, N>>,
    /// Proximal points, once sweeps have stalled.
    points: Option<Points<P, D, N>>,
    /// Steps towards them.
    approached: u32,
    phase: Phase,
    /// Next residual threshold (√J).
    rung: f64,
    /// √(Σ max(0, −b)²/`W_αα`) (√J).
    scale: f64,
    best: Best,
}

impl<P: PointSolver<D, N>, const D: usize, const N: usize> Run<'_, P, D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// One sweep, and at times a look at what it leaves.
    fn sweep(&mut self) {
        self.sweeps.advance();
        self.swept += 1;
        if !self.swept.is_multiple_of(LOOK) {
            return;
        }
        let mut r = vec![0.0; self.best.impulses.len()];
        self.sweeps.impulses(&mut r);
        let left = self.newton.left_by(&r);
        if left <= 0.5 * self.halved.0 {
            self.halved = (left, self.swept);
        }
        self.best.take(left, |best| best.copy_from_slice(&r));
        let has_stalled = self.swept >= self.halved.1 + PATIENCE;
        if left <= self.rung && (has_stalled || self.is_due()) {
            self.best = Best { left, impulses: r };
            self.try_newton();
        } else if has_stalled || !left.is_finite() {
            self.begin_points();
        }
    }

    /// An interior point on the law itself.
    fn begin_interior(&mut self) -> Result<(), SetupError> {
        self.interior = Some(Conic::coulomb(self.problem, self.newton.structure()?)?);
        self.phase = Phase::Interior;
        Ok(())
    }

    /// One step of the interior point, from the end of which points follow, or sweeps, if there were none.
    fn interior(&mut self) {
        let Some(interior) = &mut self.interior else { return };
        if interior.step() {
            return;
        }
        let mut r = vec![0.0; self.best.impulses.len()];
        interior.impulses(&mut r);
        let left = self.newton.left_by(&r);
        let is_nearer = left <= RUNG * self.best.left;
        if is_nearer {
            self.best = Best { left, impulses: r };
        }
        if self.points.is_none() {
            if is_nearer { self.try_newton() } else { self.phase = Phase::Sweeps }
        } else if is_nearer {
            self.begin_points();
        } else {
            self.phase = Phase::Proximal;
        }
    }

    /// Reports whether sweeps have had the time of a factor since the last try of Newton's method, if that is longer than they may stall.
    fn is_due(&mut self) -> bool {
        let due = self.due.unwrap_or_else(|| self.wait());
        self.due = Some(due);
        self.swept >= due
    }

    /// Returns the number of sweeps that Newton's method waits for.
    fn wait(&mut self) -> u64 {
        self.newton.sweeps_of_factor().filter(|sweeps| *sweeps > PATIENCE).unwrap_or(0)
    }

    /// Proximal points from the best impulses; none, where factors do not fit in memory.
    fn begin_points(&mut self) {
        if self.newton.prepare().is_ok() {
            self.points = Some(Points::new(&self.newton, &self.best));
            self.phase = Phase::Proximal;
        }
    }

    /// One proximal point, or a step towards it.
    fn proximal(&mut self) {
        let Some(points) = &mut self.points else { return };
        match points.advance(&mut self.newton, &mut self.best, ROUND_OFF * self.scale) {
            Approach::On => {
                self.approached += 1;
                // Where it does not fit in memory, points go on.
                if self.interior.is_none() && self.approached == TURN {
                    self.begin_interior().unwrap_or_default();
                }
            }
            Approach::Nearly => self.try_newton(),
            Approach::InVain => self.phase = Phase::Ended,
        }
    }

    /// Newton's method from the best impulses.
    fn try_newton(&mut self) {
        self.rung = RUNG * self.rung.min(self.best.left);
        if self.newton.prepare().is_ok() {
            self.best.left = self.newton.begin(&self.best.impulses);
            self.phase = Phase::Newton;
        }
    }

    /// One step of Newton's method. Where it stalls, sweeps resume at once: an iterate that stays would look like one that needs no
    /// change.
    fn newton_step(&mut self) {
        self.phase = match self.newton.advance(&mut self.best) {
            Step::Solved => Phase::Ended,
            Step::On => Phase::Newton,
            Step::InVain if self.points.is_some() || self.best.left <= ROUND_OFF * self.scale => Phase::Ended,
            Step::InVain => {
                self.due = Some(self.swept + self.wait());
                self.phase = Phase::Sweeps;
                return self.sweep();
            }
        };
    }
}

impl<P: PointSolver<D, N>, const D: usize, const N: usize> Iteration for Run<'_, P, D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    fn advance(&mut self) {
        match self.phase {
            Phase::Sweeps => self.sweep(),
            Phase::Interior => self.interior(),
            Phase::Proximal => self.proximal(),
            Phase::Newton => self.newton_step(),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match (self.phase, &self.interior) {
            (Phase::Sweeps, _) => self.sweeps.impulses(r),
            (Phase::Interior, Some(interior)) if self.points.is_none() => interior.impulses(r),
            _ => r.copy_from_slice(&self.best.impulses),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.sweeps.work();
        work += self.newton.work();
        self.interior.iter().for_each(|interior| work += interior.work());
        work
    }
}

impl ActiveSet {
    /// A run with friction from the impulses `r0` (N·s).
    fn with_friction<'p, P: PointSolver<D, N> + 'static, const D: usize, const N: usize>(
        &self,
        problem: &'p Packing<Rough<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError>
    where
        Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
    {
        let accuracy = self.accuracy(ACCURACY_OF_DEARER)?;
        let expected = "sweeps, interior-point or cold-set: cg is for problems without friction";
        SetupError::unless(self.start != Some(Start::Cg), "start", "cg", expected)?;
        let (newton, scale) = (Newton::new(problem), problem.scale().sqrt());
        let left = newton.left_by(r0);
        let mut run: Run<P, D, N> = Run {
            sweeps: accelerated(problem, r0)?,
            swept: 0,
            due: None,
            halved: (f64::INFINITY, 0),
            newton,
            problem,
            interior: None,
            points: None,
            approached: 0,
            phase: Phase::Sweeps,
            rung: accuracy * scale,
            scale,
            best: Best { left, impulses: r0.to_vec() },
        };
        match self.start {
            Some(Start::ColdSet) => {
                run.newton.prepare()?;
                run.try_newton();
            }
            Some(Start::InteriorPoint) => run.begin_interior()?,
            _ => {}
        }
        Ok(Box::new(run))
    }
}

impl Solver<RoughDiscs> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughDiscs>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        self.with_friction::<Exact, 2, 3>(problem, r0)
    }
}

impl Solver<RoughSpheres> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughSpheres>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        self.with_friction::<Whole, 3, 6>(problem, r0)
    }
}
