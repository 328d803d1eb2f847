//! Work on many items in threads. Closures come as trait objects: a thread's worth of work never feels the call, and the compiler
//! makes one parallel loop for all of the program instead of one for each closure.

use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// A thread that sleeps takes some tens of microseconds to wake (ns).
const WORTH_A_THREAD: usize = 100_000;

/// The parallel sections of this process so far.
static SECTIONS: AtomicUsize = AtomicUsize::new(0);

/// Returns the number of parallel sections that this process has gone through. All its threads wait for the end of each, so that it
/// counts barriers.
pub fn sections() -> usize {
    SECTIONS.load(Ordering::Relaxed)
}

/// Reports whether there are threads, and work of about so many `nanoseconds` is worth them: from a tenth of a millisecond on. Only time
/// depends on it.
pub fn pay(nanoseconds: usize) -> bool {
    nanoseconds >= WORTH_A_THREAD && rayon::current_num_threads() > 1
}

/// Calls `act` with each item and its index; in threads, where all take about so many `nanoseconds` that these pay.
pub fn each<T: Send>(items: &mut [T], nanoseconds: usize, act: &(dyn Fn(usize, &mut T) + Sync)) {
    if pay(nanoseconds) {
        shared(items.iter_mut(), &|k, item| act(k, item));
    } else {
        items.iter_mut().enumerate().for_each(|(k, item)| act(k, item));
    }
}

/// [`each`] of two lists, as far as both go.
pub fn each_pair<A: Send, B: Send>(
    (first, second): (&mut [A], &mut [B]),
    nanoseconds: usize,
    act: &(dyn Fn(&mut A, &mut B) + Sync),
) {
    let pairs = first.iter_mut().zip(second);
    if pay(nanoseconds) {
        shared(pairs, &|_, (a, b)| act(a, b));
    } else {
        pairs.for_each(|(a, b)| act(a, b));
    }
}

/// Returns the results of `make` for the indices below `count`, each of which is worth a thread.
pub fn make<T: Send>(count: usize, make: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    let mut made: Vec<Option<T>> = (0..count).map(|_| None).collect();
    each(&mut made, usize::MAX, &|k, made| *made = Some(make(k)));
    made.into_iter().flatten().collect()
}

/// In threads, each of which locks the item that it works on.
fn shared<T: Send>(items: impl Iterator<Item = T>, act: &(dyn Fn(usize, &mut T) + Sync)) {
    let items: Vec<Mutex<T>> = items.map(Mutex::new).collect();
    in_threads(items.len(), &|k| act(k, &mut items[k].lock().unwrap_or_else(PoisonError::into_inner)));
}

fn in_threads(count: usize, act: &(dyn Fn(usize) + Sync)) {
    SECTIONS.fetch_add(1, Ordering::Relaxed);
    (0..count).into_par_iter().for_each(act);
}
