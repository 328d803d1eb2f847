//! Methods that must be one another, iterate by iterate.

use crate::problems::{PACKINGS, any_problem, difference, frozen, impulses, start};
use cg::Cg;
use contact::{Contact, Iteration, Packing, Solver, Touch, greedy_colours, law};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use nalgebra::Vector2;
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Grid, Partition, Scheme};
use proptest::prelude::*;
use runner::{Stop, solve};

/// l⁻ = 0 makes the linear stage explicit: the local stage then is a Jacobi update, with ω = 1 for l⁺ = 1/W_αα.
#[test]
fn latin_without_l_minus_is_projected_jacobi() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        let explicit = LatinDd {
            relaxation: 1.0,
            kappa_l_minus: Some(0.0),
            kappa_l_plus: Some(1.0),
            ..LatinDd::default()
        };
        let mut jacobi = start(&Jacobi { relaxation: 1.0, ..Jacobi::default() }, &problem);
        let mut advance = || {
            jacobi.advance();
            impulses(&*jacobi, &problem)
        };
        // Few iterations: ω = 1 diverges on a packing, and takes round-off with it.
        assert_same_iterates(&problem, &mut *start(&explicit, &problem), &mut advance, 20);
    }
}

/// Begun from a solution, every stage of LATIN finds what it had: the start values satisfy all of (1)-(7).
#[test]
fn latin_stays_at_a_solution() {
    let problem = frozen("shear-box-991-sheared").problem;
    let stop = Stop { tolerance: 1e-12, ..Stop::default() };
    let r0 = vec![0.0; problem.contact_count()];
    let solution = solve(&Cg::default(), &problem, &r0, &stop, &mut |_| {}).unwrap().impulses;
    for subdomains in [Grid::ONE, Grid::of(4, 2)] {
        let settings = LatinDd { subdomains, ..LatinDd::default() };
        let mut run = settings.start(&problem, &solution).unwrap();
        run.advance();
        let difference = difference(&solution, &impulses(&*run, &problem));
        assert!(difference < 1e-9, "{subdomains}: {difference}");
    }
}

/// What sums of a few thousand terms of like size may differ by, relative to the greatest (–).
const ROUND_OFF: f64 = 1e-11;

fn assert_same_iterates(
    problem: &Packing,
    one: &mut dyn Iteration,
    other: &mut dyn FnMut() -> Vec<f64>,
    iterations: u32,
) {
    for k in 1..=iterations {
        one.advance();
        let (r, s) = (impulses(one, problem), other());
        assert!(difference(&r, &s) < ROUND_OFF, "iteration {k}: {}", difference(&r, &s));
    }
}

#[test]
fn nsgs_dd_on_one_subdomain_is_nsgs() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for relaxation in [1.0, 1.6] {
            let mut nsgs = start(&Nsgs { relaxation, ..Nsgs::default() }, &problem);
            let mut advance = || {
                nsgs.advance();
                impulses(&*nsgs, &problem)
            };
            let settings = NsgsDd { relaxation, ..NsgsDd::default() };
            assert_same_iterates(&problem, &mut *start(&settings, &problem), &mut advance, 100);
        }
    }
}

/// With whole masses what every contact changes is added up, in whichever subdomain it is.
#[test]
fn nsgs_dd_of_contacts_at_once_is_jacobi() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for (grid, mass_splitting) in [(Grid::ONE, true), (Grid::of(4, 2), false)] {
            let mut jacobi = start(&Jacobi::default(), &problem);
            let mut advance = || {
                jacobi.advance();
                impulses(&*jacobi, &problem)
            };
            let settings = NsgsDd {
                subdomains: grid,
                relaxation: Jacobi::default().relaxation,
                contact_exchange: Exchange::Jacobi,
                mass_splitting,
                ..NsgsDd::default()
            };
            assert_same_iterates(&problem, &mut *start(&settings, &problem), &mut advance, 100);
        }
    }
}

