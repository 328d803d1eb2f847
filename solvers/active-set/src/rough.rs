//! With friction: Newton's method on the statuses open, stick and slide, which ends where it begins near a solution, and wanders
//! anywhere else.
//!
//! Nothing is minimised, and no way is known that always leads to that neighbourhood. So conjugate gradients come first, to the
//! accuracy of the start or as near as they come; Newton's method has a try from there, which is left at the first step that makes
//! things worse. Proximal points follow, each reached along an exact path: they come through where walls move and where impulses only
//! drift. Where they lead nowhere, LATIN has a try from the start impulses, with Newton's method at each rung of a ladder of
//! accuracies, then a fixed point over convex programmes, then proximal points once more. Where all of that brings nothing nearer, that
//! is the floor, and the end.

mod convex;
mod layout;
mod matrix;
mod path;
mod proximal;
mod statuses;

use crate::progress::Progress;
use crate::{ActiveSet, Best, Start};
use cg::{Cg, Preconditioner, RoughRun};
use contact::{Iteration, Packing, RoughDiscs, SetupError, Solver, Work};
pub use convex::Convex;
use latin_dd::LatinDd;
use layout::terms_of_b;
use proximal::Proximal;
use statuses::Statuses;

/// One rung of the ladder over the one before (–).
const RUNG: f64 = 0.1;

/// Iterations in which the conjugate gradient must halve what is left, or proximal points follow; and those of LATIN, or the fixed point
/// does.
const PATIENCE: u64 = 1000;
const PATIENCE_WITH_LATIN: u64 = 4000;

/// Iterations of LATIN from one look at what it leaves to the next.
const LOOK: u64 = 25;

/// κ of LATIN (–): of 3, 10, 30 and 100 the one that leads to the neighbourhood of a solution on most of fourteen packings of 250 and
/// 991 discs with friction of 0.1 to 0.8, at rest and with moving walls: on four, where 3 and 30 do on three and two.
const KAPPA: f64 = 10.0;

/// Programmes of the fixed point that do not halve what is left, after which sweeps take their place.
const IN_VAIN: u32 = 4;

/// Where proximal points come no nearer than that, neither LATIN nor convex programmes do (–).
const AT_THE_FLOOR: f64 = 1e-6;

/// What is left of the law where no step leaves less, over the problem's scale, at most (–): else it is no end.
const ROUND_OFF: f64 = 1e-12;

