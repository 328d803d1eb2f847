//! Plans with cases, axes and quick forms: what `gravel bench` and `gravel plan` make of them.

use crate::bench::{Study, plan, rows};
use crate::common::{checkout, entries, gravel, names, text, write};
use std::fs;
use tempfile::TempDir;

/// Example plan of the harness's page.
fn example() -> String {
    let page = fs::read_to_string(checkout().join("harness/README.md")).unwrap();
    let (_, example) = page.split_once("```toml\n").unwrap();
    example.split_once("```").unwrap().0.to_owned()
}

const CG: &str = "[[methods]]\nmethod = \"cg\"\n";

/// Columns of three heights under two gravities: six problems.
const CASES: &str = "[[cases]]\ncase = \"column\"\n\
     scene = { \"scene.law\" = \"iqs\" }\n\
     zip = { \"sample.grains\" = [2, 3, 4], \"scene.time_step_s\" = [0.002, 0.005, 0.005] }\n\
     axes = { \"scene.gravity_m_per_s2\" = [9.81, 1.62] }\n";

fn study_of_columns() -> Study {
    let study = Study::new();
    let columns = plan("columns", &["pair"], &format!("{CASES}\n{CG}"));
    write(study.folder(), "harness/plans/columns.toml", &columns);
    study
}

const NAMES: [&str; 7] = [
    "pair",
    "column grains=2 gravity_m_per_s2=9.81",
    "column grains=2 gravity_m_per_s2=1.62",
    "column grains=3 gravity_m_per_s2=9.81",
    "column grains=3 gravity_m_per_s2=1.62",
    "column grains=4 gravity_m_per_s2=9.81",
    "column grains=4 gravity_m_per_s2=1.62",
];

#[test]
fn every_combination_of_the_axes_of_a_case_is_a_problem_with_its_settings() {
    let study = study_of_columns();
    let rows = rows(study.bench("columns").join("runs.csv"));
    let names: Vec<&str> = rows.iter().map(|row| &*row["problem"]).collect();
    assert_eq!(names, NAMES);
    let grains: Vec<&str> = rows.iter().map(|row| &*row["grains"]).collect();
    assert_eq!(grains, ["2", "2", "2", "3", "3", "4", "4"]);
    assert_eq!(rows[0]["problem_settings"], "{}");
    let settings: serde_json::Value = serde_json::from_str(&rows[1]["problem_settings"]).unwrap();
    let expected = serde_json::json!({
        "case": "column", "time_step": 1, "scene.law": "iqs", "sample.grains": 2, "scene.time_step_s": 0.002,
        "scene.gravity_m_per_s2": 9.81
    });
    assert_eq!(settings, expected);
}

/// A plan on the fourth time step of a column, all before it solved as `march` says.
fn study_of_a_march(march: &str) -> Study {
    let study = Study::new();
    let case = format!("[[cases]]\ncase = \"column\"\ntime_step = 4\n{march}\n");
    write(study.folder(), "harness/plans/marched.toml", &plan("marched", &[], &format!("{case}\n{CG}")));
    study
}

#[test]
fn case_names_its_marcher_and_rows_count_the_time_steps_that_missed() {
    let settings = |march: &str| {
        let study = study_of_a_march(march);
        let row = rows(study.bench("marched").join("runs.csv")).remove(0);
        // The problem is made again from the row, by the same marcher.
        fs::remove_dir_all(study.folder().path().join("results/problems")).unwrap();
        study.gravel(&["view", &row["id"]]).succeeded();
        serde_json::from_str::<serde_json::Value>(&row["problem_settings"]).unwrap()
    };
    let own = settings("");
    assert_eq!((&own["missed_before"], &own["march"]), (&0.into(), &serde_json::Value::Null));
    let short = "march = { method = \"nsgs\", set = { relaxation = 0.5 }, stop = { max_iterations = 1 } }";
    let missed = settings(short);
    assert_eq!(missed["missed_before"], 3);
    assert_eq!(missed["march"]["method"], "nsgs");
    assert_eq!(missed["march"]["set"]["relaxation"], 0.5);
    for (march, words) in [
        ("march = { method = \"nsgss\" }", ["`march`", "nsgss", "nsgs"]),
        ("march = { method = \"nsgs\", set = { omega = 1 } }", ["`march`", "omega", "column"]),
        ("march = { method = \"nsgs\", stop = { tolerance = -1 } }", ["`march.stop`", "tolerance", "-1"]),
    ] {
        study_of_a_march(march).gravel(&["bench", "marched"]).refused(&words);
    }
}

