//! Share of a rank in a problem that is cut into subdomains: its own contacts, and the grains that they touch.

use crate::decomposition::{Decomposition, Subdomain};
use crate::grid::Grid;
use crate::scheme::Scheme;
use crate::team::Team;
use contact::{Iteration, Mechanics, Packing, ProblemError, SetupError, Solver, Touch};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

/// Facts about the whole problem that every rank must know.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Whole {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// Scheme by which the contacts are distributed.
    pub partition: Scheme,
    /// Number of grains.
    pub grains: u64,
    /// Number of contacts.
    pub contacts: u64,
    /// Grains on the longest of the shortest ways from a grain to a wall that pushes.
    pub depth: u32,
    /// Λ ≥ λmax(W_D⁻¹ W) (–).
    pub scaled_delassus_bound: f64,
}

/// Some subdomains, one after the other, as a problem of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Share<M: Mechanics> {
    /// Their contacts and grains, in the order of the whole problem, with their own numbers.
    pub problem: Packing<M>,
    /// Decomposition of these contacts; the copies of others stand beside them.
    pub decomposition: Decomposition,
    /// The whole problem's number of each contact.
    pub contacts: Vec<u32>,
    /// The whole problem's number of each grain.
    pub grains: Vec<u32>,
    /// Whole problem of which they are a part.
    pub whole: Whole,
}

/// Why a method does not start on the shares of several ranks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refused {
    /// For a reason of this rank, or of all.
    #[error(transparent)]
    Here(#[from] SetupError),
    /// For a reason of another rank.
    #[error("another rank cannot start")]
    Elsewhere,
}

/// A method whose subdomains may be those of several ranks.
pub trait Distributed<M: Mechanics>: Solver<M> {
    /// Binds the method to the share of this rank, from its impulses `r0` (N·s); all of the `team` must do it. Impulses are in the
    /// order of the share's contacts, and counted work is that of this rank.
    ///
    /// # Errors
    /// Those of [`Solver::start`], at all ranks if at one.
    fn start_in<'p>(
        &self,
        share: &'p Share<M>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused>;
}

impl Team {
    /// Returns the result of this rank, if all ranks succeeded.
    ///
    /// # Errors
    /// The own reason, or that another rank has one.
    pub fn unless_refused<T>(&self, own: Result<T, SetupError>) -> Result<T, Refused> {
        if self.all(own.is_ok()) {
            Ok(own?)
        } else {
            Err(own.err().map_or(Refused::Elsewhere, Refused::Here))
        }
    }
}

impl From<Refused> for SetupError {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::Here(error) => error,
            Refused::Elsewhere => {
                Self::new("ranks", "such that another rank cannot start", "able to, all of them")
            }
        }
    }
}

impl<M: Mechanics> Share<M> {
    /// The subdomain `e` of a problem that is cut in this way.
    ///
    /// # Errors
    /// None: what is taken from a problem is valid.
    pub fn of_subdomain(
        problem: &Packing<M>,
        decomposition: &Decomposition,
        e: usize,
        whole: Whole,
    ) -> Result<Self, ProblemError> {
        let subdomain = &decomposition.subdomains[e];
        let number = decomposition.first + e as u32;
        let mut grains = subdomain.grains.clone();
        grains.sort_unstable();
        let of = |all: &[u32]| -> Vec<u32> { all.iter().map(|grain| place(&grains, *grain)).collect() };
        let is_here = |copies: &&Vec<(u32, u32)>| copies.iter().any(|(f, _)| *f == number);
        let local = Subdomain {
            contacts: (0..subdomain.contacts.len() as u32).collect(),
            grains: of(&subdomain.grains),
            ..subdomain.clone()
        };
        Ok(Self {
            problem: some_of(problem, &subdomain.contacts, &grains)?,
            decomposition: Decomposition {
                subdomains: vec![local],
                first: number,
                multiplicity: grains
                    .iter()
                    .map(|grain| decomposition.multiplicity[*grain as usize])
                    .collect(),
                boundary: decomposition.boundary.iter().filter(is_here).cloned().collect(),
            },
            contacts: subdomain.contacts.clone(),
            grains,
            whole,
        })
    }

