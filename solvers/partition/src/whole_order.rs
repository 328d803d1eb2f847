//! Velocities of impulses that ranks share, with the bits of one machine: at a boundary grain, contact after contact in the order of
//! the whole problem, wherever the contacts are.

use crate::share::Share;
use crate::sums::{CopySums, Sendable};
use crate::team::Team;
use contact::{Mass, Mechanics, Touch, Vector};
use std::iter::Sum;

/// The next contact at a copy, by its number in the whole problem, and H r of it at the grain; that of the least number is the
/// "sum" of several. None is left where the number is infinite.
#[derive(Clone, Copy)]
struct Next<V> {
    contact: f64,
    push: V,
}

impl<V: Vector> Next<V> {
    const NONE: Self = Self { contact: f64::INFINITY, push: V::ZERO };
}

impl<V: Vector> Sum for Next<V> {
    fn sum<I: Iterator<Item = Self>>(nexts: I) -> Self {
        nexts.fold(Self::NONE, |least, next| if next.contact < least.contact { next } else { least })
    }
}

impl<V: Vector> Sendable for Next<V> {
    const NUMBERS: usize = 1 + V::LEN;

    fn write(self, numbers: &mut Vec<f64>) {
        numbers.push(self.contact);
        numbers.extend(self.push.components());
    }

    fn read(numbers: &[f64]) -> Self {
        Self { contact: numbers[0], push: V::at(&numbers[1..], 0) }
    }
}

/// The copies of a subdomain: of each, the contacts that are left, the next one last, and the sum of those before.
struct Copies<V> {
    left: Vec<Vec<Next<V>>>,
    sums: Vec<V>,
}

impl<M: Mechanics> Share<M> {
    /// V = `V_free` + M⁻¹ H r (m/s) of the own grains, with the impulses `r` of the own contacts (N·s) and those of all other ranks,
    /// which all must ask: the bits of [`ContactProblem::velocity`](contact::ContactProblem::velocity).
    pub fn velocity(&self, r: &[f64], team: &Team) -> Vec<M::Velocity> {
        let Self { problem, decomposition, .. } = self;
        let mut velocity = vec![M::Velocity::ZERO; problem.grain_count()];
        problem.resultant(r, &mut velocity);
        let mut copies: Vec<Copies<M::Velocity>> =
            (0..decomposition.subdomains.len()).map(|e| self.copies(e, r)).collect();
        let mut sums = CopySums::over(decomposition, team);
        while !team.all(copies.iter().all(|copies| copies.left.iter().all(Vec::is_empty))) {
            sums.send(&mut copies, 0, |copies, sent| {
                for (left, sent) in copies.left.iter().zip(sent) {
                    *sent = left.last().copied().unwrap_or(Next::NONE);
                }
            });
            sums.receive(&mut copies, 0, |copies, nexts| {
                for ((left, sum), next) in copies.left.iter_mut().zip(&mut copies.sums).zip(nexts) {
                    *sum += next.push;
                    left.pop_if(|own| own.contact <= next.contact);
                }
            });
        }
        for (subdomain, copies) in decomposition.subdomains.iter().zip(copies) {
            for (grain, sum) in subdomain.boundary_grains().zip(copies.sums) {
                velocity[grain as usize] = sum;
            }
        }
        for ((v, m), free) in velocity.iter_mut().zip(problem.mass()).zip(problem.free_velocity()) {
            *v = *free + m.divides(*v);
        }
        velocity
    }

    fn copies(&self, e: usize, r: &[f64]) -> Copies<M::Velocity> {
        let subdomain = &self.decomposition.subdomains[e];
        let mut copy_of = vec![None; subdomain.grains.len()];
        for (k, place) in subdomain.boundary.iter().enumerate() {
            copy_of[*place as usize] = Some(k);
        }
        let mut left = vec![Vec::new(); subdomain.boundary.len()];
        for (k, (i, j)) in subdomain.contacts.iter().zip(&subdomain.ends).rev() {
            let contact = self.problem.contacts()[*k as usize].between(0, j.map(|_| 1));
            let mut pushes = [M::Velocity::ZERO; 2];
            contact.push(M::Impulse::at(r, *k as usize), &mut pushes);
            for (place, push) in std::iter::once(*i).chain(*j).zip(pushes) {
                if let Some(copy) = copy_of[place as usize] {
                    let contact = f64::from(self.contacts[*k as usize]);
                    left[copy].push(Next { contact, push });
                }
            }
        }
        Copies { sums: vec![M::Velocity::ZERO; left.len()], left }
    }
}
