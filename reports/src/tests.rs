//! The reports of small studies: what they show, and that nothing in the tables stops them.

pub(crate) mod fixture;
pub(crate) mod fixture_in_time;

use contact::Measure;
use results::name::StopOn;
use results::schema::Ending;
use std::fs;

use crate::tests::fixture::{
    decay, explosion, files, object, read, run, sample, scene, stored, tables, whole,
};
use crate::text::{Kind, Table, markdown, rows};
use crate::{About, Chart, Formats, Wanted, report, summary};
use polars::prelude::DataFrame;
use results::schema::{Run, Sample};
use results::study::Runs;
use serde_json::json;
use tempfile::TempDir;

fn figures(runs: &Runs) -> Vec<(String, String)> {
    let study = whole(runs);
    let charts = Chart::default_set(false).into_iter();
    let figures: Vec<_> = charts.flat_map(|chart| files(&chart.parts(&study))).collect();
    for (name, svg) in &figures {
        assert_well_formed(name, svg);
    }
    figures
}

/// Elements are closed in order, and no number is NaN or infinite.
pub(crate) fn assert_well_formed(name: &str, svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').expect("every tag ends");
        let word = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(word), "{name}");
        } else if !tag.ends_with('/') {
            open.push(word);
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{name}: {tag}");
        assert!(!tag.contains("NaN") && !tag.contains("inf"), "{name}: {tag}");
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

fn study() -> Runs {
    let on = |subdomains, run: Run| {
        let settings = object(&json!({ "subdomains": run.variant }));
        Run { subdomains, settings, ..run }
    };
    let runs = [
        run(0, "nsgs", "", Ending::Converged),
        on(8, run(1, "nsgs-dd", "4x2", Ending::IterationLimit)),
        on(2, run(2, "nsgs-dd", "2x1", Ending::Converged)),
        run(3, "cg", "", Ending::Diverged),
    ];
    tables(&runs, &[(0, decay()), (1, decay()), (2, decay()), (3, explosion())])
}

pub(crate) fn about() -> About {
    let again = "paper".to_owned();
    let rows = "../../../results/runs/paper".into();
    About {
        name: "paper".into(),
        why: "What <it> asks.".into(),
        bench: again.clone(),
        rows,
        text: None,
        draw: Some(again),
    }
}

#[test]
fn study_without_runs_says_so() {
    let empty = tables(&[], &[]);
    let figures = figures(&empty);
    assert_eq!(figures.len(), 1);
    assert!(figures[0].1.contains("no run in this study"));
    assert!(summary(&stored(&empty)).unwrap().contains("no such run in this study"));
}

#[test]
fn each_problem_has_a_figure_and_a_page_has_all() {
    let runs = [
        run(0, "nsgs", "", Ending::Converged),
        Run { problem: "a b/c".into(), ..run(1, "nsgs", "", Ending::Converged) },
    ];
    let figures = figures(&tables(&runs, &[(0, decay())]));
    let names: Vec<&str> = figures.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["convergence-column.svg", "convergence-a-b-c.svg", "convergence.svg"]);
    assert!(figures[1].1.contains("no value in this range"), "the second run has no curve");
}

#[test]
fn more_problems_than_a_page_holds_are_not_squeezed() {
    let many: Vec<Run> = (0..9)
        .map(|i| Run { problem: format!("problem {i}"), ..run(i, "nsgs", "", Ending::Converged) })
        .collect();
    assert!(figures(&tables(&many, &[])).iter().all(|(name, _)| name != "convergence.svg"));
}

#[test]
fn runs_that_only_fail_are_drawn_until_they_leave_the_frame() {
    let failed = tables(&[run(0, "jacobi", "", Ending::Diverged)], &[(0, explosion())]);
    let svg = &figures(&failed)[0].1;
    assert!(svg.contains("10¹") && !svg.contains("10³⁰"), "one decade above 1 shows that it grew");
    assert!(!svg.contains("no value in this range"));
}

#[test]
fn undefined_infinite_zero_and_negative_values_are_no_obstacle() {
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e300, 1e-300];
    let curve: Vec<Sample> = (0..).zip(values).map(|(i, value)| sample(i, value, value)).collect();
    let odd = Run { tolerance: f64::NAN, ..run(0, "nsgs", "", Ending::Converged) };
    let none = Run { tolerance: 0.0, ..run(1, "cg", "", Ending::Converged) };
    figures(&tables(&[odd, none], &[(0, curve), (1, vec![sample(0, f64::NAN, f64::NAN)])]));
}

#[test]
fn legend_orders_variants_by_subdomains() {
    let svg = &figures(&study())[0].1;
    assert!(svg.find("nsgs-dd 2x1").unwrap() < svg.find("nsgs-dd 4x2").unwrap());
}

#[test]
fn skipped_run_has_its_reason_below_the_table_and_no_place_in_the_figure() {
    let reason = "`subdomains` is 8x8: it must be at most 20 subdomains, the number of contacts";
    let skipped = Run { reason: reason.into(), ..run(1, "nsgs-dd", "8x8", Ending::Skipped) };
    let study = tables(&[run(0, "nsgs", "", Ending::Converged), skipped], &[(0, decay())]);
    let text = summary(&stored(&study)).unwrap();
    assert!(text.ends_with(&format!("\nskipped: nsgs-dd 8x8 on column: {reason}\n")), "{text}");
    let svg = &figures(&study)[0].1;
    assert!(svg.contains(", 1\u{a0}run\n") && !svg.contains("nsgs-dd"), "{svg}");
}

