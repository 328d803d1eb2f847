//! What a partition must be, what gluing must give, and the descent that split masses assure.

use crate::problems::{
    PACKINGS, any_problem, assert_never_increases, difference, energies, frozen, impulses, start,
};
use contact::{Packing, Solver};
use gradient::Gradient;
use nalgebra::{Vector2, Vector3};
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{CopySums, Decomposition, Grid, Partition, Scheme, Subdomain};
use proptest::prelude::*;

const GRIDS: [Grid; 5] = [Grid::ONE, Grid::of(2, 1), Grid::of(2, 2), Grid::of(4, 2), Grid::of(5, 5)];

fn fits(problem: &Packing, grid: Grid) -> bool {
    grid.count() <= problem.contact_count() as u64
}

fn assert_is_a_partition(problem: &Packing, partition: &Partition) {
    let decomposition = Decomposition::new(problem, partition);
    let mut held: Vec<u32> = decomposition.subdomains.iter().flat_map(|e| e.contacts.clone()).collect();
    held.sort_unstable();
    assert_eq!(
        held,
        (0..problem.contact_count() as u32).collect::<Vec<_>>(),
        "each contact in one subdomain"
    );

    let boundary_grains = decomposition.boundary.len();
    assert_eq!(partition.cut(&problem.adjacency()), decomposition.copy_count() - boundary_grains);

    // The masses M_i/m_i of the copies, found by walking through the subdomains, sum to the grain's.
    let mut mass = vec![0.0; problem.grain_count()];
    for subdomain in &decomposition.subdomains {
        for (contact, (i, j)) in subdomain.contacts.iter().zip(&subdomain.ends) {
            let contact = problem.contacts()[*contact as usize];
            assert_eq!(subdomain.grains[*i as usize], contact.candidate);
            assert_eq!(j.map(|j| subdomain.grains[j as usize]), contact.antagonist);
        }
        for grain in &subdomain.grains {
            let grain = *grain as usize;
            mass[grain] += problem.mass()[grain] / f64::from(decomposition.multiplicity[grain]);
        }
    }
    for (grain, (copies, whole)) in mass.iter().zip(problem.mass()).enumerate() {
        let touched = decomposition.multiplicity[grain] > 0;
        assert!(!touched || (copies / whole - 1.0).abs() < 1e-14, "grain {grain}: {copies} of {whole} kg");
    }
}

#[test]
fn partitions_of_packings_hold_every_contact_once_and_the_whole_mass() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for grid in GRIDS {
            for scheme in [Scheme::Boxes, Scheme::Balanced] {
                assert_is_a_partition(&problem, &Partition::of_contacts(&problem, scheme, grid).unwrap());
            }
        }
    }
}

#[test]
fn balanced_subdomains_differ_by_one_contact() {
    let problem = frozen("shear-box-991-sheared").problem;
    let partition = Partition::of_contacts(&problem, Scheme::Balanced, Grid::of(4, 2)).unwrap();
    let count = |e: u32| partition.subdomain.iter().filter(|other| **other == e).count();
    let counts: Vec<usize> = (0..8).map(count).collect();
    assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{counts:?}");
}

/// 1e16 + 1 − 1e16 is 0 or 1, as it is added up.
#[test]
fn every_copy_gets_the_sum_over_all_copies_in_the_order_of_the_subdomains() {
    let problem = frozen("shear-box-991-sheared").problem;
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, Grid::of(5, 5)).unwrap();
    let decomposition = Decomposition::new(&problem, &partition);
    let part = |e: u32, grain: u32| [1e16, 1.0, -1e16][(e + grain) as usize % 3] * f64::from(1 + grain);
    let mut expected = vec![0.0; problem.grain_count()];
    for (e, subdomain) in (0_u32..).zip(&decomposition.subdomains) {
        subdomain.grains.iter().for_each(|grain| expected[*grain as usize] += part(e, *grain));
    }
    let mut subdomains: Vec<_> = (0_u32..).zip(&decomposition.subdomains).collect();
    let mut sums = CopySums::new(&decomposition);
    sums.send(&mut subdomains, 0, |(e, subdomain), sent| {
        subdomain.boundary_grains().zip(sent).for_each(|(grain, sent)| *sent = part(*e, grain));
    });
    sums.receive(&mut subdomains, 0, |(_, subdomain), sums| {
        let sums: Vec<f64> = sums.collect();
        assert_eq!(sums.len(), subdomain.boundary.len());
        let expected = subdomain.boundary_grains().map(|grain| expected[grain as usize]);
        assert!(expected.eq(sums.iter().copied()), "{sums:?}");
    });
}

