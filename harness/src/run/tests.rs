//! Which iterates are kept, and where contacts are drawn.

use crate::plan::Method;
use crate::problems::Problem;
use crate::root::Root;
use crate::run::repeats::{Made, median_times, repeated};
use crate::run::{Ended, Snapshots, ended, scene_rows};
use cases::{AnyFrozen, Case};
use lineup::march;
use partition::{Grid, Scheme};
use results::schema::{Sample, Timing};
use runner::{Measured, Outcome, Stop};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The path of a frozen problem.
fn frozen(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../cases/frozen/{name}.json"))
}

#[test]
fn begin_end_and_some_iterates_between_are_kept() {
    let problem = Problem::alone(AnyFrozen::read(&frozen("shear-box-991-onset")).unwrap(), false);
    let stop = Stop { max_iterations: 23, tolerance: 0.0, ..Stop::default() };
    let mut snapshots = Snapshots::of(&problem.posed);
    let start = problem.start(false);
    let run = lineup::Run { truths: &[], r0: &start, stop: &stop, measured: Measured::Every };
    let nsgs = Method::parse("nsgs", &[]).unwrap();
    let outcome = problem.posed.solve(nsgs.ours().unwrap(), run, &mut |progress| {
        snapshots.observe(progress);
        ControlFlow::Continue(())
    });
    let outcome = outcome.unwrap();
    let snapshots = snapshots.finish(&outcome);
    let iterations: Vec<u64> = snapshots.iter().map(|snapshot| snapshot.iteration).collect();
    assert_eq!(iterations, [0, 1, 2, 3, 5, 7, 10, 14, 20, 23]);
    let end = &snapshots[9].impulses_n_s;
    assert!(end.iter().zip(&outcome.impulses).all(|(kept, r)| (kept - r).abs() <= 0.005 * r));
}

/// Neither through the whole box, where a contact is beyond a periodic side, nor to the middle of a lid.
#[test]
fn a_contact_is_drawn_no_longer_than_two_grains() {
    let root = Root::find(None).unwrap();
    let case = Case::read(&root.problem_or_case("periodic-shear").unwrap(), &[]).unwrap();
    let problem = lineup::problem(march(&case).unwrap().frozen("", None).unwrap());
    let partitions = [("1x1".to_owned(), Grid::ONE, Scheme::Boxes)];
    let (grains, contacts) = scene_rows(("periodic-shear", &*problem), &partitions, None);
    let far = contacts.iter().zip(problem.touching()).filter(|(_, contact)| {
        let there =
            contact.antagonist.map(|j| grains[j as usize].x_m - grains[contact.candidate as usize].x_m);
        there.is_some_and(|x| x.abs() > 1.2)
    });
    assert!(far.count() > 0, "a contact through the sides");
    for row in &contacts {
        let length = (row.x1_m - row.x0_m).hypot(row.y1_m - row.y0_m);
        assert!(length < 0.2 + 0.05, "{length} m");
    }
}

/// Three repeats of less than a millisecond are more of them, until they take three.
#[test]
fn short_runs_are_repeated_more_often() {
    let problem = Problem::alone(AnyFrozen::read(&frozen("settled-60")).unwrap(), false);
    let start = problem.start(false);
    let run = lineup::Run { truths: &[], r0: &start, stop: &Stop::default(), measured: Measured::Needed };
    let nsgs = Method::parse("nsgs", &[]).unwrap();
    let made = ended(&nsgs, &problem, run, &mut |_| ControlFlow::Continue(())).unwrap().outcome;
    let repeats = |ours: bool, asked: u32, microseconds: u64| {
        let iterating = Duration::from_micros(microseconds);
        let once = || {
            let outcome = Outcome { setup: Duration::ZERO, iterating, ..made.clone() };
            let ended = Ended { outcome, rungs: Vec::new(), samples: Vec::new(), failed: None };
            Ok((ended, (Vec::new(), Vec::new())))
        };
        let timing = Timing { repeats: asked, ..Timing::default() };
        match repeated("a run", ours, &timing, once).unwrap() {
            Made::Ended(_, _, timing) => timing.repeats,
            Made::Halted | Made::Refused(_) => panic!("it ended"),
        }
    };
    assert_eq!([repeats(true, 3, 2000), repeats(true, 3, 700), repeats(true, 3, 70)], [3, 5, 43]);
    assert_eq!(repeats(true, 3, 1), 1000, "and no more than that");
    // One run is no sample, and another code is a process each time.
    assert_eq!([repeats(true, 1, 70), repeats(false, 3, 70)], [1, 3]);
}

/// A pause within one of three repeats, and a curve that another code cut short.
#[test]
fn curves_have_the_median_times_of_their_repeats() {
    let curve = |times: &[f64]| -> Vec<Sample> {
        let samples = times.iter().zip(0..);
        samples
            .map(|(time, iteration)| Sample { iteration, iterating_s: *time, ..Sample::default() })
            .collect()
    };
    let [first, paused, last] =
        [[0.0, 1.0, 2.0], [0.0, 9.0, 10.0], [0.0, 1.5, 2.5]].map(|times| curve(&times));
    assert_eq!(median_times(&[&first, &paused, &last]), [0.0, 1.5, 2.5]);
    assert_eq!(median_times(&[&first, &curve(&[0.0, 1.0])]), [0.0; 0]);
}
