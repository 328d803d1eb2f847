//! K = 1 + Σ H̃ P H̃ᵗ of the contacts that are held, in blocks of grains: it has factors, and after single contacts changed their status
//! solves with the factors that it had and what changed.

use crate::layout::{ColumnOf, Layout};
use cholesky::{Lu, OneWay, Order, Structure};
use contact::status::{Slide, Status, unit, wanted};
use contact::{Cone, Frictional, Rough, RoughColumn, SetupError, Visited, Work};
use nalgebra::{DMatrix, DVector, Dyn, LU, SMatrix, SVector, Vector2};
use std::sync::Arc;

/// Share of what a solve had before it that is left after it, at most, or no other follows (–): each makes good what ε or round-off left of
/// the one before.
const WORTH_ANOTHER: f64 = 0.1;

/// K, of which the structure never changes.
pub(super) struct Matrix<const D: usize, const N: usize> {
    structure: Arc<Structure<N>>,
    factors: Lu<N>,
    is_factorised: bool,
    changes: Changes<D, N>,
    /// Statuses and ε (–) of the matrix.
    status: Vec<Status<D>>,
    epsilon: f64,
    work: Work,
}

/// Changes since the factor was made: K is the factor's matrix and Σ push pullᵗ/ε of these.
struct Changes<const D: usize, const N: usize> {
    /// By contact, what pushes and what pulls, as impulses of the contact.
    of: Vec<(usize, SVector<f64, D>, SVector<f64, D>)>,
    /// K₀⁻¹ push/ε of each.
    solved: Vec<Vec<SVector<f64, N>>>,
    /// 1 + pullᵗ K₀⁻¹ push/ε.
    small: Option<LU<f64, Dyn, Dyn>>,
}

impl<const D: usize, const N: usize> Default for Changes<D, N> {
    fn default() -> Self {
        Self { of: Vec::new(), solved: Vec::new(), small: None }
    }
}

impl<const D: usize, const N: usize> Changes<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// x ← K⁻¹ K₀ x.
    fn apply(&self, columns: &[ColumnOf<D>], x: &mut [SVector<f64, N>]) {
        let Some(small) = &self.small else { return };
        let pulled = self.of.iter().map(|(contact, _, pull)| pull.dot(&columns[*contact].relative(x)));
        let mut weights = DVector::from_iterator(self.of.len(), pulled);
        if small.solve_mut(&mut weights) {
            for (weight, solved) in weights.iter().zip(&self.solved) {
                x.iter_mut().zip(solved).for_each(|(x, solved)| *x -= *weight * solved);
            }
        }
    }
}

impl<const D: usize, const N: usize> Matrix<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Prepares the matrix of a packing.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(super) fn new(layout: &Layout<D, N>) -> Result<Self, SetupError> {
        let ends: Vec<_> = layout
            .columns
            .iter()
            .map(ColumnOf::<D>::places)
            .map(|[i, j]| (i, (j != i).then_some(j)))
            .collect();
        let order = Order::minimum_degree(layout.grains(), &ends)?;
        let structure = Structure::new(&ends, &order)?;
        Ok(Self {
            factors: Lu::new(Arc::clone(&structure))?,
            structure,
            is_factorised: false,
            changes: Changes::default(),
            status: Vec::new(),
            epsilon: 0.0,
            work: Work::default(),
        })
    }

    /// Returns the multiply-adds of a factorisation, and the entries of its factors.
    pub(super) fn cost(&self) -> (u64, usize) {
        (2 * self.structure.work(), self.factors.entries())
    }

    /// Reports whether it solves with the matrix of these statuses and ε (–).
    pub(super) fn is_of(&self, status: &[Status<D>], epsilon: f64) -> bool {
        self.is_factorised && self.epsilon == epsilon && self.status == status
    }

    /// Factorises the matrix of these statuses with ε (–) and reports whether it has a factor.
    pub(super) fn factorise(&mut self, columns: &[ColumnOf<D>], status: &[Status<D>], epsilon: f64) -> bool {
        self.changes = Changes::default();
        self.epsilon = epsilon;
        self.status.clear();
        self.status.extend_from_slice(status);
        let coupling = |contact: usize| {
            let column = &columns[contact];
            let weights = status[contact].weights(column.friction(), epsilon)?;
            let of_unknowns: [_; D] = std::array::from_fn(|unknown| column.pushes(unit(unknown)));
            let ends = [0, 1].map(|end| SMatrix::<f64, N, D>::from_columns(&of_unknowns.map(|of| of[end])));
            Some(OneWay::product(ends.map(|end| end * weights), ends))
        };
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += 2 * self.structure.work();
        self.is_factorised = self.factors.renew(|_| SVector::repeat(1.0), coupling).is_ok();
        self.is_factorised
    }

    /// Takes from the impulses s what the velocities v of the contacts call for (√J), to first order and but for ε δs:
    ///
    /// K δy = −Σ H̃ g(v),   δs = −g(v + H̃ᵗ δy),   K = 1 + Σ H̃ P H̃ᵗ,   P = ∂g/∂v
    ///
    /// with g the [answer](Status::answer) of the status of each contact.
    fn correct(&mut self, columns: &[ColumnOf<D>], v: &[SVector<f64, D>], s: &mut [SVector<f64, D>]) {
        let mut change = vec![SVector::zeros(); self.structure.position().len()];
        for (k, column) in columns.iter().enumerate() {
            column.push(-self.answer(columns, k, s[k], v[k]), &mut change);
        }
        self.solve(columns, &mut change);
        for (k, column) in columns.iter().enumerate() {
            s[k] -= self.answer(columns, k, s[k], v[k] + column.relative(&change));
        }
    }

    /// Corrects s while what its `velocity` moves against the statuses falls to less than [`WORTH_ANOTHER`] of it each time, and until
    /// `is_enough` of s, v and what is left (√J). Returns v.
    pub(super) fn settle(
        &mut self,
        columns: &[ColumnOf<D>],
        s: &mut [SVector<f64, D>],
        velocity: impl Fn(&[SVector<f64, D>]) -> Vec<SVector<f64, D>>,
        is_enough: impl Fn(&[SVector<f64, D>], &[SVector<f64, D>], f64) -> bool,
    ) -> Vec<SVector<f64, D>> {
        let mut v = velocity(s);
        let mut left = wanted(&self.status, s, &v);
        let mut before = f64::INFINITY;
        while left < WORTH_ANOTHER * before && !is_enough(s, &v, left) {
            self.correct(columns, &v, s);
            v = velocity(s);
            before = std::mem::replace(&mut left, wanted(&self.status, s, &v));
        }
        v
    }

    /// Returns the answer of a contact.
    fn answer(
        &self,
        columns: &[ColumnOf<D>],
        contact: usize,
        s: SVector<f64, D>,
        v: SVector<f64, D>,
    ) -> SVector<f64, D> {
        self.status[contact].answer(columns[contact].friction(), self.epsilon, s, v)
    }

    /// x ← K⁻¹ x.
    pub(super) fn solve(&mut self, columns: &[ColumnOf<D>], x: &mut [SVector<f64, N>]) {
        self.solve_with_factor(x);
        self.changes.apply(columns, x);
    }

    fn solve_with_factor(&mut self, x: &mut [SVector<f64, N>]) {
        let mut placed = vec![SVector::zeros(); x.len()];
        self.work.triangular_solve_entries += self.factors.entries() as u64;
        let position = self.structure.position();
        position.iter().zip(&*x).for_each(|(place, x)| placed[*place as usize] = *x);
        self.factors.solve(&mut placed);
        x.iter_mut().zip(position).for_each(|(x, place)| *x = placed[*place as usize]);
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        self.work
    }
}

