//! The charts over subdomains, sizes and sets of problems, of small studies.

use results::schema::Ending;
use std::collections::BTreeSet;

use crate::charts::declared::{CRITICAL_PATH, DIMENSIONS, OF_SUBDOMAINS, SIZE, WEAK};
use crate::charts::declared::{OwnChart, own as declared};
use crate::charts::{profiles, relaxation};
use crate::draw::{METHODS, RGBColor};
use crate::tests::assert_well_formed;
use crate::tests::fixture::{
    File, decay, end, explosion, files, object, read, run, sample, study, tables, without_truth,
};
use results::schema::{Run, Sample};
use serde_json::{Value, json};

pub(super) fn text<'f>(files: &'f [File], name: &str) -> &'f str {
    for (name, svg) in files.iter().filter(|(name, _)| name.contains(".svg")) {
        assert_well_formed(name, svg);
    }
    &files.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no {name}")).1
}

pub(super) fn on(id: u32, subdomains: u32, kappa: &str, iterations: u64) -> Run {
    let kappa: Value = serde_json::from_str(kappa).unwrap();
    let settings = object(&json!({ "kappa_d": kappa, "subdomains": format!("{subdomains}x1") }));
    Run { settings, subdomains, iterations, ..run(id, "latin-dd", "", Ending::Converged) }
}

#[test]
fn growth_with_subdomains_is_told_for_each_setting_apart() {
    let runs = [
        on(0, 1, "null", 100),
        on(1, 8, "null", 125),
        on(2, 1, "0.3", 100),
        Run { status: Ending::IterationLimit, ..on(3, 8, "0.3", 1000) },
        Run { status: Ending::Skipped, iterating_s: f64::NAN, ..on(4, 64, "0.3", 0) },
    ];
    let files = files(&OF_SUBDOMAINS.parts(&study(&runs, &[])));
    let rows: Vec<&str> = text(&files, "subdomains.csv").lines().skip(1).collect();
    assert!(rows[1].starts_with("column,latin-dd,8,converged,125,1.25,"), "{}", rows[1]);
    assert!(rows[3].starts_with("column,\"latin-dd, kappa_d=0.3\",8,iteration limit,1000,,"), "{}", rows[3]);
    let svg = text(&files, "subdomains-column.svg");
    assert!(
        svg.contains("iteration limit") && svg.contains("latin-dd, kappa_d=0.3") && !svg.contains("skipped")
    );
}

#[test]
fn speed_up_is_counted_on_the_longest_subdomain_and_measured_in_seconds() {
    let path = |path: u32, run: Run| Run { derived: object(&json!({ "critical_path": path })), ..run };
    let runs = [
        path(800, Run { iterating_s: 3.0, ..on(0, 1, "null", 100) }),
        path(250, Run { iterating_s: 2.0, ..on(1, 4, "null", 128) }),
        path(9, Run { status: Ending::IterationLimit, ..on(2, 16, "null", 1000) }),
        run(3, "cg", "", Ending::Converged),
    ];
    let files = files(&CRITICAL_PATH.parts(&study(&runs, &[])));
    let rows: Vec<&str> = text(&files, "critical-path.csv").lines().skip(1).collect();
    assert!(rows[1].contains(",128,250.0,2.5,1.5,"), "{}", rows[1]);
    assert!(rows[2].contains("iteration limit,1000,9.0,,,"), "{}", rows[2]);
    assert_eq!(rows.len(), 3, "cg has no subdomains");
}

#[test]
fn weak_series_have_as_many_grains_in_each_subdomain() {
    let of = |id, subdomains: u32, grains: u32, iterations| Run {
        problem: format!("{grains} grains"),
        grains,
        derived: object(&json!({ "critical_path": 10 })),
        ..on(id, subdomains, "null", iterations)
    };
    let runs =
        [of(0, 1, 250, 100), of(1, 4, 1000, 150), of(2, 2, 1000, 120), of(3, 3, 900, 1), of(4, 8, 4000, 180)];
    let files = files(&WEAK.parts(&study(&runs, &[])));
    let rows: Vec<&str> = text(&files, "weak.csv").lines().skip(1).collect();
    assert!(rows[0].contains(",250.0,1,250,converged,47,100,1.0,1000.0,"), "{}", rows[0]);
    assert!(rows[1].contains(",250.0,4,1000,converged,47,150,1.5,1500.0,"), "{}", rows[1]);
    assert!(rows[3].contains(",500.0,8,4000,converged,47,180,1.5,1800.0,"), "{}", rows[3]);
    assert_eq!(rows.len(), 4, "no other run has 300 grains each");
}

