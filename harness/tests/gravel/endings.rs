//! How runs end: exit codes, what a simulation says of its ending, and what is left of one that is stopped.

use crate::bench::{Study, plan, rows};
use crate::common::{Ran, checkout, command, entries, gravel, text, write};
use crate::truth::closing_walls;
use serde_json::{Value, json};
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;

#[test]
fn exit_code_of_solve_says_whether_there_is_a_solution_and_whether_it_was_found() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/closing.json", &closing_walls().to_string());
    let solve = |args: &[&str]| study.gravel(&[&["solve"], args].concat());
    solve(&["pair"]).ended(0);
    solve(&["pair", "--method", "nsgs", "--max-iterations", "1"]).ended(3);
    solve(&["closing", "--method", "nsgs"]).ended(4);
    let on_zeta = ["closing", "--method", "nsgs", "--on", "zeta", "--tolerance", "1e-2"];
    // ζ falls where nothing converges; the reference knows it.
    solve(&[&on_zeta[..], &["--truth"]].concat()).ended(3);
    solve(&["absent"]).ended(1);
    solve(&["pair", "--max-iterations", "x"]).ended(2);
}

#[test]
fn exit_code_of_certify_is_that_of_what_was_asked_about() {
    let study = Study::new();
    write(study.folder(), "cases/frozen/closing.json", &closing_walls().to_string());
    let certify = |problem: &str, impulses: Option<Value>| {
        let given = impulses.map(|r| write(study.folder(), "r.json", &json!({ "impulse": r }).to_string()));
        let given = given.iter().flat_map(|file| ["--impulses", text(file)]);
        study.gravel(&["certify", problem].into_iter().chain(given).collect::<Vec<_>>())
    };
    certify("pair", None).ended(0);
    certify("pair", Some(json!([0.15, 0.1]))).ended(0);
    certify("pair", Some(json!([0.15, 0.2]))).ended(3);
    certify("closing", None).ended(4);
    certify("closing", Some(json!([1.0, 1.0]))).ended(4);
}

#[test]
fn help_says_which_exit_code_means_what() {
    for command in [&["--help"][..], &["solve", "--help"], &["certify", "--help"], &["simulate", "--help"]] {
        let printed = gravel(command).succeeded().stdout;
        for word in ["Exit codes:", "false-convergence", "not certified", "no solution", "130"] {
            assert!(printed.contains(word), "{command:?}: no `{word}` in: {printed}");
        }
    }
}

/// Walls that close on a disc at 10 m/s: no time step has a solution, and in the eleventh they have passed its centre.
const SQUEEZED: [&str; 8] = [
    "simulate",
    "closing-walls",
    "--scene",
    "scene.box.closing_speed_m_per_s=10",
    "--time-steps",
    "50",
    "--method",
    "gradient",
];

fn copy_case(study: &Study, name: &str) {
    let case = format!("cases/{name}.toml");
    fs::copy(checkout().join(&case), study.folder().path().join(case)).unwrap();
}

fn simulate(args: &[&str]) -> (TempDir, Ran) {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("rows.csv");
    let ran = gravel(&[args, &["-o", text(&file)]].concat());
    (folder, ran)
}

