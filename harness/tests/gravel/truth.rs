//! References: kept, certified again, and what is printed beside them.

use crate::bench::{Study, plan, rows};
use crate::common::{checkout, entries, impulses, text, write};
use crate::external::ROUGH;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;

#[test]
fn certify_prints_every_condition_of_the_reference_and_keeps_it() {
    let study = Study::new();
    let printed = study.gravel(&["certify", "pair"]).succeeded().stdout;
    for word in
        ["reference: certified to 1e-12", "approach", "pull", "complementarity", "momentum", "duality_gap"]
    {
        assert!(printed.contains(word), "no `{word}` in: {printed}");
    }
    let kept = entries(&study.folder().path().join("results/references"));
    assert_eq!(kept.len(), 1, "{kept:?}");
    assert_eq!(study.gravel(&["certify", "pair"]).succeeded().stdout, printed, "read back");
}

#[test]
fn corrupted_references_are_computed_again_with_a_word() {
    let study = Study::new();
    study.gravel(&["certify", "pair"]).succeeded();
    let folder = study.folder().path().join("results/references");
    let file = folder.join(&entries(&folder)[0]);
    let good = fs::read_to_string(&file).unwrap();
    let kept: Value = serde_json::from_str(&good).unwrap();
    let r: Vec<f64> = serde_json::from_value(kept["impulses"].clone()).unwrap();
    let bad = [
        json!({ "impulses": [r[0] * (1.0 + 1e-6), r[1]] }).to_string(),
        json!({ "impulses": [r[0]] }).to_string(),
        json!({ "ray": [1.0, 1.0] }).to_string(),
        json!({ "else": r }).to_string(),
        good[..good.len() / 2].to_owned(),
        String::new(),
    ];
    for bad in bad {
        fs::write(&file, &bad).unwrap();
        let ran = study.gravel(&["certify", "pair"]).succeeded();
        assert!(ran.stderr.contains("computed again"), "{bad}: {}", ran.stderr);
        assert!(ran.stdout.contains("reference: certified"), "{bad}: {}", ran.stdout);
        assert_eq!(fs::read_to_string(&file).unwrap(), good, "{bad}");
    }
}

#[test]
fn references_from_before_there_were_checksums_are_certified_and_get_one() {
    for problem in ["pair", "rough"] {
        let study = Study::new();
        write(study.folder(), "cases/frozen/rough.json", ROUGH);
        study.gravel(&["certify", problem]).succeeded();
        let folder = study.folder().path().join("results/references");
        let file = folder.join(&entries(&folder)[0]);
        let kept = fs::read(&file).unwrap();
        fs::write(&file, seal::opened(&kept).unwrap().unwrap()).unwrap();
        let said = study.gravel(&["certify", problem]).succeeded().stderr;
        assert!(said.contains("it had no checksum; ") && said.contains("has one now"), "{said}");
        assert_eq!(fs::read(&file).unwrap(), kept);
        assert_eq!(study.gravel(&["certify", problem]).succeeded().stderr, "");
    }
}

/// Bits here and there of what is kept: the answer is that of before, and what was damaged is made again with a word.
#[test]
fn no_flipped_bit_of_what_is_kept_changes_an_answer() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/rough.json", ROUGH);
    for problem in ["pair", "rough"] {
        let certify = || study.gravel(&["certify", problem]).succeeded();
        let folder = study.folder().path().join("results/references");
        let _ = fs::remove_dir_all(&folder);
        let answer = certify().stdout;
        let file = folder.join(&entries(&folder)[0]);
        let kept = fs::read(&file).unwrap();
        for bit in (3..8 * (kept.len() - 1)).step_by(8 * kept.len() / 12) {
            let mut flipped = kept.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(&file, flipped).unwrap();
            let ran = certify();
            assert!(ran.stderr.contains("computed again"), "{problem}, bit {bit}: {}", ran.stderr);
            assert_eq!(
                (ran.stdout, fs::read(&file).unwrap()),
                (answer.clone(), kept.clone()),
                "{problem}, bit {bit}"
            );
        }
    }
}

