//! Which iterates are kept.

use crate::run::Snapshots;
use cases::Frozen;
use runner::{Stop, solve};

#[test]
fn begin_end_and_some_iterates_between_are_kept() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../cases/frozen/shear-box-991-onset.json");
    let frozen = Frozen::read(std::path::Path::new(path)).unwrap();
    let stop = Stop { max_iterations: 23, tolerance: 0.0, ..Stop::default() };
    let mut snapshots = Snapshots::new();
    let start = frozen.start(false);
    let outcome = solve(&nsgs::Nsgs::default(), &frozen.problem, &start, &stop, &mut |progress| {
        snapshots.observe(progress, 1);
    });
    let outcome = outcome.unwrap();
    let snapshots = snapshots.finish(&outcome);
    let iterations: Vec<u64> = snapshots.iter().map(|snapshot| snapshot.iteration).collect();
    assert_eq!(iterations, [0, 1, 2, 3, 5, 7, 10, 14, 20, 23]);
    let end = &snapshots[9].impulses_n_s;
    assert!(end.iter().zip(&outcome.impulses).all(|(kept, r)| (kept - r).abs() <= 0.005 * r));
}
