//! `gravel report`, `gravel figure` and `gravel table`: tables and figures of the newest stored study of a plan, without
//! running it.

use crate::cli::args::PlanArgs;
use crate::plan::{Plan, chart, key_value};
use crate::root::Root;
use crate::store::{about, draw, stored, tables_of};
use crate::terminal::{prepare_place, read_text, say, suggest, write_whole};
use anyhow::{Context, Result, bail};
use reports::{Chart, Formats, Pick, Style, TableFormat, Wanted, use_style};
use results::journal::Record;
use results::schema::Run;
use results::simulation::Simulated;
use results::study::{Runs, Study as Rows};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use wildmatch::WildMatch;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: PlanArgs,
    #[command(flatten)]
    formats: FormatArgs,
    #[command(flatten)]
    style: StyleArgs,
    /// Draw from the tables in FOLDER, such as one of results/archive, not from the newest study in results/runs
    #[arg(long, value_name = "FOLDER")]
    rows: Option<PathBuf>,
    /// Compare with an earlier study of the plan, run by run: the folder of its tables
    #[arg(long, value_name = "FOLDER")]
    against: Option<PathBuf>,
    /// Fill a template with numbers of the study's runs as well: FILE.in becomes FILE, beside it
    #[arg(long, value_name = "FILE.in")]
    fill: Option<PathBuf>,
}