#[test]
fn simulation_without_solution_says_so_and_counts_what_it_began_from_zero() {
    let (folder, ran) = simulate(&SQUEEZED);
    let ran = ran.ended(4);
    assert!(ran.stdout.contains("no-solution after "), "{}", ran.stdout);
    assert!(ran.stderr.contains("has no solution; the problem of its last good state is"), "{}", ran.stderr);
    let folder_of_nothing = TempDir::new().unwrap();
    let bare = command(&SQUEEZED)
        .current_dir(folder_of_nothing.path())
        .env("GRAVEL_ROOT", checkout())
        .output()
        .unwrap();
    let said = String::from_utf8(bare.stderr).unwrap();
    assert!(said.contains("with `--output`, `--state` or `--vtk`"), "{said}");
    assert_eq!(entries(folder_of_nothing.path()).len(), 0, "nothing is written unasked");
    let object = simulate(&[&SQUEEZED[..], &["--json"]].concat()).1.json();
    assert_eq!((&object["case"], &object["status"]), (&json!("closing-walls"), &json!("no-solution")));
    let made = object["time_steps"].as_u64().unwrap();
    assert!((5..15).contains(&made), "{object}");
    for (key, expected) in [
        ("missed_time_steps", made),
        ("infeasible_time_steps", made),
        ("diverged_time_steps", 0),
        ("restarted_time_steps", made - 1),
    ] {
        assert_eq!(object[key], expected, "{key}");
    }
    let csv = fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    assert_eq!(csv.lines().filter(|row| row.contains(",infeasible,")).count() as u64, made);
    let reason = object["reason"].as_str().unwrap();
    assert!(reason.contains(&format!("exploded in time step {}: an overlap of", made + 1)), "{reason}");
    let last = &object["last_time_step"];
    assert!(last["time_s"].as_f64().unwrap() > 0.0 && last["contacts"] == 3, "{last}");
    // Where each time step begins from r = 0 anyway, none begins again from it.
    let cold = simulate(&[&SQUEEZED[..], &["--json", "--cold"]].concat()).1.json();
    assert_eq!((&cold["infeasible_time_steps"], &cold["restarted_time_steps"]), (&json!(made), &json!(0)));
}

#[test]
fn simulation_whose_solver_diverges_says_so() {
    let packing = ["simulate", "settled-box", "--time-steps", "50", "--scene", "sample.grains=60"];
    let jacobi = ["--scene", "scene.box.width_m=1.2", "--method", "jacobi", "--set", "relaxation=1.9"];
    let (folder, ran) = simulate(&[&packing[..], &jacobi, &["--json"]].concat());
    let object = ran.json();
    assert_eq!(object["status"], "solver-diverged", "{object}");
    assert!(object["reason"].as_str().unwrap().contains("the solver diverged in time step"), "{object}");
    let state = object["last_state"].as_str().unwrap();
    assert!(Path::new(state).starts_with(folder.path()), "{state}");
    gravel(&["solve", state]).succeeded();
    let kept = fs::read_to_string(state).unwrap();
    fs::write(state, kept.replacen("\"mass\":[", "\"mass\":[1", 1)).unwrap();
    gravel(&["solve", state]).refused(&[state, "damaged: its checksum is"]);
    // What is stopped early has not diverged: it exploded, and the time steps say what they missed.
    let early = ["--max-iterations", "12", "--tolerance", "0", "--json"];
    let object = simulate(&[&packing[..], &jacobi, &early].concat()).1.json();
    assert_eq!(object["status"], "exploded", "{object}");
    assert_eq!(object["missed_time_steps"], object["time_steps"]);
    assert!(object["reason"].as_str().unwrap().ends_with("with iteration-limit"), "{object}");
}

#[test]
fn completed_simulation_prints_one_object() {
    let object =
        gravel(&["simulate", "column", "--time-steps", "3", "--max-iterations", "1", "--json"]).json();
    assert_eq!(object["status"], "completed");
    assert_eq!(object["reason"], "3 of 3 time steps did not converge to natural_map ≤ 1e-6");
    assert_eq!((&object["time_steps_asked"], &object["time_steps"]), (&json!(3), &json!(3)));
    assert_eq!((&object["missed_time_steps"], &object["iterations"]), (&json!(3), &json!(3)));
    assert_eq!(object["max_iterations"], 1);
    assert!(object["last_state"].is_null() && object["delassus_products"].is_u64(), "{object}");
}

