//! The problem, its products and its natural map.

use contact::law::{self, tangential};
use contact::{ProblemError, Vector, is_not_negative, ratio};
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;

/// Contacts with 1, 2 or 3 unknowns each, the normal one first: of relative velocity v = W r + q (m/s) and of impulse r (N·s).
#[derive(Clone, Debug, PartialEq)]
pub struct LocalProblem {
    dimension: usize,
    /// The blocks of contact α are those from `start[α]` to `start[α + 1]`, by their columns.
    start: Vec<usize>,
    column: Vec<u32>,
    /// Column by column, `dimension`² numbers a block (1/kg).
    blocks: Vec<f64>,
    /// Which block is `W_αα`.
    diagonal: Vec<usize>,
    q: Vec<f64>,
    friction: Vec<f64>,
}

impl LocalProblem {
    /// A problem of entries (row, column, value) of W (1/kg), of which those of one place are added up; of q (m/s); and of μ (–), whose
    /// length is the number of contacts.
    ///
    /// # Errors
    /// Names what is wrong after the datasets of FCLIB: `W`, `vectors/q`, `vectors/mu`.
    ///
    /// # Panics
    /// Unless there are 1 to 3 unknowns a contact.
    pub fn new(
        dimension: usize,
        entries: impl IntoIterator<Item = (usize, usize, f64)>,
        q: Vec<f64>,
        friction: Vec<f64>,
    ) -> Result<Self, ProblemError> {
        assert!((1..=3).contains(&dimension), "a contact has one, two or three unknowns");
        let contacts = friction.len();
        ProblemError::unless_length("vectors/q", &q, dimension * contacts)?;
        ProblemError::unless_each("vectors/q", &q, "finite", |q| q.is_finite())?;
        ProblemError::unless_each("vectors/mu", &friction, "finite and not negative", |mu| {
            is_not_negative(*mu)
        })?;
        let mut all: BTreeMap<(usize, usize), [f64; 9]> = BTreeMap::new();
        for (index, (row, column, value)) in entries.into_iter().enumerate() {
            let fault =
                |value: String, expected: String| ProblemError::Value { key: "W", index, value, expected };
            if row.max(column) >= q.len() {
                return Err(fault(
                    format!("in row {row}, column {column}"),
                    format!("of {0} × {0} entries", q.len()),
                ));
            }
            if !value.is_finite() {
                return Err(fault(format!("{value:?}"), "finite".to_owned()));
            }
            let block = all.entry((row / dimension, column / dimension)).or_default();
            block[row % dimension + dimension * (column % dimension)] += value;
        }
        let mut problem = Self {
            dimension,
            start: vec![0],
            column: Vec::with_capacity(all.len()),
            blocks: Vec::with_capacity(all.len() * dimension * dimension),
            diagonal: Vec::with_capacity(contacts),
            q,
            friction,
        };
        for ((row, column), block) in all {
            problem.start.resize(row + 1, problem.column.len());
            if row == column {
                problem.diagonal.push(problem.column.len());
            }
            problem.column.push(column as u32);
            problem.blocks.extend(&block[..dimension * dimension]);
        }
        problem.start.resize(contacts + 1, problem.column.len());
        problem.check_diagonal()?;
        Ok(problem)
    }

    /// Accepts a W whose `W_αα` are there and positive definite.
    fn check_diagonal(&self) -> Result<(), ProblemError> {
        for contact in 0..self.contact_count() {
            let is_there = self.diagonal.get(contact).is_some_and(|at| self.column[*at] as usize == contact);
            let value = if !is_there {
                "missing".to_owned()
            } else if !self.is_definite(contact) {
                format!("{:?}", self.block(self.diagonal[contact]))
            } else {
                continue;
            };
            let expected = "a block of a contact with itself, positive definite".to_owned();
            return Err(ProblemError::Value { key: "W", index: contact, value, expected });
        }
        Ok(())
    }

    /// Reports whether the symmetric part of `W_αα` has positive pivots.
    fn is_definite(&self, contact: usize) -> bool {
        match self.dimension {
            1 => self.own::<1>(contact)[0] > 0.0,
            2 => definite(self.own::<2>(contact)),
            _ => definite(self.own::<3>(contact)),
        }
    }