/// Subdomains of one colour share no grain, so whole masses and one colour after the other make one Gauss-Seidel
/// sweep over the contacts, subdomain by subdomain.
#[test]
fn gauss_seidel_exchange_with_whole_masses_is_nsgs_in_another_order() {
    let problem = frozen("shear-box-991-sheared").problem;
    // Eight columns: every second one has the first colour.
    let grid = Grid::of(8, 1);
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
    let mut order: Vec<usize> = (0..problem.contact_count()).collect();
    order.sort_by_key(|contact| (partition.subdomain[*contact] % 2, partition.subdomain[*contact]));
    let contacts: Vec<Contact> = order.iter().map(|contact| problem.contacts()[*contact]).collect();
    let reordered = Packing::new(
        problem.mass().to_vec(),
        problem.position().to_vec(),
        problem.free_velocity().to_vec(),
        contacts,
    )
    .unwrap();

    let settings = NsgsDd {
        subdomains: grid,
        exchange: Exchange::GaussSeidel,
        mass_splitting: false,
        ..NsgsDd::default()
    };
    let mut nsgs = start(&Nsgs::default(), &reordered);
    let mut advance = || {
        nsgs.advance();
        let sorted = impulses(&*nsgs, &reordered);
        let mut r = vec![0.0; sorted.len()];
        order.iter().zip(sorted).for_each(|(contact, value)| r[*contact] = value);
        r
    };
    assert_same_iterates(&problem, &mut *start(&settings, &problem), &mut advance, 100);
}

/// Mass splitting of Tonge et al. 2012, written out: every contact alone with its shares of its grains' masses.
fn mass_splitting_jacobi(problem: &Packing, r: &mut [f64]) {
    let mut multiplicity = vec![0.0; problem.grain_count()];
    for contact in problem.contacts() {
        multiplicity[contact.candidate as usize] += 1.0;
        if let Some(j) = contact.antagonist {
            multiplicity[j as usize] += 1.0;
        }
    }
    let mut velocity = vec![Vector2::zeros(); problem.grain_count()];
    problem.velocity(r, &mut velocity);
    for (contact, r) in problem.contacts().iter().zip(r) {
        let share = |grain: u32| multiplicity[grain as usize] / problem.mass()[grain as usize];
        let w = share(contact.candidate) + contact.antagonist.map_or(0.0, share);
        let v = contact.relative(&velocity) + contact.offset;
        *r = law::update(*r, v, 1.0 / w, 1.0);
    }
}

#[test]
fn one_contact_per_subdomain_is_mass_splitting() {
    let problem = frozen("shear-box-991-onset").problem;
    let settings = NsgsDd {
        subdomains: Grid::of(problem.contact_count() as u32, 1),
        partition: Scheme::Balanced,
        ..NsgsDd::default()
    };
    let mut r = vec![0.0; problem.contact_count()];
    let mut advance = || {
        mass_splitting_jacobi(&problem, &mut r);
        r.clone()
    };
    assert_same_iterates(&problem, &mut *start(&settings, &problem), &mut advance, 100);
}

#[test]
fn symmetric_sweep_is_a_sweep_and_its_reverse() {
    let problem = frozen("shear-box-991-onset").problem;
    let reversed = Packing::new(
        problem.mass().to_vec(),
        problem.position().to_vec(),
        problem.free_velocity().to_vec(),
        problem.contacts().iter().rev().copied().collect(),
    )
    .unwrap();
    let mut symmetric = start(&Nsgs { symmetric: true, ..Nsgs::default() }, &problem);
    symmetric.advance();

    let mut forward = start(&Nsgs::default(), &problem);
    forward.advance();
    let mut r = impulses(&*forward, &problem);
    r.reverse();
    let mut backward = contact::Solver::start(&Nsgs::default(), &reversed, &r).unwrap();
    backward.advance();
    let mut r = impulses(&*backward, &reversed);
    r.reverse();
    assert!(difference(&impulses(&*symmetric, &problem), &r) < ROUND_OFF);
    assert_eq!(symmetric.work().contact_updates, 2 * problem.contact_count() as u64);
}

proptest! {
    #[test]
    fn colours_share_no_grain(problem in any_problem()) {
        let contacts = problem.contacts().iter().map(Contact::grains);
        let colours = greedy_colours(contacts, problem.grain_count());
        for (k, (contact, colour)) in problem.contacts().iter().zip(&colours).enumerate() {
            let grains = |contact: &Contact| [Some(contact.candidate), contact.antagonist];
            for (other, other_colour) in problem.contacts()[..k].iter().zip(&colours) {
                let shared = grains(contact).iter().flatten().any(|grain| grains(other).contains(&Some(*grain)));
                prop_assert!(!shared || colour != other_colour);
            }
        }
    }

    #[test]
    fn every_order_visits_every_contact_once(problem in any_problem(), seed: u64) {
        for order in [Order::Natural, Order::BottomUp, Order::Shuffled, Order::Coloured] {
            let mut visited = order.of(&problem, seed);
            visited.sort_unstable();
            prop_assert_eq!(visited, (0..problem.contact_count() as u32).collect::<Vec<_>>());
        }
    }
}
