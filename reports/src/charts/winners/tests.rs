use results::schema::{Ending, Run, Timing};
use serde_json::json;

use super::*;
use crate::read::Study;
use crate::tests::fixture::{object, run, sample, stored, tables};
use crate::text::Kind as Made;

/// Runs of a method on so many packings, each with its seconds to 1e-4, which it does not reach where there are none.
fn on_packings(
    first: u32,
    method: &str,
    seconds: &[Option<f64>],
) -> (Vec<Run>, Vec<(u32, Vec<results::schema::Sample>)>) {
    let one = |(k, seconds): (u32, &Option<f64>)| {
        let problem_settings = object(
            &json!({ "case": "box", "time_step": 399, "moment": "rest", "sample.grains": 60, "sample.seed": k, "scene.friction": 0.3 }),
        );
        let timing = Timing { repeats: 5, setup_spread_s: 0.0, iterating_spread_s: 0.0, ..Timing::default() };
        let row = Run {
            problem: format!("box seed={k}"),
            problem_settings,
            setup_s: seconds.unwrap_or(1.0),
            iterating_s: 0.0,
            timing,
            ..run(first + k, method, "", Ending::Converged)
        };
        (row, (first + k, vec![sample(0, 0.1, if seconds.is_some() { 1e-5 } else { 1e-3 })]))
    };
    (0..).zip(seconds).map(one).unzip()
}

fn made(all: &[(&str, &[Option<f64>])]) -> (String, String) {
    let each =
        (0..).zip(all).map(|(k, (method, seconds))| on_packings(k * seconds.len() as u32, method, seconds));
    let (runs, curves): (Vec<_>, Vec<_>) = each.unzip();
    let study = Study::from(&stored(&tables(&runs.concat(), &curves.concat())));
    let Study::Problems(study) = study else { panic!("it is of runs") };
    let parts = parts(&study);
    let Made::Figure(svg) = &parts[0].kind else { panic!("it is a figure") };
    let Made::Table(table) = &parts[2].kind else { panic!("it is a table") };
    (svg.clone(), crate::text::csv(&table.all).unwrap())
}

/// One kind of problem, whatever its seeds: all in a row of the figure and of the table for each accuracy.
#[test]
fn packings_of_a_kind_are_one_row() {
    let (svg, csv) = made(&[("nsgs", &[Some(1.0), Some(1.0)]), ("cg", &[Some(2.0), Some(2.0)])]);
    assert!(
        svg.contains("rest, μ = 0.3") && svg.contains("2\u{a0}packings") && svg.contains("60\u{a0}grains"),
        "{svg}"
    );
    assert!(csv.contains("box,\"rest, μ = 0.3\",60,2,0.0001,nsgs,\"\",2,1.0"), "{csv}");
}

/// The winner of a tie has no claim alone, and one that misses a packing is marked.
#[test]
fn ties_and_what_is_missed_show() {
    let (_, csv) = made(&[("nsgs", &[Some(1.0), Some(2.0)]), ("cg", &[Some(2.0), Some(1.0)])]);
    assert!(csv.contains("nsgs,cg ×1.5,2") || csv.contains("cg,nsgs ×1.5,2"), "{csv}");
    let on_some = "on some of the packings alone";
    let (svg, csv) = made(&[("nsgs", &[Some(1.0), None]), ("cg", &[None, None])]);
    assert!(svg.contains(on_some) && csv.contains("nsgs,\"\",1"), "{csv}");
    let (svg, csv) = made(&[("nsgs", &[None, None])]);
    assert!(svg.contains("no method reaches it") && !svg.contains(on_some), "{svg}");
    assert!(csv.contains("0.0001,,\"\",0,,,"), "{csv}");
}
