//! Results of any number of ranks are bitwise identical to those of one machine.
#![allow(clippy::unwrap_used)]

use crate::{simulated, whole};
use analysis::Proof;
use cases::{AnyFrozen, Frozen};
use cg::Cg;
use contact::acceleration::Acceleration;
use contact::{Contact, Discs, Measures, Mechanics, Packing, Place, RoughDiscs, Vector};
use latin_dd::LatinDd;
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Decomposition, Distributed, Grid, Partition, Scheme, Share, Team};
use runner::{Beside, Measured, OnRanks, Outcome, Status, Stop, solve, solve_on_ranks};
use std::ops::ControlFlow;
use std::path::Path;

const GRID: Grid = Grid::of(4, 2);
const SIZES: [usize; 4] = [1, 2, 3, 8];

fn frozen(name: &str) -> AnyFrozen {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen");
    AnyFrozen::read(&folder.join(name).with_extension("json")).unwrap_or_else(|error| panic!("{error}"))
}

fn discs(name: &str) -> Packing {
    frozen(name).of().expect("a problem without friction").problem
}

fn rough(name: &str) -> Packing<RoughDiscs> {
    frozen(name).of().expect("a problem with friction").problem
}

/// A run on so many ranks from r = 0: what came out, with the impulses of all.
fn on_ranks<M: Mechanics + analysis::Bounded>(
    problem: &Packing<M>,
    solver: &dyn Distributed<M>,
    cut: (Grid, usize),
    stop: &Stop,
) -> Outcome {
    let r0 = vec![0.0; problem.impulse_count()];
    on_ranks_beside(problem, solver, cut, Beside { start: &r0, solutions: &[] }, stop).unwrap().outcome
}

/// Runs ranks from a start and beside solutions, all of the whole problem.
fn on_ranks_beside<M: Mechanics + analysis::Bounded>(
    problem: &Packing<M>,
    solver: &dyn Distributed<M>,
    (grid, size): (Grid, usize),
    Beside { start, solutions }: Beside<'_>,
    stop: &Stop,
) -> Result<OnRanks, String> {
    let partition = Partition::of_contacts(problem, Scheme::Boxes, grid).unwrap();
    let decomposition = Decomposition::new(problem, &partition);
    let whole = whole(problem, grid, Scheme::Boxes);
    let mut of_ranks = simulated(size, |post| {
        let team = Team::new(post, decomposition.subdomains.len()).unwrap();
        let share = Share::of_rank(problem, &decomposition, &team, whole).unwrap();
        let own = |r: &[f64]| {
            let mut own = vec![0.0; share.problem.impulse_count()];
            for (k, contact) in share.contacts.iter().enumerate() {
                M::Impulse::at(r, *contact as usize).put(&mut own, k);
            }
            own
        };
        let (start, solutions) = (own(start), solutions.iter().map(|r| own(r)).collect::<Vec<_>>());
        let beside = Beside { start: &start, solutions: &solutions };
        let go_on = &mut |_: &runner::Progress| ControlFlow::Continue(());
        let end = solve_on_ranks(solver, &share, &team, beside, stop, Measured::Needed, go_on);
        end.map(|end| (share.contacts, end)).map_err(|refused| refused.to_string())
    })
    .into_iter()
    .collect::<Result<Vec<_>, _>>()?;
    let mut impulses = vec![f64::NAN; problem.impulse_count()];
    for (contacts, end) in &of_ranks {
        for (k, contact) in contacts.iter().enumerate() {
            M::Impulse::at(&end.outcome.impulses, k).put(&mut impulses, *contact as usize);
        }
    }
    assert!(impulses.iter().all(|r| r.is_finite()), "each contact is of a rank");
    let ended = |end: &Outcome| (end.status, end.iterations, bits(&end.measures));
    let ends: Vec<_> = of_ranks.iter().map(|(_, end)| ended(&end.outcome)).collect();
    assert!(ends.iter().all(|end| *end == ends[0]), "all ranks say the same: {ends:?}");
    let (_, end) = of_ranks.remove(0);
    Ok(OnRanks { outcome: Outcome { impulses, ..end.outcome }, ..end })
}

