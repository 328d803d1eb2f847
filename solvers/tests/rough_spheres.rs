//! Spheres with friction: what the plane gives in space, and what is known of one sphere.

use crate::friction::rough;
use crate::spheres::{in_step, marched_to, sphere_problem_of};
use active_set::Conic;
use analysis::Meter;
use cg::{Cg, Preconditioner};
use contact::acceleration::Acceleration;
use contact::{
    Contact, Packing, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Solver, Spheres, Truth, frame,
};
use jacobi::Jacobi;
use latin_dd::LatinDd;
use nalgebra::{Vector2, Vector3, Vector6};
use nsgs::Nsgs;
use nsgs_dd::NsgsDd;
use partition::Grid;
use reference::{Existence, existence};
use runner::{Status, Stop, solve};

/// A problem of the plane, laid into space: a disc becomes a body that spins about z as it does, and about the other axes alike.
pub(crate) fn embedded(problem: &Packing<RoughDiscs>) -> Packing<RoughSpheres> {
    let contact = |at: &RoughContact| {
        let normal = Vector3::new(at.normal.x, at.normal.y, 0.0);
        let tangent = Vector3::new(-at.normal.y, at.normal.x, 0.0);
        let [first, second] = frame(&normal).map(|t| t.dot(&tangent) * at.offset.y);
        RoughContact {
            candidate: at.candidate,
            antagonist: at.antagonist,
            normal,
            arms: at.arms,
            offset: Vector3::new(at.offset.x, first, second),
            friction: at.friction,
        }
    };
    Packing::new(
        problem.mass().to_vec(),
        problem.position().iter().map(|x| Vector3::new(x.x, x.y, 0.0)).collect(),
        problem.free_velocity().iter().map(|v| Vector6::new(v.x, v.y, 0.0, 0.0, 0.0, v.z)).collect(),
        problem.contacts().iter().map(contact).collect(),
    )
    .unwrap()
}

