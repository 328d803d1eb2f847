//! The factor of a matrix, front by front up the tree of supernodes.

use crate::Singular;
use crate::front::Front;
use crate::solve::solve;
use crate::structure::{Join, Structure};
use crate::tree::{Fronts, Left};
use nalgebra::{SMatrix, SVector};
use pulp::Arch;
use std::ops::Add;
use std::sync::Arc;

/// Contribution of a coupling of two grains to the matrix, with D unknowns of each.
#[derive(Clone, Copy, Debug)]
pub struct Coupling<const D: usize = 2> {
    /// In the rows and columns of its first grain.
    pub first: SMatrix<f64, D, D>,
    /// In those of its second, if there is one.
    pub second: SMatrix<f64, D, D>,
    /// In the rows of the first and the columns of the second, if there is one.
    pub between: SMatrix<f64, D, D>,
}

impl<const D: usize> Coupling<D> {
    /// A W Aᵗ with a symmetric W, and A given by its rows at the first grain and at the second.
    #[inline]
    pub fn product<const C: usize>(rows: [SMatrix<f64, D, C>; 2], weights: SMatrix<f64, C, C>) -> Self {
        let [first, second] = rows.map(|rows| rows * weights);
        Self {
            first: first * rows[0].transpose(),
            second: second * rows[1].transpose(),
            between: first * rows[1].transpose(),
        }
    }

    /// w h hᵗ, with h at the first grain, and at the second.
    #[inline]
    pub fn dyad(weight: f64, first: SVector<f64, D>, second: SVector<f64, D>) -> Self {
        Self {
            first: weight * first * first.transpose(),
            second: weight * second * second.transpose(),
            between: weight * first * second.transpose(),
        }
    }
}

/// Sum of two contributions.
impl<const D: usize> Add for Coupling<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            first: self.first + other.first,
            second: self.second + other.second,
            between: self.between + other.between,
        }
    }
}

/// The factor L of P K Pᵗ = L Lᵗ, with K = diag(masses) + what the couplings add.
pub struct Factor<const D: usize = 2> {
    structure: Arc<Structure<D>>,
    /// Columns of L of each supernode, with the inverses of the diagonal entries in their places.
    values: Vec<f64>,
}

/// Terms of the matrix: the masses of each place, and what each coupling adds, if it does. Trait objects, or each method would
/// have a factorisation of its own compiled.
struct Matrix<'m, const D: usize> {
    structure: &'m Structure<D>,
    mass: &'m (dyn Fn(usize) -> SVector<f64, D> + Sync),
    coupling: &'m (dyn Fn(usize) -> Option<Coupling<D>> + Sync),
}

impl<const D: usize> Fronts<D> for Matrix<'_, D> {
    type Memory<'v> = &'v mut [f64];

    fn structure(&self) -> &Structure<D> {
        self.structure
    }

    fn front(&self, k: usize, panel: &mut [f64], rest: &mut Left, children: &[(usize, &[f64])]) -> bool {
        let node = &self.structure.supernodes[k];
        let own = D * node.own.len();
        let rows = own + D * node.rows.len();
        panel.fill(0.0);
        rest.clear();
        rest.resize((rows - own) * (rows - own), 0.0);
        let mut front = Assembly::<D> { panel, rest, own, rows };
        for (column, place) in node.own.clone().enumerate() {
            let mass = (self.mass)(place as usize);
            for (c, mass) in mass.iter().enumerate() {
                front.panel[(D * column + c) * (rows + 1)] = *mass;
            }
        }
        for join in &self.structure.joins[node.joins.clone()] {
            if let Some(coupling) = (self.coupling)(join.coupling as usize) {
                front.add(join, &coupling);
            }
        }
        for (child, left) in children {
            let rows = &self.structure.in_parent[self.structure.supernodes[*child].rows.clone()];
            front.extend_add(left, rows);
        }
        Front { panel: front.panel, rest: front.rest, own, rows }.eliminate()
    }
}

/// A front as it is put together.
struct Assembly<'m, const D: usize> {
    panel: &'m mut [f64],
    rest: &'m mut [f64],
    own: usize,
    rows: usize,
}

