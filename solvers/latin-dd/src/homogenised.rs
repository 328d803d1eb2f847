//! What a subdomain is as a material to LATIN-DD (§5): how its interface answers a uniform strain of its boundary.
//!
//! With V̂ = ε (x − x̄) asked of the boundary grains, x̄ their centre, τ = d⁻ V̂, (1) (4) (5) give V_E = K_E⁻¹ d⁻ B ε and
//! F_E = d⁻ (B ε − V_E), hence the condensed operator of the coarse problem with the strains in place of its translations:
//!
//! C_E = `B_E`ᵗ (d⁻ − d⁻ K_E⁻¹ d⁻) `B_E`
//!
//! Its contacts have the stiffness l⁻, not their law; masses resist too.

use crate::run::Run;
use crate::stages::Stages;
use crate::subdomain::Latin;
use nalgebra::{DMatrix, SVector};
use partition::Subdomain;

impl<M, const D: usize, const T: usize> Run<'_, M, D, T>
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    /// C_E of each own subdomain (kg m²): symmetric, not negative, a row and a column for each of the strains xx, yy, then in space
    /// zz, then the shears xy, xz, yz, where V̂ = ½ (y, x) for xy. `position` is that of each grain (m).
    ///
    /// # Panics
    /// If a grain of a subdomain has no position.
    pub fn stiffness(&self, position: &[SVector<f64, T>]) -> Vec<DMatrix<f64>> {
        let normal = (0..T).map(|i| (i, i));
        let shear = (0..T).flat_map(|i| (i + 1..T).map(move |j| (i, j)));
        let strains: Vec<_> = normal.chain(shear).collect();
        let of = |(latin, subdomain): (&Latin<M, D>, &Subdomain)| {
            let place = |local: &u32| position[subdomain.grains[*local as usize] as usize];
            let count = subdomain.boundary.len().max(1) as f64;
            let centre = subdomain.boundary.iter().map(place).sum::<SVector<f64, T>>() / count;
            let arms: Vec<_> = subdomain.boundary.iter().map(|local| place(local) - centre).collect();
            let columns = strains.iter().map(|(i, j)| {
                let motion = |arm: &SVector<f64, T>| {
                    let mut v = SVector::zeros();
                    v[*i] += 0.5 * arm[*j];
                    v[*j] += 0.5 * arm[*i];
                    v
                };
                arms.iter().map(motion).collect::<Vec<SVector<f64, D>>>()
            });
            let columns: Vec<_> = columns.collect();
            let answers: Vec<_> = columns.iter().map(|column| latin.answer(column)).collect();
            let work =
                |a: &[SVector<f64, D>], f: &[SVector<f64, D>]| a.iter().zip(f).map(|(a, f)| a.dot(f)).sum();
            DMatrix::from_fn(strains.len(), strains.len(), |i, j| work(&columns[i], &answers[j]))
        };
        self.subdomains.iter().zip(&self.decomposition.subdomains).map(of).collect()
    }
}

/// The least and the greatest eigenvalue of C_E.
#[cfg(test)]
fn ends(stiffness: &DMatrix<f64>) -> (f64, f64) {
    let eigenvalues = stiffness.clone().symmetric_eigenvalues();
    (eigenvalues.min(), eigenvalues.max())
}

#[cfg(test)]
mod tests {
    use super::ends;
    use crate::{LatinDd, Run};
    use cases::Frozen;
    use contact::Packing;
    use partition::Grid;
    use std::path::Path;

    fn settled() -> Packing {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/frozen/settled-250.json");
        Frozen::read(&file).unwrap().problem
    }

    fn run(problem: &Packing, kappa_l: f64, kappa_d: f64) -> Run<'_> {
        let (subdomains, [l, d]) = (Grid::of(2, 2), [kappa_l, kappa_d].map(Some));
        let settings = LatinDd { subdomains, kappa_l: l, kappa_d: d, ..LatinDd::default() };
        settings.run(problem, &vec![0.0; problem.contact_count()]).unwrap()
    }

    #[test]
    fn stiffness_is_symmetric_and_positive_and_grows_with_that_of_contacts() {
        let problem = settled();
        let [soft, stiff] = [1.0, 10.0].map(|l| run(&problem, l, 10.0).stiffness(problem.position()));
        for (soft, stiff) in soft.iter().zip(&stiff) {
            assert!((soft - soft.transpose()).norm() < 1e-10 * soft.norm());
            assert!(ends(soft).0 > 0.0);
            // By Loewner's order, since K_E grows.
            assert!(ends(&(stiff - soft)).0 > 0.0);
        }
    }

    #[test]
    fn stiff_interface_that_holds_no_contacts_feels_the_masses_alone() {
        let problem = settled();
        // κ_l so small that K_E is M_E + d⁻: C_E = Σ d⁻ M/(d⁻ + M) of each arm, with d⁻ = κ_d M.
        let [one, two] = [1.0, 3.0].map(|d| run(&problem, 1e-14, d).stiffness(problem.position()));
        for (one, two) in one.iter().zip(&two) {
            // κ/(1 + κ) is ½ and ¾.
            assert!((two / 0.75 - one / 0.5).norm() < 1e-9 * one.norm());
        }
    }
}