#[test]
fn run_that_begins_converged_is_told_for_it_has_no_line() {
    let begun = Run { iterations: 0, ..run(0, "cg", "none", Ending::Converged) };
    let svg = figures(&tables(&[begun], &[(0, vec![sample(0, f64::NAN, 0.0)])])).remove(0).1;
    assert!(svg.contains("cg on column: converged at its start, no line"), "{svg}");
}

#[test]
fn method_looks_the_same_in_every_study() {
    let alone = [run(0, "cg", "", Ending::Converged)];
    let beside = [
        run(0, "nsgs", "", Ending::Converged),
        run(1, "mine", "", Ending::Converged),
        run(2, "cg", "", Ending::Converged),
    ];
    let color = |runs: &[Run], method: &str| {
        let study = read(&tables(runs, &[]));
        crate::draw::Looks::new(&study.runs).of_method(method).pen.color
    };
    assert_eq!(color(&alone, "cg"), color(&beside, "cg"));
    assert_ne!(color(&beside, "mine"), color(&beside, "nsgs"));
}

#[test]
fn tolerance_is_written_beside_the_measure_that_stops() {
    let texts = |stop_on: Measure| {
        let asked =
            Run { stop_on: StopOn(stop_on), tolerance: 3e-5, ..run(0, "nsgs", "", Ending::Converged) };
        figures(&tables(&[asked], &[(0, decay())]))[0].1.matches("3·10⁻⁵").count()
    };
    assert_eq!((texts(Measure::Zeta), texts(Measure::NaturalMap), texts(Measure::QuadDv)), (1, 1, 0));
}

#[test]
fn sample_shows_counts_scales_and_boundary_grains() {
    let (grains, contacts) = scene(2.0);
    let scene = Runs {
        grains,
        contacts,
        ..tables(&[Run { problem: "pair".into(), ..run(0, "cg", "diagonal", Ending::Converged) }], &[])
    };
    let (name, svg) = figures(&scene).pop().unwrap();
    assert_eq!(name, "sample-pair-2x1.svg");
    assert!(svg.contains("of the reference"), "whose impulses they are: {svg}");
    for text in [
        "3\u{a0}grains,",
        "3\u{a0}contacts,",
        "2 of them",
        "0.1 m",
        "2.0 N·s",
        "boundary grain",
        "no contact",
        "E0",
        "E1",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    // Three grains, two in the key, two that bear a name; each with an outline.
    assert_eq!(svg.matches("<circle").count(), 3 + 2 + 2);
}

#[test]
fn scene_without_impulses_or_without_grains_says_so() {
    let (grains, contacts) = scene(f64::NAN);
    let mut unknown = tables(&[], &[]);
    (unknown.grains, unknown.contacts) = (grains, contacts);
    assert!(figures(&unknown).pop().unwrap().1.contains("No impulse is known."));
    unknown.grains.clear();
    assert!(figures(&unknown).pop().unwrap().1.contains("0\u{a0}grains"));
}

#[test]
fn same_tables_give_the_same_bytes_and_replace_the_files() {
    let out = TempDir::new().unwrap();
    let read = |paths: &[std::path::PathBuf]| paths.iter().map(|p| fs::read(p).unwrap()).collect::<Vec<_>>();
    let charts = Chart::default_set(false);
    let wanted = Wanted { charts: &charts, formats: Formats::default(), against: None };
    let make = || report(&stored(&study()), &about(), wanted, &out.path().join("paper"));
    let first = make().unwrap();
    let bytes = read(&first);
    fs::write(&first[0], "old").unwrap();
    let second = make().unwrap();
    assert_eq!(first, second);
    assert_eq!(bytes, read(&second));
    assert_eq!(fs::read_dir(out.path()).unwrap().count(), 1, "no draft is left");
}

#[test]
fn table_reads_off_what_the_rows_say() {
    let Kind::Table(Table { all: table, .. }) = rows(&whole(&study())).unwrap().kind else { panic!() };
    let number = |table: &DataFrame, column: &str, row| table.column(column).unwrap().u64().unwrap().get(row);
    assert_eq!(number(&table, "iterations_to_zeta_1e_3", 0), Some(31));
    assert_eq!(number(&table, "iterations_to_zeta_1e_4", 0), None);
    assert_eq!(number(&table, "iterations_to_natural_map_1e_2", 2), Some(47));
    assert_eq!(number(&table, "contact_updates", 3), Some(4000));
    let text = markdown(&table).unwrap();
    let row: Vec<&str> = text.lines().nth(3).unwrap().split('|').map(str::trim).collect();
    let expected = [
        "",
        "column",
        "nsgs-dd",
        "4x2",
        "8",
        "iteration-limit",
        "31",
        "–",
        "47",
        "100",
        "100",
        "4000",
        "200",
    ];
    assert_eq!(row[..13], expected);
    assert_eq!(
        row[13..],
        ["0", "0", "10⁻⁵", "0.0123", "10⁻⁴", "10⁻⁴", "–", "–", "–", "–", "", "–", "", "0000000000000001", ""]
    );
}