    /// Unknowns of a contact.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns the number of contacts.
    pub fn contact_count(&self) -> usize {
        self.friction.len()
    }

    /// The diagonal of W (1/kg), one number for each unknown.
    pub fn diagonal(&self) -> Vec<f64> {
        let d = self.dimension;
        let own = |at: usize| (0..d).map(move |k| self.block(at)[k + d * k]);
        self.diagonal.iter().copied().flat_map(own).collect()
    }

    /// q: the relative velocities without contact impulses (m/s).
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// μ of each contact (–).
    pub fn friction(&self) -> &[f64] {
        &self.friction
    }

    /// The entries of all blocks of W by their places, row by row, zeros within a block included: row, column, value (1/kg).
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let d = self.dimension;
        (0..self.q.len()).flat_map(move |row| {
            self.blocks_of(row / d).flat_map(move |at| {
                let first = d * self.column[at] as usize;
                (0..d).map(move |k| (row, first + k, self.block(at)[row % d + d * k]))
            })
        })
    }

    /// The contacts that W couples with one, itself among them.
    pub(crate) fn neighbours(&self, contact: usize) -> &[u32] {
        &self.column[self.blocks_of(contact)]
    }

    fn blocks_of(&self, contact: usize) -> std::ops::Range<usize> {
        self.start[contact]..self.start[contact + 1]
    }

    pub(crate) fn block(&self, at: usize) -> &[f64] {
        let size = self.dimension * self.dimension;
        &self.blocks[size * at..size * (at + 1)]
    }

    /// All blocks (1/kg).
    #[inline]
    fn matrices<const D: usize>(&self) -> &[SMatrix<f64, D, D>] {
        bytemuck::cast_slice(&self.blocks)
    }

    /// `W_αα` (1/kg).
    #[inline]
    pub(crate) fn own<const D: usize>(&self, contact: usize) -> &SMatrix<f64, D, D> {
        &self.matrices()[self.diagonal[contact]]
    }

    /// The blocks `W_αβ` of a contact (1/kg), with β.
    #[inline]
    pub(crate) fn row<const D: usize>(
        &self,
        contact: usize,
    ) -> impl Iterator<Item = (&SMatrix<f64, D, D>, usize)> {
        let all = self.blocks_of(contact);
        let columns = self.column[all.clone()].iter().map(|column| *column as usize);
        self.matrices()[all].iter().zip(columns)
    }

    /// (W r)_α (m/s), where `r` gives the impulse of each contact (N·s).
    pub(crate) fn product_at<const D: usize>(
        &self,
        contact: usize,
        r: impl Fn(usize) -> SVector<f64, D>,
    ) -> SVector<f64, D> {
        self.row::<D>(contact).map(|(w, other)| w * r(other)).sum()
    }

    /// v = W r + q (m/s), normal first at each contact, of the impulses `r` (N·s).
    pub fn velocity(&self, r: &[f64]) -> Vec<f64> {
        let mut v = self.delassus_product(r);
        v.iter_mut().zip(&self.q).for_each(|(v, q)| *v += q);
        v
    }

    /// W r (m/s), normal first at each contact, of the impulses `r` (N·s).
    pub fn delassus_product(&self, r: &[f64]) -> Vec<f64> {
        match self.dimension {
            1 => self.product_of::<1>(r),
            2 => self.product_of::<2>(r),
            _ => self.product_of::<3>(r),
        }
    }

    fn product_of<const D: usize>(&self, r: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; r.len()];
        for contact in 0..self.contact_count() {
            self.product_at::<D>(contact, |other| SVector::at(r, other)).put(&mut product, contact);
        }
        product
    }

    /// `w_n` = `W_nn` and `w_t` = `λ_max(W_TT)` of a contact, one for each unknown (1/kg): what its impulses are weighed by.
    pub(crate) fn weight<const D: usize>(&self, contact: usize) -> SVector<f64, D> {
        let w = self.own::<D>(contact);
        SVector::from_fn(|k, _| if k == 0 { w[(0, 0)] } else { greatest_tangential(w) })
    }

    /// Σ max(0, −`q_n`)²/`w_n` (J): what the law makes of r = 0.
    pub fn scale(&self) -> f64 {
        let of = |contact: usize| {
            let q_n = law::non_negative(-self.q[self.dimension * contact]);
            q_n * q_n / self.block(self.diagonal[contact])[0]
        };
        (0..self.contact_count()).map(of).sum()
    }

    /// √( Σ w (r − r⁺)² / Σ max(0, −`q_n`)²/`w_n` ) (–), which is 0 exactly at a solution: with `r_n⁺` = max(0, `r_n` − `v_n`/`w_n`) and `r_t⁺`
    /// the nearest to `r_t` − `v_t`/`w_t` of size μ `r_n` at most, `w_n` = `W_nn` and `w_t` = `λ_max(W_TT)` of the contact. Where `W_αα` is diagonal it
    /// is the measure of the problems with grains.
    pub fn natural_map(&self, r: &[f64]) -> f64 {
        ratio(self.left(r, &self.velocity(r)), self.scale().sqrt())
    }

    /// √(Σ w (r − r⁺)²) (√J) of the impulses `r` (N·s), whose velocity is `v` (m/s).
    pub fn left(&self, r: &[f64], v: &[f64]) -> f64 {
        let left = match self.dimension {
            1 => self.left_of::<1>(r, v),
            2 => self.left_of::<2>(r, v),
            _ => self.left_of::<3>(r, v),
        };
        left.sqrt()
    }

    fn left_of<const D: usize>(&self, r: &[f64], v: &[f64]) -> f64 {
        let of = |contact| self.left_at::<D>(contact, &SVector::at(r, contact), &SVector::at(v, contact));
        (0..self.contact_count()).map(of).sum()
    }

    /// w (r − r⁺)² of one contact (J).
    fn left_at<const D: usize>(&self, contact: usize, r: &SVector<f64, D>, v: &SVector<f64, D>) -> f64 {
        let w = self.weight::<D>(contact);
        let normal = r[0] - law::non_negative(r[0] - v[0] / w[0]);
        let (moved, size) = tangential(r - v.component_div(&w));
        let bound = self.friction[contact] * law::non_negative(r[0]);
        let shortened = if size > bound { bound / size } else { 1.0 };
        let along = tangential(*r).0 - moved * shortened;
        w[0] * normal * normal + w[D - 1] * along.norm_squared()
    }

    /// Reports whether the natural map of the impulses `r` (N·s) is above `tolerance` (–): only the first contacts that suffice to tell are
    /// checked.
    pub fn is_above(&self, tolerance: f64, r: &[f64]) -> bool {
        match self.dimension {
            1 => self.is_above_of::<1>(tolerance, r),
            2 => self.is_above_of::<2>(tolerance, r),
            _ => self.is_above_of::<3>(tolerance, r),
        }
    }

    fn is_above_of<const D: usize>(&self, tolerance: f64, r: &[f64]) -> bool {
        // With a margin for the round-off of the sum.
        let (bound, mut left) = (tolerance * tolerance * self.scale() * (1.0 + 1e-9), 0.0);
        (0..self.contact_count()).any(|contact| {
            let product = self.product_at::<D>(contact, |other| SVector::at(r, other));
            let v = product + SVector::at(&self.q, contact);
            left += self.left_at::<D>(contact, &SVector::at(r, contact), &v);
            left > bound
        })
    }
}

/// `λ_max` of the symmetric part of `W_TT`; 1 where there are no tangents.
fn greatest_tangential<const D: usize>(w: &SMatrix<f64, D, D>) -> f64 {
    match D {
        1 => 1.0,
        2 => w[(1, 1)],
        _ => {
            let (half, off) = (0.5 * (w[(1, 1)] - w[(2, 2)]), 0.5 * (w[(1, 2)] + w[(2, 1)]));
            0.5 * (w[(1, 1)] + w[(2, 2)]) + half.hypot(off)
        }
    }
}

fn definite<const D: usize>(w: &SMatrix<f64, D, D>) -> bool {
    // Pivots of Gaussian elimination, which are those of LDLᵗ.
    let mut w = (w + w.transpose()) * 0.5;
    for k in 0..D {
        if !(w[(k, k)] > 0.0) {
            return false;
        }
        for row in k + 1..D {
            let factor = w[(row, k)] / w[(k, k)];
            for column in k..D {
                w[(row, column)] -= factor * w[(k, column)];
            }
        }
    }
    true
}
