//! `gravel bench` in a checkout of its own: what it writes, and where.

use crate::common::{Ran, checkout, entries, gravel, pair, text, write};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A checkout with one case, the frozen problem `pair` and one plan.
pub(crate) struct Study(TempDir);

impl Study {
    pub(crate) fn new() -> Self {
        let folder = TempDir::new().unwrap();
        for inner in ["cases/frozen", "harness/plans"] {
            fs::create_dir_all(folder.path().join(inner)).unwrap();
        }
        fs::copy(checkout().join("cases/column.toml"), folder.path().join("cases/column.toml")).unwrap();
        write(&folder, "cases/frozen/pair.json", &pair().to_string());
        Self(folder)
    }

    pub(crate) fn folder(&self) -> &TempDir {
        &self.0
    }

    /// Runs `gravel` on this checkout.
    pub(crate) fn gravel(&self, args: &[&str]) -> Ran {
        gravel(&[&["--root", text(self.0.path())], args].concat())
    }

    pub(crate) fn plan(&self, name: &str, problems: &[&str], methods: &str) {
        write(&self.0, &format!("harness/plans/{name}.toml"), &plan(name, problems, methods));
    }

    /// Runs a plan and returns the folder of its rows.
    pub(crate) fn bench(&self, name: &str) -> PathBuf {
        self.gravel(&["bench", name]).succeeded();
        self.runs(name)
    }

    /// The folder of a plan's rows.
    pub(crate) fn runs(&self, name: &str) -> PathBuf {
        self.0.path().join("results/runs").join(name)
    }
}

/// The text of a plan that stops at `natural_map` ≤ 1e-3.
pub(crate) fn plan(name: &str, problems: &[&str], methods: &str) -> String {
    format!(
        "name = \"{name}\"\nwhy = \"A test.\"\nproblems = {problems:?}\n\n\
         [stop]\non = \"natural_map\"\ntolerance = 1e-3\nmax_iterations = 10_000\n\n{methods}"
    )
}

/// NSGS, and NSGS-DD with as many subdomains as the pair has contacts, and with more.
const METHODS: &str = "[[methods]]\nmethod = \"nsgs\"\n\n\
     [[methods]]\nmethod = \"nsgs-dd\"\naxes = { subdomains = [\"1x2\", \"3x3\", \"65536x65536\"] }\n";

pub(crate) fn study_of_the_pair_and_a_column() -> Study {
    let study = Study::new();
    let column = study.folder().path().join("cases/frozen/column-9.json");
    let freeze = ["freeze", "column", "--time-step", "1", "--scene", "sample.grains=9", "-o", text(&column)];
    study.gravel(&freeze).succeeded();
    study.plan("small", &["pair", "column-9"], METHODS);
    study
}

/// The rows of a plan's runs or curves, less what differs from one time to the next.
pub(crate) fn counts(study: &Study, plan: &str, table: &str) -> Vec<BTreeMap<String, String>> {
    let mut rows = rows(study.runs(plan).join(table));
    let timing = ["started_utc", "load_average", "timed_alone", "repeats", "threads"];
    for row in &mut rows {
        row.retain(|column, _| !column.ends_with("_s") && !timing.contains(&&**column));
    }
    assert!(!rows.is_empty());
    rows
}

/// The rows of a CSV file, each by column.
pub(crate) fn rows(file: PathBuf) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines().map(fields);
    let header = lines.next().unwrap();
    lines
        .map(|values| {
            assert_eq!(values.len(), header.len(), "{values:?}");
            header.iter().cloned().zip(values).collect()
        })
        .collect()
}

/// The fields of a line: those with a comma or a quote in them are quoted, and their quotes doubled.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    // A doubled quote ends a quoted part and begins the next: it leaves `quoted` as it was, and one quote behind.
    let mut before = ' ';
    for c in line.chars() {
        match c {
            ',' if !quoted => fields.push(String::new()),
            '"' => {
                quoted = !quoted;
                if quoted && before == '"' {
                    fields.last_mut().unwrap().push('"');
                }
            }
            _ => fields.last_mut().unwrap().push(c),
        }
        before = c;
    }
    fields
}

