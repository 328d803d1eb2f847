//! Linear solver for K by subdomains: interiors are condensed, the interface problem is solved, interiors follow.

use crate::conjugate::Conjugate;
use crate::interface::{Assembled, Subdomains};
use crate::subdomain::Subdomain;
use crate::{Interface, NewtonSchur, Preconditioner};
use active_set::{Inner, Whole};
use cholesky::Coupling;
use contact::{Packing, SetupError, Smooth, Work, threads};
use nalgebra::SVector;
use partition::{Decomposition, Partition};

/// Solver of the interface problem.
enum Way<const D: usize> {
    Direct(Assembled<D>),
    Cg(Conjugate<D>),
}

/// K by subdomains. Grains and contacts are in the problem's order.
pub struct Schur<const D: usize = 2> {
    subdomains: Subdomains<D>,
    way: Way<D>,
    penalty: f64,
    /// 0, 1, 2, ….
    position: Vec<u32>,
    contacts: u32,
    /// The problem's grain of each boundary grain.
    boundary: Vec<u32>,
    /// The right-hand side at the boundary, then its velocities.
    u: Vec<SVector<f64, D>>,
    cost: (u64, usize),
    work: Work,
    iterations: u64,
}

impl<const D: usize> Schur<D> {
    /// Cuts the problem into subdomains, and finds where the factors have entries.
    pub(crate) fn new(settings: &NewtonSchur, problem: &Packing<Smooth<D>>) -> Result<Self, SetupError> {
        let partition = Partition::of_contacts(problem, settings.partition, settings.subdomains)?;
        let Decomposition { subdomains, multiplicity, .. } = Decomposition::new(problem, &partition);
        let position: Vec<u32> = (0..problem.grain_count() as u32).collect();
        let boundary: Vec<u32> =
            position.iter().copied().filter(|grain| multiplicity[*grain as usize] > 1).collect();
        let mut number = vec![0; position.len()];
        (0..).zip(&boundary).for_each(|(k, grain)| number[*grain as usize] = k);
        let neumann =
            settings.interface == Interface::Cg && settings.preconditioner == Preconditioner::NeumannNeumann;
        let of_own = |own: &partition::Subdomain| {
            let numbers = own.boundary_grains().map(|grain| number[grain as usize]).collect();
            Subdomain::new(problem, own, &multiplicity, numbers, neumann)
        };
        let own = threads::make(subdomains.len(), &|e| of_own(&subdomains[e]));
        let own: Result<Vec<_>, _> = own.into_iter().collect();
        let subdomains = Subdomains { own: own?, boundary: boundary.len() };
        let way = match settings.interface {
            Interface::Direct => Way::Direct(Assembled::new(&subdomains)?),
            Interface::Cg => {
                Way::Cg(Conjugate::new(boundary.len(), (neumann, settings.coarse), settings.inner_accuracy))
            }
        };
        Ok(Self {
            subdomains,
            way,
            penalty: settings.penalty,
            position,
            contacts: problem.contact_count() as u32,
            u: vec![SVector::zeros(); boundary.len()],
            boundary,
            cost: Whole::cost_of(problem)?,
            work: Work::default(),
            iterations: 0,
        })
    }

    /// Iterations on the interface so far.
    pub fn inner_iterations(&self) -> u64 {
        self.iterations
    }

    /// Velocity components that copies send in an exchange.
    pub(crate) fn exchange(&self) -> u64 {
        D as u64 * self.subdomains.copies()
    }

    /// Entries of the factors of all interiors, and of all K_E.
    fn entries(&self) -> [u64; 2] {
        let add = |[a, b]: [u64; 2], [c, d]: [u64; 2]| [a + c, b + d];
        self.subdomains.own.iter().map(Subdomain::entries).fold([0, 0], add)
    }
}

impl<const D: usize> Inner<D> for Schur<D> {
    fn penalty(&self) -> f64 {
        self.penalty
    }

    fn position(&self) -> &[u32] {
        &self.position
    }

    fn contacts(&self) -> impl Iterator<Item = u32> {
        0..self.contacts
    }

    fn factorise(&mut self, coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync) -> bool {
        let subdomains = &mut self.subdomains.own;
        let mut done = vec![false; subdomains.len()];
        threads::each_pair((subdomains, &mut done), usize::MAX, &|subdomain, done| {
            *done = subdomain.factorise(&coupling);
        });
        for subdomain in &self.subdomains.own {
            let (multiply_adds, factorisations) = subdomain.factorisation();
            self.work.factorisation_multiply_adds += multiply_adds;
            self.work.factorisations += factorisations;
        }
        if done.contains(&false) {
            return false;
        }
        match &mut self.way {
            Way::Direct(assembled) => {
                for subdomain in &self.subdomains.own {
                    let unknowns = (D * subdomain.boundary.len()) as u64;
                    self.work.triangular_solve_entries += 2 * unknowns * subdomain.entries()[0];
                    self.work.interface_values += unknowns * (unknowns + 1) / 2;
                }
                self.work.factorisation_multiply_adds += assembled.work();
                self.work.factorisations += u64::from(self.subdomains.boundary > 0);
                assembled.factorise(&mut self.subdomains)
            }
            Way::Cg(conjugate) => {
                conjugate.renew();
                let shares = conjugate.neumann || conjugate.coarse;
                if shares {
                    // Symmetric blocks.
                    self.work.interface_values += (D * (D + 1) / 2) as u64 * self.subdomains.copies();
                }
                !shares || self.subdomains.share_out()
            }
        }
    }

    /// With S = Σ (K_bb − K_bi K_ii⁻¹ K_ib):
    ///
    /// S u_b = x_b − Σ K_bi K_ii⁻¹ x_i,   u_i = K_ii⁻¹ (x_i − K_ib u_b)
    fn solve(&mut self, x: &mut [SVector<f64, D>]) {
        let ([inside, whole], exchange) = (self.entries(), self.exchange());
        let Self { subdomains, way, boundary, u, work, iterations, .. } = self;
        for (u, grain) in u.iter_mut().zip(&*boundary) {
            *u = x[*grain as usize];
        }
        subdomains.add(u, |subdomain| subdomain.condense(x));
        match way {
            Way::Direct(assembled) => {
                assembled.solve(u);
                work.triangular_solve_entries += 2 * assembled.entries();
            }
            Way::Cg(conjugate) => {
                let taken = conjugate.solve(subdomains, u);
                *iterations += taken.iterations;
                let solves = if conjugate.neumann { taken.iterations } else { 0 };
                work.triangular_solve_entries += 2 * (taken.products * inside + solves * whole);
                work.interface_values += exchange * (taken.products + solves);
            }
        }
        subdomains.each(|subdomain| subdomain.recover(x, u));
        work.triangular_solve_entries += 4 * inside;
        work.interface_values += exchange;
        for subdomain in &subdomains.own {
            subdomain.interior().for_each(|(grain, u)| x[grain as usize] = *u);
        }
        for (grain, u) in boundary.iter().zip(u) {
            x[*grain as usize] = *u;
        }
    }

    fn work(&self) -> Work {
        self.work
    }

    fn cost(&self) -> (u64, usize) {
        self.cost
    }
}

#[cfg(test)]
mod tests;
