//! The site: pages of what is archived and collected, for any browser, offline.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use contact::Measure;
use minijinja::context;
use minijinja::value::Serde;
use polars::df;
use polars::prelude::{DataFrame, NamedFrom, Series};
use rayon::prelude::*;
use results::name::Name;
use results::schema::{ContactRow, GrainRow};
use results::study::Study as Stored;
use serde::Serialize;

use crate::charts::Chart;
use crate::charts::profiles::{Pair, paired};
use crate::charts::sample::draw;
use crate::draw::Formats;
use crate::error::ReportError;
use crate::page::{About, Rows, filled, inline, json, replace};
use crate::read::{
    COSTS, Ending, Problems, Ranked, RunRow, Study, Verdicts, accuracy_text, count, counted, ending_text,
    file_name, kinds, natural_maps, number, ranked, scenes, unique,
};
use crate::text::{File, Kind, frame, html};
use crate::{Wanted, report};

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
    let pages = Pages::of(site);
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

/// Rows of the site, read once.
struct Pages<'s> {
    site: &'s Site,
    /// Studies on problems, by name.
    studies: Vec<(&'s str, Problems)>,
    methods: Vec<String>,
    /// All runs on problems, and all simulations.
    runs: (DataFrame, Vec<String>),
    simulations: DataFrame,
}

/// Accuracy of the pairs on the first page.
const ACCURACY: f64 = 1e-4;

impl<'s> Pages<'s> {
    fn of(site: &'s Site) -> Self {
        let mut studies: Vec<(&str, Problems)> = Vec::new();
        for Archived { about, rows, .. } in &site.studies {
            if let Stored::Runs(runs) = rows {
                studies.push((&about.name, runs.into()));
            }
        }
        let methods: BTreeSet<String> = studies
            .iter()
            .flat_map(|(_, study)| study.runs.iter().map(|run| run.method.clone()))
            .chain(site.hazards.iter().map(|hazard| hazard.method.clone()))
            .collect();
        let runs = (runs(site, &studies), hashes(&studies));
        let simulations = simulations(site);
        Self { site, studies, methods: methods.into_iter().collect(), runs, simulations }
    }

    fn is_collected(&self, hash: &str) -> bool {
        self.site.problems.binary_search_by(|problem| problem.id().cmp(hash)).is_ok()
    }

    /// Rows of runs, whose problems lead to their pages.
    fn rows_of_runs(&self, name: &str, keep: &dyn Fn(usize) -> bool) -> Result<Rows, ReportError> {
        let kept: Vec<usize> = (0..self.runs.1.len()).filter(|row| keep(*row)).collect();
        let leads = |row: usize, heading: &str| {
            let hash = &self.runs.1[kept[row]];
            (heading == "problem" && self.is_collected(hash)).then(|| format!("problem-{hash}.html"))
        };
        Rows::linked(name, &some(&self.runs.0, &kept)?, "", &leads)
    }

    fn runs(&self) -> Result<String, ReportError> {
        let runs = self.rows_of_runs("runs", &|_| true)?.chosen_by(&[
            "study",
            "method",
            "mechanics",
            "grains",
            "μ",
            "state",
            "start",
            "status",
        ]);
        let simulations = Rows::of("simulations", &self.simulations, "")?.chosen_by(&[
            "study",
            "method",
            "mechanics",
            "grains",
            "μ",
            "tolerance",
            "status",
        ]);
        let content = context! {
            title => "All runs",
            lead => "Every archived run on a problem, then every archived simulation. Seconds are those after which the natural map is at most the accuracy and stays below ten times that, set-up included, on the machine that the page of the study names; they compare within a study alone. –: not reached.",
            tables => Serde([runs, simulations]),
        };
        filled("list.html", content)
    }

