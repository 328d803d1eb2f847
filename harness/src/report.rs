//! `gravel report` and `gravel figure`: tables and figures of the newest stored study of a plan, without running it.

use crate::inputs::Root;
use crate::output::say;
use crate::plan::Plan;
use anyhow::{Result, bail};
use reports::Chart;
use results::store::{latest, read, read_simulations};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
}

#[derive(clap::Args)]
pub(crate) struct FigureArgs {
    /// The chart
    chart: Chart,
    #[command(flatten)]
    of: Args,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let plan = Plan::read(&root.plan(&args.plan)?, args.quick)?;
    draw(root, &plan, &plan.charts()?, &plan.name)
}

/// One chart, in a folder of its own: the report of the study stays as it is.
pub(crate) fn figure(root: &Root, args: &FigureArgs) -> Result<()> {
    let plan = Plan::read(&root.plan(&args.of.plan)?, args.of.quick)?;
    plan.suits(args.chart)?;
    draw(root, &plan, &[args.chart], &format!("{}-{}", plan.name, args.chart.name()))
}

fn draw(root: &Root, plan: &Plan, charts: &[Chart], folder: &str) -> Result<()> {
    let runs = root.join("results/runs");
    let Some(stored) = latest(&runs, &plan.name) else {
        bail!("no study of plan `{}` is stored in {}: `gravel bench` makes one", plan.name, runs.display());
    };
    let out = root.join("reports/out").join(folder);
    let files = if plan.simulate.is_some() {
        reports::report_simulations(&read_simulations(&stored)?, charts, &out)?
    } else {
        reports::report(&read(&stored)?, charts, &out)?
    };
    say(format_args!("rows and curves   {}", stored.display()))?;
    say_files(&out, &files)
}

/// Where the files of a report are, and their names.
pub(crate) fn say_files(out: &Path, files: &[PathBuf]) -> Result<()> {
    say(format_args!("tables and figures {}", out.display()))?;
    for file in files {
        say(format_args!("  {}", file.file_name().unwrap_or_default().to_string_lossy()))?;
    }
    Ok(())
}
