use contact::Work;
use results::schema::Ending;
use results::schema::{Run, Sample, Timing};
use serde_json::json;

use super::{front, stairs};
use crate::charts::truth::{truth, work_precision as parts};
use crate::tests::assert_well_formed;
use crate::tests::fixture::{
    File, decay, end, explosion, files, object, read, run, sample, study, tables, without_truth,
};
use crate::text::Part;

fn made(parts: &[Part]) -> Vec<File> {
    let files = files(parts);
    for (name, text) in files.iter().filter(|(name, _)| name.contains(".svg")) {
        assert_well_formed(name, text);
    }
    files
}

/// The table as CSV.
fn table(files: &[File]) -> &str {
    &files
        .iter()
        .find(|(name, _)| name.rsplit_once('.').is_some_and(|(_, ending)| ending == "csv"))
        .unwrap()
        .1
}

#[test]
fn front_is_below_every_point() {
    let points = [(1.0, 0.0), (0.0, 0.0), (2.0, -2.0), (1.5, -1.0), (3.0, -1.5)].map(Some);
    assert_eq!(front(points.iter()), [(0.0, 0.0), (1.5, 0.0), (1.5, -1.0), (2.0, -1.0), (2.0, -2.0)]);
    assert!(front([None].iter()).is_empty());
}

#[test]
fn value_holds_until_the_next_sample() {
    let line = [Some((0.0, 0.0)), Some((1.0, -1.0)), None, Some((3.0, 1.0)), Some((4.0, -2.0))];
    let corners: Vec<_> =
        stairs(&line).into_iter().map(|point| point.unwrap_or((f64::NAN, f64::NAN))).collect();
    assert_eq!(stairs(&line).len(), line.len() + 2);
    let joined = corners.windows(2).filter(|pair| !pair[0].0.is_nan() && !pair[1].0.is_nan());
    assert!(joined.clone().all(|pair| pair[0].0 == pair[1].0 || pair[0].1 == pair[1].1), "{corners:?}");
    assert_eq!(corners[1], (1.0, 0.0), "not before it is measured");
}

/// A run that was repeated five times.
fn repeated(run: Run) -> Run {
    Run {
        timing: Timing { repeats: 5, setup_spread_s: 0.0, iterating_spread_s: 0.0, ..run.timing.clone() },
        ..run
    }
}

#[test]
fn first_run_to_each_accuracy_is_named_with_its_cost() {
    let mut runs = [
        repeated(run(0, "nsgs", "", Ending::Converged)),
        Run { setup_s: 1.0, ..repeated(run(1, "cg", "none", Ending::Converged)) },
    ];
    let slow = || (0..=50).map(|i| sample(i, 1.0, 10f64.powf(-4.0 * i as f64 / 50.0))).collect();
    let first = |runs: &[Run]| {
        let files = made(&parts(&study(runs, &[(0, decay()), (1, slow())])));
        table(&files).lines().nth(1).unwrap().to_owned()
    };
    assert_eq!(
        first(&[run(0, "nsgs", "", Ending::Converged), runs[1].clone()]),
        "column,0.01,,0.00501,cg,100.0"
    );
    let files = made(&parts(&study(&runs, &[(0, decay()), (1, slow())])));
    // 50 iterations of 1e-4 s and a set-up of 1e-5 s; 25 of 40 updates and 2 products on 20 contacts.
    let rows: Vec<&str> = table(&files).lines().collect();
    assert_eq!(rows[1], "column,0.01,nsgs,0.00501,cg,100.0");
    assert_eq!(rows[3], "column,1e-6,,,,", "no run reaches it");
    // Intervals that overlap: a thousand times either way.
    runs[1].timing.iterating_spread_s = 1e3;
    assert_eq!(first(&runs), "column,0.01,nsgs; cg,0.00501,cg,100.0");
}

