//! Exchange between subdomains: sums over the copies of each boundary grain.

use crate::decomposition::Decomposition;
use crate::team::{Parcel, Team};
use contact::{Vector, threads};
use std::collections::BTreeMap;
use std::iter::Sum;
use std::slice::Iter;

/// Message of a copy of a boundary grain: some numbers that are added up together.
pub trait Sendable: Copy + Send + Sync + Sum {
    /// Number of components.
    const NUMBERS: usize;

    /// Adds them to a list.
    fn write(self, numbers: &mut Vec<f64>);

    /// Reads a value from the beginning of a list.
    fn read(numbers: &[f64]) -> Self;
}

impl<V: Vector> Sendable for V {
    const NUMBERS: usize = V::LEN;

    fn write(self, numbers: &mut Vec<f64>) {
        numbers.extend(self.components());
    }

    fn read(numbers: &[f64]) -> Self {
        V::at(numbers, 0)
    }
}

/// The only exchange between subdomains: each copy of a boundary grain gets the sum over all copies of the grain, added up in
/// the order of the subdomains, so that no number of threads or ranks changes a bit.
///
/// In two passes over the subdomains: all [send](Self::send), then each [receives](Self::receive) and waits for no other. Between
/// the two, ranks send each other what they share. Where a subdomain need not receive before it sends again, one pass
/// [does both](Self::exchange): threads wait for each other half as often. Copies are numbered as in
/// [`Subdomain::boundary`](crate::Subdomain::boundary).
pub struct CopySums<V> {
    /// Values sent by each own subdomain, copy by copy; then those received from each neighbouring rank.
    sent: Vec<Vec<V>>,
    /// Values of the pass before, while those of the next are sent.
    before: Vec<Vec<V>>,
    post: Option<Between>,
    /// Positions of the terms of each subdomain's sums.
    terms: Vec<Terms>,
    /// Number of copies in all.
    copies: usize,
}

/// Copy after copy, the number of terms of its sum; and all terms, each a subdomain and the number of a copy there.
#[derive(Clone, Default)]
struct Terms {
    counts: Vec<u32>,
    of: Vec<(u32, u32)>,
}

impl Terms {
    fn sums<'s, V>(&'s self, sent: &'s [Vec<V>]) -> Sums<'s, V> {
        Sums { counts: self.counts.iter(), of: &self.of, sent }
    }
}

/// Approximate cost of sending a copy, or of fetching one that another thread sent (ns).
const NS_PER_COPY: usize = 20;

/// Values sent to other ranks, and received from them.
struct Between {
    team: Team,
    /// For each parcel to another rank, the own subdomain and the number of each copy.
    copies: Vec<Vec<(u32, u32)>>,
    out: Vec<Parcel>,
    into: Vec<Parcel>,
}

impl<V: Sendable> CopySums<V> {
    /// Between the subdomains of `decomposition`, which are all.
    pub fn new(decomposition: &Decomposition) -> Self {
        Self::over(decomposition, &Team::alone(decomposition.subdomains.len()))
    }

    /// Between the subdomains of `decomposition`, those of this rank, and those of the other ranks of the `team`.
    pub fn over(decomposition: &Decomposition, team: &Team) -> Self {
        let (own, first) = (decomposition.subdomains.len(), decomposition.first);
        // The copies of a grain are known wherever one is, so both sides find the same ones, and sort them alike.
        let is_mine = |e: u32| team.mine().contains(&(e as usize));
        let (mut out, mut into) = (BTreeMap::<_, Vec<_>>::new(), BTreeMap::<_, Vec<_>>::new());
        for copies in &decomposition.boundary {
            let (mine, others): (Vec<_>, Vec<_>) = copies.iter().copied().partition(|(e, _)| is_mine(*e));
            let mut ranks: Vec<usize> = others.iter().map(|(e, _)| team.rank_of(*e as usize)).collect();
            for copy in others {
                into.entry(team.rank_of(copy.0 as usize)).or_default().push(copy);
            }
            ranks.dedup();
            for rank in ranks {
                out.entry(rank).or_default().extend(&mine);
            }
        }
        out.values_mut().chain(into.values_mut()).for_each(|copies| copies.sort_unstable());

        let mut place_of = BTreeMap::new();
        for (slot, copies) in into.values().enumerate() {
            let place = |(k, copy): (u32, &(u32, u32))| (*copy, ((own + slot) as u32, k));
            place_of.extend((0..).zip(copies).map(place));
        }
        let place =
            |(e, k): &(u32, u32)| place_of.get(&(*e, *k)).copied().unwrap_or((e.wrapping_sub(first), *k));
        let mut terms = vec![Terms::default(); own];
        for copies in &decomposition.boundary {
            for (e, _) in copies.iter().filter(|(e, _)| is_mine(*e)) {
                let terms = &mut terms[(*e - first) as usize];
                terms.of.extend(copies.iter().map(place));
                terms.counts.push(copies.len() as u32);
            }
        }

        let parcel =
            |rank: &usize, copies: usize| Parcel { rank: *rank, numbers: vec![0.0; V::NUMBERS * copies] };
        let none: V = std::iter::empty().sum();
        let mut sent: Vec<Vec<V>> =
            decomposition.subdomains.iter().map(|subdomain| vec![none; subdomain.boundary.len()]).collect();
        let copies = sent.iter().map(Vec::len).sum();
        sent.extend(into.values().map(|copies| vec![none; copies.len()]));
        let post = (team.size() > 1).then(|| Between {
            team: team.clone(),
            out: out.keys().map(|rank| parcel(rank, 0)).collect(),
            into: into.iter().map(|(rank, copies)| parcel(rank, copies.len())).collect(),
            copies: out
                .into_values()
                .map(|copies| copies.into_iter().map(|(e, k)| (e - first, k)).collect())
                .collect(),
        });
        Self { sent, before: Vec::new(), post, terms, copies }
    }

