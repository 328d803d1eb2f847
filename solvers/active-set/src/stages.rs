//! With friction: the stages that lead to where Newton's method ends, one after the other, in the plane and in space.
//!
//! Nothing is minimised, and no way is known that always leads to that neighbourhood. So conjugate gradients come first, with a try of
//! Newton's method from where they come to the accuracy of the start, or to a rung of a ladder below it. Where they come no nearer,
//! proximal points follow; where those lead nowhere, LATIN has a try from the start impulses, with Newton's method at each rung, then,
//! in the plane, a fixed point over convex programmes, then proximal points once more. Where all of that brings nothing nearer, that is
//! the floor, and the end.

mod newton;

pub(crate) use newton::{Approach, Newton, Step};

use crate::progress::Progress;
use crate::{ActiveSet, Best, Convex, Start};
use cg::{Cg, Preconditioner, RoughRun};
use contact::{Iteration, Packing, SetupError, Solver, Work};
use latin_dd::LatinDd;

/// One rung of the ladder over the one before (–).
pub(crate) const RUNG: f64 = 0.1;

/// Iterations in which the conjugate gradient must halve what is left, or proximal points follow; and those of LATIN, or what comes after
/// it does.
const PATIENCE: u64 = 1000;
const PATIENCE_WITH_LATIN: u64 = 4000;

/// Iterations of LATIN from one look at what it leaves to the next.
const LOOK: u64 = 25;

/// κ of LATIN (–): of 3, 10, 30 and 100 the one that leads to the neighbourhood of a solution on most of fourteen packings of 250 and
/// 991 discs with friction of 0.1 to 0.8, at rest and with moving walls: on four, where 3 and 30 do on three and two.
const KAPPA: f64 = 10.0;

/// Programmes of the fixed point that do not halve what is left, after which sweeps take their place.
const IN_VAIN: u32 = 4;

/// Residual, over the problem's scale, from which proximal points are the last stage (–): where they come no nearer, neither LATIN nor
/// convex programmes do.
const AT_THE_FLOOR: f64 = 1e-6;

/// Largest residual of the law at an end where no step reduces it, over the problem's scale (–): else it is no end.
const ROUND_OFF: f64 = 1e-12;

/// Phase of an iteration.
enum Phase<'p, N: Newton<'p, D>, const D: usize> {
    /// Conjugate gradients.
    Gradient { run: Box<RoughRun<N::Mechanics, D>>, progress: Progress },
    /// LATIN.
    Latin { run: Box<dyn Iteration + 'p>, progress: Progress },
    /// The fixed point over convex programmes; the least that one left (√J), and how many since have not halved it.
    Convex { convex: Box<Convex>, least: f64, in_vain: u32 },
    /// Proximal points; whether they are the last that is tried.
    Proximal { points: Box<N::Points>, is_last: bool },
    /// Newton's method, from what was left before (√J).
    Newton { before: f64 },
    /// No further iteration helps.
    Ended,
}

struct Run<'p, N: Newton<'p, D>, const D: usize> {
    problem: &'p Packing<N::Mechanics>,
    newton: N,
    phase: Phase<'p, N, D>,
    /// Phase that resumes where Newton's method, which has a try, does not end.
    waiting: Option<Phase<'p, N, D>>,
    /// From which LATIN begins (N·s).
    r0: Vec<f64>,
    /// Next residual threshold (√J).
    rung: f64,
    /// √(Σ max(0, −b)²/`W_αα`) (√J).
    scale: f64,
    best: Best,
    /// Work of the phases that ended.
    work: Work,
}

impl<'p, N: Newton<'p, D>, const D: usize> Run<'p, N, D>
where
    LatinDd: Solver<N::Mechanics>,
    RoughRun<N::Mechanics, D>: Iteration,
{
    fn gradient(&mut self) {
        let Phase::Gradient { run, progress } = &mut self.phase else { return };
        run.advance();
        progress.iterations += 1;
        let left = run.left();
        let is_in_vain = progress.is_in_vain(left, PATIENCE);
        self.best.take(left, |r| run.impulses(r));
        if left <= self.rung {
            run.impulses(&mut self.best.impulses);
            self.best.left = left;
            self.try_newton();
        } else if is_in_vain {
            self.work += run.work();
            self.phase = self.points(false);
        }
    }

    /// One iteration of LATIN, and at times a look at what it leaves.
    fn latin(&mut self) {
        let Phase::Latin { run, progress } = &mut self.phase else { return };
        run.advance();
        progress.iterations += 1;
        if !progress.iterations.is_multiple_of(LOOK) {
            return;
        }
        let mut r = vec![0.0; self.best.impulses.len()];
        run.impulses(&mut r);
        let left = self.newton.begin(&r);
        let is_in_vain = progress.is_in_vain(left, PATIENCE_WITH_LATIN);
        self.best.take(left, |best| best.copy_from_slice(&r));
        if left <= self.rung {
            self.try_newton();
        } else if is_in_vain {
            self.work += run.work();
            self.phase = match N::programmes(self.problem) {
                Some(convex) => Phase::Convex { convex: Box::new(convex), least: f64::INFINITY, in_vain: 0 },
                None => self.points(true),
            };
        }
    }

    /// One programme of the fixed point, and Newton's method from where it ends.
    fn convex(&mut self) {
        let Phase::Convex { convex, least, in_vain } = &mut self.phase else { return };
        let solved = convex.advance();
        let mut r = vec![0.0; self.best.impulses.len()];
        convex.impulses(&mut r);
        let left = self.newton.begin(&r);
        self.best.take(left, |best| best.copy_from_slice(&r));
        *in_vain = if left < 0.5 * *least { 0 } else { *in_vain + 1 };
        *least = least.min(left);
        let gives_up = !solved || *in_vain >= IN_VAIN;
        if gives_up {
            self.work += convex.work();
            self.phase = self.points(true);
        }
        if left <= self.rung {
            self.try_newton();
        }
    }

    /// Proximal points from the best impulses.
    fn points(&self, is_last: bool) -> Phase<'p, N, D> {
        let points = self.newton.points(self.problem, &self.best);
        points.map_or(Phase::Ended, |points| Phase::Proximal { points: Box::new(points), is_last })
    }

