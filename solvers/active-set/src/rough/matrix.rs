//! K = 1 + κ Σ push pullᵗ of the contacts that are held, in 3×3 blocks of grains: it has factors, and after single contacts changed
//! their status solves with the factors that it had and what changed.

use super::layout::{Status, against};
use cholesky::{Lu, OneWay, Order, Structure};
use contact::{Column, RoughColumn, SetupError, Work};
use nalgebra::{DMatrix, DVector, Dyn, LU, Matrix3x2, Vector2, Vector3};
use std::sync::Arc;

/// K, of which the structure never changes.
pub(super) struct Matrix {
    structure: Arc<Structure<3>>,
    factors: Lu<3>,
    is_factorised: bool,
    changes: Changes,
    /// Statuses and κ (–) of the matrix.
    status: Vec<Status>,
    kappa: f64,
    work: Work,
}

/// Changes since the factor was made: K is the factor's matrix and κ Σ push pullᵗ of these.
#[derive(Default)]
struct Changes {
    /// By contact, the parts along normal and tangent of what pushes and what pulls.
    of: Vec<(usize, Vector2<f64>, Vector2<f64>)>,
    /// κ K₀⁻¹ push of each.
    solved: Vec<Vec<Vector3<f64>>>,
    /// 1 + pullᵗ κ K₀⁻¹ push.
    small: Option<LU<f64, Dyn, Dyn>>,
}

impl Matrix {
    /// Lays the matrix of so many grains out.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(super) fn new(columns: &[RoughColumn], grains: usize) -> Result<Self, SetupError> {
        let ends: Vec<_> =
            columns.iter().map(RoughColumn::places).map(|[i, j]| (i, (j != i).then_some(j))).collect();
        let order = Order::minimum_degree(grains, &ends)?;
        let structure = Structure::new(&ends, &order)?;
        Ok(Self {
            factors: Lu::new(Arc::clone(&structure))?,
            structure,
            is_factorised: false,
            changes: Changes::default(),
            status: Vec::new(),
            kappa: 0.0,
            work: Work::default(),
        })
    }

    /// Reports whether it solves with the matrix of these statuses and κ (–).
    pub(super) fn is_of(&self, status: &[Status], kappa: f64) -> bool {
        self.is_factorised && self.kappa == kappa && self.status == status
    }

    /// Changes since the factor was made.
    pub(super) fn changes(&self) -> usize {
        self.changes.of.len()
    }

    /// Factorises the matrix of these statuses with the weight κ (–) and reports whether it has a factor.
    pub(super) fn factorise(&mut self, columns: &[RoughColumn], status: &[Status], kappa: f64) -> bool {
        self.changes = Changes::default();
        self.kappa = kappa;
        self.status.clear();
        self.status.extend_from_slice(status);
        let coupling = |contact: usize| {
            let (ends, friction) = (columns[contact].at_ends(), columns[contact].friction());
            match status[contact] {
                Status::Open => None,
                Status::Stick => {
                    let both = ends.map(|end| Matrix3x2::from_columns(&end));
                    Some(OneWay::product(both.map(|end| kappa * end), both))
                }
                Status::Slide(sign) => {
                    let edge = ends.map(|[n, t]| kappa * n + kappa * (sign * friction) * t);
                    Some(OneWay::product(edge, ends.map(|[n, _]| n)))
                }
            }
        };
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += 2 * self.structure.work();
        self.is_factorised = self.factors.renew(|_| Vector3::repeat(1.0), coupling).is_ok();
        self.is_factorised
    }

    /// Gives a contact another status; says whether K then has an inverse. If not, it is the matrix of none.
    pub(super) fn change(&mut self, columns: &[RoughColumn], contact: usize, now: Status) -> bool {
        let before = std::mem::replace(&mut self.status[contact], now);
        self.is_factorised = parts(before, now, columns[contact].friction())
            .is_some_and(|parts| self.add(columns, contact, parts));
        self.is_factorised
    }

    /// Adds κ push pullᵗ of a contact, given by their parts along its normal and its tangent; says whether K then has an inverse.
    fn add(&mut self, columns: &[RoughColumn], contact: usize, [push, pull]: [Vector2<f64>; 2]) -> bool {
        let mut solved = vec![Vector3::zeros(); self.structure.position().len()];
        columns[contact].push(self.kappa * push, &mut solved);
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

    /// Adds to the impulses s what stops the velocities v of the contacts that are held (√J):
    ///
    /// K δy = −κ Σ push v_pull,   δs = −κ (v + pullᵗ δy),   K = 1 + κ Σ push pullᵗ
    ///
    /// with `push` the column, or columns, that the impulses of a contact act by, and `pull` those that must not move: a sliding contact
    /// pushes by `h_n` ± μ `h_t` and pulls by `h_n` alone.
    pub(super) fn stop(&mut self, columns: &[RoughColumn], v: &[Vector2<f64>], s: &mut [Vector2<f64>]) {
        let mut change = vec![Vector3::zeros(); self.structure.position().len()];
        for ((column, status), v) in columns.iter().zip(&self.status).zip(v) {
            if let Some(push) = against(*status, column, *v) {
                column.push(-self.kappa * push, &mut change);
            }
        }
        self.solve(columns, &mut change);
        for (((column, status), v), s) in columns.iter().zip(&self.status).zip(v).zip(s) {
            if let Some(push) = against(*status, column, v + column.relative(&change)) {
                *s -= self.kappa * push;
            }
        }
    }

    /// x ← K⁻¹ x.
    pub(super) fn solve(&mut self, columns: &[RoughColumn], x: &mut [Vector3<f64>]) {
        self.solve_with_factor(x);
        let Changes { of, solved, small } = &self.changes;
        let Some(small) = small else { return };
        let pulled = of.iter().map(|(contact, _, pull)| pull.dot(&columns[*contact].relative(x)));
        let mut weights = DVector::from_iterator(of.len(), pulled);
        if small.solve_mut(&mut weights) {
            for (weight, solved) in weights.iter().zip(solved) {
                x.iter_mut().zip(solved).for_each(|(x, solved)| *x -= *weight * solved);
            }
        }
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        self.work
    }

    fn solve_with_factor(&mut self, x: &mut [Vector3<f64>]) {
        let mut placed = vec![Vector3::zeros(); x.len()];
        self.work.triangular_solve_entries += self.factors.entries() as u64;
        let position = self.structure.position();
        position.iter().zip(&*x).for_each(|(place, x)| placed[*place as usize] = *x);
        self.factors.solve(&mut placed);
        x.iter_mut().zip(position).for_each(|(x, place)| *x = placed[*place as usize]);
    }
}

/// push and pull of the product that K gains with a change of status, by their parts along normal and tangent: none where it has no
/// such form.
fn parts(before: Status, now: Status, friction: f64) -> Option<[Vector2<f64>; 2]> {
    let edge = |sign: f64| Vector2::new(1.0, sign * friction);
    let slipping = |sign: f64| Vector2::new(sign * friction, -1.0);
    match (before, now) {
        (Status::Stick, Status::Slide(sign)) => Some([Vector2::y(), slipping(sign)]),
        (Status::Slide(sign), Status::Stick) => Some([Vector2::y(), -slipping(sign)]),
        (Status::Open, Status::Slide(sign)) => Some([edge(sign), Vector2::x()]),
        (Status::Slide(sign), Status::Open) => Some([edge(sign), -Vector2::x()]),
        _ => None,
    }
}
