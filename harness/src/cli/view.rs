//! `gravel view`: a page that shows how runs come to the impulses of a problem, or how a stored run did, iteration by
//! iteration.

use crate::cli::args::{SceneArgs, StopArgs};
use crate::plan::{Method, Variant, key_value};
use crate::problems::{Known, Problem};
use crate::root::Root;
use crate::run::{Ended, Snapshots, ended, partitions, scene_rows};
use crate::store::{is_id, problem_of_run, stored_run};
use crate::terminal::{create_folder_of, prepare_place, say, write_whole};
use anyhow::{Context, Result, bail};
use partition::{Grid, Scheme};
use results::journal::Record;
use results::name::Name;
use results::schema::Run;
use runner::{Measured, Progress, Stop};
use std::ops::ControlFlow;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case, by name or by the path of its file; or a run that a study stored: its id, or any
    /// unambiguous prefix of it
    #[arg(value_name = "PROBLEM-OR-RUN")]
    problem: String,
    #[command(flatten)]
    scene: SceneArgs,
    /// A run to show: a method with its settings, such as "nsgs-dd subdomains=4x2"; may be repeated; of a problem
    /// without any, NSGS, LATIN-DD with directions that stay, on up to 4x2 subdomains, and CG. Of a stored run: one to show
    /// beside it
    #[arg(long = "run", value_name = "METHOD [KEY=VALUE …]")]
    runs: Vec<String>,
    #[command(flatten)]
    stop: StopArgs,
    /// The page [default: reports/out/view-PROBLEM-OR-RUN.html]; one that is there is replaced
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Returns the runs that are shown by default: those on the page of the plan `paper`, with search directions that stay fixed;
/// on fewer subdomains where there are not as many contacts.
pub(super) fn runs_of(contacts: usize) -> [String; 3] {
    const GRIDS: [Grid; 3] = [Grid::of(4, 2), Grid::of(2, 2), Grid::of(2, 1)];
    let grid = GRIDS.into_iter().find(|grid| grid.count() <= contacts as u64).unwrap_or(Grid::ONE);
    let latin = format!("latin-dd adaptive=false subdomains={grid}");
    ["nsgs".to_owned(), latin, "cg preconditioner=diagonal".to_owned()]
}

/// Content of a page.
struct Shown {
    problem: Problem,
    stop: Stop,
    /// A stored run, if one is shown: it is the first of the variants.
    stored: Option<Record>,
    variants: Vec<Variant>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let shown = args.shown(root)?;
    let Shown { problem, stored, variants, .. } = &shown;
    let name = stored.as_ref().map_or(&problem.name, |record| &record.run.id);
    let file = format!("view-{name}.html");
    let default = || root.kept("reports/out", &file).unwrap_or_else(|| file.clone().into());
    let page = args.output.clone().unwrap_or_else(default);
    if args.output.is_none() {
        create_folder_of(&page)?;
    }
    prepare_place(&page)?;

    let known = problem.known(root)?;
    let mut filmed = Vec::new();
    for (n, variant) in variants.iter().enumerate() {
        filmed.push(shown.iterates(variant, stored.as_ref().filter(|_| n == 0), known)?);
    }
    let mut split = partitions(variants);
    if split.is_empty() {
        split.push(("1x1".to_owned(), Grid::ONE, Scheme::Boxes));
    }
    let r = known.impulses.first().map(Vec::as_slice);
    let (grains, contacts) = scene_rows((&problem.name, problem.posed.grains()?), &split, r);
    let html = reports::view(&problem.name, (&grains, &contacts), filmed, &args.again())?;
    write_whole(&page, &html)?;
    say(format_args!("{}", page.display()))
}

impl Args {
    fn shown(&self, root: &Root) -> Result<Shown> {
        let mut variants: Vec<Variant> = self.runs.iter().map(|text| variant(text)).collect::<Result<_>>()?;
        let path = match root.problem_or_case(&self.problem) {
            Err(_) if is_id(&self.problem) => {
                return self.shown_of(root, stored_run(root, &self.problem)?, variants);
            }
            path => path?,
        };
        let problem = Problem::alone(self.scene.problem(&path)?, true);
        if variants.is_empty() {
            let runs = runs_of(problem.posed.facts().contacts);
            variants = runs.iter().map(|text| variant(text)).collect::<Result<_>>()?;
        }
        Ok(Shown { problem, stop: self.stop.of(Stop::default())?, stored: None, variants })
    }

