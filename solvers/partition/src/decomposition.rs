//! Subdomains with their own copies of the grains.

use crate::scheme::Partition;
use crate::team::Team;
use contact::{ContactProblem, Mechanics, Touch};
use std::collections::BTreeSet;

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

/// A contact problem cut along its boundary grains; or what one of several ranks has of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decomposition {
    /// The subdomains, or those of a rank; some may have no contact.
    pub subdomains: Vec<Subdomain>,
    /// Number of the first of them among all.
    pub first: u32,
    /// `m_i`: in how many subdomains each grain has contacts; 0 for a grain without contact.
    pub multiplicity: Vec<u32>,
    /// The copies of each boundary grain, in the order of the subdomains: subdomain among all, and number among its copies. Those
    /// of other ranks stand beside the own ones.
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
        Self { subdomains, first: 0, multiplicity, boundary }
    }

    /// Number of copies of boundary grains in these subdomains.
    pub fn copy_count(&self) -> usize {
        self.subdomains.iter().map(|subdomain| subdomain.boundary.len()).sum()
    }

    /// With how many others the subdomain with most neighbours shares grains; and how many values of copies the one that sends most
    /// sends them, one of each of its copies to each other copy of that grain.
    pub fn greatest_exchange(&self) -> (u32, u64) {
        let mut of_each = vec![(BTreeSet::new(), 0_u64); self.subdomains.len()];
        for copies in &self.boundary {
            for (e, _) in copies {
                let own = e.checked_sub(self.first).and_then(|e| of_each.get_mut(e as usize));
                if let Some((neighbours, sent)) = own {
                    neighbours.extend(copies.iter().map(|(f, _)| *f).filter(|f| f != e));
                    *sent += copies.len() as u64 - 1;
                }
            }
        }
        of_each.iter().fold((0, 0), |(most, greatest), (neighbours, sent)| {
            (most.max(neighbours.len() as u32), greatest.max(*sent))
        })
    }

    /// Greedy colours of all subdomains: each, in their order, takes the least that none before it has with which it shares a grain.
    pub fn colours(&self, team: &Team) -> Vec<u32> {
        let mut neighbours = vec![BTreeSet::new(); self.subdomains.len()];
        for copies in &self.boundary {
            for (e, _) in copies {
                if let Some(neighbours) =
                    e.checked_sub(self.first).and_then(|e| neighbours.get_mut(e as usize))
                {
                    neighbours.extend(copies.iter().map(|(f, _)| *f).filter(|f| f < e));
                }
            }
        }
        let colours = team.in_turn(vec![0.0; team.subdomains()], |colours| {
            for (e, neighbours) in (self.first as usize..).zip(&neighbours) {
                let taken: BTreeSet<u32> = neighbours.iter().map(|f| colours[*f as usize] as u32).collect();
                let least = (0..taken.len() as u32).find(|colour| !taken.contains(colour));
                colours[e] = f64::from(least.unwrap_or(taken.len() as u32));
            }
        });
        colours.into_iter().map(|colour| colour as u32).collect()
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
