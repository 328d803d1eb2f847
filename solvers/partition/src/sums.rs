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
    /// The copies of each boundary grain, as [`Decomposition::boundary`] has them.
    copies: Vec<Vec<(u32, u32)>>,
    /// The boundary grain of each copy, subdomain by subdomain.
    grains: Vec<Vec<u32>>,
    /// Number of copies in all.
    count: usize,
}

/// What it takes to send a copy, or to fetch what another thread sent, about (ns).
const NS_PER_COPY: usize = 20;

impl<V: Copy + Default + Send + Sync + Sum> CopySums<V> {
    /// Between the subdomains of `decomposition`.
    pub fn new(decomposition: &Decomposition) -> Self {
        let subdomains = &decomposition.subdomains;
        let copies = decomposition.boundary.clone();
        let mut grains = vec![Vec::new(); subdomains.len()];
        for (grain, copies) in (0_u32..).zip(&copies) {
            for (e, _) in copies {
                grains[*e as usize].push(grain);
            }
        }
        let sent = subdomains.iter().map(|subdomain| vec![V::default(); subdomain.boundary.len()]).collect();
        Self { sent, copies, grains, count: decomposition.copy_count() }
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
        let subdomains = subdomains.par_iter_mut().zip(&self.grains).with_min_len(together);
        subdomains.for_each(|(subdomain, grains)| {
            pass(subdomain, Sums { grains: grains.iter(), copies: &self.copies, sent: &self.sent });
        });
    }

    fn together(&self, nanoseconds: usize) -> usize {
        together(nanoseconds + NS_PER_COPY * self.count)
    }
}

/// The sum over all copies of its grain, for each copy of a subdomain.
pub struct Sums<'s, V> {
    /// Of the copies that are left.
    grains: Iter<'s, u32>,
    copies: &'s [Vec<(u32, u32)>],
    sent: &'s [Vec<V>],
}

impl<V: Copy + Sum> Iterator for Sums<'_, V> {
    type Item = V;

    #[inline]
    fn next(&mut self) -> Option<V> {
        let copies = &self.copies[*self.grains.next()? as usize];
        Some(copies.iter().map(|(e, k)| self.sent[*e as usize][*k as usize]).sum())
    }
}
