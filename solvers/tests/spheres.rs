//! Spheres: what the plane gives in space, and what is known of packings in space.

use crate::problems::{PACKINGS, frozen};
use active_set::ActiveSet;
use analysis::Meter;
use apgd::Apgd;
use cases::{Case, March, Marched};
use cg::Cg;
use contact::{Contact, Discs, Iteration, Measure, Packing, Solver, Spheres, Truth, Vector, Work};
use gradient::Gradient;
use jacobi::Jacobi;
use latin_dd::LatinDd;
use mprgp::Mprgp;
use nalgebra::Vector3;
use newton_schur::{Interface, NewtonSchur};
use nncg::Nncg;
use nsgs::{Nsgs, Order};
use nsgs_dd::{Exchange, NsgsDd};
use partition::{Grid, Partition, Scheme};
use reference::{Answer, InteriorPoint, certify};
use runner::{Status, Stop, solve};
use std::path::Path;

/// A problem of the plane, laid into space.
fn embedded(problem: &Packing) -> Packing<Spheres> {
    let lay = |v: &nalgebra::Vector2<f64>| Vector3::new(v.x, v.y, 0.0);
    let contact = |at: &Contact| Contact {
        candidate: at.candidate,
        antagonist: at.antagonist,
        normal: lay(&at.normal),
        offset: at.offset,
    };
    Packing::new(
        problem.mass().to_vec(),
        problem.position().iter().map(lay).collect(),
        problem.free_velocity().iter().map(lay).collect(),
        problem.contacts().iter().map(contact).collect(),
    )
    .unwrap()
}

/// The contact problem of a case at a time step, marched to by conjugate gradients.
fn sphere_problem(case: &str, overrides: &[(&str, &str)], time_step: u64) -> Packing<Spheres> {
    let cg = Cg::preconditioned();
    marched_to(case, overrides, time_step, &cg, &Stop::default())
}

/// The contact problem of a case at a time step, marched to by a method.
pub(crate) fn marched_to<M: Marched>(
    case: &str,
    overrides: &[(&str, &str)],
    time_step: u64,
    method: &dyn Solver<M>,
    stop: &Stop,
) -> Packing<M> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(case).with_extension("toml");
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    let case = Case::read(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let mut march = March::<M>::new(&case).unwrap();
    for _ in 1..time_step {
        march.time_step(method, stop).unwrap();
    }
    march.next().unwrap().frozen.problem
}

/// The problem of a case at a time step, with the radius of each sphere (m).
pub(crate) fn sphere_problem_of(case: &str, time_step: u64) -> (Packing<Spheres>, Vec<f64>) {
    let problem = sphere_problem(case, &[], time_step);
    // m = 4/3 π ρ R³
    let radius = |m: &f64| (m / 2600.0 * 0.75 / std::f64::consts::PI).cbrt();
    let radii = problem.mass().iter().map(radius).collect();
    (problem, radii)
}