    /// One proximal point, or a step towards it.
    fn proximal(&mut self) {
        let Phase::Proximal { points, is_last } = &mut self.phase else { return };
        let approach = self.newton.approach(points, &mut self.best, ROUND_OFF * self.scale);
        let is_last = *is_last || self.best.left <= AT_THE_FLOOR * self.scale;
        if matches!(approach, Approach::On) {
            return;
        }
        self.work += N::work_of(points);
        self.phase = match approach {
            Approach::InVain if !is_last => latin::<N, D>(self.problem, &self.r0).unwrap_or(Phase::Ended),
            _ => Phase::Ended,
        };
        if matches!(approach, Approach::Nearly) {
            self.try_newton();
        }
    }

    /// Newton's method from the best impulses.
    fn try_newton(&mut self) {
        self.rung *= RUNG;
        let before = self.newton.begin(&self.best.impulses);
        self.best.left = before;
        self.waiting = Some(std::mem::replace(&mut self.phase, Phase::Newton { before }));
    }

    /// One step of Newton's method. Where it is in vain, what waited goes on at once: an iterate that stays would look like one that needs
    /// no change.
    fn newton(&mut self, before: f64) {
        match self.newton.step(before, &mut self.best) {
            Step::Solved => self.phase = Phase::Ended,
            Step::On(before) => self.phase = Phase::Newton { before },
            Step::InVain => {
                let is_round_off = self.best.left <= ROUND_OFF * self.scale;
                self.phase = match self.waiting.take() {
                    Some(Phase::Gradient { run, progress })
                        if N::HAS_ONE_TRY && !is_round_off && progress.iterations > 0 =>
                    {
                        self.work += run.work();
                        self.points(false)
                    }
                    Some(waiting) if !is_round_off => waiting,
                    _ => Phase::Ended,
                };
                self.advance();
            }
        }
    }
}

impl<'p, N: Newton<'p, D>, const D: usize> Iteration for Run<'p, N, D>
where
    LatinDd: Solver<N::Mechanics>,
    RoughRun<N::Mechanics, D>: Iteration,
{
    fn advance(&mut self) {
        match self.phase {
            Phase::Gradient { .. } => self.gradient(),
            Phase::Latin { .. } => self.latin(),
            Phase::Convex { .. } => self.convex(),
            Phase::Proximal { .. } => self.proximal(),
            Phase::Newton { before } => self.newton(before),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match &self.phase {
            Phase::Gradient { run, .. } => run.impulses(r),
            Phase::Latin { run, .. } => run.impulses(r),
            _ => r.copy_from_slice(&self.best.impulses),
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.work;
        work += self.newton.work();
        for phase in std::iter::once(&self.phase).chain(&self.waiting) {
            match phase {
                Phase::Gradient { run, .. } => work += run.work(),
                Phase::Latin { run, .. } => work += run.work(),
                Phase::Convex { convex, .. } => work += convex.work(),
                Phase::Proximal { points, .. } => work += N::work_of(points),
                Phase::Newton { .. } | Phase::Ended => {}
            }
        }
        work
    }
}

/// LATIN from impulses `r0` (N·s).
fn latin<'p, N: Newton<'p, D>, const D: usize>(
    problem: &'p Packing<N::Mechanics>,
    r0: &[f64],
) -> Result<Phase<'p, N, D>, SetupError>
where
    LatinDd: Solver<N::Mechanics>,
{
    let method = LatinDd { kappa_l: Some(KAPPA), adaptive: Some(false), ..LatinDd::default() };
    let run = method.start(problem, r0)?;
    Ok(Phase::Latin { run, progress: Progress::from(f64::INFINITY) })
}

impl ActiveSet {
    /// A run with friction from the impulses `r0` (N·s).
    pub(crate) fn rough<'p, N: Newton<'p, D> + 'p, const D: usize>(
        &self,
        problem: &'p Packing<N::Mechanics>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError>
    where
        LatinDd: Solver<N::Mechanics>,
        RoughRun<N::Mechanics, D>: Iteration,
    {
        SetupError::unless_not_negative("start_accuracy", self.start_accuracy)?;
        let expected = "cg, latin or cold-set: its interior point is for problems without friction";
        SetupError::unless(self.start != Start::InteriorPoint, "start", "interior-point", expected)?;
        let mut newton = N::new(problem)?;
        let left = newton.begin(r0);
        let first = if self.start == Start::Latin {
            latin::<N, D>(problem, r0)?
        } else {
            let run = Cg { preconditioner: Preconditioner::Diagonal }.rough_run(problem, r0)?;
            Phase::Gradient { run: Box::new(run), progress: Progress::from(left) }
        };
        let at_once = self.start == Start::ColdSet || self.warm && r0.iter().any(|r| *r != 0.0);
        let (phase, waiting) =
            if at_once { (Phase::Newton { before: left }, Some(first)) } else { (first, None) };
        let scale = problem.scale().sqrt();
        Ok(Box::new(Run {
            problem,
            newton,
            phase,
            waiting,
            r0: r0.to_vec(),
            rung: self.start_accuracy * scale,
            scale,
            best: Best { left, impulses: r0.to_vec() },
            work: Work::default(),
        }))
    }
}