/// A subdomain with the velocities of its grains, and the greatest |V_E − V̄| of its copies.
type Moving<'d> = (&'d Subdomain, Vec<Vector2<f64>>, f64);

/// Gluing, eq. (3): V̄ = Σ_E V_E/m_i, by the sums of V_E and of 1 over the copies. Returns the greatest |V_E − V̄|.
fn glue(sums: &mut CopySums<Vector3<f64>>, subdomains: &mut [Moving]) -> f64 {
    sums.send(subdomains, 0, |(e, velocity, _), sent| {
        for (local, sent) in e.boundary.iter().zip(sent) {
            *sent = velocity[*local as usize].push(1.0);
        }
    });
    sums.receive(subdomains, 0, |(e, velocity, jump), sums| {
        *jump = 0.0;
        for (local, sum) in e.boundary.iter().zip(sums) {
            let (v, mean) = (&mut velocity[*local as usize], sum.xy() / sum.z);
            *jump = jump.max((*v - mean).norm());
            *v = mean;
        }
    });
    subdomains.iter().map(|(_, _, jump)| *jump).fold(0.0, f64::max)
}

/// From V̄ = `V_free` + M⁻¹ H r, each copy takes the change of its own subdomain's impulses on its share of the mass.
#[test]
fn glued_copies_move_at_the_velocity_of_the_whole_problem() {
    let problem = frozen("shear-box-991-sheared").problem;
    let n = problem.contact_count();
    let r: Vec<f64> = (0..n).map(|k| (k as f64).sin().abs()).collect();
    let change: Vec<f64> = (0..n).map(|k| (1.7 * k as f64).cos()).collect();
    let sum: Vec<f64> = r.iter().zip(&change).map(|(r, dr)| r + dr).collect();
    let (mut before, mut after) =
        (vec![Vector2::zeros(); problem.grain_count()], vec![Vector2::zeros(); problem.grain_count()]);
    problem.velocity(&r, &mut before);
    problem.velocity(&sum, &mut after);

    let partition = Partition::of_contacts(&problem, Scheme::Boxes, Grid::of(5, 5)).unwrap();
    let decomposition = Decomposition::new(&problem, &partition);
    assert!(*decomposition.multiplicity.iter().max().unwrap() >= 3, "the cut has corners");
    let mut velocity: Vec<Vec<Vector2<f64>>> = decomposition
        .subdomains
        .iter()
        .map(|e| e.grains.iter().map(|grain| before[*grain as usize]).collect())
        .collect();
    for (e, velocity) in decomposition.subdomains.iter().zip(&mut velocity) {
        let inverse_mass = |local: u32| {
            let grain = e.grains[local as usize] as usize;
            f64::from(decomposition.multiplicity[grain]) / problem.mass()[grain]
        };
        for (k, contact) in e.contacts.iter().enumerate() {
            let impulse = problem.contacts()[*contact as usize].normal * change[*contact as usize];
            let (i, j) = e.ends[k];
            velocity[i as usize] += impulse * inverse_mass(i);
            if let Some(j) = j {
                velocity[j as usize] -= impulse * inverse_mass(j);
            }
        }
    }
    let subdomains = decomposition.subdomains.iter().zip(velocity);
    let mut subdomains: Vec<Moving> = subdomains.map(|(e, velocity)| (e, velocity, 0.0)).collect();
    let mut sums = CopySums::new(&decomposition);
    let jump = glue(&mut sums, &mut subdomains);
    assert!(jump > 0.1, "there was something to glue: {jump} m/s");
    for (e, velocity, _) in &subdomains {
        for (grain, v) in e.grains.iter().zip(velocity) {
            // Velocities are of the order of 1 m/s.
            assert!((v - after[*grain as usize]).norm() < 1e-13);
        }
    }
    assert!(glue(&mut sums, &mut subdomains) < 1e-15, "what is glued stays");
}