/// A run on a problem of its size.
fn sized(id: u32, method: &str, grains: u32, iterations: u64) -> Run {
    let problem = format!("{grains} grains");
    Run { problem, grains, iterations, ..run(id, method, "", Ending::Converged) }
}

#[test]
fn best_relaxation_is_that_of_each_problem_and_one_fixed_is_that_of_all() {
    let on = |id, problem: &str, relaxation: f64, iterations| Run {
        problem: format!("box grains=60 seed={problem}"),
        problem_settings: object(&json!({ "sample.seed": problem.parse::<u32>().unwrap() })),
        settings: object(&json!({ "order": "natural", "relaxation": relaxation })),
        iterations,
        ..run(id, "nsgs", "", Ending::Converged)
    };
    let runs = [
        on(0, "1", 1.0, 900),
        on(1, "1", 1.8, 90),
        on(2, "1", 1.9, 40),
        on(3, "2", 1.0, 800),
        on(4, "2", 1.8, 100),
        Run { status: Ending::IterationLimit, ..on(5, "2", 1.9, 1000) },
        Run { status: Ending::Diverged, ..on(6, "2", 1.95, 7) },
        run(7, "cg", "", Ending::Converged),
    ];
    let files = files(&relaxation::parts(&study(&runs, &[])));
    let rows: Vec<&str> = text(&files, "relaxation.csv").lines().skip(1).collect();
    assert_eq!(rows[0], "nsgs,box grains=60 seed=1,0,1.9,40,1.8,90,900");
    assert_eq!(rows[1], "nsgs,box grains=60 seed=2,2,1.8,100,1.8,100,800");
    assert_eq!(rows.len(), 2, "cg has no relaxation");
    // √(90 · 100) and √(900 · 800).
    let found = text(&files, "relaxation-found.csv").lines().nth(1).unwrap();
    assert!(found.starts_with("nsgs,2,1.8,94.86") && found.contains(",0.0,848.5"), "{found}");
    let svg = text(&files, "relaxation.svg");
    assert_eq!(svg.matches("box grains=60").count(), 1, "seeds look the same");
    assert!(svg.contains("iteration limit") && svg.contains("diverged") && !svg.contains("NaN"));
}

#[test]
fn exponents_are_those_of_runs_that_converged_on_three_sizes() {
    let mut runs = vec![
        sized(0, "nsgs", 10, 100),
        sized(1, "nsgs", 1000, 100_000),
        sized(2, "nsgs", 100_000, 100_000_000),
        Run { status: Ending::IterationLimit, ..sized(3, "nsgs", 100_000, 7) },
        // A proof that there is no solution is no failure.
        Run {
            problem: "wedge".into(),
            end: end(sample(9, 1.0, f64::NAN)),
            ..run(4, "cg", "", Ending::Infeasible)
        },
        sized(5, "jacobi", 10, 1001),
        sized(6, "jacobi", 1000, 1000),
        sized(7, "jacobi", 100_000, 1000),
    ];
    let read = |runs: &[Run]| files(&SIZE.parts(&study(runs, &[])));
    let fitted = read(&runs);
    let rows: Vec<&str> = text(&fitted, "size.csv").lines().skip(1).collect();
    assert!(rows[0].starts_with("nsgs,4,1,0.0,1.5,") && rows[1].starts_with("cg,1,0,,"), "{rows:?}");
    let svg = text(&fitted, "size.svg");
    assert!(svg.contains("nsgs (0.00, 1.50, 0.00)") && svg.contains("fitted to 3 sizes or more"), "{svg}");
    assert!(svg.contains("jacobi (") && !svg.contains("−0.00"), "no zero has a sign: {svg}");
    assert!(svg.contains("∝ √n") && svg.contains("∝ n"), "slopes to compare with: {svg}");
    // Through two sizes every power goes.
    runs.truncate(5);
    runs.remove(1);
    let joined = read(&runs);
    assert!(text(&joined, "size.csv").contains("nsgs,3,1,,,"), "{}", text(&joined, "size.csv"));
    assert!(text(&joined, "size.svg").contains("an exponent needs 3"));
}