    fn problems(&self) -> Result<String, ReportError> {
        let problems = &self.site.problems;
        let leads = |row: usize, heading: &str| {
            (heading == "name").then(|| format!("problem-{}.html", problems[row].id()))
        };
        let text = |key: &str| problems.iter().map(|p| p.text(key)).collect::<Vec<_>>();
        let known = |key: &str| problems.iter().map(|p| p.entry["known"][key].as_f64()).collect::<Vec<_>>();
        let whole = |key: &str| problems.iter().map(|p| p.entry[key].as_u64()).collect::<Vec<_>>();
        let table = frame(df!(
            "name" => text("name"),
            "mechanics" => text("mechanics"),
            "grains" => whole("grains"),
            "contacts" => whole("contacts"),
            "μ" => problems.iter().map(|p| friction(p.entry["friction"][1].as_f64())).collect::<Vec<_>>(),
            "state" => text("state"),
            "status" => problems.iter().map(Collected::status).collect::<Vec<_>>(),
            "natural_map" => known("natural_map"),
            "solutions" => problems.iter().map(|p| p.entry["known"]["solutions"].as_u64()).collect::<Vec<_>>(),
            "spread" => known("spread"),
            "best_by" => text("by"),
            "id" => text("id"),
        ));
        let filters = &["mechanics", "grains", "μ", "state", "status"];
        let rows = Rows::linked("problems", &table, "", &leads)?.chosen_by(filters);
        let content = context! {
            title => "Problems",
            lead => "The collection: each problem with the least residual that is known of it, and whose it is. A status is set by the program, from stored impulses.",
            tables => Serde([rows]),
        };
        filled("list.html", content)
    }

    fn problem(&self, problem: &Collected) -> Result<File, ReportError> {
        let (id, entry) = (problem.id(), &problem.entry);
        let is_open = problem.status() == "open";
        let of = if is_open { "the best known answer" } else { "a certified solution" };
        let of = if problem.status() == "no-solution" { "the proof that there is no solution" } else { of };
        let in_plane = !problem.grains.is_empty() && problem.grains.iter().all(|grain| grain.z_m == 0.0);
        let scene = scenes(&problem.grains, &problem.contacts).into_iter().next();
        let picture = scene.filter(|_| in_plane).map(|((name, _), scene)| {
            let svg = draw(&name, &scene, of);
            inline(&svg, &format!("{name}: grains, walls and chains of impulses of {of}"))
        });
        let runs = self.rows_of_runs("runs", &|row| self.runs.1[row] == id)?;
        let hazards = self.hazards("hazards", &|hazard| hazard.hash == id)?;
        let content = context! {
            title => problem.text("name"),
            entry => Serde(entry), status => problem.status(), picture,
            natural_map => entry["known"]["natural_map"].as_f64().map(|value| number(value, 3)),
            spread => entry["known"]["spread"].as_f64().map(|value| number(value, 3)),
            submissions => Serde(&problem.submissions),
            tables => Serde([runs, hazards]),
        };
        Ok(File::new(format!("problem-{id}.html"), filled("problem.html", content)?))
    }

    fn hazards(&self, name: &str, keep: &dyn Fn(&Hazard) -> bool) -> Result<Rows, ReportError> {
        let kept: Vec<&Hazard> = self.site.hazards.iter().filter(|hazard| keep(hazard)).collect();
        let text = |of: fn(&Hazard) -> &str| kept.iter().map(|hazard| of(hazard)).collect::<Vec<_>>();
        let table = frame(df!(
            "problem" => text(|hazard| &hazard.problem),
            "method" => text(|hazard| &hazard.method),
            "settings" => text(|hazard| &hazard.settings),
            "status" => text(|hazard| &hazard.status),
            "iterations" => kept.iter().map(|hazard| hazard.iterations).collect::<Vec<_>>(),
            "why" => text(|hazard| &hazard.why),
        ));
        let leads = |row: usize, heading: &str| match heading {
            "problem" => {
                let hash = &kept[row].hash;
                self.is_collected(hash).then(|| format!("problem-{hash}.html"))
            }
            "method" => Some(of_method(&kept[row].method)),
            _ => None,
        };
        Ok(Rows::linked(name, &table, "", &leads)?.chosen_by(&["status"]))
    }

