//! `gravel report` and `gravel figure`: tables and figures of the newest stored study of a plan, without running it.

use crate::inputs::Root;
use crate::output::say;
use crate::plan::Plan;
use anyhow::{Result, bail};
use reports::Chart;
use results::store::{latest, read};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A plan, or a stored study: its name, or the path of the plan's file
    #[arg(default_value = "paper")]
    plan: String,
}

#[derive(clap::Args)]
pub(crate) struct FigureArgs {
    /// The chart
    chart: Chart,
    /// A plan, or a stored study: its name, or the path of the plan's file
    #[arg(default_value = "paper")]
    plan: String,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let study = study(root, &args.plan)?;
    // A stored study may outlive its plan.
    let plan =
        root.plan(study.strip_suffix("-quick").unwrap_or(&study)).and_then(|path| Plan::read(&path, false));
    let charts = plan.and_then(|plan| plan.charts()).unwrap_or_else(|_| Chart::default_set().to_vec());
    draw(root, &study, &charts, &study)
}

/// One chart, in a folder of its own: the report of the study stays as it is.
pub(crate) fn figure(root: &Root, args: &FigureArgs) -> Result<()> {
    let study = study(root, &args.plan)?;
    draw(root, &study, &[args.chart], &format!("{study}-{}", args.chart.name()))
}

/// Name of the stored studies that `name` means.
fn study(root: &Root, name: &str) -> Result<String> {
    if !name.is_empty() && !name.contains(['/', '\\', '.']) && latest(&runs(root), name).is_some() {
        return Ok(name.to_owned());
    }
    Ok(Plan::read(&root.plan(name)?, false)?.name)
}

fn runs(root: &Root) -> PathBuf {
    root.join("results/runs")
}

fn draw(root: &Root, study: &str, charts: &[Chart], folder: &str) -> Result<()> {
    let Some(stored) = latest(&runs(root), study) else {
        bail!("no stored study of plan `{study}` in {}: `gravel bench` makes one", runs(root).display());
    };
    let out = root.join("reports/out").join(folder);
    let files = reports::report(&read(&stored)?, charts, &out)?;
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