#[test]
fn exit_code_of_a_simulation_is_that_of_its_worst_time_step_and_its_last_line_says_why() {
    let column = ["simulate", "column", "--time-steps", "3"];
    let last = |ran: &Ran| ran.stdout.lines().last().unwrap().to_owned();
    let ran = gravel(&column).ended(0);
    assert!(last(&ran).trim_start().starts_with("3 "), "{}", ran.stdout);
    let object = gravel(&[&column[..], &["--json"]].concat()).json();
    assert_eq!((&object["status"], &object["reason"]), (&json!("completed"), &json!("")));
    let missed = gravel(&[&column[..], &["--max-iterations", "1"]].concat()).ended(3);
    assert_eq!(last(&missed), "3 of 3 time steps did not converge to natural_map ≤ 1e-6");
    // It ends before the walls have passed the centre of the disc.
    let squeezed = [&SQUEEZED[..5], &["3"], &SQUEEZED[6..]].concat();
    let none = gravel(&squeezed).ended(4);
    assert!(last(&none).contains("3 of 3 time steps did not converge"), "{}", none.stdout);
    assert!(last(&none).contains("3 had no solution"), "{}", none.stdout);
    let object = gravel(&[&squeezed[..], &["--json"]].concat()).json();
    assert_eq!((&object["status"], &object["infeasible_time_steps"]), (&json!("completed"), &json!(3)));
}

#[test]
fn study_through_time_keeps_what_made_a_simulation_explode() {
    let study = Study::new();
    let squeezed = r#"
name = "squeezed"
why = "A test."

[stop]
on = "natural_map"
tolerance = 1e-6
max_iterations = 2_000

[simulate]
duration_s = 0.1
sample_every_s = 0.005

[simulate.reference]
method = "gradient"
tolerance = 1e-8
refine = 1

[[cases]]
case = "closing-walls"
scene = { "scene.box.closing_speed_m_per_s" = 10.0 }

[[methods]]
method = "nsgs"
"#;
    write(study.folder(), "harness/plans/squeezed.toml", squeezed);
    copy_case(&study, "closing-walls");
    study.bench("squeezed");
    let table = rows(study.runs("squeezed").join("simulations.csv"));
    let run = table.iter().find(|row| row["role"] == "run").unwrap();
    assert_eq!(run["status"], "no-solution", "{run:?}");
    assert_eq!(run["infeasible_time_steps"], run["time_steps"], "{run:?}");
    assert!(study.runs("squeezed").join(&run["last_state"]).is_file(), "{run:?}");
    study.gravel(&["figure", "atlas-in-time", "squeezed"]).succeeded();
    let atlas = study.folder().path().join("reports/out/squeezed-atlas-in-time/atlas-in-time.csv");
    assert!(rows(atlas).iter().all(|row| row["class"] == "no solution"));
}

