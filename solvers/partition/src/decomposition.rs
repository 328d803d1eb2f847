//! Subdomains with their own copies of the grains, and gluing, eq. (3).

use crate::scheme::Partition;
use contact::{ContactProblem, together};
use nalgebra::Vector2;
use rayon::prelude::*;

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
    /// By subdomain, its copies of boundary grains: local index, and k.
    of_subdomain: Vec<Vec<(u32, u32)>>,
    /// The place of each of `copies` in the list of its subdomain.
    place: Vec<u32>,
}

/// What it takes to fetch a copy that another thread wrote, about (ns).
const NS_PER_COPY: usize = 20;

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

        let mut multiplicity = vec![0; problem.grain_count()];
        for grain in subdomains.iter().flat_map(|subdomain| &subdomain.grains) {
            multiplicity[*grain as usize] += 1;
        }
        let (mut first, mut place_of) = (vec![0], vec![None; problem.grain_count()]);
        let mut end = 0;
        for (copies, place) in multiplicity.iter().zip(&mut place_of).filter(|(copies, _)| **copies > 1) {
            *place = Some(end);
            end += *copies as usize;
            first.push(end);
        }
        let mut copies = vec![(0, 0); end];
        for (e, subdomain) in (0_u32..).zip(&subdomains) {
            for (local, grain) in (0_u32..).zip(&subdomain.grains) {
                if let Some(place) = &mut place_of[*grain as usize] {
                    copies[*place] = (e, local);
                    *place += 1;
                }
            }
        }
        let mut of_subdomain = vec![Vec::new(); subdomains.len()];
        let mut place = Vec::with_capacity(copies.len());
        for (k, ends) in (0_u32..).zip(first.windows(2)) {
            for (e, local) in &copies[ends[0]..ends[1]] {
                let own = &mut of_subdomain[*e as usize];
                place.push(own.len() as u32);
                own.push((*local, k));
            }
        }
        Self { subdomains, multiplicity, copies, first, of_subdomain, place }
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

    /// Boundary grain by boundary grain, `join` makes what its copies have in common, `joined[k]`, from k and the copies
    /// (subdomain, local index). Returns the greatest of what `join` returns.
    pub fn join<T: Send>(
        &self,
        joined: &mut [T],
        join: impl Fn(usize, &[(u32, u32)], &mut T) -> f64 + Sync,
    ) -> f64 {
        let copies = |k: usize| &self.copies[self.first[k]..self.first[k + 1]];
        let grains =
            joined.par_iter_mut().enumerate().with_min_len(together(NS_PER_COPY * self.copies.len()));
        grains.map(|(k, joined)| join(k, copies(k), joined)).reduce(|| 0.0, f64::max)
    }

    /// Subdomain by subdomain, `take` does what follows for its copies of boundary grains: local indices and k.
    pub fn hand_back<S: Send>(&self, subdomains: &mut [S], take: impl Fn(&mut S, &[(u32, u32)]) + Sync) {
        let subdomains = subdomains.par_iter_mut().zip(&self.of_subdomain);
        let subdomains = subdomains.with_min_len(together(NS_PER_COPY * self.copies.len()));
        subdomains.for_each(|(subdomain, copies)| take(subdomain, copies));
    }

    /// Gluing, eq. (3) for equal copies: every copy moves at the plain mean V̄ of the copies. `y[E]` holds the copies of
    /// subdomain E in any unit that the copies of a grain share: V is `unit`·y (m/s), `unit` boundary grain by boundary
    /// grain, like `glued`, which takes the means. Returns the greatest |`V_E` − V̄| before gluing (m/s).
    pub fn glue(&self, y: &mut [Vec<Vector2<f64>>], unit: &[f64], glued: &mut [Vector2<f64>]) -> f64 {
        let jump = self.join(glued, |k, copies, mean| {
            let of = |(e, local): &(u32, u32)| y[*e as usize][*local as usize];
            // V̄ = Σ_E V_E / m_i
            *mean = copies.iter().map(of).sum::<Vector2<f64>>() / copies.len() as f64;
            copies.iter().map(|copy| unit[k] * (of(copy) - *mean).norm()).fold(0.0, f64::max)
        });
        self.move_copies(y, glued);
        jump
    }

    /// Gives every copy of a boundary grain what `joined` has for the grain.
    pub fn move_copies(&self, y: &mut [Vec<Vector2<f64>>], joined: &[Vector2<f64>]) {
        self.hand_back(y, |y, copies| {
            for (local, k) in copies {
                y[*local as usize] = joined[*k as usize];
            }
        });
    }

    /// Copies what subdomain `e` has of its boundary grains to `shown`, one place for each, where the others may read it.
    pub fn show(&self, e: usize, y: &[Vector2<f64>], shown: &mut [Vector2<f64>]) {
        for ((local, _), shown) in self.of_subdomain[e].iter().zip(shown) {
            *shown = y[*local as usize];
        }
    }

    /// Gives the copies in subdomain `e` of boundary grains the sum over all copies, once every subdomain has shown its own. It
    /// reads what was shown and writes to no other subdomain, so none waits for another after that.
    pub fn assemble(&self, e: usize, shown: &[Vec<Vector2<f64>>], y: &mut [Vector2<f64>]) {
        for (local, k) in &self.of_subdomain[e] {
            let copies = self.first[*k as usize]..self.first[*k as usize + 1];
            let copies = self.copies[copies.clone()].iter().zip(&self.place[copies]);
            y[*local as usize] = copies.map(|((e, _), place)| shown[*e as usize][*place as usize]).sum();
        }
    }

    /// Number of boundary grains.
    pub fn boundary_count(&self) -> usize {
        self.first.len() - 1
    }

    /// Number of copies of boundary grains in each subdomain.
    pub fn copies_by_subdomain(&self) -> impl Iterator<Item = usize> {
        self.of_subdomain.iter().map(Vec::len)
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
