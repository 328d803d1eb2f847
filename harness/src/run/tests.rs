//! Which iterates are kept, and where contacts are drawn.

use crate::problems::Root;
use crate::run::{Snapshots, scene_rows};
use cases::{Case, Frozen, March};
use contact::RoughDiscs;
use partition::{Grid, Scheme};
use runner::{Stop, solve};

#[test]
fn begin_end_and_some_iterates_between_are_kept() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../cases/frozen/shear-box-991-onset.json");
    let frozen = Frozen::<contact::Discs>::read(std::path::Path::new(path)).unwrap();
    let stop = Stop { max_iterations: 23, tolerance: 0.0, ..Stop::default() };
    let mut snapshots = Snapshots::of(&frozen.problem);
    let start = frozen.start(false);
    let outcome = solve(&nsgs::Nsgs::default(), &frozen.problem, &start, &stop, &mut |progress| {
        snapshots.observe(progress);
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
    let time_step = March::<RoughDiscs>::new(&case).unwrap().next().unwrap();
    let partitions = [("1x1".to_owned(), Grid::ONE, Scheme::Boxes)];
    let (grains, contacts) = scene_rows(&time_step.frozen, &partitions, None);
    let far = contacts.iter().zip(time_step.frozen.problem.contacts()).filter(|(_, contact)| {
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
