use super::*;
use nalgebra::Vector2;

const RADIUS: [f64; 2] = [1.0, 0.05];
const H: f64 = 0.01;

/// A large grain and a small one with a contact between them, and one of the large grain with a wall.
fn exploded(gap: [f64; 2], speed: [f64; 2]) -> Option<Explosion> {
    let velocity = speed.map(|v| Vector2::new(0.0, -v));
    let deepest = deepest([(0, Some(1)), (0, None)].into_iter(), &gap, &RADIUS);
    explosion(deepest, &RADIUS, &velocity, H)
}

#[test]
fn each_grain_is_judged_by_its_own_size() {
    let [large, small] = RADIUS;
    assert_eq!(exploded([-small, -large], [2.0 * large / H, 2.0 * small / H]), None);
    let overlap = |grain, overlap, bound| Some(Explosion::Overlap { grain, overlap, bound });
    assert_eq!(exploded([-0.06, -0.9], [0.0; 2]), overlap(1, 0.06, small));
    assert_eq!(exploded([0.01, -1.01], [0.0; 2]), overlap(0, 1.01, large));
    // Of several, the one farthest beyond its bound.
    assert_eq!(exploded([-0.1, -1.5], [0.0; 2]), overlap(1, 0.1, small));
    let speed = |grain, speed, bound| Some(Explosion::Speed { grain, speed, bound });
    assert_eq!(exploded([0.0; 2], [100.0, 10.5]), speed(1, 10.5, 2.0 * small / H));
    assert_eq!(exploded([0.0; 2], [201.0, 9.0]), speed(0, 201.0, 2.0 * large / H));
}

#[test]
fn velocities_that_are_not_finite_come_first() {
    // The square of a finite speed need not be finite.
    for odd in [f64::NAN, f64::INFINITY, 1e200] {
        assert_eq!(exploded([-2.0; 2], [0.0, odd]), Some(Explosion::NotFinite));
    }
}
