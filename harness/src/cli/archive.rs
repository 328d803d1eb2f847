//! `gravel archive`: a study in one file with all that makes it again; and the check of such a file, or of archived rows.

use crate::cli::args::{PlanArgs, StudyArgs};
use crate::collection::sha256;
use crate::exchange::is_foreign;
use crate::identity::provenance;
use crate::plan::{Curves, Method, Plan, Variant};
use crate::problems::{Known, Problem};
use crate::root::{Kind as Held, Root, stem};
use crate::run::{Conditions, How, Recorder, Task, Through, ended, ended_row};
use crate::store::{has_tables, problem_of_run, stored, studies_in, tables_of};
use crate::study::{Kind, ThroughTime, run_id};
use crate::terminal::{Bars, exit, prepare_new, progress, read_text, say, say_table, write_whole};
use anyhow::{Context, Result, bail, ensure};
use cases::AnyFrozen;
use contact::Measure;
use lineup::hash_of;
use results::journal::{Entry, Record};
use results::schema::{Ending, Provenance};
use results::settings::{CASE, TIME_STEP};
use results::simulation::Simulated;
use results::study::{Runs, Study as Rows, TABLES};
use runner::{Measured, Stop};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    study: PlanArgs,
    /// The tables, such as those in results/archive/PLAN [default: those of the newest study in results/runs]
    #[arg(long, value_name = "FOLDER")]
    rows: Option<PathBuf>,
    /// The file to write, a tar archive
    #[arg(short, long, value_name = "FILE.tar", required = true)]
    output: Option<PathBuf>,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Check the checksums of a packed study, or of archived tables, and make a share of the runs again, to the same counts
    Check(Check),
    /// Print a Markdown table of the archived studies: rows, size, commit, machine
    List {
        /// The folder of the archive [default: results/archive of the checkout]
        folder: Option<PathBuf>,
    },
}

#[derive(clap::Args)]
struct Check {
    /// A file that `gravel archive` wrote; or a folder of tables, or of such folders, such as results/archive
    #[arg(value_name = "FILE|FOLDER")]
    what: PathBuf,
    /// Share of the runs that are made again, drawn by the hash of their id and the salt (%)
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, value_parser = percent)]
    share: f64,
    /// Text that draws others, such as a commit
    #[arg(long, value_name = "TEXT", default_value = "")]
    salt: String,
    /// Make those alone that this counted budget of a study holds, in the order in which they are drawn: iterations times contacts, of
    /// simulations times grains; a time step before a problem that is not stored counts as 100 iterations
    #[arg(long, value_name = "N")]
    budget: Option<u64>,
}