/// The methods that solve in both.
fn methods<M>() -> Vec<(&'static str, Box<dyn Solver<M>>)>
where
    M: contact::Mechanics,
    Nsgs: Solver<M>,
    Jacobi: Solver<M>,
    NsgsDd: Solver<M>,
    LatinDd: Solver<M>,
    Cg: Solver<M>,
{
    let grid = Grid::of(2, 2);
    vec![
        ("nsgs", Box::new(Nsgs::default())),
        ("jacobi", Box::new(Jacobi { relaxation: 0.3, ..Jacobi::default() })),
        ("cg", Box::new(Cg::preconditioned())),
        ("nsgs-dd", Box::new(NsgsDd { subdomains: grid, ..NsgsDd::default() })),
        ("latin-dd", Box::new(LatinDd { subdomains: grid, kappa_l: Some(3.0), ..LatinDd::default() })),
    ]
}

/// Normal impulses, and tangential ones along the tangent of the plane, are those of the plane; along z nothing acts.
#[test]
fn layer_with_friction_in_space_gives_the_iterates_of_the_plane() {
    let flat = rough("rough-250").problem;
    let laid = embedded(&flat);
    let (zeros, none) = (vec![0.0; flat.impulse_count()], vec![0.0; laid.impulse_count()]);
    for ((name, in_plane), (_, in_space)) in
        methods::<RoughDiscs>().into_iter().zip(methods::<RoughSpheres>())
    {
        let one = in_plane.start(&flat, &zeros).unwrap();
        let other = in_space.start(&laid, &none).unwrap();
        // A contact that stays at its cone keeps the direction of a small impulse, round-off and all, while this grows.
        let iterations = if name == "cg" { 2 } else { 20 };
        in_step([one, other], [&zeros, &none], iterations, |iteration, r, s| {
            let greatest = r.iter().copied().fold(0.0, f64::max);
            for (k, contact) in laid.contacts().iter().enumerate() {
                let (n, t) = (contact.normal, Vector3::new(-contact.normal.y, contact.normal.x, 0.0));
                let [first, second] = frame(&n);
                let along = first * s[3 * k + 1] + second * s[3 * k + 2];
                let apart = Vector3::new(s[3 * k] - r[2 * k], along.dot(&t) - r[2 * k + 1], along.z);
                assert!(apart.amax() < 1e-9 * greatest, "{name}, iteration {iteration}: {apart:?}");
            }
        });
    }
    let measures = |zeta: &[f64]| Meter::new(&flat).measure_after(&[], zeta, 0.0);
    let in_space = Meter::new(&laid).measure_after(&[], &none, 0.0);
    assert!((measures(&zeros).natural_map - in_space.natural_map).abs() < 1e-12);
}

#[test]
fn relaxation_of_a_layer_in_space_is_that_of_the_plane() {
    let flat = rough("rough-250").problem;
    let laid = embedded(&flat);
    assert_eq!([existence(&flat), existence(&laid)], [Some(Existence::AtRest); 2]);
    let driven = rough("rough-991-onset-unconverged").problem;
    assert_eq!([existence(&driven), existence(&embedded(&driven))], [Some(Existence::Moving); 2]);
    let [mut in_plane, mut in_space] = [vec![0.0; flat.impulse_count()], vec![0.0; laid.impulse_count()]];
    let (mut one, mut other) = (Conic::relaxation(&flat).unwrap(), Conic::relaxation(&laid).unwrap());
    assert!(one.advance() && other.advance());
    one.impulses(&mut in_plane);
    other.impulses(&mut in_space);
    let left = Meter::new(&flat).measure_after(&[], &in_plane, 0.0).natural_map;
    let left_in_space = Meter::new(&laid).measure_after(&[], &in_space, 0.0).natural_map;
    // The packing is at rest, where the relaxation is the law.
    assert!(left < 1e-5 && left_in_space < 1e-5, "{left:e}, {left_in_space:e}");
    let greatest = in_plane.iter().copied().fold(0.0, f64::max);
    for k in 0..flat.contact_count() {
        assert!((in_plane[2 * k] - in_space[3 * k]).abs() < 1e-3 * greatest, "contact {k}");
    }
}

/// Walls that begin to move make contacts slide around their cones: with all of u along the circle, in the place of the part that
/// projection leaves, conjugate gradients end at a natural map of 0.1 here.
#[test]
fn conjugate_gradients_solve_spheres_whose_walls_begin_to_move() {
    let side = "0.78";
    let overrides = [
        ("sample.grains", "60"),
        ("scene.box.width_m", side),
        ("scene.box.depth_m", side),
        ("scene.friction", "0.3"),
    ];
    let nsgs = Nsgs { acceleration: Acceleration::Nesterov, ..Nsgs::default() };
    let stop = Stop { tolerance: 1e-4, max_iterations: 2000, ..Stop::default() };
    let problem = marched_to::<RoughSpheres>("sphere-shear-box", &overrides, 303, &nsgs, &stop);
    for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
        let stop = Stop { tolerance: 1e-8, max_iterations: 5000, ..Stop::default() };
        let none = vec![0.0; problem.impulse_count()];
        let outcome =
            solve(&Cg { preconditioner, ..Cg::default() }, &problem, &none, &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{preconditioner:?}");
    }
}

/// The same spheres with friction.
pub(crate) fn roughened(smooth: &Packing<Spheres>, radius: &[f64], friction: f64) -> Packing<RoughSpheres> {
    let contact = |at: &Contact<3>| RoughContact {
        candidate: at.candidate,
        antagonist: at.antagonist,
        normal: at.normal,
        arms: Vector2::new(radius[at.candidate as usize], at.antagonist.map_or(0.0, |j| radius[j as usize])),
        offset: Vector3::new(at.offset, 0.0, 0.0),
        friction,
    };
    Packing::new(
        smooth
            .mass()
            .iter()
            .zip(radius)
            .map(|(m, r)| RoughMass { mass: *m, inertia: 0.4 * m * r * r })
            .collect(),
        smooth.position().to_vec(),
        smooth.free_velocity().iter().map(|v| Vector6::new(v.x, v.y, v.z, 0.0, 0.0, 0.0)).collect(),
        smooth.contacts().iter().map(contact).collect(),
    )
    .unwrap()
}

/// Without friction the tangential unknowns stay 0, and the normal ones are those of spheres without any.
#[test]
fn spheres_without_friction_give_the_frictionless_iterates() {
    let (smooth, radius) = sphere_problem_of("sphere-box", 30);
    let rough = roughened(&smooth, &radius, 0.0);
    let (zeros, none) = (vec![0.0; smooth.impulse_count()], vec![0.0; rough.impulse_count()]);
    for ((name, one), (_, other)) in methods::<Spheres>().into_iter().zip(methods::<RoughSpheres>()) {
        let (one, other) = (one.start(&smooth, &zeros).unwrap(), other.start(&rough, &none).unwrap());
        in_step([one, other], [&zeros, &none], 20, |iteration, r, s| {
            let greatest = r.iter().copied().fold(0.0, f64::max);
            for (r, s) in r.iter().zip(s.chunks_exact(3)) {
                let apart = (r - s[0]).abs().max(s[1].abs()).max(s[2].abs());
                assert!(apart < 1e-9 * greatest, "{name}, iteration {iteration}: {apart}");
            }
        });
    }
}

/// Half a second of a sphere on a plane, from a velocity and a spin, under a gravity: V and ω.
fn rolled(mut motion: Vector6<f64>, gravity: Vector3<f64>, friction: f64, scale: (f64, f64)) -> Vector6<f64> {
    let (length, mass) = scale;
    let (radius, m, h) = (0.25 * length, 2.0 * mass, 0.01);
    motion.fixed_rows_mut::<3>(0).scale_mut(length);
    for _ in 0..50 {
        let mut free = motion;
        let mut translation = free.fixed_rows_mut::<3>(0);
        translation += gravity * (h * length);
        let problem = Packing::<RoughSpheres>::new(
            vec![RoughMass { mass: m, inertia: 0.4 * m * radius * radius }],
            vec![Vector3::new(0.0, radius, 0.0)],
            vec![free],
            vec![RoughContact {
                candidate: 0,
                antagonist: None,
                normal: Vector3::y(),
                arms: Vector2::new(radius, 0.0),
                offset: Vector3::zeros(),
                friction,
            }],
        )
        .unwrap();
        let stop = Stop { tolerance: 1e-13, max_iterations: 100, ..Stop::default() };
        let outcome = solve(&Nsgs::default(), &problem, &[0.0; 3], &stop, &mut |_| {}).unwrap();
        assert_eq!(outcome.status, Status::Converged);
        motion = Truth::new(&problem, &outcome.impulses).velocity()[0];
    }
    motion.fixed_rows_mut::<3>(0).unscale_mut(length);
    motion
}

/// It rolls iff tan θ ≤ 3.5 μ, at 5/7 g sin θ, whichever way is down; else it slides at g (sin θ − μ cos θ). Units change nothing.
#[test]
fn sphere_on_a_slope_rolls_or_slides() {
    let (g, time) = (9.81, 0.5);
    for scale in [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e6)] {
        for (slope, friction) in [(0.3_f64, 0.2), (0.6, 0.1), (0.6, 0.2)] {
            for down in [Vector3::x(), Vector3::z(), Vector3::new(0.6, 0.0, -0.8)] {
                let gravity = (down * slope.sin() - Vector3::y() * slope.cos()) * g;
                let end = rolled(Vector6::zeros(), gravity, friction, scale);
                let rolls = slope.tan() <= 3.5 * friction;
                let speed = if rolls {
                    5.0 / 7.0 * g * slope.sin() * time
                } else {
                    g * (slope.sin() - friction * slope.cos()) * time
                };
                let translation = end.fixed_rows::<3>(0).into_owned();
                assert!((translation - down * speed).norm() < 1e-10 * speed, "{scale:?}, {end}");
                if rolls {
                    // The contact point is at rest: V = ω × n R.
                    let spin = end.fixed_rows::<3>(3).cross(&Vector3::y()) * 0.25;
                    assert!((translation - spin).norm() < 1e-10 * speed, "{end}");
                }
            }
        }
    }
}

/// Thrown without spin at v₀, it rolls from 2 v₀/(7 μ g) on, at 5/7 v₀.
#[test]
fn thrown_sphere_rolls_at_five_sevenths() {
    let thrown = Vector6::new(1.2, 0.0, -0.9, 0.0, 0.0, 0.0);
    let end = rolled(thrown, -Vector3::y() * 9.81, 0.3, (1.0, 1.0));
    let expected = Vector3::new(1.2, 0.0, -0.9) * (5.0 / 7.0);
    assert!((end.fixed_rows::<3>(0) - expected).norm() < 1e-12, "{end}");
}
