use super::*;
use crate::sample::shapes;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::{FRAC_PI_6, PI};

fn places(spheres: &[[f64; 4]]) -> (Vec<Vector3<f64>>, Vec<f64>) {
    spheres.iter().map(|&[x, y, z, r]| (Vector3::new(x, y, z), r)).unzip()
}

/// Returns all pairs that touch, and all grains that touch the faces of the box around them: without these a crystal falls apart from its corners.
fn touching(position: &[Vector3<f64>], radius: &[f64]) -> Vec<(u32, Option<u32>)> {
    let other = |side: Side| if let Side::Grain(j) = side { Some(j) } else { None };
    let pairs = crate::detect(position, radius, 1e-9);
    let pairs = pairs.iter().map(|pair| (pair.candidate, other(pair.antagonist)));
    let [low, high] = Place::extent(position.iter().copied());
    let faces = (0..).zip(position).flat_map(|(i, x)| {
        let at_faces = x.iter().zip(low.iter().zip(high.iter()));
        let count = at_faces.filter(|(x, (low, high))| **x < *low + 1e-9 || **x > *high - 1e-9).count();
        std::iter::repeat_n((i, None), count)
    });
    pairs.chain(faces).collect()
}

/// Checks that the parts above and below a plane add up, and that planes through the centre leave a half, a quarter and an eighth.
#[test]
fn balls_and_discs_are_cut_exactly() {
    let whole = 4.0 / 3.0 * PI;
    let (all, half) = ([-2.0, 2.0], [0.0, 2.0]);
    for (cut, share) in
        [([all; 3], 1.0), ([half, all, all], 0.5), ([half, half, all], 0.25), ([half; 3], 0.125)]
    {
        assert!((ball_in(cut) - share * whole).abs() < 1e-14, "{cut:?}");
    }
    for h in [0.1_f64, 0.5, 1.3, 1.9] {
        // A cap of height h, π h² (3 − h)/3, lying and standing.
        let cap = PI * h * h * (3.0 - h) / 3.0;
        assert!((ball_in([all, [1.0 - h, 1.0], all]) - cap).abs() < 1e-14, "{h}");
        assert!((ball_in([[1.0 - h, 1.0], all, all]) - cap).abs() < 1e-3 * whole, "{h}");
        let segment = libm::acos(1.0 - h) - (1.0 - h) * (2.0 * h - h * h).sqrt();
        for cut in [[[1.0 - h, 2.0], all], [all, [1.0 - h, 2.0]]] {
            assert!((disc_in(cut, 1.0) - segment).abs() < 1e-14, "{h}");
        }
    }
    // Four boxes that meet in a corner, wherever it is.
    for [a, b] in [[0.3, -0.2], [-0.9, 0.8], [0.0, 0.7], [0.71, 0.71]] {
        let [x, y] = [[[-2.0, a], [a, 2.0]], [[-2.0, b], [b, 2.0]]];
        let parts = x.iter().flat_map(|x| y.iter().map(move |y| disc_in([*x, *y], 3.0) / 9.0));
        let scaled = |cut: [f64; 2]| cut.map(|at| 3.0 * at);
        let scaled =
            x.iter().flat_map(|x| y.iter().map(move |y| disc_in([scaled(*x), scaled(*y)], 3.0) / 9.0));
        assert!((scaled.sum::<f64>() - PI).abs() < 1e-14 && parts.sum::<f64>() > 0.0, "{a}, {b}");
    }
}

/// π/6 of a simple cubic crystal and π/(3√2) of a face-centred one are filled, whatever cells the box begins at; 6 and 12 contacts.
#[test]
fn crystals_have_their_solid_fraction_and_their_contacts() {
    let r = 0.25;
    let layer = r * 2.0_f64.sqrt();
    for (spheres, rise, fraction, contacts) in [
        (shapes::simple_cubic([6, 6, 6], r), 2.0 * r, FRAC_PI_6, 6),
        (shapes::face_centred([6, 9, 6], r), 2.0 * layer, PI / 18.0_f64.sqrt(), 12),
    ] {
        let (position, radius) = places(&spheres);
        for from in [2.0 * r, 3.0 * r] {
            let low = [from, r + rise, from];
            let high = [from + 4.0 * r, r + 2.0 * rise, from + 4.0 * r];
            let filled = solid_fraction(&position, &radius, [low, high], false);
            assert!((filled - fraction).abs() < 1e-13, "{filled}");
        }
        let held = held_contacts(position.len(), &touching(&position, &radius), 4);
        let inside = |x: &Vector3<f64>| x.iter().all(|x| (2.5 * r..=9.6 * r).contains(x));
        let deep: Vec<u32> = position.iter().zip(&held).filter(|(x, _)| inside(x)).map(|(_, k)| *k).collect();
        assert!(deep.len() > 20 && deep.iter().all(|k| *k == contacts), "{deep:?}");
    }
    // Discs on a square lattice: π/4.
    let discs: Vec<Vector2<f64>> =
        (0..36).map(|k| Vector2::new(f64::from(k % 6), f64::from(k / 6))).collect();
    let filled = solid_fraction(&discs, &[0.5; 36], [[1.0, 1.0, 0.0], [4.0, 3.0, 0.0]], false);
    assert!((filled - PI / 4.0).abs() < 1e-14, "{filled}");
}

/// A chain of grains on a held one goes from its end, one after the other; what holds itself stays.
#[test]
fn rattlers_go_until_all_are_held() {
    // A ring of 0, 1, 2; a chain 2-3-4; 5 touches a wall alone, and 6 nothing.
    let pushing = [(0, Some(1)), (1, Some(2)), (0, Some(2)), (2, Some(3)), (3, Some(4)), (5, None)];
    assert_eq!(held_contacts(7, &pushing, 2), [2, 2, 2, 0, 0, 0, 0]);
    assert_eq!(held_contacts(7, &pushing, 3), [0; 7]);
    assert_eq!(held_contacts(7, &pushing, 0), [2, 2, 3, 2, 1, 1, 0]);
}