fn bits(measures: &Measures) -> Vec<u64> {
    let Measures { zeta, natural_map, penetration_rate, quad_dv, max_dv, velocity_jump, energy, .. } =
        *measures;
    let Measures { velocity_error, energy_gap, .. } = *measures;
    let of_iterate = [zeta, natural_map, penetration_rate, quad_dv, max_dv, velocity_jump, energy];
    of_iterate.into_iter().chain([velocity_error, energy_gap]).map(f64::to_bits).collect()
}

fn close(found: f64, expected: f64) -> bool {
    found == expected || (found - expected).abs() <= 1e-9 * expected.abs()
}

/// The run on each number of ranks beside that on one machine, and on one rank.
fn as_on_one_machine<M: Mechanics + analysis::Bounded>(
    problem: &Packing<M>,
    solver: &dyn Distributed<M>,
    name: &str,
    same_bits: bool,
) {
    let stop = Stop { tolerance: 0.0, max_iterations: 45, ..Stop::default() };
    let r0 = vec![0.0; problem.impulse_count()];
    let alone = solve(solver, problem, &r0, &stop, &mut |_| {}).unwrap();
    let first = on_ranks(problem, solver, (GRID, 1), &stop);
    for size in SIZES {
        let beside = Beside { start: &r0, solutions: &[] };
        let OnRanks { outcome: end, traffic, .. } =
            on_ranks_beside(problem, solver, (GRID, size), beside, &stop).unwrap();
        assert!(end.impulses == first.impulses, "{name}, {size} ranks: impulses have other bits");
        assert_eq!(bits(&end.measures), bits(&first.measures), "{name}, {size} ranks");
        assert_eq!((end.work, end.critical_path), (first.work, first.critical_path), "{name}, {size} ranks");
        let messages: u64 = traffic.iter().map(|traffic| traffic.messages).sum();
        assert_eq!(messages > 0, size > 1, "{name}, {size} ranks: {messages} messages");
    }
    if same_bits {
        assert!(alone.impulses == first.impulses, "{name}: other bits than on one machine");
        assert_eq!((alone.work, alone.critical_path), (first.work, first.critical_path), "{name}");
        assert_eq!(alone.derived, first.derived, "{name}");
        let (found, expected) = (first.measures, alone.measures);
        for (measure, found, expected) in [
            ("natural map", found.natural_map, expected.natural_map),
            ("zeta", found.zeta, expected.zeta),
            ("penetration rate", found.penetration_rate, expected.penetration_rate),
            ("quad_dv", found.quad_dv, expected.quad_dv),
            ("max_dv", found.max_dv, expected.max_dv),
            ("velocity jump", found.velocity_jump, expected.velocity_jump),
            ("energy", found.energy, expected.energy),
        ] {
            assert!(close(found, expected), "{name}: {measure} {found:e} instead of {expected:e}");
        }
        assert_eq!(found.worst_contact, expected.worst_contact, "{name}");
    }
}

mod beside;

#[test]
fn sweeps_have_the_bits_of_one_machine() {
    let default = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
    let (smooth, rough) = (discs("shear-box-991-sheared"), rough("rough-991-mu08"));
    for (name, settings) in [
        ("jacobi", default),
        ("gauss-seidel", NsgsDd { exchange: Exchange::GaussSeidel, ..default }),
        ("schwarz", NsgsDd { mass_splitting: false, relaxation: 0.5, ..default }),
        ("three sweeps", NsgsDd { inner_sweeps: 3, ..default }),
        ("accelerated", NsgsDd { acceleration: Acceleration::Nesterov, ..default }),
    ] {
        as_on_one_machine::<Discs>(&smooth, &settings, name, true);
        as_on_one_machine(&rough, &settings, name, true);
    }
}