    /// Returns the rows of a table of `winners`, of every study that has it, in which a method is named.
    fn won(&self, table: &str, column: &str, method: &str) -> Result<Option<Rows>, ReportError> {
        let is_own = |label: &str| label == method || label.starts_with(&format!("{method}, "));
        for (name, study) in self.ranked() {
            let labels: Vec<String> = unique(study.runs.iter().map(RunRow::own_label));
            let parts = Chart::named("winners").map(|chart| chart.parts_of(study)).unwrap_or_default();
            let found = parts.into_iter().find(|part| part.name == table).map(|part| part.kind);
            let Some(Kind::Table(found)) = found else { continue };
            let cells = found.all.column(column)?.str()?;
            let named = |row: &usize| {
                let cell = cells.get(*row).unwrap_or_default();
                cell.split("; ").any(|one| is_own(one.split(" ×").next().unwrap_or(one)))
                    && labels.iter().any(|label| cell.contains(label.as_str()))
            };
            let kept: Vec<usize> = (0..found.all.height()).filter(named).collect();
            let rows = Rows::of(&format!("{name}-{table}-{column}"), &some(&found.all, &kept)?, &found.note)?;
            return Ok((!kept.is_empty()).then_some(rows));
        }
        Ok(None)
    }

    /// Studies that rank methods.
    fn ranked(&self) -> impl Iterator<Item = (&str, &Problems)> {
        let ranks = |name: &str| {
            let study = self.site.studies.iter().find(|study| study.about.name == name);
            study.is_some_and(|study| study.charts.iter().any(|chart| chart.name == "winners"))
        };
        self.studies.iter().filter(move |(name, _)| ranks(name)).map(|(name, study)| (*name, study))
    }

    fn method(&self, method: &str) -> Result<String, ReportError> {
        let mut failed: BTreeMap<(&str, bool, String), usize> = BTreeMap::new();
        let mut made: BTreeMap<(&str, bool), usize> = BTreeMap::new();
        for (name, study) in &self.studies {
            let verdicts = Verdicts::of(&study.runs);
            for run in study.runs.iter().filter(|run| run.method == method) {
                let facts = self.site.facts.get(&run.problem_hash);
                let rough = facts.is_some_and(|facts| facts.friction > 0.0);
                *made.entry((name, rough)).or_default() += 1;
                if !verdicts.is_right(run) {
                    *failed.entry((name, rough, ending_text(run.status))).or_default() += 1;
                }
            }
        }
        let law = |rough: bool| if rough { "with friction" } else { "without friction" };
        let failures = frame(df!(
            "study" => failed.keys().map(|(study, ..)| *study).collect::<Vec<_>>(),
            "problems" => failed.keys().map(|(_, rough, _)| law(*rough)).collect::<Vec<_>>(),
            "ending" => failed.keys().map(|(.., ending)| ending.as_str()).collect::<Vec<_>>(),
            "runs" => failed.values().map(|runs| *runs as u64).collect::<Vec<_>>(),
            "of" => failed.keys().map(|(study, rough, _)| made[&(*study, *rough)] as u64).collect::<Vec<_>>(),
        ));
        let failures = Rows::linked("failures", &failures, "", &|row, heading| {
            let (study, ..) = failed.keys().nth(row)?;
            (heading == "study").then(|| format!("studies/{study}/index.html"))
        })?;
        let of_method = |hazard: &Hazard| hazard.method == method;
        let hazards: Vec<&Hazard> = self.site.hazards.iter().filter(|hazard| of_method(hazard)).collect();
        let broke = hazards.iter().filter(|hazard| hazard.status != Ending::Converged.name()).count();
        let content = context! {
            title => method, hazards => hazards.len(), broke,
            counts => Serde(self.won("winners-counts", "method", method)?),
            firsts => Serde(self.won("winners", "first", method)?),
            ties => Serde(self.won("winners", "ties", method)?),
            failures => Serde(failures),
            broken => Serde(self.hazards("hazards", &|hazard| of_method(hazard) && hazard.status != Ending::Converged.name())?),
        };
        filled("method.html", content)
    }