#[test]
fn size_has_no_panel_twice_nor_an_empty_one_and_is_a_sentence_on_one_size() {
    let names = |files: &[File]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    let panels = |tolerance: f64| {
        let runs = [sized(0, "cg", 10, 100), sized(1, "cg", 1000, 200)].map(|run| Run { tolerance, ..run });
        let files = files(&SIZE.parts(&study(&runs, &[])));
        text(&files, "size.svg").matches("\ngrains\n").count()
    };
    // Without curves there is no counted work, and no panel of it.
    assert_eq!((panels(1e-2), panels(1e-4)), (2, 3));
    let files = files(&SIZE.parts(&study(&[run(0, "cg", "", Ending::Converged)], &[])));
    assert_eq!(names(&files), ["size-found.md", "size.csv", "size.md", "size.tex"]);
    assert!(text(&files, "size-found.md").contains("every problem has 20\u{a0}grains"));
}

#[test]
fn few_problems_have_a_table_of_profiles_that_counts_what_is_reached() {
    let other = |id, method| Run { problem: "other".into(), ..run(id, method, "", Ending::Converged) };
    let runs = [
        run(0, "nsgs", "", Ending::Converged),
        run(1, "cg", "", Ending::Converged),
        other(2, "nsgs"),
        other(3, "cg"),
    ];
    let twice = || (0..=200).map(|i| sample(i, 1.0, 10f64.powf(-4.0 * i as f64 / 200.0))).collect();
    let curves = [(0, decay()), (1, twice()), (2, decay()), (3, explosion())];
    let files = files(&profiles::parts(&study(&runs, &curves)));
    let row = |start: &str| text(&files, "profiles.csv").lines().find(|row| row.starts_with(start)).unwrap();
    assert_eq!(row("0.01,sweeps,nsgs"), "0.01,sweeps,nsgs,2,2,2,1.0,\"\"");
    assert_eq!(row("0.01,sweeps,cg"), "0.01,sweeps,cg,2,1,0,2.0,\"\"");
    assert_eq!(row("1e-6,sweeps,cg"), "1e-6,sweeps,cg,2,0,,,\"\"");
    assert!(files.iter().all(|(name, _)| !name.contains(".svg")), "two problems are no profile");
    let note = text(&files, "profiles.md");
    assert!(note.contains("needs 10 problems; of fewer the table says all."), "{note}");
    assert_eq!(row("0.01,seconds,nsgs"), "0.01,seconds,nsgs,2,2,,1.0,\"\"", "timed once, none is the best");
}

/// Timed five times, with as wide intervals: whose overlap is a tie. Friction, warm starts and skipped runs are told apart.
#[test]
fn profiles_have_ties_and_groups() {
    let of = |id: u32, method: &str, friction: f64, iterating_s: f64| {
        let mut row = Run { iterating_s, ..run(id, method, "", Ending::Converged) };
        row.problem_settings = object(&json!({ "scene.friction": friction }));
        row.problem = format!("box {friction}");
        (row.timing.repeats, row.timing.setup_spread_s, row.timing.iterating_spread_s) =
            (5, 0.0, 0.3 * iterating_s);
        row
    };
    let mut runs = vec![of(0, "nsgs", 0.0, 1.0), of(1, "cg", 0.0, 1.1), of(2, "jacobi", 0.0, 9.0)];
    runs.push(of(3, "nsgs", 0.3, 1.0));
    runs.push(Run { status: Ending::Skipped, ..of(4, "apgd", 0.3, 1.0) });
    let lasting = |seconds: f64| -> Vec<_> {
        decay()
            .into_iter()
            .map(|s| Sample { iterating_s: seconds * s.iteration as f64 / 100.0, ..s })
            .collect()
    };
    let curves: Vec<_> = (0..4).zip([1.0, 1.1, 9.0, 1.0].map(lasting)).collect();
    let files = files(&profiles::parts(&study(&runs, &curves)));
    let csv = text(&files, "profiles.csv");
    let best = |method: &str, words: &str| {
        let row = csv
            .lines()
            .find(|row| row.starts_with(&format!("0.01,seconds,{method},")) && row.ends_with(words));
        row.map(|row| row.split(',').nth(5).unwrap().to_owned())
    };
    let of = |method| best(method, ",without friction");
    assert_eq!([of("nsgs"), of("cg"), of("jacobi")], ["1", "1", "0"].map(|n| Some(n.to_owned())), "{csv}");
    assert_eq!((best("nsgs", ",with friction").as_deref(), best("apgd", "")), (Some("1"), None), "{csv}");
    // Each pair once, on problems that both were run on: nsgs and cg overlap, jacobi is slower than both, and 1e-6 reaches none.
    let pairs = text(&files, "pairs.csv");
    for row in [
        "0.01,cg,nsgs,1,0,1,0,0,without friction",
        "0.01,cg,jacobi,1,1,0,0,0,without friction",
        "0.01,jacobi,nsgs,1,0,0,1,0,without friction",
        "1e-6,cg,nsgs,1,0,0,0,1,without friction",
    ] {
        assert!(pairs.lines().any(|line| line == row), "no {row} in {pairs}");
    }
    assert!(!pairs.contains("apgd") && !pairs.contains("nsgs,cg"), "{pairs}");
}

