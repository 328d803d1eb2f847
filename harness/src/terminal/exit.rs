//! How the program ends: exit codes, which a script may ask for without reading what is printed; and Ctrl-C or SIGTERM, of
//! which the first requests an end after the current iteration, and the second ends the program at once.

use anyhow::{Context, Result};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// The answer was found, or all is done.
const DONE: u8 = 0;
/// The method did not solve the problem, the impulses are not certified, or the simulation exploded or missed its tolerance.
const NOT_CONVERGED: u8 = 3;
/// It is proved that the problem has no solution.
const NO_SOLUTION: u8 = 4;
/// What a shell gives to a program that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

/// Below the help of every command whose answer is one of them.
pub(crate) const HELP: &str = "\
Exit codes:
    0  solve: converged; certify: certified; simulate: every time step converged; else: done
    1  an error: a file, a key or a value is wrong; regress: a count has changed
    2  wrong arguments
    3  solve: not converged (iteration-limit, stalled, diverged, false-convergence);
       certify: not certified; simulate: exploded, solver-diverged, or a time step did not converge
    4  solve, certify: it is proved that the problem has no solution; simulate: so for a time step
  130  stopped by Ctrl-C or SIGTERM; what was reached is kept
A run of `bench` that fails is a row like any other: exit code 0.";

/// The code of a solve, a certificate or a simulation that ended with this status.
pub(crate) fn code(status: &str) -> ExitCode {
    ExitCode::from(match status {
        "converged" | "certified" | "completed" => DONE,
        "infeasible" | "no-solution" => NO_SOLUTION,
        "interrupted" => INTERRUPTED,
        _ => NOT_CONVERGED,
    })
}

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From now on the first Ctrl-C only requests an end.
pub(crate) fn listen_for_interrupts() -> Result<()> {
    let handler = || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
    };
    ctrlc::set_handler(handler).context("Ctrl-C cannot be caught")
}

/// Whether the user requested an end.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
