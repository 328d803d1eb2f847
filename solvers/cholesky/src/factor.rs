//! The factor of a matrix, front by front up the tree of supernodes.

use crate::Singular;
use crate::front::Front;
use crate::solve::solve;
use crate::structure::{Join, Structure};
use nalgebra::{Matrix2, Vector2};
use pulp::Arch;
use rayon::prelude::*;
use std::sync::Arc;

/// What a coupling of two grains adds to the matrix.
#[derive(Clone, Copy, Debug)]
pub struct Coupling {
    /// In the rows and columns of its first grain.
    pub first: Matrix2<f64>,
    /// In those of its second, if there is one.
    pub second: Matrix2<f64>,
    /// In the rows of the first and the columns of the second, if there is one.
    pub between: Matrix2<f64>,
}

impl Coupling {
    /// w h hᵗ, with h at the first grain, and at the second.
    #[inline]
    pub fn dyad(weight: f64, first: Vector2<f64>, second: Vector2<f64>) -> Self {
        Self {
            first: weight * first * first.transpose(),
            second: weight * second * second.transpose(),
            between: weight * first * second.transpose(),
        }
    }
}

/// The factor L of P K Pᵗ = L Lᵗ, with K = diag(masses) + what the couplings add.
pub struct Factor {
    structure: Arc<Structure>,
    /// Of each supernode, its columns of L, with the inverses of the diagonal entries in their places.
    values: Vec<f64>,
}

/// What the matrix is made of: the mass of each place, and what each coupling adds, if it does.
struct Matrix<'m, M, C> {
    structure: &'m Structure,
    mass: M,
    coupling: C,
}

/// Multiply-adds of a subtree that are worth a thread.
const WORTH_A_THREAD: u64 = 1_000_000;

/// What a supernode leaves to its parent: (2 × rows)², column by column.
type Left = Vec<f64>;

