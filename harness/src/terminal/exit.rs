//! The end of the program: exit codes, which a script may ask for without reading what is printed; and Ctrl-C or SIGTERM.
//!
//! The first signal requests an end after the current iteration. Where that has not come within a second, as inside the factors of a
//! large problem or before the first iteration, the program ends without, once nothing is being written; so does the second signal, at
//! once. What is kept in files by then, such as the runs of a study that had ended, is whole.

use anyhow::{Context, Result};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// The answer was found, or all is done.
const DONE: u8 = 0;
/// The method did not solve the problem, the impulses are not certified, or the simulation exploded or missed its tolerance.
const NOT_CONVERGED: u8 = 3;
/// The name of a condition that the last time step did not meet, for the code of a simulation.
pub(crate) const UNMET: &str = "unmet";
/// It is proved that the problem has no solution.
const NO_SOLUTION: u8 = 4;
/// Exit code that shells give to a program ended by Ctrl-C.
const INTERRUPTED: u8 = 130;

/// Text below the help of every command whose answer is one of them.
pub(crate) const HELP: &str = "\
Exit codes:
    0  solve: converged; which: a method converges; certify: certified; simulate: every time step
       converged; else: done
    1  an error: a file, a key or a value is wrong; regress: a count has changed; accept: a submission was
       refused; collection check: a fault was found
    2  wrong arguments
    3  solve: not converged (iteration-limit, stalled, diverged, false-convergence); which: no method
       converges; certify: not certified; simulate: exploded, solver-diverged, a time step did
       not converge, or the condition of --until was not met
    4  solve, which, certify: it is proved that the problem has no solution; simulate: so for a time step
  130  stopped by Ctrl-C or SIGTERM; what was reached is kept, except by a run inside an iteration
       of more than a second
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

/// Number of live [`Whole`] guards: writes that must not be cut short.
static WRITING: Mutex<u32> = Mutex::new(0);

/// The time that an iteration has to end after a signal, and that between two checks whether files are whole.
const GRACE: Duration = Duration::from_secs(1);
const LOOK: Duration = Duration::from_millis(20);

/// Makes the first Ctrl-C request an end; where none comes in time, the program says what is `kept`.
pub(crate) fn listen_for_interrupts(kept: &'static str) -> Result<()> {
    let handler = move || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        thread::spawn(move || end_after_grace(kept));
    };
    ctrlc::set_handler(handler).context("Ctrl-C cannot be caught")
}

/// Requests an end after the current iteration, or takes the request back.
pub(crate) fn request(is_requested: bool) {
    REQUESTED.store(is_requested, Ordering::Relaxed);
}

/// Reports whether the user requested an end.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Ends the program if it has not ended after the time that an iteration has for it.
fn end_after_grace(kept: &str) {
    thread::sleep(GRACE);
    loop {
        let writing = writing();
        if *writing == 0 {
            eprintln!("stopped, since no iteration ended within a second; {kept}");
            // Whoever wants to write waits for the guard, and the program ends before.
            std::process::exit(INTERRUPTED.into());
        }
        drop(writing);
        thread::sleep(LOOK);
    }
}

fn writing() -> MutexGuard<'static, u32> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A time in which a signal alone does not end the program, since something is written that is to be whole.
pub(crate) struct Whole(());

/// Begins to write something that is to be whole, or to end in order, until the guard is dropped.
pub(crate) fn whole() -> Whole {
    *writing() += 1;
    Whole(())
}

impl Drop for Whole {
    fn drop(&mut self) {
        *writing() -= 1;
    }
}
