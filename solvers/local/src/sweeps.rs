//! Non-linear Gauss-Seidel on a stored W, by subdomains of its graph: each sweeps over its own contacts, all others kept; then all
//! hand over their impulses.
//!
//! On one subdomain it is NSGS, each contact solved exactly with all others kept. On more, what a subdomain does must not be too
//! much when all do it at once. With split masses that holds for problems with grains, since subdomains then have a Ŵ that is no less
//! than W; here Ŵ is W without what couples subdomains, and the sums of the sizes of that in each row are added to its diagonal.
//! So Ŵ − W is diagonally dominant, and q(r) = ½ rᵗ W r + qᵗ r never increases without friction, where W is symmetric.
//!
//! With acceleration the iterations are extrapolated as those between grains ([`contact::acceleration`]), in the norm of the blocks `W_αα`.

use crate::exact::{Exact, Own};
use crate::{LocalProblem, graph};
use contact::acceleration::{Lead, Momentum};
use contact::{Iteration, SetupError, Vector, Work, threads};
use nalgebra::{SMatrix, SVector};

/// Approximate cost of the update of a contact (ns).
const NANOSECONDS: usize = 100;

/// A run on one problem.
pub(crate) struct Sweeps<'p, const D: usize> {
    problem: &'p LocalProblem,
    subdomains: Vec<Subdomain<D>>,
    /// The subdomain of each contact, and its place there.
    place: Vec<(u32, u32)>,
    /// Term added to the diagonal of `W_αα` (1/kg), where there are several subdomains.
    added: Vec<SVector<f64, D>>,
    /// r after the last sweep (N·s).
    r: Vec<SVector<f64, D>>,
    accelerated: Option<(Momentum, Lead<SVector<f64, D>>)>,
    iterations: u64,
    /// Impulses that a subdomain needs of others, component by component.
    interface: u64,
}

struct Subdomain<const D: usize> {
    contacts: Vec<u32>,
    /// The law at each, with what is added to its block.
    own: Vec<Own<D>>,
    r: Vec<SVector<f64, D>>,
}

impl<'p, const D: usize> Sweeps<'p, D> {
    /// From r = 0.
    ///
    /// # Errors
    /// If there cannot be so many subdomains.
    pub(crate) fn new(
        problem: &'p LocalProblem,
        subdomains: usize,
        momentum: Option<Momentum>,
    ) -> Result<Self, SetupError> {
        let of = graph::subdomains(problem, subdomains)?;
        let none = || Subdomain { contacts: Vec::new(), own: Vec::new(), r: Vec::new() };
        let mut all: Vec<Subdomain<D>> = (0..subdomains).map(|_| none()).collect();
        let (mut place, mut added) = (Vec::with_capacity(of.len()), Vec::with_capacity(of.len()));
        let mut interface = 0;
        for (contact, subdomain) in of.iter().enumerate() {
            let (mut more, mut needed_by) = (SVector::zeros(), Vec::new());
            for (w, other) in problem.row::<D>(contact).filter(|(_, other)| of[*other] != *subdomain) {
                more += w.abs().column_sum();
                needed_by.push(of[other]);
            }
            needed_by.sort_unstable();
            needed_by.dedup();
            interface += (D * needed_by.len()) as u64;
            added.push(more);
            let w = problem.own::<D>(contact) + SMatrix::from_diagonal(&more);
            let Subdomain { contacts, own, r } = &mut all[*subdomain as usize];
            place.push((*subdomain, contacts.len() as u32));
            contacts.push(contact as u32);
            own.push(Own::new(w, problem.friction()[contact]));
            r.push(SVector::zeros());
        }
        let r = vec![SVector::zeros(); of.len()];
        let accelerated = momentum.map(|momentum| (momentum.of_problem(D > 1), Lead::new(&r)));
        Ok(Self { problem, subdomains: all, place, added, r, accelerated, iterations: 0, interface })
    }

    /// Takes the impulses `r` (N·s).
    pub(crate) fn begin(&mut self, r: &[f64]) {
        for (contact, own) in self.r.iter_mut().enumerate() {
            *own = SVector::at(r, contact);
        }
        self.hand_out();
    }

    /// Gives each subdomain its impulses.
    fn hand_out(&mut self) {
        for subdomain in &mut self.subdomains {
            for (contact, own) in subdomain.contacts.iter().zip(&mut subdomain.r) {
                *own = self.r[*contact as usize];
            }
        }
    }
}

impl<const D: usize> Iteration for Sweeps<'_, D>
where
    Own<D>: Exact<D>,
{
    fn advance(&mut self) {
        let contacts = self.r.len();
        if let Some((momentum, lead)) = &mut self.accelerated {
            lead.begin(momentum.factor());
            lead.extrapolate(&mut self.r, 0..contacts);
            self.hand_out();
        }
        let Self { problem, subdomains, place, added, r, .. } = self;
        let is_alone = subdomains.len() == 1;
        threads::each(subdomains, place.len() * NANOSECONDS, &|number, subdomain| {
            let Subdomain { contacts, own, r: inside } = subdomain;
            for (k, (contact, own)) in contacts.iter().zip(own).enumerate() {
                let contact = *contact as usize;
                // What is added acts on the change of r alone.
                let mut v = SVector::at(problem.q(), contact) - added[contact].component_mul(&inside[k]);
                for (w, other) in problem.row::<D>(contact) {
                    if other == contact {
                        continue;
                    }
                    let (of, there) = if is_alone { (0, other as u32) } else { place[other] };
                    v += w * if of as usize == number { inside[there as usize] } else { r[other] };
                }
                inside[k] = own.impulse(&v);
            }
        });
        for subdomain in &self.subdomains {
            for (contact, own) in subdomain.contacts.iter().zip(&subdomain.r) {
                self.r[*contact as usize] = *own;
            }
        }
        if let Some((momentum, lead)) = &mut self.accelerated {
            lead.judge_weighed(&self.r, |contact, g| self.problem.own::<D>(contact) * g);
            momentum.turn(lead.sums());
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        for (contact, own) in self.r.iter().enumerate() {
            own.put(r, contact);
        }
    }

    fn work(&self) -> Work {
        Work {
            contact_updates: self.iterations * self.place.len() as u64,
            interface_values: self.iterations * self.interface,
            ..Work::default()
        }
    }
}
