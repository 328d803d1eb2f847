use results::schema::{Ending, Run};
use serde_json::json;

use super::*;
use crate::read::Study;
use crate::tests::fixture::{object, run, sample, stored, tables};
use crate::text::Kind as Made;

/// A run on the packing of a seed that ends at a natural map.
fn ended(id: u32, method: &str, seed: u32, natural_map: f64) -> (Run, (u32, Vec<results::schema::Sample>)) {
    let settings = json!({ "case": "box", "time_step": 9, "moment": "rest", "sample.grains": 60, "sample.seed": seed, "known": if seed == 1 { "certified" } else { "open" } });
    let row = Run {
        problem: format!("box seed={seed}"),
        problem_settings: object(&settings),
        ..run(id, method, "", Ending::IterationLimit)
    };
    (row, (id, vec![sample(0, 0.5, 0.5), sample(9, natural_map, natural_map)]))
}

/// Statuses of the collection do not part a kind; a method that comes to an accuracy on one of two packings comes there on some.
#[test]
fn methods_are_counted_by_what_they_reach() {
    let all = [
        ended(0, "nsgs", 1, 1e-5),
        ended(1, "nsgs", 2, 1e-3),
        ended(2, "cg", 1, 0.4),
        ended(3, "cg", 2, 0.4),
    ];
    let (runs, curves): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let study = Study::from(&stored(&tables(&runs, &curves)));
    let Study::Problems(study) = study else { panic!("it is of runs") };
    let parts = parts(&study);
    let Made::Figure(svg) = &parts[0].kind else { panic!("it is a figure") };
    assert!(["on all packings", "on some", "on none"].iter().all(|cell| svg.contains(cell)), "{svg}");
    let Made::Table(table) = &parts[1].kind else { panic!("it is a table") };
    let csv = crate::text::csv(&table.all).unwrap();
    assert!(csv.contains("box,rest,60,nsgs,0.01,2,2,1,1"), "{csv}");
    assert!(csv.contains("box,rest,60,nsgs,0.0001,2,1,1,1"), "{csv}");
    assert!(csv.contains("box,rest,60,cg,0.01,2,0,1,1"), "{csv}");
}