impl<M: Fn(usize) -> f64 + Sync, C: Fn(usize) -> Option<Coupling> + Sync> Matrix<'_, M, C> {
    /// The subtree of supernode `k` into its `values`; what it leaves, or `None` where a pivot is not positive.
    fn subtree(&self, k: usize, values: &mut [f64]) -> Option<Left> {
        let node = &self.structure.supernodes[k];
        if node.work < WORTH_A_THREAD || node.children == 0 {
            return self.in_turn(node.first as usize, k, values);
        }
        let base = self.structure.supernodes[node.first as usize].start;
        let (below, panel) = values.split_at_mut(node.start - base);
        let left = self.subtrees(self.structure.children(k).into_iter(), below)?;
        let children: Vec<_> = left.iter().map(|(k, left)| (*k, &left[..])).collect();
        let mut rest = Vec::new();
        self.front(k, panel, &mut rest, &children).then_some(rest)
    }

    /// Subtrees whose `values` follow one another, in threads.
    fn subtrees(
        &self,
        tops: impl Iterator<Item = usize>,
        mut values: &mut [f64],
    ) -> Option<Vec<(usize, Left)>> {
        let mut parts = Vec::new();
        for k in tops {
            let first = self.structure.supernodes[k].first as usize;
            let entries = self.structure.end(k) - self.structure.supernodes[first].start;
            let (part, others) = values.split_at_mut(entries);
            parts.push((k, part));
            values = others;
        }
        let most = parts.iter().map(|(k, _)| self.structure.supernodes[*k].work).max().unwrap_or(0);
        let together = if most < WORTH_A_THREAD { usize::MAX } else { 1 };
        parts
            .into_par_iter()
            .with_min_len(together)
            .map(|(k, part)| Some((k, self.subtree(k, part)?)))
            .collect()
    }

    /// Supernodes `first` to `last`, a subtree, one after the other.
    fn in_turn(&self, first: usize, last: usize, values: &mut [f64]) -> Option<Left> {
        let base = self.structure.supernodes[first].start;
        let mut waiting: Vec<(usize, Left)> = Vec::new();
        let mut spare: Vec<Left> = Vec::new();
        for k in first..=last {
            let node = &self.structure.supernodes[k];
            let own = waiting.len() - node.children as usize;
            let mut rest = spare.pop().unwrap_or_default();
            let children: Vec<_> = waiting[own..].iter().map(|(k, left)| (*k, &left[..])).collect();
            let panel = &mut values[node.start - base..self.structure.end(k) - base];
            if !self.front(k, panel, &mut rest, &children) {
                return None;
            }
            spare.extend(waiting.drain(own..).map(|(_, left)| left));
            waiting.push((k, rest));
        }
        waiting.pop().map(|(_, left)| left)
    }

    /// Assembles the front of supernode `k` with what its children left, and eliminates its own columns.
    fn front(&self, k: usize, panel: &mut [f64], rest: &mut Left, children: &[(usize, &[f64])]) -> bool {
        let node = &self.structure.supernodes[k];
        let own = 2 * node.own.len();
        let rows = own + 2 * node.rows.len();
        panel.fill(0.0);
        rest.clear();
        rest.resize((rows - own) * (rows - own), 0.0);
        let mut front = Assembly { panel, rest, own, rows };
        for (column, place) in node.own.clone().enumerate() {
            let mass = (self.mass)(place as usize);
            front.panel[2 * column * (rows + 1)] = mass;
            front.panel[(2 * column + 1) * (rows + 1)] = mass;
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
struct Assembly<'m> {
    panel: &'m mut [f64],
    rest: &'m mut [f64],
    own: usize,
    rows: usize,
}

impl Assembly<'_> {
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
    fn add(&mut self, join: &Join, coupling: &Coupling) {
        let [i, j] = join.ends.map(|index| 2 * index as usize);
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
    fn add_block(&mut self, row: usize, column: usize, block: &Matrix2<f64>) {
        for (k, entries) in [(0, [block.m11, block.m21]), (1, [block.m12, block.m22])] {
            let column = self.column(column + k, row);
            column[0] += entries[0];
            column[1] += entries[1];
        }
    }

    /// Adds what a child left, whose rows have these indices.
    #[inline]
    fn extend_add(&mut self, left: &[f64], rows: &[u32]) {
        let stride = 2 * rows.len();
        for (k, index) in rows.iter().enumerate() {
            let top = 2 * *index as usize;
            for c in 0..2 {
                let column = self.column(top + c, top);
                let left = &left[(2 * k + c) * stride + 2 * k..(2 * k + c + 1) * stride];
                for (row, left) in rows[k..].iter().zip(left.chunks_exact(2)) {
                    let at = 2 * *row as usize - top;
                    column[at] += left[0];
                    column[at + 1] += left[1];
                }
            }
        }
    }
}

impl Factor {
    /// Factorises K, with the `mass` of the grain at each place and what each `coupling` adds, if it does; the lower triangle
    /// counts.
    ///
    /// # Errors
    /// Where it is not positive definite in double precision.
    pub fn new(
        structure: Arc<Structure>,
        mass: impl Fn(usize) -> f64 + Sync,
        coupling: impl Fn(usize) -> Option<Coupling> + Sync,
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
        mass: impl Fn(usize) -> f64 + Sync,
        coupling: impl Fn(usize) -> Option<Coupling> + Sync,
    ) -> Result<(), Singular> {
        let structure = &*self.structure;
        let matrix = Matrix { structure, mass, coupling };
        let done = matrix.subtrees(structure.roots(), &mut self.values).is_some();
        if done {
            Ok(())
        } else {
            Err(Singular("it is not positive definite in double precision".to_owned()))
        }
    }

    /// x ← (P K Pᵗ)⁻¹ x, for one x per place.
    pub fn solve(&self, x: &mut [Vector2<f64>]) {
        Arch::new().dispatch(|| solve(&self.structure, &self.values, x));
    }

    /// What it owes to the coupled grains alone.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// See [`Structure::entries`].
    pub fn entries(&self) -> usize {
        self.structure.entries()
    }
}
