use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[test]
fn kept_pairs_give_the_contacts_of_a_search_and_are_seldom_sought() {
    let mut position: Vec<Vector2<f64>> =
        (0..400_u32).map(|k| Vector2::new(f64::from(k % 20), f64::from(k / 20)) * 0.14).collect();
    let radius: Vec<f64> = (0..400_u32).map(|k| 0.05 + 0.025 * f64::from(k * 7 % 5) / 4.0).collect();
    let mut neighbours = Neighbours::default();
    for time_step in 0..100_u32 {
        let reach = 0.001 * f64::from(time_step % 7);
        assert_eq!(
            neighbours.contacts(&position, &radius, reach, Period(None)),
            detect(&position, &radius, reach)
        );
        // Each its own way, by less than 0.2 mm.
        for (k, x) in (0_u32..).zip(&mut position) {
            let (sin, cos) = libm::sincos(f64::from(k * 31 % 63) * 0.1);
            *x += Vector2::new(cos, sin) * 2e-4 * f64::from(k % 10) / 10.0;
        }
    }
    // They are sought 0.2 of 0.075 m too far: enough for 6 mm of reach, and for two discs to move by half of the rest.
    assert!((2..40).contains(&neighbours.searches), "{} searches in 100 time steps", neighbours.searches);
}

#[test]
fn one_disc_that_jumps_is_found_where_it_is() {
    let mut position: Vec<Vector2<f64>> =
        (0..30_u32).map(|k| Vector2::new(f64::from(k), 0.0) * 0.2).collect();
    let radius = vec![0.1; 30];
    let mut neighbours = Neighbours::default();
    for x in [0.0, 2.95, 1.0, 5.0] {
        position[0] = Vector2::new(x, 0.15);
        let [kept, sought] =
            [neighbours.contacts(&position, &radius, 0.01, Period(None)), detect(&position, &radius, 0.01)];
        let pairs = |contacts: &[DetectedContact]| -> Vec<_> {
            contacts.iter().map(|contact| (contact.candidate, contact.antagonist)).collect()
        };
        assert_eq!(pairs(&kept), pairs(&sought), "at {x}");
    }
}

/// Every pair, by its nearest image.
fn all_pairs(position: &[Vector2<f64>], radius: &[f64], reach: f64, width: f64) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for i in 0..position.len() {
        for j in i + 1..position.len() {
            let between = [-width, 0.0, width].map(|by| position[i] - position[j] + Vector2::new(by, 0.0));
            let distance = between.iter().map(Vector2::norm).fold(f64::INFINITY, f64::min);
            if distance - radius[i] - radius[j] <= reach {
                pairs.push([i as u32, j as u32]);
            }
        }
    }
    pairs
}

#[test]
fn all_pairs_are_found_through_a_periodic_boundary_while_discs_move() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for width in [1.2, 1.3, 3.7] {
        let radius: Vec<f64> = (0..120).map(|_| 0.05 + 0.05 * rng.random::<f64>()).collect();
        let mut position: Vec<Vector2<f64>> =
            (0..120).map(|_| Vector2::new(width * rng.random::<f64>(), 2.0 * rng.random::<f64>())).collect();
        let (mut neighbours, period) = (Neighbours::default(), Period(Some(width)));
        for _ in 0..60 {
            for x in &mut position {
                *x = period.wrapped(*x + Vector2::new(0.01, 0.004 * (rng.random::<f64>() - 0.5)));
            }
            let contacts = neighbours.contacts(&position, &radius, 0.02, period);
            let found: Vec<[u32; 2]> = contacts
                .iter()
                .map(|contact| match contact.antagonist {
                    Side::Grain(j) => [contact.candidate, j],
                    _ => unreachable!("grains alone"),
                })
                .collect();
            assert_eq!(found, all_pairs(&position, &radius, 0.02, width));
        }
    }
}