#[test]
fn certify_reports_how_far_given_impulses_are_from_the_reference() {
    let study = Study::new();
    let frozen = |ending: &str| checkout().join("cases/frozen/lmgc90-shear-991-t1").with_extension(ending);
    let (problem, solution) = (frozen("json"), frozen("solution.json"));
    let ran = study.gravel(&["certify", text(&problem), "--impulses", text(&solution)]).ended(3);
    // What LMGC90 left: 2.4e-7 m/s.
    for word in ["given impulses: not certified", "2.4e-7 m/s", "reference: certified"] {
        assert!(ran.stdout.contains(word), "no `{word}` in: {}", ran.stdout);
    }
    let error = ran.stdout.lines().find_map(|line| line.trim().strip_prefix("velocity_error")).unwrap();
    assert!((1e-9..1e-2).contains(&error.trim().parse::<f64>().unwrap()), "{error}");
}

#[test]
fn impulses_of_another_problem_are_refused() {
    let study = Study::new();
    for (content, words) in [
        (json!({ "impulse": [1.0] }), &["`impulse` has 1 values", "2 contacts"][..]),
        (
            json!({ "impulses": [1.0, 1.0] }),
            &["missing key `impulse`: `impulses` is no key; did you mean `impulse`?"],
        ),
        (json!({ "impulse": [1.0, "x"] }), &["given.json", "expected a number"]),
    ] {
        let file = write(study.folder(), "given.json", &content.to_string());
        study.gravel(&["certify", "pair", "--impulses", text(&file)]).refused(words);
    }
    study.gravel(&["certify", "nothing"]).refused(&["no frozen problem `nothing`"]);
}

#[test]
fn solve_reports_the_error_where_it_is_asked_to() {
    let study = Study::new();
    let solve = |more: &[&str]| study.gravel(&[&["solve", "pair", "--json"], more].concat()).json();
    assert!(solve(&[])["velocity_error"].is_null());
    assert!(solve(&["--truth"])["velocity_error"].as_f64().is_some_and(|error| error < 1e-6));
    let stopped = solve(&["--method", "nsgs", "--on", "velocity_error", "--tolerance", "1e-3"]);
    assert_eq!(stopped["status"], "converged");
    assert!(stopped["velocity_error"].as_f64().is_some_and(|error| error <= 1e-3));
    assert!(stopped["energy_gap"].as_f64().is_some_and(|gap| (0.0..1e-3).contains(&gap)));
    // The time steps before a frozen problem are solved beside no reference.
    let output = study.folder().path().join("later.json");
    let freeze = ["freeze", "column", "--time-step", "2", "-o", text(&output), "--on", "velocity_error"];
    study.gravel(&freeze).refused(&["`on` is velocity_error", "not known"]);
}

#[test]
fn impulses_of_the_interior_point_have_a_certificate() {
    let study = Study::new();
    let problem = checkout().join("cases/frozen/shear-box-991-sheared.json");
    let exact = ["--method", "interior-point", "--tolerance", "1e-13"];
    let r = impulses(&[&[text(&problem)][..], &exact].concat());
    let file = write(study.folder(), "r.json", &json!({ "impulse": r }).to_string());
    let printed = study.gravel(&["certify", text(&problem), "--impulses", text(&file)]).succeeded().stdout;
    assert!(printed.contains("given impulses: certified"), "{printed}");
}

/// A disc between two walls that close at 1 m/s.
pub(crate) fn closing_walls() -> Value {
    json!({
        "format": "gravel/contact-problem/1",
        "name": "closing",
        "source": "made for a test",
        "time_step": 0.005,
        "grains": {
            "mass": [1.0], "radius": [0.5], "position": [[0.0, 0.5]], "free_velocity": [[0.0, 0.0]]
        },
        "contacts": {
            "candidate": [0, 0],
            "antagonist": [null, null],
            "normal": [[1.0, 0.0], [-1.0, 0.0]],
            "offset": [-1.0, -1.0],
            "gap": [0.0, 0.0]
        }
    })
}

