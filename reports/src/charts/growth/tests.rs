use results::schema::{Ending, Run, Sample};
use serde_json::json;

use super::*;
use crate::read::Study;
use crate::tests::fixture::{object, run, sample, stored, tables};
use crate::text::{Kind as Made, csv};

/// A run on the packing of a seed that comes to 1e-2 after so many iterations, and no further.
fn on_packing(
    id: u32,
    seed: u32,
    (method, grid): (&str, &str),
    iterations: u64,
) -> (Run, (u32, Vec<Sample>)) {
    let settings = if grid.is_empty() { object(&json!({})) } else { object(&json!({ "subdomains": grid })) };
    let row = Run {
        problem: format!("box seed={seed}"),
        problem_settings: object(&json!({ "case": "box", "time_step": 1, "sample.seed": seed })),
        settings,
        subdomains: if grid == "4x2" { 8 } else { 1 },
        ..run(id, method, grid, Ending::IterationLimit)
    };
    (row, (id, vec![sample(0, 1.0, 1.0), sample(iterations, 0.02, 0.01)]))
}

#[test]
fn ratios_are_medians_over_the_packings() {
    // Of five packings, 1.0, 1.1, 1.2, 1.3 and 2.0 times the iterations of NSGS.
    let mut all = Vec::new();
    for (seed, iterations) in (1..).zip([100, 110, 120, 130, 200]) {
        let id = all.len() as u32;
        all.push(on_packing(id, seed, ("nsgs", ""), 100));
        all.push(on_packing(id + 1, seed, ("nsgs-dd", "4x2"), iterations));
    }
    let (runs, curves): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let study = Study::from(&stored(&tables(&runs, &curves)));
    let Study::Problems(study) = study else { panic!("it is of runs") };
    let parts = parts(&study);
    let Made::Table(table) = &parts[1].kind else { panic!("it is a table") };
    let csv = csv(&table.all).unwrap();
    assert!(csv.contains("nsgs-dd,8,natural_map,0.01,5,5,1.2,1.0,2.0"), "{csv}");
    // ζ stays above 1e-2.
    assert!(csv.contains("nsgs-dd,8,zeta,0.1,5,5,") && !csv.contains("zeta,0.01"), "{csv}");
    let Made::Figure(svg) = &parts[0].kind else { panic!("it is a figure") };
    assert!(svg.contains("5\u{a0}packings") && svg.contains("nsgs-dd, 8 subdomains"), "{svg}");
}
