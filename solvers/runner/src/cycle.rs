//! Detection of cycles in a run that did not converge.

use contact::Iteration;

/// The longest cycle that is looked for.
const LONGEST: u64 = 32;

/// Iterations from which on a run is long enough for the look.
const LONG: u64 = 320;

/// Largest distance at which impulses count as returned, over their last change (–).
const BACK: f64 = 1e-6;

/// Iterations of the cycle in which a run of so many goes, if it does: after them the impulses are those of its last iterate again,
/// and that they changed from the one `before` is no round-off. The run is taken further for that.
pub(crate) fn cycle(
    iteration: &mut dyn Iteration,
    iterations: u64,
    before: &[f64],
    last: &[f64],
) -> Option<u64> {
    let change = distance(before, last);
    let size = last.iter().map(|r| r * r).sum::<f64>().sqrt();
    if iterations < LONG || before.len() != last.len() || !(change > f64::EPSILON.sqrt() * size) {
        return None;
    }
    let mut r = last.to_vec();
    let back = (1..=LONGEST).find(|_| {
        iteration.advance();
        iteration.impulses(&mut r);
        distance(&r, last) <= BACK * change
    });
    // Impulses that stay as they are go nowhere.
    back.filter(|iterations| *iterations > 1)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