/// Walls that close a ten-millionth as fast as a disc beside them falls.
#[test]
fn converged_is_no_claim_that_a_solution_exists() {
    let mut problem = closing_walls();
    problem["grains"] = json!({
        "mass": [1.0, 1.0], "radius": [0.5, 0.5], "position": [[0.0, 0.5], [3.0, 0.5]],
        "free_velocity": [[0.0, 0.0], [0.0, -1.0]]
    });
    problem["contacts"] = json!({
        "candidate": [0, 0, 1],
        "antagonist": [null, null, null],
        "normal": [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]],
        "offset": [-1e-7, -1e-7, 0.0],
        "gap": [0.0, 0.0, 0.0]
    });
    let study = Study::new();
    write(study.folder(), "cases/frozen/closing.json", &problem.to_string());
    let solve = |more: &[&str]| {
        study.gravel(&[&["solve", "closing", "--method", "nsgs", "--json"], more].concat()).json()["status"]
            .clone()
    };
    assert_eq!(solve(&[]), "converged");
    study.gravel(&["certify", "closing"]).ended(4);
    assert_eq!(solve(&["--truth"]), "false-convergence");
    let help = study.gravel(&["certify", "--help"]).succeeded().stdout;
    assert!(help.contains("no claim that a solution exists"), "{help}");
}

#[test]
fn solve_says_that_a_measure_was_met_where_there_is_no_solution() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/closing.json", &closing_walls().to_string());
    let solve = ["solve", "closing", "--method", "nsgs", "--tolerance", "1e-2", "--on"];
    for on in ["zeta", "quad_dv", "max_dv"] {
        let ran = study.gravel(&[&solve[..], &[on]].concat());
        assert!(ran.stdout.contains("\nfalse-convergence after"), "{on}: {}", ran.stdout);
        assert_eq!(
            study.gravel(&[&solve[..], &[on, "--json"]].concat()).json()["status"],
            "false-convergence"
        );
    }
    // A tolerance above the rate of the walls is met at once, and only the proof of the reference says otherwise.
    let rate = ["solve", "closing", "--json", "--on", "penetration_rate", "--tolerance", "1.5"];
    assert_eq!(study.gravel(&[&rate[..], &["--truth"]].concat()).json()["status"], "false-convergence");
}

#[test]
fn studies_report_the_error_and_the_convergence_that_is_none() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/closing.json", &closing_walls().to_string());
    let methods = "[[methods]]\nmethod = \"nsgs\"\n";
    let text = plan("test", &["pair", "closing"], methods);
    let ends = |text: &str| {
        write(study.folder(), "harness/plans/test.toml", text);
        let runs = rows(study.bench("test").join("runs.csv"));
        runs.iter().map(|run| (run["status"].clone(), run["velocity_error"].clone())).collect::<Vec<_>>()
    };
    let on_the_natural_map = ends(&text);
    assert_eq!(on_the_natural_map[0].0, "converged");
    assert!(on_the_natural_map[0].1.parse::<f64>().unwrap() < 1e-2, "{on_the_natural_map:?}");
    assert_eq!(on_the_natural_map[1], ("infeasible".to_owned(), String::new()));
    for (on, tolerance) in
        [("zeta", "1e-2"), ("quad_dv", "1e-2"), ("max_dv", "1e-2"), ("penetration_rate", "1.5")]
    {
        let ended = ends(&text.replace("natural_map", on).replace("1e-3", tolerance));
        assert_eq!(ended[1], ("false-convergence".to_owned(), String::new()), "{on}");
    }
    let on_the_error = ends(&text.replace("natural_map", "velocity_error"));
    assert_eq!(on_the_error[0].0, "converged");
    assert!(on_the_error[0].1.parse::<f64>().unwrap() <= 1e-3, "{on_the_error:?}");
    assert_eq!(on_the_error[1].0, "skipped");
    let printed = study.gravel(&["certify", "closing"]).ended(4).stdout;
    assert!(printed.contains("no solution"), "{printed}");
}