#[test]
fn profile_names_its_axis_what_is_not_reached_and_who_has_no_line() {
    let runs: Vec<Run> = (0..20)
        .map(|i| {
            let method = ["nsgs", "jacobi"][i as usize % 2];
            Run { problem: format!("problem {}", i / 2), ..run(i, method, "", Ending::Converged) }
        })
        .collect();
    let curves: Vec<_> = (0..20).step_by(2).map(|i| (i, decay())).collect();
    let files = files(&profiles::parts(&study(&runs, &curves)));
    for words in ["share solved to 10⁻⁴ (–)", "10⁻² by 10 of 20, 10⁻⁴ by 10 of 20, 10⁻⁶ by 20 of 20"]
    {
        assert!(text(&files, "profiles-sweeps.svg").contains(words), "{words}");
    }
    let svg = text(&files, "profiles-sweeps.svg");
    assert!(svg.contains("jacobi: no value") && svg.matches("jacobi").count() == 1, "{svg}");
}

/// Colours in a figure, of lines and of fills.
fn colors(svg: &str) -> BTreeSet<&str> {
    let of = |key: &'static str| svg.split(key).skip(1).filter_map(|rest| rest.split('"').next());
    of("stroke=\"").chain(of("fill=\"")).collect()
}

#[test]
fn variants_of_a_method_wear_its_hue_alone() {
    let hex = |RGBColor(r, g, b): RGBColor| format!("#{r:02X}{g:02X}{b:02X}");
    let kappas = ["null", "0.1", "0.3", "1.0", "3.0", "10.0", "30.0", "100.0"];
    let runs: Vec<Run> =
        (0..16).map(|i| on(i, 1 + 7 * (i / 8), kappas[i as usize % 8], u64::from(100 + i))).collect();
    let files = files(&OF_SUBDOMAINS.parts(&study(&runs, &[])));
    let worn = colors(text(&files, "subdomains-column.svg"));
    // Black is of frames and texts as well.
    for (method, family) in METHODS.iter().filter(|(method, _)| *method != "nsgs") {
        let own = family.shades.iter().any(|shade| worn.contains(hex(*shade).as_str()));
        assert_eq!(own, *method == "latin-dd", "{method}: {worn:?}");
    }
}

#[test]
fn failures_stand_beside_each_other_and_methods_without_subdomains_are_levels() {
    let limit = |id, kappa| Run { status: Ending::IterationLimit, ..on(id, 8, kappa, 1000) };
    let mut runs = vec![on(0, 1, "0.1", 100), on(1, 1, "0.3", 110), limit(2, "0.1"), limit(3, "0.3")];
    let drawn = |runs: &[Run]| {
        let files = files(&OF_SUBDOMAINS.parts(&study(runs, &[])));
        text(&files, "subdomains-column.svg").to_owned()
    };
    let alone = drawn(&runs);
    let places = |svg: &str| -> BTreeSet<String> {
        let polygons =
            svg.split("<polygon ").skip(1).map(|polygon| polygon.split("points=\"").nth(1).unwrap());
        // Three corners: the sign of the iteration limit.
        let corners = polygons.map(|points| points.split('"').next().unwrap().trim().to_owned());
        corners.filter(|points| points.split(' ').count() == 3).collect()
    };
    // Two runs in two panels, and the key.
    assert_eq!(places(&alone).len(), 2 * 2 + 1, "{alone}");
    assert!(!alone.contains("Level lines"));
    for (i, omega) in (10..).zip([0.8, 1.0, 1.2, 1.4, 1.6]) {
        let settings = object(&json!({ "relaxation": omega }));
        runs.push(Run { settings, iterations: u64::from(10 * i), ..run(i, "nsgs", "", Ending::Converged) });
    }
    let beside = drawn(&runs);
    assert!(beside.contains("Level lines: methods without the setting that varies."));
    // As dots are drawn, with an edge; one in the key for each, and one in each panel.
    assert_eq!(beside.matches("<circle").count(), 5 * 3, "{beside}");
}

