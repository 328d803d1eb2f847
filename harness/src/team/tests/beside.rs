//! Files that ranks read beside those of a problem: impulses to begin from, and solutions.

use super::{Solve, Split, checkout, reason};
use crate::cli::split;
use crate::plan::Method;
use crate::problems::Impulses;
use crate::root::Root;
use crate::store::open;
use crate::team::share::Posted;
use crate::team::{bench, solve};
use cases::{AnyFrozen, Frozen};
use clap::Parser;
use contact::Measure;
use lineup::{OneProblem, Run};
use ranks::simulated;
use reference::Answer;
use results::journal::Record;
use results::store::Store;
use runner::{Measured, Outcome, Stop};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use tempfile::TempDir;

/// A checkout with some problems, in which references may be kept.
fn checkout_of(problems: &[&str]) -> TempDir {
    let root = TempDir::new().unwrap();
    for inner in ["cases/frozen", "harness/plans"] {
        fs::create_dir_all(root.path().join(inner)).unwrap();
    }
    for problem in problems {
        let file = Path::new("cases/frozen").join(problem).with_extension("json");
        fs::copy(checkout().join(&file), root.path().join(&file)).unwrap();
    }
    root
}

fn root_of(folder: &TempDir) -> Root {
    Root::find(Some(folder.path().into())).unwrap()
}

fn split_of(root: &TempDir, problem: &str, parts: &Path, more: &[&str]) {
    let to = parts.to_str().unwrap();
    let arguments = [&["split", problem, "--subdomains", "4x2", "-o", to], more].concat();
    split::run(&root_of(root), &Split::parse_from(arguments).args).unwrap();
}

/// The impulses with which so many ranks end.
fn ended(root: &TempDir, size: usize, arguments: &[&str]) -> Vec<f64> {
    let folder = TempDir::new().unwrap();
    ended_in(root, size, arguments, folder.path());
    Impulses::join_all(folder.path()).unwrap()
}

fn ended_in(root: &TempDir, size: usize, arguments: &[&str], folder: &Path) {
    let to = folder.to_str().unwrap();
    let Solve { args } = Solve::parse_from([&["solve"], arguments, &["--impulses", to]].concat());
    for end in simulated(size, |post| solve::run(&Posted(post), &root_of(root), &args)) {
        end.unwrap();
    }
}

fn frozen(name: &str) -> Frozen {
    let path = checkout().join("cases/frozen").join(name).with_extension("json");
    AnyFrozen::read(&path).unwrap().of().expect("a problem of discs without friction")
}

/// Solves on one machine, and measures the distance to the solution.
fn alone(frozen: &Frozen, method: &str, start: &[f64], stop: &Stop) -> Outcome {
    let method = Method::parse(method, &[("subdomains".to_owned(), "4x2".to_owned())]).unwrap();
    let Answer::Solution { impulses, .. } = reference::solve(&frozen.problem) else { panic!("no solution") };
    let run = Run { truths: &[impulses], r0: start, stop, measured: Measured::Every };
    let go_on = &mut |_: &runner::Progress| ControlFlow::Continue(());
    OneProblem::solve(frozen, method.ours().unwrap(), run, go_on).unwrap()
}

#[test]
fn ranks_stop_on_the_error_that_their_parts_of_the_solution_tell() {
    let (root, folder) = (checkout_of(&["settled-60"]), TempDir::new().unwrap());
    let parts = folder.path().join("parts");
    split_of(&root, "settled-60", &parts, &["--truth"]);
    let problem = frozen("settled-60");
    let stop = Stop { on: Measure::VelocityError, tolerance: 1e-2, max_iterations: 100_000 };
    let expected = alone(&problem, "nsgs-dd", &problem.start(false), &stop);
    assert!(expected.measures.velocity_error <= 1e-2 && expected.iterations > 10);
    let on = ["--method", "nsgs-dd", "--on", "velocity_error", "--tolerance", "1e-2"];
    for size in [1, 3, 8] {
        let of_parts = ended(&root, size, &[&[parts.to_str().unwrap()][..], &on].concat());
        assert!(of_parts == expected.impulses, "{size} ranks");
        // Each keeps its part of the reference that rank 0 found.
        let of_whole = ended(&root, size, &[&["settled-60", "--subdomains", "4x2"][..], &on].concat());
        assert!(of_whole == expected.impulses, "{size} ranks");
    }
    // What lies there is the solution in parts.
    let Answer::Solution { impulses, .. } = reference::solve(&problem.problem) else { panic!("no solution") };
    assert_eq!(Impulses::join_all(&parts.join("solution-0")).unwrap(), impulses);
}