    fn first(&self) -> Result<String, ReportError> {
        let mut fields = Vec::new();
        let mut pairs = Vec::new();
        let mut busy = Vec::new();
        for (name, study) in self.ranked() {
            let kinds = kinds(&study.runs);
            fields.extend(
                ranked(&kinds, &natural_maps(&study.runs)).iter().map(|ranked| self.field(name, ranked)),
            );
            for rough in [true, false] {
                let facts = |run: &&RunRow| {
                    self.site
                        .facts
                        .get(&run.problem_hash)
                        .is_some_and(|facts| (facts.friction > 0.0) == rough)
                };
                let cold = study.runs.iter().filter(|run| !run.warm_start).filter(facts);
                let law = if rough { "with friction" } else { "without friction" };
                pairs.push(context! {
                    title => format!("To a natural map of {}, {law}, from r = 0", accuracy_text(ACCURACY)),
                    table => Serde(matrix(&format!("pairs-{}", file_name(law)), &paired(cold, (Measure::NaturalMap, ACCURACY)))?),
                });
            }
            let timed: Vec<&RunRow> = study.runs.iter().filter(|run| run.status != Ending::Skipped).collect();
            let crowded = |run: &&&RunRow| {
                run.provenance.processors > 0
                    && run.timing.load_average > f64::from(run.provenance.processors)
            };
            let crowded = timed.iter().filter(crowded).count();
            busy.push(format!(
                "Of the {} of {name}, {} began while more processes wanted to run than there are processors.",
                counted(timed.len(), "timed run"),
                count(crowded)
            ));
        }
        let statuses = unique(self.site.hazards.iter().map(|hazard| hazard.status.as_str()));
        let of = |method: &str, status: Option<&str>| {
            let own = self.site.hazards.iter().filter(|hazard| hazard.method == method);
            own.filter(|hazard| status.is_none_or(|status| hazard.status == status)).count() as u64
        };
        let counts = |status: Option<&str>| {
            Series::new(
                status.unwrap_or("runs").replace('-', " ").into(),
                self.methods.iter().map(|method| of(method, status)).collect::<Vec<_>>(),
            )
        };
        let mut stability =
            frame(df!("method" => self.methods.iter().map(String::as_str).collect::<Vec<_>>()));
        for status in std::iter::once(None).chain(statuses.into_iter().map(Some)) {
            stability.with_column(counts(status).into())?;
        }
        let leads = |row: usize, heading: &str| (heading == "method").then(|| of_method(&self.methods[row]));
        let figure = |name: &str, words: &str| self.site.figures.get(name).map(|svg| inline(svg, words));
        let page = |name: &str| {
            self.site.pages.get(name).map(|text| context! {
                name, title => title(text), lead => self.html(lead(text)),
                figure => self.site.pages.get(name).and_then(|text| figure(&first_figure(text)?, title(text))),
            })
        };
        let problems = &self.site.problems;
        let status = |status: &str| problems.iter().filter(|problem| problem.status() == status).count();
        let content = context! {
            fields => json(&fields), busy, pairs,
            stability => Serde(Rows::linked("stability", &stability, "", &leads)?),
            atlas => figure("atlas", "Class of the run of every method on every hazard"),
            residuals => figure("speed", "The residual that each method leaves after so many seconds"),
            speed => page("which-method"),
            needs => ["tolerance", "statics", "elasticity"].map(page),
            mechanics => figure("mechanics", "Effect of friction and of the third dimension on a packing, and its cost"),
            others => self.site.pages.iter().map(|(name, text)| context! { name, title => title(text) }).collect::<Vec<_>>(),
            studies => self.site.studies.iter().map(|study| context! { name => &study.about.name, why => &study.about.why }).collect::<Vec<_>>(),
            methods => &self.methods, runs => count(self.runs.1.len()), simulations => count(self.simulations.height()),
            problems => count(problems.len()), open => status("open"), unsolvable => status("no-solution"),
            site_script => include_str!("site/site.js"),
        };
        filled("first.html", content)
    }

    /// Returns the standings of a kind at an accuracy, as the question form reads them.
    fn field(&self, study: &str, ranked: &Ranked) -> Field {
        let run = ranked.kind.runs[0];
        let facts = self.site.facts.get(&run.problem_hash).cloned().unwrap_or_default();
        Field {
            study: study.to_owned(),
            mechanics: facts.mechanics,
            friction: friction(Some(facts.friction)),
            state: facts.state,
            start: start(run),
            grains: ranked.kind.grains,
            packings: ranked.kind.problems(),
            accuracy: accuracy_text(ranked.accuracy),
            standings: ranked
                .standings
                .iter()
                .map(|s| {
                    let seconds = [s.seconds.median, s.seconds.low, s.seconds.high].map(|s| number(s, 2));
                    (s.label.clone(), s.reached, seconds, number(s.ratio, 2), s.ties)
                })
                .collect(),
        }
    }

