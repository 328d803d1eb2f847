//! `gravel view`: a page that shows how runs come to the impulses of a problem, or how a stored run did, iteration by
//! iteration.

use crate::film::Film;
use crate::identity::is_id;
use crate::inputs::Root;
use crate::methods::{Method, key_value};
use crate::output::{check_place, say, write_whole};
use crate::plan::Variant;
use crate::problems::of_run;
use crate::rows::{partitions, scene_rows};
use crate::solve::{SceneArgs, StopChanges, measure};
use crate::stored::stored;
use crate::truth::known;
use anyhow::{Context, Result, anyhow};
use cases::Frozen;
use contact::{Stop, Truth, solve_against};
use partition::{Grid, Scheme};
use reports::Snapshots;
use results::journal::Record;
use results::schema::Run;
use results::tables::{contacts_table, grains_table};
use std::ops::ControlFlow;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A frozen problem or a case, by name or by the path of its file; or a run that a study stored: its id, or as much of
    /// its begin as tells it from others
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
    stop: StopChanges,
    /// The page [default: reports/out/view-PROBLEM-OR-RUN.html]; one that is there is replaced
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// What is shown of a problem that nobody asks for more of: what the page of the plan `paper` shows, directions that stay
/// included; on fewer subdomains where there are not as many contacts.
fn runs_of(contacts: usize) -> [String; 3] {
    const GRIDS: [Grid; 3] = [Grid { nx: 4, ny: 2 }, Grid { nx: 2, ny: 2 }, Grid { nx: 2, ny: 1 }];
    let grid = GRIDS.into_iter().find(|grid| grid.count() <= contacts as u64).unwrap_or(Grid::ONE);
    let latin = format!("latin-dd adaptive=false subdomains={grid}");
    ["nsgs".to_owned(), latin, "cg preconditioner=diagonal".to_owned()]
}

/// What a page shows.
struct Shown {
    frozen: Frozen,
    stop: Stop,
    /// A stored run, if one was asked for: it is the first of the variants.
    stored: Option<Record>,
    variants: Vec<Variant>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let shown = args.shown(root)?;
    let Shown { frozen, stored, variants, .. } = &shown;
    let page = if let Some(page) = &args.output {
        page.clone()
    } else {
        let folder = root.join("reports/out");
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        let name = stored.as_ref().map_or(&frozen.name, |record| &record.run.id);
        folder.join(format!("view-{name}.html"))
    };
    check_place(&page)?;

    let known = known(root, frozen)?;
    let mut filmed = Vec::new();
    for (n, variant) in variants.iter().enumerate() {
        filmed.push(shown.film(variant, stored.as_ref().filter(|_| n == 0), known.truth())?);
    }
    let mut split = partitions(variants);
    if split.is_empty() {
        split.push(("1x1".to_owned(), Grid::ONE, Scheme::Boxes));
    }
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    for (name, grid, scheme) in split {
        let partition = scheme.partition(&frozen.problem, grid)?;
        let (g, c) = scene_rows(frozen, &name, &partition, known.impulses());
        grains.extend(g);
        contacts.extend(c);
    }
    let (grains, contacts) = (grains_table(&grains)?, contacts_table(&contacts)?);
    write_whole(&page, &reports::view(&frozen.name, (&grains, &contacts), filmed, &args.again())?)?;
    say(format_args!("{}", page.display()))?;
    Ok(())
}

impl Args {
    fn shown(&self, root: &Root) -> Result<Shown> {
        let mut variants: Vec<Variant> = self.runs.iter().map(|text| variant(text)).collect::<Result<_>>()?;
        let path = match root.problem_or_case(&self.problem) {
            Err(_) if is_id(&self.problem) => {
                return self.shown_of(root, stored(root, &self.problem)?, variants);
            }
            path => path?,
        };
        let frozen = self.scene.problem(&path)?;
        if variants.is_empty() {
            let runs = runs_of(frozen.problem.contact_count());
            variants = runs.iter().map(|text| variant(text)).collect::<Result<_>>()?;
        }
        let stop = self.stop.of(Stop::default())?;
        Ok(Shown { frozen, stop, stored: None, variants })
    }