    /// In every subdomain, `pass(subdomain, sent)` writes what its copies send; the passes take about `nanoseconds` in all.
    pub fn send<S: Send>(
        &mut self,
        subdomains: &mut [S],
        nanoseconds: usize,
        pass: impl Fn(&mut S, &mut [V]) + Sync,
    ) {
        let nanoseconds = nanoseconds + NS_PER_COPY * self.copies;
        threads::each_pair((subdomains, &mut self.sent), nanoseconds, &|subdomain, sent| {
            pass(subdomain, sent);
        });
        self.swap();
    }

    /// Each rank gets what its neighbours sent.
    fn swap(&mut self) {
        let Some(Between { team, copies, out, into }) = &mut self.post else { return };
        for (parcel, copies) in out.iter_mut().zip(copies) {
            parcel.numbers.clear();
            for (e, k) in copies.iter() {
                self.sent[*e as usize][*k as usize].write(&mut parcel.numbers);
            }
        }
        team.swap(out, into);
        let own = self.sent.len() - into.len();
        for (sent, parcel) in self.sent[own..].iter_mut().zip(into) {
            sent.iter_mut()
                .zip(parcel.numbers.chunks_exact(V::NUMBERS))
                .for_each(|(sent, numbers)| *sent = V::read(numbers));
        }
    }

    /// In every subdomain, `pass(subdomain, sums)` takes the sums of what was sent, copy by copy; the passes take about
    /// `nanoseconds` in all.
    pub fn receive<S: Send>(
        &self,
        subdomains: &mut [S],
        nanoseconds: usize,
        pass: impl Fn(&mut S, Sums<'_, V>) + Sync,
    ) {
        let nanoseconds = nanoseconds + NS_PER_COPY * self.copies;
        threads::each(subdomains, nanoseconds, &|e, subdomain| pass(subdomain, self.sums(e)));
    }

    /// In every subdomain, `pass(subdomain, sums, sent)` takes the sums of what was sent last, and writes what its copies send next; the
    /// passes take about `nanoseconds` in all.
    pub fn exchange<S: Send>(
        &mut self,
        subdomains: &mut [S],
        nanoseconds: usize,
        pass: impl Fn(&mut S, Sums<'_, V>, &mut [V]) + Sync,
    ) {
        let nanoseconds = nanoseconds + 2 * NS_PER_COPY * self.copies;
        if self.before.is_empty() {
            self.before.clone_from(&self.sent);
        }
        std::mem::swap(&mut self.sent, &mut self.before);
        let Self { sent, before, terms, .. } = self;
        let mut pairs: Vec<_> = subdomains.iter_mut().zip(sent).collect();
        threads::each(&mut pairs, nanoseconds, &|e, (subdomain, sent)| {
            pass(subdomain, terms[e].sums(before), sent);
        });
        self.swap();
    }

    /// Returns the sums of what was sent last, for the copies of a subdomain.
    pub fn sums(&self, subdomain: usize) -> Sums<'_, V> {
        self.terms[subdomain].sums(&self.sent)
    }
}

/// The sum over all copies of its grain, for each copy of a subdomain.
pub struct Sums<'s, V> {
    counts: Iter<'s, u32>,
    /// The terms that are left.
    of: &'s [(u32, u32)],
    sent: &'s [Vec<V>],
}

impl<V: Copy + Sum> Iterator for Sums<'_, V> {
    type Item = V;

    #[inline]
    fn next(&mut self) -> Option<V> {
        let (of, left) = self.of.split_at(*self.counts.next()? as usize);
        self.of = left;
        Some(of.iter().map(|(e, k)| self.sent[*e as usize][*k as usize]).sum())
    }
}