/// The copies are not seen from outside; but a run that is started afresh from the impulses, hence from
/// `V_free` + M⁻¹ H r, must go on as one that was glued into the same state.
#[test]
fn critical_path_is_that_of_the_longest_subdomain() {
    let problem = frozen("settled-250").problem;
    let path = |solver: &dyn Solver| start(solver, &problem).critical_path();
    let by_grid = |subdomains| path(&NsgsDd { subdomains, ..NsgsDd::default() }).unwrap();
    // Eight multiply-adds per contact; one subdomain has no copies.
    assert_eq!(by_grid(Grid::ONE), 8 * problem.contact_count() as u64);
    assert!(by_grid(Grid::of(4, 2)) < by_grid(Grid::ONE) / 4);
    assert_eq!(path(&Nsgs::default()), None, "no subdomains");
}

#[test]
fn a_run_goes_on_as_one_that_starts_from_its_impulses() {
    let problem = frozen("shear-box-991-sheared").problem;
    for exchange in [Exchange::Jacobi, Exchange::GaussSeidel] {
        for mass_splitting in [true, false] {
            let settings = NsgsDd {
                subdomains: Grid::of(5, 5),
                exchange,
                mass_splitting,
                inner_sweeps: 2,
                ..NsgsDd::default()
            };
            let mut run = start(&settings, &problem);
            (0..20).for_each(|_| run.advance());
            let mut fresh = settings.start(&problem, &impulses(&*run, &problem)).unwrap();
            run.advance();
            fresh.advance();
            let difference = difference(&impulses(&*run, &problem), &impulses(&*fresh, &problem));
            assert!(difference < 1e-12, "{exchange:?}, splitting {mass_splitting}: {difference}");
            assert!(run.velocity_jump() > 0.0);

            let partition =
                Partition::of_contacts(&problem, settings.partition, settings.subdomains).unwrap();
            let copies = Decomposition::new(&problem, &partition).copy_count() as u64;
            let work = run.work();
            assert_eq!(work.interface_values, 21 * 2 * copies);
            assert_eq!(work.contact_updates, 21 * 2 * problem.contact_count() as u64);
        }
    }
}

#[test]
fn split_masses_never_increase_the_energy_of_packings() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for subdomains in &GRIDS[1..] {
            for inner_sweeps in [1, 2, 5] {
                let settings = NsgsDd { subdomains: *subdomains, inner_sweeps, ..NsgsDd::default() };
                let what = format!("{name}, {subdomains}, {inner_sweeps} inner sweeps");
                assert_never_increases(&energies(&settings, &problem, 60), &what);
            }
        }
    }
}

proptest! {
    #[test]
    fn partitions_of_any_problem_hold_every_contact_once_and_the_whole_mass(problem in any_problem()) {
        for grid in GRIDS.into_iter().filter(|grid| fits(&problem, *grid)) {
            for scheme in [Scheme::Boxes, Scheme::Balanced] {
                assert_is_a_partition(&problem, &Partition::of_contacts(&problem, scheme, grid).unwrap());
            }
        }
    }

    #[test]
    fn split_masses_never_increase_the_energy_of_any_problem(
        problem in any_problem(),
        inner_sweeps in prop::sample::select(vec![1_u32, 2, 5]),
        relaxation in 0.1..1.95_f64,
        gauss_seidel: bool,
    ) {
        let exchange = if gauss_seidel { Exchange::GaussSeidel } else { Exchange::Jacobi };
        for subdomains in GRIDS.into_iter().filter(|grid| fits(&problem, *grid)) {
            for partition in [Scheme::Boxes, Scheme::Balanced] {
                let settings = NsgsDd {
                    subdomains,
                    partition,
                    inner_sweeps,
                    relaxation,
                    exchange,
                    mass_splitting: true,
                ..NsgsDd::default()
            };
                assert_never_increases(&energies(&settings, &problem, 40), &format!("{settings:?}"));
            }
        }
    }

    /// And so Λ ≥ λmax(W): a step of 2/λmax or more is no descent on some problem.
    #[test]
    fn gradient_never_increases_the_energy_of_any_problem(problem in any_problem(), step in 0.1..1.99_f64) {
        let settings = Gradient { step };
        assert_never_increases(&energies(&settings, &problem, 40), &format!("{settings:?}"));
    }

    #[test]
    fn nsgs_never_increases_the_energy_of_any_problem(
        problem in any_problem(),
        relaxation in 0.1..1.95_f64,
        seed: u64,
        symmetric: bool,
    ) {
        for order in [Order::Natural, Order::BottomUp, Order::Shuffled, Order::Coloured] {
            let settings = Nsgs { order, seed, relaxation, symmetric, ..Nsgs::default() };
            assert_never_increases(&energies(&settings, &problem, 40), &format!("{settings:?}"));
        }
    }
}
