//! K = 1 + κ Σ push pullᵗ of the contacts that are held, in 3×3 blocks of grains: it has a factor, and after single contacts changed
//! their status solves with the factor that it had and what changed.

use super::layout::Status;
use contact::{Column, RoughColumn, SetupError};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use nalgebra::{DMatrix, DVector, Dyn, LU, Matrix3, Vector2, Vector3};

/// K, of which the pattern never changes.
pub(super) struct Matrix {
    pattern: SymbolicSparseColMat<usize>,
    places: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
    values: Vec<f64>,
    factor: Option<Lu<usize, f64>>,
    changes: Changes,
    /// What it is the matrix of: the statuses, and κ (–).
    status: Vec<Status>,
    kappa: f64,
}

/// What changed since the factor was made: K is the factor's matrix and κ Σ push pullᵗ of these.
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
        let failed =
            |error: &dyn std::fmt::Debug| SetupError::new("problem", format!("{error:?}"), "smaller");
        let mut places: Vec<Pair<usize, usize>> = (0..3 * grains).map(|k| Pair { row: k, col: k }).collect();
        for column in columns {
            for [row, col] in blocks(column) {
                let of_block = (0..3).flat_map(|c| (0..3).map(move |r| (r, c)));
                places.extend(of_block.map(|(r, c)| Pair { row: 3 * row + r, col: 3 * col + c }));
            }
        }
        let count = places.len();
        let (pattern, places) = SymbolicSparseColMat::try_new_from_indices(3 * grains, 3 * grains, &places)
            .map_err(|error| failed(&error))?;
        let symbolic = SymbolicLu::try_new(pattern.as_ref()).map_err(|error| failed(&error))?;
        let values = vec![0.0; count];
        Ok(Self {
            pattern,
            places,
            symbolic,
            values,
            factor: None,
            changes: Changes::default(),
            status: Vec::new(),
            kappa: 0.0,
        })
    }

    /// Whether it solves with the matrix of these statuses and κ (–).
    pub(super) fn is_of(&self, status: &[Status], kappa: f64) -> bool {
        self.factor.is_some() && self.kappa == kappa && self.status == status
    }

    /// Changes since the factor was made.
    pub(super) fn changes(&self) -> usize {
        self.changes.of.len()
    }

    /// Whether the matrix of these statuses with the weight κ (–) has a factor.
    pub(super) fn factorise(&mut self, columns: &[RoughColumn], status: &[Status], kappa: f64) -> bool {
        self.changes = Changes::default();
        self.values.clear();
        self.values.resize(self.pattern.ncols(), 1.0);
        for (column, status) in columns.iter().zip(status) {
            let ends = column.at_ends();
            let outer = |push: &Vector3<f64>, pull: &Vector3<f64>| kappa * push * pull.transpose();
            for [row, col] in sides(column) {
                let ([n, t], [n_pull, t_pull]) = (ends[row], ends[col]);
                let block = match status {
                    Status::Open => Matrix3::zeros(),
                    Status::Stick => outer(&n, &n_pull) + outer(&t, &t_pull),
                    Status::Slide(sign) => outer(&(n + sign * column.friction() * t), &n_pull),
                };
                self.values.extend_from_slice(block.as_slice());
            }
        }
        let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.places, &self.values);
        let factor = matrix
            .ok()
            .and_then(|matrix| Lu::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref()).ok());
        self.factor = factor;
        self.kappa = kappa;
        self.status.clear();
        self.status.extend_from_slice(status);
        self.factor.is_some()
    }

    /// Gives a contact another status; says whether K then has an inverse.
    pub(super) fn change(&mut self, columns: &[RoughColumn], contact: usize, now: Status) -> bool {
        let before = std::mem::replace(&mut self.status[contact], now);
        let Some([push, pull]) = parts(before, now, columns[contact].friction()) else { return false };
        let mut solved = vec![Vector3::zeros(); self.pattern.ncols() / 3];
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

    /// x ← K⁻¹ x.
    pub(super) fn solve(&self, columns: &[RoughColumn], x: &mut [Vector3<f64>]) {
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

    fn solve_with_factor(&self, x: &mut [Vector3<f64>]) {
        let Some(factor) = &self.factor else { return };
        let mut all = faer::Col::from_fn(3 * x.len(), |k| x[k / 3][k % 3]);
        factor.solve_in_place(all.as_mut());
        x.iter_mut()
            .enumerate()
            .for_each(|(k, x)| *x = Vector3::new(all[3 * k], all[3 * k + 1], all[3 * k + 2]));
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

/// The blocks of a contact, by the side that is pushed and the side that pulls: one at a wall.
fn sides(column: &RoughColumn) -> impl Iterator<Item = [usize; 2]> {
    let [i, j] = column.places();
    let count = if i == j { 1 } else { 2 };
    (0..count).flat_map(move |row| (0..count).map(move |col| [row, col]))
}

/// The same by grains.
fn blocks(column: &RoughColumn) -> impl Iterator<Item = [usize; 2]> {
    let places = column.places();
    sides(column).map(move |[row, col]| [places[row] as usize, places[col] as usize])
}
