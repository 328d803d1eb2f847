//! Subdomains with their own copies of the grains.

use crate::scheme::Partition;
use contact::{ContactProblem, Mechanics, Touch};

/// One subdomain E: its contacts, and its own copy of each grain that they touch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subdomain {
    /// Indices of its contacts in the problem, rising.
    pub contacts: Vec<u32>,
    /// Indices in the problem of the grains that its contacts touch, in the order in which they first do. The place
    /// in this list is the grain's local index.
    pub grains: Vec<u32>,
    /// Local indices of each contact's candidate and antagonist; `None` for a wall.
    pub ends: Vec<(u32, Option<u32>)>,
    /// Local indices of its copies of boundary grains, in the order of the problem's grains.
    pub boundary: Vec<u32>,
}

/// A contact problem cut along its boundary grains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decomposition {
    /// The subdomains; some may have no contact.
    pub subdomains: Vec<Subdomain>,
    /// `m_i`: in how many subdomains each grain has contacts; 0 for a grain without contact.
    pub multiplicity: Vec<u32>,
    /// The copies of each boundary grain, in the order of the subdomains: subdomain, and number among its copies.
    pub boundary: Vec<Vec<(u32, u32)>>,
}

impl Decomposition {
    /// Cuts `problem` along `partition`.
    ///
    /// # Panics
    /// If the partition is not one of this problem's contacts.
    pub fn new<M: Mechanics>(problem: &ContactProblem<M>, partition: &Partition) -> Self {
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
        let mut subdomains: Vec<Subdomain> = contacts_of
            .into_iter()
            .map(|contacts| Subdomain::new(problem, contacts, &mut local_of))
            .collect();

        let mut multiplicity = vec![0; problem.grain_count()];
        for grain in subdomains.iter().flat_map(|subdomain| &subdomain.grains) {
            multiplicity[*grain as usize] += 1;
        }
        let mut boundary = vec![Vec::new(); problem.grain_count()];
        for (e, subdomain) in (0_u32..).zip(&mut subdomains) {
            let places = (0_u32..).zip(&subdomain.grains);
            let mut copies: Vec<_> = places.filter(|(_, grain)| multiplicity[**grain as usize] > 1).collect();
            copies.sort_by_key(|(_, grain)| **grain);
            for (k, (_, grain)) in (0_u32..).zip(&copies) {
                boundary[**grain as usize].push((e, k));
            }
            subdomain.boundary = copies.into_iter().map(|(local, _)| local).collect();
        }
        boundary.retain(|copies| !copies.is_empty());
        Self { subdomains, multiplicity, boundary }
    }

    /// Number of copies of boundary grains.
    pub fn copy_count(&self) -> usize {
        self.boundary.iter().map(Vec::len).sum()
    }
}

impl Subdomain {
    /// The problem's index of each of its boundary grains.
    pub fn boundary_grains(&self) -> impl Iterator<Item = u32> + Clone {
        self.boundary.iter().map(|local| self.grains[*local as usize])
    }

    /// `local_of` is scratch: `None` for every grain, before and after.
    fn new<M: Mechanics>(
        problem: &ContactProblem<M>,
        contacts: Vec<u32>,
        local_of: &mut [Option<u32>],
    ) -> Self {
        let mut grains = Vec::new();
        let mut local = |grain: u32| {
            *local_of[grain as usize].get_or_insert_with(|| {
                grains.push(grain);
                grains.len() as u32 - 1
            })
        };
        let ends = contacts
            .iter()
            .map(|contact| {
                let (candidate, antagonist) = problem.contacts()[*contact as usize].ends();
                (local(candidate), antagonist.map(&mut local))
            })
            .collect();
        for grain in &grains {
            local_of[*grain as usize] = None;
        }
        Self { contacts, grains, ends, boundary: Vec::new() }
    }
}
