//! Subdomains with their own copies of the grains, and gluing, eq. (3).

use crate::scheme::Partition;
use contact::ContactProblem;
use nalgebra::Vector2;

/// One subdomain E: its contacts, and its own copy of each grain that they touch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subdomain {
    /// Indices of its contacts in the problem, rising.
    pub contacts: Vec<u32>,
    /// Indices in the problem of the grains that its contacts touch, in the order in which they first do. The place
    /// in this list is the grain's local index.
    pub grains: Vec<u32>,
    /// Local index of each contact's candidate.
    pub candidate: Vec<u32>,
    /// Local index of each contact's antagonist; `None` for a wall.
    pub antagonist: Vec<Option<u32>>,
}

/// A contact problem cut along its boundary grains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decomposition {
    /// The subdomains; some may have no contact.
    pub subdomains: Vec<Subdomain>,
    /// `m_i`: in how many subdomains each grain has contacts; 0 for a grain without contact.
    pub multiplicity: Vec<u32>,
    /// The copies (subdomain, local index) of all boundary grains, grain after grain.
    copies: Vec<(u32, u32)>,
    /// Boundary grain k has the copies `copies[first[k]..first[k + 1]]`.
    first: Vec<usize>,
}

impl Decomposition {
    /// Cuts `problem` along `partition`.
    ///
    /// # Panics
    /// If the partition is not one of this problem's contacts.
    pub fn new(problem: &ContactProblem, partition: &Partition) -> Self {
        assert_eq!(
            partition.subdomain.len(),
            problem.contact_count(),
            "a partition gives every contact of its problem one subdomain"
        );
        let mut contacts_of = vec![Vec::new(); partition.count as usize];
        for (contact, subdomain) in (0_u32..).zip(&partition.subdomain) {
            contacts_of[*subdomain as usize].push(contact);
        }
        let mut local_of = vec![None; problem.grain_count()];
        let subdomains: Vec<Subdomain> = contacts_of
            .into_iter()
            .map(|contacts| Subdomain::new(problem, contacts, &mut local_of))
            .collect();

        let mut copies_of: Vec<Vec<(u32, u32)>> = vec![Vec::new(); problem.grain_count()];
        for (e, subdomain) in (0_u32..).zip(&subdomains) {
            for (local, grain) in (0_u32..).zip(&subdomain.grains) {
                copies_of[*grain as usize].push((e, local));
            }
        }
        let multiplicity = copies_of.iter().map(|copies| copies.len() as u32).collect();
        let (mut copies, mut first) = (Vec::new(), vec![0]);
        for boundary in copies_of.iter().filter(|copies| copies.len() > 1) {
            copies.extend_from_slice(boundary);
            first.push(copies.len());
        }
        Self { subdomains, multiplicity, copies, first }
    }

    /// The copies (subdomain, local index) of each boundary grain.
    pub fn boundary(&self) -> impl Iterator<Item = &[(u32, u32)]> {
        self.first.windows(2).map(|ends| &self.copies[ends[0]..ends[1]])
    }

    /// Brings values that are given subdomain by subdomain, in the order of their contacts, into the order of the problem.
    pub fn in_problem_order<'a>(&self, by_subdomain: impl Iterator<Item = &'a [f64]>, values: &mut [f64]) {
        for (subdomain, own) in self.subdomains.iter().zip(by_subdomain) {
            for (contact, value) in subdomain.contacts.iter().zip(own) {
                values[*contact as usize] = *value;
            }
        }
    }

    /// Number of copies of boundary grains.
    pub fn copy_count(&self) -> usize {
        self.copies.len()
    }

    /// Gluing, eq. (3) for equal copies: every copy moves at the plain mean V̄ of the copies. `y[E]` holds the copies of
    /// subdomain E in any unit that the copies of a grain share: V is `unit`·y (m/s), `unit` boundary grain by boundary
    /// grain. Returns the greatest |`V_E` − V̄| before gluing (m/s).
    pub fn glue(&self, y: &mut [Vec<Vector2<f64>>], unit: &[f64]) -> f64 {
        let mut jump: f64 = 0.0;
        for (copies, unit) in self.boundary().zip(unit) {
            let of = |(e, local): &(u32, u32)| y[*e as usize][*local as usize];
            // V̄ = Σ_E V_E / m_i
            let mean = copies.iter().map(of).sum::<Vector2<f64>>() / copies.len() as f64;
            for (e, local) in copies {
                let copy = &mut y[*e as usize][*local as usize];
                jump = jump.max(unit * (*copy - mean).norm());
                *copy = mean;
            }
        }
        jump
    }

    /// Number of copies of boundary grains in each subdomain.
    pub fn copies_by_subdomain(&self) -> Vec<usize> {
        let mut copies = vec![0; self.subdomains.len()];
        self.copies.iter().for_each(|(e, _)| copies[*e as usize] += 1);
        copies
    }

    /// Gives every copy of a boundary grain the sum over its copies.
    pub fn assemble(&self, y: &mut [Vec<Vector2<f64>>]) {
        for copies in self.boundary() {
            let sum: Vector2<f64> = copies.iter().map(|(e, local)| y[*e as usize][*local as usize]).sum();
            for (e, local) in copies {
                y[*e as usize][*local as usize] = sum;
            }
        }
    }

    /// The problem's index of each boundary grain.
    pub fn boundary_grains(&self) -> impl Iterator<Item = u32> {
        self.boundary().map(|copies| self.subdomains[copies[0].0 as usize].grains[copies[0].1 as usize])
    }
}

impl Subdomain {
    /// `local_of` is scratch: `None` for every grain, before and after.
    fn new(problem: &ContactProblem, contacts: Vec<u32>, local_of: &mut [Option<u32>]) -> Self {
        let mut grains = Vec::new();
        let mut local = |grain: u32| {
            *local_of[grain as usize].get_or_insert_with(|| {
                grains.push(grain);
                grains.len() as u32 - 1
            })
        };
        let (candidate, antagonist) = contacts
            .iter()
            .map(|contact| {
                let contact = &problem.contacts()[*contact as usize];
                (local(contact.candidate), contact.antagonist.map(&mut local))
            })
            .unzip();
        for grain in &grains {
            local_of[*grain as usize] = None;
        }
        Self { contacts, grains, candidate, antagonist }
    }
}
