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
    // The disc escapes at 2/sin(tilt) m/s, which is a solution, however fast that is.
    for tilt in [0.1, 1e-2, 1e-3, 1e-9, 1e-12, 1e-16, 1e-300] {
        for grown in [1.0, 1e6, 1e12] {
            assert!(!proves_infeasible(&between_walls(tilt), &[grown, grown]), "{tilt} rad");
        }
    }
}

/// Two walls that give way upwards at a lever, and a third above that is pushed by as little of their impulses.
#[test]
fn impulse_as_small_as_round_off_bars_a_fine_lever() {
    for tilt in [1e-3_f64, 1e-9, 1e-11, 1e-12] {
        let wall = |normal, offset| Contact { candidate: 0, antagonist: None, normal, offset };
        let slopes = [tilt.cos(), -tilt.cos()].map(|x| wall(Vector2::new(x, tilt.sin()), -1.0));
        let barred = slopes.into_iter().chain([wall(-Vector2::y(), 0.0)]).collect();
        let barred: ContactProblem = ContactProblem::new(vec![1.0], vec![Vector2::zeros()], barred).unwrap();
        assert!(proves_infeasible(&barred, &[1.0, 1.0, 2.0 * tilt.sin()]), "{tilt} rad");
        assert!(!proves_infeasible(&barred, &[1.0, 1.0, 0.0]), "{tilt} rad");
    }
}

/// Grains of 1 kg in a row along `normal`, and walls that close on its ends.
fn row(grains: u32, normal: Vector2<f64>) -> ContactProblem {
    let contact = |candidate, antagonist, normal, offset| Contact { candidate, antagonist, normal, offset };
    let mut contacts = vec![contact(0, None, normal, -0.5), contact(grains - 1, None, -normal, -0.5)];
    contacts.extend((1..grains).map(|k| contact(k, Some(k - 1), normal, 0.0)));
    ContactProblem::new(vec![1.0; grains as usize], vec![Vector2::zeros(); grains as usize], contacts)
        .unwrap()
}

#[test]
fn impulses_need_balance_but_for_round_off_where_impulses_near_them_balance_exactly() {
    let normal = Vector2::new(-0.373_388_827_803_571_5, 0.927_674_934_053_666_7);
    for grains in [1, 2, 40] {
        let ray: Vec<f64> = (0..=grains).map(|k| 1.0 + 1e-14 * f64::from(k % 3)).collect();
        assert!(proves_infeasible(&row(grains, normal), &ray), "{grains} grains");
    }
    // One link is turned by a unit of round-off: the row gives way there, at some 1e16 m/s.
    let mut contacts = row(3, normal).contacts().to_vec();
    contacts[2].normal.x = contacts[2].normal.x.next_up();
    let turned: ContactProblem =
        ContactProblem::new(vec![1.0; 3], vec![Vector2::zeros(); 3], contacts).unwrap();
    assert!(!proves_infeasible(&turned, &[1.0; 4]));
}

/// Discs on a square lattice with links to all eight neighbours, in a box whose walls close, all turned by an angle.
#[test]
fn packing_that_is_held_in_more_ways_than_it_can_move_is_refuted_by_bounds_of_round_off() {
    const SIDE: u32 = 12;
    let turn = nalgebra::Rotation2::new(0.3);
    let (mut contacts, mut ray) = (Vec::new(), Vec::new());
    let mut add = |candidate, antagonist, x: f64, y: f64, offset, d| {
        let normal = turn * Vector2::new(x, y).normalize();
        contacts.push(Contact { candidate, antagonist, normal, offset });
        ray.push(d);
    };
    for (column, row) in (0..SIDE).flat_map(|column| (0..SIDE).map(move |row| (column, row))) {
        let grain = |column, row| column * SIDE + row;
        let here = grain(column, row);
        let (first, last) = (|k| k == 0, |k| k == SIDE - 1);
        for (is_wall, x, y) in [
            (first(column), 1.0, 0.01),
            (last(column), -1.0, 0.02),
            (first(row), 0.03, 1.0),
            (last(row), 0.01, -1.0),
        ] {
            if is_wall {
                add(here, None, x, y, -0.1, 1.0);
                add(here, None, x - 0.1 * y, y + 0.1 * x, -0.1, 0.2);
                add(here, None, x + 0.1 * y, y - 0.1 * x, -0.1, 0.2);
            }
        }
        for (right, up) in [(1, 0), (0, 1), (1, 1)] {
            if column + right < SIDE && row + up < SIDE {
                add(
                    grain(column + right, row + up),
                    Some(here),
                    f64::from(right),
                    f64::from(up),
                    0.0,
                    if right * up > 0 { 0.2 } else { 1.2 },
                );
            }
        }
        if column > 0 && row + 1 < SIDE {
            add(grain(column - 1, row + 1), Some(here), -1.0, 1.0, 0.0, 0.2);
        }
    }
    let grains = (SIDE * SIDE) as usize;
    let problem: ContactProblem =
        ContactProblem::new(vec![1.0; grains], vec![Vector2::zeros(); grains], contacts).unwrap();
    let mut proof = Proof::alone(&problem);
    proof.take(&ray).balance();
    let ray = proof.subdomains[0].d.clone();
    assert!(proves_infeasible(&problem, &ray));
    // The same with walls that open has a solution.
    let opened = |contact: &Contact| Contact { offset: -contact.offset, ..*contact };
    let open = problem.contacts().iter().map(opened).collect();
    let open: ContactProblem =
        ContactProblem::new(problem.mass().to_vec(), problem.free_velocity().to_vec(), open).unwrap();
    assert!(!proves_infeasible(&open, &ray));
}
