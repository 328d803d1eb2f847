//! What subdomains exchange: sums over the copies of each boundary grain.

use crate::decomposition::Decomposition;
use contact::together;
use rayon::prelude::*;
use std::iter::Sum;

/// The only exchange between subdomains: each copy of a boundary grain gets the sum over all copies of the grain, added up in
/// the order of the subdomains, so that no number of threads changes a bit.
///
/// In two passes over the subdomains: all [send](Self::send), then each [receives](Self::receive) and waits for no other. Copies
/// are numbered as in [`Subdomain::boundary`](crate::Subdomain::boundary).
pub struct CopySums<V> {
    /// What each subdomain sent, copy by copy.
    sent: Vec<Vec<V>>,
    /// Where each subdomain finds the terms of its sums.
    terms: Vec<Terms>,
    /// Number of copies in all.
    copies: usize,
}

/// Copy k gets the sum over `of[first[k]..first[k + 1]]`, each a subdomain and the number of a copy there.
#[derive(Clone)]
struct Terms {
    first: Vec<u32>,
    of: Vec<(u32, u32)>,
}

/// What it takes to send a copy, or to fetch what another thread sent, about (ns).
const NS_PER_COPY: usize = 20;

impl<V: Copy + Default + Send + Sync + Sum> CopySums<V> {
    /// Between the subdomains of `decomposition`.
    pub fn new(decomposition: &Decomposition) -> Self {
        let subdomains = &decomposition.subdomains;
        let mut terms = vec![Terms { first: vec![0], of: Vec::new() }; subdomains.len()];
        for copies in decomposition.boundary() {
            // Lists grow grain by grain, as those of the boundary did.
            let of: Vec<_> =
                copies.iter().map(|(e, _)| (*e, terms[*e as usize].first.len() as u32 - 1)).collect();
            for (e, _) in copies {
                let terms = &mut terms[*e as usize];
                terms.of.extend(&of);
                terms.first.push(terms.of.len() as u32);
            }
        }
        let sent = subdomains.iter().map(|subdomain| vec![V::default(); subdomain.boundary.len()]).collect();
        Self { sent, terms, copies: decomposition.copy_count() }
    }

    /// Does the `work` of every subdomain, which takes about `nanoseconds` in all; then its copy k sends `value(subdomain, k)`.
    pub fn send<S: Send>(
        &mut self,
        subdomains: &mut [S],
        nanoseconds: usize,
        work: impl Fn(&mut S) + Sync,
        value: impl Fn(&mut S, usize) -> V + Sync,
    ) {
        let together = self.together(nanoseconds);
        let subdomains = subdomains.par_iter_mut().zip(&mut self.sent).with_min_len(together);
        subdomains.for_each(|(subdomain, sent)| {
            work(subdomain);
            for (k, sent) in sent.iter_mut().enumerate() {
                *sent = value(subdomain, k);
            }
        });
    }

    /// In every subdomain, `take(subdomain, k, sum)` gets what all copies of the grain of copy k sent; then it does its `work`,
    /// which takes about `nanoseconds` in all.
    pub fn receive<S: Send>(
        &self,
        subdomains: &mut [S],
        nanoseconds: usize,
        take: impl Fn(&mut S, usize, V) + Sync,
        work: impl Fn(&mut S) + Sync,
    ) {
        let together = self.together(nanoseconds);
        let subdomains = subdomains.par_iter_mut().zip(&self.terms).with_min_len(together);
        subdomains.for_each(|(subdomain, terms)| {
            for (k, ends) in terms.first.windows(2).enumerate() {
                let of = &terms.of[ends[0] as usize..ends[1] as usize];
                take(subdomain, k, of.iter().map(|(e, k)| self.sent[*e as usize][*k as usize]).sum());
            }
            work(subdomain);
        });
    }

    fn together(&self, nanoseconds: usize) -> usize {
        together(nanoseconds + NS_PER_COPY * self.copies)
    }
}
