//! The solution of a problem to round-off, with its certificate: the judge of accuracy, and a method of the line-up.
//!
//! (1)-(2) are the optimality system of the quadratic programme min ½ (V − `V_free`)ᵗ M (V − `V_free`) subject to
//! Hᵗ V + c ≥ 0, whose multipliers are r. An active set ends at round-off; where it does not, an interior point finds the
//! neighbourhood of the solution first. V is unique, the impulses need not be.

mod certificate;
mod constraint;
mod continued;
mod dual;
mod existence;
mod interior;
mod isolated;
mod method;
mod rough;

pub use certificate::{Certificate, Certified, ENERGY_ROUND_OFF, ROUND_OFF, Residual, certify};
pub use continued::{SEARCHES, continued};
pub use existence::{Existence, existence};
pub use isolated::{Isolation, isolation};
pub use method::InteriorPoint;
pub use rough::{Provable, RoughSolution, distance, is_same, polished, solve_rough, take};

use active_set::ActiveSet;
use analysis::proves_infeasible;
use contact::{ContactProblem, Iteration, Packing, Smooth, Solver};
use dual::End;
use interior::Verdict;
use method::Run;

/// Answer to a problem.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// A certified solution.
    Solution {
        /// r ≥ 0 (N·s).
        impulses: Vec<f64>,
        /// Their certificate.
        certificate: Certificate,
    },
    /// No solution.
    Infeasible {
        /// Impulses d ≥ 0 that prove it (N·s), see [`proves_infeasible`].
        ray: Vec<f64>,
    },
    /// Neither was found: the problem is too close to both, or too ill-conditioned.
    Unknown {
        /// The best impulses found (N·s).
        impulses: Vec<f64>,
        /// Certificate of their residuals.
        certificate: Certificate,
        /// Reasons why the methods of the reference ended.
        why: String,
    },
}

/// Grains up to which the dual active set is asked where the interior point leads to no answer: its matrix is dense.
const FEW: usize = 200;

/// Iterations of the active set after which it is left: those that end take a tenth of them.
const MANY: u32 = 20_000;

/// The answer to `problem`: solved and certified, or proved to have none. No method's word counts; the active set has the first
/// try, then the interior point, and on small problems the dual active set.
pub fn solve<const D: usize>(problem: &Packing<Smooth<D>>) -> Answer {
    let none = vec![0.0; problem.contact_count()];
    let mut best = Best { certificate: certify(problem, &none), impulses: none };
    if let Some(answer) = active_set(problem, &mut best) {
        return answer;
    }
    let mut why = match interior_point(problem, &mut best) {
        Ok(answer) => return answer,
        Err(why) => why,
    };
    if problem.grain_count() <= FEW && problem.scale() > 0.0 {
        for yielding in dual::YIELDING {
            match dual::solve(problem, yielding) {
                End::Solution(impulses) => best.take(problem, &impulses),
                End::Ray(ray) if proves_infeasible(problem, &ray) => return Answer::Infeasible { ray },
                End::Ray(_) | End::Stopped => {}
            }
            if best.certificate.certified() {
                break;
            }
        }
        why += "; a dual active set found neither impulses in double precision that solve it, nor a proof that none do";
    }
    let Best { impulses, certificate } = best;
    if certificate.certified() {
        Answer::Solution { impulses, certificate }
    } else {
        Answer::Unknown { impulses, certificate, why }
    }
}

/// The impulses with the least residuals so far.
struct Best {
    impulses: Vec<f64>,
    certificate: Certificate,
}

impl Best {
    /// Takes `impulses` that leave less.
    fn take<const D: usize>(&mut self, problem: &ContactProblem<Smooth<D>>, impulses: &[f64]) {
        let certificate = certify(problem, impulses);
        if certificate.worst() < self.certificate.worst() || certificate.certified() {
            *self = Self { impulses: impulses.to_vec(), certificate };
        }
    }

    /// The answer that they are, if they are certified.
    fn answer(&mut self) -> Option<Answer> {
        let certificate = self.certificate;
        certificate
            .certified()
            .then(|| Answer::Solution { impulses: std::mem::take(&mut self.impulses), certificate })
    }
}

/// The answer of the active set, if it ends with one; else the `best` impulses are kept.
fn active_set<const D: usize>(problem: &Packing<Smooth<D>>, best: &mut Best) -> Option<Answer> {
    let mut r = best.impulses.clone();
    let mut run = ActiveSet::default().start(problem, &r).ok()?;
    for _ in 0..MANY {
        if best.certificate.certified() || run.stalled() {
            break;
        }
        run.advance();
    }
    run.impulses(&mut r);
    if proves_infeasible(problem, &r) {
        return Some(Answer::Infeasible { ray: r });
    }
    best.take(problem, &r);
    best.answer()
}

/// The answer of the interior point and its polish; or how it ended without one, the `best` impulses kept.
fn interior_point<const D: usize>(problem: &Packing<Smooth<D>>, best: &mut Best) -> Result<Answer, String> {
    let mut run = Run::new(problem, &best.impulses, true)?;
    let verdict = run.interior_point();
    if verdict != Verdict::Solution {
        let mut ray = run.impulses().to_vec();
        run.balance(&mut ray);
        if proves_infeasible(problem, &ray) {
            return Ok(Answer::Infeasible { ray });
        }
    }
    best.take(problem, run.impulses());
    while !best.certificate.certified() && !run.stalled() {
        run.polish();
        best.take(problem, run.impulses());
    }
    if let Some(answer) = best.answer() {
        return Ok(answer);
    }
    let ended = match verdict {
        Verdict::Solution => "found impulses that are not certified".to_owned(),
        Verdict::Infeasible => "found no solution, and no proof of that".to_owned(),
        Verdict::Stopped(why) => format!("stopped ({why:?})"),
    };
    Err(format!("the interior point {ended}"))
}
