//! Between spheres with friction: Newton's method on the statuses open, stick and slide, where sliding has a direction.
//!
//! In space the law is not piecewise linear, so Newton's method ends by round-off, not by statuses that stay. As in the plane conjugate
//! gradients come first, with a try of Newton's method at each rung of a ladder of accuracies; proximal points follow where they come no
//! nearer, then LATIN from the start impulses, then proximal points once more. Where all of that brings nothing nearer, that is the
//! floor, and the end: in packings at rest more may stick than motion allows, and impulses then drift along the kernel of W, further
//! than any of these follows them.

mod layout;
mod newton;
mod proximal;

use crate::progress::Progress;
use crate::{ActiveSet, Best, Start};
use cg::{Cg, Preconditioner, RoughRun};
use contact::{Iteration, Packing, RoughSpheres, SetupError, Solver, Work};
use latin_dd::LatinDd;
use nalgebra::Vector3;
use newton::{Drawn, Newton};
use proximal::{Proximal, shortened};

/// One rung of the ladder over the one before (–).
const RUNG: f64 = 0.1;

/// Iterations in which the conjugate gradient, and in which LATIN must halve what is left, or proximal points follow.
const PATIENCE: u64 = 1000;
const PATIENCE_WITH_LATIN: u64 = 4000;

/// Iterations of LATIN from one look at what it leaves to the next.
const LOOK: u64 = 25;

/// κ of LATIN (–), as in the plane.
const KAPPA: f64 = 10.0;

/// ε of Newton's method alone (–): what sticks more than motion allows keeps its impulses but for so much.
const EPSILON: f64 = 1e-6;

/// What is left of the law where no step leaves less, over the problem's scale, at most (–): else it is no end.
const ROUND_OFF: f64 = 1e-12;

/// Where proximal points come no nearer than that, LATIN does not either (–).
const AT_THE_FLOOR: f64 = 1e-6;

/// What an iteration does.
enum Phase<'p> {
    /// Conjugate gradients.
    Gradient { run: Box<RoughRun<RoughSpheres, 3>>, progress: Progress },
    /// LATIN.
    Latin { run: Box<latin_dd::Run<'p, RoughSpheres, 6, 3>>, progress: Progress },
    /// Proximal points; whether they are the last that is tried.
    Proximal { points: Box<Proximal>, is_last: bool },
    /// Newton's method.
    Newton,
    /// No further iteration helps.
    Ended,
}

struct Run<'p> {
    problem: &'p Packing<RoughSpheres>,
    newton: Newton,
    /// The iterate of Newton's method (√J).
    s: Vec<Vector3<f64>>,
    phase: Phase<'p>,
    /// What goes on where Newton's method, which has a try, does not end.
    waiting: Option<Phase<'p>>,
    /// From which LATIN begins (N·s).
    r0: Vec<f64>,
    /// What is left at the next rung (√J).
    rung: f64,
    /// √(Σ max(0, −b)²/`W_αα`) (√J).
    scale: f64,
    best: Best,
    /// Of the phases that ended.
    work: Work,
}

/// Newton's method without a point that draws.
const ALONE: Drawn<'static> = Drawn { epsilon: EPSILON, centre: None };

impl<'p> Run<'p> {
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
        let left = self.newton.left(ALONE, &self.newton.layout.scaled(&r));
        let is_in_vain = progress.is_in_vain(left, PATIENCE_WITH_LATIN);
        self.best.take(left, |best| best.copy_from_slice(&r));
        if left <= self.rung {
            self.try_newton();
        } else if is_in_vain {
            self.work += run.work();
            self.phase = self.points(true);
        }
    }

    /// Proximal points from the best impulses.
    fn points(&self, is_last: bool) -> Phase<'p> {
        let s = self.newton.layout.scaled(&self.best.impulses);
        Phase::Proximal { points: Box::new(Proximal::new(s, self.best.left)), is_last }
    }

    /// One step towards a proximal point; where it leaves next to nothing, Newton's method ends it.
    fn proximal(&mut self) {
        let Phase::Proximal { points, is_last } = &mut self.phase else { return };
        let left = points.advance(&mut self.newton);
        self.best.take(left, |r| self.newton.layout.impulses(&points.s, r));
        if self.best.left <= ROUND_OFF * self.scale || self.newton.layout.is_round_off(left, &points.s) {
            self.phase = Phase::Ended;
            self.try_newton();
        } else if points.is_in_vain() {
            let is_last = *is_last || self.best.left <= AT_THE_FLOOR * self.scale;
            self.phase =
                if is_last { Phase::Ended } else { latin(self.problem, &self.r0).unwrap_or(Phase::Ended) };
        }
    }

    /// Newton's method from the best impulses.
    fn try_newton(&mut self) {
        self.rung *= RUNG;
        self.s = self.newton.layout.scaled(&self.best.impulses);
        self.best.left = self.newton.left(ALONE, &self.s);
        self.waiting = Some(std::mem::replace(&mut self.phase, Phase::Newton));
    }

    /// One step of Newton. Where no part of it leaves less, what waited goes on, at once: an iterate that stays would look like one that
    /// needs no change.
    fn newton(&mut self) {
        let before = self.newton.left(ALONE, &self.s);
        if self.newton.layout.is_round_off(before, &self.s) {
            self.phase = Phase::Ended;
        } else if let Some((next, left)) = shortened(&mut self.newton, ALONE, &self.s, before) {
            self.s = next;
            self.best.take(left, |r| self.newton.layout.impulses(&self.s, r));
        } else {
            let is_round_off = self.best.left <= ROUND_OFF * self.scale;
            self.phase = match self.waiting.take() {
                Some(waiting) if !is_round_off => waiting,
                _ => Phase::Ended,
            };
            self.advance();
        }
    }
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        match self.phase {
            Phase::Gradient { .. } => self.gradient(),
            Phase::Latin { .. } => self.latin(),
            Phase::Proximal { .. } => self.proximal(),
            Phase::Newton => self.newton(),
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
                _ => {}
            }
        }
        work
    }
}

/// LATIN from impulses `r0` (N·s).
fn latin<'p>(problem: &'p Packing<RoughSpheres>, r0: &[f64]) -> Result<Phase<'p>, SetupError> {
    let method = LatinDd { kappa_l: Some(KAPPA), adaptive: Some(false), ..LatinDd::default() };
    let run = Box::new(method.run(problem, r0)?);
    Ok(Phase::Latin { run, progress: Progress::from(f64::INFINITY) })
}

impl Solver<RoughSpheres> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughSpheres>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_not_negative("start_accuracy", self.start_accuracy)?;
        let expected = "cg, latin or cold-set: its interior point is for problems without friction";
        SetupError::unless(self.start != Start::InteriorPoint, "start", "interior-point", expected)?;
        let newton = Newton::new(problem)?;
        let s = newton.layout.scaled(r0);
        let left = newton.left(ALONE, &s);
        let first = if self.start == Start::Latin {
            latin(problem, r0)?
        } else {
            let run = Cg { preconditioner: Preconditioner::Diagonal }.rough_run(problem, r0)?;
            Phase::Gradient { run: Box::new(run), progress: Progress::from(left) }
        };
        let at_once = self.start == Start::ColdSet || self.warm && r0.iter().any(|r| *r != 0.0);
        let (phase, waiting) = if at_once { (Phase::Newton, Some(first)) } else { (first, None) };
        let scale = problem.scale().sqrt();
        Ok(Box::new(Run {
            problem,
            newton,
            s,
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