    /// A stored run, and `others` beside it that begin as it does.
    fn shown_of(&self, root: &Root, record: Record, others: Vec<Variant>) -> Result<Shown> {
        let run = &record.run;
        let told = format!("run {} ({} on {})", run.id, run.method, run.problem);
        self.scene.refused(&format!("{told} is stored"))?;
        let stop = self.stop.of(stop_of(run)?)?;
        let method = || Method::new(&run.method, serde_json::from_str(&run.settings)?);
        let method = method().with_context(|| told.clone())?;
        let variant = Variant { method, warm_start: run.warm_start, name: run.variant.clone() };
        let others = others.into_iter().map(|other| Variant { warm_start: run.warm_start, ..other });
        let variants = std::iter::once(variant).chain(others).collect();
        let frozen = of_run(root, run).context(told)?;
        Ok(Shown { frozen, stop, stored: Some(record), variants })
    }

    /// The command.
    fn again(&self) -> String {
        let mut words = vec![format!("gravel view {}", self.problem)];
        words.extend(self.scene.again());
        words.extend(self.runs.iter().map(|run| format!("--run '{run}'")));
        words.extend(self.stop.again());
        words.join(" ")
    }
}

impl Shown {
    /// The iterates of a run: those that are `stored`, or else it is made.
    fn film(&self, variant: &Variant, stored: Option<&Record>, truth: Option<&Truth>) -> Result<Snapshots> {
        let label = variant.label();
        let as_stored = stored.filter(|record| stop_of(&record.run).is_ok_and(|stop| stop == self.stop));
        if let Some(Record { run, snapshots, .. }) = as_stored.filter(|record| !record.snapshots.is_empty()) {
            let ending = run.status.replace('-', " ");
            say(format_args!("{label}: {ending} after {} iterations, as stored", run.iterations))?;
            return Ok(Snapshots { label, ending, snapshots: snapshots.clone() });
        }
        let (mut film, start) = (Film::new(), self.frozen.start(variant.warm_start));
        let (solver, problem) = (&*variant.method.solver, &self.frozen.problem);
        let outcome = solve_against(truth, solver, problem, &start, &self.stop, &mut |progress| {
            film.observe(progress);
            ControlFlow::Continue(())
        })
        .with_context(|| format!("method `{}` on {}", variant.method.name, self.frozen.name))?;
        let ending = outcome.status.name().replace('-', " ");
        let why = match (stored, as_stored) {
            (None, _) => "",
            (Some(_), None) => ", made again with another stop rule",
            (Some(_), Some(_)) => ", made again: its iterates are not stored",
        };
        say(format_args!("{label}: {ending} after {} iterations{why}", outcome.iterations))?;
        if let Some(Record { run, .. }) =
            as_stored.filter(|record| record.run.iterations != outcome.iterations)
        {
            say(format_args!("  the stored run took {}: the method has changed since", run.iterations))?;
        }
        Ok(Snapshots { label, ending, snapshots: film.finish(&outcome) })
    }
}

/// The stop rule of a stored run.
fn stop_of(run: &Run) -> Result<Stop> {
    let on = measure(&run.stop_on)
        .map_err(|known| anyhow!("run {}: measure `{}`: {known}", run.id, run.stop_on))?;
    Ok(Stop { on, tolerance: run.tolerance, max_iterations: run.max_iterations })
}

/// A method and its settings in one text.
fn variant(text: &str) -> Result<Variant> {
    let (name, settings) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    let pairs = settings.split_whitespace().map(|word| key_value(word).map_err(anyhow::Error::msg));
    let read = || Method::parse(name, &pairs.collect::<Result<Vec<_>>>()?);
    let method = read().with_context(|| format!("--run '{text}'"))?;
    Ok(Variant { method, warm_start: false, name: settings.trim().to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use std::path::Path;

    #[test]
    fn what_is_shown_without_a_wish_is_what_the_page_of_the_paper_shows() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/plans/paper.toml"));
        let plan = Plan::read(path, false).unwrap();
        let view = plan.view.as_ref().unwrap();
        let variants = plan.variants(&[]).unwrap();
        let shown = variants.iter().filter(|variant| view.runs.contains(&variant.label()));
        let of_page: Vec<_> = shown.map(|v| (v.method.name, v.method.settings.clone())).collect();
        let own = runs_of(1000).map(|text| variant(&text).unwrap().method);
        assert_eq!(own.map(|method| (method.name, method.settings)).to_vec(), of_page);
    }

    #[test]
    fn few_contacts_have_few_subdomains() {
        let grid = |contacts| runs_of(contacts)[1].rsplit_once('=').unwrap().1.to_owned();
        assert_eq!([8, 7, 3, 1, 0].map(grid), ["4x2", "2x2", "2x1", "1x1", "1x1"]);
    }
}
