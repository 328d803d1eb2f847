//! `gravel-mpi` without MPI: its commands at simulated ranks.
#![allow(clippy::unwrap_used)]

use crate::cli::split;
use crate::plan::Method;
use crate::problems::{Impulses, Problem};
use crate::root::Root;
use crate::store::open;
use crate::team::share::Posted;
use crate::team::{bench, ping, solve};
use anyhow::Result;
use cases::AnyFrozen;
use clap::Parser;
use lineup::Run;
use ranks::simulated;
use results::journal::Record;
use results::name::Name;
use results::store::Store;
use runner::{Measured, Outcome, Stop};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tempfile::TempDir;

mod beside;
mod in_parts;

#[derive(Parser)]
struct Split {
    #[command(flatten)]
    args: split::Args,
}

#[derive(Parser)]
struct Solve {
    #[command(flatten)]
    args: solve::Args,
}

#[derive(Parser)]
struct Ping {
    #[command(flatten)]
    args: ping::Args,
}

#[derive(Parser)]
struct Bench {
    #[command(flatten)]
    args: bench::Args,
}

fn checkout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The problem in 4x2 files.
fn split(problem: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let parts = folder.path().to_str().unwrap();
    let Split { args } = Split::parse_from(["split", problem, "--subdomains", "4x2", "-o", parts]);
    split::run(&Root::find(Some(checkout())).unwrap(), &args).unwrap();
    folder
}

/// Runs `gravel-mpi solve` on so many ranks and returns the end of each.
fn solve(size: usize, arguments: &[&str]) -> Vec<Result<ExitCode>> {
    let Solve { args } = Solve::parse_from([&["solve"], arguments].concat());
    simulated(size, |post| solve::run(&Posted(post), &Root::find(Some(checkout())).unwrap(), &args))
}

/// Returns the error it ends with, the same at all ranks.
fn reason(size: usize, arguments: &[&str]) -> String {
    let reasons: Vec<String> =
        solve(size, arguments).into_iter().map(|end| format!("{:#}", end.unwrap_err())).collect();
    assert!(reasons.iter().all(|reason| *reason == reasons[0]), "{reasons:?}");
    reasons[0].clone()
}

/// The impulses that ranks write, each its own.
fn impulses(size: usize, problem: &str, method: &str) -> Vec<f64> {
    let folder = TempDir::new().unwrap();
    let to = folder.path().to_str().unwrap();
    let stop = ["--tolerance", "0", "--max-iterations", "45", "--impulses", to];
    for end in solve(size, &[&[problem, "--method", method][..], &stop].concat()) {
        end.unwrap();
    }
    Impulses::join_all(folder.path()).unwrap()
}

