//! The coarse problem: interface impulses whose resultants vanish on every interface, at each linear stage.
//!
//! The multiscale step that Iceta et al. 2009 name as perspective, after Alart & Dureisseix, Comput. Methods Appl. Mech.
//! Engrg. 197 (2008) 319-331: an interface is the set of boundary grains between the same subdomains, its large scale the
//! translations, of which there are T. A velocity w per interface is added to what the local stage asks of its copies, τ ← τ + d⁻ w, such that
//! Σ F_E = 0 over the interface's grains and copies:
//!
//! S w = −g,   S = Σ_E `B_E`ᵗ (d⁻ − d⁻ K_E⁻¹ d⁻) `B_E`,   g = Σ_E `B_E`ᵗ F_E
//!
//! with K_E the matrix of the linear stage and `B_E` the translations of the interfaces' grains; spins, where grains have
//! some, have no large scale here: w translates whole interfaces and rotates none. At convergence w = 0.

use crate::assembly::masses;
use crate::stages::Stages;
use crate::subdomain::Latin;
use cholesky::{Coupling, Factor, Order, Singular, Structure};
use contact::{ContactProblem, SetupError};
use nalgebra::{SMatrix, SVector};
use partition::Decomposition;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What an interface is to one of its subdomains.
struct Side<const D: usize, const T: usize> {
    /// Place of the interface in the order of the coarse factor.
    interface: usize,
    /// Places of the interface's grains in the subdomain, and their d⁻ (kg).
    grains: Vec<(usize, f64)>,
    /// K_E⁻¹ d⁻ `B_E`: what a unit w does to each grain's velocity (–).
    influence: Vec<SMatrix<f64, D, T>>,
}

/// The coarse problem, factorised.
pub(crate) struct Coarse<const D: usize, const T: usize> {
    /// By subdomain.
    sides: Vec<Vec<Side<D, T>>>,
    factor: Factor<T>,
    /// g, then w, of each interface in the order of the factor.
    w: Vec<SVector<f64, T>>,
}

impl<const D: usize, const T: usize> Coarse<D, T> {
    /// Groups the boundary grains into interfaces, and assembles and factorises S for these factors of K_E.
    pub(crate) fn new<'f, M: Stages<Velocity = SVector<f64, D>>>(
        problem: &ContactProblem<M>,
        decomposition: &Decomposition,
        subdomains: &[Latin<M, D>],
        factor_of: impl Fn(usize) -> &'f Factor<D>,
        kappa_d_minus: f64,
    ) -> Result<Self, SetupError> {
        let refused = |why: Singular| {
            let where_not = format!("false where kappa_d_minus is {kappa_d_minus:e}");
            SetupError::new("coarse", true, format!("{where_not}: its matrix cannot be factorised ({why})"))
        };
        let interfaces = interfaces(decomposition);
        let mut sides: Vec<Vec<Side<D, T>>> = subdomains.iter().map(|_| Vec::new()).collect();
        for (interface, grains) in interfaces.iter().enumerate() {
            for (k, (e, _)) in grains[0].iter().enumerate() {
                let latin = &subdomains[*e as usize];
                let grains: Vec<(usize, f64)> = grains
                    .iter()
                    .map(|copies| {
                        let subdomain = &decomposition.subdomains[*e as usize];
                        let (_, copy) = copies[k];
                        let grain = subdomain.grains[subdomain.boundary[copy as usize] as usize] as usize;
                        let mass = masses::<M, D>(problem.mass()[grain])[0];
                        let d_minus = kappa_d_minus * mass / copies.len() as f64;
                        (latin.boundary[copy as usize] as usize, d_minus)
                    })
                    .collect();
                let influence = latin.influence(factor_of(*e as usize), &grains);
                sides[*e as usize].push(Side { interface, grains, influence });
            }
        }
        let ends: Vec<_> = pairs(&sides).map(|(row, column)| ends(row, column)).collect();
        let couplings: Vec<_> = pairs(&sides).map(|(row, column)| coupling(row, column)).collect();
        let order = Order::minimum_degree(interfaces.len(), &ends).map_err(refused)?;
        let structure = Arc::new(Structure::new(&ends, &order));
        for side in sides.iter_mut().flatten() {
            side.interface = structure.position()[side.interface] as usize;
        }
        let factor = Factor::new(structure, |_| SVector::zeros(), |k| Some(couplings[k])).map_err(refused)?;
        Ok(Self { sides, factor, w: vec![SVector::zeros(); interfaces.len()] })
    }

    /// Solves for w, and brings every subdomain's V_E and τ to it.
    pub(crate) fn correct<M>(&mut self, subdomains: &mut [Latin<M, D>])
    where
        M: Stages<Velocity = SVector<f64, D>>,
    {
        let Self { sides, factor, w } = self;
        resultants(sides, subdomains, w);
        for g in w.iter_mut() {
            *g = -*g;
        }
        factor.solve(w);
        for (sides, latin) in sides.iter().zip(subdomains) {
            for side in sides {
                latin.translate(&side.grains, &side.influence, w[side.interface]);
            }
        }
    }

    /// g of each interface (N·s).
    #[cfg(test)]
    pub(crate) fn resultants<M>(&self, subdomains: &[Latin<M, D>]) -> Vec<SVector<f64, T>>
    where
        M: Stages<Velocity = SVector<f64, D>>,
    {
        let mut g = self.w.clone();
        resultants(&self.sides, subdomains, &mut g);
        g
    }

    /// Entries that a correction goes through: those of the factor twice, those of the influences once.
    pub(crate) fn entries(&self) -> usize {
        let influences: usize = self.sides.iter().flatten().map(|side| T * D * side.influence.len()).sum();
        2 * self.factor.entries() + influences
    }

    /// Multiply-adds of the factorisation of S.
    pub(crate) fn factorisation(&self) -> u64 {
        self.factor.structure().work()
    }

    /// Number of interfaces.
    pub(crate) fn interfaces(&self) -> usize {
        self.w.len()
    }
}