#[test]
fn latin_has_the_bits_of_one_machine() {
    let default = LatinDd { subdomains: GRID, ..LatinDd::default() };
    let (smooth, rough) = (discs("shear-box-991-sheared"), rough("rough-991-mu08"));
    for (name, settings) in [
        ("kept", LatinDd { kappa_l: Some(30.0), ..default }),
        ("derived", LatinDd { adaptive: Some(false), ..default }),
        // Directions turn at iterations 20 and 40.
        ("adapted", default),
        ("coarse", LatinDd { coarse: true, ..default }),
    ] {
        as_on_one_machine::<Discs>(&smooth, &settings, name, true);
        as_on_one_machine(&rough, &settings, name, true);
    }
}

/// Boxes on a bounding box may be empty, and so may be all that a rank has.
#[test]
fn ranks_may_have_nothing_to_do() {
    let (problem, grid) = (discs("settled-60"), Grid::of(10, 12));
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
    assert!((0..120).any(|e| !partition.subdomain.contains(&e)), "no box is empty");
    let stop = Stop { tolerance: 0.0, max_iterations: 45, ..Stop::default() };
    let r0 = vec![0.0; problem.contact_count()];
    let nsgs = NsgsDd { subdomains: grid, exchange: Exchange::GaussSeidel, ..NsgsDd::default() };
    let latin = LatinDd { subdomains: grid, coarse: true, ..LatinDd::default() };
    for solver in [&nsgs as &dyn Distributed<Discs>, &latin] {
        let alone = solve(solver, &problem, &r0, &stop, &mut |_| {}).unwrap();
        for size in [1, 7, 120] {
            assert!(
                on_ranks(&problem, solver, (grid, size), &stop).impulses == alone.impulses,
                "{size} ranks"
            );
        }
    }
    let of_cg =
        [1, 120].map(|size| on_ranks::<Discs>(&problem, &Cg::default(), (grid, size), &stop).impulses);
    assert!(of_cg[0] == of_cg[1]);
}

/// On one machine its blocks are others.
#[test]
fn conjugate_gradients_have_the_same_bits_on_any_number_of_ranks() {
    for preconditioner in [cg::Preconditioner::None, cg::Preconditioner::Diagonal] {
        as_on_one_machine::<Discs>(
            &discs("shear-box-991-sheared"),
            &Cg { preconditioner, ..Cg::default() },
            "cg",
            false,
        );
        as_on_one_machine(
            &rough("rough-991-mu08"),
            &Cg { preconditioner, ..Cg::default() },
            "cg with friction",
            false,
        );
    }
}

#[test]
fn ranks_stop_where_one_machine_does() {
    let problem = discs("settled-991");
    let r0 = vec![0.0; problem.contact_count()];
    let stop = Stop { tolerance: 1e-4, ..Stop::default() };
    let latin = LatinDd { subdomains: GRID, ..LatinDd::default() };
    let alone = solve(&latin, &problem, &r0, &stop, &mut |_| {}).unwrap();
    for size in SIZES {
        let end = on_ranks::<Discs>(&problem, &latin, (GRID, size), &stop);
        assert_eq!((end.status, end.iterations), (Status::Converged, alone.iterations));
        assert!(end.impulses == alone.impulses);
    }
    let cg = Cg::preconditioned();
    for size in SIZES {
        assert_eq!(on_ranks::<Discs>(&problem, &cg, (GRID, size), &stop).status, Status::Converged);
    }
}

