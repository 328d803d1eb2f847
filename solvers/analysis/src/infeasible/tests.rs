use super::*;
use contact::Contact;
use nalgebra::Vector2;

/// A disc of 1 kg between two walls that close at 1 m/s; `tilt` (rad) of the second leaves a way out upwards.
fn between_walls(tilt: f64) -> ContactProblem {
    let wall = |normal| Contact { candidate: 0, antagonist: None, normal, offset: -1.0 };
    let contacts = vec![wall(Vector2::x()), wall(Vector2::new(-tilt.cos(), tilt.sin()))];
    ContactProblem::new(vec![1.0], vec![Vector2::zeros()], contacts).unwrap()
}

#[test]
fn impulses_that_balance_while_contacts_approach_prove_that_there_is_no_solution() {
    let closing = between_walls(0.0);
    assert!(proves_infeasible(&closing, &[1.0, 1.0]));
    assert!(proves_infeasible(&closing, &[1e9, 1e9]));
    for no_proof in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.001], [-1.0, -1.0], [f64::NAN, 1.0]] {
        assert!(!proves_infeasible(&closing, &no_proof), "{no_proof:?}");
    }
    // The disc escapes at 2/sin(tilt) m/s: 2e3 m/s at the narrowest, which is a solution.
    for tilt in [0.1, 1e-2, 1e-3] {
        for grown in [1.0, 1e6, 1e12] {
            assert!(!proves_infeasible(&between_walls(tilt), &[grown, grown]), "{tilt} rad");
        }
    }
}