/// A multiply-add takes 0.1 ns, a sweep 4 ns at a contact; sweeps reach 1e-6 sooner than the time of a factor has passed.
#[test]
fn no_factor_is_made_before_sweeps_have_taken_its_time() {
    let size = [("sample.grains", "2000"), ("scene.box.width_m", "2.5"), ("scene.box.depth_m", "2.5")];
    let problem = sphere_problem("sphere-box", &size, 1);
    let r0 = vec![0.0; problem.contact_count()];
    let stop = Stop { on: Measure::NaturalMap, tolerance: 1e-6, max_iterations: 1000 };
    let outcome = solve(&ActiveSet::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
    assert_eq!((outcome.status, outcome.work.factorisations), (Status::Converged, 0));
    let mut run = ActiveSet::default().start(&problem, &r0).unwrap();
    while run.work().factorisations == 0 {
        run.advance();
    }
    let Work { contact_updates, factorisation_multiply_adds, .. } = run.work();
    assert!(0.1 * factorisation_multiply_adds as f64 <= 4.0 * contact_updates as f64);
}

#[test]
fn newton_by_subdomains_ends_certified_between_spheres() {
    let problem = sphere_problem("sphere-box", &[], 1);
    let subdomains = Grid { nx: 2, ny: 2, nz: 2 };
    for interface in [Interface::Direct, Interface::Cg] {
        let method = NewtonSchur { subdomains, interface, ..NewtonSchur::default() };
        let mut r = vec![0.0; problem.contact_count()];
        let mut run = method.start(&problem, &r).unwrap();
        for _ in 0..2000 {
            run.advance();
        }
        assert!(run.stalled() && run.work().factorisations > 8, "{interface:?}");
        run.impulses(&mut r);
        let certificate = certify(&problem, &r);
        assert!(certificate.certified(), "{interface:?}: {certificate}");
    }
}

/// Advances two runs from impulses of these lengths, and shows the impulses of both after each of some iterations.
pub(crate) fn in_step(
    mut runs: [Box<dyn Iteration + '_>; 2],
    lengths: [&[f64]; 2],
    iterations: u32,
    mut compare: impl FnMut(u32, &[f64], &[f64]),
) {
    let [mut r, mut s] = lengths.map(<[f64]>::to_vec);
    for iteration in 1..=iterations {
        for run in &mut runs {
            run.advance();
        }
        runs[0].impulses(&mut r);
        runs[1].impulses(&mut s);
        compare(iteration, &r, &s);
    }
}

/// The greatest difference of two lists of impulses (N·s).
fn apart(r: &[f64], s: &[f64]) -> f64 {
    r.iter().zip(s).map(|(r, s)| (r - s).abs()).fold(0.0, f64::max)
}

type Both = (&'static str, Box<dyn Solver<Discs>>, Box<dyn Solver<Spheres>>);

fn methods() -> Vec<Both> {
    fn both<S: Solver<Discs> + Solver<Spheres> + Clone + 'static>(name: &'static str, method: S) -> Both {
        (name, Box::new(method.clone()), Box::new(method))
    }
    let grid = Grid::of(4, 2);
    vec![
        both("nsgs", Nsgs::default()),
        both("nsgs bottom-up", Nsgs { order: Order::BottomUp, symmetric: true, ..Nsgs::default() }),
        both("jacobi", Jacobi { bounded: true, ..Jacobi::default() }),
        both("nsgs-dd", NsgsDd { subdomains: grid, ..NsgsDd::default() }),
        both("nsgs-dd gs", NsgsDd { subdomains: grid, exchange: Exchange::GaussSeidel, ..NsgsDd::default() }),
        both("latin-dd", LatinDd { subdomains: grid, ..LatinDd::default() }),
        both("latin-dd coarse", LatinDd { subdomains: grid, coarse: true, ..LatinDd::default() }),
        both("cg", Cg::preconditioned()),
        both("gradient", Gradient::default()),
        both("apgd", Apgd::default()),
        both("mprgp", Mprgp::default()),
        both("nncg", Nncg::default()),
    ]
}

/// Nothing moves along z, so each iterate is that of the plane, for every method.
#[test]
fn layer_in_space_gives_the_iterates_of_the_plane() {
    for name in ["settled-250", PACKINGS[2]] {
        let flat = frozen(name).problem;
        let laid = embedded(&flat);
        let r0 = vec![0.0; flat.contact_count()];
        for (method, in_plane, in_space) in methods() {
            let (one, other) = (in_plane.start(&flat, &r0).unwrap(), in_space.start(&laid, &r0).unwrap());
            in_step([one, other], [&r0, &r0], 30, |iteration, r, s| {
                let greatest = r.iter().copied().fold(0.0, f64::max);
                assert!(
                    apart(r, s) < 1e-8 * greatest,
                    "{name}, {method}, iteration {iteration}: {}",
                    apart(r, s)
                );
            });
        }
    }
}

/// The measures of an embedded iterate are those of the plane.
#[test]
fn measures_in_space_are_those_of_the_plane() {
    let flat = frozen("settled-250").problem;
    let laid = embedded(&flat);
    let r: Vec<f64> = (0..flat.contact_count()).map(|k| f64::from(k as u32 % 7)).collect();
    let truth = |r: &[f64]| r.iter().map(|r| 0.5 * r).collect::<Vec<f64>>();
    let one = Meter::new(&flat).against(&Truth::new(&flat, &truth(&r))).measure(&r, 0.0);
    let other = Meter::new(&laid).against(&Truth::new(&laid, &truth(&r))).measure(&r, 0.0);
    for measure in [Measure::NaturalMap, Measure::PenetrationRate, Measure::QuadDv, Measure::VelocityError] {
        let (one, other) = (one.get(measure), other.get(measure));
        assert!((one - other).abs() <= 1e-12 * one.abs(), "{measure}: {one}, {other}");
    }
}

/// Two witnesses that share no line but the measures: both certified, with one velocity; every method comes to it.
#[test]
fn active_set_and_interior_point_agree_in_space() {
    for (case, overrides, time_step) in [
        ("sphere-box", &[("sample.grains", "250")][..], 60),
        ("sphere-shear-box", &[("sample.grains", "300"), ("scene.box.tilt_start_s", "0.2")], 60),
    ] {
        let problem = sphere_problem(case, overrides, time_step);
        let Answer::Solution { impulses, certificate } = reference::solve(&problem) else {
            panic!("{case} has no certified solution")
        };
        assert!(certificate.certified(), "{certificate}");
        let stop = Stop { tolerance: 1e-12, max_iterations: 2000, ..Stop::default() };
        let r0 = vec![0.0; problem.contact_count()];
        let truth = Truth::new(&problem, &impulses);
        let witness = solve(&InteriorPoint::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert!(certify(&problem, &witness.impulses).certified(), "{case}");
        let error =
            |r: &[f64]| Meter::new(&problem).against(&truth).measure_after(&[], r, 0.0).velocity_error;
        assert!(error(&witness.impulses) < 1e-9, "{case}: {}", error(&witness.impulses));
        let active = solve(&ActiveSet::default(), &problem, &r0, &stop, &mut |_| {}).unwrap();
        assert!(error(&active.impulses) < 1e-9, "{case}: {}", error(&active.impulses));
        let stop = Stop { tolerance: 1e-4, max_iterations: 20_000, ..Stop::default() };
        let cubes = Grid { nz: 2, ..Grid::of(2, 2) };
        let runs: [(&str, &dyn Solver<Spheres>); 5] = [
            ("nsgs", &Nsgs::default()),
            ("nsgs-dd", &NsgsDd { subdomains: cubes, ..NsgsDd::default() }),
            ("latin-dd", &LatinDd { subdomains: cubes, ..LatinDd::default() }),
            ("latin-dd coarse", &LatinDd { subdomains: cubes, coarse: true, ..LatinDd::default() }),
            ("cg", &Cg::preconditioned()),
        ];
        for (name, method) in runs {
            let outcome = solve(method, &problem, &r0, &stop, &mut |_| {}).unwrap();
            assert_eq!(outcome.status, Status::Converged, "{case}, {name}");
            assert!(error(&outcome.impulses) < 2e-2, "{case}, {name}: {}", error(&outcome.impulses));
        }
    }
}

/// q(r) never rises with split masses, over cubes of subdomains; and one subdomain is NSGS.
#[test]
fn subdomains_in_space_never_raise_the_energy() {
    let problem = sphere_problem("sphere-box", &[], 20);
    let r0 = vec![0.0; problem.contact_count()];
    for grid in [Grid { nz: 2, ..Grid::of(2, 2) }, Grid { nz: 3, ..Grid::of(3, 3) }] {
        let partition = Partition::of_contacts(&problem, Scheme::Boxes, grid).unwrap();
        assert_eq!(u64::from(partition.count), grid.count());
        let mut run = NsgsDd { subdomains: grid, ..NsgsDd::default() }.start(&problem, &r0).unwrap();
        let (mut meter, mut r, mut before) = (Meter::new(&problem), r0.clone(), 0.0_f64);
        for _ in 0..100 {
            run.advance();
            run.impulses(&mut r);
            let energy = meter.measure(&r, 0.0).energy;
            assert!(energy <= before + 1e-12 * before.abs(), "{grid}: {before} J, then {energy} J");
            before = energy;
        }
    }
    let one = NsgsDd::default().start(&problem, &r0).unwrap();
    let nsgs = Nsgs::default().start(&problem, &r0).unwrap();
    in_step([one, nsgs], [&r0, &r0], 20, |_, r, s| assert!(apart(r, s) < 1e-12, "{} N·s", apart(r, s)));
}

/// Layers are for space alone.
#[test]
fn layers_of_discs_are_refused() {
    let problem = frozen("settled-60").problem;
    let grid = Grid { nz: 2, ..Grid::of(2, 1) };
    let error = Partition::of_contacts(&problem, Scheme::Balanced, grid).unwrap_err().to_string();
    assert!(error.starts_with("`subdomains` is 2x1x2: it must be columns x rows"), "{error}");
    assert_eq!(<Spheres as contact::Mechanics>::Place::LEN, 3);
}
