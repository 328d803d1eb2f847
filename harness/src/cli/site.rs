//! `gravel site`: pages of all that the tree holds: archived studies, the collection, texts and figures.

use crate::collection::{Collection, Submission};
use crate::plan::Plan;
use crate::problems::{Problem, overrides, read_case};
use crate::root::{Root, stem};
use crate::run::scene_rows;
use crate::store::{about, expected_failures, read_baseline, studies_in, tables_of};
use crate::terminal::{exit, progress, read_text, say};
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use lineup::Posed;
use partition::{Grid, Scheme};
use reports::{About, Archived, Collected, Facts, Hazard, Site};
use results::settings::{CASE, FRICTION, MARCH, MISSED_BEFORE, MOMENT, TIME_STEP};
use results::study::{Runs, Study as Rows};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::iter::repeat_n;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// The folder of the site; files of a site before are replaced, files of yours stay
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// The folder of the archive, a folder of tables for each plan [default: results/archive of the checkout]
    #[arg(long, value_name = "FOLDER")]
    archive: Option<PathBuf>,
    /// The folder of the collection [default: cases/collection of the checkout]
    #[arg(long = "in", value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

/// The plan whose accepted counts say what breaks which method.
const HAZARDS: &str = "stability";

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let out = &args.output;
    if out.exists() && !out.is_dir() {
        bail!("--output {}: it is a file; give the path of a folder", out.display());
    }
    let collection = Collection::of(root, args.folder.as_deref(), false)?;
    let problems = collected(&collection)?;
    let archive = args.archive.clone().unwrap_or_else(|| root.join("results/archive"));
    let studies = archived(root, &archive)?;
    let facts = facts(root, &problems, &studies)?;
    let (pages, figures) = (texts(root, ".md")?, texts(root, ".svg")?);
    let bar = progress::bar(studies.len() as u64, "studies drawn");
    let site = Site { studies, problems, facts, hazards: hazards(root)?, pages, figures };
    let first = reports::site(&site, out, &|| {
        bar.inc(1);
        !exit::requested()
    })?;
    bar.finish_and_clear();
    match first {
        Some(first) => say(format_args!("open {} in a browser", first.display())),
        None => bail!("stopped: the site in {} is not whole", out.display()),
    }
}

/// Reads the studies of an archive, by name.
fn archived(root: &Root, archive: &Path) -> Result<Vec<Archived>> {
    let study = |folder: PathBuf| {
        let plan = Plan::read(&root.plan(&stem(&folder))?, false)?;
        // The site has the tables of its reports alone.
        let about = About { rows: String::new(), text: None, ..about(&plan, &plan.name) };
        Ok(Archived { about, rows: tables_of(&folder)?, charts: plan.charts() })
    };
    studies_in(archive)?.into_iter().map(study).collect()
}

