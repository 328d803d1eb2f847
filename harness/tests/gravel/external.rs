//! Other codes as methods: what becomes of their answers, and of codes that are not there.

use crate::bench::{Study, rows};
use crate::common::{checkout, gravel, other_codes, write};
use serde_json::Value;
use std::collections::BTreeMap;

/// A code that answers with the text that the setting `answer` names, in a script.
const CODE: &str = "what = 'a code'\nmechanics = ['discs']\nfiles = ['code.sh']\nversion = ['echo', 'code 1.2']\n\
    command = ['sh', '{here}/code.sh', '{problem}', '{tolerance}', '{answer}', '{does}']\n\
    install = 'install code'\ntolerances = [1e-1, 1e-9]\ntime_out_s = 20\n\n[settings.does]\nwhat = 'What it does.'\n\
    values = ['solves', 'negative', 'missing', 'short', 'crashes', 'nothing', 'sleeps', 'sticks', 'slips']\n";

/// At 0.1 it answers half of the impulses of the pair, at 1e-9 those.
const SCRIPT: &str = r#"
says() { echo "{\"impulse\": $1, \"iterations\": 3, \"setup_s\": 0.25, \"solve_s\": 0.5, \"ending\": \"solved\"}"; }
case $4 in
    solves) if [ "$2" = 1e-1 ]; then says '[0.075, 0.05]'; else says '[0.15, 0.1]'; fi > "$3" ;;
    negative) says '[0.15, -1e-30]' > "$3" ;;
    missing) says '[null, 0.1]' > "$3" ;;
    short) says '[0.15]' > "$3" ;;
    crashes) echo 'out of luck' >&2; exit 7 ;;
    nothing) ;;
    sleeps) exec sleep 60 ;;
    sticks) says '[0.05, 0.01]' > "$3" ;;
    slips) says '[0.05, 0.02]' > "$3" ;;
esac
"#;

fn study(description: &str) -> Study {
    let study = Study::new();
    std::fs::create_dir_all(study.folder().path().join("harness/external")).unwrap();
    write(study.folder(), "harness/external/code.toml", description);
    write(study.folder(), "harness/external/code.sh", SCRIPT);
    study
}

/// The rows of the pair solved by the code with these settings.
fn ran(description: &str, method: &str) -> Vec<BTreeMap<String, String>> {
    let study = study(description);
    study.plan("other", &["pair"], &format!("[[methods]]\nmethod = \"code\"\n{method}"));
    rows(study.bench("other").join("runs.csv"))
}

#[test]
fn answer_is_measured_and_less_is_asked_until_the_stop_rule_is_met() {
    let row = ran(CODE, "").remove(0);
    let is = |column: &str, value: &str| assert_eq!(row[column], value, "{column}");
    is("status", "converged");
    is("iterations", "3");
    is("setup_s", "0.25");
    is("iterating_s", "0.5");
    is("other_code", "code 1.2");
    assert!(row["natural_map"].parse::<f64>().unwrap() < 1e-12);
    let derived: Value = serde_json::from_str(&row["derived"]).unwrap();
    let rungs = derived["rungs"].as_array().unwrap();
    assert_eq!(rungs.len(), 2);
    // Half of the impulses leaves half of the velocity.
    assert!((rungs[0]["velocity_error"].as_f64().unwrap() - 0.5).abs() < 1e-12, "{derived}");
    assert_eq!([&rungs[0]["tolerance"], &rungs[1]["tolerance"]], [0.1, 1e-9]);
    assert!(rungs.iter().all(|rung| rung["process_s"].as_f64().unwrap() > 0.0));
}

#[test]
fn wrong_description_is_an_error_where_its_code_is_named_and_nowhere_else() {
    let study = study(&CODE.replace("version =", "versoin ="));
    study.gravel(&["solve", "pair", "--method", "nsgs"]).succeeded();
    study.gravel(&["solve", "pair", "--method", "code"]).refused(&[
        "code.toml",
        "unknown field `versoin`",
        "did you mean `version`?",
    ]);
}

#[test]
fn code_that_never_meets_the_stop_rule_has_stalled() {
    let row = ran(CODE, "set = { tolerances = [0.1] }\n").remove(0);
    assert_eq!(row["status"], "stalled");
}

