//! The ranks of MPI.

use mpi::Threading;
use mpi::environment::Universe;
use mpi::request::multiple_scope;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Source};
use partition::{Parcel, Post};

/// MPI, begun; it ends with this.
pub struct World {
    universe: Universe,
}

/// The ranks of all processes. What MPI knows of them is asked from it each time.
struct Ranks {
    rank: usize,
    size: usize,
}

impl World {
    /// Begins MPI; `None` if it was begun before, or does not allow that a thread other than the first speaks.
    pub fn begin() -> Option<Self> {
        let (universe, threading) = mpi::initialize_with_threading(Threading::Serialized)?;
        (threading >= Threading::Serialized).then_some(Self { universe })
    }

    /// The ranks of all processes.
    pub fn post(&self) -> impl Post + use<> {
        let world = self.universe.world();
        Ranks { rank: world.rank() as usize, size: world.size() as usize }
    }

    /// Ends all ranks at once, this one with an exit code: for what the others cannot be told.
    pub fn abort(code: i32) -> ! {
        SimpleCommunicator::world().abort(code)
    }
}

impl Post for Ranks {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn swap(&self, sent: &[Parcel], received: &mut [Parcel]) {
        let world = SimpleCommunicator::world();
        let others = sent.len() + received.len();
        multiple_scope(sent.len(), |scope, sends| {
            multiple_scope(received.len(), |scope_of_receives, receives| {
                for Parcel { rank, numbers } in received {
                    let from = world.process_at_rank(number(*rank));
                    receives.add(from.immediate_receive_into(scope_of_receives, &mut numbers[..]));
                }
                for Parcel { rank, numbers } in sent {
                    sends.add(world.process_at_rank(number(*rank)).immediate_send(scope, &numbers[..]));
                }
                receives.wait_all(&mut Vec::with_capacity(others));
            });
            sends.wait_all(&mut Vec::with_capacity(others));
        });
    }
}

/// As MPI has it, which counted them.
fn number(rank: usize) -> i32 {
    i32::try_from(rank).unwrap_or(i32::MAX)
}