/// The end of a method of this name on one machine.
fn alone(problem: &Path, method: &str, stop: &Stop) -> Outcome {
    let problem = Problem::alone(AnyFrozen::read(problem).unwrap(), false);
    let method = Method::parse(method, &[("subdomains".to_owned(), "4x2".to_owned())]).unwrap();
    let run = Run { truths: &[], r0: &problem.start(false), stop, measured: Measured::Every };
    problem.posed.solve(method.ours().unwrap(), run, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn ranks_that_read_their_own_files_end_with_the_bits_of_one_machine() {
    for name in ["settled-991", "rough-250", "spheres-250", "rough-spheres-250"] {
        let folder = split(name);
        let parts = folder.path().to_str().unwrap();
        let path = checkout().join("cases/frozen").join(name).with_extension("json");
        // As many iterations as ranks make.
        let stop = Stop { tolerance: 0.0, max_iterations: 45, ..Stop::default() };
        let [of_latin, of_nsgs] = ["latin-dd", "nsgs-dd"].map(|method| alone(&path, method, &stop).impulses);
        for size in [1, 3, 8] {
            assert!(impulses(size, parts, "latin-dd") == of_latin, "{name}, {size} ranks");
            assert!(impulses(size, parts, "nsgs-dd") == of_nsgs, "{name}, {size} ranks");
        }
        let of_cg = impulses(1, parts, "cg");
        assert!([2, 8].map(|size| impulses(size, parts, "cg")).iter().all(|r| *r == of_cg), "{name}");
    }
}

#[test]
fn one_rank_that_cannot_go_on_ends_all_with_its_number() {
    let folder = split("settled-60");
    let parts = folder.path().to_str().unwrap();
    let solved = |size| reason(size, &[parts, "--method", "nsgs-dd"]);
    let path = folder.path().join("6.jsonl");
    let text = fs::read_to_string(&path).unwrap();

    let (line, problem) = text.split_once('\n').unwrap();
    let line = String::from_utf8(seal::opened(line.as_bytes()).unwrap().unwrap()).unwrap();
    let line = seal::sealed(&line.replacen("\"subdomain\":6", "\"subdomain\":5", 1));
    fs::write(&path, format!("{line}\n{problem}")).unwrap();
    let expected = format!("{}: `subdomain` is 5: it must be 6", path.display());
    assert_eq!(solved(4), format!("rank 3: {expected}"));
    fs::write(&path, &text[..text.len() / 2]).unwrap();
    assert!(solved(4).starts_with(&format!("rank 3: {}", path.display())), "{}", solved(4));
    fs::remove_file(&path).unwrap();
    assert!(solved(8).starts_with(&format!("rank 6: {}", path.display())), "{}", solved(8));
    fs::remove_file(folder.path().join("0.jsonl")).unwrap();
    assert!(solved(8).starts_with("rank 0: "), "{}", solved(8));
}

#[test]
fn what_cannot_be_is_refused_alike_at_all_ranks() {
    let folder = split("settled-60");
    let parts = folder.path().to_str().unwrap();
    for (arguments, expected) in [
        (
            &[parts, "--method", "nsgs"][..],
            "method `nsgs` has no subdomains: nsgs-dd, latin-dd and cg run on ranks",
        ),
        (
            &[parts, "--method", "cg", "--subdomains", "2x2"],
            "subdomains are to be 2x2: the problem is split into 4x2",
        ),
        (
            &[parts, "--method", "latin-dd", "--set", "relaxation=3"],
            "`relaxation` is 3: it must be above 0 and at most 1",
        ),
        (
            &["settled-60", "--subdomains", "1x2", "--method", "cg"],
            "`ranks` is 4: it must be at most 2, the number of subdomains",
        ),
        (
            &[parts, "--method", "cg", "--on", "velocity_error"],
            "no solution lies there: `gravel split --truth` writes those that are known",
        ),
    ] {
        let reason = reason(4, arguments);
        assert!(reason.contains(expected), "{reason}");
    }
}

#[test]
fn a_study_on_ranks_is_one_row_a_run() {
    let root = TempDir::new().unwrap();
    for inner in ["cases/frozen", "harness/plans"] {
        fs::create_dir_all(root.path().join(inner)).unwrap();
    }
    let problem = "cases/frozen/settled-60.json";
    fs::copy(checkout().join(problem), root.path().join(problem)).unwrap();
    let plan = "name = \"few\"\nwhy = \"A test.\"\nproblems = [\"settled-60\"]\n\n\
        [stop]\non = \"natural_map\"\ntolerance = 1e-3\nmax_iterations = 10_000\n\n\
        [[methods]]\nmethod = \"nsgs-dd\"\naxes = { subdomains = [\"1x1\", \"4x2\"] }\n\n\
        [[methods]]\nmethod = \"cg\"\n\n[[methods]]\nmethod = \"nsgs\"\n";
    fs::write(root.path().join("harness/plans/few.toml"), plan).unwrap();
    let Bench { args } = Bench::parse_from(["bench", "few"]);
    for _ in 0..2 {
        let ends = simulated(2, |post| {
            bench::run(&Posted(post), &Root::find(Some(root.path().into())).unwrap(), &args)
        });
        assert!(ends.iter().all(Result::is_ok), "{ends:?}");
        let store: Store<Record> =
            open(&Root::find(Some(root.path().into())).unwrap(), "few-on-2-ranks").unwrap();
        let runs: Vec<_> = store.records().iter().map(|record| &record.run).collect();
        let ends: Vec<_> = runs.iter().map(|run| (&*run.method, run.subdomains, run.status.name())).collect();
        // What is there is not run again.
        let expected = [
            ("nsgs-dd", 1, "skipped"),
            ("nsgs-dd", 8, "converged"),
            ("cg", 2, "converged"),
            ("nsgs", 1, "skipped"),
        ];
        assert_eq!(ends, expected);
        let exchange = &runs[1].exchange;
        assert_eq!(exchange.ranks, 2);
        // Two ranks of four subdomains each: one message each way in each iteration.
        assert_eq!(exchange.messages, 2 * runs[1].iterations);
        assert!(exchange.message_bytes > 0 && exchange.waiting_s > 0.0);
    }
}

#[test]
fn a_message_takes_some_time() {
    let alone = simulated(1, |post| ping::run(&Posted(post), &Ping::parse_from(["ping"]).args));
    assert!(alone[0].as_ref().unwrap_err().to_string().contains("two ranks"));
    let ends = simulated(3, |post| ping::run(&Posted(post), &Ping::parse_from(["ping", "--json"]).args));
    assert!(ends.iter().all(Result::is_ok), "{ends:?}");
}

/// Whatever iterates are measured, they are the same; one that ends a run may be seen late.
#[test]
fn a_run_that_is_measured_rarely_ends_late_by_less_than_that() {
    let iterations = |every: &str| {
        let folder = TempDir::new().unwrap();
        let to = folder.path().to_str().unwrap();
        let arguments =
            ["settled-60", "--method", "nsgs-dd", "--set", "subdomains=4x2", "--tolerance", "1e-3"];
        let more = ["--measure-every", every, "--impulses", to];
        assert!(solve(2, &[&arguments[..], &more].concat()).iter().all(Result::is_ok));
        Impulses::join_all(folder.path()).unwrap()
    };
    let path = checkout().join("cases/frozen/settled-60.json");
    let at = |max_iterations| {
        let stop = Stop { tolerance: 1e-3, max_iterations, ..Stop::default() };
        let stop = if max_iterations < 10_000 { Stop { tolerance: 0.0, ..stop } } else { stop };
        alone(&path, "nsgs-dd", &stop)
    };
    let end = at(10_000);
    assert!(iterations("1") == end.impulses);
    assert!(!end.iterations.is_multiple_of(10), "{} iterations", end.iterations);
    assert!(iterations("10") == at(end.iterations.next_multiple_of(10)).impulses);
}
