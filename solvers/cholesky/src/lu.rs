//! Factors L U of matrices with entries in symmetric places, which are not symmetric: front by front as those of Cholesky. A pivot is
//! the greatest entry of its column in the own rows of its front.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod front;

use crate::Singular;
use crate::structure::{Structure, Supernode};
use crate::tree::{Fronts, Left, Memory};
use contact::SetupError;
use contact::memory::Reserved;
use front::Front;
use nalgebra::{SMatrix, SVector};
use pulp::{Arch, Simd, WithSimd};
use std::sync::Arc;

/// Contribution of a coupling of two grains, with D unknowns each, to the matrix where one acts on the other otherwise than that on it.
#[derive(Clone, Copy, Debug)]
pub struct OneWay<const D: usize> {
    /// In the rows and columns of its first grain.
    pub first: SMatrix<f64, D, D>,
    /// In those of its second, if there is one.
    pub second: SMatrix<f64, D, D>,
    /// In the rows of the first and the columns of the second, if there is one.
    pub between: SMatrix<f64, D, D>,
    /// In the rows of the second and the columns of the first, if there is one.
    pub back: SMatrix<f64, D, D>,
}

impl<const D: usize> OneWay<D> {
    /// push pullᵗ, of one column or more, given by their rows at the first grain and at the second.
    #[inline]
    pub fn product<const C: usize>(push: [SMatrix<f64, D, C>; 2], pull: [SMatrix<f64, D, C>; 2]) -> Self {
        let block = |row: usize, column: usize| push[row] * pull[column].transpose();
        Self { first: block(0, 0), second: block(1, 1), between: block(0, 1), back: block(1, 0) }
    }
}

/// The factors of P K Pᵗ, with K = diag(masses) + what the couplings add.
pub struct Lu<const D: usize> {
    structure: Arc<Structure<D>>,
    /// Columns of each supernode: of U in its own rows, with the inverses of the diagonal entries, and of L below, whose diagonal is 1.
    lower: Vec<f64>,
    /// Rows of U of each supernode, from the same place on, to the right of its own columns, one after the other.
    upper: Vec<f64>,
    /// The own row of its front, counted from itself, that took the place of each unknown's.
    exchanged: Vec<u32>,
    /// The memory of the second factor.
    _second: Reserved,
}

impl<const D: usize> Lu<D> {
    /// Memory for the factors of matrices of this structure; it has none yet.
    ///
    /// # Errors
    /// Where that is not left.
    pub fn new(structure: Arc<Structure<D>>) -> Result<Self, SetupError> {
        let (entries, unknowns) = (structure.stored(), D * structure.position().len());
        let second = Reserved::new(structure.bytes())?;
        let [lower, upper] = [(); 2].map(|()| vec![0.0; entries]);
        Ok(Self { structure, lower, upper, exchanged: vec![0; unknowns], _second: second })
    }

    /// Factorises K, with the masses of the grain at each place, one per unknown, and what each `coupling` adds, if it does.
    ///
    /// # Errors
    /// Where a front has no pivot in its own rows: this is then no factor of any.
    pub fn renew(
        &mut self,
        mass: impl Fn(usize) -> SVector<f64, D> + Sync,
        coupling: impl Fn(usize) -> Option<OneWay<D>> + Sync,
    ) -> Result<(), Singular> {
        let matrix = Matrix { structure: &self.structure, mass: &mass, coupling: &coupling };
        let memory =
            Places { lower: &mut self.lower, upper: &mut self.upper, exchanged: &mut self.exchanged };
        let why = || Singular("a front has no pivot".to_owned());
        matrix.factorise(memory).then_some(()).ok_or_else(why)
    }

    /// x ← (P K Pᵗ)⁻¹ x, for one x per place.
    pub fn solve(&self, x: &mut [SVector<f64, D>]) {
        let mut all: Vec<f64> = x.iter().flat_map(|x| x.iter().copied()).collect();
        Arch::new().dispatch(Solve { lu: self, x: &mut all });
        x.iter_mut().zip(all.as_chunks::<D>().0).for_each(|(x, all)| *x = SVector::from(*all));
    }

    /// See [`Structure::entries`]: as many of L, and of U.
    pub fn entries(&self) -> usize {
        2 * self.structure.entries()
    }
}

/// Terms of the matrix, as trait objects: see [`Lu::renew`].
struct Matrix<'m, const D: usize> {
    structure: &'m Structure<D>,
    mass: &'m (dyn Fn(usize) -> SVector<f64, D> + Sync),
    coupling: &'m (dyn Fn(usize) -> Option<OneWay<D>> + Sync),
}

