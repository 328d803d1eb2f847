use super::*;
use nalgebra::Vector2;
use pulp::{Arch, WithSimd};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Visits at once, with whatever instructions this processor has.
struct Visits<'a, N: Number> {
    rows: &'a [Row<SphereColumn<N>>; TOGETHER],
    s: &'a mut [Vector3<N>; TOGETHER],
    y: &'a mut [Vector6<N>],
}

impl<N: Number> WithSimd for Visits<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        SphereColumn::visit(simd, self.rows, self.s, self.y, 0.9);
    }
}

/// Contacts between grains 2 k and 2 k + 1, every third with a wall.
fn row(k: usize, next: &mut impl FnMut() -> f64) -> Row<SphereColumn> {
    let (candidate, has_antagonist) = (2 * k as u32, !k.is_multiple_of(3));
    let contact = RoughContact {
        candidate,
        antagonist: has_antagonist.then_some(candidate + 1),
        normal: Vector3::new(next(), next(), next()).normalize(),
        arms: Vector2::new(0.1, if has_antagonist { 0.2 } else { 0.0 }),
        offset: Vector3::zeros(),
        friction: 0.3,
    };
    let mass = |grain: u32| RoughMass { mass: 1.0 + f64::from(grain), inertia: 2.0 + f64::from(grain) };
    let (column, _) = SphereColumn::new(&contact, contact.ends(), mass, true);
    Row { column, offset: Vector3::new(next(), next(), next()) }
}

/// Visits of one precision, each row of which is made of one in double precision.
fn assert_visits_at_once_have_the_bits_of_visits_one_by_one<N: Number>(
    precise: impl Fn(Row<SphereColumn>) -> Row<SphereColumn<N>>,
) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut next = || rng.random_range(-1.0..1.0);
    let rows: [_; TOGETHER] = std::array::from_fn(|k| precise(row(k, &mut next)));
    let odd = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let (mut slid, mut stuck) = (0, 0);
    for trial in 0..5000 {
        // Half of the trials have numbers that are none, or zeros with signs.
        let plain = trial % 2 == 0;
        let mut number = || {
            let x = next();
            N::nearest(if plain || x < 0.8 { x } else { odd[(1e6 * x) as usize % odd.len()] })
        };
        let mut vector = || Vector3::new(number(), number(), number());
        let mut s: [_; TOGETHER] = std::array::from_fn(|_| vector() + Vector3::x());
        let mut y: Vec<_> = (0..2 * TOGETHER).map(|_| joined(vector(), vector())).collect();
        let (mut s_alone, mut y_alone) = (s, y.clone());
        for (row, s) in rows.iter().zip(&mut s_alone) {
            row.solve(s, &mut y_alone, 0.9);
            let s = s.double();
            let bound = row.column.law().0.into() * s.x;
            let sticks = s.yz().norm() < 0.999 * bound;
            stuck += u32::from(plain && sticks);
            slid += u32::from(plain && s.x > 0.0 && !sticks);
        }
        Arch::new().dispatch(Visits { rows: &rows, s: &mut s, y: &mut y });
        let numbers = s.iter().flatten().chain(y.iter().flatten());
        for (x, alone) in numbers.zip(s_alone.iter().flatten().chain(y_alone.iter().flatten())) {
            let [x, alone]: [f64; 2] = [*x, *alone].map(Into::into);
            assert!(x.to_bits() == alone.to_bits() || x.is_nan() && alone.is_nan(), "{x} {alone}");
        }
    }
    assert!(slid > 1000 && stuck > 1000, "{slid} slid and {stuck} stuck");
}

#[test]
fn visits_at_once_have_the_bits_of_visits_one_by_one_whatever_the_numbers() {
    assert_visits_at_once_have_the_bits_of_visits_one_by_one(|row| row);
    assert_visits_at_once_have_the_bits_of_visits_one_by_one(|row| Row {
        column: row.column.single(),
        offset: Numbers::nearest(row.offset),
    });
}

/// s − s⁺ is v, or what of v is at a right angle to a sliding s, however large s is.
#[test]
fn residual_of_huge_impulses_is_what_moves() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let Row { column, .. } = row(1, &mut || rng.random_range(-1.0..1.0));
    let v = Vector3::new(-0.5, 0.3, 0.4);
    for size in [1e6, 1e10, 1e20] {
        let bound = column.friction() * size;
        let of = |first: f64| column.residual(Vector3::new(size, first * bound, 0.0), v);
        assert_eq!(of(0.9), v, "it should stick");
        assert_eq!(of(1.0).x, -0.5, "it approaches");
        assert_eq!(of(1.0).yz(), v.yz(), "it slides, and friction pushes it on");
        let against = of(-1.0).yz() - Vector2::new(0.0, 0.4);
        assert!(against.norm() < 2.0 / size + 1e-9, "{size:e}: {against:?}");
    }
    let left = column.residual(Vector3::new(f64::NAN, 1.0, 0.0), v);
    assert!(left.y.is_nan() && left.z.is_nan());
}
