//! The site: pages of what is archived and collected, for any browser, offline.

mod first;
mod tables;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use minijinja::context;
use minijinja::value::Serde;
use polars::prelude::DataFrame;
use rayon::prelude::*;
use results::schema::{ContactRow, GrainRow};
use results::study::Study as Stored;

use crate::charts::Chart;
use crate::charts::sample::draw;
use crate::draw::Formats;
use crate::error::ReportError;
use crate::page::{About, Rows, filled, inline, replace};
use crate::read::{Problems, RunRow, Study, Verdicts, ending_text, file_name, number, scenes};
use crate::text::{File, Kind, html};
use crate::{Wanted, report};
use tables::{converged, some};

/// A study of the archive.
#[derive(Clone, Debug)]
pub struct Archived {
    /// Description of the study.
    pub about: About,
    /// Its rows.
    pub rows: Stored,
    /// Its charts.
    pub charts: Vec<Chart>,
}

/// A problem of the collection.
#[derive(Clone, Debug)]
pub struct Collected {
    /// Its entry, as JSON.
    pub entry: serde_json::Value,
    /// Its submissions with what was verified, as JSON.
    pub submissions: Vec<serde_json::Value>,
    /// Its grains; none of W alone.
    pub grains: Vec<GrainRow>,
    /// Its contacts, with the impulses of the best known answer.
    pub contacts: Vec<ContactRow>,
}

/// Facts of a problem or a scene that no row holds.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Name of the mechanics.
    pub mechanics: String,
    /// Greatest μ (–).
    pub friction: f64,
    /// State of the packing.
    pub state: String,
}

/// Accepted counts of a run on a hazard.
#[derive(Clone, Debug)]
pub struct Hazard {
    /// Name of the problem.
    pub problem: String,
    /// Id of the problem.
    pub hash: String,
    /// Name of the method.
    pub method: String,
    /// Settings other than the defaults.
    pub settings: String,
    /// Ending of the run.
    pub status: String,
    /// Iterations made.
    pub iterations: u64,
    /// Reason of the ending, where it is known.
    pub why: String,
}

/// Content of the site.
#[derive(Clone, Debug)]
pub struct Site {
    /// Studies of the archive, by name.
    pub studies: Vec<Archived>,
    /// Problems of the collection, by id.
    pub problems: Vec<Collected>,
    /// Facts of problems and scenes, by hash.
    pub facts: BTreeMap<String, Facts>,
    /// Runs on hazards.
    pub hazards: Vec<Hazard>,
    /// Pages in Markdown, by name.
    pub pages: BTreeMap<String, String>,
    /// Figures of these pages as SVG, by name.
    pub figures: BTreeMap<String, String>,
}

/// Writes the site into the folder `out`, in place of the one before; files of anyone else stay. Calls `progress` after each study, and
/// ends early where it returns false. Returns the path of the first page.
///
/// # Errors
///
/// If a table lacks a column or a file cannot be written.
pub fn site(site: &Site, out: &Path, progress: &dyn Fn() -> bool) -> Result<Option<PathBuf>, ReportError> {
    let mut studies: Vec<(&str, Problems)> = Vec::new();
    for Archived { about, rows, .. } in &site.studies {
        if let Stored::Runs(runs) = rows {
            studies.push((&about.name, runs.into()));
        }
    }
    let pages = Pages::of(site, &studies);
    let mut files = vec![
        File::new("index.html".to_owned(), pages.first()?),
        File::new("runs.html".to_owned(), pages.runs()?),
        File::new("problems.html".to_owned(), pages.problems()?),
    ];
    for method in &pages.methods {
        files.push(File::new(of_method(method), pages.method(method)?));
    }
    let of_problems = site.problems.par_iter().map(|problem| pages.problem(problem));
    files.extend(of_problems.collect::<Result<Vec<_>, _>>()?);
    for (name, text) in &site.pages {
        let content = context! { title => title(text), body => pages.html(text.trim_start_matches(&format!("# {}", title(text)))) };
        files.push(File::new(format!("page-{name}.html"), filled("list.html", content)?));
    }
    let figures = site.figures.iter().map(|(name, svg)| File::new(format!("{name}.svg"), svg.clone()));
    files.extend(figures);
    for Archived { about, rows, charts } in &site.studies {
        let wanted = Wanted { charts, formats: Formats::default(), against: None };
        report(rows, about, wanted, &out.join("studies").join(&about.name))?;
        if !progress() {
            return Ok(None);
        }
    }
    Ok(replace(&files, out)?.into_iter().next())
}

fn of_method(method: &str) -> String {
    format!("method-{}.html", file_name(method))
}

/// Returns the first heading of a page in Markdown.
fn title(text: &str) -> &str {
    text.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or_default()
}

/// Names the problems of a law.
fn law(is_frictional: bool) -> &'static str {
    if is_frictional { "with friction" } else { "without friction" }
}

/// Rows of the site, read once.
struct Pages<'s> {
    site: &'s Site,
    /// Studies on problems, by name.
    studies: &'s [(&'s str, Problems)],
    methods: Vec<String>,
    /// All runs on problems, the ids of their problems, and all simulations.
    runs: DataFrame,
    hashes: Vec<&'s str>,
    simulations: DataFrame,
}

