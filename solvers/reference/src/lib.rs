//! The solution of a problem to round-off, with its certificate: the judge of accuracy, and a method of the line-up.
//!
//! (1)-(2) are the optimality system of the quadratic programme min ½ (V − `V_free`)ᵗ M (V − `V_free`) subject to
//! Hᵗ V + c ≥ 0, whose multipliers are r. An interior point finds its neighbourhood, an active set ends at round-off. V is
//! unique; of the impulses, the nearest to the centre of all that solve the problem.

mod certificate;
mod constraint;
mod dual;
mod interior;
mod method;
mod polish;

pub use certificate::{Certificate, ENERGY_ROUND_OFF, ROUND_OFF, Residual, certify};
pub use method::InteriorPoint;

use analysis::proves_infeasible;
use contact::{ContactProblem, Iteration};
use dual::End;
use interior::Verdict;
use method::Run;

/// What a problem has.
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
        /// What they leave.
        certificate: Certificate,
        /// How the methods of the reference ended.
        why: String,
    },
}

/// Grains up to which the dual active set is asked where the interior point leads to no answer: its matrix is dense.
const FEW: usize = 200;

/// The answer to `problem`: solved, polished, and certified; or proved to have none. Neither the interior point's word counts
/// nor that of the dual active set, which has the last try on small problems.
pub fn solve(problem: &ContactProblem) -> Answer {
    let none = vec![0.0; problem.contact_count()];
    let mut best = Best { certificate: certify(problem, &none), impulses: none };
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
    fn take(&mut self, problem: &ContactProblem, impulses: &[f64]) {
        let certificate = certify(problem, impulses);
        if certificate.worst() < self.certificate.worst() || certificate.certified() {
            *self = Self { impulses: impulses.to_vec(), certificate };
        }
    }
}

/// The answer of the interior point and its polish; or how it ended without one, the `best` impulses kept.
fn interior_point(problem: &ContactProblem, best: &mut Best) -> Result<Answer, String> {
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
    if best.certificate.certified() {
        let Best { impulses, certificate } = best;
        return Ok(Answer::Solution { impulses: std::mem::take(impulses), certificate: *certificate });
    }
    let ended = match verdict {
        Verdict::Solution => "found impulses that are not certified".to_owned(),
        Verdict::Infeasible => "found no solution, and no proof of that".to_owned(),
        Verdict::Stopped(why) => format!("stopped ({why:?})"),
    };
    Err(format!("the interior point {ended}"))
}