#[test]
fn both_speed_ups_have_the_same_axes_with_the_ideal_and_the_threads() {
    let path = |path: u32, seconds: f64, run: Run| Run {
        derived: object(&json!({ "critical_path": path })),
        iterating_s: seconds,
        ..run
    };
    let runs = [path(3200, 1.0, on(0, 1, "null", 100)), path(100, 1.1, on(1, 16, "null", 100))];
    let files = files(&CRITICAL_PATH.parts(&study(&runs, &[])));
    let svg = text(&files, "critical-path-column.svg");
    assert_eq!(svg.matches("\n10¹\n").count(), 2, "a tick of each panel: {svg}");
    for words in ["1\u{a0}thread (–)", "no communication cost"] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn no_run_only_failures_and_undefined_values_are_no_obstacle() {
    let failed = Run { setup_s: f64::NAN, iterations: 0, ..run(0, "jacobi", "", Ending::Diverged) };
    let skipped = Run { grains: 0, ..run(1, "cg", "", Ending::Skipped) };
    let one = tables(&[failed, skipped], &[(0, explosion())]);
    for study in [tables(&[], &[]), without_truth(one.clone()), one].iter().map(read) {
        let charts = [OF_SUBDOMAINS, SIZE, CRITICAL_PATH, WEAK, DIMENSIONS]
            .map(|lines| lines.parts(&study))
            .into_iter();
        let others = [profiles::parts, relaxation::parts].map(|parts| parts(&study));
        for parts in charts.chain(others) {
            let files = files(&parts);
            text(&files, &files[0].0);
        }
    }
}

#[test]
fn the_plane_stands_beside_space_for_as_many_subdomains_with_and_without_friction() {
    let of = |problem: &str, (dimensions, unknowns): (u32, u32), subdomains: u32, iterations| {
        let spectrum =
            object(&json!({ "dimensions": dimensions, "unknowns": unknowns, "boundary_share": 0.1 }));
        let mut run = Run { problem: problem.into(), spectrum, ..on(0, subdomains, "null", iterations) };
        // 20 grains, and 30 entries of each in the plane, 90 in space.
        run.end.work.triangular_solve_entries = iterations * 2 * 20 * if dimensions == 2 { 30 } else { 90 };
        run
    };
    let runs = [
        of("plane", (2, 1), 1, 100),
        of("space", (3, 1), 1, 80),
        of("plane", (2, 1), 8, 200),
        of("space", (3, 1), 8, 120),
        of("rough", (2, 2), 1, 1000),
    ];
    let files = files(&DIMENSIONS.parts(&study(&runs, &[])));
    let rows: Vec<&str> = text(&files, "dimensions.csv").lines().skip(1).collect();
    assert_eq!(rows[0], "plane,2,20,\"latin-dd, without friction\",1,converged,100,,30.0,0.1,");
    assert!(
        rows[3].starts_with("space,3,20,\"latin-dd, 8 subdomains without friction\",8,converged,120,,90.0,")
    );
    assert_eq!(rows.len(), 4, "nothing in space is as rough");
    assert!(text(&files, "dimensions.svg").contains("8 subdomains without friction"));
}

#[test]
fn chart_of_a_plan_is_drawn_as_it_is_declared() {
    let own = |fit| OwnChart {
        name: "mine".into(),
        x: "grains".into(),
        title: None,
        y: vec!["iterations".into(), "work".into()],
        varied: None,
        fit,
    };
    let runs = [sized(0, "cg", 10, 100), sized(1, "cg", 1000, 200)];
    let study = study(&runs, &[(0, decay()), (1, decay())]);
    let names = |fit| {
        let files = files(&declared(own(fit)).unwrap().parts(&study));
        files
            .into_iter()
            .map(|(name, _)| name)
            .filter(|name| name.rsplit_once('.').is_none_or(|(_, ending)| ending != "tex"))
            .collect::<Vec<_>>()
    };
    assert_eq!(names(true), ["mine.svg", "mine.csv", "mine.md"]);
    assert_eq!(names(false), ["mine-10-grains.svg", "mine-1000-grains.svg", "mine.csv", "mine.md"]);
    let unknown = declared(OwnChart { x: "beauty".into(), ..own(true) }).map(drop);
    assert!(unknown.unwrap_err().to_string().starts_with("no quantity `beauty`: there are subdomains, "));
}