    /// Converts a page, whose links lead to pages of the site where these are there.
    fn html(&self, text: &str) -> String {
        html(text, &|to| {
            let (file, place) = to.split_once('#').map_or((to, None), |(file, place)| (file, Some(place)));
            if file.starts_with("http") || file.is_empty() {
                return Some(to.to_owned());
            }
            let (name, ending) = file.rsplit_once('.')?;
            let place = place.map_or_else(String::new, |place| format!("#{place}"));
            match ending {
                "svg" if self.site.figures.contains_key(name) => Some(file.to_owned()),
                "md" if self.site.pages.contains_key(name) => Some(format!("page-{name}.html{place}")),
                _ => None,
            }
        })
    }
}

/// Standings of the methods on a kind of problem at an accuracy: label, problems on which it was reached, seconds with their interval,
/// median ratio to the fastest of each problem, and whether no difference from the first shows.
#[derive(Serialize)]
struct Field {
    study: String,
    mechanics: String,
    friction: String,
    state: String,
    start: &'static str,
    grains: u32,
    packings: usize,
    accuracy: String,
    standings: Vec<(String, usize, [String; 3], String, bool)>,
}

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

/// Returns the first paragraph after the title of a page in Markdown.
fn lead(text: &str) -> &str {
    let after = text.split_once("\n\n").map_or("", |(_, after)| after);
    after.split("\n\n").next().unwrap_or_default()
}

/// Returns the name of the first figure of a page in Markdown.
fn first_figure(text: &str) -> Option<String> {
    let figure = text.split_once("![")?.1.split_once("](")?.1.split_once(".svg")?.0;
    Some(figure.to_owned())
}

/// Writes μ as a text, by which rows are chosen.
fn friction(mu: Option<f64>) -> String {
    mu.map_or_else(|| "–".to_owned(), |mu| mu.to_string())
}

fn start(run: &RunRow) -> &'static str {
    if run.warm_start { "time step before" } else { "r = 0" }
}

/// Returns some rows of a table.
fn some(table: &DataFrame, rows: &[usize]) -> Result<DataFrame, ReportError> {
    let rows: Vec<u32> = rows.iter().map(|row| *row as u32).collect();
    Ok(table.take(&polars::prelude::IdxCa::from_vec("rows".into(), rows))?)
}

/// Returns the ids of the problems of all runs, in their order.
fn hashes(studies: &[(&str, Problems)]) -> Vec<String> {
    studies.iter().flat_map(|(_, study)| study.runs.iter().map(|run| run.problem_hash.clone())).collect()
}

/// Makes the table of all runs on problems.
fn runs(site: &Site, studies: &[(&str, Problems)]) -> DataFrame {
    let runs: Vec<(&str, &RunRow)> =
        studies.iter().flat_map(|(name, study)| study.runs.iter().map(|run| (*name, run))).collect();
    let none = Facts::default();
    let facts: Vec<&Facts> =
        runs.iter().map(|(_, run)| site.facts.get(&run.problem_hash).unwrap_or(&none)).collect();
    let text = |of: fn(&RunRow) -> String| runs.iter().map(|(_, run)| of(run)).collect::<Vec<_>>();
    let to = |accuracy: f64| {
        runs.iter().map(|(_, run)| COSTS[0].to(run, Measure::NaturalMap, accuracy)).collect::<Vec<_>>()
    };
    frame(df!(
        "method" => text(|run| run.method.clone()),
        "settings" => text(|run| run.set.clone()),
        "status" => text(|run| ending_text(run.status)),
        "iterations" => runs.iter().map(|(_, run)| run.iterations).collect::<Vec<_>>(),
        "natural_map_1e_2_s" => to(1e-2),
        "natural_map_1e_4_s" => to(1e-4),
        "natural_map_1e_6_s" => to(1e-6),
        "natural_map_1e_8_s" => to(1e-8),
        "least_natural_map" => runs.iter().map(|(_, run)| run.least().map(|(least, _)| least)).collect::<Vec<_>>(),
        "mechanics" => facts.iter().map(|facts| facts.mechanics.as_str()).collect::<Vec<_>>(),
        "grains" => runs.iter().map(|(_, run)| run.grains_asked()).collect::<Vec<_>>(),
        "μ" => facts.iter().map(|facts| friction(Some(facts.friction))).collect::<Vec<_>>(),
        "state" => facts.iter().map(|facts| facts.state.as_str()).collect::<Vec<_>>(),
        "start" => runs.iter().map(|(_, run)| start(run)).collect::<Vec<_>>(),
        "problem" => text(|run| run.problem.clone()),
        "study" => runs.iter().map(|(study, _)| *study).collect::<Vec<_>>(),
        "id" => text(|run| run.id.clone()),
    ))
}

