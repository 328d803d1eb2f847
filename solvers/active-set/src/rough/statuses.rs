//! Newton's method on the statuses of contacts with friction: which are open, stick, or slide to which side.

use super::terms_of_b;
use contact::law::{clip, non_negative};
use contact::scaled::scaled_velocity;
use contact::{Column, Mass, Packing, RoughColumn, RoughDiscs, SetupError, Touch, Vector, Work};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use nalgebra::{Matrix3, Vector2, Vector3};

/// κ, the weight of the contacts against the masses (–): what sticks more than motion allows keeps its impulses but for 1/κ.
const PENALTY: f64 = 1e6;

/// Solves with one factor, at most: each makes good what 1/κ left of the one before.
const SOLVES: u32 = 6;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.1;

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// What a contact does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Status {
    Open,
    Stick,
    /// To the side where the tangential impulse has this sign.
    Slide(f64),
}

/// Statuses, and the impulses that go with them; all in mass-scaled unknowns.
pub(crate) struct Statuses {
    columns: Vec<RoughColumn>,
    unit: Vec<Vector2<f64>>,
    /// c/√`W_αα` (√J).
    offset: Vec<Vector2<f64>>,
    /// M^½ `V_free` (√J).
    free: Vec<Vector3<f64>>,
    /// See [`terms_of_b`] (√J).
    terms_of_b: f64,
    status: Vec<Status>,
    s: Vec<Vector2<f64>>,
    v: Vec<Vector2<f64>>,
    y: Vec<Vector3<f64>>,
    matrix: Matrix,
    work: Work,
}

/// K = 1 + κ Σ push pullᵗ, 3×3 blocks of grains, of which the pattern never changes.
struct Matrix {
    pattern: SymbolicSparseColMat<usize>,
    places: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
    values: Vec<f64>,
    factor: Option<Lu<usize, f64>>,
}