/// Reads the problems of a collection with the rows of their pictures.
fn collected(collection: &Collection) -> Result<Vec<Collected>> {
    let (entries, names) = (collection.entries()?, collection.names("submissions")?);
    let bar = progress::bar(entries.len() as u64, "problems read");
    let mut all = Vec::new();
    for entry in entries {
        let rows = match collection.problem(&entry)? {
            Some(Problem { posed: Posed::Grains(problem), .. }) => {
                let answers = collection.answers(&entry.id)?;
                let (r, is_proof) = answers.first();
                let tangents = if is_proof { problem.facts().of_contact - 1 } else { 0 };
                let r: Vec<f64> =
                    r.iter().flat_map(|r| [*r].into_iter().chain(repeat_n(0.0, tangents))).collect();
                let whole = [(String::new(), Grid::ONE, Scheme::Boxes)];
                scene_rows((&entry.name, &*problem), &whole, Some(&r))
            }
            _ => (Vec::new(), Vec::new()),
        };
        let of_entry = names.iter().filter(|name| name.starts_with(&entry.id));
        let submissions = of_entry.map(|name| submission(collection, name)).collect::<Result<_>>()?;
        all.push(Collected { entry: json!(entry), submissions, grains: rows.0, contacts: rows.1 });
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(all)
}

fn submission(collection: &Collection, name: &str) -> Result<Value> {
    let of = Submission::read(&collection.file("submissions", &format!("{name}.json.gz")))?;
    let natural_map = of.verified.map(|verified| format!("{:.2e}", verified.natural_map));
    Ok(json!({
        "code": of.code, "version": of.version, "division": of.division.name(), "how": of.how,
        "natural_map": natural_map, "certified": of.verified.is_some_and(|verified| verified.certified),
        "seconds": of.claimed.seconds,
    }))
}

/// Returns mechanics, greatest μ and state of all problems and scenes of the archive.
fn facts(root: &Root, problems: &[Collected], studies: &[Archived]) -> Result<BTreeMap<String, Facts>> {
    let mut facts: BTreeMap<String, Facts> = BTreeMap::new();
    for Collected { entry, .. } in problems {
        let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let friction = entry["friction"][1].as_f64().unwrap_or(0.0);
        facts.insert(text("id"), Facts { mechanics: text("mechanics"), friction, state: text("state") });
    }
    let mut seen = BTreeSet::new();
    for Archived { rows, .. } in studies {
        let all: Vec<(&str, &str, &Map<String, Value>)> = match rows {
            Rows::Runs(Runs { records, .. }) => {
                let runs = records.iter().map(|record| &record.run);
                runs.map(|run| (&*run.problem_hash, &*run.problem, &run.problem_settings)).collect()
            }
            Rows::Simulations(all) => {
                let scenes = all.iter().map(|one| &one.simulation);
                scenes.map(|one| (&*one.scene_hash, &*one.scene, &one.scene_settings)).collect()
            }
        };
        for (hash, name, settings) in all {
            // One of a case has the state that its study names.
            let is_new = settings.contains_key(TIME_STEP) || !facts.contains_key(hash);
            if seen.insert(hash) && is_new {
                facts.insert(hash.to_owned(), of_problem(root, name, settings)?);
            }
        }
    }
    Ok(facts)
}

fn of_problem(root: &Root, name: &str, settings: &Map<String, Value>) -> Result<Facts> {
    let text = |key: &str| settings.get(key).and_then(Value::as_str).map(str::to_owned);
    let Some(case) = text(CASE) else {
        let problem = Problem::alone(AnyFrozen::read(&root.problem(name)?)?, false);
        let Posed::Grains(grains) = &problem.posed else { return Ok(Facts::default()) };
        let touching = grains.touching();
        let friction = touching.iter().map(|contact| contact.friction).fold(0.0, f64::max);
        return Ok(Facts {
            mechanics: grains.facts().mechanics.to_owned(),
            friction,
            state: "other".to_owned(),
        });
    };
    let mut scene = settings.clone();
    scene.retain(|key, _| ![CASE, TIME_STEP, MOMENT, MARCH, MISSED_BEFORE].contains(&key.as_str()));
    let case = read_case(&root.case(&case)?, &overrides(&scene))?;
    let mechanics = lineup::name_of(&case)?.to_owned();
    let friction = settings.get(FRICTION).and_then(Value::as_f64).or(case.scene.friction).unwrap_or(0.0);
    let step = settings.get(TIME_STEP).map(|step| format!("time step {step}"));
    Ok(Facts { mechanics, friction, state: text(MOMENT).or(step).unwrap_or_default() })
}

/// Reads the accepted counts of the runs on hazards, each with the reason of its ending where it is known.
fn hazards(root: &Root) -> Result<Vec<Hazard>> {
    let plan = format!("{HAZARDS}-quick");
    let folder = root.join("results/baseline");
    let file = folder.join(format!("{plan}.csv"));
    if !file.is_file() {
        return Ok(Vec::new());
    }
    let expected = expected_failures(&folder.join("expected-failures.toml"), &plan)?;
    let hazard = |counts: &crate::store::Counts| {
        let [problem, method, settings, hash, status, iterations] = counts.named();
        let why = expected.iter().find(|failure| failure.run == counts.run());
        Ok(Hazard {
            problem: problem.to_owned(),
            hash: hash.to_owned(),
            method: method.to_owned(),
            settings: settings.to_owned(),
            status: status.to_owned(),
            iterations: iterations
                .parse()
                .with_context(|| format!("{}: `iterations` is {iterations}", file.display()))?,
            why: why.map(|failure| failure.why.clone()).unwrap_or_default(),
        })
    };
    read_baseline(&file)?.iter().map(hazard).collect()
}

/// Reads the texts in the folder of reports whose names have this ending, by name; those about the folder itself are none.
fn texts(root: &Root, ending: &str) -> Result<BTreeMap<String, String>> {
    let folder = root.join("reports");
    let name = || folder.display().to_string();
    let mut texts = BTreeMap::new();
    if !folder.is_dir() {
        return Ok(texts);
    }
    for entry in std::fs::read_dir(&folder).with_context(name)? {
        let path = entry.with_context(name)?.path();
        let is_one = path.to_string_lossy().ends_with(ending) && stem(&path) != "README";
        if is_one {
            texts.insert(stem(&path), read_text(&path)?);
        }
    }
    Ok(texts)
}