/// Waits until a file that `child` writes has `count` lines.
fn wait_for_lines(file: &Path, count: usize, child: &mut Child) {
    while fs::read_to_string(file).map_or(0, |text| text.lines().count()) < count {
        assert!(child.try_wait().unwrap().is_none(), "ended");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn killed_simulation_leaves_the_rows_and_frames_that_it_made() {
    let folder = TempDir::new().unwrap();
    let (file, vtk) = (folder.path().join("rows.csv"), folder.path().join("frames"));
    let args = ["simulate", "column", "--time-steps", "1000000000", "-o", text(&file), "--vtk", text(&vtk)];
    let mut child = command(&args).stdout(Stdio::null()).spawn().unwrap();
    wait_for_lines(&file, 20, &mut child);
    child.kill().unwrap();
    child.wait().unwrap();
    let csv = fs::read_to_string(&file).unwrap();
    let widths: Vec<usize> = csv.lines().map(|row| row.split(',').count()).collect();
    assert!(csv.ends_with('\n') && widths.len() >= 20 && widths.iter().all(|w| *w == widths[0]), "{csv}");
    let collection = fs::read_to_string(vtk.join("column.pvd")).unwrap();
    assert!(collection.starts_with("<?xml") && collection.ends_with("</VTKFile>\n"), "{collection}");
    let shown: Vec<&str> =
        collection.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    // Without the initial state. The kill may fall between a frame and its line, or a row and its frame.
    let states = shown.iter().filter(|name| name.contains("-grains-")).count() - 1;
    assert!(widths.len() - 2 <= states && states < widths.len(), "{states}");
    let frames = entries(&vtk);
    assert!(shown.iter().all(|name| frames.iter().any(|file| file == name)), "{shown:?}: {frames:?}");
}

/// Ends the child as `kill` does, and returns its exit code and what it printed.
#[cfg(unix)]
fn terminated(child: Child) -> (Option<i32>, String) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

/// Nothing is at or below a tolerance of 0 but the exact solution, which NSGS does not meet.
const ENDLESS: [&str; 6] = ["--method", "nsgs", "--tolerance", "0", "--max-iterations", "1000000000000"];

#[cfg(unix)]
#[test]
fn simulation_is_stopped_inside_a_solve_and_says_where() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("rows.csv");
    let run = ["simulate", "shear-box-991", "--time-steps", "3", "--json", "-o", text(&file)];
    let mut child = command(&[&run[..], &ENDLESS].concat()).stdout(Stdio::piped()).spawn().unwrap();
    wait_for_lines(&file, 1, &mut child);
    let (code, printed) = terminated(child);
    let object: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!((code, &object["status"]), (Some(130), &json!("interrupted")), "{object}");
    assert_eq!(object["time_steps"], 0, "{object}");
    assert_eq!(fs::read_to_string(&file).unwrap().lines().count(), 1);
}

/// Waits until the process catches SIGTERM: the signals that it catches are a mask of its status.
#[cfg(target_os = "linux")]
fn wait_until_it_listens(child: &mut Child) {
    let catches_sigterm = |child: &Child| {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim();
        u64::from_str_radix(mask, 16).unwrap() & 1 << 14 != 0
    };
    let begun = std::time::Instant::now();
    while !catches_sigterm(child) {
        assert!(child.try_wait().unwrap().is_none(), "ended");
        if begun.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("it does not catch SIGTERM");
        }
        sleep(Duration::from_millis(2));
    }
}

/// Commands that take longer than a test before any iteration that they could be stopped at: each marches.
#[cfg(target_os = "linux")]
#[test]
fn every_command_ends_alike_before_its_first_iteration() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out.json");
    let long = ["settled-box", "--time-step", "1000000"];
    for command_line in [
        &["solve", "--impulses", text(&out)][..],
        &["freeze", "-o", text(&out)],
        &["convert", text(&out)],
        &["view", "-o", text(&out)],
    ] {
        let args = match command_line {
            ["convert", to] => [&["convert", long[0], *to], &long[1..]].concat(),
            _ => [command_line, &long[..]].concat(),
        };
        let mut child = command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        wait_until_it_listens(&mut child);
        let mut stderr = child.stderr.take().unwrap();
        let (code, printed) = terminated(child);
        let mut said = String::new();
        stderr.read_to_string(&mut said).unwrap();
        assert_eq!((code, &*printed), (Some(130), ""), "{args:?}: {said}");
        assert!(
            said.contains("no iteration ended within a second; nothing of it is kept"),
            "{args:?}: {said}"
        );
        assert!(!out.exists(), "{args:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn solve_that_is_stopped_writes_what_it_reached() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.json");
    let run = ["solve", "settled-250", "--json", "--impulses", text(&file)];
    let mut child = command(&[&run[..], &ENDLESS].concat()).stdout(Stdio::piped()).spawn().unwrap();
    wait_until_it_listens(&mut child);
    let (code, printed) = terminated(child);
    let object: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!((code, &object["status"]), (Some(130), &json!("interrupted")), "{object}");
    let written: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(written["impulse"].as_array().unwrap().len() as u64, object["contacts"].as_u64().unwrap());
}