    /// A stored run, and `others` beside it that begin as it does.
    fn shown_of(&self, root: &Root, record: Record, others: Vec<Variant>) -> Result<Shown> {
        let run = &record.run;
        let warm_start = run.warm_start;
        let name = format!("run {} ({} on {})", run.id, run.method, run.problem);
        self.scene.refused(&format!("{name} is stored"))?;
        let stop = self.stop.of(stop_of(run))?;
        let method = Method::new(&run.method, run.settings.clone()).with_context(|| name.clone())?;
        let mut variants =
            vec![Variant { method, warm_start, name: run.variant.clone(), problems: Vec::new() }];
        variants.extend(others.into_iter().map(|other| Variant { warm_start, ..other }));
        let problem = Problem::alone(problem_of_run(root, run).context(name)?, true);
        Ok(Shown { problem, stop, stored: Some(record), variants })
    }

    /// The command.
    fn again(&self) -> String {
        let runs = self.runs.iter().map(|run| format!("--run '{run}'"));
        let words = self.scene.again().chain(runs).chain(self.stop.again()).map(|word| format!(" {word}"));
        format!("gravel view {}{}", self.problem, words.collect::<String>())
    }
}

impl Shown {
    /// The iterates of a run: those that are `stored`, or else those of a run now.
    fn iterates(
        &self,
        variant: &Variant,
        stored: Option<&Record>,
        known: &Known,
    ) -> Result<reports::Snapshots> {
        let problem = &self.problem;
        let label = variant.label();
        let as_stored = stored.filter(|record| stop_of(&record.run) == self.stop);
        if let Some(Record { run, snapshots, .. }) = as_stored.filter(|record| !record.snapshots.is_empty()) {
            let ending = run.status.name().replace('-', " ");
            say(format_args!("{label}: {ending} after {} iterations, as stored", run.iterations))?;
            return Ok(reports::Snapshots { label, ending, snapshots: snapshots.clone() });
        }
        let (mut kept, start) = (Snapshots::of(&problem.posed), problem.start(variant.warm_start));
        let observe = &mut |progress: &Progress| {
            kept.observe(progress);
            ControlFlow::Continue(())
        };
        let truths = &known.impulses;
        let run = lineup::Run { truths, r0: &start, stop: &self.stop, measured: Measured::Grid };
        let on_problem = || format!("method `{}` on {}", variant.method.name, problem.name);
        let Ended { outcome, failed, .. } =
            ended(&variant.method, problem, run, observe).with_context(on_problem)?;
        if let Some(why) = failed {
            bail!("{}: {why}", on_problem());
        }
        let (ending, iterations) = (outcome.status.name().replace('-', " "), outcome.iterations);
        let why = match (stored, as_stored) {
            (None, _) => "",
            (Some(_), None) => ", run again with another stop rule",
            (Some(_), Some(_)) => ", run again: its iterates are not stored",
        };
        say(format_args!("{label}: {ending} after {iterations} iterations{why}"))?;
        if let Some(Record { run, .. }) = as_stored.filter(|record| record.run.iterations != iterations) {
            say(format_args!("  the stored run took {}: the method has changed since", run.iterations))?;
        }
        Ok(reports::Snapshots { label, ending, snapshots: kept.finish(&outcome) })
    }
}

/// The stop rule of a stored run.
fn stop_of(run: &Run) -> Stop {
    Stop { on: run.stop_on.0, tolerance: run.tolerance, max_iterations: run.max_iterations }
}

/// A method and its settings in one text.
pub(super) fn variant(text: &str) -> Result<Variant> {
    let (name, settings) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    let pairs = settings.split_whitespace().map(|word| key_value(word).map_err(anyhow::Error::msg));
    let read = || Method::parse(name, &pairs.collect::<Result<Vec<_>>>()?);
    let method = read().with_context(|| format!("--run '{text}'"))?;
    Ok(Variant { method, warm_start: false, name: settings.trim().to_owned(), problems: Vec::new() })
}
