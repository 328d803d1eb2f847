//! Ranks that share a problem, each with a memory of its own: over MPI, which only this crate knows and only with its feature
//! `mpi`; or simulated in one process, so that what ranks do together is tested without it.

mod simulated;
#[cfg(feature = "mpi")]
mod world;

pub use simulated::simulated;
#[cfg(feature = "mpi")]
pub use world::World;

use analysis::Bounded;
use contact::Packing;
use partition::{Grid, Scheme, Whole};

/// Returns the facts about the whole problem, cut into `subdomains` by the rule `partition`, that every rank must know.
pub fn whole<M: Bounded>(problem: &Packing<M>, subdomains: Grid, partition: Scheme) -> Whole {
    Whole {
        subdomains,
        partition,
        grains: problem.grain_count() as u64,
        contacts: problem.contact_count() as u64,
        depth: latin_dd::depth_of(problem),
        scaled_delassus_bound: M::scaled_delassus_bound(problem),
    }
}

#[cfg(test)]
mod tests;