/// g: Σ F_E over the grains and copies of each interface (N·s).
fn resultants<M, const D: usize, const T: usize>(
    sides: &[Vec<Side<D, T>>],
    subdomains: &[Latin<M, D>],
    g: &mut [SVector<f64, T>],
) where
    M: Stages<Velocity = SVector<f64, D>>,
{
    g.fill(SVector::zeros());
    for (sides, latin) in sides.iter().zip(subdomains) {
        for side in sides {
            g[side.interface] += latin.resultant(&side.grains);
        }
    }
}

/// The boundary grains by the subdomains between which they are, as the copies of each.
fn interfaces(decomposition: &Decomposition) -> Vec<Vec<&Vec<(u32, u32)>>> {
    let mut interfaces = BTreeMap::<Vec<u32>, Vec<_>>::new();
    for copies in &decomposition.boundary {
        let between = copies.iter().map(|(e, _)| *e).collect();
        interfaces.entry(between).or_default().push(copies);
    }
    interfaces.into_values().collect()
}

/// All pairs of sides of one subdomain, either once.
fn pairs<const D: usize, const T: usize>(
    sides: &[Vec<Side<D, T>>],
) -> impl Iterator<Item = (&Side<D, T>, &Side<D, T>)> {
    sides.iter().flat_map(|sides| {
        sides.iter().enumerate().flat_map(|(k, row)| sides[k..].iter().map(move |column| (row, column)))
    })
}

/// The interfaces of two sides, or the one that both are.
fn ends<const D: usize, const T: usize>(row: &Side<D, T>, column: &Side<D, T>) -> (u32, Option<u32>) {
    (row.interface as u32, (row.interface != column.interface).then_some(column.interface as u32))
}

/// What two sides of one subdomain add to S.
fn coupling<const D: usize, const T: usize>(row: &Side<D, T>, column: &Side<D, T>) -> Coupling<T> {
    let mut block = SMatrix::zeros();
    for (place, d_minus) in &row.grains {
        block -= column.influence[*place].fixed_rows::<T>(0) * *d_minus;
    }
    let zeros = SMatrix::zeros();
    if row.interface == column.interface {
        let own: f64 = row.grains.iter().map(|(_, d_minus)| d_minus).sum();
        Coupling { first: block + own * SMatrix::identity(), second: zeros, between: zeros }
    } else {
        Coupling { first: zeros, second: zeros, between: block }
    }
}
