//! Blocks of contacts for the threads, or of the ranks, and what they exchange.

use contact::{Column, ContactProblem, Discs, Mass, Mechanics, Packing, SetupError, Vector, threads};
use partition::{CopySums, Decomposition, Grid, Partition, Scheme, Share, Subdomain, Sums, Team};

/// The contacts of a problem cut into blocks, which meet between two passes only, at the grains that they share. They are for
/// the threads alone: how many there are depends on the problem, so no number of threads changes a bit. Where ranks share a problem,
/// each subdomain is a block.
pub struct Layout<M: Mechanics = Discs> {
    decomposition: Decomposition,
    /// The ranks, if there are some.
    team: Option<Team>,
    sums: CopySums<M::Velocity>,
    contacts: usize,
}

/// Approximate cost of a pass per contact (ns).
const NS_PER_CONTACT: usize = 3;

/// Contacts of a block, about: few enough that some threads have work where there is work for them, so many that blocks
/// share few grains.
const BLOCK: usize = 8192;

/// Columns and rows of blocks, and layers in space, of equal numbers of contacts.
fn grid(contacts: usize, axes: usize) -> Grid {
    let blocks = contacts.div_ceil(BLOCK).max(1) as u32;
    let n = (1..=blocks).find(|n| n.pow(axes as u32) >= blocks).unwrap_or(1);
    if axes > 2 { Grid { nx: n, ny: n, nz: n } } else { Grid::of(n, n) }
}

impl<M: Mechanics> Layout<M> {
    /// The blocks of `problem`.
    ///
    /// # Errors
    /// Where the contacts cannot be cut into blocks: there is no such problem.
    pub fn new(problem: &Packing<M>) -> Result<Self, SetupError> {
        let contacts = problem.contact_count();
        let partition = Partition::of_contacts(problem, Scheme::Balanced, grid(contacts, M::Place::LEN))?;
        let decomposition = Decomposition::new(problem, &partition);
        Ok(Self { sums: CopySums::new(&decomposition), decomposition, team: None, contacts })
    }

    /// The subdomains of a rank's share of a problem.
    pub fn of_share(share: &Share<M>, team: &Team) -> Self {
        Self {
            sums: CopySums::over(&share.decomposition, team),
            decomposition: share.decomposition.clone(),
            team: Some(team.clone()),
            contacts: share.problem.contact_count(),
        }
    }

    /// The sums of what each block adds, at all ranks.
    pub(crate) fn sum<const N: usize>(&self, parts: impl Iterator<Item = [f64; N]>) -> [f64; N] {
        match &self.team {
            None => parts.fold([0.0; N], |a, b| std::array::from_fn(|k| a[k] + b[k])),
            Some(team) => team.sum(parts),
        }
    }

    /// The least value at any rank.
    pub(crate) fn least(&self, here: f64) -> f64 {
        self.team.as_ref().map_or(here, |team| team.min(here))
    }

    /// The greatest value at any rank, or 0.
    pub fn greatest(&self, here: f64) -> f64 {
        self.team.as_ref().map_or(here, |team| team.max(here))
    }

    /// Returns the number of contacts of each block.
    pub fn contacts(&self) -> Vec<usize> {
        self.subdomains().iter().map(|block| block.contacts.len()).collect()
    }

    /// The contacts and grains of each block.
    pub(crate) fn subdomains(&self) -> &[Subdomain] {
        &self.decomposition.subdomains
    }

    /// Returns the data of a method for each block, made from its contacts and their columns, which are `scaled` by the diagonal of W or not.
    pub(crate) fn blocks<B: Send>(
        &self,
        problem: &ContactProblem<M>,
        scaled: bool,
        block: impl Fn(Units<M>, Vec<M::Column>, &Subdomain) -> B + Sync,
    ) -> Vec<B> {
        let subdomains = self.subdomains();
        threads::make(subdomains.len(), &|e| {
            let (units, of_h) = Units::new(problem, &self.decomposition, &subdomains[e], scaled);
            block(units, of_h, &subdomains[e])
        })
    }

    /// A pass over all blocks, in which each sends what it has of the grains it shares, in the order of [`Subdomain::boundary`].
    pub(crate) fn send<B: Send>(
        &mut self,
        blocks: &mut [B],
        pass: impl Fn(&mut B, &mut [M::Velocity]) + Sync,
    ) {
        self.sums.send(blocks, NS_PER_CONTACT * self.contacts, pass);
    }

    /// A pass over all blocks, in which each takes the sums of what all have sent.
    pub(crate) fn receive<B: Send>(
        &self,
        blocks: &mut [B],
        pass: impl Fn(&mut B, Sums<'_, M::Velocity>) + Sync,
    ) {
        self.sums.receive(blocks, NS_PER_CONTACT * self.contacts, pass);
    }

    /// A pass over all blocks in which they exchange nothing.
    pub(crate) fn each<B: Send>(&self, blocks: &mut [B], make: impl Fn(&mut B) + Sync) {
        threads::each(blocks, NS_PER_CONTACT * self.contacts, &|_, block| make(block));
    }
}

/// The contacts of a block by their numbers in the problem, with their units, and the grains that it shares.
pub(crate) struct Units<M: Mechanics> {
    /// The problem's contact of each column.
    contact: Vec<u32>,
    /// 1, or √`W_αα` (kg^-½) for columns of H̃.
    unit: Vec<M::Impulse>,
    /// The grains that blocks share.
    pub(crate) boundary: Vec<u32>,
    /// 1 over the number of blocks that have the grain: sums over the grains then count each once.
    pub(crate) share: Vec<f64>,
}

impl<M: Mechanics> Units<M> {
    /// Returns the contacts of a subdomain, and their columns of M^-½ H, or of H̃ where they are `scaled`.
    fn new(
        problem: &ContactProblem<M>,
        decomposition: &Decomposition,
        subdomain: &Subdomain,
        scaled: bool,
    ) -> (Self, Vec<M::Column>) {
        let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
        let column = |(contact, ends): (&u32, &(u32, Option<u32>))| {
            M::Column::new(&problem.contacts()[*contact as usize], *ends, inverse_mass, scaled)
        };
        let share = |grain: &u32| 1.0 / f64::from(decomposition.multiplicity[*grain as usize]);
        let (columns, unit) = subdomain.contacts.iter().zip(&subdomain.ends).map(column).unzip();
        let contacts = Self {
            contact: subdomain.contacts.clone(),
            unit,
            boundary: subdomain.boundary.clone(),
            share: subdomain.grains.iter().map(share).collect(),
        };
        (contacts, columns)
    }

    /// The problem's contact and the unit of each column.
    pub(crate) fn each(&self) -> impl Iterator<Item = (usize, M::Impulse)> {
        self.contact.iter().map(|contact| *contact as usize).zip(self.unit.iter().copied())
    }

    /// Puts impulses, of which `r` gives the unit times each, in the problem's order (N·s).
    pub(crate) fn impulses(&self, r: impl Iterator<Item = M::Impulse>, impulses: &mut [f64]) {
        for (r, (contact, unit)) in r.zip(self.each()) {
            r.with(unit, |r, unit| r / unit).put(impulses, contact);
        }
    }
}
