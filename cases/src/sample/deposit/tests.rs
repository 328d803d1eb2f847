use super::front::{beside_wall, on_two};
use super::*;

/// `count` radii from `least` to `greatest`, drawn evenly.
fn radii(count: u32, least: f64, greatest: f64) -> Vec<f64> {
    (0..count).map(|k| least + (greatest - least) * (f64::from(k) * 0.618_034).fract()).collect()
}

#[test]
fn deposited_discs_fill_the_box_without_overlap() {
    for (least, width, solid) in [(0.05, 3.0, 0.7), (0.01, 2.0, 0.7), (0.001, 2.0, 0.7)] {
        let discs = deposit(&radii(400, least, 0.1), width).unwrap();
        for (k, (x, r)) in discs.iter().enumerate() {
            let inside = x.x >= r - 1e-11 && x.x <= width - r + 1e-11 && x.y >= r - 1e-11;
            assert!(inside, "disc {k} leaves the box");
            for (other, (y, s)) in discs[..k].iter().enumerate() {
                assert!((x - y).norm() >= r + s - 1e-11, "discs {other} and {k} from {least} m overlap");
            }
        }
        let area: f64 = discs.iter().map(|(_, r)| std::f64::consts::PI * r * r).sum();
        let top = discs.iter().map(|(x, r)| x.y + r).fold(0.0, f64::max);
        assert!(area / (width * top) > solid, "solid fraction {} from {least} m", area / (width * top));
    }
}

/// The lowest of all places on any two discs of the front, or on one and beside a wall.
fn lowest_of_all(front: &Front, radius: f64) -> Option<Place> {
    let chain: Vec<u32> = std::iter::successors(front.first, |disc| front.after[*disc as usize]).collect();
    let disc = |k: u32| front.discs[k as usize];
    let beside = |k: u32| {
        let left = beside_wall(disc(k), radius, radius).map(|at| Place { at, left: None, right: Some(k) });
        let right = beside_wall(disc(k), front.width - radius, radius);
        left.into_iter().chain(right.map(|at| Place { at, left: Some(k), right: None }))
    };
    let on = |k: u32, other: u32| {
        on_two(disc(k), disc(other), radius).map(|at| Place { at, left: Some(k), right: Some(other) })
    };
    let pairs = chain.iter().enumerate().flat_map(|(k, held)| {
        chain[k + 1..].iter().filter_map(move |other| on(*held, *other)).chain(beside(*held))
    });
    pairs
        .filter(|place| front.fits(chain.iter().copied(), place.at, radius))
        .min_by(|a, b| a.at.y.total_cmp(&b.at.y).then(a.at.x.total_cmp(&b.at.x)))
}

#[test]
fn every_disc_lies_at_the_lowest_of_all_places() {
    let mut with_intruder = radii(250, 0.05, 0.1);
    with_intruder[120] = 0.4;
    for (radii, width) in [
        (radii(250, 0.05, 0.1), 2.4),
        (radii(250, 0.02, 0.2), 3.0),
        (radii(150, 0.001, 0.1), 1.5),
        (with_intruder, 2.4),
    ] {
        let mut front = Front::new(width, &radii);
        for (k, (at, radius)) in (0_u32..).zip(deposit(&radii, width).unwrap()) {
            let place = if at.y == radius {
                let (x, left) = front.beside_on_floor(radius);
                Place { at: Vector2::new(x, radius), left, right: None }
            } else {
                lowest_of_all(&front, radius).unwrap()
            };
            assert_eq!(place.at, at, "disc {k} of radius {radius}");
            front.lay(&place, radius);
        }
    }
}

#[test]
fn equal_discs_lie_in_rows_of_five_and_four() {
    let discs = deposit(&[0.1; 60], 1.0).unwrap();
    let top = discs.iter().map(|(x, _)| x.y).fold(0.0, f64::max);
    assert!((top - (0.1 + 13.0 * 0.1 * 3.0_f64.sqrt())).abs() < 1e-9, "{top}");
}

#[test]
fn the_work_for_a_disc_hardly_grows_with_the_width_of_the_box() {
    let work = |discs: u32, width: f64| {
        let (_, promises) = laid(&radii(discs, 0.05, 0.1), width).unwrap();
        promises.looks as f64 / f64::from(discs)
    };
    // Sixteen times as many discs on four times as many columns.
    let (looks, looks_then) = (work(2_000, 6.8), work(32_000, 27.2));
    assert!(looks_then < 1.5 * looks, "{looks} columns for a disc, then {looks_then}");
}

#[test]
fn the_lowest_column_is_the_first_of_the_lowest() {
    for columns in [1, 2, 5, 8, 13] {
        let (mut heights, mut listed) = (Heights::new(columns), vec![0.0; columns]);
        for k in 0..200 {
            let (column, height) = (k * 7 % columns, f64::from(k as u32 * 31 % 11));
            if k % 3 == 0 {
                heights.raise(column, height);
                listed[column] = f64::max(listed[column], height);
            } else {
                heights.set(column, height);
                listed[column] = height;
            }
            let lowest = listed.iter().copied().fold(f64::INFINITY, f64::min);
            let first = listed.iter().position(|height| *height == lowest).unwrap();
            assert_eq!(heights.lowest(), Some((first, lowest)));
        }
    }
}