/// Facts of a problem of which none are known.
static UNKNOWN: Facts = Facts { mechanics: String::new(), friction: 0.0, state: String::new() };

impl<'s> Pages<'s> {
    fn of(site: &'s Site, studies: &'s [(&'s str, Problems)]) -> Self {
        let facts = |hash: &str| site.facts.get(hash).unwrap_or(&UNKNOWN);
        let mut runs = Vec::new();
        for (name, study) in studies {
            runs.extend(study.runs.iter().map(|run| (*name, run, facts(&run.problem_hash))));
        }
        let through_time = site.studies.iter().map(|study| (&*study.about.name, Study::from(&study.rows)));
        let through_time: Vec<(&str, Study)> = through_time.collect();
        let mut simulations = Vec::new();
        for (name, study) in &through_time {
            if let Study::Simulations(all) = study {
                simulations.extend(all.iter().map(|one| (*name, one, facts(&one.scene_hash))));
            }
        }
        let of_hazards = site.hazards.iter().map(|hazard| &hazard.method);
        let methods: BTreeSet<&String> =
            runs.iter().map(|(_, run, _)| &run.method).chain(of_hazards).collect();
        Self {
            site,
            studies,
            methods: methods.into_iter().cloned().collect(),
            hashes: runs.iter().map(|(_, run, _)| run.problem_hash.as_str()).collect(),
            runs: tables::runs(&runs),
            simulations: tables::simulations(&simulations),
        }
    }

    fn facts(&self, run: &RunRow) -> &Facts {
        self.site.facts.get(&run.problem_hash).unwrap_or(&UNKNOWN)
    }

    /// Returns the name of the page of a problem, if the collection has it.
    fn page_of(&self, hash: &str) -> Option<String> {
        let found = self.site.problems.binary_search_by(|problem| problem.id().cmp(hash));
        found.is_ok().then(|| format!("problem-{hash}.html"))
    }

    /// Makes the rows of the runs on some problems, each of which leads to its page.
    fn rows_of_runs(&self, keep: &dyn Fn(&str) -> bool) -> Result<Rows, ReportError> {
        let kept: Vec<usize> = (0..self.hashes.len()).filter(|row| keep(self.hashes[*row])).collect();
        let leads = |row: usize, heading: &str| {
            let hash = self.hashes[kept[row]];
            (heading == "problem").then(|| self.page_of(hash)).flatten()
        };
        Rows::linked("runs", &some(&self.runs, &kept)?, "", &leads)
    }

    fn runs(&self) -> Result<String, ReportError> {
        let runs = self.rows_of_runs(&|_| true)?;
        let of_runs = &["study", "method", "mechanics", "grains", "μ", "state", "start", "status"];
        let simulations = Rows::of("simulations", &self.simulations, "")?;
        let of_simulations = &["study", "method", "mechanics", "grains", "μ", "tolerance", "status"];
        let tables = [runs.chosen_by(of_runs), simulations.chosen_by(of_simulations)];
        let content = context! { title => "All runs", lead => RUNS, tables => Serde(tables) };
        filled("list.html", content)
    }

    fn problems(&self) -> Result<String, ReportError> {
        let problems = &self.site.problems;
        let leads = |row: usize, heading: &str| {
            (heading == "name").then(|| self.page_of(problems[row].id())).flatten()
        };
        let rows = Rows::linked("problems", &tables::collection(problems), "", &leads)?;
        let rows = rows.chosen_by(&["mechanics", "grains", "μ", "state", "status"]);
        filled("list.html", context! { title => "Problems", lead => COLLECTION, tables => Serde([rows]) })
    }

    fn problem(&self, problem: &Collected) -> Result<File, ReportError> {
        let (id, entry) = (problem.id(), &problem.entry);
        let of = match problem.status() {
            "open" => "the best known answer",
            "no-solution" => "the proof that there is no solution",
            _ => "a certified solution",
        };
        let is_plane = problem.grains.iter().all(|grain| grain.z_m == 0.0);
        let scene = scenes(&problem.grains, &problem.contacts).into_iter().next();
        let picture = scene.filter(|_| is_plane).map(|((name, _), scene)| {
            let words = format!("{name}: grains, walls and chains of impulses of {of}");
            inline(&draw(&name, &scene, of), &words)
        });
        let known = |key: &str| entry["known"][key].as_f64().map(|value| number(value, 3));
        let runs = self.rows_of_runs(&|hash| hash == id)?;
        let hazards = self.hazards(&|hazard| hazard.hash == id)?;
        let content = context! {
            title => problem.text("name"), entry => Serde(entry), status => problem.status(), picture,
            natural_map => known("natural_map"), spread => known("spread"),
            submissions => Serde(&problem.submissions), tables => Serde([runs, hazards]),
        };
        Ok(File::new(format!("problem-{id}.html"), filled("problem.html", content)?))
    }

    fn hazards(&self, keep: &dyn Fn(&Hazard) -> bool) -> Result<Rows, ReportError> {
        let kept: Vec<&Hazard> = self.site.hazards.iter().filter(|hazard| keep(hazard)).collect();
        let leads = |row: usize, heading: &str| match heading {
            "problem" => self.page_of(&kept[row].hash),
            "method" => Some(of_method(&kept[row].method)),
            _ => None,
        };
        Ok(Rows::linked("hazards", &tables::hazards(&kept), "", &leads)?.chosen_by(&["status"]))
    }

    /// Returns the studies that rank methods.
    fn ranked(&self) -> impl Iterator<Item = &'s (&'s str, Problems)> {
        let of = |name: &str| self.site.studies.iter().find(|study| study.about.name == name);
        let ranks = move |name: &str| {
            of(name).is_some_and(|study| study.charts.iter().any(|chart| chart.name == "winners"))
        };
        self.studies.iter().filter(move |(name, _)| ranks(name))
    }

    /// Returns the rows of a table of the chart `winners` that name a method in a column, of the first study that has some.
    fn won(&self, table: &str, column: &str, method: &str) -> Result<Option<Rows>, ReportError> {
        let is_own = |label: &str| label == method || label.starts_with(&format!("{method}, "));
        for (name, study) in self.ranked() {
            let parts = Chart::named("winners").map(|chart| chart.parts_of(study)).unwrap_or_default();
            let found = parts.into_iter().find(|part| part.name == table).map(|part| part.kind);
            let Some(Kind::Table(found)) = found else { continue };
            let cells = found.all.column(column)?.str()?;
            let named = |row: &usize| {
                let mut labels = cells.get(*row).unwrap_or_default().split("; ");
                labels.any(|label| is_own(label.split(" ×").next().unwrap_or(label)))
            };
            let kept: Vec<usize> = (0..found.all.height()).filter(named).collect();
            if !kept.is_empty() {
                let name = format!("{name}-{table}-{column}");
                return Ok(Some(Rows::of(&name, &some(&found.all, &kept)?, &found.note)?));
            }
        }
        Ok(None)
    }

    fn method(&self, method: &str) -> Result<String, ReportError> {
        // By study and law the number of all runs, and of those that failed by their ending.
        type Made<'m> = BTreeMap<(&'m str, bool), (u64, BTreeMap<String, u64>)>;
        let mut made = Made::new();
        for (name, study) in self.studies {
            let verdicts = Verdicts::of(&study.runs);
            for run in study.runs.iter().filter(|run| run.method == method) {
                let (all, failed) = made.entry((name, self.facts(run).friction > 0.0)).or_default();
                *all += 1;
                if !verdicts.is_right(run) {
                    *failed.entry(ending_text(run.status)).or_default() += 1;
                }
            }
        }
        let mut failed = Vec::new();
        for ((name, is_frictional), (all, endings)) in made {
            let row = |(ending, runs)| (name, law(is_frictional), ending, runs, all);
            failed.extend(endings.into_iter().map(row));
        }
        let failures = Rows::linked("failures", &tables::failures(&failed), "", &|row, heading| {
            (heading == "study").then(|| format!("studies/{}/index.html", failed[row].0))
        })?;
        let own = |hazard: &&Hazard| hazard.method == method;
        let hazards: Vec<&Hazard> = self.site.hazards.iter().filter(own).collect();
        let content = context! {
            title => method,
            hazards => hazards.len(), broke => hazards.iter().filter(|hazard| !converged(hazard)).count(),
            counts => Serde(self.won("winners-counts", "method", method)?),
            firsts => Serde(self.won("winners", "first", method)?),
            ties => Serde(self.won("winners", "ties", method)?),
            failures => Serde(failures),
            broken => Serde(self.hazards(&|hazard| own(&hazard) && !converged(hazard))?),
        };
        filled("method.html", content)
    }

