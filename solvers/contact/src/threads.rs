//! Work on many items in threads. The closures are taken as trait objects: a thread's worth of work never feels the call, and the
//! compiler makes one loop per kind of item instead of one per closure.

use rayon::prelude::*;

/// A thread that sleeps takes some tens of microseconds to wake (ns).
const WORTH_A_THREAD: usize = 100_000;

/// Calls `act` with each item and its index. On one thread, where all take less than a tenth of a millisecond, about `nanoseconds`;
/// only time depends on it.
pub fn each<T: Send>(items: &mut [T], nanoseconds: usize, act: &(dyn Fn(usize, &mut T) + Sync)) {
    items.par_iter_mut().enumerate().with_min_len(together(nanoseconds)).for_each(|(k, item)| act(k, item));
}

/// [`each`] of two lists, as far as both go.
pub fn each_pair<A: Send, B: Send>(
    (first, second): (&mut [A], &mut [B]),
    nanoseconds: usize,
    act: &(dyn Fn(&mut A, &mut B) + Sync),
) {
    let pairs = first.par_iter_mut().zip(second).with_min_len(together(nanoseconds));
    pairs.for_each(|(a, b)| act(a, b));
}

/// What `make` makes of the indices below `count`, each of which is worth a thread.
pub fn make<T: Send>(count: usize, make: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    (0..count).into_par_iter().map(make).collect()
}

/// How many items stay together on one thread, for `with_min_len` of rayon.
pub(crate) fn together(nanoseconds: usize) -> usize {
    if nanoseconds < WORTH_A_THREAD { usize::MAX } else { 1 }
}