#[test]
fn computed_problem_is_kept_and_one_that_does_not_read_is_computed_again() {
    let study = study_of_columns();
    let made = |ran: &str| ran.lines().filter(|line| line.starts_with("computing column ")).count();
    let bench = || study.gravel(&["bench", "columns"]).succeeded();
    assert_eq!(made(&bench().stdout), 6);
    let folder = study.folder().path().join("results/problems");
    let kept = entries(&folder);
    assert_eq!(kept.len(), 6);
    assert_eq!(made(&bench().stdout), 0);
    let file = folder.join(&kept[0]);
    let before = fs::read_to_string(&file).unwrap();
    fs::write(&file, &before[..before.len() / 2]).unwrap();
    let ran = bench();
    assert_eq!(made(&ran.stdout), 1);
    assert!(ran.stderr.contains(&kept[0]) && ran.stderr.contains("computed again"), "{}", ran.stderr);
    assert_eq!(fs::read_to_string(&file).unwrap(), before);
    // One digit of a number, and a file from before there were checksums.
    let digit = before.find("\"mass\":[").unwrap() + 14;
    let other = if before.as_bytes()[digit] == b'7' { "8" } else { "7" };
    let changed = format!("{}{other}{}", &before[..digit], &before[digit + 1..]);
    let unsealed = String::from_utf8(seal::opened(before.as_bytes()).unwrap().unwrap()).unwrap();
    for (text, why) in [(changed, "damaged: its checksum is"), (unsealed, "it has no checksum")] {
        fs::write(&file, text).unwrap();
        let ran = bench();
        assert!(ran.stderr.contains(why) && ran.stderr.contains("computed again"), "{}", ran.stderr);
        assert_eq!(fs::read_to_string(&file).unwrap(), before);
    }
    // Another case, another problem.
    let case = study.folder().path().join("cases/column.toml");
    fs::write(&case, fs::read_to_string(&case).unwrap().replace("9.81", "9.8")).unwrap();
    assert_eq!(made(&bench().stdout), 6);
}