#[test]
fn a_study_on_ranks_has_the_errors_of_one_machine() {
    let root = checkout_of(&["settled-60", "shear-box-991-sheared"]);
    let plan = "name = \"few\"\nwhy = \"A test.\"\nproblems = [\"settled-60\", \"shear-box-991-sheared\"]\n\
\n\
        [stop]\non = \"natural_map\"\ntolerance = 0.0\nmax_iterations = 20\n\n\
        [[methods]]\nmethod = \"latin-dd\"\nset = { subdomains = \"4x2\" }\nwarm_start = [false, true]\n";
    fs::write(root.path().join("harness/plans/few.toml"), plan).unwrap();
    let super::Bench { args } = super::Bench::parse_from(["bench", "few"]);
    for end in simulated(2, |post| bench::run(&Posted(post), &root_of(&root), &args)) {
        end.unwrap();
    }
    let store: Store<Record> = open(&root_of(&root), "few-on-2-ranks").unwrap();
    let stop = Stop { tolerance: 0.0, max_iterations: 20, ..Stop::default() };
    let mut warm = 0;
    for Record { run, curve, .. } in store.records() {
        let problem = frozen(&run.problem);
        warm += usize::from(run.warm_start);
        let expected = alone(&problem, "latin-dd", &problem.start(run.warm_start), &stop).measures;
        let found = run.end.measures;
        let apart = (found.velocity_error - expected.velocity_error).abs();
        assert!(apart <= 1e-9 * expected.velocity_error, "{}: {apart:e}", run.problem);
        assert_eq!(run.known.solutions, Some(1));
        assert!(curve.iter().all(|sample| sample.measures.velocity_error > 0.0));
    }
    assert_eq!((store.records().len(), warm), (4, 2));
}

#[test]
fn ranks_begin_where_others_ended_or_the_time_step_before_did() {
    let (root, folder) = (checkout_of(&["shear-box-991-sheared"]), TempDir::new().unwrap());
    let [parts, before] = ["parts", "before"].map(|inner| folder.path().join(inner));
    split_of(&root, "shear-box-991-sheared", &parts, &[]);
    let problem = frozen("shear-box-991-sheared");
    assert!(!problem.start.is_empty());
    let common = [parts.to_str().unwrap(), "--method", "nsgs-dd", "--tolerance", "0"];
    let run = |size, more: &[&str]| ended(&root, size, &[&common, more].concat());
    let stop = Stop { tolerance: 0.0, max_iterations: 20, ..Stop::default() };
    fs::create_dir(&before).unwrap();
    ended_in(&root, 8, &[&common[..], &["--max-iterations", "15"]].concat(), &before);
    let from = Impulses::join_all(&before).unwrap();
    for size in [1, 2, 4, 8] {
        let warm = run(size, &["--max-iterations", "20", "--start", "warm"]);
        assert!(warm == alone(&problem, "nsgs-dd", &problem.start, &stop).impulses, "{size} ranks");
        let on = run(size, &["--max-iterations", "20", "--start", before.to_str().unwrap()]);
        assert!(on == alone(&problem, "nsgs-dd", &from, &stop).impulses, "{size} ranks");
    }
}

/// The text of a file of impulses without its checksum, as it was written once: what a test changes in it is then read.
fn without_checksum(path: &Path) -> String {
    String::from_utf8(seal::opened(&fs::read(path).unwrap()).unwrap().unwrap()).unwrap()
}