#[cfg(unix)]
#[test]
fn study_through_time_is_stopped_inside_a_solve() {
    let study = Study::new();
    let endless = plan("endless", &[], "[[methods]]\nmethod = \"nsgs\"\n")
        .replace("10_000", "1_000_000_000_000")
        .replace("1e-3", "0.0");
    let through_time = "[simulate]\nduration_s = 0.005\nsample_every_s = 0.005\n\n[simulate.reference]\nmethod = \"cg\"\n\
                        tolerance = 1e-3\nrefine = 1\n\n[[cases]]\ncase = \"settled-box\"\n";
    write(study.folder(), "harness/plans/endless.toml", &format!("{endless}{through_time}"));
    copy_case(&study, "settled-box");
    let args = ["--root", text(study.folder().path()), "bench", "endless"];
    let mut child = command(&args).stdout(Stdio::piped()).spawn().unwrap();
    // The reference, which is the floor as well, and its twin end; the run never does.
    let journal = study.runs("endless").join("journal.jsonl");
    wait_for_lines(&journal, 2, &mut child);
    let (code, printed) = terminated(child);
    assert_eq!(code, Some(130), "{printed}");
    assert!(printed.contains("stopped; simulations missing: "), "{printed}");
}

/// Sweeps of one iteration that take hours.
const SWEEPS: &str = "4000000000";

#[cfg(target_os = "linux")]
#[test]
fn one_signal_ends_a_solve_inside_an_iteration_without_end() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.json");
    let sweeps = format!("inner_sweeps={SWEEPS}");
    let run = ["solve", "settled-250", "--method", "nsgs-dd", "--set", &sweeps, "--impulses", text(&file)];
    let mut child = command(&run).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Half a second of a processor, in ticks of 10 ms: all before the first iteration takes a tenth of that.
    let worked = |child: &Child| {
        let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
        let after_name = stat.rsplit(')').next().unwrap().split_whitespace();
        after_name.skip(11).take(2).map(|ticks| ticks.parse::<u64>().unwrap()).sum::<u64>()
    };
    while worked(&child) < 50 {
        assert!(child.try_wait().unwrap().is_none(), "ended");
        sleep(Duration::from_millis(2));
    }
    let mut stderr = child.stderr.take().unwrap();
    let (code, printed) = terminated(child);
    let mut said = String::new();
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!((code, &*printed), (Some(130), ""), "{said}");
    assert!(said.contains("no iteration ended within a second; nothing of it is kept"), "{said}");
    assert!(!file.exists());
}

#[cfg(unix)]
#[test]
fn study_that_is_ended_inside_an_iteration_keeps_the_runs_before() {
    let study = Study::new();
    let methods = format!(
        "[[methods]]\nmethod = \"nsgs\"\n\n[[methods]]\nmethod = \"nsgs-dd\"\naxes = {{ inner_sweeps = [{SWEEPS}] }}\n"
    );
    let column = study.folder().path().join("cases/frozen/column-999.json");
    let freeze =
        ["freeze", "column", "--time-step", "1", "--scene", "sample.grains=999", "-o", text(&column)];
    study.gravel(&freeze).succeeded();
    study.plan("endless", &["column-999"], &methods);
    let args = ["--root", text(study.folder().path()), "bench", "endless"];
    let mut child = command(&args).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let journal = study.runs("endless").join("journal.jsonl");
    wait_for_lines(&journal, 1, &mut child);
    let (code, printed) = terminated(child);
    assert_eq!(code, Some(130), "{printed}");
    let kept = fs::read_to_string(&journal).unwrap();
    assert!(kept.ends_with('\n') && kept.lines().count() == 1, "{kept}");
    let listed = study.gravel(&["plan", "endless"]).succeeded().stdout;
    assert!(listed.contains("1        2  in all"), "{listed}");
}