    /// The subdomains of `shares`, which follow each other, as one share.
    ///
    /// # Errors
    /// Names the first grain that is not the same in two of them.
    ///
    /// # Panics
    /// Of no share.
    pub fn joined(mut shares: Vec<Self>) -> Result<Self, ProblemError> {
        assert!(!shares.is_empty(), "a rank has a subdomain");
        if shares.len() == 1 {
            return Ok(shares.remove(0));
        }
        let mut grains: Vec<u32> = shares.iter().flat_map(|share| &share.grains).copied().collect();
        grains.sort_unstable();
        grains.dedup();
        let numbers =
            |share: usize| (0_u32..).zip(&shares[share].contacts).map(move |(k, number)| (*number, share, k));
        let mut order: Vec<(u32, usize, u32)> = (0..shares.len()).flat_map(numbers).collect();
        order.sort_unstable();
        let contacts: Vec<u32> = order.iter().map(|(number, _, _)| *number).collect();

        let (mut first_with, mut boundary) = (vec![None; grains.len()], BTreeMap::new());
        let mut subdomains = Vec::new();
        for (s, share) in shares.iter().enumerate() {
            let cut = &share.decomposition;
            for (k, grain) in share.grains.iter().enumerate() {
                first_with[place(&grains, *grain) as usize].get_or_insert((s, k));
            }
            let number = |local: u32| share.grains[local as usize];
            for copies in &cut.boundary {
                let own = copies.iter().find_map(|(e, k)| {
                    let subdomain = cut.subdomains.get(e.checked_sub(cut.first)? as usize)?;
                    Some(number(subdomain.grains[subdomain.boundary[*k as usize] as usize]))
                });
                boundary.insert(own, copies.clone());
            }
            subdomains.extend(
                cut.subdomains.iter().map(|subdomain| Subdomain {
                    contacts: subdomain
                        .contacts
                        .iter()
                        .map(|k| place(&contacts, share.contacts[*k as usize]))
                        .collect(),
                    grains: subdomain.grains.iter().map(|grain| place(&grains, number(*grain))).collect(),
                    ..subdomain.clone()
                }),
            );
        }
        let of: Vec<(usize, usize)> = first_with.into_iter().flatten().collect();
        let each = |(s, k): &(usize, usize)| (&shares[*s], *k);
        let moved = |(_, s, k): &(u32, usize, u32)| {
            let (share, contact) = (&shares[*s], &shares[*s].problem.contacts()[*k as usize]);
            let (i, j) = contact.ends();
            let new = |grain: u32| place(&grains, share.grains[grain as usize]);
            contact.between(new(i), j.map(new))
        };
        Ok(Self {
            problem: Packing::new(
                of.iter().map(each).map(|(share, k)| share.problem.mass()[k]).collect(),
                of.iter().map(each).map(|(share, k)| share.problem.position()[k]).collect(),
                of.iter().map(each).map(|(share, k)| share.problem.free_velocity()[k]).collect(),
                order.iter().map(moved).collect(),
            )?,
            decomposition: Decomposition {
                subdomains,
                first: shares[0].decomposition.first,
                multiplicity: of
                    .iter()
                    .map(each)
                    .map(|(share, k)| share.decomposition.multiplicity[k])
                    .collect(),
                boundary: boundary.into_values().collect(),
            },
            whole: shares[0].whole,
            contacts,
            grains,
        })
    }

    /// The own subdomains of a rank of a problem that is cut in this way.
    ///
    /// # Errors
    /// None: what is taken from a problem is valid.
    pub fn of_rank(
        problem: &Packing<M>,
        decomposition: &Decomposition,
        team: &Team,
        whole: Whole,
    ) -> Result<Self, ProblemError> {
        let shares = team.mine().map(|e| Self::of_subdomain(problem, decomposition, e, whole));
        Self::joined(shares.collect::<Result<_, _>>()?)
    }
}

/// The place of a number in a rising list that has it.
fn place(numbers: &[u32], number: u32) -> u32 {
    numbers.partition_point(|other| *other < number) as u32
}

/// Some contacts of a problem, between some grains, which have those that the contacts touch; both rising.
///
/// # Errors
/// None: what is taken from a problem is valid.
pub fn some_of<M: Mechanics>(
    problem: &Packing<M>,
    contacts: &[u32],
    grains: &[u32],
) -> Result<Packing<M>, ProblemError> {
    let contact = |k: &u32| {
        let contact = &problem.contacts()[*k as usize];
        let (i, j) = contact.ends();
        contact.between(place(grains, i), j.map(|j| place(grains, j)))
    };
    Packing::new(
        grains.iter().map(|grain| problem.mass()[*grain as usize]).collect(),
        grains.iter().map(|grain| problem.position()[*grain as usize]).collect(),
        grains.iter().map(|grain| problem.free_velocity()[*grain as usize]).collect(),
        contacts.iter().map(contact).collect(),
    )
}
