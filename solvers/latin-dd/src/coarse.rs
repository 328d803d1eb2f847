//! The coarse problem: interface impulses whose resultants vanish on every interface, at each linear stage.
//!
//! The multiscale step that Iceta et al. 2009 name as perspective, after Alart & Dureisseix, Comput. Methods Appl. Mech.
//! Engrg. 197 (2008) 319-331: an interface is the set of boundary grains between the same subdomains, its large scale the
//! translations, of which there are T. A velocity w per interface is added to what the local stage asks of its copies,
//! τ ← τ + d⁻ w, such that Σ F_E = 0 over the interface's grains and copies:
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
use partition::{Decomposition, Team};
use std::collections::{BTreeMap, BTreeSet};

/// Side of an interface that belongs to one of its subdomains.
struct Side<const D: usize, const T: usize> {
    /// Place of the interface in the order of the coarse factor.
    interface: usize,
    /// Places of the interface's grains in the subdomain, and their d⁻ (kg).
    grains: Vec<(usize, f64)>,
    /// K_E⁻¹ d⁻ `B_E`: what a unit w does to each grain's velocity (–).
    influence: Vec<SMatrix<f64, D, T>>,
}

/// The coarse problem, factorised: all ranks have it, and each its own sides.
pub(crate) struct Coarse<const D: usize, const T: usize> {
    team: Team,
    /// By own subdomain.
    sides: Vec<Vec<Side<D, T>>>,
    factor: Factor<T>,
    /// Place of the interface of each side of all ranks, in the order of subdomains.
    all: Vec<usize>,
    /// g, then w, of each interface in the order of the factor.
    w: Vec<SVector<f64, T>>,
}

