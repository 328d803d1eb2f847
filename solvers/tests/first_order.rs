//! The accelerated gradient and the non-smooth conjugate gradient: descent where it is proved, and what they start from.

use crate::column::iterations_per_decade;
use crate::problems::{any_problem, assert_never_increases, difference, energies, frozen, impulses, start};
use apgd::{Apgd, Preconditioner};
use contact::Solver;
use nncg::Nncg;
use nsgs::Nsgs;
use proptest::prelude::*;

/// The rate of a gradient is that of the condition, n² in a column; extrapolated, that of its root.
#[test]
fn extrapolation_makes_the_iterations_grow_with_the_column_and_not_with_its_square() {
    let growth = |solver: &dyn Solver| iterations_per_decade(solver, 40) / iterations_per_decade(solver, 10);
    let plain = growth(&Apgd { acceleration: false, ..Apgd::default() });
    assert!((14.0..18.0).contains(&plain), "{plain}, 16 expected");
    let accelerated = growth(&Apgd::default());
    assert!((3.0..5.0).contains(&accelerated), "{accelerated}, 4 expected");
}

/// There is no bound for this one: on longer columns it gains less.
#[test]
fn conjugate_directions_save_four_sweeps_in_five_of_a_column() {
    for n in [10, 20, 40] {
        let sweeps = iterations_per_decade(&Nncg::default(), n);
        let plain = iterations_per_decade(&Nsgs::default(), n);
        assert!(sweeps < 0.2 * plain, "{n} discs: {sweeps} sweeps instead of {plain}");
    }
}

#[test]
fn first_iteration_of_the_nonsmooth_conjugate_gradient_is_a_sweep() {
    let problem = frozen("shear-box-991-sheared").problem;
    let (mut nncg, mut nsgs) = (start(&Nncg::default(), &problem), start(&Nsgs::default(), &problem));
    nncg.advance();
    nsgs.advance();
    assert!(difference(&impulses(&*nsgs, &problem), &impulses(&*nncg, &problem)) < 1e-14);
    nncg.advance();
    nsgs.advance();
    assert!(difference(&impulses(&*nsgs, &problem), &impulses(&*nncg, &problem)) < 1e-14);
    assert_eq!(nncg.work(), nsgs.work());
    nncg.advance();
    nsgs.advance();
    assert!(
        difference(&impulses(&*nsgs, &problem), &impulses(&*nncg, &problem)) > 1e-3,
        "then it runs ahead"
    );
}

/// Where a sweep begins, r is above or below 0; the iterates that it leaves are admissible, and so are those of a step.
#[test]
fn iterates_are_admissible() {
    let problem = frozen("shear-box-991-onset").problem;
    for solver in [&Nncg::default() as &dyn Solver, &Apgd::default()] {
        let mut run = start(solver, &problem);
        for _ in 0..200 {
            run.advance();
            assert!(impulses(&*run, &problem).iter().all(|r| *r >= 0.0));
        }
    }
}

proptest! {
    #[test]
    fn projected_gradient_without_extrapolation_never_increases_the_energy(problem in any_problem()) {
        for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
            let settings = Apgd { acceleration: false, preconditioner };
            assert_never_increases(&energies(&settings, &problem, 40), &format!("{settings:?}"));
        }
    }
}
