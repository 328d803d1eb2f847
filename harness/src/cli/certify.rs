//! `gravel certify`: what a solution leaves of the contact problem, condition by condition.

use crate::problems::{Found, Given, found};
use crate::root::Root;
use crate::terminal::{exit, progress, say};
use anyhow::Result;
use cases::AnyFrozen;
use lineup::{Frictional, Law, OneProblem};
use reference::{Certificate, ENERGY_ROUND_OFF, Existence, Isolation, ROUND_OFF, RoughSolution, SEARCHES};
use std::path::PathBuf;
use std::process::ExitCode;

/// Text below the help, above that of the exit codes.
pub(crate) const HELP: &str = "\
That a method has converged is no claim that a solution exists: where contacts close more slowly than its tolerance
tells, `gravel solve` may say converged, and this command prove that there is no solution. `gravel solve --truth` looks
for that proof as well.";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem: its name, or the path of its file
    problem: String,
    /// Certify these impulses instead of the reference, and report how far from it they are: a file with
    /// {"impulse": [N·s, in the problem's contact order]}, as `gravel solve --impulses` writes it
    #[arg(long, value_name = "FILE")]
    impulses: Option<PathBuf>,
    /// With friction: seek solutions from r = 0 and from N more starts; those found are kept
    #[arg(long, value_name = "N", default_value = "3")]
    starts: u64,
    /// With friction, at rest: where none of the starts leads to a solution, seek one by continuation, from the problem in which
    /// gaps close as fast as grains fall to the problem itself; may take minutes
    #[arg(long)]
    continuation: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let frozen = AnyFrozen::read(&root.problem(&args.problem)?)?;
    let name = frozen.name().to_owned();
    let problem = &*lineup::problem(frozen);
    let facts = problem.facts();
    let given = args.impulses.as_deref().map(|file| Given::read(file, &facts)).transpose()?;
    let given = given.map(|given| (problem.certify(&given.impulse), given.impulse));
    let found = found(root, problem, args.starts)?;
    say(format_args!("{name}: {}", facts.size()))?;
    if let Some((certificate, _)) = &given {
        say(format_args!("given impulses: {}", verdict(certificate)))?;
        print(certificate)?;
    }
    let Some(Found { mut solutions, why }) = found else {
        say(format_args!(
            "the problem has no solution: normal impulses balance, in exact arithmetic, while contacts approach"
        ))?;
        return Ok(exit::code("no-solution"));
    };
    let r = given.as_ref().map(|(_, r)| &**r);
    match problem.law() {
        Law::Frictionless(_) => say_one(problem, &solutions, &why, r)?,
        Law::Frictional(law) => {
            say(format_args!("{}", existence_in_words(law.existence())))?;
            if args.continuation && !solutions.iter().any(|solution| solution.certificate.certified()) {
                let bar = progress::bar(SEARCHES, "searches");
                solutions = law.continued(&mut || bar.inc(1)).map_or(solutions, |found| vec![found]);
            }
            say_several(problem, law, &solutions, r)?;
        }
    }
    // Where there is a solution, the given impulses are what is asked about; `take` keeps no other beside one that is certified.
    let found = solutions.first().map(|solution| &solution.certificate);
    Ok(exit::code(given.as_ref().map(|(certificate, _)| certificate).or(found).map_or("not certified", word)))
}

/// Prints the reference solution of a frictionless problem, or how far the `given` impulses (N·s) are from it.
fn say_one(
    problem: &dyn OneProblem,
    solutions: &[RoughSolution],
    why: &str,
    given: Option<&[f64]>,
) -> Result<()> {
    for RoughSolution { impulses, certificate } in solutions {
        say(format_args!("reference: {}{why}", verdict(certificate)))?;
        let Some(given) = given.filter(|_| certificate.certified()) else {
            print(certificate)?;
            continue;
        };
        let measures = problem.measures(std::slice::from_ref(impulses), given);
        say(format_args!("the given impulses beside it"))?;
        say(format_args!("  {:<17}{:>10.1e}", "velocity_error", measures.velocity_error))?;
        say(format_args!("  {:<17}{:>10.1e}", "energy_gap", measures.energy_gap))?;
    }
    Ok(())
}

/// Prints each solution of a problem with friction, and how far apart they are.
fn say_several(
    problem: &dyn OneProblem,
    law: &dyn Frictional,
    pool: &[RoughSolution],
    given: Option<&[f64]>,
) -> Result<()> {
    let apart = |given| pool.iter().map(move |solution| problem.distance(&solution.impulses, given));
    let nearest = given.and_then(|given| apart(given).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)));
    if let Some((n, apart)) = nearest {
        say(format_args!("  its velocity is nearest to that of solution {}: {apart:.1e} apart", n + 1))?;
    }
    for (n, solution) in pool.iter().enumerate() {
        let apart = problem.distance(&pool[0].impulses, &solution.impulses);
        let of_first =
            if n == 0 { String::new() } else { format!(", {apart:.1e} from the first in velocity") };
        say(format_args!("solution {}: {}{of_first}", n + 1, verdict(&solution.certificate)))?;
        if given.is_none() {
            print(&solution.certificate)?;
        }
        if solution.certificate.certified() {
            say(format_args!("  {}", isolation_in_words(&law.isolation(&solution.impulses))))?;
        }
    }
    if pool.len() > 1 {
        let all: Vec<&[f64]> = pool.iter().map(|solution| &*solution.impulses).collect();
        let spread = problem.spread(&all);
        say(format_args!("spread of the {} solutions in velocity: {spread:.2e}", pool.len()))?;
    }
    Ok(())
}

/// Returns, in words, whether a solution exists.
fn existence_in_words(existence: Option<Existence>) -> &'static str {
    match existence {
        Some(Existence::AtRest) => {
            "a solution exists: no wall drives a contact at rest, and no gap is negative"
        }
        Some(Existence::Moving) => {
            "a solution exists: there are velocities with v_n ≥ μ|v_t| at every contact"
        }
        None => {
            "whether a solution exists is unknown: no velocities were found with v_n ≥ μ|v_t| at every contact"
        }
    }
}

/// Returns, in words, whether a solution is isolated.
fn isolation_in_words(isolation: &Isolation) -> String {
    let Isolation { margin, least_singular_value, unknowns, .. } = isolation;
    let (word, near) = if isolation.is_isolated() {
        ("isolated", format!(", the solution is within {:.1e}", isolation.error()))
    } else {
        ("not known to be isolated", String::new())
    };
    format!(
        "{word}: a status changes at {margin:.1e} of the scale{near}; the matrix of the statuses has {unknowns} unknowns and the \
         least singular value {least_singular_value:.1e}"
    )
}

fn word(certificate: &Certificate) -> &'static str {
    if certificate.certified() { "certified" } else { "not certified" }
}

fn verdict(certificate: &Certificate) -> String {
    format!("{} to {ROUND_OFF:e}", word(certificate))
}

fn print(certificate: &Certificate) -> Result<()> {
    say(format_args!("  {:<17}{:>10}  absolute", "", "relative"))?;
    for (name, residual) in certificate.residuals() {
        let unit = match name {
            "approach" | "complementarity" | "sliding" => "m/s",
            "natural_map" => "√J",
            "duality_gap" => "J",
            _ => "N·s",
        };
        let limit = if name == "natural_map" { ENERGY_ROUND_OFF } else { ROUND_OFF };
        let above = if residual.relative <= limit { String::new() } else { format!(", above {limit:e}") };
        say(format_args!(
            "  {name:<17}{:>10.1e}  {:.1e} {unit}{above}",
            residual.relative, residual.absolute
        ))?;
    }
    Ok(())
}