impl<const D: usize> Assembly<'_, D> {
    /// The column of the front, from its row `from` on.
    #[inline]
    fn column(&mut self, column: usize, from: usize) -> &mut [f64] {
        if column < self.own {
            &mut self.panel[column * self.rows + from..(column + 1) * self.rows]
        } else {
            let stride = self.rows - self.own;
            &mut self.rest[(column - self.own) * stride + from - self.own..(column - self.own + 1) * stride]
        }
    }

    #[inline]
    fn add(&mut self, join: &Join, coupling: &Coupling<D>) {
        let [i, j] = join.ends.map(|index| D * index as usize);
        self.add_block(i, i, &coupling.first);
        if i < j {
            self.add_block(j, j, &coupling.second);
            self.add_block(j, i, &coupling.between.transpose());
        } else if j < i {
            self.add_block(j, j, &coupling.second);
            self.add_block(i, j, &coupling.between);
        }
    }

    #[inline]
    fn add_block(&mut self, row: usize, column: usize, block: &SMatrix<f64, D, D>) {
        for (c, block) in block.column_iter().enumerate() {
            let column = &mut self.column(column + c, row)[..D];
            column.iter_mut().zip(&block).for_each(|(entry, block)| *entry += block);
        }
    }

    /// Adds what a child left, whose rows have these indices.
    #[inline]
    fn extend_add(&mut self, left: &[f64], rows: &[u32]) {
        let stride = D * rows.len();
        for (k, index) in rows.iter().enumerate() {
            let top = D * *index as usize;
            for c in 0..D {
                let column = self.column(top + c, top);
                let left = &left[(D * k + c) * stride + D * k..(D * k + c + 1) * stride];
                for (row, left) in rows[k..].iter().zip(left.as_chunks::<D>().0) {
                    let at = D * *row as usize - top;
                    column[at..at + D].iter_mut().zip(left).for_each(|(entry, left)| *entry += left);
                }
            }
        }
    }
}

impl<const D: usize> Factor<D> {
    /// Factorises K, with the masses of the grain at each place, one per unknown, and what each `coupling` adds, if it does; the
    /// lower triangle counts.
    ///
    /// # Errors
    /// Where it is not positive definite in double precision.
    pub fn new(
        structure: Arc<Structure<D>>,
        mass: impl Fn(usize) -> SVector<f64, D> + Sync,
        coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync,
    ) -> Result<Self, Singular> {
        let values = vec![0.0; structure.stored()];
        let mut factor = Self { structure, values };
        factor.renew(mass, coupling)?;
        Ok(factor)
    }

    /// Factorises another matrix of the same structure in the same memory.
    ///
    /// # Errors
    /// Where it is not positive definite in double precision: this is then no factor of any.
    pub fn renew(
        &mut self,
        mass: impl Fn(usize) -> SVector<f64, D> + Sync,
        coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync,
    ) -> Result<(), Singular> {
        let structure = &*self.structure;
        let matrix = Matrix { structure, mass: &mass, coupling: &coupling };
        let why = || Singular("it is not positive definite in double precision".to_owned());
        matrix.factorise(&mut self.values).then_some(()).ok_or_else(why)
    }

    /// Leaves the factor of another matrix, as of [`Factor::renew`], in the place of one or of none; says whether it has one. Where it
    /// has none, none is left.
    pub fn replace(
        place: &mut Option<Self>,
        structure: &Arc<Structure<D>>,
        mass: impl Fn(usize) -> SVector<f64, D> + Sync,
        coupling: impl Fn(usize) -> Option<Coupling<D>> + Sync,
    ) -> bool {
        let done = match place {
            Some(factor) => factor.renew(mass, coupling),
            None => Self::new(Arc::clone(structure), mass, coupling).map(|new| *place = Some(new)),
        };
        if done.is_err() {
            *place = None;
        }
        place.is_some()
    }

    /// x ← (P K Pᵗ)⁻¹ x, for one x per place.
    pub fn solve(&self, x: &mut [SVector<f64, D>]) {
        Arch::new().dispatch(|| solve(&self.structure, &self.values, x));
    }

    /// Returns the part of the factor that depends on the coupled grains alone.
    pub fn structure(&self) -> &Structure<D> {
        &self.structure
    }

    /// See [`Structure::entries`].
    pub fn entries(&self) -> usize {
        self.structure.entries()
    }
}
