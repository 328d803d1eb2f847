//! The solution of a problem to round-off, with its certificate: the judge of accuracy, and a method of the line-up.
//!
//! (1)-(2) are the optimality system of the quadratic programme min ½ (V − `V_free`)ᵗ M (V − `V_free`) subject to
//! Hᵗ V + c ≥ 0, whose multipliers are r. An interior point finds its neighbourhood, an active set ends at round-off. V is
//! unique; of the impulses, the nearest to the centre of all that solve the problem.

mod certificate;
mod factor;
mod interior;
mod method;
mod polish;
mod row;

pub use certificate::{Certificate, ROUND_OFF, Residual, certify};
pub use method::InteriorPoint;

use contact::{ContactProblem, proves_infeasible};
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
        /// How the interior point ended.
        interior_point: String,
    },
}

/// Polish steps without a better certificate after which there is none to expect.
const PATIENCE: u32 = 8;

/// The answer to `problem`: solved, polished, and certified; or proved to have none. Clarabel's word counts in neither.
pub fn solve(problem: &ContactProblem) -> Answer {
    let none = vec![0.0; problem.contact_count()];
    let mut run = match Run::new(problem, &none, true) {
        Ok(run) => run,
        Err(why) => {
            let certificate = certify(problem, &none);
            return Answer::Unknown { impulses: none, certificate, interior_point: why };
        }
    };
    let verdict = run.interior_point();
    if verdict != Verdict::Solution {
        let mut ray = run.impulses().to_vec();
        run.balance(&mut ray);
        if proves_infeasible(problem, &ray) {
            return Answer::Infeasible { ray };
        }
    }
    let mut best = (run.impulses().to_vec(), certify(problem, run.impulses()));
    let mut in_vain = 0;
    while !best.1.certified() && in_vain < PATIENCE {
        run.polish();
        let certificate = certify(problem, run.impulses());
        if certificate.worst() < best.1.worst() {
            (best, in_vain) = ((run.impulses().to_vec(), certificate), 0);
        } else {
            in_vain += 1;
        }
    }
    let (impulses, certificate) = best;
    if certificate.certified() {
        Answer::Solution { impulses, certificate }
    } else {
        Answer::Unknown { impulses, certificate, interior_point: format!("{verdict:?}") }
    }
}
