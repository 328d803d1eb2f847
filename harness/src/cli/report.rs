//! `gravel report` and `gravel figure`: tables and figures of the newest stored study of a plan, without running it.

use crate::plan::Plan;
use crate::problems::Root;
use crate::store::{about, runs_folder, say_files};
use crate::terminal::{say, write_whole};
use anyhow::{Context, Result, bail};
use reports::{Chart, Formats, Wanted, made};
use results::store::{read, tables_folder};
use results::study::Study as Rows;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: Stored,
    #[command(flatten)]
    formats: FormatArgs,
    /// Compare with an earlier study of the plan, run by run: the folder of its tables
    #[arg(long, value_name = "FOLDER")]
    against: Option<PathBuf>,
    /// Fill a template with numbers of the study's runs as well: FILE.in becomes FILE, beside it
    #[arg(long, value_name = "FILE.in")]
    fill: Option<PathBuf>,
}

#[derive(clap::Args)]
pub(crate) struct FigureArgs {
    /// The chart
    chart: Chart,
    #[command(flatten)]
    study: Stored,
    #[command(flatten)]
    formats: FormatArgs,
}

/// A stored study on the command line.
#[derive(clap::Args)]
struct Stored {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
    /// The quick form of the plan
    #[arg(long)]
    quick: bool,
}

/// Formats of figures on the command line.
#[derive(clap::Args)]
struct FormatArgs {
    /// Figures as PNG too, 300 pixels to the inch; from then on, until the files are deleted
    #[arg(long)]
    png: bool,
    /// Figures as PDF too; from then on, until the files are deleted
    #[arg(long)]
    pdf: bool,
}

impl FormatArgs {
    /// Those asked for, and those of the files that are there.
    fn formats(&self, before: &[String]) -> Formats {
        Formats { png: self.png, pdf: self.pdf }.and_those_of(before)
    }
}

impl Stored {
    fn plan(&self, root: &Root) -> Result<Plan> {
        Plan::read(&root.plan(&self.plan)?, self.quick)
    }

    /// The arguments that ask for the same.
    fn again(&self) -> String {
        format!("{}{}", self.plan, if self.quick { " --quick" } else { "" })
    }
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let plan = args.study.plan(root)?;
    let stored = stored(root, &plan)?;
    let about = about(&plan, &args.study.again());
    let out = root.join("reports/out").join(&plan.name);
    let rows = read(&stored)?;
    let earlier = args.against.as_deref().map(read).transpose().context("--against")?;
    if (args.fill.is_some() || earlier.is_some()) && !matches!(rows, Rows::Runs(_)) {
        bail!("--against and --fill are for studies of problems, and `{}` is one through time", plan.name);
    }
    let before = made(&out);
    let (charts, formats) = (plan.charts(), args.formats.formats(&before));
    let wanted = Wanted { charts: &charts, formats, against: earlier.as_ref() };
    if let Some(template) = &args.fill {
        fill(&rows, template)?;
    }
    let files = reports::report(&rows, &about, wanted, &out)?;
    say_files(&stored, &out, &files, &before)
}

fn fill(rows: &Rows, template: &Path) -> Result<()> {
    if template.extension().is_none_or(|ending| ending != "in") {
        bail!("--fill {}: the name of a template ends in .in", template.display());
    }
    let text = std::fs::read_to_string(template).with_context(|| format!("--fill {}", template.display()))?;
    let filled = reports::fill(rows, &text).with_context(|| format!("--fill {}", template.display()))?;
    let page = template.with_extension("");
    write_whole(&page, &filled)?;
    say(format_args!("{}", page.display()))?;
    Ok(())
}

/// One chart, in a folder of its own: the report of the study stays as it is.
pub(crate) fn figure(root: &Root, args: &FigureArgs) -> Result<()> {
    let plan = args.study.plan(root)?;
    plan.suits(args.chart)?;
    let stored = stored(root, &plan)?;
    let out = root.join("reports/out").join(format!("{}-{}", plan.name, args.chart.name()));
    let before = made(&out);
    let formats = args.formats.formats(&before);
    let files = reports::figure(&read(&stored)?, args.chart, formats, &out)?;
    say_files(&stored, &out, &files, &before)
}

/// The folder of the study of `plan`.
fn stored(root: &Root, plan: &Plan) -> Result<PathBuf> {
    let runs = runs_folder(root);
    tables_folder(&runs, &plan.name).with_context(|| {
        let quick = tables_folder(&runs, &format!("{}-quick", plan.name));
        let quick = if quick.is_some() { "; its quick form is: add --quick" } else { "" };
        let runs = runs.display();
        format!("no study of plan `{}` is stored in {runs}{quick}: `gravel bench` makes one", plan.name)
    })
}