fn percent(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=100.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is no number from 0 to 100"))
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<ExitCode> {
    match (&args.command, &args.output) {
        (Some(Command::Check(check)), _) => check.run(root),
        (Some(Command::List { folder }), _) => {
            let folder = folder.clone().unwrap_or_else(|| root.join("results/archive"));
            list(&folder).map(|()| ExitCode::SUCCESS)
        }
        (None, Some(output)) => pack(root.needed()?, args, output).map(|()| ExitCode::SUCCESS),
        (None, None) => bail!("--output: name the file to write"),
    }
}

/// Name of the description of a pack, as RO-Crate has it; folder of its rows.
const METADATA: &str = "ro-crate-metadata.json";
const ROWS: &str = "rows";

fn pack(root: &Root, args: &Args, output: &Path) -> Result<()> {
    let name = output.display();
    ensure!(
        output.extension().is_some_and(|ending| ending == "tar"),
        "--output {name}: its name must end in .tar"
    );
    prepare_new(output)?;
    let path = args.study.path(root)?;
    let plan = Plan::read(&path, args.study.quick)?;
    let folder = args.rows.clone().map_or_else(|| stored(root, &plan), Ok)?;
    // Refuses what is damaged.
    let rows = tables_of(&folder)?;
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut add = |inside: String, file: &Path| -> Result<()> {
        files.insert(inside, fs::read(file).with_context(|| file.display().to_string())?);
        Ok(())
    };
    for table in TABLES.map(|table| format!("{table}.parquet")) {
        if folder.join(&table).is_file() {
            add(format!("{ROWS}/{table}"), &folder.join(&table))?;
        }
    }
    add(format!("harness/plans/{}.toml", stem(&path)), &path)?;
    for (held, name) in sources(&rows) {
        let file = if held == Held::Case { root.case(&name)? } else { root.any_problem(&name)? };
        let base = match held {
            Held::Case => "cases",
            _ if is_foreign(&file) => "cases/foreign",
            _ => "cases/frozen",
        };
        let file_name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        add(format!("{base}/{file_name}"), &file)?;
        if held == Held::Case
            && let Some(beside) = of_sample(&file)?
        {
            add(format!("cases/{beside}"), &file.with_file_name(&beside))?;
        }
    }
    let lock = root.join("Cargo.lock");
    if lock.is_file() {
        add("Cargo.lock".to_owned(), &lock)?;
    }
    let described = serde_json::to_vec_pretty(&described(&plan, &rows, &files)?)?;
    let count = files.len();
    files.insert(METADATA.to_owned(), described);
    let mut tar = tar::Builder::new(Vec::new());
    for (inside, bytes) in &files {
        // Neither times nor owners, so that the same study has the same bytes.
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        tar.append_data(&mut header, inside, &**bytes)?;
    }
    write_whole(output, tar.into_inner()?)?;
    say(format_args!("{name}: {count} files, {}", counted(&rows)))
}

fn list(folder: &Path) -> Result<()> {
    let mut rows = Vec::new();
    for study in studies_in(folder)? {
        let tables = tables_of(&study)?;
        let mut bytes = 0;
        for file in fs::read_dir(&study).with_context(|| study.display().to_string())? {
            bytes += file?.metadata()?.len();
        }
        let origins = origins(&tables);
        let all = |of: &dyn Fn(&Provenance) -> String| {
            origins
                .iter()
                .map(|origin| of(origin))
                .collect::<BTreeSet<_>>()
                .into_iter()
                .collect::<Vec<_>>()
                .join(", ")
        };
        let words = all(&|o| o.commit.split_at_checked(7).map_or(&*o.commit, |(short, _)| short).to_owned());
        let machine = all(&|o| format!("{}, {} of {} threads", o.processor, o.threads, o.processors));
        let size = format!("{:.1}", bytes as f64 / 1e6);
        let name = stem(&study);
        let minutes = format!("{:.1}", seconds(&tables) / 60.0);
        let renewed = format!("`just archive {name}`");
        rows.push(vec![format!("`{name}`"), counted(&tables), size, minutes, words, machine, renewed]);
    }
    say_table(&["study", "rows", "MB", "minutes", "commit", "machine", "renewed by"], &rows)
}

fn counted(rows: &Rows) -> String {
    match rows {
        Rows::Runs(Runs { records, .. }) => format!("{} runs", records.len()),
        Rows::Simulations(all) => format!("{} simulations", all.len()),
    }
}

/// Returns the cases and the frozen problems of rows, each once.
fn sources(rows: &Rows) -> BTreeSet<(Held, String)> {
    let source = |settings: &serde_json::Map<String, Value>, name: &str| match settings.get(CASE) {
        Some(Value::String(case)) => (Held::Case, case.clone()),
        _ => (Held::Frozen, name.to_owned()),
    };
    match rows {
        Rows::Runs(Runs { records, .. }) => {
            records.iter().map(|one| source(&one.run.problem_settings, &one.run.problem)).collect()
        }
        Rows::Simulations(all) => {
            all.iter().map(|one| source(&one.simulation.scene_settings, &one.simulation.scene)).collect()
        }
    }
}

/// Returns the name of the file beside a case that holds its sample, if there is one.
fn of_sample(case: &Path) -> Result<Option<String>> {
    let table: toml::Table = read_text(case)?.parse().with_context(|| case.display().to_string())?;
    let sample = table.get("sample").and_then(|sample| sample.get("file"));
    Ok(sample.and_then(|file| file.as_str()).map(str::to_owned))
}

/// Returns the time that all rows took, one after the other, with their repeats and measures (s).
fn seconds(rows: &Rows) -> f64 {
    let walls: Vec<f64> = match rows {
        Rows::Runs(Runs { records, .. }) => records.iter().map(|one| one.timing().wall_s).collect(),
        Rows::Simulations(all) => all.iter().map(|one| one.timing().wall_s).collect(),
    };
    walls.into_iter().filter(|wall| wall.is_finite()).sum()
}

fn origins(rows: &Rows) -> Vec<&Provenance> {
    match rows {
        Rows::Runs(Runs { records, .. }) => records.iter().map(Entry::provenance).collect(),
        Rows::Simulations(all) => all.iter().map(Entry::provenance).collect(),
    }
}

/// Describes a pack as [RO-Crate 1.2](https://w3id.org/ro/crate/1.2) does: each file with its length and SHA-256, the program and the
/// machines that made the rows, and when.
fn described(plan: &Plan, rows: &Rows, files: &BTreeMap<String, Vec<u8>>) -> Result<Value> {
    let origins = origins(rows);
    let all = |of: fn(&Provenance) -> String| origins.iter().map(|o| of(o)).collect::<BTreeSet<_>>();
    let times = all(|o| o.started_utc.clone());
    let hashes: BTreeSet<&str> = match rows {
        Rows::Runs(Runs { records, .. }) => records.iter().map(|one| &*one.run.problem_hash).collect(),
        Rows::Simulations(all) => all.iter().map(|one| &*one.simulation.scene_hash).collect(),
    };
    let (first, last) = (times.first().context("the study has no rows")?, times.last());
    let licence = "https://spdx.org/licenses/CC-BY-4.0";
    let mut graph = vec![
        json!({
            "@id": METADATA, "@type": "CreativeWork", "about": { "@id": "./" },
            "conformsTo": { "@id": "https://w3id.org/ro/crate/1.2" },
        }),
        json!({
            "@id": "./", "@type": "Dataset", "name": format!("gravel study {}", plan.name), "description": plan.why,
            "datePublished": last.unwrap_or(first).get(..10), "license": { "@id": licence },
            "hasPart": files.keys().map(|file| json!({ "@id": file })).collect::<Vec<_>>(),
            "mentions": { "@id": "#runs" }, "variableMeasured": counted(rows),
            "identifier": hashes,
        }),
        json!({ "@id": licence, "@type": "CreativeWork", "name": "Creative Commons Attribution 4.0 International" }),
        json!({
            "@id": "#gravel", "@type": "SoftwareApplication", "name": "gravel", "softwareVersion": all(|o| o.commit.clone()),
            "softwareRequirements": all(|o| format!("rustc {}, profile {}", o.rustc, o.profile)),
        }),
        json!({
            "@id": "#runs", "@type": "CreateAction", "name": format!("gravel bench {}", plan.name),
            "instrument": { "@id": "#gravel" }, "result": { "@id": "./" }, "startTime": first, "endTime": last,
            "description": all(|o| format!("{}, {} threads", o.processor, o.threads)),
        }),
    ];
    graph.extend(files.iter().map(|(file, bytes)| {
        json!({ "@id": file, "@type": "File", "contentSize": bytes.len().to_string(), "sha256": sha256(bytes) })
    }));
    Ok(json!({ "@context": "https://w3id.org/ro/crate/1.2/context", "@graph": graph }))
}

/// Unpacks a file into a folder, once all its files are what its description says.
fn unpacked(file: &Path, folder: &Path) -> Result<()> {
    let read = || -> Result<BTreeMap<String, Vec<u8>>> {
        let mut files = BTreeMap::new();
        let mut archive = tar::Archive::new(fs::File::open(file)?);
        for entry in archive.entries()? {
            let mut entry = entry?;
            let name = entry.path()?.to_string_lossy().into_owned();
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut entry, &mut bytes)?;
            files.insert(name, bytes);
        }
        Ok(files)
    };
    let mut files = read().context("it is no tar archive that `gravel archive` wrote")?;
    let metadata = files.remove(METADATA).with_context(|| format!("it has no {METADATA}"))?;
    let metadata: Value = serde_json::from_slice(&metadata).context(METADATA)?;
    let graph =
        metadata["@graph"].as_array().with_context(|| format!("{METADATA}: it has no list `@graph`"))?;
    let described: BTreeMap<&str, &Value> = graph
        .iter()
        .filter(|entity| entity["@type"] == "File")
        .filter_map(|entity| Some((entity["@id"].as_str()?, &entity["sha256"])))
        .collect();
    if let Some(missing) = described.keys().find(|name| !files.contains_key(**name)) {
        bail!("{missing}: the description names it, and it is not there");
    }
    for (name, bytes) in &files {
        let wanted = described
            .get(name.as_str())
            .with_context(|| format!("{name}: the description does not name it"))?;
        let found = sha256(bytes);
        ensure!(**wanted == found, "{name}: `sha256` is {wanted}, and the file has {found}: it was changed");
        let path = Path::new(name);
        ensure!(
            path.components().all(|part| matches!(part, Component::Normal(_))),
            "{name}: it is no path inside a folder"
        );
        let target = folder.join(path);
        fs::create_dir_all(target.parent().unwrap_or(folder))?;
        fs::write(&target, bytes)?;
    }
    for inner in ["cases/frozen", "harness/plans"] {
        fs::create_dir_all(folder.join(inner))?;
    }
    Ok(())
}

