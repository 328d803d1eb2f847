//! The interface problem S u = g on the boundary grains, S = Σ S_E: by a factor of S, or by conjugate gradients.

use crate::subdomain::Subdomain;
use cholesky::{Coupling, Factor, Order, Structure};
use contact::{SetupError, threads};
use nalgebra::{SMatrix, SVector};
use std::sync::Arc;

/// Approximate time of a thread for an entry of a factor (ns): two passes.
const NS_PER_ENTRY: usize = 2;

/// The subdomains, and how many boundary grains they have among them.
pub(crate) struct Subdomains<const D: usize> {
    pub(crate) own: Vec<Subdomain<D>>,
    pub(crate) boundary: usize,
}

impl<const D: usize> Subdomains<D> {
    /// Each does this, at the same time, where that pays.
    pub(crate) fn each(&mut self, act: impl Fn(&mut Subdomain<D>) + Sync + Send) {
        let entries: u64 = self.own.iter().flat_map(Subdomain::entries).sum();
        threads::each(&mut self.own, NS_PER_ENTRY * entries as usize, &|_, subdomain| act(subdomain));
    }

    /// Acts on all subdomains; `sum` gets what they send, added to what it holds in the order of subdomains.
    pub(crate) fn add(&mut self, sum: &mut [SVector<f64, D>], act: impl Fn(&mut Subdomain<D>) + Sync + Send) {
        self.each(act);
        for subdomain in &self.own {
            for (k, sent) in subdomain.boundary.iter().zip(&subdomain.sent) {
                sum[*k as usize] += sent;
            }
        }
    }

    /// D = (Σ K_bb)⁻¹ K_bb of each copy of a boundary grain, grain by grain, which add up to 1; before, each has its K_bb. Says
    /// whether it could.
    pub(crate) fn share_out(&mut self) -> bool {
        let mut sums = vec![SMatrix::<f64, D, D>::zeros(); self.boundary];
        for subdomain in &self.own {
            for (k, weight) in subdomain.boundary.iter().zip(&subdomain.weight) {
                sums[*k as usize] += weight;
            }
        }
        let inverses: Option<Vec<_>> = sums.into_iter().map(SMatrix::try_inverse).collect();
        let Some(inverses) = inverses else { return false };
        for subdomain in &mut self.own {
            for (k, weight) in subdomain.boundary.iter().zip(&mut subdomain.weight) {
                *weight = inverses[*k as usize] * *weight;
            }
        }
        true
    }

    /// Copies of boundary grains.
    pub(crate) fn copies(&self) -> u64 {
        self.own.iter().map(|subdomain| subdomain.boundary.len() as u64).sum()
    }
}

/// A factor of S, whose blocks the subdomains add.
pub(crate) struct Assembled<const D: usize> {
    /// The subdomain of each coupling of boundary grains, and the column and the row of its S_E.
    couplings: Vec<[u32; 3]>,
    structure: Arc<Structure<D>>,
    factor: Option<Factor<D>>,
    /// By place.
    u: Vec<SVector<f64, D>>,
}

impl<const D: usize> Assembled<D> {
    /// All boundary grains of a subdomain are coupled.
    pub(crate) fn new(subdomains: &Subdomains<D>) -> Result<Self, SetupError> {
        let (mut couplings, mut ends) = (Vec::new(), Vec::new());
        for (e, subdomain) in (0_u32..).zip(&subdomains.own) {
            for (column, i) in (0_u32..).zip(&subdomain.boundary) {
                for (row, j) in (column..).zip(&subdomain.boundary[column as usize..]) {
                    couplings.push([e, column, row]);
                    ends.push((*i, (i != j).then_some(*j)));
                }
            }
        }
        let order = Order::minimum_degree(subdomains.boundary, &ends)?;
        let structure = Structure::new(&ends, &order)?;
        Ok(Self { couplings, structure, factor: None, u: vec![SVector::zeros(); subdomains.boundary] })
    }

    /// Adds up S and factorises it; says whether it could.
    pub(crate) fn factorise(&mut self, subdomains: &mut Subdomains<D>) -> bool {
        let mut blocks = vec![Vec::new(); subdomains.own.len()];
        threads::each_pair((&mut subdomains.own, &mut blocks), usize::MAX, &|subdomain, blocks| {
            *blocks = subdomain.assembled();
        });
        let Self { couplings, structure, factor, .. } = self;
        let coupling = |k: usize| {
            let [e, column, row] = couplings[k].map(|index| index as usize);
            let count = subdomains.own[e].boundary.len();
            // In the rows of the first, which is the column's grain: the transposed block of the column.
            let block = blocks[e][column * count + row];
            let zero = SMatrix::zeros();
            Some(if column == row {
                Coupling { first: block, second: zero, between: zero }
            } else {
                Coupling { first: zero, second: zero, between: block.transpose() }
            })
        };
        Factor::replace(factor, structure, |_| SVector::zeros(), coupling)
    }

    /// u ← S⁻¹ u.
    pub(crate) fn solve(&mut self, u: &mut [SVector<f64, D>]) {
        let Some(factor) = &self.factor else { return };
        let place = self.structure.position();
        place.iter().zip(&*u).for_each(|(place, u)| self.u[*place as usize] = *u);
        factor.solve(&mut self.u);
        place.iter().zip(u).for_each(|(place, u)| *u = self.u[*place as usize]);
    }

    /// Multiply-adds of a factorisation.
    pub(crate) fn work(&self) -> u64 {
        self.structure.work()
    }

    /// Entries of the factor.
    pub(crate) fn entries(&self) -> u64 {
        self.structure.entries() as u64
    }
}