impl Statuses {
    /// Lays the problem out, with r = 0.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(crate) fn new(problem: &Packing<RoughDiscs>) -> Result<Self, SetupError> {
        let inverse_mass = |grain: u32| Mass::<Vector3<f64>>::inverse(problem.mass()[grain as usize], 1.0);
        let column = |contact| RoughColumn::new(contact, contact.ends(), inverse_mass, true);
        let (columns, unit): (Vec<_>, Vec<_>) = problem.contacts().iter().map(column).unzip();
        let offset = problem
            .contacts()
            .iter()
            .zip(&unit)
            .map(|(at, unit)| at.offset.component_div(unit))
            .collect::<Vec<_>>();
        let free = scaled_velocity(problem, &vec![0.0; problem.impulse_count()]);
        let terms_of_b = terms_of_b(&columns, &offset, &free);
        let none = vec![Vector2::zeros(); columns.len()];
        let mut statuses = Self {
            matrix: Matrix::new(&columns, free.len())?,
            status: vec![Status::Open; columns.len()],
            s: none.clone(),
            v: none,
            y: free.clone(),
            terms_of_b,
            columns,
            unit,
            offset,
            free,
            work: Work::default(),
        };
        statuses.measure();
        Ok(statuses)
    }

    /// Takes the impulses `r` (N·s).
    pub(crate) fn begin(&mut self, r: &[f64]) {
        for (k, (s, unit)) in self.s.iter_mut().zip(&self.unit).enumerate() {
            *s = Vector2::at(r, k).component_mul(unit);
        }
        self.measure();
    }

    /// The nearest impulses that the law admits, in the problem's order (N·s).
    pub(crate) fn impulses(&self, r: &mut [f64]) {
        for (k, ((s, unit), column)) in self.s.iter().zip(&self.unit).zip(&self.columns).enumerate() {
            admissible(*s, column.friction()).component_div(unit).put(r, k);
        }
    }

    /// What is left of the law, weighed as energy: the natural map (√J).
    pub(crate) fn left(&self) -> f64 {
        let of = |((s, v), column): ((&Vector2<f64>, &Vector2<f64>), &RoughColumn)| {
            let bound = column.friction() * non_negative(s.x);
            let normal = if v.x >= s.x { s.x } else { v.x };
            let tangential = s.y - clip(s.y - v.y, bound);
            normal * normal + tangential * tangential
        };
        self.s.iter().zip(&self.v).zip(&self.columns).map(of).sum::<f64>().sqrt()
    }

    /// Whether what is left of the law is round-off.
    pub(crate) fn is_solved(&self) -> bool {
        let of_s = self.s.iter().map(Vector2::norm_squared).sum::<f64>().sqrt();
        self.left() <= ROUND_OFF * (of_s + self.terms_of_b)
    }

    /// Work so far.
    pub(crate) fn work(&self) -> Work {
        self.work
    }

    /// The statuses that s − v has.
    fn statuses(&self) -> Vec<Status> {
        let status = |((s, v), column): ((&Vector2<f64>, &Vector2<f64>), &RoughColumn)| {
            let moved = s - v;
            let bound = column.friction() * moved.x;
            if moved.x <= 0.0 {
                Status::Open
            } else if moved.y >= bound {
                Status::Slide(1.0)
            } else if moved.y <= -bound {
                Status::Slide(-1.0)
            } else {
                Status::Stick
            }
        };
        self.s.iter().zip(&self.v).zip(&self.columns).map(status).collect()
    }

    /// One step of Newton: the statuses of s − v, and the impulses for which they hold. With `push` the column, or columns, that the
    /// impulses of a contact act by, and `pull` those that must not move,
    ///
    /// K δy = −κ Σ push v_pull,   δs = −κ (v + pullᵗ δy),   K = 1 + κ Σ push pullᵗ
    ///
    /// where a sliding contact pushes by `h_n` ± μ `h_t` and pulls by `h_n` alone. v comes from s each time, so that no error of K
    /// stays. Returns how many contacts changed, `None` if the matrix has no factor.
    pub(crate) fn step(&mut self) -> Option<usize> {
        let now = self.statuses();
        let changed = now.iter().zip(&self.status).filter(|(now, before)| now != before).count();
        self.status = now;
        if changed > 0 || self.matrix.factor.is_none() {
            self.work.factorisations += 1;
            if !self.matrix.factorise(&self.columns, &self.status) {
                return None;
            }
        }
        self.project();
        let mut left = self.unheld();
        for _ in 0..SOLVES {
            self.solve();
            let before = std::mem::replace(&mut left, self.unheld());
            if !(left < WORTH_ANOTHER * before) {
                break;
            }
        }
        Some(changed)
    }

    /// Impulses that have their statuses.
    fn project(&mut self) {
        for ((s, status), column) in self.s.iter_mut().zip(&self.status).zip(&self.columns) {
            *s = match status {
                Status::Open => Vector2::zeros(),
                Status::Stick => *s,
                Status::Slide(sign) => Vector2::new(s.x, sign * column.friction() * s.x),
            };
        }
        self.measure();
    }

    /// What moves of that which must not (√J).
    fn unheld(&self) -> f64 {
        let of = |(v, status): (&Vector2<f64>, &Status)| match status {
            Status::Open => 0.0,
            Status::Stick => v.norm_squared(),
            Status::Slide(_) => v.x * v.x,
        };
        self.v.iter().zip(&self.status).map(of).sum::<f64>().sqrt()
    }

    fn solve(&mut self) {
        let mut right_hand_side = vec![Vector3::zeros(); self.y.len()];
        for ((column, status), v) in self.columns.iter().zip(&self.status).zip(&self.v) {
            if let Some(push) = pushed(*status, column, *v) {
                column.push(-PENALTY * push, &mut right_hand_side);
            }
        }
        self.matrix.solve(&mut right_hand_side);
        let change = right_hand_side;
        for (((column, status), v), s) in self.columns.iter().zip(&self.status).zip(&self.v).zip(&mut self.s)
        {
            if let Some(push) = pushed(*status, column, v + column.relative(&change)) {
                *s -= PENALTY * push;
            }
        }
        self.measure();
    }

    /// y and v of s.
    fn measure(&mut self) {
        self.y.copy_from_slice(&self.free);
        for (column, s) in self.columns.iter().zip(&self.s) {
            column.push(*s, &mut self.y);
        }
        for ((column, v), c) in self.columns.iter().zip(&mut self.v).zip(&self.offset) {
            *v = column.relative(&self.y) + c;
        }
    }
}

/// The impulse that acts against a relative velocity v: along the boundary of the cone where the contact slides, none where it is
/// open.
fn pushed(status: Status, column: &RoughColumn, v: Vector2<f64>) -> Option<Vector2<f64>> {
    match status {
        Status::Open => None,
        Status::Stick => Some(v),
        Status::Slide(sign) => Some(Vector2::new(v.x, sign * column.friction() * v.x)),
    }
}

fn admissible(s: Vector2<f64>, friction: f64) -> Vector2<f64> {
    let normal = non_negative(s.x);
    Vector2::new(normal, clip(s.y, friction * normal))
}

impl Matrix {
    fn new(columns: &[RoughColumn], grains: usize) -> Result<Self, SetupError> {
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
        Ok(Self { pattern, places, symbolic, values: vec![0.0; count], factor: None })
    }

    /// Whether the matrix of these statuses has a factor.
    fn factorise(&mut self, columns: &[RoughColumn], status: &[Status]) -> bool {
        self.values.clear();
        self.values.resize(self.pattern.ncols(), 1.0);
        for (column, status) in columns.iter().zip(status) {
            let ends = column.at_ends();
            let outer = |push: &Vector3<f64>, pull: &Vector3<f64>| PENALTY * push * pull.transpose();
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
        self.factor.is_some()
    }

    /// x ← K⁻¹ x.
    fn solve(&self, x: &mut [Vector3<f64>]) {
        let Some(factor) = &self.factor else { return };
        let mut all = faer::Col::from_fn(3 * x.len(), |k| x[k / 3][k % 3]);
        factor.solve_in_place(all.as_mut());
        x.iter_mut()
            .enumerate()
            .for_each(|(k, x)| *x = Vector3::new(all[3 * k], all[3 * k + 1], all[3 * k + 2]));
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
