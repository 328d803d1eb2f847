//! Ranks as threads of one process, which share nothing but channels.

use partition::{Parcel, Post};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// One end of the channels between all pairs of ranks.
struct Channels {
    rank: usize,
    /// To each rank.
    to: Vec<Sender<Vec<f64>>>,
    /// From each rank.
    from: Vec<Mutex<Receiver<Vec<f64>>>>,
}

impl Post for Channels {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn swap(&self, sent: &[Parcel], received: &mut [Parcel]) {
        let gone = |rank: usize| format!("rank {rank} has ended, and rank {} waits for it", self.rank);
        for Parcel { rank, numbers } in sent {
            self.to[*rank].send(numbers.clone()).unwrap_or_else(|_| panic!("{}", gone(*rank)));
        }
        for Parcel { rank, numbers } in received {
            let from = self.from[*rank].lock().unwrap_or_else(PoisonError::into_inner);
            let arrived = from.recv().unwrap_or_else(|_| panic!("{}", gone(*rank)));
            assert_eq!(
                arrived.len(),
                numbers.len(),
                "rank {} expects another parcel of rank {rank}",
                self.rank
            );
            *numbers = arrived;
        }
    }
}

/// Returns the results of `work` at each of so many ranks, which are threads of this process.
///
/// # Panics
/// If the work of a rank does.
pub fn simulated<T: Send>(size: usize, work: impl Fn(Arc<dyn Post>) -> T + Sync) -> Vec<T> {
    let mut ends: Vec<(Vec<_>, Vec<_>)> = (0..size).map(|_| (Vec::new(), Vec::new())).collect();
    for from in 0..size {
        for to in 0..size {
            let (sender, receiver) = channel();
            ends[from].0.push(sender);
            ends[to].1.push(Mutex::new(receiver));
        }
    }
    let work = &work;
    thread::scope(|scope| {
        let start = |(rank, (to, from))| scope.spawn(move || work(Arc::new(Channels { rank, to, from })));
        let ranks: Vec<_> = ends.into_iter().enumerate().map(start).collect();
        let ended = ranks.into_iter().map(thread::ScopedJoinHandle::join);
        ended.map(|end| end.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}
