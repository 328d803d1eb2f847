//! `gravel solve` of a file of another code that has W alone.

use super::{Args, Start, tell};
use crate::plan::Method;
use crate::problems::{size_of_w, stem};
use crate::run::{OnW, solved_on_w};
use crate::terminal::{Line, exit};
use anyhow::{Context, Result, bail};
use contact::Measure;
use local::LocalProblem;
use runner::{Measured, Progress, Stop};
use serde_json::json;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;

/// Runs the method on the problem that was read from `path`.
pub(super) fn solve(
    problem: LocalProblem,
    args: &Args,
    (method, stop): (&Method, &Stop),
    path: &Path,
) -> Result<ExitCode> {
    args.scene.refused(&format!("{} is a problem of W alone", path.display()))?;
    if args.homogenised.is_some() {
        bail!("--homogenised: {} has W alone, no grains and no contacts in space", path.display());
    }
    if args.start != Start::Cold {
        bail!(
            "--start: {} is a problem of W alone: it has no impulses of a time step before, and takes none",
            path.display()
        );
    }
    exit::listen_for_interrupts("nothing of it is kept")?;
    let on_w = OnW::new(stem(path), problem, args.truth || stop.on == Measure::VelocityError);
    let (truth, problem) = (on_w.truth(), &on_w.problem);
    let mut line = Line::alone(method.name.to_owned());
    let mut observe = |progress: &Progress| {
        line.show(progress, stop.on);
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = solved_on_w(method, truth, problem, stop, Measured::Needed, &mut observe)
        .with_context(|| format!("method `{}` on {}", method.name, path.display()))?;
    let _whole = exit::whole();
    drop(line);
    let asked = || {
        json!({
            "problem": on_w.name, "mechanics": "local",
            "contacts": problem.contact_count(), "unknowns": problem.dimension(),
            "method": method.name, "settings": method.settings,
            "stop_on": stop.on, "tolerance": stop.tolerance, "max_iterations": stop.max_iterations,
        })
    };
    tell(args, (asked, &format!("{}: {}", on_w.name, size_of_w(problem))), (method, stop), &outcome)
}
