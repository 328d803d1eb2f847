use super::*;
use crate::scaled_delassus_bound;
use contact::Contact;
use nalgebra::Vector2;

/// n discs of mass 1 on a floor, one on top of the other.
fn column(n: u32) -> ContactProblem {
    let up = Vector2::y();
    let contact = |k: u32| Contact { candidate: k, antagonist: k.checked_sub(1), normal: up, offset: 0.0 };
    let grains = n as usize;
    ContactProblem::new(vec![1.0; grains], vec![-up; grains], (0..n).map(contact).collect()).unwrap()
}

/// W_D^-½ W W_D^-½ of a column is tridiagonal: 1 − cos((2j − 1)π/2n) are its eigenvalues.
#[test]
fn eigenvalues_of_a_column_are_those_of_a_chain() {
    let n = 12;
    let values = eigenvalues(&column(n), &(0..n as usize).collect::<Vec<_>>()).unwrap();
    for (j, value) in values.iter().enumerate() {
        let expected = 1.0 - ((2 * j + 1) as f64 * std::f64::consts::PI / f64::from(2 * n)).cos();
        assert!((value - expected).abs() < 1e-13, "{value}, {expected} expected");
    }
}

#[test]
fn copies_of_a_contact_multiply_the_greatest_eigenvalue_and_are_redundant() {
    let once = column(5);
    let twice: Vec<Contact> = once.contacts().iter().flat_map(|contact| [*contact; 2]).collect();
    let twice = ContactProblem::new(once.mass().to_vec(), once.free_velocity().to_vec(), twice).unwrap();
    let spectrum = |problem: &ContactProblem| {
        Spectrum::of(problem, Some(&vec![true; problem.contact_count()])).closed.unwrap()
    };
    let (once, twice) = (spectrum(&once), spectrum(&twice));
    assert_eq!((once.redundant, twice.redundant), (0, 5));
    assert!((twice.greatest / once.greatest - 2.0).abs() < 1e-12);
    assert!((twice.least / once.least - 2.0).abs() < 1e-10);
}

#[test]
fn bound_is_above_the_greatest_eigenvalue_and_the_power_iteration_below() {
    for n in [1, 2, 7, 40] {
        let problem = column(n);
        let exact = Spectrum::of(&problem, None).greatest;
        assert!(greatest_eigenvalue(&problem) <= exact * (1.0 + 1e-14));
        assert!(exact <= scaled_delassus_bound(&problem) * (1.0 + 1e-14), "n = {n}");
    }
}

#[test]
fn no_contact_has_no_spectrum() {
    let problem = ContactProblem::new(vec![1.0], vec![Vector2::zeros()], vec![]).unwrap();
    assert_eq!(Spectrum::of(&problem, Some(&[])), Spectrum::default());
    assert_eq!(scaled_delassus_bound(&problem), 0.0);
}