impl Matrix<2, 3> {
    /// Number of changes since the factor was made.
    pub(super) fn changes(&self) -> usize {
        self.changes.of.len()
    }

    /// Gives a contact another status, and takes a response of the impulses ds to that after it, where the contact moved with `v` (√J),
    /// which ε ds is no part of. Returns whether K then has an inverse; if not, this is the matrix of none.
    pub(super) fn change(
        &mut self,
        columns: &[RoughColumn],
        contact: usize,
        now: Status<2>,
        v: Vector2<f64>,
        ds: &mut [Vector2<f64>],
    ) -> bool {
        let before = std::mem::replace(&mut self.status[contact], now);
        let parts = parts(before, now, columns[contact].friction());
        self.is_factorised = parts.is_some_and(|parts| self.add(columns, contact, parts));
        if let Some([push, pull]) = parts.filter(|_| self.is_factorised) {
            // The answers of the contact change by push pullᵗ v/ε, and the grains respond to that.
            let moves = pull.dot(&v);
            let own = self.changes.solved.last();
            let mut y: Vec<_> = own.into_iter().flatten().map(|solved| -moves * solved).collect();
            self.changes.apply(columns, &mut y);
            for (k, column) in columns.iter().enumerate() {
                ds[k] -= self.answer(columns, k, Vector2::zeros(), column.relative(&y));
            }
            ds[contact] -= push * (moves / self.epsilon);
        }
        self.is_factorised
    }

    /// Adds push pullᵗ/ε of a contact, given as impulses of it; says whether K then has an inverse.
    fn add(&mut self, columns: &[RoughColumn], contact: usize, [push, pull]: [Vector2<f64>; 2]) -> bool {
        let mut solved = vec![SVector::zeros(); self.structure.position().len()];
        columns[contact].push(push / self.epsilon, &mut solved);
        self.solve_with_factor(&mut solved);
        let Changes { of, solved: all, small } = &mut self.changes;
        of.push((contact, push, pull));
        all.push(solved);
        let entry = |row: usize, col: usize| {
            let (contact, _, pull) = of[row];
            f64::from(u8::from(row == col)) + pull.dot(&columns[contact].relative(&all[col]))
        };
        let lu = DMatrix::from_fn(of.len(), of.len(), entry).lu();
        let is_regular = lu.is_invertible();
        *small = Some(lu);
        is_regular
    }
}

/// push and pull of the product that K gains with a change of status, by their parts along normal and tangent: none where it has no
/// such form.
fn parts(before: Status<2>, now: Status<2>, friction: f64) -> Option<[Vector2<f64>; 2]> {
    let edge = |slide: Slide<2>| Vector2::new(1.0, slide.along.y * friction);
    let slipping = |slide: Slide<2>| Vector2::new(slide.along.y * friction, -1.0);
    match (before, now) {
        (Status::Stick, Status::Slide(slide)) => Some([Vector2::y(), slipping(slide)]),
        (Status::Slide(slide), Status::Stick) => Some([Vector2::y(), -slipping(slide)]),
        (Status::Open, Status::Slide(slide)) => Some([edge(slide), Vector2::x()]),
        (Status::Slide(slide), Status::Open) => Some([edge(slide), -Vector2::x()]),
        _ => None,
    }
}