/// Record made again, and the id that it has now; none if the user stopped it.
type Again<R> = Option<(R, String)>;

impl Check {
    fn run(&self, root: &Root) -> Result<ExitCode> {
        let name = || self.what.display().to_string();
        let folder = tempfile::tempdir().context("a folder for the files of the study")?;
        let mut studies = Vec::new();
        let unpacked_root = if self.what.is_file() {
            unpacked(&self.what, folder.path()).with_context(name)?;
            studies.push(folder.path().join(ROWS));
            Some(Root::find(Some(folder.path().to_owned()))?)
        } else {
            studies = if has_tables(&self.what) { vec![self.what.clone()] } else { studies_in(&self.what)? };
            None
        };
        let mut differ = 0;
        for study in studies {
            differ += self
                .study(unpacked_root.as_ref().unwrap_or(root), &study)
                .with_context(|| study.display().to_string())?;
            if exit::requested() {
                eprintln!("stopped: not all was checked");
                return Ok(exit::code("interrupted"));
            }
        }
        Ok(if differ == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// Checks the tables of a study and makes a share of its runs again; returns how many of this code differ.
    fn study(&self, root: &Root, folder: &Path) -> Result<usize> {
        let rows = tables_of(folder)?;
        match &rows {
            Rows::Runs(Runs { records, .. }) => {
                let is_ours = |record: &&Record| {
                    let ended =
                        !matches!(record.run.status, Ending::Skipped | Ending::Given | Ending::Failed);
                    ended && record.run.grains > 0 && record.run.provenance.other_code.is_empty()
                };
                let of: Vec<&Record> = records.iter().filter(is_ours).collect();
                let cost = |record: &Record| {
                    let run = &record.run;
                    let steps = run.problem_settings.get(TIME_STEP).and_then(Value::as_u64).unwrap_or(0);
                    let march = if collected(root, &run.problem_hash).is_some() { 0 } else { 100 * steps };
                    (run.iterations + march) * u64::from(run.contacts)
                };
                self.again(&rows, &of, &cost, &|record| made_again(root, record))
            }
            Rows::Simulations(all) => {
                let of: Vec<&Simulated> = all.iter().collect();
                let plan = all.first().map_or("", |one| &one.simulation.plan);
                let study = ThroughTime::new(
                    StudyArgs::plan(plan.trim_end_matches("-quick"), plan.ends_with("-quick"))
                        .selection(root)?,
                    root,
                    false,
                )?;
                let cost =
                    |one: &Simulated| one.simulation.totals.iterations * u64::from(one.simulation.grains);
                self.again(&rows, &of, &cost, &|one| simulated_again(root, &study, one))
            }
        }
    }

    /// Makes a share of `all` again, with the ids that they have now; says which differ, and returns how many do of the same id: those
    /// of earlier code may.
    fn again<R: Entry>(
        &self,
        rows: &Rows,
        all: &[&R],
        cost: &dyn Fn(&R) -> u64,
        made: &dyn Fn(&R) -> Result<Again<R>>,
    ) -> Result<usize> {
        let mut drawn = all.to_vec();
        drawn.sort_by_cached_key(|record| hash_of(&json!([record.id(), self.salt])));
        drawn.truncate((self.share / 100.0 * all.len() as f64).ceil() as usize);
        let (mut left, mut beyond, mut unmade, mut differ) = (self.budget.unwrap_or(u64::MAX), 0, 0, [0, 0]);
        let bar = progress::bar(drawn.len() as u64, "made again");
        for record in &drawn {
            let price = cost(record);
            if price > left {
                beyond += 1;
                continue;
            }
            left -= price;
            let name = || format!("{} ({})", record.name(), record.id());
            let found = match made(record) {
                Ok(None) => return Ok(differ[1]),
                Ok(Some((again, id))) => difference(*record, &again).map(|found| (found, id == record.id())),
                Err(why) => {
                    unmade += 1;
                    bar.suspend(|| say(format_args!("{}: it is not made again: {why:#}", name())))?;
                    None
                }
            };
            if let Some((found, is_same)) = found {
                differ[usize::from(is_same)] += 1;
                let earlier = if is_same { "" } else { ", of earlier code" };
                bar.suspend(|| say(format_args!("{}{earlier}: {found}", name())))?;
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        let some =
            |count: u32, words: &str| if count > 0 { format!(", {count} {words}") } else { String::new() };
        let left_out = some(beyond, "beyond the budget") + &some(unmade, "not made again");
        let (study, number, [earlier, same]) = (plan_of(rows), drawn.len(), differ);
        let all = counted(rows);
        say(format_args!(
            "{study}: {all}, checksums right; {number} drawn{left_out}; of this code {same} differ, of earlier code {earlier}"
        ))?;
        Ok(same)
    }
}

/// Returns the first count in which two records differ, with both values. A series is measured, not counted.
fn difference<R: Entry>(record: &R, again: &R) -> Option<String> {
    let counts = |of: &R| {
        let all = of.counts().into_iter();
        all.filter(|(name, _)| !name.starts_with("series")).collect::<Vec<_>>()
    };
    let both = counts(record).into_iter().zip(counts(again));
    let mut differ = both.filter(|((_, before), (_, now))| before != now);
    differ.next().map(|((count, before), (_, now))| format!("`{count}` was {before}, and is {now}"))
}

fn plan_of(rows: &Rows) -> &str {
    match rows {
        Rows::Runs(Runs { records, .. }) => records.first().map_or("no runs", |one| &one.run.plan),
        Rows::Simulations(all) => all.first().map_or("no simulations", |one| &one.simulation.plan),
    }
}

/// Returns the file of a problem that the collection of a checkout holds.
fn collected(root: &Root, hash: &str) -> Option<PathBuf> {
    root.collected(&root.join("cases/collection"), hash)
}

/// Makes a run again; `None` if the user stopped it.
fn made_again(root: &Root, record: &Record) -> Result<Again<Record>> {
    let run = &record.run;
    let frozen = match collected(root, &run.problem_hash) {
        Some(file) => AnyFrozen::read(&file)?,
        None => problem_of_run(root, run)?,
    };
    let (problem, method) = (Problem::alone(frozen, true), Method::new(&run.method, run.settings.clone())?);
    ensure!(
        problem.hash == run.problem_hash,
        "its problem was {}, and is {}",
        run.problem_hash,
        problem.hash
    );
    // The solution changes no count of the others.
    let needs_truth = matches!(run.stop_on.0, Measure::VelocityError | Measure::Zeta)
        || run.status == Ending::FalseConvergence;
    let known = if needs_truth { problem.known(root)? } else { &Known::default() };
    let stop = Stop { on: run.stop_on.0, tolerance: run.tolerance, max_iterations: run.max_iterations };
    let (mut recorder, r0) = (Recorder::new(Curves::Ends), problem.start(run.warm_start));
    let asked = lineup::Run { truths: &known.impulses, r0: &r0, stop: &stop, measured: Measured::Grid };
    let made = ended(&method, &problem, asked, &mut |progress| {
        recorder.observe(progress);
        if exit::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if exit::requested() {
        return Ok(None);
    }
    let mut outcome = made.outcome;
    outcome.status = known.ending(outcome.status);
    let curve = recorder.finish();
    let run = ended_row(run.clone(), &outcome, &curve);
    let variant = Variant { method, warm_start: run.warm_start, name: String::new(), problems: Vec::new() };
    let id = run_id(&problem.hash, &variant, &stop);
    Ok(Some((Record { run, curve, snapshots: Vec::new() }, id)))
}

/// Makes a simulation again; `None` if the user stopped it.
fn simulated_again(root: &Root, study: &ThroughTime, simulated: &Simulated) -> Result<Again<Simulated>> {
    let one = &simulated.simulation;
    // A setting that came later has its default.
    let settings = Method::new(&one.method, one.settings.clone())?.settings;
    let same = |task: &&Task<Through>| {
        let (what, method) = (&task.what, &task.variant.method);
        let (rule, stop) = (&what.rule, &what.rule.stop);
        let is_same_rule = (stop.on, stop.tolerance, stop.max_iterations)
            == (one.stop_on.0, one.tolerance, one.max_iterations)
            && (one.start.is_empty() || one.start == rule.warm_start.name());
        what.role == one.role
            && what.scene.hash == one.scene_hash
            && what.scene.case.scene.time_step_s == one.time_step_s
            && method.name == one.method
            && method.settings == settings
            && is_same_rule
    };
    let tasks = study.tasks();
    let task = tasks.iter().find(same).context("its plan has no such simulation any more")?;
    let (provenance, bars) = (provenance()?, Bars::new(1));
    let (jobs, measured) = (NonZeroUsize::MIN, Measured::Grid);
    let how = How { root, folder: None, provenance: &provenance, repeats: 1, jobs, measured };
    let made = study.run(task, &Conditions { how: &how, bars: &bars, halt: &exit::requested })?;
    Ok(made.map(|made| (made, task.id.clone())))
}