#[test]
fn answer_that_is_none_is_a_row_with_its_reason() {
    let does = "axes = { does = ['negative', 'missing', 'short', 'crashes', 'nothing'] }\n";
    let rows = ran(CODE, does);
    let reasons = [
        "impulse of contact 1 is -1e-30: it must be finite and not negative",
        "impulse of contact 0 is missing",
        "1 impulses where the problem has 2 contacts",
        "out of luck",
        "it wrote no answer",
    ];
    assert_eq!(rows.len(), reasons.len());
    for (row, reason) in rows.iter().zip(reasons) {
        assert_eq!(row["status"], "failed");
        assert!(row["reason"].starts_with("at the tolerance 1e-1: "), "{}", row["reason"]);
        assert!(row["reason"].contains(reason), "{}", row["reason"]);
    }
    let late = ran(CODE, "set = { does = 'sleeps', time_out_s = 0.05 }\n").remove(0);
    assert_eq!(late["reason"], "at the tolerance 1e-1: no answer within 0.05 s");
}

/// A disc of 1 kg comes to a floor at 0.05 m/s, sliding so that a tangential impulse of 0.01 N·s stops it: W is 1 and 3 1/kg.
pub(crate) const ROUGH: &str = r#"{"format": "gravel/contact-problem/2", "name": "rough", "source": "a test", "time_step": 0.005,
    "grains": {"mass": [1], "inertia": [0.5], "radius": [1], "position": [[0, 1]], "free_velocity": [[0.03, -0.05, 0]]},
    "contacts": {"candidate": [0], "antagonist": [null], "normal": [[0, 1]], "offset": [[0, 0]], "gap": [0],
                 "friction": [0.3]}}"#;

#[test]
fn answer_with_friction_is_measured_and_one_outside_of_the_cone_is_none() {
    let study = study(&CODE.replace("['discs']", "['rough-discs']"));
    write(study.folder(), "cases/frozen/rough.json", ROUGH);
    let solve = |does| ["solve", "rough", "--json", "--method", "code", "--set", does];
    let object = study.gravel(&solve("does=sticks")).json();
    assert_eq!(object["status"], "converged");
    assert!(object["natural_map"].as_f64().unwrap() < 1e-12, "{object}");
    study
        .gravel(&solve("does=slips"))
        .refused(&["the impulse of contact 0 is [0.05, 0.02]", "at most μ times"]);
    study.gravel(&solve("does=solves")).refused(&["the impulse of contact 0 is [0.075, 0.05]"]);
    study
        .gravel(&solve("does=short"))
        .refused(&["1 impulses where the problem has 1 contacts of 2 numbers each"]);
}

#[test]
fn code_that_is_not_there_or_cannot_do_it_is_skipped_and_told() {
    let absent = CODE.replace("['echo', 'code 1.2']", "['sh', '-c', 'echo no such code >&2; exit 1']");
    let row = ran(&absent, "").remove(0);
    assert_eq!(row["status"], "skipped");
    assert_eq!(row["reason"], "code is not installed (no such code); `install code` installs it");
    let listed = study(&absent).gravel(&["list", "methods", "--installed"]).succeeded().stdout;
    assert!(
        listed.contains("not installed (no such code)") && listed.contains("          install code\n"),
        "{listed}"
    );
    let row = ran(&CODE.replace("['discs']", "['polyhedra']"), "").remove(0);
    assert_eq!(
        (&*row["status"], &*row["reason"]),
        ("skipped", "code does not solve problems of discs without friction")
    );
}

#[test]
fn wrong_descriptions_and_settings_are_refused() {
    let refused =
        |description: &str, args: &[&str], words: &[&str]| study(description).gravel(args).refused(words);
    let named = ["solve", "pair", "--method", "code"];
    refused(&CODE.replace("{answer}", "{reply}"), &named, &["code.toml", "`command` must hold {answer}"]);
    refused(&CODE.replace("'code.sh'", "'other.sh'"), &named, &["code.toml", "other.sh"]);
    refused(&CODE.replace("what = 'a code'", ""), &named, &["code.toml", "what"]);
    let solve = |set| ["solve", "pair", "--method", "code", "--set", set];
    refused(CODE, &solve("does=flies"), &["method `code`, `does` is \"flies\"", "solves, negative"]);
    refused(CODE, &solve("tolerances=[]"), &["`tolerances` is []", "positive numbers"]);
    refused(CODE, &solve("seed=1"), &["unknown field `seed`", "`does`"]);
    refused(CODE, &["solve", "pair", "--method", "code", "--on", "zeta"], &["`on` is zeta"]);
    refused(
        CODE,
        &["simulate", "column", "--time-steps", "1", "--method", "code"],
        &["`code` is another code", "not through time"],
    );
}