#[test]
fn study_leaves_its_rows_and_its_figures_under_its_root() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let root = study.folder().path();
    assert_eq!(entries(root), ["cases", "harness", "reports", "results"]);
    assert_eq!(entries(&root.join("results/runs")), ["small"]);
    let tables = [
        "contacts.parquet",
        "curves.csv",
        "curves.parquet",
        "grains.parquet",
        "runs.csv",
        "runs.parquet",
        "snapshots.parquet",
    ];
    let mut files = entries(&folder);
    files.retain(|file| file != "journal.jsonl" && file != "lock");
    assert_eq!(files, tables);
    let out = entries(&root.join("reports/out/small"));
    let figures = ["convergence-column-9.svg", "convergence-pair.svg", "convergence.svg"];
    for file in ["index.html", "iterations.csv", "iterations.md", "iterations.tex"].iter().chain(&figures) {
        assert!(out.iter().any(|name| name == file), "no {file} in {out:?}");
    }
    for figure in out.iter().filter(|name| name.contains(".svg")) {
        let svg = fs::read_to_string(root.join("reports/out/small").join(figure)).unwrap();
        assert!(svg.trim_end().ends_with("</svg>"), "{figure} is not whole");
    }

    let (results::study::Study::Runs(runs), _) = results::store::read(&folder).unwrap() else { panic!() };
    // The pair has 2 grains and 2 contacts, the column 9; 1x2 fits both, 3x3 the column only.
    assert_eq!(runs.records.len(), 8);
    assert_eq!((runs.grains.len(), runs.contacts.len()), (2 + 2 * 9, 2 + 2 * 9));
    assert!(runs.records.iter().all(|record| record.snapshots.is_empty()), "the plan shows no run");
}

#[test]
fn every_run_says_what_was_asked_and_where_it_comes_from() {
    let study = study_of_the_pair_and_a_column();
    let rows = rows(study.bench("small").join("runs.csv"));
    let asked = ["pair", "column-9"].into_iter().flat_map(|problem| {
        let dd = ["1x2", "3x3", "65536x65536"].map(|variant| (problem, "nsgs-dd", variant));
        std::iter::once((problem, "nsgs", "")).chain(dd)
    });
    assert_eq!(rows.len(), 8);
    for (row, (problem, method, variant)) in rows.iter().zip(asked) {
        assert_eq!((&*row["problem"], &*row["method"], &*row["variant"]), (problem, method, variant));
        assert_eq!((&*row["plan"], &*row["stop_on"], &*row["tolerance"]), ("small", "natural_map", "0.001"));
        let settings: serde_json::Value = serde_json::from_str(&row["settings"]).unwrap();
        assert!(settings.as_object().unwrap().len() > 2, "defaults are spelled out");
        for column in
            ["id", "problem_hash", "commit", "processor", "threads", "rustc", "profile", "started_utc"]
        {
            assert!(!row[column].is_empty(), "{column}");
        }
    }
}

#[test]
fn method_that_cannot_start_is_a_skipped_row_with_its_reason_and_the_plan_goes_on() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let rows = rows(folder.join("runs.csv"));
    let status: Vec<&str> = rows.iter().map(|row| &*row["status"]).collect();
    let (done, not) = ("converged", "skipped");
    assert_eq!(status, [done, done, not, not, done, done, done, not]);
    for row in &rows {
        let reason = match &*row["variant"] {
            variant if row["status"] == not => format!(
                "`subdomains` is {variant}: it must be at most {} subdomains, the number of contacts",
                row["contacts"]
            ),
            _ => String::new(),
        };
        assert_eq!(row["reason"], reason);
    }
    let skipped = &rows[2];
    assert_eq!((&*skipped["iterations"], &*skipped["contact_updates"]), ("0", "0"));
    for column in ["setup_s", "iterating_s", "zeta", "natural_map", "energy_j"] {
        assert_eq!(skipped[column], "", "{column} of a run that was not made");
    }
    let curves = fs::read_to_string(folder.join("curves.csv")).unwrap();
    assert!(curves.lines().any(|line| line.starts_with("1,")));
    assert!(!curves.lines().any(|line| line.starts_with("2,")), "a run that was not made has no curve");
}