/// A disc that falls on a floor with friction, and slides too fast to stick.
fn sliding() -> Value {
    json!({
        "format": "gravel/contact-problem/2",
        "name": "sliding",
        "source": "a test",
        "time_step": 0.01,
        "grains": {
            "mass": [1.0], "inertia": [0.5], "radius": [1.0], "position": [[0.0, 1.0]], "free_velocity": [[3.0, -1.0, 0.0]],
        },
        "contacts": {
            "candidate": [0], "antagonist": [null], "normal": [[0.0, 1.0]], "offset": [[0.0, 0.0]], "gap": [0.0],
            "friction": [0.3],
        },
    })
}

/// A disc between two walls that close along a line at an angle, with friction.
fn closing_with_friction() -> Value {
    json!({
        "format": "gravel/contact-problem/2",
        "name": "squeezed",
        "source": "a test",
        "time_step": 0.005,
        "grains": {
            "mass": [1.0], "inertia": [0.125], "radius": [0.5], "position": [[0.0, 0.0]], "free_velocity": [[0.0, 0.0, 0.0]],
        },
        "contacts": {
            "candidate": [0, 0], "antagonist": [null, null],
            "normal": [[-0.373_388_827_803_571_5, 0.927_674_934_053_666_7], [0.373_388_827_803_571_5, -0.927_674_934_053_666_7]],
            "offset": [[-0.5, 0.0], [-0.9, 0.0]], "gap": [0.0, 0.0], "friction": [0.3, 0.3],
        },
    })
}

#[test]
fn normal_parts_prove_that_a_problem_with_friction_has_no_solution_whatever_was_kept() {
    let study = Study::new();
    let file = write(study.folder(), "cases/frozen/squeezed.json", &closing_with_friction().to_string());
    let printed = study.gravel(&["certify", "squeezed", "--starts", "0"]).ended(4).stdout;
    assert!(printed.contains("the problem has no solution") && !printed.contains(" certified"), "{printed}");
    let huge = json!({ "impulse": [[1e25, 0.0], [1e25, 0.0]] }).to_string();
    let given = write(study.folder(), "huge.json", &huge);
    let printed = study.gravel(&["certify", text(&file), "--impulses", text(&given)]).ended(4).stdout;
    assert!(printed.contains("given impulses: not certified"), "{printed}");
    // A tolerance above the rate of the walls is met at once.
    let rate =
        ["solve", "squeezed", "--json", "--on", "penetration_rate", "--tolerance", "1.5", "--method", "nsgs"];
    assert_eq!(study.gravel(&[&rate[..], &["--truth"]].concat()).json()["status"], "false-convergence");
}

#[test]
fn kept_solutions_with_friction_are_certified_again() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/sliding.json", &sliding().to_string());
    study.gravel(&["certify", "sliding", "--starts", "0"]).ended(0);
    let folder = study.folder().path().join("results/references");
    let file = folder.join(&entries(&folder)[0]);
    let good: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    // Impulses far too large, beside the right ones, and alone.
    for solutions in [json!([[9.0, 0.0], good["solutions"][0]]), json!([[9.0, 0.0]])] {
        let starts = if solutions[1].is_null() { json!(0) } else { good["starts"].clone() };
        let kept = json!({ "starts": starts, "code": good["code"], "solutions": solutions });
        fs::write(&file, kept.to_string()).unwrap();
        let printed = study.gravel(&["certify", "sliding", "--starts", "0"]).ended(0).stdout;
        assert!(printed.contains("solution 1: certified") && !printed.contains("solution 2"), "{printed}");
    }
}

#[test]
fn certify_tells_of_friction_whether_solutions_exist_and_stand_alone() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/sliding.json", &sliding().to_string());
    let printed = study.gravel(&["certify", "sliding"]).succeeded().stdout;
    for word in [
        "a solution exists: no wall drives",
        "solution 1: certified to 1e-12",
        "isolated: a status changes at",
    ] {
        assert!(printed.contains(word), "no `{word}` in: {printed}");
    }
    assert!(!printed.contains("solution 2") && !printed.contains("not known"), "{printed}");
}

