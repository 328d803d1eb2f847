//! Distribution of subdomains over their holders, and their joint decisions: alone on one machine, or as ranks with a memory of their own.

use contact::SetupError;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Numbers for another rank, or from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parcel {
    /// The other rank.
    pub rank: usize,
    /// As many as the other side expects.
    pub numbers: Vec<f64>,
}

/// Transport of numbers between ranks: all that a library of messages, or a test, must offer.
pub trait Post: Send + Sync {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Returns the number of ranks.
    fn size(&self) -> usize;

    /// Sends the parcels `sent`, and returns when the `received`, whose lengths are known, are filled. Between two ranks parcels
    /// arrive in the order in which they are sent.
    fn swap(&self, sent: &[Parcel], received: &mut [Parcel]);
}

/// One rank, which has nobody to write to.
struct Alone;

impl Post for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn swap(&self, _: &[Parcel], _: &mut [Parcel]) {}
}

/// Data that a rank has sent, and the time it waited for others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Messages sent.
    pub messages: u64,
    /// Bytes in them.
    pub bytes: u64,
    /// Time in exchanges (ns): for those who are late, and for the way of the messages.
    pub waiting_ns: u64,
}

contact::added!(Traffic: messages, bytes, waiting_ns);

impl Traffic {
    /// Returns the traffic added since `before`.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        Self {
            messages: self.messages - before.messages,
            bytes: self.bytes - before.bytes,
            waiting_ns: self.waiting_ns - before.waiting_ns,
        }
    }
}

/// A rank among those who share the subdomains of a problem. Each has a range of them; all must call the same methods in the same
/// order, and each then gets the same answer, whatever the number of ranks.
#[derive(Clone)]
pub struct Team {
    post: Arc<dyn Post>,
    /// Rank k has the subdomains `first[k]..first[k + 1]`.
    first: Arc<[usize]>,
    counts: Arc<[AtomicU64; 3]>,
}

impl Team {
    /// One rank with all of so many `subdomains`.
    pub fn alone(subdomains: usize) -> Self {
        Self { post: Arc::new(Alone), first: [0, subdomains].into(), counts: Arc::default() }
    }

    /// The ranks that `post` joins, with as equal numbers of `subdomains` as can be.
    ///
    /// # Errors
    /// More ranks than subdomains.
    pub fn new(post: Arc<dyn Post>, subdomains: usize) -> Result<Self, SetupError> {
        let size = post.size();
        let expected = format!("at most {subdomains}, the number of subdomains");
        SetupError::unless(size <= subdomains, "ranks", size, expected)?;
        let first = (0..=size).map(|rank| rank * subdomains / size).collect();
        Ok(Self { post, first, counts: Arc::default() })
    }

    /// Number of this rank.
    pub fn rank(&self) -> usize {
        self.post.rank()
    }

    /// Returns the number of ranks.
    pub fn size(&self) -> usize {
        self.post.size()
    }

    /// Number of subdomains of all ranks.
    pub fn subdomains(&self) -> usize {
        self.first[self.size()]
    }

    /// The subdomains of this rank.
    pub fn mine(&self) -> Range<usize> {
        self.of(self.rank())
    }

    /// The subdomains of a rank.
    pub fn of(&self, rank: usize) -> Range<usize> {
        self.first[rank]..self.first[rank + 1]
    }

    /// The rank that has a subdomain.
    pub fn rank_of(&self, subdomain: usize) -> usize {
        self.first.partition_point(|first| *first <= subdomain) - 1
    }

    /// Returns the data that this rank has sent so far, and the time it waited.
    pub fn traffic(&self) -> Traffic {
        let [messages, bytes, waiting_ns] = [0, 1, 2].map(|k| self.counts[k].load(Ordering::Relaxed));
        Traffic { messages, bytes, waiting_ns }
    }

    /// [`Post::swap`], counted.
    pub(crate) fn swap(&self, sent: &[Parcel], received: &mut [Parcel]) {
        if sent.is_empty() && received.is_empty() {
            return;
        }
        let clock = Instant::now();
        self.post.swap(sent, received);
        let bytes: usize = sent.iter().map(|parcel| 8 * parcel.numbers.len()).sum();
        let counted = [sent.len() as u64, bytes as u64, clock.elapsed().as_nanos() as u64];
        for (count, more) in self.counts.iter().zip(counted) {
            count.fetch_add(more, Ordering::Relaxed);
        }
    }
}