/// Those that are installed find the velocity that ours certify, but for one that softens contacts; without any the test says so and checks
/// nothing.
#[test]
fn installed_codes_come_to_the_certified_velocity() {
    for (code, installed) in other_codes().into_iter().filter(|(code, _)| code != "mujoco") {
        if !installed {
            eprintln!("skipped: {code} is not installed; `gravel list methods` says how to install it");
            continue;
        }
        let stop = ["--on", "velocity_error", "--tolerance", "1e-6"];
        let object =
            gravel(&[&["solve", "settled-60", "--json", "--method", &code], &stop[..]].concat()).json();
        assert_eq!(object["status"], "converged", "{code}");
    }
}

/// Input of a code that makes its own contacts; without the Python of the other codes the test says so and checks nothing.
#[test]
fn what_is_handed_over_is_placed_exactly_and_told_from_another_problem() {
    let here = checkout().join("harness/external");
    let environment = std::env::var_os("GRAVEL_EXTERNAL_ENVIRONMENT");
    let environment = environment.map_or_else(|| here.join(".venv"), std::path::PathBuf::from);
    let python = environment.join("bin/python");
    if !python.is_file() {
        eprintln!("skipped: there is no {}", python.display());
        return;
    }
    let problem = checkout().join("cases/frozen/lmgc90-shear-991-t1.json");
    let output = std::process::Command::new(python)
        .args([here.join("test_scene.py"), problem])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Each form of a programme has the same solution.
#[test]
fn both_forms_of_a_programme_come_to_the_certified_velocity() {
    for code in ["clarabel", "osqp", "piqp", "proxqp"] {
        if !other_codes().contains(&(code.to_owned(), true)) {
            eprintln!("skipped: {code} is not installed; `gravel list methods` says how to install it");
            continue;
        }
        for form in ["form=dual", "form=primal"] {
            let stop = ["--on", "velocity_error", "--tolerance", "1e-6", "--set", form];
            let object =
                gravel(&[&["solve", "settled-60", "--json", "--method", code], &stop[..]].concat()).json();
            assert_eq!(object["status"], "converged", "{code}, {form}");
        }
    }
}

/// With friction, in the plane and in space; without the code the test says so and checks nothing.
#[test]
fn other_codes_leave_little_of_coulombs_law() {
    for (code, solver, problem) in [
        ("siconos-fc2d", "fc2d-nsgs", "thrown-disc"),
        ("siconos-fc3d", "fc3d-prox", "rough-250"),
        ("pinocchio", "admm", "rough-250"),
    ] {
        if !other_codes().contains(&(code.to_owned(), true)) {
            eprintln!("skipped: {code} is not installed; `gravel list methods` says how to install it");
            continue;
        }
        let setting = format!("solver={solver}");
        let object = gravel(&["solve", problem, "--json", "--method", code, "--set", &setting]).json();
        assert_eq!(object["status"], "converged", "{code}: {object}");
        assert!(object["natural_map"].as_f64().unwrap() <= 1e-6, "{code}: {object}");
    }
}

/// Where nothing slides its error is the softness of its contacts, the same with each solver.
#[test]
fn mujoco_comes_as_near_as_its_softness_allows() {
    if !other_codes().contains(&("mujoco".to_owned(), true)) {
        eprintln!("skipped: mujoco is not installed; `gravel list methods` says how to install it");
        return;
    }
    let error = |solver: &str| {
        let set = format!("solver={solver}");
        // Its Newton's method may fail with a sparse Jacobian.
        let set = ["--set", &set, "--set", "jacobian=dense"];
        let object =
            gravel(&[&["solve", "settled-60", "--json", "--method", "mujoco"], &set[..]].concat()).json();
        assert_eq!(object["status"], "stalled", "{solver}: {object}");
        object["natural_map"].as_f64().unwrap()
    };
    let newton = error("newton");
    assert!((1e-4..1e-1).contains(&newton), "{newton}");
    for solver in ["cg", "pgs"] {
        assert!((error(solver) / newton - 1.0).abs() < 1e-2, "{solver}");
    }
}