/// Time steps of a case that a plan varies are problems of their own, and a stored run of one leads back to it.
#[test]
fn time_step_may_be_an_axis() {
    let study = Study::new();
    let case = study.folder().path().join("cases/column.toml");
    let moments = "[moments]\nlate = 3\n\n[sample]";
    fs::write(&case, fs::read_to_string(&case).unwrap().replacen("[sample]", moments, 1)).unwrap();
    let axes = format!("[[cases]]\ncase = \"column\"\naxes = {{ time_step = [1, \"late\"] }}\n\n{CG}");
    write(study.folder(), "harness/plans/steps.toml", &plan("steps", &[], &axes));
    study.bench("steps");
    let rows = rows(study.runs("steps").join("runs.csv"));
    let steps = rows.iter().map(|row| (row["problem"].as_str(), row["problem_settings"].as_str()));
    let steps: Vec<(&str, &str)> = steps.collect();
    assert_eq!(steps[0].0, "column time_step=1");
    assert_eq!(steps[1].0, "column time_step=late");
    assert!(!steps[0].1.contains("moment") && steps[1].1.contains(r#""moment":"late""#), "{steps:?}");
    assert!(steps[1].1.contains(r#""time_step":3"#), "{steps:?}");
    study.gravel(&["view", &rows[1]["id"], "-o", text(&study.folder().path().join("late.html"))]).succeeded();
}

#[test]
fn time_step_of_a_case_is_a_number_or_a_moment() {
    let study = Study::new();
    let case = study.folder().path().join("cases/column.toml");
    let moments = "[moments]\nlate = 3\n\n[sample]";
    fs::write(&case, fs::read_to_string(&case).unwrap().replacen("[sample]", moments, 1)).unwrap();
    let bench = |moment: &str| {
        let case = format!("[[cases]]\ncase = \"column\"\ntime_step = {moment}\n\n{CG}");
        write(study.folder(), "harness/plans/moment.toml", &plan("moment", &[], &case));
        study.gravel(&["bench", "moment"])
    };
    assert!(bench("\"late\"").succeeded().stdout.contains("computing column: 3 time steps"));
    assert!(bench("2").succeeded().stdout.contains("computing column: 2 time steps"));
    bench("0").refused(&["moment.toml", "case `column`", "`time_step` 0", "from 1"]);
    bench("\"lte\"").refused(&["`time_step` lte", "late", "did you mean `late`?"]);
}

#[test]
fn curves_of_ends_have_fewer_samples_and_the_same_rows() {
    let study = Study::new();
    let nsgs = "[[cases]]\ncase = \"column\"\nscene = { \"sample.grains\" = 40 }\n\n[[methods]]\nmethod = \"nsgs\"\n";
    let whole = plan("whole", &[], nsgs);
    write(study.folder(), "harness/plans/whole.toml", &whole);
    write(
        study.folder(),
        "harness/plans/ends.toml",
        &format!("curves = \"ends\"\n{}", whole.replace("whole", "ends")),
    );
    let (whole, ends) = (study.bench("whole"), study.bench("ends"));
    let curve = |folder: &std::path::Path| -> Vec<u64> {
        rows(folder.join("curves.csv")).iter().map(|row| row["iteration"].parse().unwrap()).collect()
    };
    let (whole_curve, ends_curve) = (curve(&whole), curve(&ends));
    assert!(ends_curve.len() * 10 < whole_curve.len(), "{} of {}", ends_curve.len(), whole_curve.len());
    assert_eq!(ends_curve.first(), Some(&0));
    assert_eq!(ends_curve.last(), whole_curve.last());
    let counts = |folder: &std::path::Path| {
        let mut rows = rows(folder.join("runs.csv"));
        for row in &mut rows {
            row.retain(|column, _| column.contains("iterations") || column.contains("natural_map"));
        }
        rows
    };
    assert_eq!(counts(&whole), counts(&ends));
}

#[test]
fn quick_and_changed_studies_have_places_of_their_own() {
    let study = Study::new();
    let nsgs = "[[methods]]\nmethod = \"nsgs\"\naxes = { relaxation = [1.0, 1.5] }\n";
    let text = plan("small", &["pair"], &format!("{nsgs}\n{CG}\n[quick]\nstop.max_iterations = 5\n"));
    write(study.folder(), "harness/plans/small.toml", &text);
    let bench = |args: &[&str], place: &str, runs: usize, words: &[&str]| {
        let ran = study.gravel(&[&["bench", "small"], args].concat()).succeeded();
        for word in words {
            assert!(ran.stdout.contains(word), "no `{word}` in: {}", ran.stdout);
        }
        let root = study.folder().path().join("results/runs");
        let folder = results::store::tables_folder(&root, place).unwrap();
        assert_eq!(rows(folder.join("runs.csv")).len(), runs);
    };
    bench(&[], "small", 3, &["plan small: 3 runs, 3 on each problem"]);
    bench(&["--quick"], "small-quick", 3, &["plan small-quick"]);
    bench(&["--set", "relaxation=1.2"], "small-changed", 2, &["changed: relaxation = 1.2"]);
    let changed = ["--quick", "--tolerance", "1e-2", "--on", "zeta", "--max-iterations", "9"];
    let words = ["changed: tolerance = 1e-2, on = zeta, max_iterations = 9"];
    bench(&changed, "small-quick-changed", 3, &words);
}

#[test]
fn request_for_a_study_that_makes_no_sense_is_refused() {
    let study = study_of_columns();
    let refused = |args: &[&str], words: &[&str]| {
        study.gravel(&[&["bench", "columns"], args].concat()).refused(words);
    };
    refused(&["--quick"], &["columns.toml", "no table [quick]"]);
    refused(&["--only", "method=cgg"], &["--only method=cgg", "there are cg", "did you mean `cg`?"]);
    refused(&["--only", "problem=pair", "--only", "problem=col*"], &["problem=col*", "there are pair"]);
    refused(&["--only", "methods=cg"], &["--only methods=cg", "variant", "did you mean `method`?"]);
    refused(&["--only", "cg"], &["--only", "KEY=PATTERN", "'cg'"]);
    refused(&["--set", "relaxation=1"], &["columns.toml", "--set relaxation=1", "no method"]);
    refused(&["--set", "preconditioner=1", "--set", "preconditioner=2"], &["preconditioner", "twice"]);
    refused(&["--tolerance", "-1"], &["`tolerance` is -1"]);
    study.gravel(&["bench", "colums"]).refused(&["no plan `colums`", "did you mean `columns`?"]);
    assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
}

#[test]
fn case_of_a_plan_that_makes_no_sense_is_refused() {
    let study = Study::new();
    let refused = |cases: &str, words: &[&str]| {
        let file =
            write(study.folder(), "harness/plans/bad.toml", &plan("bad", &[], &format!("{cases}\n{CG}")));
        study.gravel(&["bench", text(&file)]).refused(&[&["bad.toml"], words].concat());
        assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
    };
    let column = |keys: &str| format!("[[cases]]\ncase = \"column\"\n{keys}\n");
    refused("[[cases]]\ncase = \"colum\"\n", &["no case `colum`", "did you mean `column`?"]);
    refused(&column("seed = 1"), &["line ", "`seed`", "`scene`"]);
    refused(
        &column("axes = { \"sample.grain\" = [3] }"),
        &["column.toml", "`grain`", "did you mean `grains`?"],
    );
    refused(
        &column("axes = { \"sample.grains\" = \"3..1\" }"),
        &["case `column`", "`sample.grains` is \"3..1\""],
    );
    refused(&column("scene = { \"sample.grains\" = 0 }"), &["`sample` has no grain"]);
    refused(&format!("{0}\n{0}", column("")), &["two problems have the name `column`"]);
}

#[test]
fn part_of_a_study_is_made_first_and_the_rest_later() {
    let study = study_of_columns();
    let bench = |args: &[&str]| study.gravel(&[&["bench", "columns"], args].concat()).succeeded().stdout;
    let problems = || -> Vec<String> {
        let rows = rows(study.runs("columns").join("runs.csv"));
        rows.into_iter().map(|mut row| row.remove("problem").unwrap()).collect()
    };
    let printed = bench(&["--only", "problem=column*9.81", "--only", "method=c*"]);
    assert!(printed.contains("3 of the 7 runs of the plan are selected"), "{printed}");
    assert!(printed.contains("3 of 7 to run"), "{printed}");
    assert!(printed.contains("Not run yet, of those of the plan: 4 runs."), "{printed}");
    assert_eq!(problems(), [NAMES[1], NAMES[3], NAMES[5]]);
    // What is there stays in the tables, whatever is selected next.
    assert!(bench(&["--only", "problem=pair"]).contains("1 of 7 to run"));
    assert_eq!(problems(), [NAMES[0], NAMES[1], NAMES[3], NAMES[5]]);
    let printed = bench(&[]);
    assert!(printed.contains("3 of 7 to run") && !printed.contains("Not run yet"), "{printed}");
    assert_eq!(problems(), NAMES);
}

#[test]
fn runs_begin_cold_or_warm_as_the_plan_says() {
    let study = Study::new();
    let cg = "[[cases]]\ncase = \"column\"\ntime_step = 3\n\n[[methods]]\nmethod = \"cg\"\nwarm_start = [false, true]\n";
    study.plan("starts", &["pair"], cg);
    let rows = rows(study.bench("starts").join("runs.csv"));
    let row = |i: usize| ["problem", "variant", "warm_start", "status"].map(|key| rows[i][key].as_str());
    assert_eq!(row(0), ["pair", "", "false", "converged"]);
    assert_eq!(row(1), ["pair", "warm start", "true", "skipped"]);
    assert!(rows[1]["reason"].contains("no impulses of a time step before"), "{}", rows[1]["reason"]);
    assert_eq!(row(2), ["column", "", "false", "converged"]);
    assert_eq!(row(3), ["column", "warm start", "true", "converged"]);
    // The column rests, and the impulses of the time step before are those of this one.
    let iterations = |i: usize| rows[i]["iterations"].parse::<u64>().unwrap();
    assert!(iterations(3) < iterations(2), "{} and {}", iterations(3), iterations(2));
}

#[test]
fn runs_of_a_plan_are_shown_and_counted_and_none_is_made() {
    let study = study_of_columns();
    let printed = |args: &[&str]| study.gravel(&[&["plan", "columns"], args].concat()).succeeded().stdout;
    let shown = printed(&[]);
    let lines: Vec<&str> = shown.lines().collect();
    assert_eq!(lines[0], "plan columns: A test.");
    for (line, name) in lines[1..].iter().zip(NAMES) {
        assert_eq!(line.split_once(" cg").unwrap().0.trim(), name);
    }
    let count = printed(&["--count", "--only", "problem=column*9.81"]);
    let expected = "plan columns: A test.\n  3 of the 7 runs of the plan are selected\n     done     runs\n";
    assert!(count.starts_with(expected), "{count}");
    assert!(count.ends_with("        0        3  of cg\n        0        3  in all\n"), "{count}");
    assert_eq!(count.lines().count(), 3 + 3 + 2, "{count}");
    assert_eq!(entries(study.folder().path()), ["cases", "harness"]);
}

#[test]
fn runs_that_are_made_are_shown_so_and_the_others_with_the_time_they_may_take() {
    let study = study_of_columns();
    study.gravel(&["bench", "columns", "--only", "problem=column*9.81"]).succeeded();
    let shown = study.gravel(&["plan", "columns"]).succeeded().stdout;
    let done = |line: &&str| line.starts_with("  done  column ") && line.contains("9.81");
    assert_eq!(shown.lines().filter(done).count(), 3, "{shown}");
    assert!(shown.contains("        3        7  in all\n"), "{shown}");
    assert!(shown.ends_with("left on the problems computed so far, one run at a time\n"), "{shown}");
}

#[test]
fn plans_and_cases_of_the_checkout_satisfy_their_schemas_and_a_typo_does_not() {
    let (mut compiler, mut schemas) = (boon::Compiler::new(), boon::Schemas::new());
    for what in ["plan", "case"] {
        compiler.add_resource(what, gravel(&["schema", what]).succeeded().json()).unwrap();
    }
    let [plan, case] = ["plan", "case"].map(|what| compiler.compile(what, &mut schemas).unwrap());
    let value = |text: &str| -> serde_json::Value { toml::from_str(text).unwrap() };
    let read = |path: &str| fs::read_to_string(checkout().join(path)).unwrap();
    for (schema, folder) in [(plan, "harness/plans"), (case, "cases")] {
        for name in names(folder, ".toml").iter().filter(|name| *name != "Cargo") {
            let checked = value(&read(&format!("{folder}/{name}.toml")));
            schemas.validate(&checked, schema).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }
    for (schema, path, from, to) in [
        (plan, "harness/plans/paper.toml", "tolerance", "tolerence"),
        (plan, "harness/plans/paper.toml", "method = \"jacobi\"", "method = \"jakobi\""),
        (plan, "harness/plans/paper.toml", "preconditioner =", "precondition ="),
        (plan, "harness/plans/paper.toml", "\"diagonal\"", "\"diag\""),
        (case, "cases/column.toml", "gravity_m_per_s2", "gravity"),
    ] {
        let text = read(path);
        assert!(text.contains(from), "no `{from}` to replace in {path}");
        assert!(schemas.validate(&value(&text.replace(from, to)), schema).is_err(), "{to}");
    }
}

#[test]
fn example_of_the_page_is_a_plan() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "NAME.toml", &example());
    let count =
        |args: &[&str]| gravel(&[&["plan", text(&file), "--count"], args].concat()).succeeded().stdout;
    // One frozen problem for 3 × 2 variants and 5 more, and 2 × 5 made ones for these 5; the quick form has the frozen one alone.
    assert!(count(&[]).contains("      61  in all"), "{}", count(&[]));
    assert!(count(&["--quick"]).contains("      11  in all"), "{}", count(&["--quick"]));
}

#[test]
fn every_plan_of_the_checkout_is_one_in_both_its_forms() {
    for name in names("harness/plans", ".toml") {
        gravel(&["plan", &name, "--count"]).succeeded();
        if fs::read_to_string(checkout().join(format!("harness/plans/{name}.toml")))
            .unwrap()
            .contains("[quick]")
        {
            gravel(&["plan", &name, "--count", "--quick"]).succeeded();
        }
    }
}