/// Runs of one method, each with a longer set-up and less work than the one before.
#[test]
fn of_many_runs_the_first_to_the_finest_accuracy_is_told_apart() {
    let letter = |n: u32| char::from_u32(u32::from('a') + n).unwrap().to_string();
    let variant = |n: u32| Run {
        setup_s: 1e-3 * f64::from(n),
        settings: object(&json!({ "letter": letter(n) })),
        ..run(n, "nsgs", &letter(n), Ending::Converged)
    };
    let work = |n: u32| {
        decay().into_iter().map(move |mut sample| {
            sample.work.contact_updates = sample.iteration * (99 - u64::from(n));
            sample
        })
    };
    let figure = |runs: u32| {
        let curves: Vec<_> = (0..runs).map(|n| (n, work(n).collect())).collect();
        let rows: Vec<Run> = (0..runs).map(variant).collect();
        made(&parts(&study(&rows, &curves))).remove(0).1
    };
    let few = figure(12);
    assert!((0..12).all(|n| few.contains(&format!("nsgs, {}", letter(n)))) && !few.contains("other runs"));
    let many = figure(13);
    let told: Vec<u32> = (0..13).filter(|n| many.contains(&format!("nsgs, {}", letter(*n)))).collect();
    assert_eq!(told, [0, 12], "first in seconds, first in counted work");
    assert!(many.contains("11 other runs."));
}

#[test]
fn run_that_factorises_again_has_no_counted_work() {
    let again = |s: Sample| Sample { work: Work { factorisations: s.iteration, ..s.work }, ..s };
    let again = decay().into_iter().map(again).collect();
    let only = [repeated(run(0, "interior-point", "", Ending::Converged))];
    let files = made(&parts(&study(&only, &[(0, again)])));
    assert!(table(&files).contains("column,0.01,interior-point,0.00501,,\n"), "{}", table(&files));
}

#[test]
fn rows_without_truth_or_with_failures_only_are_said_and_drawn() {
    let untrue = read(&without_truth(tables(&[run(0, "nsgs", "", Ending::Converged)], &[(0, decay())])));
    let failed = study(&[run(0, "jacobi", "", Ending::Diverged)], &[(0, explosion())]);
    let lone = study(
        &[run(0, "cg", "", Ending::Skipped), run(1, "cg", "", Ending::Converged)],
        &[(1, vec![sample(0, f64::NAN, 0.0)])],
    );
    for chart in [parts, truth] {
        let page = made(&chart(&untrue));
        assert!(page[1].1.contains("no velocity error in its rows"));
        assert_eq!(table(&made(&chart(&study(&[], &[])))).lines().count(), 1);
        made(&chart(&failed));
        made(&chart(&lone));
    }
}

#[test]
fn error_behind_a_small_measure_is_told() {
    let lies = (0..=10).map(|i| sample(i, 1e-5, 0.5)).collect();
    let runs = [run(0, "nsgs", "", Ending::Converged), run(1, "jacobi", "", Ending::IterationLimit)];
    let files = made(&truth(&study(&runs, &[(0, decay()), (1, lies)])));
    assert!(table(&files).contains("column,ζ,2,2,0.0001,0.5\n"), "{}", table(&files));
}

#[test]
fn impulses_of_another_code_are_told_with_their_error_and_not_drawn() {
    let given = Run {
        variant: "other code".into(),
        end: end(sample(0, 1e-7, 2e-5)),
        ..run(1, "given", "", Ending::Given)
    };
    let made = made(&parts(&study(&[run(0, "nsgs", "", Ending::Converged), given], &[(0, decay())])));
    let text = &made[made.len() - 2].1;
    let said = "column: the impulses that other code gave have a velocity error of 2·10⁻⁵.\n";
    assert!(text.contains(said), "{text}");
    assert!(!made[0].1.contains("given"));
}

#[test]
fn run_that_tells_no_work_has_none_after_its_start() {
    let untold = decay().into_iter().map(|s| Sample { work: Work::default(), ..s }).collect();
    let made =
        made(&parts(&study(&[repeated(run(0, "interior-point", "", Ending::Converged))], &[(0, untold)])));
    assert!(table(&made).contains("column,0.01,interior-point,0.00501,,\n"), "{}", table(&made));
}

#[test]
fn note_says_how_often_runs_were_made() {
    let note = |repeats: [u32; 2]| {
        let runs = [0, 1].map(|n| {
            let run = run(n, "nsgs", &n.to_string(), Ending::Converged);
            Run { timing: Timing { repeats: repeats[n as usize], ..run.timing.clone() }, ..run }
        });
        made(&parts(&study(&runs, &[(0, decay()), (1, decay())]))).swap_remove(2).1
    };
    assert!(note([1, 1]).contains("\nOne run each. "));
    assert!(note([3, 3]).contains("\nSeconds: medians of 3 runs each. "));
    assert!(note([1, 5]).contains("\nSeconds: medians of 1 to 5 runs each. "));
}