impl<const D: usize, const T: usize> Coarse<D, T> {
    /// Groups the boundary grains into interfaces, and assembles and factorises S for these factors of K_E.
    pub(crate) fn new<'f, M: Stages<Velocity = SVector<f64, D>>>(
        problem: &ContactProblem<M>,
        (decomposition, team): (&Decomposition, &Team),
        subdomains: &[Latin<M, D>],
        factor_of: impl Fn(usize) -> &'f Factor<D>,
        kappa_d_minus: f64,
    ) -> Result<Self, SetupError> {
        let refused = |why: Singular| {
            let where_not = format!("false where kappa_d_minus is {kappa_d_minus:e}");
            SetupError::new("coarse", true, format!("{where_not}: its matrix cannot be factorised ({why})"))
        };
        let interfaces = interfaces(decomposition);
        let number_of = numbers(&interfaces, team);
        let mut sides: Vec<Vec<Side<D, T>>> = subdomains.iter().map(|_| Vec::new()).collect();
        for (between, grains) in &interfaces {
            for (k, e) in between.iter().enumerate() {
                let Some(e) = e.checked_sub(decomposition.first).filter(|e| (*e as usize) < sides.len())
                else {
                    continue;
                };
                let (latin, subdomain) = (&subdomains[e as usize], &decomposition.subdomains[e as usize]);
                let grains: Vec<(usize, f64)> = grains
                    .iter()
                    .map(|copies| {
                        let (_, copy) = copies[k];
                        let grain = subdomain.grains[subdomain.boundary[copy as usize] as usize] as usize;
                        let mass = masses::<M, D>(problem.mass()[grain])[0];
                        let d_minus = kappa_d_minus * mass / copies.len() as f64;
                        (latin.boundary[copy as usize] as usize, d_minus)
                    })
                    .collect();
                let influence = latin.influence(factor_of(e as usize), &grains);
                sides[e as usize].push(Side { interface: number_of[between], grains, influence });
            }
        }
        let mut own = Vec::new();
        for (row, column) in pairs(&sides) {
            own.extend([row.interface as f64, column.interface as f64]);
            own.extend(block(row, column).iter());
        }
        let read = |pair: &[f64]| (pair[0] as u32, pair[1] as u32, SMatrix::from_column_slice(&pair[2..]));
        let all: Vec<_> = team.gather(&own).concat().chunks_exact(2 + T * T).map(read).collect();
        let ends: Vec<_> = all.iter().map(|(row, column, _)| ends(*row, *column)).collect();
        let order = Order::minimum_degree(number_of.len(), &ends)?;
        let structure = team.unless_refused(Structure::new(&ends, &order))?;
        for side in sides.iter_mut().flatten() {
            side.interface = structure.position()[side.interface] as usize;
        }
        let own: Vec<f64> = sides.iter().flatten().map(|side| side.interface as f64).collect();
        let places = team.gather(&own).concat().into_iter().map(|place| place as usize).collect();
        let factor =
            Factor::new(structure, |_| SVector::zeros(), |k| Some(coupling(all[k]))).map_err(refused)?;
        let w = vec![SVector::zeros(); number_of.len()];
        Ok(Self { team: team.clone(), sides, factor, all: places, w })
    }

    /// Solves for w, and brings every subdomain's V_E and τ to it.
    pub(crate) fn correct<M>(&mut self, subdomains: &mut [Latin<M, D>])
    where
        M: Stages<Velocity = SVector<f64, D>>,
    {
        self.add_up(subdomains);
        let Self { sides, factor, w, .. } = self;
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

    /// g: Σ F_E over the grains and copies of each interface (N·s).
    fn add_up<M: Stages<Velocity = SVector<f64, D>>>(&mut self, subdomains: &[Latin<M, D>]) {
        let sides = self.sides.iter().zip(subdomains);
        let own: Vec<f64> = sides
            .flat_map(|(sides, latin)| {
                sides.iter().flat_map(|side| latin.resultant::<T>(&side.grains).data.0[0])
            })
            .collect();
        self.w.fill(SVector::zeros());
        let of_ranks = self.team.gather(&own);
        let all = of_ranks.iter().flat_map(|of_rank| of_rank.as_chunks::<T>().0);
        for (place, g) in self.all.iter().zip(all) {
            self.w[*place] += SVector::from(*g);
        }
    }

    /// g of each interface (N·s).
    #[cfg(test)]
    pub(crate) fn resultants<M>(&mut self, subdomains: &[Latin<M, D>]) -> Vec<SVector<f64, T>>
    where
        M: Stages<Velocity = SVector<f64, D>>,
    {
        self.add_up(subdomains);
        self.w.clone()
    }

    /// Entries of the factor that a correction goes through, twice; and those of the influences of the own sides, once.
    pub(crate) fn entries(&self) -> [usize; 2] {
        let influences = self.sides.iter().flatten().map(|side| T * D * side.influence.len()).sum();
        [2 * self.factor.entries(), influences]
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

/// The boundary grains, as the copies of each, by the subdomains between which they are.
type Interfaces<'d> = BTreeMap<Vec<u32>, Vec<&'d Vec<(u32, u32)>>>;

fn interfaces(decomposition: &Decomposition) -> Interfaces<'_> {
    let mut interfaces = Interfaces::new();
    for copies in &decomposition.boundary {
        let between = copies.iter().map(|(e, _)| *e).collect();
        interfaces.entry(between).or_default().push(copies);
    }
    interfaces
}

/// The number of each interface among those of all ranks. The rank of its first subdomain tells the others of it.
fn numbers(interfaces: &Interfaces, team: &Team) -> BTreeMap<Vec<u32>, usize> {
    let own = interfaces.keys().filter(|between| team.mine().contains(&(between[0] as usize)));
    let own: Vec<f64> = own
        .flat_map(|between| std::iter::once(between.len() as u32).chain(between.iter().copied()))
        .map(f64::from)
        .collect();
    let all = team.gather(&own).concat();
    let (mut between, mut rest) = (BTreeSet::new(), &all[..]);
    while let Some((length, after)) = rest.split_first() {
        let (subdomains, after) = after.split_at(*length as usize);
        between.insert(subdomains.iter().map(|e| *e as u32).collect::<Vec<_>>());
        rest = after;
    }
    between.into_iter().zip(0..).collect()
}

/// All pairs of sides of one subdomain, either once.
fn pairs<const D: usize, const T: usize>(
    sides: &[Vec<Side<D, T>>],
) -> impl Iterator<Item = (&Side<D, T>, &Side<D, T>)> {
    sides.iter().flat_map(|sides| {
        sides.iter().enumerate().flat_map(|(k, row)| sides[k..].iter().map(move |column| (row, column)))
    })
}

/// Two interfaces, or the one that both are.
fn ends(row: u32, column: u32) -> (u32, Option<u32>) {
    (row, (row != column).then_some(column))
}

/// Returns the contribution of two sides of one subdomain to S.
fn block<const D: usize, const T: usize>(row: &Side<D, T>, column: &Side<D, T>) -> SMatrix<f64, T, T> {
    let mut block = SMatrix::zeros();
    for (place, d_minus) in &row.grains {
        block -= column.influence[*place].fixed_rows::<T>(0) * *d_minus;
    }
    if row.interface == column.interface {
        let own: f64 = row.grains.iter().map(|(_, d_minus)| d_minus).sum();
        block += own * SMatrix::identity();
    }
    block
}

/// Returns the contribution, with the interfaces of the two sides, in the form of the factor.
fn coupling<const T: usize>((row, column, block): (u32, u32, SMatrix<f64, T, T>)) -> Coupling<T> {
    let zeros = SMatrix::zeros();
    if row == column {
        Coupling { first: block, second: zeros, between: zeros }
    } else {
        Coupling { first: zeros, second: zeros, between: block }
    }
}
