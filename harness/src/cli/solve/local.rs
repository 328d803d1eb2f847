//! `gravel solve` of a file of another code that has W alone.

use super::{Args, Start, say_ending};
use crate::plan::Method;
use crate::terminal::{Line, exit, say, write_instead};
use anyhow::{Context, Result, bail};
use contact::Measure;
use local::{LocalProblem, Nsgs};
use runner::{Status, Stop};
use serde_json::json;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Refuses what has no meaning without grains.
fn check(args: &Args, method: &Method, stop: &Stop, path: &Path) -> Result<()> {
    let plain = Method::parse("nsgs", &[])?;
    let refused = if method.name != plain.name {
        format!("method `{}`", method.name)
    } else if method.settings != plain.settings {
        "--set".to_owned()
    } else if stop.on != Measure::NaturalMap {
        format!("--on {}", stop.on)
    } else if args.truth {
        "--truth".to_owned()
    } else if args.start == Start::Warm {
        "--start warm".to_owned()
    } else {
        return args.scene.refused(&format!("{} is a problem of W alone", path.display()));
    };
    bail!(
        "{}: {refused} needs grains, and the file has W alone: it is solved by `--method nsgs`, in the order of its contacts, to a natural map",
        path.display()
    )
}

/// Sweeps until the natural map is small enough; as of other runs it is measured after each of the first 200 sweeps, then after one
/// in each two-hundredth of them.
pub(super) fn solve(
    problem: &LocalProblem,
    args: &Args,
    (method, stop): (&Method, &Stop),
    path: &Path,
) -> Result<ExitCode> {
    check(args, method, stop, path)?;
    exit::listen_for_interrupts()?;
    let mut line = Line::alone(method.name.to_owned());
    let mut nsgs = Nsgs::new(problem);
    let (mut sweeps, mut next, mut iterating) = (0, 1, Duration::ZERO);
    let (status, natural_map) = loop {
        let natural_map = problem.natural_map(nsgs.impulses());
        line.show_value(sweeps, stop.on, natural_map);
        let status = if natural_map <= stop.tolerance {
            Some(Status::Converged)
        } else if !natural_map.is_finite() {
            Some(Status::Diverged)
        } else if sweeps >= stop.max_iterations {
            Some(Status::IterationLimit)
        } else {
            exit::requested().then_some(Status::Interrupted)
        };
        if let Some(status) = status {
            break (status.name(), natural_map);
        }
        let clock = Instant::now();
        while sweeps < next.min(stop.max_iterations) {
            nsgs.sweep();
            sweeps += 1;
        }
        iterating += clock.elapsed();
        next = sweeps + (sweeps / 200).max(1);
    };
    drop(line);
    if let Some(file) = &args.impulses {
        write_instead(file, json!({ "impulse": nsgs.impulses() }).to_string())?;
    }
    let name = path.file_stem().context("a file has a name")?.to_string_lossy();
    let (contacts, unknowns, seconds) =
        (problem.contact_count(), problem.dimension(), iterating.as_secs_f64());
    if args.json {
        let object = json!({
            "problem": name, "mechanics": "local", "contacts": contacts, "unknowns": unknowns, "method": method.name,
            "stop_on": stop.on, "tolerance": stop.tolerance, "max_iterations": stop.max_iterations,
            "status": status, "iterations": sweeps, "iterating_s": seconds, "natural_map": natural_map,
        });
        say(format_args!("{object}"))?;
    } else {
        say(format_args!("{name}: {contacts} contacts of {unknowns} unknowns, W alone"))?;
        say_ending(status, sweeps, stop)?;
        say(format_args!("  iterating {seconds:.3e} s"))?;
        say(format_args!("  natural_map      {natural_map:.3e}"))?;
    }
    Ok(exit::code(status))
}
