//! What subdomains exchange: sums over the copies of each boundary grain.

use crate::decomposition::Decomposition;
use contact::together;
use rayon::prelude::*;
use std::iter::Sum;
use std::slice::Iter;

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

/// Copy after copy, the number of terms of its sum; and all terms, each a subdomain and the number of a copy there.
#[derive(Clone, Default)]
struct Terms {
    counts: Vec<u32>,
    of: Vec<(u32, u32)>,
}

/// What it takes to send a copy, or to fetch what another thread sent, about (ns).
const NS_PER_COPY: usize = 20;

impl<V: Copy + Send + Sync + Sum> CopySums<V> {
    /// Between the subdomains of `decomposition`.
    pub fn new(decomposition: &Decomposition) -> Self {
        let subdomains = &decomposition.subdomains;
        let mut terms = vec![Terms::default(); subdomains.len()];
        for copies in &decomposition.boundary {
            for (e, _) in copies {
                let terms = &mut terms[*e as usize];
                terms.of.extend(copies);
                terms.counts.push(copies.len() as u32);
            }
        }
        let none: V = std::iter::empty().sum();
        let sent = subdomains.iter().map(|subdomain| vec![none; subdomain.boundary.len()]).collect();
        Self { sent, terms, copies: decomposition.copy_count() }
    }

    /// In every subdomain, `pass(subdomain, sent)` writes what its copies send; the passes take about `nanoseconds` in all.
    pub fn send<S: Send>(
        &mut self,
        subdomains: &mut [S],
        nanoseconds: usize,
        pass: impl Fn(&mut S, &mut [V]) + Sync,
    ) {
        let together = self.together(nanoseconds);
        let subdomains = subdomains.par_iter_mut().zip(&mut self.sent).with_min_len(together);
        subdomains.for_each(|(subdomain, sent)| pass(subdomain, sent));
    }

    /// In every subdomain, `pass(subdomain, sums)` takes the sums of what was sent, copy by copy; the passes take about
    /// `nanoseconds` in all.
    pub fn receive<S: Send>(
        &self,
        subdomains: &mut [S],
        nanoseconds: usize,
        pass: impl Fn(&mut S, Sums<'_, V>) + Sync,
    ) {
        let together = self.together(nanoseconds);
        let subdomains = subdomains.par_iter_mut().zip(&self.terms).with_min_len(together);
        subdomains.for_each(|(subdomain, terms)| {
            pass(subdomain, Sums { counts: terms.counts.iter(), of: &terms.of, sent: &self.sent });
        });
    }

    fn together(&self, nanoseconds: usize) -> usize {
        together(nanoseconds + NS_PER_COPY * self.copies)
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
