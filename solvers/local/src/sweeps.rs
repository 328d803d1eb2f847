//! Non-linear Gauss-Seidel on a stored W, by subdomains of its graph: each sweeps over its own contacts, all others kept; then all
//! hand over their impulses.
//!
//! On one subdomain it is NSGS, each contact solved exactly with all others kept. On more, what a subdomain does must not be too
//! much when all do it at once. With split masses that holds for problems with grains, since subdomains then have a Ŵ that is no less
//! than W; here Ŵ is W without what couples subdomains, and the sums of the sizes of that in each row are added to its diagonal.
//! So Ŵ − W is diagonally dominant, and q(r) = ½ rᵗ W r + qᵗ r never increases without friction, where W is symmetric.
//!
//! With acceleration the iterations are extrapolated as those between grains ([`contact::acceleration`]), in the norm of the blocks `W_αα`.

use crate::{LocalProblem, graph};
use contact::acceleration::{Lead, Momentum};
use contact::{Iteration, SetupError, Vector, Work, threads};
use nalgebra::{SMatrix, SVector};

/// The law at one contact, from `W_αα`, the relative velocity without its own impulse, and μ.
pub(crate) type Exact<const D: usize> = fn(&SMatrix<f64, D, D>, &SVector<f64, D>, f64) -> SVector<f64, D>;

/// Approximate cost of the update of a contact (ns).
const NANOSECONDS: usize = 100;

/// A run on one problem.
pub(crate) struct Sweeps<'p, const D: usize> {
    problem: &'p LocalProblem,
    exact: Exact<D>,
    subdomains: Vec<Subdomain<D>>,
    /// The subdomain of each contact, and its place there.
    place: Vec<(u32, u32)>,
    /// Term added to the diagonal of `W_αα` (1/kg).
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
    r: Vec<SVector<f64, D>>,
}

impl<'p, const D: usize> Sweeps<'p, D> {
    /// From r = 0.
    ///
    /// # Errors
    /// If there cannot be so many subdomains.
    pub(crate) fn new(
        problem: &'p LocalProblem,
        exact: Exact<D>,
        subdomains: usize,
        momentum: Option<Momentum>,
    ) -> Result<Self, SetupError> {
        let of = graph::subdomains(problem, subdomains)?;
        let mut all: Vec<Subdomain<D>> =
            (0..subdomains).map(|_| Subdomain { contacts: Vec::new(), r: Vec::new() }).collect();
        let mut place = Vec::with_capacity(of.len());
        for (contact, own) in of.iter().enumerate() {
            let Subdomain { contacts, r } = &mut all[*own as usize];
            place.push((*own, contacts.len() as u32));
            contacts.push(contact as u32);
            r.push(SVector::zeros());
        }
        let mut added = vec![SVector::zeros(); of.len()];
        let mut interface = 0;
        for (contact, added) in added.iter_mut().enumerate() {
            let mut needed_by = Vec::new();
            for at in problem.blocks_of(contact) {
                let (w, other) = problem.entry::<D>(at);
                if of[other] != of[contact] {
                    *added += w.abs().column_sum();
                    needed_by.push(of[other]);
                }
            }
            needed_by.sort_unstable();
            needed_by.dedup();
            interface += (D * needed_by.len()) as u64;
        }
        let r = vec![SVector::zeros(); of.len()];
        let accelerated = momentum.map(|momentum| (momentum.of_problem(D > 1), Lead::new(&r)));
        Ok(Self { problem, exact, subdomains: all, place, added, r, accelerated, iterations: 0, interface })
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

impl<const D: usize> Iteration for Sweeps<'_, D> {
    fn advance(&mut self) {
        let contacts = self.r.len();
        if let Some((momentum, lead)) = &mut self.accelerated {
            lead.begin(momentum.factor());
            lead.extrapolate(&mut self.r, 0..contacts);
            self.hand_out();
        }
        let Self { problem, exact, subdomains, place, added, r, .. } = self;
        threads::each(subdomains, place.len() * NANOSECONDS, &|own, subdomain| {
            for k in 0..subdomain.contacts.len() {
                let contact = subdomain.contacts[k] as usize;
                let mut w = *problem.own::<D>(contact);
                // What is added acts on the change of r alone.
                let mut v = SVector::at(problem.q(), contact) - added[contact].component_mul(&subdomain.r[k]);
                (0..D).for_each(|k| w[(k, k)] += added[contact][k]);
                for at in problem.blocks_of(contact) {
                    let (w, other) = problem.entry::<D>(at);
                    if other != contact {
                        let (of, there) = place[other];
                        let is_own = of as usize == own;
                        v += w * if is_own { subdomain.r[there as usize] } else { r[other] };
                    }
                }
                subdomain.r[k] = exact(&w, &v, problem.friction()[contact]);
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