/// The same as a sphere, in space.
#[test]
fn certify_finds_the_solution_between_spheres_with_friction() {
    let study = Study::new();
    let mut problem = sliding();
    problem["mechanics"] = "rough-spheres".into();
    problem["grains"]["position"] = json!([[0.0, 1.0, 0.0]]);
    problem["grains"]["free_velocity"] = json!([[3.0, -1.0, 0.5, 0.0, 0.0, 0.0]]);
    problem["contacts"]["normal"] = json!([[0.0, 1.0, 0.0]]);
    problem["contacts"]["offset"] = json!([[0.0, 0.0, 0.0]]);
    write(study.folder(), "cases/frozen/sliding.json", &problem.to_string());
    let printed = study.gravel(&["certify", "sliding"]).succeeded().stdout;
    for word in ["isolated: a status changes at", "the solution is within", "solution 1: certified to 1e-12"]
    {
        assert!(printed.contains(word), "no `{word}` in: {printed}");
    }
}

#[test]
fn rows_tell_of_friction_how_many_solutions_are_known_and_to_which_a_run_is_polished() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/sliding.json", &sliding().to_string());
    let methods = "[[methods]]\nmethod = \"jacobi\"\nset = { relaxation = 0.5 }\n";
    study.plan("truth", &["sliding", "pair"], methods);
    let rows = rows(study.bench("truth").join("runs.csv"));
    let of = |problem: &str| rows.iter().find(|row| row["problem"] == problem).unwrap();
    let (sliding, pair) = (of("sliding"), of("pair"));
    assert_eq!([&*sliding["solutions"], &*sliding["polished_to"], &*pair["polished_to"]], ["1", "known", ""]);
    assert_eq!(
        [&sliding["spread"], &pair["spread"]].map(|spread| spread.parse::<f64>().unwrap()),
        [0.0, 0.0]
    );
    let by: f64 = sliding["polished_by"].parse().unwrap();
    assert!(by > 1e-8 && by < 1e-2, "as far as the run was from it: {by:e}");
}

#[test]
fn a_solution_that_a_run_ends_at_is_known_to_later_studies() {
    let study = Study::new();
    let read = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(checkout().join("cases/frozen").join(name)).unwrap())
            .unwrap()
    };
    // Another code's solution as the impulses of the time step before.
    let mut problem = read("rough-991-mu08.json");
    problem["name"] = "packing".into();
    problem["contacts"]["start"] = read("rough-991-mu08.solution.json")["impulse"].take();
    write(study.folder(), "cases/frozen/packing.json", &problem.to_string());
    study.plan("ends", &["packing"], "[[methods]]\nmethod = \"nsgs\"\nwarm_start = [true]\n");
    let row = |study: &Study, plan: &str| rows(study.bench(plan).join("runs.csv")).remove(0);
    let before = row(&study, "ends");
    assert_eq!(before["polished_to"], "new", "{before:?}");
    // In another study, since rows stay as they were made.
    study.plan("later", &["packing"], "[[methods]]\nmethod = \"nsgs\"\nwarm_start = [true]\n");
    let after = row(&study, "later");
    assert_eq!(after["polished_to"], "known", "{after:?}");
    let solutions = |row: &BTreeMap<String, String>| row["solutions"].parse::<u32>().unwrap();
    assert_eq!(solutions(&after), solutions(&before) + 1);
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    assert!(
        number(&before, "velocity_error") > 1e-2 && number(&after, "velocity_error") < 1e-10,
        "{after:?}"
    );
    assert!(number(&after, "spread") >= number(&before, "spread"));
    // Later studies know the same file: nobody has to seek again.
    let printed = study.gravel(&["certify", "packing"]).succeeded().stdout;
    assert!(printed.contains(&format!("spread of the {} solutions", solutions(&after))), "{printed}");
}
