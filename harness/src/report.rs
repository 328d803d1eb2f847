//! `gravel report` and `gravel figure`: tables and figures of the newest stored study of a plan, without running it.

use crate::bench::runs_folder;
use crate::inputs::Root;
use crate::output::say;
use crate::plan::Plan;
use anyhow::{Result, bail};
use reports::Chart;
use results::store::{Tables, read, tables_folder};
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
    let plan = plan(root, args)?;
    let (tables, stored) = stored(root, &plan.name)?;
    draw(root, &tables, &plan.charts, &stored, &plan.name)
}

/// One chart, in a folder of its own: the report of the study stays as it is.
pub(crate) fn figure(root: &Root, args: &FigureArgs) -> Result<()> {
    let plan = plan(root, &args.of)?;
    let (tables, stored) = stored(root, &plan.name)?;
    draw(root, &tables, &[args.chart], &stored, &format!("{}-{}", plan.name, args.chart.name()))
}

fn plan(root: &Root, args: &Args) -> Result<Plan> {
    Plan::read(&root.plan(&args.plan)?, args.quick)
}

/// The tables of a study, and where they are.
fn stored(root: &Root, study: &str) -> Result<(Tables, PathBuf)> {
    let runs = runs_folder(root);
    let Some(folder) = tables_folder(&runs, study) else {
        bail!("no study of plan `{study}` is stored in {}: `gravel bench` makes one", runs.display());
    };
    Ok((read(&folder)?, folder))
}

/// Draws charts of a study into a folder of reports/out, and says where all is.
pub(crate) fn draw(
    root: &Root,
    tables: &Tables,
    charts: &[Chart],
    stored: &Path,
    folder: &str,
) -> Result<()> {
    let out = root.join("reports/out").join(folder);
    let files = reports::report(tables, charts, &out)?;
    say(format_args!("rows and curves   {}", stored.display()))?;
    say(format_args!("tables and figures {}", out.display()))?;
    for file in files {
        say(format_args!("  {}", file.file_name().unwrap_or_default().to_string_lossy()))?;
    }
    Ok(())
}