/// The places of the factors of supernodes that follow one another: see [`Lu`].
struct Places<'v> {
    lower: &'v mut [f64],
    upper: &'v mut [f64],
    exchanged: &'v mut [u32],
}

impl Memory for Places<'_> {
    fn split(self, entries: usize, unknowns: usize) -> (Self, Self) {
        let (lower, upper) = (self.lower.split_at_mut(entries), self.upper.split_at_mut(entries));
        let exchanged = self.exchanged.split_at_mut(unknowns);
        let part = |lower, upper, exchanged| Self { lower, upper, exchanged };
        (part(lower.0, upper.0, exchanged.0), part(lower.1, upper.1, exchanged.1))
    }
}

impl<const D: usize> Fronts<D> for Matrix<'_, D> {
    type Memory<'v> = Places<'v>;

    fn structure(&self) -> &Structure<D> {
        self.structure
    }

    fn front(&self, k: usize, memory: Places, rest: &mut Left, children: &[(usize, &[f64])]) -> bool {
        let node = &self.structure.supernodes[k];
        let (own, below) = unknowns::<D>(node);
        rest.clear();
        rest.resize(below * below, 0.0);
        let Places { lower, upper, exchanged } = memory;
        let mut front = Front { lower, upper: &mut upper[..own * below], rest, exchanged, own, below };
        Arch::new().dispatch(|| {
            front.clear();
            for (place, at) in node.own.clone().zip(0..) {
                front.add::<D>(at, at, &SMatrix::from_diagonal(&(self.mass)(place as usize)));
            }
            for join in &self.structure.joins[node.joins.clone()] {
                let [i, j] = join.ends;
                if let Some(coupling) = (self.coupling)(join.coupling as usize) {
                    front.add(i, i, &coupling.first);
                    if i != j {
                        front.add(j, j, &coupling.second);
                        front.add(i, j, &coupling.between);
                        front.add(j, i, &coupling.back);
                    }
                }
            }
            for (child, left) in children {
                let rows = &self.structure.in_parent[self.structure.supernodes[*child].rows.clone()];
                front.extend_add::<D>(left, rows);
            }
        });
        front.eliminate()
    }
}

/// Unknowns of a supernode: its own, and those of its rows below.
fn unknowns<const D: usize>(node: &Supernode) -> (usize, usize) {
    (D * node.own.len(), D * node.rows.len())
}

/// See [`Lu::solve`].
struct Solve<'s, const D: usize> {
    lu: &'s Lu<D>,
    x: &'s mut [f64],
}

impl<const D: usize> WithSimd for Solve<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { lu, x } = self;
        let Lu { structure, lower, upper, exchanged, .. } = lu;
        let mut far = Vec::new();
        for node in &structure.supernodes {
            let (own, below) = unknowns::<D>(node);
            let rows = &structure.rows[node.rows.clone()];
            let start = D * node.own.start as usize;
            let near = &mut x[start..start + own];
            // A right side at few grains leaves most supernodes alone.
            if near.iter().all(|x| *x == 0.0) {
                continue;
            }
            for (j, at) in exchanged[start..start + own].iter().enumerate() {
                near.swap(j, j + *at as usize);
            }
            far.clear();
            far.resize(below, 0.0);
            for (j, column) in
                lower[node.start..][..(own + below) * own].chunks_exact(own + below).enumerate()
            {
                let factor = near[j];
                near[j + 1..].iter_mut().zip(&column[j + 1..]).for_each(|(x, l)| *x -= factor * l);
                far.iter_mut().zip(&column[own..]).for_each(|(x, l)| *x += factor * l);
            }
            for (row, far) in rows.iter().zip(far.as_chunks::<D>().0) {
                let at = D * *row as usize;
                x[at..at + D].iter_mut().zip(far).for_each(|(x, far)| *x -= far);
            }
        }
        for node in structure.supernodes.iter().rev() {
            let (own, below) = unknowns::<D>(node);
            let start = D * node.own.start as usize;
            far.clear();
            for row in &structure.rows[node.rows.clone()] {
                far.extend_from_slice(&x[D * *row as usize..][..D]);
            }
            let near = &mut x[start..start + own];
            if below > 0 {
                for (x, row) in near.iter_mut().zip(upper[node.start..][..own * below].chunks_exact(below)) {
                    *x -= dot(row, &far);
                }
            }
            for (j, column) in
                lower[node.start..][..(own + below) * own].chunks_exact(own + below).enumerate().rev()
            {
                let factor = near[j] * column[j];
                near[j] = factor;
                near[..j].iter_mut().zip(column).for_each(|(x, u)| *x -= factor * u);
            }
        }
    }
}

/// Σ a b, in four sums.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}