#[derive(clap::Args)]
pub(crate) struct FigureArgs {
    /// The chart; `gravel list charts` shows them
    #[arg(value_parser = chart)]
    chart: Chart,
    #[command(flatten)]
    study: PlanArgs,
    /// Only the runs with this problem, method or variant, such as method=latin-dd or problem=shear*; of simulations `scene` in place of
    /// `problem`; may be repeated: a run must match all
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    #[command(flatten)]
    formats: FormatArgs,
    #[command(flatten)]
    style: StyleArgs,
    /// Draw from the tables in FOLDER, such as one of results/archive, not from the newest study in results/runs
    #[arg(long, value_name = "FOLDER")]
    rows: Option<PathBuf>,
    /// Title of the figures; empty for none
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Width of a figure and height of its panels [default: 175 mm, a journal's page]
    #[arg(long, value_name = "MMxMM", value_parser = size)]
    size: Option<(f64, f64)>,
}

#[derive(clap::Args)]
pub(crate) struct TableArgs {
    /// The table: the name of its files in the report
    #[arg(default_value = "iterations")]
    table: String,
    #[command(flatten)]
    study: PlanArgs,
    /// Its columns in this order, by their names in the CSV file [default: those that the page shows]
    #[arg(long, value_name = "A,B,…", value_delimiter = ',')]
    columns: Vec<String>,
    /// Only rows whose value matches, such as method=nsgs* or iterations=1??; may be repeated: a row must
    /// match all
    #[arg(long, value_name = "COLUMN=PATTERN", value_parser = key_value)]
    rows: Vec<(String, String)>,
    /// Write it to FILE, whose ending says the format: .tex, .csv or .md [default: Markdown on standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
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

/// Style of figures on the command line.
#[derive(clap::Args)]
struct StyleArgs {
    /// Draw in the style of FILE: size, title, font, names, colours and signs of methods; harness/how-to.md has its keys
    #[arg(long, value_name = "FILE.toml")]
    style: Option<PathBuf>,
}

impl StyleArgs {
    /// Takes the style for all figures of this process, with what `replaces` it.
    fn take(&self, replaces: impl FnOnce(&mut Style)) -> Result<()> {
        let Some(path) = &self.style else {
            let mut style = Style::default();
            replaces(&mut style);
            return use_style(style, None).map_err(anyhow::Error::msg);
        };
        let of_file = || {
            let mut style: Style = toml::from_str(&read_text(path)?)?;
            replaces(&mut style);
            // Beside its file.
            let font = style.font.as_ref().map(|font| path.with_file_name(font));
            let bytes =
                font.map(|font| fs::read(&font).with_context(|| format!("`font` = {}", font.display())));
            use_style(style, bytes.transpose()?).map_err(anyhow::Error::msg)
        };
        of_file().with_context(|| format!("--style {}", path.display()))
    }
}

/// Reads a size such as `85x50` (mm).
fn size(text: &str) -> Result<(f64, f64), String> {
    let length = |text: &str| text.parse::<f64>().ok().filter(|length| *length >= 20.0 && *length <= 400.0);
    text.split_once('x')
        .and_then(|(width, height)| Some((length(width)?, length(height)?)))
        .ok_or_else(|| "a size is like 85x50, both 20 to 400 mm".to_owned())
}

impl FormatArgs {
    fn formats(&self) -> Formats {
        Formats { png: self.png, pdf: self.pdf }
    }
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    args.style.take(|_| {})?;
    let plan = Plan::read(&args.study.path(root)?, args.study.quick)?;
    let stored = args.rows.clone().map_or_else(|| stored(root, &plan), Ok)?;
    let rows = tables_of(&stored)?;
    let earlier = args.against.as_deref().map(tables_of).transpose().context("--against")?;
    if earlier.is_some() && !matches!(rows, Rows::Runs(_)) {
        bail!("--against is for studies of problems, and `{}` is one through time", plan.name);
    }
    if let Some(template) = &args.fill {
        fill(&rows, &plan.charts(), template)?;
    }
    let (charts, about) = (plan.charts(), about(&plan, &args.study.again()));
    draw(root, &plan.name, &stored, args.formats.formats(), |formats, out| {
        let wanted = Wanted { charts: &charts, formats, against: earlier.as_ref() };
        Ok(reports::report(&rows, &about, wanted, out)?)
    })
}

fn fill(rows: &Rows, charts: &[Chart], template: &Path) -> Result<()> {
    if template.extension().is_none_or(|ending| ending != "in") {
        bail!("--fill {}: the name of a template ends in .in", template.display());
    }
    let text = read_text(template).context("--fill")?;
    let filled = included(template, &text).and_then(|parts| Ok(reports::fill(rows, charts, &text, &parts)?));
    let filled = filled.with_context(|| format!("--fill {}", template.display()))?;
    let page = template.with_extension("");
    write_whole(&page, &filled)?;
    say(format_args!("{}", page.display()))
}

/// Reads the parts that the text of a template includes, which lie beside it.
fn included(template: &Path, text: &str) -> Result<Vec<(String, String)>> {
    let names = text.split("{% include \"").skip(1).filter_map(|rest| Some(rest.split_once('"')?.0));
    names.map(|name| Ok((name.to_owned(), read_text(&template.with_file_name(name))?))).collect()
}

/// One chart, in a folder of its own: the report of the study stays as it is.
pub(crate) fn figure(root: &Root, args: &FigureArgs) -> Result<()> {
    args.style.take(|style| {
        style.title = args.title.clone().or(style.title.take());
        if let Some((width, height)) = args.size {
            (style.width_mm, style.panel_height_mm) = (Some(width), Some(height));
        }
    })?;
    let plan = Plan::read(&args.study.path(root)?, args.study.quick)?;
    plan.suits(args.chart)?;
    let stored = args.rows.clone().map_or_else(|| stored(root, &plan), Ok)?;
    let name = format!("{}-{}", plan.name, args.chart.name);
    let mut rows = tables_of(&stored)?;
    for (key, pattern) in &args.only {
        keep(&mut rows, key, pattern)?;
    }
    draw(root, &name, &stored, args.formats.formats(), |formats, out| {
        Ok(reports::figure(&rows, args.chart, formats, out)?)
    })
}

/// Keeps the runs or simulations of a study whose `key` matches `pattern`, in which `*` stands for any text.
fn keep(rows: &mut Rows, key: &str, pattern: &str) -> Result<()> {
    let keys = ["problem", "method", "variant"];
    let keys = if matches!(rows, Rows::Runs(_)) {
        keys
    } else {
        keys.map(|key| if key == "problem" { "scene" } else { key })
    };
    let Some(place) = keys.iter().position(|known| *known == key) else {
        bail!("--only {key}={pattern}: the key is one of {}{}", keys.join(", "), suggest::of(key, keys));
    };
    let (wanted, mut known, mut left) = (WildMatch::new(pattern), BTreeSet::new(), 0);
    let mut is_wanted = |of: [&str; 3]| {
        known.insert(of[place].to_owned());
        let is_wanted = wanted.matches(of[place]);
        left += usize::from(is_wanted);
        is_wanted
    };
    match rows {
        Rows::Runs(Runs { records, grains, contacts }) => {
            records.retain(|Record { run, .. }| is_wanted([&run.problem, &run.method, &run.variant]));
            // Samples are drawn of the problems and partitions that are left.
            let partition =
                |run: &Run| run.settings.get("subdomains").and_then(Value::as_str).map(str::to_owned);
            let drawn: BTreeSet<(&str, Option<String>)> =
                records.iter().map(|Record { run, .. }| (run.problem.as_str(), partition(run))).collect();
            let is_drawn = |problem: &str, at: &str| {
                drawn.contains(&(problem, Some(at.trim_end_matches("-balanced").to_owned())))
            };
            grains.retain(|grain| is_drawn(&grain.problem, &grain.partition));
            contacts.retain(|contact| is_drawn(&contact.problem, &contact.partition));
        }
        Rows::Simulations(all) => all.retain(|Simulated { simulation, .. }| {
            is_wanted([&simulation.scene, &simulation.method, &simulation.variant])
        }),
    }
    if left == 0 {
        let what = format!("--only {key}={pattern}: there is none");
        bail!("{}", suggest::among(&what, pattern, known.iter().map(String::as_str)));
    }
    Ok(())
}

/// One table, in part.
pub(crate) fn table(root: &Root, args: &TableArgs) -> Result<()> {
    let TableArgs { table, study, columns, rows, output } = args;
    let format = match output {
        None => TableFormat::Markdown,
        Some(file) => {
            prepare_place(file)?;
            format_of(file)?
        }
    };
    let plan = Plan::read(&study.path(root)?, study.quick)?;
    let pick = Pick { table, columns, rows, format };
    let text = reports::table(&tables_of(&stored(root, &plan)?)?, &plan.charts(), pick)?;
    match output {
        None => say(format_args!("{}", text.trim_end())),
        Some(file) => {
            write_whole(file, &text)?;
            say(format_args!("{}", file.display()))
        }
    }
}

fn format_of(file: &Path) -> Result<TableFormat> {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("tex") => Ok(TableFormat::Latex),
        Some("csv") => Ok(TableFormat::Csv),
        Some("md") => Ok(TableFormat::Markdown),
        _ => bail!("--output {}: the name of a table ends in .tex, .csv or .md", file.display()),
    }
}