#[test]
fn what_stops_a_run_at_one_rank_stops_it_at_all() {
    let problem = discs("settled-991");
    let decomposition =
        Decomposition::new(&problem, &Partition::of_contacts(&problem, Scheme::Boxes, GRID).unwrap());
    let whole = whole(&problem, GRID, Scheme::Boxes);
    let ends = simulated(4, |post| {
        let team = Team::new(post, 8).unwrap();
        let share = Share::of_rank(&problem, &decomposition, &team, whole).unwrap();
        let nsgs = NsgsDd { subdomains: GRID, ..NsgsDd::default() };
        let observe = &mut |progress: &runner::Progress| {
            let presses = team.rank() == 2 && progress.iteration == 7;
            if presses { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let r0 = vec![0.0; share.problem.impulse_count()];
        let beside = Beside { start: &r0, solutions: &[] };
        solve_on_ranks(&nsgs, &share, &team, beside, &Stop::default(), Measured::Needed, observe).unwrap()
    });
    assert!(ends.iter().all(|end| (end.outcome.status, end.outcome.iterations) == (Status::Interrupted, 7)));
}

#[test]
fn a_reason_of_one_rank_is_the_reason_of_all() {
    for size in [2, 5, 8] {
        let reasons = simulated(size, |post| {
            let team = Team::new(post, 9).unwrap();
            let fails = team.rank() >= size - 1;
            team.agree(if fails { Err("no such file: «ö»".to_owned()) } else { Ok(()) })
        });
        let expected = format!("rank {}: no such file: «ö»", size - 1);
        assert!(reasons.iter().all(|reason| reason.as_ref().unwrap_err() == &expected), "{reasons:?}");
    }
}

/// (1e16 + 1) − 1e16 is 0, and 1e16 − 1e16 + 1 is 1: the order shows.
#[test]
fn sums_go_along_one_tree_whatever_the_ranks() {
    let value = |e: usize| [[1e16, 1.0, -1e16, 3.0, 0.1][e % 5], e as f64];
    for subdomains in 1..20 {
        let expected = tree(&(0..subdomains).map(value).collect::<Vec<_>>());
        for size in 1..=subdomains {
            let sums = simulated(size, |post| {
                let team = Team::new(post, subdomains).unwrap();
                let lists = team.gather(&vec![team.rank() as f64; team.rank()]);
                assert!(lists.iter().enumerate().all(|(rank, list)| *list == vec![rank as f64; rank]));
                let turns = team.in_turn(vec![0.0], |state| state[0] = 2.0 * state[0] + 1.0);
                assert_eq!(turns, [((1_u64 << size) - 1) as f64]);
                assert_eq!(team.max(team.rank() as f64), (size - 1) as f64);
                assert_eq!(team.min(1.0 + team.rank() as f64), 1.0);
                assert!(!team.all(team.rank() < size - 1));
                assert_eq!(team.count(1), size as u64);
                team.sum(team.mine().map(value))
            });
            assert!(sums.iter().all(|sum| *sum == expected), "{subdomains} subdomains, {size} ranks");
        }
    }
}

#[test]
fn lists_go_to_the_subdomains_beside() {
    // Subdomain e tells the one before it e times its number, and the one after it e + 1 times the negative.
    let told = |e: usize| [vec![e as f64; e], vec![-(e as f64); e + 1]];
    for subdomains in 1..7 {
        for size in 1..=subdomains {
            let heard = simulated(size, |post| {
                let team = Team::new(post, subdomains).unwrap();
                team.from_beside(&team.mine().map(told).collect::<Vec<_>>())
            });
            for (e, [before, after]) in heard.into_iter().flatten().enumerate() {
                assert_eq!(before, e.checked_sub(1).map_or(Vec::new(), |e| told(e)[1].clone()));
                assert_eq!(after, if e + 1 < subdomains { told(e + 1)[0].clone() } else { Vec::new() });
            }
        }
    }
}

fn tree(values: &[[f64; 2]]) -> [f64; 2] {
    if let [value] = values {
        return *value;
    }
    let (lower, higher) = values.split_at(values.len().next_power_of_two() / 2);
    let (a, b) = (tree(lower), tree(higher));
    [a[0] + b[0], a[1] + b[1]]
}

/// A disc between two walls that close, among others: the proof is found on ranks as on one machine.
#[test]
fn ranks_prove_together_that_there_is_no_solution() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/hard/infeasible-c.json");
    let problem = Frozen::<Discs>::read(&path).unwrap().problem;
    let grid = Grid::of(2, 1);
    let r0 = vec![0.0; problem.contact_count()];
    let nsgs = NsgsDd { subdomains: grid, ..NsgsDd::default() };
    let stop = Stop { tolerance: 1e-10, ..Stop::default() };
    let alone = solve(&nsgs, &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!(alone.status, Status::Infeasible);
    // What is left of the ray is near round-off, so one machine may find the proof a look later.
    let ends = [1, 2].map(|size| on_ranks::<Discs>(&problem, &nsgs, (grid, size), &stop));
    for end in &ends {
        assert_eq!((end.status, end.iterations), (alone.status, ends[0].iterations));
        assert!(end.iterations.is_power_of_two() && end.iterations <= alone.iterations);
    }
}

/// Discs that walls hold at rest, and one between walls that close: 100,002 contacts act, and two of them prove it.
#[test]
fn ranks_prove_it_where_more_contacts_act_than_each_is_told_of() {
    const GRAINS: u32 = 50_001;
    let at = |x: f64| Place::of([x, 0.0, 0.0]);
    let between = |grain: u32| {
        let offset = if grain == 0 { -1.0 } else { 0.0 };
        [1.0, -1.0].map(|x| Contact { candidate: grain, antagonist: None, normal: at(x), offset })
    };
    let (mass, still) = (vec![1.0; GRAINS as usize], vec![at(0.0); GRAINS as usize]);
    let position = (0..GRAINS).map(|grain| at(f64::from(grain))).collect();
    let problem: Packing =
        Packing::new(mass, position, still, (0..GRAINS).flat_map(between).collect()).unwrap();
    let grid = Grid::of(2, 1);
    let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
    let decomposition = Decomposition::new(&problem, &partition);
    let whole = whole(&problem, grid, Scheme::Boxes);
    for size in [1, 2] {
        let proved = simulated(size, |post| {
            let team = Team::new(post, 2).unwrap();
            let share = Share::of_rank(&problem, &decomposition, &team, whole).unwrap();
            let ray = share.contacts.iter().map(|contact| if *contact < 2 { 1.0 } else { 1e-5 }).collect();
            let mut proof = Proof::of(&share, &team);
            proof.any_proves_infeasible(&[ray])
        });
        assert_eq!(proved, vec![true; size]);
    }
}

#[test]
fn no_rank_holds_more_than_its_contacts_and_their_grains() {
    let problem = discs("shear-box-991-sheared");
    let grid = Grid::of(4, 4);
    let decomposition =
        Decomposition::new(&problem, &Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap());
    let whole = whole(&problem, grid, Scheme::Boxes);
    let held = simulated(8, |post| {
        let team = Team::new(post, 16).unwrap();
        let share = Share::of_rank(&problem, &decomposition, &team, whole).unwrap();
        let own = &decomposition.subdomains[team.mine()];
        assert_eq!(share.problem.contact_count(), own.iter().map(|e| e.contacts.len()).sum::<usize>());
        let shared: usize = share.decomposition.boundary.len();
        assert!(share.problem.grain_count() <= own.iter().map(|e| e.grains.len()).sum());
        (share.problem.contact_count(), share.problem.grain_count(), shared)
    });
    let contacts: usize = held.iter().map(|held| held.0).sum();
    assert_eq!(contacts, problem.contact_count(), "each contact is held once");
    let twice: usize = held.iter().map(|held| held.1).sum::<usize>() - problem.grain_count();
    let shared: usize = held.iter().map(|held| held.2).sum();
    assert!(twice <= shared, "what is held more than once, {twice} grains, are boundary grains, {shared}");
    assert!(held.iter().all(|held| held.0 < problem.contact_count() / 3), "{held:?}");
}

#[test]
fn more_ranks_than_subdomains_are_refused() {
    let error = simulated(9, |post| Team::new(post, 8).err().map(|error| error.to_string()));
    assert_eq!(error[0].as_deref(), Some("`ranks` is 9: it must be at most 8, the number of subdomains"));
}
