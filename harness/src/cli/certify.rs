//! `gravel certify`: what a solution leaves of the contact problem, condition by condition.

use crate::problems::{Given, Root, answer, size};
use crate::terminal::{exit, say};
use anyhow::Result;
use cases::Frozen;
use contact::{ContactProblem, Meter, Truth};
use reference::{Answer, Certificate, ENERGY_ROUND_OFF, ROUND_OFF, certify};
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
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    let frozen = Frozen::read(&root.problem(&args.problem)?)?;
    let problem = &frozen.problem;
    let given = args.impulses.as_deref().map(|file| Given::read(file, problem)).transpose()?;
    let reference = answer(root, &frozen)?;
    say(format_args!("{}: {}", frozen.name, size(problem)))?;
    let of_given = given.as_ref().map(|given| certify(problem, &given.impulse));
    if let Some(certificate) = &of_given {
        say(format_args!("given impulses: {}", verdict(certificate)))?;
        print(certificate)?;
    }
    let of_reference = match &reference {
        Answer::Infeasible { .. } => {
            say(format_args!("the problem has no solution: impulses balance while contacts approach"))?;
            return Ok(exit::code("no-solution"));
        }
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
            "approach" | "complementarity" => "m/s",
            "pull" | "momentum" => "N·s",
            "natural_map" => "√J",
            _ => "J",
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

fn print_errors(problem: &ContactProblem, truth: &Truth, impulses: &[f64]) -> Result<()> {
    let measures = Meter::new(problem).against(truth).measure(impulses, 0.0);
    say(format_args!("the given impulses beside it"))?;
    say(format_args!("  {:<17}{:>10.1e}", "velocity_error", measures.velocity_error))?;
    say(format_args!("  {:<17}{:>10.1e}", "energy_gap", measures.energy_gap))
}