#[test]
fn curve_of_a_run_ends_at_its_last_iterate() {
    let study = study_of_the_pair_and_a_column();
    let nsgs = "[[methods]]\nmethod = \"nsgs\"\n";
    // Beyond 100 iterations a curve keeps one sample in each hundredth of them: of these two ends, it keeps one only
    // because it is the end.
    for limit in ["133", "134"] {
        let plan = plan("limited", &["column-9"], nsgs).replace("1e-3", "0.0").replace("10_000", limit);
        write(study.folder(), "harness/plans/limited.toml", &plan);
        let folder = study.bench("limited");
        let (run, curve) = (&rows(folder.join("runs.csv"))[0], rows(folder.join("curves.csv")));
        assert_eq!((&*run["status"], &*run["iterations"]), ("iteration-limit", limit));
        let (first, last) = (&curve[0], &curve[curve.len() - 1]);
        assert_eq!((&*first["iteration"], &*first["zeta"]), ("0", ""), "ζ is undefined there");
        assert_eq!(&*last["iteration"], limit);
        for column in ["natural_map", "zeta", "energy_j", "contact_updates"] {
            assert_eq!(run[column], last[column], "{column}");
        }
    }
}

#[test]
fn reasons_of_skipped_runs_are_printed_below_the_table() {
    let study = study_of_the_pair_and_a_column();
    let printed = study.gravel(&["bench", "small"]).succeeded().stdout;
    let reason = "skipped: nsgs-dd 3x3 on pair: `subdomains` is 3x3: it must be at most 2 subdomains";
    assert!(printed.contains(reason), "{printed}");
    let table = study.folder().path().join("reports/out/small/iterations.md");
    assert!(fs::read_to_string(table).unwrap().contains(reason));
}

#[test]
fn study_made_twice_differs_in_seconds_and_its_time_only() {
    let study = study_of_the_pair_and_a_column();
    study.bench("small");
    let first = ["runs.csv", "curves.csv"].map(|table| counts(&study, "small", table));
    study.gravel(&["bench", "small", "--rerun"]).succeeded();
    assert_eq!(first, ["runs.csv", "curves.csv"].map(|table| counts(&study, "small", table)));
}

#[test]
fn number_of_threads_and_of_jobs_changes_seconds_only() {
    let study = study_of_the_pair_and_a_column();
    let bench = |threads, jobs| {
        let how = ["--threads", threads, "bench", "small", "--jobs", jobs, "--rerun"];
        study.gravel(&how).succeeded();
        let rows = rows(study.runs("small").join("runs.csv"));
        assert!(rows.iter().all(|row| row["threads"] == threads));
        assert!(rows.iter().all(|row| row["timed_alone"] == (jobs == "1").to_string()));
        ["runs.csv", "curves.csv"].map(|table| counts(&study, "small", table))
    };
    let alone = bench("1", "1");
    assert_eq!(alone, bench("2", "1"));
    assert_eq!(alone, bench("2", "4"));
}

#[test]
fn repeats_give_medians_with_their_spreads() {
    let study = study_of_the_pair_and_a_column();
    study.gravel(&["bench", "small", "--repeats", "3"]).succeeded();
    let repeated = rows(study.runs("small").join("runs.csv"));
    let curves = rows(study.runs("small").join("curves.csv"));
    for row in repeated.iter().filter(|row| row["status"] == "converged") {
        let seconds = |column: &str| row[column].parse::<f64>().unwrap();
        // A short one is repeated more often.
        assert!(row["repeats"].parse::<u32>().unwrap() >= 3, "{}", row["repeats"]);
        assert!(seconds("setup_spread_s") >= 0.0 && seconds("iterating_spread_s") >= 0.0);
        // Four times: once before the three, which is not counted.
        assert!(seconds("wall_s") >= 3.0 * seconds("iterating_s") - 2.0 * seconds("iterating_spread_s"));
        let last = curves.iter().rfind(|sample| sample["run"] == row["run"]).unwrap();
        assert_eq!(last["iterating_s"], row["iterating_s"], "the curve is that of the median");
    }
    let counted = counts(&study, "small", "curves.csv");
    study.gravel(&["bench", "small", "--rerun"]).succeeded();
    assert_eq!(counted, counts(&study, "small", "curves.csv"));
    assert_eq!(rows(study.runs("small").join("runs.csv"))[0]["setup_spread_s"], "");
}
