//! Packings at rest with friction, by continuation in the offsets.
//!
//! At rest next to nothing moves. What moves is due to gaps that are about to close, at 1e-7 of the speed that impulses hold back, in
//! the packings of this repository. The impulses of a solution depend on the directions of this motion all the same, and no residual
//! shows the way to them: W is singular, and whole families of impulses leave as little. With all offsets c times so large a factor
//! that gaps close as fast as grains fall, the packing moves, and its solution is found. So the factor falls from there to 1, and each
//! solution begins the search for the next. In other units, the weight of the grains stays and their inertia falls. At rest no offset is
//! negative, so a solution exists for every factor.
//!
//! Solutions may jump as the factor falls: where none is found nearby, other factors are tried, farther away as well.

use crate::Existence;
use crate::certificate::certify;
use crate::rough::{Provable, RoughSolution, polished};
use active_set::ActiveSet;
use analysis::Meter;
use contact::{Packing, Solver, Touch, Vector};

/// Largest natural map at the factor 1, and at the first one, between which it falls with the factor (–).
const LAST: f64 = 1e-12;
const FIRST: f64 = 1e-7;

/// Iterations of one search: where the factor before is near, a few to some thousands suffice.
const MANY: u32 = 10_000;

/// Iterations of a search from one look at the natural map to the next.
const LOOK: u32 = 5;

/// Searches, at most.
pub const SEARCHES: u64 = 300;

/// First ratios of a factor to the next (–), each of which leads along another way; and the widest.
const RATIOS: [f64; 4] = [3.0, 2.0, 1.5, 5.0];
const WIDEST: f64 = 10.0;

/// Ratios that are tried in turn where that of the last success, and its root, lead to no solution (–): nearer, then beyond a jump.
const OTHERS: [f64; 6] = [1.1, 1.02, 1.5, 2.5, 5.0, 10.0];

/// Returns the certified solution of a `problem` at rest to which the continuation leads, if it leads to one; each search is `seen`.
pub fn continued<M: Provable>(problem: &Packing<M>, mut seen: impl FnMut()) -> Option<RoughSolution>
where
    ActiveSet: Solver<M>,
{
    if M::existence(problem) != Some(Existence::AtRest) {
        return None;
    }
    let first = greatest_factor(problem)?;
    let mut searches = 0;
    let mut search = |factor: f64, from: &[f64]| {
        if searches == SEARCHES {
            return None;
        }
        searches += 1;
        seen();
        let accuracy = f64::max(LAST, FIRST * factor / first);
        searched(&M::with_offsets(problem, factor)?, from, accuracy)
    };
    let none = vec![0.0; problem.impulse_count()];
    RATIOS.iter().find_map(|ratio| {
        let r = way(first, *ratio, &none, &mut search)?;
        let certificate = certify(problem, &r);
        let found = RoughSolution { impulses: r, certificate };
        if found.certificate.certified() { Some(found) } else { polished(problem, &found.impulses) }
    })
}

/// Returns the impulses (N·s) at the factor 1 to which a way leads from the `first` factor, if it arrives; `search` seeks the solution
/// for a factor from impulses.
fn way(
    first: f64,
    first_ratio: f64,
    none: &[f64],
    search: &mut impl FnMut(f64, &[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let mut factor = first;
    let mut r = loop {
        if let Some(found) = search(factor, none) {
            break found;
        }
        if factor <= 1.0 {
            return None;
        }
        factor = f64::max(1.0, factor / first_ratio);
    };
    let mut ratio = first_ratio;
    while factor > 1.0 {
        let mut ratios = [ratio, ratio.sqrt()].into_iter().chain(OTHERS);
        let (next, taken, found) = ratios.find_map(|ratio| {
            let next = f64::max(1.0, factor / ratio);
            search(next, &r).map(|found| (next, ratio, found))
        })?;
        (factor, r) = (next, found);
        ratio = taken.max(OTHERS[0]).powf(1.5).min(WIDEST);
    }
    Some(r)
}

/// Returns the factor at which the least gap closes as fast as the fastest contact approaches; `None` where all offsets are 0 but for
/// round-off.
fn greatest_factor<M: Provable>(problem: &Packing<M>) -> Option<f64> {
    let b = problem.b();
    let fastest = b.iter().step_by(M::Impulse::LEN).fold(0.0, |fastest: f64, b| fastest.max(-b));
    let offsets = problem.contacts().iter().map(|contact| contact.offset().first());
    let least = offsets.filter(|offset| *offset > f64::EPSILON * fastest).reduce(f64::min)?;
    Some(f64::max(1.0, fastest / least))
}

/// Returns the impulses (N·s) of the active set, begun from others, that leave a natural map of at most `accuracy` (–), if it comes to
/// some.
fn searched<M: Provable>(problem: &Packing<M>, from: &[f64], accuracy: f64) -> Option<Vec<f64>>
where
    ActiveSet: Solver<M>,
{
    let mut run = Solver::<M>::start(&ActiveSet::default(), problem, from).ok()?;
    let (mut impulses, mut meter) = (from.to_vec(), Meter::new(problem));
    for iteration in 0..MANY {
        let is_ended = run.stalled();
        if is_ended || iteration.is_multiple_of(LOOK) {
            run.impulses(&mut impulses);
            if meter.measure(&impulses, 0.0).natural_map <= accuracy {
                return Some(impulses);
            }
        }
        if is_ended {
            break;
        }
        run.advance();
    }
    None
}