#[test]
fn what_lies_beside_is_refused_with_its_file_and_rank() {
    let (root, folder) = (checkout_of(&["settled-60"]), TempDir::new().unwrap());
    let [parts, start] = ["parts", "start"].map(|inner| folder.path().join(inner));
    split_of(&root, "settled-60", &parts, &["--truth"]);
    fs::create_dir(&start).unwrap();
    let [parts_, start_] = [&parts, &start].map(|path| path.to_str().unwrap());
    ended_in(&root, 4, &[parts_, "--method", "cg"], &start);
    let solved = |more: &[&str]| reason(4, &[&[parts_, "--method", "cg"], more].concat());

    let path = parts.join("solution-0/5.impulses.json");
    let kept = without_checksum(&path);
    fs::remove_file(&path).unwrap();
    assert!(
        solved(&["--truth"]).starts_with(&format!("rank 2: {}", path.display())),
        "{}",
        solved(&["--truth"])
    );
    fs::write(&path, kept.replacen("\"impulse\":[", "\"impulse\":[1.0,", 1)).unwrap();
    assert!(solved(&["--truth"]).contains("`impulse` has "), "{}", solved(&["--truth"]));
    let last = kept.rfind(',').unwrap();
    fs::write(&path, format!("{},12.5]}}", &kept[..last])).unwrap();
    assert!(solved(&["--truth"]).starts_with("`solution` is number 0, which"), "{}", solved(&["--truth"]));

    let path = start.join("6.impulses.json");
    let kept = without_checksum(&path);
    let begun = || solved(&["--start", start_]);
    let says = |expected: &str| {
        let reason = begun();
        assert!(reason.starts_with(&format!("rank 3: {}: {expected}", path.display())), "{reason}");
    };
    fs::write(&path, kept.replacen("\"problem_hash\":\"", "\"problem_hash\":\"0", 1)).unwrap();
    says("`problem_hash` is 0");
    let last = kept.rfind(',').unwrap();
    fs::write(&path, format!("{},-0.5]}}", &kept[..last])).unwrap();
    says("`impulse` of contact ");
    fs::copy(start.join("5.impulses.json"), &path).unwrap();
    says("`contact` has not the contacts of subdomain 6");
}

#[test]
fn no_flipped_bit_of_a_part_or_of_its_impulses_is_taken_for_what_was_written() {
    let (root, folder) = (checkout_of(&["settled-60"]), TempDir::new().unwrap());
    let [parts, start] = ["parts", "start"].map(|inner| folder.path().join(inner));
    split_of(&root, "settled-60", &parts, &["--truth"]);
    fs::create_dir(&start).unwrap();
    let [parts_, start_] = [&parts, &start].map(|path| path.to_str().unwrap());
    ended_in(&root, 2, &[parts_, "--method", "nsgs-dd"], &start);
    let solved = || reason(2, &[parts_, "--method", "nsgs-dd", "--start", start_, "--truth"]);
    for (file, rank) in [
        (parts.join("0.jsonl"), 0),
        (parts.join("5.jsonl"), 1),
        (parts.join("solution-0/1.impulses.json"), 0),
        (start.join("6.impulses.json"), 1),
    ] {
        let kept = fs::read(&file).unwrap();
        for bit in (3..8 * kept.len()).step_by(8 * kept.len() / 40 + 1) {
            let mut flipped = kept.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(&file, flipped).unwrap();
            let reason = solved();
            let expected = format!("rank {rank}: {}", file.display());
            assert!(reason.starts_with(&expected), "bit {bit}: {reason}");
        }
        fs::write(&file, kept).unwrap();
    }
}

#[test]
fn parts_from_before_there_were_checksums_are_read_and_ones_that_lost_theirs_are_not() {
    let (root, folder) = (checkout_of(&["settled-60"]), TempDir::new().unwrap());
    let parts = folder.path().join("parts");
    split_of(&root, "settled-60", &parts, &[]);
    let arguments =
        [parts.to_str().unwrap(), "--method", "nsgs-dd", "--tolerance", "0", "--max-iterations", "9"];
    let expected = ended(&root, 2, &arguments);
    for e in 0..8 {
        let file = parts.join(format!("{e}.jsonl"));
        let text = fs::read_to_string(&file).unwrap();
        let lines = text.lines().map(|line| seal::opened(line.as_bytes()).unwrap().unwrap());
        let lines: Vec<String> = lines.map(|line| String::from_utf8(line).unwrap()).collect();
        if e == 3 {
            fs::write(&file, lines.join("\n")).unwrap();
            assert!(reason(2, &arguments).contains("3.jsonl: damaged: it has no checksum"));
            let first = text.lines().next().unwrap();
            fs::write(&file, format!("{first}\n{}\n", lines[1])).unwrap();
            assert!(reason(2, &arguments).contains("3.jsonl: line 2 is damaged: it has no checksum"));
        }
        fs::write(&file, lines.join("\n").replacen("subdomain/2", "subdomain/1", 1)).unwrap();
    }
    assert!(ended(&root, 2, &arguments) == expected);
}
