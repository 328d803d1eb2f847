//! The packings that are timed.

use cases::{Case, Frozen, March, Marched};
use contact::RoughDiscs;
use std::path::Path;

/// `deposited-box` with so many grains, in a box about as wide as high.
pub(crate) fn scene(grains: usize) -> March {
    scene_of(grains, &[])
}

/// The same with some values replaced.
fn scene_of<M: Marched>(grains: usize, more: &[(&str, &str)]) -> March<M> {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/deposited-box.toml");
    let mut overrides = vec![
        ("sample.grains".to_owned(), grains.to_string()),
        ("scene.box.width_m".to_owned(), format!("{:.3}", 0.152 * (grains as f64).sqrt())),
    ];
    overrides.extend(more.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())));
    let made = Case::read(&case, &overrides).and_then(|case| March::new(&case));
    made.unwrap_or_else(|error| panic!("{error}"))
}

/// Its first problem.
pub(crate) fn packing(grains: usize) -> Frozen {
    scene(grains).next().unwrap_or_else(|error| panic!("{error}")).frozen
}

/// That with a friction of 0.3.
#[allow(dead_code, reason = "not all benchmarks have friction")]
pub(crate) fn rough_packing(grains: usize) -> Frozen<RoughDiscs> {
    let scene = scene_of(grains, &[("scene.friction", "0.3")]);
    scene.next().unwrap_or_else(|error| panic!("{error}")).frozen
}

/// The numbers of grains of the environment variable `GRAINS`, such as "1000 1000000", or else 1000 and 100,000.
pub(crate) fn sizes() -> Vec<usize> {
    let asked = std::env::var("GRAINS").unwrap_or_else(|_| "1000 100000".to_owned());
    let size =
        |text: &str| text.parse().unwrap_or_else(|_| panic!("GRAINS: `{text}` is no number of grains"));
    asked.split_whitespace().map(size).collect()
}
