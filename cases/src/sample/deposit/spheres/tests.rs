use super::*;

/// No sphere overlaps another or a wall, the seed decides, and the bed is as dense as such beds are.
#[test]
fn deposited_spheres_lie_apart_and_fill_the_box() {
    let radii: Vec<f64> = (0..3000_u32).map(|k| 0.08 + 0.04 * f64::from(k * 7 % 11) / 10.0).collect();
    let (width, depth) = (2.0, 1.5);
    let spheres = deposit_spheres(&radii, [width, depth], 1);
    assert_eq!(spheres, deposit_spheres(&radii, [width, depth], 1));
    assert_ne!(spheres, deposit_spheres(&radii, [width, depth], 2));
    for (k, &[x, y, z, r]) in spheres.iter().enumerate() {
        let inside = |x: f64, size: f64| x >= r - 1e-9 && x <= size - r + 1e-9;
        assert!(inside(x, width) && inside(z, depth) && y >= r - 1e-9, "{k}");
        for &[a, b, c, s] in &spheres[..k] {
            let apart = ((x - a).powi(2) + (y - b).powi(2) + (z - c).powi(2)).sqrt() - r - s;
            assert!(apart > -1e-9, "{apart} at {k}");
        }
    }
    // Solid fraction below 80 % of the height, away from the loose surface.
    let top = 0.8 * spheres.iter().map(|sphere| sphere[1]).fold(0.0, f64::max);
    let below = spheres.iter().filter(|sphere| sphere[1] < top);
    let volume: f64 = below.map(|sphere| 4.0 / 3.0 * std::f64::consts::PI * sphere[3].powi(3)).sum();
    let fraction = volume / (width * depth * top);
    assert!((0.5..0.6).contains(&fraction), "{fraction}");
}
