//! `gravel certify`: what a solution leaves of the contact problem, condition by condition.

use crate::problems::{Given, Root, Studied, answer, pool, size};
use crate::terminal::{exit, say};
use active_set::ActiveSet;
use analysis::Meter;
use anyhow::Result;
use cases::{AnyFrozen, Frozen};
use contact::{ContactProblem, Packing, RoughDiscs, Smooth, Solver, Truth, greatest};
use reference::{
    Answer, Certificate, ENERGY_ROUND_OFF, Existence, Isolation, ROUND_OFF, Rough, RoughSolution, certify,
    distance, existence, isolation,
};
use std::path::PathBuf;
use std::process::ExitCode;

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
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    match AnyFrozen::read(&root.problem(&args.problem)?)? {
        AnyFrozen::Discs(frozen) => smooth(root, args, &frozen),
        AnyFrozen::RoughDiscs(frozen) => rough(root, args, &frozen, Some(&IN_THE_PLANE)),
        AnyFrozen::Spheres(frozen) => smooth(root, args, &frozen),
        AnyFrozen::RoughSpheres(frozen) => rough(root, args, &frozen, None),
    }
}

/// Further analyses of a problem with friction: existence of a solution, and isolation of one.
struct Theory<M: Rough> {
    existence: fn(&Packing<M>) -> &'static str,
    isolation: fn(&Packing<M>, &[f64]) -> String,
}

const IN_THE_PLANE: Theory<RoughDiscs> = Theory {
    existence: existence_in_words,
    isolation: |problem, r| isolation_in_words(&isolation(problem, r)),
};

/// Certifies a problem with friction: each solution of the pool, and how far apart they are.
fn rough<M: Studied + Rough>(
    root: &Root,
    args: &Args,
    frozen: &Frozen<M>,
    theory: Option<&Theory<M>>,
) -> Result<ExitCode>
where
    ActiveSet: Solver<M>,
{
    let problem = &frozen.problem;
    let given = args.impulses.as_deref().map(|file| Given::read(file, problem)).transpose()?;
    let pool = pool(root, frozen, args.starts)?;
    say(format_args!("{}: {}", frozen.name, size(problem)))?;
    let of_given = given.as_ref().map(|given| certify(problem, &given.impulse));
    if let Some(certificate) = &of_given {
        say(format_args!("given impulses: {}", verdict(certificate)))?;
        print(certificate)?;
    }
    let Some(pool) = pool else { return no_solution() };
    let unknown =
        "whether a solution exists, and whether one stands alone, is looked into between discs alone";
    say(format_args!("{}", theory.map_or(unknown, |theory| (theory.existence)(problem))))?;
    if let Some(Given { impulse, .. }) = &given
        && let Some((n, apart)) = pool
            .iter()
            .map(|solution| distance(problem, &solution.impulses, impulse))
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
    {
        say(format_args!("  its velocity is nearest to that of solution {}: {apart:.1e} apart", n + 1))?;
    }
    for (n, solution) in pool.iter().enumerate() {
        let apart = distance(problem, &pool[0].impulses, &solution.impulses);
        let of_first =
            if n == 0 { String::new() } else { format!(", {apart:.1e} from the first in velocity") };
        say(format_args!("solution {}: {}{of_first}", n + 1, verdict(&solution.certificate)))?;
        if given.is_none() {
            print(&solution.certificate)?;
        }
        if let (Some(theory), true) = (theory, solution.certificate.certified()) {
            say(format_args!("  {}", (theory.isolation)(problem, &solution.impulses)))?;
        }
    }
    if let [first, _, ..] = &pool[..] {
        let pairs = pool.iter().enumerate().flat_map(|(k, a)| pool[..k].iter().map(move |b| (a, b)));
        let apart = |a: &RoughSolution, b: &RoughSolution| {
            let [a, b] = [a, b].map(|solution| Truth::new(problem, &solution.impulses));
            problem.velocity_distance(a.velocity(), b.velocity())
        };
        let spread = greatest(pairs.map(|(a, b)| apart(a, b)));
        let size = Truth::new(problem, &first.impulses);
        let size = problem.velocity_distance(size.velocity(), problem.free_velocity());
        say(format_args!("spread of the {} solutions in velocity: {:.2e}", pool.len(), spread / size))?;
    }
    // `take` keeps no other beside one that is certified.
    let certificate = of_given.as_ref().or(pool.first().map(|solution| &solution.certificate));
    Ok(exit::code(certificate.map_or("not certified", word)))
}

/// Returns, in words, whether a solution exists.
fn existence_in_words(problem: &Packing<RoughDiscs>) -> &'static str {
    match existence(problem) {
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
    let word = if isolation.is_isolated() { "isolated" } else { "not known to be isolated" };
    format!(
        "{word}: a status changes at {margin:.1e} of the scale, the matrix of the statuses has {unknowns} unknowns and the \
         least singular value {least_singular_value:.1e}"
    )
}

fn no_solution() -> Result<ExitCode> {
    say(format_args!(
        "the problem has no solution: normal impulses balance, in exact arithmetic, while contacts approach"
    ))?;
    Ok(exit::code("no-solution"))
}

fn smooth<const D: usize>(root: &Root, args: &Args, frozen: &Frozen<Smooth<D>>) -> Result<ExitCode>
where
    Smooth<D>: Studied,
{
    let problem = &frozen.problem;
    let given = args.impulses.as_deref().map(|file| Given::read(file, problem)).transpose()?;
    let reference = answer(root, frozen)?;
    say(format_args!("{}: {}", frozen.name, size(problem)))?;
    let of_given = given.as_ref().map(|given| certify(problem, &given.impulse));
    if let Some(certificate) = &of_given {
        say(format_args!("given impulses: {}", verdict(certificate)))?;
        print(certificate)?;
    }
    let of_reference = match &reference {
        Answer::Infeasible { .. } => return no_solution(),
        Answer::Unknown { certificate, why, .. } => {
            say(format_args!("reference: {}: {why}", verdict(certificate)))?;
            print(certificate)?;
            certificate
        }
        Answer::Solution { impulses, certificate } => {
            say(format_args!("reference: {}", verdict(certificate)))?;
            match &given {
                Some(given) => print_errors(problem, &Truth::new(problem, impulses), &given.impulse)?,
                None => print(certificate)?,
            }
            certificate
        }
    };
    // Where there is a solution, the given impulses are what is asked about.
    Ok(exit::code(word(of_given.as_ref().unwrap_or(of_reference))))
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

fn print_errors<const D: usize>(
    problem: &ContactProblem<Smooth<D>>,
    truth: &Truth<Smooth<D>>,
    impulses: &[f64],
) -> Result<()> {
    let measures = Meter::new(problem).against(truth).measure(impulses, 0.0);
    say(format_args!("the given impulses beside it"))?;
    say(format_args!("  {:<17}{:>10.1e}", "velocity_error", measures.velocity_error))?;
    say(format_args!("  {:<17}{:>10.1e}", "energy_gap", measures.energy_gap))
}
