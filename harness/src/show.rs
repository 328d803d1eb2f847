//! `gravel plan`: the runs of a plan, and how many they are, with nothing run.

use crate::asked::{Asked, StudyArgs};
use crate::inputs::Root;
use crate::output::say;
use anyhow::Result;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// The numbers of runs alone
    #[arg(long)]
    count: bool,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let study = args.study.asked(root)?;
    say(format_args!("plan {}: {}", study.plan.name, study.plan.why))?;
    for note in &study.notes {
        say(format_args!("  {note}"))?;
    }
    if !args.count {
        let problems = study.problems.iter().map(|problem| problem.name.chars().count());
        let width = problems.max().unwrap_or(0);
        for problem in &study.problems {
            for variant in &study.variants {
                let run = format!("{:<width$}  {} {}", problem.name, variant.method.name, variant.name);
                say(format_args!("  {}", run.trim_end()))?;
            }
        }
    }
    let rules = study.plan.rules()?;
    for (_, name) in &rules {
        say(format_args!("  each under the rule  {name}"))?;
    }
    say_counts(&study)
}

/// Runs on each problem, of each method, and in all.
fn say_counts(study: &Asked) -> Result<()> {
    let rules = study.rules();
    let (problems, variants) = (study.problems.len() * rules, study.variants.len() * rules);
    let mut methods: Vec<(&str, usize)> = Vec::new();
    for variant in &study.variants {
        match methods.iter_mut().find(|(name, _)| *name == variant.method.name) {
            Some((_, runs)) => *runs += problems,
            None => methods.push((variant.method.name, problems)),
        }
    }
    let on = study.problems.iter().map(|problem| (format!("on {}", problem.name), variants));
    let of = methods.into_iter().map(|(name, runs)| (format!("of {name}"), runs));
    let all = std::iter::once(("in all".to_owned(), study.runs()));
    say(format_args!("runs"))?;
    for (what, runs) in on.chain(of).chain(all) {
        say(format_args!("  {runs:>7}  {what}"))?;
    }
    Ok(())
}
