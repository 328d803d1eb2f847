//! The packings that are timed.

use cases::{Case, Frozen, March, Marched};
use contact::RoughDiscs;
use std::path::Path;

/// `deposited-box` with so many grains, in a box about as wide as high.
pub(crate) fn scene(grains: usize) -> March {
    scene_of("deposited-box", grains, &[("width_m", 0.152 * (grains as f64).sqrt())], 0.0)
}

/// A case with so many grains, in a box of some `sides` (m), and with `friction`.
fn scene_of<M: Marched>(case: &str, grains: usize, sides: &[(&str, f64)], friction: f64) -> March<M> {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../cases/{case}.toml"));
    let mut overrides = vec![("sample.grains".to_owned(), grains.to_string())];
    overrides.extend(sides.iter().map(|(side, value)| (format!("scene.box.{side}"), format!("{value:.3}"))));
    if friction > 0.0 {
        overrides.push(("scene.friction".to_owned(), friction.to_string()));
    }
    let made = Case::read(&case, &overrides).and_then(|case| March::new(&case));
    made.unwrap_or_else(|error| panic!("{error}"))
}

/// The first problem of a scene.
fn first<M: Marched>(scene: &March<M>) -> Frozen<M> {
    scene.next().unwrap_or_else(|error| panic!("{error}")).frozen
}

/// The first problem of [`scene`].
pub(crate) fn packing(grains: usize) -> Frozen {
    first(&scene(grains))
}

/// The first problem of [`scene`] with a friction of 0.3.
#[allow(dead_code, reason = "not all benchmarks have friction")]
pub(crate) fn rough_packing(grains: usize) -> Frozen<RoughDiscs> {
    first(&scene_of("deposited-box", grains, &[("width_m", 0.152 * (grains as f64).sqrt())], 0.3))
}

/// The first problem of `sphere-box` with so many grains, in a box about as wide and as deep as high, and with `friction`.
#[allow(dead_code, reason = "not all benchmarks are of spheres")]
pub(crate) fn packing_in_space<M: Marched>(grains: usize, friction: f64) -> Frozen<M> {
    let side = 0.2 * (grains as f64).cbrt();
    first(&scene_of("sphere-box", grains, &[("width_m", side), ("depth_m", side)], friction))
}

/// The numbers of grains of the environment variable `GRAINS`, such as "1000 1000000", or else 1000 and 100,000.
pub(crate) fn sizes() -> Vec<usize> {
    let asked = std::env::var("GRAINS").unwrap_or_else(|_| "1000 100000".to_owned());
    let size =
        |text: &str| text.parse().unwrap_or_else(|_| panic!("GRAINS: `{text}` is no number of grains"));
    asked.split_whitespace().map(size).collect()
}
