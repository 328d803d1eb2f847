//! The share of a rank in a problem, whatever the mechanics; and the first line of the file of a subdomain.

use crate::facts::{Facts, facts};
use crate::form::{Form, unless_admissible};
use anyhow::{Context, Result, bail};
use cases::{AnyFrozen, Frozen};
use contact::{Mechanics, Vector};
use partition::{Decomposition, Partition, Share, Whole};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
#[cfg(feature = "on-ranks")]
use {
    crate::methods::Ours,
    partition::{Refused, Team},
    runner::{Beside, Measured, OnRanks, Progress, Stop, solve_on_ranks},
    std::ops::ControlFlow,
};

/// Format of the file of a subdomain.
pub const FORMAT: &str = "gravel/subdomain/2";

/// The first line of the file of a subdomain.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// [`FORMAT`].
    pub format: String,
    /// Hash of the whole problem.
    pub problem_hash: String,
    /// Facts about the whole problem.
    pub whole: Whole,
    /// The number of this subdomain among all.
    pub subdomain: u32,
    /// The whole problem's numbers of its grains, in the order of the second line.
    pub grains: Vec<u32>,
    /// The whole problem's numbers of its contacts.
    pub contacts: Vec<u32>,
    /// Its copies of boundary grains, in their order: the grain, by its place in the second line, and all copies, each by its
    /// subdomain and its number there.
    pub boundary: Vec<(u32, Vec<(u32, u32)>)>,
}

impl Part {
    /// The first line of the file of a share that is one subdomain.
    pub(crate) fn of<M: Mechanics>(share: &Share<M>, problem_hash: &str) -> Self {
        let (cut, e) = (&share.decomposition, share.decomposition.first);
        let place = |copies: &Vec<(u32, u32)>| {
            let (_, k) = *copies.iter().find(|(f, _)| *f == e)?;
            let subdomain = &cut.subdomains[0];
            Some((subdomain.grains[subdomain.boundary[k as usize] as usize], copies.clone()))
        };
        Self {
            format: FORMAT.to_owned(),
            problem_hash: problem_hash.to_owned(),
            whole: share.whole,
            subdomain: e,
            boundary: cut.boundary.iter().filter_map(place).collect(),
            grains: share.grains.clone(),
            contacts: share.contacts.clone(),
        }
    }

    /// The share of a rank that has this subdomain alone, of whose second line `problem` is.
    fn share<M: Form>(self, Frozen { problem, .. }: Frozen<M>) -> Result<Share<M>> {
        let (grains, contacts) = (problem.grain_count(), problem.contact_count());
        if (self.grains.len(), self.contacts.len()) != (grains, contacts) {
            bail!(
                "`grains` and `contacts` have not one number for each of {grains} grains and {contacts} contacts"
            );
        }
        let all_here = Partition { subdomain: vec![0; contacts], count: 1 };
        let mut decomposition = Decomposition::new(&problem, &all_here);
        let mut local = vec![0; grains];
        for (k, grain) in (0..).zip(&decomposition.subdomains[0].grains) {
            local[*grain as usize] = k;
        }
        decomposition.first = self.subdomain;
        for (k, (grain, copies)) in (0..).zip(self.boundary) {
            let known = local.get(grain as usize).filter(|_| copies.contains(&(self.subdomain, k)));
            let Some(place) = known else { bail!("`boundary[{k}]` is not a copy of this subdomain") };
            decomposition.subdomains[0].boundary.push(*place);
            decomposition.multiplicity[grain as usize] = copies.len() as u32;
            decomposition.boundary.push(copies);
        }
        Ok(Share { problem, decomposition, contacts: self.contacts, grains: self.grains, whole: self.whole })
    }
}

/// The share of a rank in a problem. Impulses (N·s) are flat lists, in the order of its contacts.
pub trait OneShare {
    /// Returns the kind and size of what the rank has.
    fn facts(&self) -> Facts;

    /// Returns the facts about the whole problem.
    fn whole(&self) -> &Whole;

    /// Returns the whole problem's number of each contact.
    fn contacts(&self) -> &[u32];

    /// Returns its subdomains, the first by its number among all.
    fn decomposition(&self) -> &Decomposition;

    /// Refuses an impulse of contact `k` that the law does not admit.
    ///
    /// # Errors
    /// Says what it must be.
    fn unless_admissible(&self, k: usize, r: &[f64]) -> Result<()>;

    /// Runs a method on the shares of all ranks, which all must do.
    ///
    /// # Errors
    /// Names the method that has no subdomains; a setting that has no meaning, at all ranks if at one.
    #[cfg(feature = "on-ranks")]
    fn solve(
        &self,
        team: &Team,
        ours: &Ours,
        beside: Beside,
        stop: &Stop,
        measured: Measured,
        observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Result<OnRanks, Refused>>;
}

impl dyn OneShare + '_ {
    /// Returns the impulses of the share, from those of the whole problem, `r`.
    pub fn own(&self, r: &[f64]) -> Vec<f64> {
        let of_contact = self.facts().of_contact;
        let own = self.contacts().iter().flat_map(|k| &r[of_contact * *k as usize..][..of_contact]);
        own.copied().collect()
    }
}

impl<M: Form> OneShare for Share<M> {
    fn facts(&self) -> Facts {
        facts::<M>(self.problem.grain_count(), self.problem.contact_count())
    }

    fn whole(&self) -> &Whole {
        &self.whole
    }

    fn contacts(&self) -> &[u32] {
        &self.contacts
    }

    fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    fn unless_admissible(&self, k: usize, r: &[f64]) -> Result<()> {
        unless_admissible::<M>(&self.problem.contacts()[k], M::Impulse::at(r, 0))
    }

    #[cfg(feature = "on-ranks")]
    fn solve(
        &self,
        team: &Team,
        ours: &Ours,
        beside: Beside,
        stop: &Stop,
        measured: Measured,
        observe: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Result<OnRanks, Refused>> {
        let solver = ours.distributed()?;
        Ok(solve_on_ranks(solver, self, team, beside, stop, measured, observe))
    }
}

/// A subdomain as its file holds it, with the path of that.
pub type Read = (PathBuf, Part, AnyFrozen);

/// The share of a rank, and its impulses of the time step before (N·s), 0 where they are not known.
pub type Joined = (Box<dyn OneShare>, Vec<f64>);

/// Joins the subdomains of a mechanics to the share of a rank.
pub(crate) fn joined_of<M: Form>(parts: Vec<Read>) -> Result<Joined> {
    let (mut shares, mut starts) = (Vec::new(), Vec::new());
    for (path, part, frozen) in parts {
        let frozen = frozen.of::<M>().with_context(|| format!("its subdomains are not all {}", M::NAME))?;
        starts.push((part.contacts.clone(), frozen.start(true)));
        shares.push(part.share(frozen).with_context(|| path.display().to_string())?);
    }
    let share = Share::joined(shares)?;
    let mut start = vec![0.0; share.problem.impulse_count()];
    for (contacts, own) in starts {
        for (k, contact) in contacts.iter().enumerate() {
            let place = share.contacts.partition_point(|other| other < contact);
            M::Impulse::at(&own, k).put(&mut start, place);
        }
    }
    Ok((Box::new(share), start))
}
