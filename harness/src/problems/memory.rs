//! What a scene needs of the memory, before any of it is taken.

use cases::{Case, Sample};

/// What a grain takes with its contacts left aside, and what each of these takes, in a march and its solver (B): with `cg` a
/// first time step took 135 and 200, on columns of 1e5 grains with 1 to 30 copies of each contact, and a march keeps the
/// impulses of the one before.
const PER_GRAIN: f64 = 200.0;
const PER_CONTACT: f64 = 250.0;

/// A grain has two contacts of its own in a packing of discs, or a little less.
const CONTACTS_PER_GRAIN: f64 = 2.0;

/// Names the key that asks for more than is `free` (B).
pub(super) fn fits(case: &Case, free: Option<u64>) -> Result<(), String> {
    let copies = case.scene.contact_copies;
    let in_the_file = || match &case.sample {
        Sample::Discs { discs, .. } => discs.len() as u64,
        // Those of another file are counted once it is read, and it has been written.
        _ => 1000,
    };
    let (key, grains) = case.sample.grains().unwrap_or_else(|| ("sample", in_the_file()));
    let (key, value) = if copies > 1000 { ("scene.contact_copies", copies.into()) } else { (key, grains) };
    let needed = grains as f64 * (PER_GRAIN + CONTACTS_PER_GRAIN * f64::from(copies) * PER_CONTACT);
    match free {
        Some(free) if needed > free as f64 => Err(format!(
            "`{key}` is {value}: the scene needs about {} of memory, and {} are free",
            gigabytes(needed),
            gigabytes(free as f64)
        )),
        _ => Ok(()),
    }
}

fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB", bytes / 1e9)
}
