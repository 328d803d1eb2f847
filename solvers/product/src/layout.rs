//! Blocks of contacts for the threads, and what they exchange.

use contact::scaled::{ScaledContact, inverse_masses};
use contact::{ContactProblem, Packing, SetupError, together};
use nalgebra::Vector2;
use partition::{CopySums, Decomposition, Grid, Partition, Scheme, Subdomain, Sums};
use rayon::prelude::*;

/// The contacts of a problem cut into blocks, which meet between two passes only, at the grains that they share. They are for
/// the threads alone: how many there are depends on the problem, so no number of threads changes a bit.
pub struct Layout {
    decomposition: Decomposition,
    sums: CopySums<Vector2<f64>>,
    contacts: usize,
}

/// What a pass takes per contact, about (ns).
const NS_PER_CONTACT: usize = 3;

/// Contacts of a block, about: few enough that some threads have work where there is work for them, so many that blocks
/// share few grains.
const BLOCK: usize = 8192;

/// Columns and rows of blocks, of equal numbers of contacts.
fn grid(contacts: usize) -> Grid {
    let blocks = contacts.div_ceil(BLOCK).max(1);
    let n = (blocks - 1).isqrt() as u32 + 1;
    Grid { nx: n, ny: n }
}

impl Layout {
    /// The blocks of `problem`.
    ///
    /// # Errors
    /// Where the contacts cannot be cut into blocks: there is no such problem.
    pub fn new(problem: &Packing) -> Result<Self, SetupError> {
        let contacts = problem.contact_count();
        let partition = Partition::of_contacts(problem, Scheme::Balanced, grid(contacts))?;
        let decomposition = Decomposition::new(problem, &partition);
        Ok(Self { sums: CopySums::new(&decomposition), decomposition, contacts })
    }

    /// What a method knows of each block, from its contacts and grains.
    pub fn blocks<B: Send>(&self, block: impl Fn(&Subdomain) -> B + Sync) -> Vec<B> {
        self.decomposition.subdomains.par_iter().map(&block).collect()
    }

    /// 1 over the number of blocks that have the grain, for each grain of one: sums over the grains then count each once.
    pub fn shares(&self, subdomain: &Subdomain) -> Vec<f64> {
        let share = |grain: &u32| 1.0 / f64::from(self.decomposition.multiplicity[*grain as usize]);
        subdomain.grains.iter().map(share).collect()
    }

    /// A pass over all blocks, in which each sends what it has of the grains it shares, in the order of [`Subdomain::boundary`].
    pub fn send<B: Send>(&mut self, blocks: &mut [B], pass: impl Fn(&mut B, &mut [Vector2<f64>]) + Sync) {
        self.sums.send(blocks, NS_PER_CONTACT * self.contacts, pass);
    }

    /// A pass over all blocks, in which each takes the sums of what all have sent.
    pub fn receive<B: Send>(&self, blocks: &mut [B], pass: impl Fn(&mut B, Sums<'_, Vector2<f64>>) + Sync) {
        self.sums.receive(blocks, NS_PER_CONTACT * self.contacts, pass);
    }

    /// A pass over all blocks in which they exchange nothing.
    pub fn each<B: Send>(&self, blocks: &mut [B], make: impl Fn(&mut B) + Sync) {
        let together = together(NS_PER_CONTACT * self.contacts);
        blocks.par_iter_mut().with_min_len(together).for_each(&make);
    }
}

/// The contacts of a block as columns, in its local indices, and the unit of each: 1 for columns of M^-½ H, or √`W_αα` (kg^-½)
/// for those of H̃ if they are to be `scaled` by the diagonal of W.
pub fn columns(
    problem: &ContactProblem,
    subdomain: &Subdomain,
    scaled: bool,
) -> (Vec<ScaledContact>, Vec<f64>) {
    let column = |k: usize| {
        let contact = &problem.contacts()[subdomain.contacts[k] as usize];
        let (inverse_mass, root) =
            inverse_masses(contact.ends(), |grain| 1.0 / problem.mass()[grain as usize]);
        let unit = if scaled { root } else { 1.0 };
        (ScaledContact::new(subdomain.ends[k], contact.normal, inverse_mass, unit), unit)
    };
    (0..subdomain.contacts.len()).map(column).unzip()
}

/// Copies what a block has of the grains at `places` to `sent`.
pub fn send_of(places: &[u32], y: &[Vector2<f64>], sent: &mut [Vector2<f64>]) {
    for (place, sent) in places.iter().zip(sent) {
        *sent = y[*place as usize];
    }
}

/// Gives the grains at `places` the `sums` over the blocks.
pub fn take_sums(places: &[u32], y: &mut [Vector2<f64>], sums: Sums<'_, Vector2<f64>>) {
    for (place, sum) in places.iter().zip(sums) {
        y[*place as usize] = sum;
    }
}
