//! Classes by their rule; matrices, tables and sentences of small studies.

use results::schema::Ending;
use results::schema::{Run, Sample};

use super::parts;
use crate::tests::assert_well_formed;
use crate::tests::fixture::{File, end, files, object, run, sample, study};
use serde_json::json;

/// A run on `problem` with a curve of (iteration, natural map).
fn judged(id: u32, variant: &str, status: Ending, problem: &str, curve: &[(u64, f64)]) -> (Run, Vec<Sample>) {
    let curve: Vec<Sample> = curve.iter().map(|(i, value)| sample(*i, *value, *value)).collect();
    let case = problem.split(' ').next().unwrap_or_default();
    let run = Run {
        problem: problem.into(),
        problem_settings: object(&json!({ "case": case })),
        settings: object(&json!({ "name": variant })),
        spectrum: object(&json!({ "lambda_max": 2.5 })),
        iterations: curve.last().map_or(0, |end| end.iteration),
        ..run(id, "jacobi", variant, status)
    };
    (run, curve)
}

fn made(rows: Vec<(Run, Vec<Sample>)>) -> Vec<File> {
    let (runs, curves): (Vec<Run>, Vec<_>) =
        (0..).zip(rows).map(|(number, (run, curve))| (run, (number, curve))).unzip();
    let files = files(&parts(&study(&runs, &curves)));
    for (name, text) in files.iter().filter(|(name, _)| name.contains(".svg")) {
        assert_well_formed(name, text);
    }
    files
}

fn text<'f>(files: &'f [File], name: &str) -> &'f str {
    &files.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no {name}")).1
}

/// The classes of a study, by its table.
fn classes(files: &[File]) -> Vec<String> {
    let rows = text(files, "atlas.csv").lines().skip(1);
    rows.map(|row| row.split(',').nth(5).unwrap().to_owned()).collect()
}

#[test]
fn class_is_decided_by_the_ending_and_the_curve() {
    let far = |(run, mut curve): (Run, Vec<Sample>)| {
        for sample in &mut curve {
            sample.measures.velocity_error = 0.5;
        }
        (run, curve)
    };
    let proof = judged(6, "g", Ending::Infeasible, "wedge", &[(0, 1.0), (1024, 1e-2)]);
    let files = made(vec![
        judged(0, "a", Ending::Converged, "pile", &[(0, 1.0), (50, 1e-4)]),
        judged(1, "b", Ending::IterationLimit, "pile", &[(0, 1.0), (512, 0.5), (1000, 0.49)]),
        judged(2, "c", Ending::IterationLimit, "pile", &[(0, 1.0), (500, 0.5), (1000, 0.499)]),
        judged(3, "d", Ending::Diverged, "pile", &[(0, 1.0), (9, 1e30)]),
        far(judged(4, "e", Ending::Converged, "pile", &[(0, 1.0), (50, 1e-4)])),
        judged(5, "f", Ending::FalseConvergence, "pile", &[(0, 1.0), (50, 1e-4)]),
        // Of a problem that no run solves, and of one that has a solution.
        (Run { end: end(sample(1024, 1e-2, f64::NAN)), ..proof.0 }, proof.1),
        judged(9, "j", Ending::Infeasible, "pile", &[(0, 1.0), (1024, 1e-2)]),
        (
            Run { reason: "`subdomains` is 9x9".into(), ..judged(7, "h", Ending::Skipped, "pile", &[]).0 },
            Vec::new(),
        ),
        judged(8, "i", Ending::Failed, "pile", &[(0, 1.0)]),
    ]);
    let expected = [
        "converged",
        // 0.49 at 1000 is 2 % below 0.5 at 512, but both are in the second half: against 1.0 it falls.
        "slow",
        "stalled",
        "diverged",
        "false convergence",
        "false convergence",
        "infeasible",
        "failed",
        "skipped",
        "failed",
    ];
    assert_eq!(classes(&files), expected);
    assert!(text(&files, "atlas.csv").contains("`subdomains` is 9x9"));
}

#[test]
fn failure_with_another_setting_that_converges_has_a_ring_in_the_matrix() {
    let ring = "converges with another setting";
    let first = judged(0, "1.0", Ending::Diverged, "pile", &[(0, 1.0), (9, 1e30)]);
    let alone = made(vec![first.clone()]);
    assert!(!text(&alone, "atlas.svg").contains(ring));
    let mended = made(vec![first, judged(1, "0.5", Ending::Converged, "pile", &[(0, 1.0), (50, 1e-4)])]);
    assert!(text(&mended, "atlas.svg").contains(ring));
    let settings = text(&mended, "atlas-jacobi.svg");
    assert!(
        settings.contains("\n0.5\n") && !settings.contains("2 0.5"),
        "words above the columns, not numbers"
    );
}

#[test]
fn zeta_that_met_the_tolerance_far_from_the_solution_is_told() {
    let (run, mut curve) =
        judged(0, "", Ending::IterationLimit, "pile", &[(0, 1.0), (512, 0.4), (1000, 0.3)]);
    curve[1].measures.zeta = 1e-5;
    assert!(text(&made(vec![(run.clone(), curve.clone())]), "atlas.csv").contains(",true,"));
    curve[1].measures.zeta = 1e-3;
    assert!(text(&made(vec![(run, curve)]), "atlas.csv").contains(",false,"));
}

#[test]
fn study_without_runs_has_tables_and_no_figure() {
    let files = made(Vec::new());
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let tables =
        ["atlas-counts.csv", "atlas-counts.md", "atlas-counts.tex", "atlas.csv", "atlas.md", "atlas.tex"];
    assert_eq!(names, tables);
}

#[test]
fn undefined_and_infinite_measures_are_drawn_as_classes() {
    for value in [f64::NAN, f64::INFINITY] {
        let files = made(vec![judged(0, "", Ending::IterationLimit, "pile", &[(0, value), (1000, value)])]);
        assert_eq!(classes(&files), ["stalled"]);
    }
}

#[test]
fn hazards_are_the_problems_of_a_case_with_what_differs_among_them() {
    let on = |id, problem: &str, settings| Run {
        problem_settings: object(&settings),
        ..judged(id, "", Ending::Converged, problem, &[(0, 1e-5)]).0
    };
    let box_of = |grains: u32| json!({ "case": "box", "sample.grains": grains, "scene.law": "iqs" });
    let rows = [
        on(0, "box grains=5", box_of(5)),
        on(1, "frozen", json!({})),
        on(2, "box grains=9", box_of(9)),
        on(3, "box", json!({ "case": "box" })),
    ];
    let hazards = super::hazards(&study(&rows, &[]).runs);
    let told: Vec<_> =
        hazards.iter().map(|h| (h.name.as_str(), h.setting.as_str(), h.problems.len())).collect();
    assert_eq!(told, [("box", "grains 5, 9", 2), ("frozen", "", 1), ("box", "", 1)]);
}
