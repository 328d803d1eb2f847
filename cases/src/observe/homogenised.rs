//! Subdomains as homogenised materials (§5): stress, fabric and coordination of each.
//!
//! The moment of a grain i is `M_i` = Σ f ⊗ l over its contacts, f the force on it and l from its centre to the contact. A grain
//! whose contacts lie in m subdomains counts in each of them with 1/m, as its copies have its mass:
//!
//! - σ_E = 1/A_E Σ_i `M_i`/m_i (Love-Weber; pressure is positive), with A_E the part of the box around the grains that the volume of
//!   those of E is of all that touch. Σ A_E σ_E = A σ to round-off, and where all grains bear the same so do all subdomains.
//! - fabric F_E = ⟨n ⊗ n⟩ over the contacts of its grains that push; its trace is 1.
//! - coordination `z_E`: contacts that push, per grain.
//!
//! F. Radjai, V. Richefeu, "Contact dynamics as a nonsmooth discrete element method", Mech. Mater. 41 (2009).

use crate::detect::extent::room;
use crate::problem::frozen::Frozen;
use crate::problem::marched::{Marched, to_candidate};
use contact::{Place, Touch, Vector};
use std::collections::BTreeSet;

/// A symmetric or nearly symmetric tensor: xx, yy, zz, xy, xz, yz; what has z is 0 in the plane.
pub type Tensor = [f64; 6];

/// A subdomain as a material; all is 0 where no grain touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Homogenised {
    /// Grains, boundary grains by their share (–).
    pub grains: f64,
    /// `A_E` (m²; of spheres m³).
    pub volume: f64,
    /// `σ_E` (N/m; of spheres N/m²), its symmetric part.
    pub stress: Tensor,
    /// `F_E` (–); 0 where nothing pushes.
    pub fabric: Tensor,
    /// `z_E` (–).
    pub coordination: f64,
}

impl Homogenised {
    /// Mean of the normal stresses (N/m; of spheres N/m²), in so many dimensions.
    pub fn pressure(&self, dimensions: usize) -> f64 {
        self.stress[..dimensions].iter().sum::<f64>() / dimensions as f64
    }

    /// Homogenises `count` subdomains, given the `subdomain` of each contact and the impulses `r` (N·s). Bodies from number
    /// `grains` on, lids and driven segments, are walls.
    ///
    /// # Panics
    /// If there is not one subdomain below `count` and one impulse for each contact.
    pub fn of<M: Marched>(
        frozen: &Frozen<M>,
        grains: usize,
        (subdomain, count): (&[u32], usize),
        r: &[f64],
    ) -> Vec<Self> {
        let (problem, radius) = (&frozen.problem, &frozen.radius);
        assert_eq!(subdomain.len(), problem.contact_count(), "one subdomain per contact");
        assert_eq!(r.len(), problem.impulse_count(), "one impulse per contact");
        let mut in_subdomains = vec![BTreeSet::new(); grains];
        let mut of_grain = vec![Grain::default(); grains];
        for (k, contact) in problem.contacts().iter().enumerate() {
            let (candidate, antagonist) = contact.ends();
            let antagonist = antagonist.filter(|j| (*j as usize) < grains);
            let both = [Some(candidate), antagonist].into_iter().flatten();
            let (r, gap) = (M::Impulse::at(r, k), frozen.gap[k]);
            let (f, n) = (to_candidate::<M>(contact, r) / frozen.time_step, contact.normal());
            // Half of a gap between two grains belongs to each.
            let gap = if antagonist.is_some() { 0.5 * gap } else { gap };
            for i in both.map(|i| i as usize).filter(|i| *i < grains) {
                in_subdomains[i].insert(subdomain[k]);
                if r.first() > 0.0 {
                    // Force and branch both turn where the grain is the antagonist.
                    of_grain[i].moment.add(f, n * (radius[i] + gap));
                    of_grain[i].fabric.add(n, n);
                    of_grain[i].contacts += 1.0;
                }
            }
        }
        let mut all = vec![Self::default(); count];
        for (i, copies) in in_subdomains.iter().enumerate() {
            let share = 1.0 / copies.len() as f64;
            for e in copies {
                let one = &mut all[*e as usize];
                one.grains += share;
                one.volume += share * (0..M::Place::LEN).map(|_| radius[i]).product::<f64>();
                one.coordination += share * of_grain[i].contacts;
                one.stress.add_share(share, &of_grain[i].moment);
                one.fabric.add_share(share, &of_grain[i].fabric);
            }
        }
        let touching: f64 = all.iter().map(|one| one.volume).sum();
        let room = room(&problem.position()[..grains], radius);
        for one in all.iter_mut().filter(|one| one.grains > 0.0) {
            one.volume *= room / touching;
            one.stress = one.stress.map(|sum| sum / one.volume);
            one.fabric = one.fabric.map(|sum| sum / f64::max(one.coordination, f64::MIN_POSITIVE));
            one.coordination /= one.grains;
        }
        all
    }
}

/// Sums over the contacts of a grain that push.
#[derive(Clone, Copy, Default)]
struct Grain {
    moment: Tensor,
    fabric: Tensor,
    contacts: f64,
}

trait Sum {
    /// Adds the symmetric part of a ⊗ b.
    fn add<P: Place>(&mut self, a: P, b: P);

    fn add_share(&mut self, share: f64, other: &Self);
}

impl Sum for Tensor {
    fn add<P: Place>(&mut self, a: P, b: P) {
        let (a, b) = (a.space(), b.space());
        let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        for (sum, (i, j)) in self.iter_mut().zip(pairs) {
            *sum += 0.5 * (a[i] * b[j] + a[j] * b[i]);
        }
    }

    fn add_share(&mut self, share: f64, other: &Self) {
        for (sum, value) in self.iter_mut().zip(other) {
            *sum += share * value;
        }
    }
}

#[cfg(test)]
mod tests;
