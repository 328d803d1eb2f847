//! Methods whose factors need more memory than there is are refused before they take it; what a run has taken is given back.

use active_set::ActiveSet;
use cases::Frozen;
use contact::{Discs, Packing, Solver, memory};
use latin_dd::LatinDd;
use nsgs::Nsgs;
use std::path::Path;

/// Why a method does not start, if it does not.
fn refusal(method: &dyn Solver, problem: &Packing) -> Option<String> {
    method.start(problem, &vec![0.0; problem.contact_count()]).err().map(|error| error.to_string())
}

#[test]
fn factors_take_no_more_memory_than_they_are_allowed() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen/settled-991.json");
    let problem = Frozen::<Discs>::read(&file).unwrap_or_else(|error| panic!("{error}")).problem;
    let fixed = LatinDd { kappa_l: Some(40.0), adaptive: Some(false), ..LatinDd::default() };
    let adaptive = LatinDd { kappa_l: Some(40.0), adaptive: Some(true), ..LatinDd::default() };
    let [active_set, nsgs] = [&ActiveSet::default() as &dyn Solver, &Nsgs::default()];
    // Some 4e4 entries of 8 bytes.
    memory::allow(100_000);
    for method in [active_set, &fixed] {
        let why = refusal(method, &problem).unwrap_or_default();
        assert!(why.contains("a factor takes 0.0 GB"), "{why}");
    }
    assert_eq!(refusal(nsgs, &problem), None);
    // One factor fits, and again, since the one before is gone; a second beside it does not.
    memory::allow(500_000);
    for _ in 0..5 {
        assert_eq!(refusal(active_set, &problem), None);
        assert_eq!(refusal(&fixed, &problem), None);
    }
    assert!(refusal(&adaptive, &problem).is_some());
    let _held = fixed.start(&problem, &vec![0.0; problem.contact_count()]);
    assert!(refusal(active_set, &problem).is_some());
}
