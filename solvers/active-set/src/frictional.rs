//! With friction: the stages that lead to where Newton's method ends, one after the other.
//!
//! Nothing is minimised, and no method is known that always leads to that neighbourhood. Accelerated sweeps of Gauss-Seidel come first.
//! Where their residual reaches the accuracy of the start, or a tenth of that of the last try, Newton's method is tried, and sweeps
//! resume where it stalls; a factor that takes longer than sweeps may stall waits until they have had its time since then, or stall.
//! Where sweeps stall, convex programmes and proximal points follow. From r = 0 a load path is to be chosen: programmes come first, and at
//! rest they come near, for the grains that do not move, while sweeps settle those that do. From other impulses, which have a load path,
//! points come first, and programmes where they stall. Points go on from what the programmes find, if that leaves a tenth of what was
//! left. Where they stall then, that is the floor, and the end. Where factors do not fit in memory, sweeps are the only stage.

mod exact;
mod matrix;
mod newton;
mod path;
mod points;
mod programmes;
mod whole;

use crate::start::{ACCURACY_OF_DEARER, LOOK, RUNG, Start, accelerated};
use crate::{ActiveSet, Best};
use contact::{Frictional, Iteration, Packing, Rough, RoughDiscs, RoughSpheres, SetupError, Solver, Work};
use exact::Exact;
use nalgebra::SVector;
use newton::{Newton, Step};
use points::{Approach, PointSolver, Points};
use programmes::Programmes;
use whole::Whole;

/// Sweeps in which the residual must be halved, or the next stage follows.
const PATIENCE: u64 = 1000;

/// Residual of the law over the problem's scale (–): where points leave it, Newton's method follows; where no step reduces it, it is the
/// end.
const ROUND_OFF: f64 = 1e-12;

/// Residual when it was last halved (√J), and the sweeps or points since.
struct Halved {
    left: f64,
    since: u64,
}

impl Halved {
    /// Begins to count at a residual (√J).
    fn at(left: f64) -> Self {
        Self { left, since: 0 }
    }

    /// Begins anew where a residual `left` (√J) is at most half the one before.
    fn look(&mut self, left: f64) {
        if left <= 0.5 * self.left {
            *self = Self::at(left);
        }
    }
}

/// Phase of an iteration.
#[derive(Clone, Copy)]
enum Phase {
    /// Accelerated sweeps.
    Sweeps,
    /// Convex programmes.
    Programmes,
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
    /// Residual of the sweeps.
    halved: Halved,
    newton: Newton<D, N>,
    problem: &'p Packing<Rough<D>>,
    /// True where it begins from impulses.
    is_warm: bool,
    /// Convex programmes, once they have begun.
    programmes: Option<Programmes<D, N>>,
    /// Proximal points, once sweeps have stalled.
    points: Option<Points<P, D, N>>,
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
        self.halved.since += LOOK;
        self.halved.look(left);
        self.best.take(left, |best| best.copy_from_slice(&r));
        let has_stalled = self.halved.since >= PATIENCE;
        if left <= self.rung && (has_stalled || self.is_due()) {
            self.best = Best { left, impulses: r };
            self.try_newton();
        } else if has_stalled || !left.is_finite() {
            self.go_on_without_sweeps();
        }
    }

    /// Begins convex programmes or points where sweeps have stalled.
    fn go_on_without_sweeps(&mut self) {
        if self.is_warm || self.programmes.is_some() || self.begin_programmes().is_err() {
            self.begin_points();
        }
    }

    fn begin_programmes(&mut self) -> Result<(), SetupError> {
        self.programmes = Some(Programmes::new(self.problem)?);
        self.phase = Phase::Programmes;
        Ok(())
    }

    /// One step of a programme. After the last, points follow where it came nearer or there were none; sweeps, or Newton's method, where
    /// the run begins with programmes.
    fn programme(&mut self) {
        let Some(programmes) = &mut self.programmes else { return };
        if programmes.advance(&mut self.newton) {
            return;
        }
        let is_nearer = programmes.best.left <= RUNG * self.best.left;
        if is_nearer {
            self.best = programmes.best.clone();
        }
        if self.swept == 0 {
            if is_nearer { self.try_newton() } else { self.phase = Phase::Sweeps }
        } else if is_nearer || self.points.is_none() {
            self.begin_points();
        } else {
            self.phase = Phase::Ended;
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
        let nearly = self.rung.min(ROUND_OFF * self.scale);
        let Some(points) = &mut self.points else { return };
        match points.advance(&mut self.newton, &mut self.best, nearly) {
            Approach::On => {}
            Approach::Nearly => self.try_newton(),
            Approach::InVain if self.programmes.is_none() && self.begin_programmes().is_ok() => {}
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

    /// One step of Newton's method. Where it stalls, points resume, if there were any, or sweeps, and these at once: an iterate that stays
    /// would look like one that needs no change.
    fn newton_step(&mut self) {
        self.phase = match self.newton.advance(&mut self.best) {
            Step::Solved => Phase::Ended,
            Step::On => Phase::Newton,
            Step::InVain if self.points.is_some() => Phase::Proximal,
            Step::InVain if self.best.left <= ROUND_OFF * self.scale => Phase::Ended,
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
            Phase::Programmes => self.programme(),
            Phase::Proximal => self.proximal(),
            Phase::Newton => self.newton_step(),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match (self.phase, &self.programmes) {
            (Phase::Sweeps, _) => self.sweeps.impulses(r),
            (Phase::Programmes, Some(programmes)) if programmes.best.left < self.best.left => {
                r.copy_from_slice(&programmes.best.impulses);
            }
            _ => r.copy_from_slice(&self.best.impulses),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.sweeps.work();
        work += self.newton.work();
        self.programmes.iter().for_each(|programmes| work += programmes.work());
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
            halved: Halved::at(f64::INFINITY),
            newton,
            problem,
            is_warm: r0.iter().any(|r| *r != 0.0),
            programmes: None,
            points: None,
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
            Some(Start::InteriorPoint) => run.begin_programmes()?,
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
