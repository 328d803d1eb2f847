//! When threads are worth waking.

/// A thread that sleeps takes some tens of microseconds to wake (ns).
const WORTH_A_THREAD: usize = 100_000;

/// How many of some items stay together on one thread, for `with_min_len` of rayon: all, where they take less than a
/// tenth of a millisecond in all. Only time depends on it.
pub fn together(nanoseconds: usize) -> usize {
    if nanoseconds < WORTH_A_THREAD { usize::MAX } else { 1 }
}