/// Makes the table of all simulations.
fn simulations(site: &Site) -> DataFrame {
    let studies: Vec<(&str, Study)> = site
        .studies
        .iter()
        .filter(|study| matches!(study.rows, Stored::Simulations(_)))
        .map(|study| (study.about.name.as_str(), Study::from(&study.rows)))
        .collect();
    let mut all = Vec::new();
    for (name, study) in &studies {
        let Study::Simulations(simulations) = study else { continue };
        all.extend(simulations.iter().map(|simulation| (*name, simulation)));
    }
    let none = Facts::default();
    let facts: Vec<&Facts> =
        all.iter().map(|(_, one)| site.facts.get(&one.scene_hash).unwrap_or(&none)).collect();
    let text =
        |of: fn(&crate::read::Simulation) -> String| all.iter().map(|(_, one)| of(one)).collect::<Vec<_>>();
    frame(df!(
        "study" => all.iter().map(|(study, _)| *study).collect::<Vec<_>>(),
        "scene" => text(|one| one.scene.clone()),
        "mechanics" => facts.iter().map(|facts| facts.mechanics.as_str()).collect::<Vec<_>>(),
        "grains" => all.iter().map(|(_, one)| one.grains).collect::<Vec<_>>(),
        "μ" => facts.iter().map(|facts| friction(Some(facts.friction))).collect::<Vec<_>>(),
        "method" => text(|one| one.method.clone()),
        "variant" => text(|one| one.variant.clone()),
        "tolerance" => text(|one| number(one.tolerance, 2)),
        "budget" => all.iter().map(|(_, one)| one.max_iterations).collect::<Vec<_>>(),
        "status" => text(|one| one.status.name().to_owned()),
        "time_steps" => all.iter().map(|(_, one)| one.totals.time_steps).collect::<Vec<_>>(),
        "missed_time_steps" => all.iter().map(|(_, one)| one.totals.missed_time_steps).collect::<Vec<_>>(),
        "iterations" => all.iter().map(|(_, one)| one.totals.iterations).collect::<Vec<_>>(),
        "id" => text(|one| one.id.clone()),
    ))
}

/// Makes a table with a row and a column for each method: on which share of the problems that either solves the one of the row wins,
/// and on which no difference shows.
fn matrix(name: &str, pairs: &[Pair]) -> Result<Rows, ReportError> {
    let methods = unique(pairs.iter().map(|pair| pair.method.as_str()));
    let share = |method: &str, against: &str| {
        let pair = pairs.iter().find(|pair| pair.method == method && pair.against == against);
        let Some(pair) = pair.filter(|pair| pair.counts.iter().sum::<u64>() > 0) else {
            return "–".to_owned();
        };
        let all = pair.counts.iter().sum::<u64>() as f64;
        let [wins, ties, _] = pair.counts.map(|count| (100.0 * count as f64 / all).round());
        format!("{wins}\u{a0}+\u{a0}{ties} of {all}")
    };
    let mut table = frame(df!("wins_+_ties_%_of_problems" => &methods));
    for against in &methods {
        let cells: Vec<String> = methods.iter().map(|method| share(method, against)).collect();
        table.with_column(Series::new(format!("over {against}").into(), cells).into())?;
    }
    Rows::of(name, &table, "")
}