/// What an iteration does.
enum Phase<'p> {
    /// Conjugate gradients.
    Gradient { run: Box<RoughRun>, progress: Progress },
    /// LATIN.
    Latin { run: Box<latin_dd::Run<'p, RoughDiscs, 3>>, progress: Progress },
    /// The fixed point over convex programmes; the least that one left (√J), and how many since have not halved it.
    Convex { convex: Box<Convex>, least: f64, in_vain: u32 },
    /// Proximal points; whether they are the last that is tried.
    Proximal { points: Box<Proximal<'p>>, is_last: bool },
    /// Newton's method, from what was left before (√J).
    Statuses { before: f64 },
    /// No further iteration helps.
    Ended,
}

struct Run<'p> {
    problem: &'p Packing<RoughDiscs>,
    statuses: Statuses,
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
            self.try_statuses();
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
        self.statuses.begin(&r);
        let left = self.statuses.left();
        let is_in_vain = progress.is_in_vain(left, PATIENCE_WITH_LATIN);
        self.best.take(left, |best| best.copy_from_slice(&r));
        if left <= self.rung {
            self.try_statuses();
        } else if is_in_vain {
            self.work += run.work();
            self.phase = self.programmes();
        }
    }

    /// The fixed point over convex programmes; or proximal points, where it cannot be laid out.
    fn programmes(&self) -> Phase<'p> {
        match Convex::new(self.problem) {
            Ok(convex) => Phase::Convex { convex: Box::new(convex), least: f64::INFINITY, in_vain: 0 },
            Err(_) => self.points(true),
        }
    }

    /// Proximal points from the best impulses.
    fn points(&self, is_last: bool) -> Phase<'p> {
        match Proximal::new(self.problem, &self.best.impulses) {
            Ok(points) => Phase::Proximal { points: Box::new(points), is_last },
            Err(_) => Phase::Ended,
        }
    }

    /// One programme of the fixed point, and Newton's method from where it ends.
    fn convex(&mut self) {
        let Phase::Convex { convex, least, in_vain } = &mut self.phase else { return };
        let solved = convex.advance();
        let mut r = vec![0.0; self.best.impulses.len()];
        convex.impulses(&mut r);
        self.statuses.begin(&r);
        let left = self.statuses.left();
        self.best.take(left, |best| best.copy_from_slice(&r));
        *in_vain = if left < 0.5 * *least { 0 } else { *in_vain + 1 };
        *least = least.min(left);
        let gives_up = !solved || *in_vain >= IN_VAIN;
        if gives_up {
            self.work += convex.work();
            self.phase = self.points(true);
        }
        if left <= self.rung {
            self.try_statuses();
        }
    }

    /// One proximal point.
    fn proximal(&mut self) {
        let Phase::Proximal { points, is_last } = &mut self.phase else { return };
        if let Some(left) = points.advance() {
            self.best.take(left, |r| points.impulses(r));
        }
        let (is_solved, is_in_vain) = (points.is_solved(), points.is_in_vain());
        let is_last = *is_last || self.best.left <= AT_THE_FLOOR * self.scale;
        if is_solved || is_in_vain {
            self.work += points.work();
            self.phase = if is_solved || is_last {
                Phase::Ended
            } else {
                latin(self.problem, &self.r0).unwrap_or(Phase::Ended)
            };
        }
    }

    /// The iterate is at a rung: Newton's method from there.
    fn try_statuses(&mut self) {
        self.rung *= RUNG;
        self.statuses.begin(&self.best.impulses);
        let before = self.statuses.left();
        self.best.left = before;
        self.waiting = Some(std::mem::replace(&mut self.phase, Phase::Statuses { before }));
    }

    fn statuses(&mut self, before: f64) {
        let changed = self.statuses.step();
        let left = self.statuses.left();
        let is_better = self.best.take(left, |r| self.statuses.impulses(r));
        if self.statuses.is_solved() {
            self.phase = Phase::Ended;
        } else if changed.is_none() || !(left < before) || changed == Some(0) && !is_better {
            let is_round_off = self.best.left <= ROUND_OFF * self.scale;
            self.phase = match self.waiting.take() {
                Some(Phase::Gradient { run, progress }) if !is_round_off && progress.iterations > 0 => {
                    self.work += run.work();
                    self.points(false)
                }
                Some(waiting) if !is_round_off => waiting,
                _ => Phase::Ended,
            };
            // What waited goes on at once: an iterate that stays would look like one that needs no change.
            self.advance();
        } else {
            self.phase = Phase::Statuses { before: left.max(before * RUNG) };
        }
    }
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        match self.phase {
            Phase::Gradient { .. } => self.gradient(),
            Phase::Latin { .. } => self.latin(),
            Phase::Convex { .. } => self.convex(),
            Phase::Proximal { .. } => self.proximal(),
            Phase::Statuses { before } => self.statuses(before),
            Phase::Ended => {}
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        match &self.phase {
            Phase::Gradient { run, .. } => run.impulses(r),
            Phase::Latin { run, .. } => run.impulses(r),
            Phase::Convex { .. } | Phase::Proximal { .. } | Phase::Statuses { .. } | Phase::Ended => {
                r.copy_from_slice(&self.best.impulses);
            }
        }
    }

    fn stalled(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    fn work(&self) -> Work {
        let mut work = self.work;
        work += self.statuses.work();
        for phase in std::iter::once(&self.phase).chain(&self.waiting) {
            match phase {
                Phase::Gradient { run, .. } => work += run.work(),
                Phase::Latin { run, .. } => work += run.work(),
                Phase::Convex { convex, .. } => work += convex.work(),
                Phase::Proximal { points, .. } => work += points.work(),
                _ => {}
            }
        }
        work
    }
}

/// LATIN from impulses `r0` (N·s).
fn latin<'p>(problem: &'p Packing<RoughDiscs>, r0: &[f64]) -> Result<Phase<'p>, SetupError> {
    let method = LatinDd { kappa_l: Some(KAPPA), adaptive: Some(false), ..LatinDd::default() };
    let run = Box::new(method.run(problem, r0)?);
    Ok(Phase::Latin { run, progress: Progress::from(f64::INFINITY) })
}

impl Solver<RoughDiscs> for ActiveSet {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughDiscs>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_not_negative("start_accuracy", self.start_accuracy)?;
        let expected = "cg, latin or cold-set: its interior point is for problems without friction";
        SetupError::unless(self.start != Start::InteriorPoint, "start", "interior-point", expected)?;
        let mut statuses = Statuses::new(problem)?;
        statuses.begin(r0);
        let left = statuses.left();
        let first = if self.start == Start::Latin {
            latin(problem, r0)?
        } else {
            let run = Cg { preconditioner: Preconditioner::Diagonal }.rough_run(problem, r0)?;
            Phase::Gradient { run: Box::new(run), progress: Progress::from(left) }
        };
        let at_once = self.start == Start::ColdSet || self.warm && r0.iter().any(|r| *r != 0.0);
        let (phase, waiting) =
            if at_once { (Phase::Statuses { before: left }, Some(first)) } else { (first, None) };
        let scale = problem.scale().sqrt();
        Ok(Box::new(Run {
            problem,
            statuses,
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
