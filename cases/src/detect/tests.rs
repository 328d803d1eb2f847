use super::*;

#[test]
fn kept_pairs_give_the_contacts_of_a_search_and_are_seldom_sought() {
    let mut position: Vec<Vector2<f64>> =
        (0..400_u32).map(|k| Vector2::new(f64::from(k % 20), f64::from(k / 20)) * 0.14).collect();
    let radius: Vec<f64> = (0..400_u32).map(|k| 0.05 + 0.025 * f64::from(k * 7 % 5) / 4.0).collect();
    let mut neighbours = Neighbours::default();
    for time_step in 0..100_u32 {
        let reach = 0.001 * f64::from(time_step % 7);
        assert_eq!(neighbours.contacts(&position, &radius, reach), detect(&position, &radius, reach));
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
            [neighbours.contacts(&position, &radius, 0.01), detect(&position, &radius, 0.01)];
        let pairs = |contacts: &[DetectedContact]| -> Vec<_> {
            contacts.iter().map(|contact| (contact.candidate, contact.antagonist)).collect()
        };
        assert_eq!(pairs(&kept), pairs(&sought), "at {x}");
    }
}