    /// Converts a text, whose links lead to pages of the site where these are there.
    fn html(&self, text: &str) -> String {
        html(text, &|to| {
            let (file, place) = to.split_once('#').unwrap_or((to, ""));
            if file.starts_with("http") || file.is_empty() {
                return Some(to.to_owned());
            }
            let place = if place.is_empty() { String::new() } else { format!("#{place}") };
            match file.rsplit_once('.')? {
                (name, "svg") if self.site.figures.contains_key(name) => Some(file.to_owned()),
                (name, "md") if self.site.pages.contains_key(name) => {
                    Some(format!("page-{name}.html{place}"))
                }
                _ => None,
            }
        })
    }
}

/// Leads of the tables of runs and of problems.
const RUNS: &str = "Every archived run on a problem, then every archived simulation. Seconds are those after which the natural map is at \
                    most the accuracy and stays below ten times that, set-up included, on the machine that the page of the study names; \
                    they compare within a study alone. –: not reached.";
const COLLECTION: &str = "The collection: each problem with the least residual that is known of it, and whose it is. A status is set by \
                          the program, from stored impulses.";

impl Collected {
    fn text(&self, key: &str) -> &str {
        self.entry[key].as_str().unwrap_or_default()
    }

    fn id(&self) -> &str {
        self.text("id")
    }

    fn status(&self) -> &str {
        self.entry["known"]["status"].as_str().unwrap_or_default()
    }
}
