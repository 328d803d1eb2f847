//! Newton's method on the statuses of contacts: open, stick, slide, of the law written as fixed point of r − v/w.
//!
//! P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, Comput. Methods
//! Appl. Mech. Engrg. 92 (1991) 353-375; with the proximal term of R. T. Rockafellar (SIAM J. Control Optim. 14 (1976) 877-898), since W
//! is singular where contacts depend on each other.

use crate::LocalProblem;
use cholesky::General;
use contact::law::{self, tangential};
use contact::{Vector, Work};
use nalgebra::{SMatrix, SVector};

/// ε of the proximal term, over w (–).
const PROXIMAL: f64 = 1e-8;

/// Solves with one factor, at most: each makes good what ε left of the one before.
const SOLVES: u32 = 8;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.5;

/// The share of the terms that make v up which is round-off (–).
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// Status of a contact.
#[derive(Clone, Copy)]
enum Status<const D: usize> {
    Open,
    Stick,
    /// With the tangential impulse along this unit vector, which r − v/w gave; and μ `r_n` over the size that it gave, at most 1.
    Slide(SVector<f64, D>, f64),
}

/// Impulses and their velocities.
pub(crate) struct Newton<'p, const D: usize> {
    problem: &'p LocalProblem,
    weight: Vec<SVector<f64, D>>,
    /// N·s.
    r: Vec<f64>,
    /// m/s.
    v: Vec<f64>,
    work: Work,
}

/// The rows of one contact in the matrix of a step: what multiplies the change of r at other contacts, by their places among those
/// that are not open.
type Rows<const D: usize> = Vec<(usize, SMatrix<f64, D, D>)>;

impl<'p, const D: usize> Newton<'p, D> {
    pub(crate) fn new(problem: &'p LocalProblem) -> Self {
        let weight = (0..problem.contact_count()).map(|contact| problem.weight(contact)).collect();
        let none = vec![0.0; problem.q().len()];
        Self { problem, weight, r: none.clone(), v: none, work: Work::default() }
    }

    /// Takes the impulses `r` (N·s).
    pub(crate) fn begin(&mut self, r: &[f64]) {
        self.r.copy_from_slice(r);
        self.v = self.problem.velocity(&self.r);
    }

    /// The nearest impulses that the law admits (N·s).
    pub(crate) fn impulses(&self, r: &mut [f64]) {
        for (contact, friction) in self.problem.friction().iter().enumerate() {
            let own = SVector::<f64, D>::at(&self.r, contact);
            let (mut along, size) = tangential(own);
            let normal = law::non_negative(own[0]);
            if size > friction * normal {
                along *= friction * normal / size;
            }
            along[0] = normal;
            along.put(r, contact);
        }
    }

    /// Work so far.
    pub(crate) fn work(&self) -> Work {
        self.work
    }

    /// Reports whether the residual `left` of the law (√J) is round-off.
    pub(crate) fn is_round_off(&self, left: f64) -> bool {
        let of = |contact: usize| {
            let mut terms = SVector::<f64, D>::at(self.problem.q(), contact).abs();
            for at in self.problem.blocks_of(contact) {
                let (w, other) = self.problem.entry::<D>(at);
                terms += w.abs() * SVector::<f64, D>::at(&self.r, other).abs();
            }
            terms.component_mul(&terms).component_div(&self.weight[contact]).sum()
        };
        left <= ROUND_OFF * (0..self.weight.len()).map(of).sum::<f64>().sqrt()
    }

    fn status(&self, contact: usize) -> Status<D> {
        let (r, v) = (SVector::<f64, D>::at(&self.r, contact), SVector::<f64, D>::at(&self.v, contact));
        let moved = r - v.component_div(&self.weight[contact]);
        let (along, size) = tangential(moved);
        let friction = self.problem.friction()[contact];
        if moved[0] <= 0.0 {
            Status::Open
        } else if D == 1 || size < friction * moved[0] {
            Status::Stick
        } else if size > 0.0 {
            Status::Slide(along / size, (friction * law::non_negative(r[0]) / size).min(1.0))
        } else {
            // Without friction, and without motion.
            Status::Slide(SVector::zeros(), 0.0)
        }
    }

    /// One step: the statuses of r − v/w, and the impulses for which they hold to first order. Returns whether the matrix had a factor.
    pub(crate) fn step(&mut self) -> bool {
        let contacts = self.problem.contact_count();
        let status: Vec<Status<D>> = (0..contacts).map(|contact| self.status(contact)).collect();
        for (contact, status) in status.iter().enumerate() {
            match status {
                Status::Open => SVector::<f64, D>::zeros().put(&mut self.r, contact),
                Status::Stick => {}
                Status::Slide(out, _) => {
                    let normal = self.r[D * contact];
                    let mut r = out * (self.problem.friction()[contact] * normal);
                    r[0] = normal;
                    r.put(&mut self.r, contact);
                }
            }
        }
        self.v = self.problem.velocity(&self.r);
        let closed: Vec<usize> =
            (0..contacts).filter(|contact| !matches!(status[*contact], Status::Open)).collect();
        let mut place = vec![None; contacts];
        closed.iter().enumerate().for_each(|(k, contact)| place[*contact] = Some(k));
        let rows: Vec<Rows<D>> =
            closed.iter().map(|contact| self.rows(*contact, &status[*contact], &place)).collect();
        let wanted: Vec<_> = closed.iter().map(|contact| self.wanted(*contact, &status[*contact])).collect();
        self.work.factorisations += 1;
        let Some(change) = solved(&rows, &wanted) else { return false };
        for (contact, change) in closed.iter().zip(change) {
            (SVector::at(&self.r, *contact) + change).put(&mut self.r, *contact);
        }
        self.v = self.problem.velocity(&self.r);
        true
    }

    /// Returns the right-hand side of the rows of a contact: −v along what must not move.
    fn wanted(&self, contact: usize, status: &Status<D>) -> SVector<f64, D> {
        let mut wanted = -SVector::<f64, D>::at(&self.v, contact);
        if let Status::Slide(..) = status {
            // Its tangential impulse is what it is to be.
            (1..D).for_each(|k| wanted[k] = 0.0);
        }
        wanted
    }

    /// The rows of a contact: those of W where it must not move. Where it slides, with r⁺ = r − v/w, e = `r_t⁺`/|`r_t⁺`| and
    /// P = 1 − e eᵗ, the first variation of `r_t` = μ `r_n` e times `w_t`:
    ///
    /// `w_t` (δ`r_t` − μ e δ`r_n`) − (μ `r_n`/|`r_t⁺`|) P (`w_t` δ`r_t` − δ`v_t`) = 0
    fn rows(&self, contact: usize, status: &Status<D>, place: &[Option<usize>]) -> Rows<D> {
        let weight = &self.weight[contact];
        let (mut onto, mut own) = (SMatrix::<f64, D, D>::identity(), SMatrix::<f64, D, D>::zeros());
        if let Status::Slide(out, share) = status {
            let across = (SMatrix::identity() - out * out.transpose()) * *share;
            own = SMatrix::identity() - across;
            own.set_column(0, &(-out * self.problem.friction()[contact]));
            own.row_mut(0).fill(0.0);
            own *= weight[D - 1];
            onto = across;
            onto.row_mut(0).fill(0.0);
            onto.column_mut(0).fill(0.0);
            onto[(0, 0)] = 1.0;
        }
        let mut rows = Rows::new();
        for at in self.problem.blocks_of(contact) {
            let (w, other) = self.problem.entry::<D>(at);
            if let Some(place) = place[other] {
                rows.push((place, if other == contact { onto * w + own } else { onto * w }));
            }
        }
        rows
    }
}

/// The solution of a system with these rows, block by block; `None` without a factor.
fn solved<const D: usize>(rows: &[Rows<D>], wanted: &[SVector<f64, D>]) -> Option<Vec<SVector<f64, D>>> {
    let size = D * rows.len();
    let mut entries = Vec::new();
    for (place, row) in rows.iter().enumerate() {
        for (other, block) in row {
            for (k, l) in (0..D).flat_map(|k| (0..D).map(move |l| (k, l))) {
                let proximal = if *other == place && k == l { PROXIMAL * block[(k, k)].abs() } else { 0.0 };
                entries.push((D * place + k, D * other + l, block[(k, l)] + proximal));
            }
        }
    }
    if size == 0 {
        return Some(Vec::new());
    }
    let factor = General::new(size, entries).ok()?;
    let mut change = vec![SVector::<f64, D>::zeros(); rows.len()];
    let mut left = wanted.to_vec();
    for _ in 0..SOLVES {
        let mut x: Vec<f64> = left.iter().flat_map(|left| left.iter().copied()).collect();
        factor.solve(&mut x);
        let step = |k: usize| SVector::<f64, D>::from_fn(|l, _| x[D * k + l]);
        let next: Vec<_> = change.iter().enumerate().map(|(k, change)| change + step(k)).collect();
        let of = |(row, wanted): (&Rows<D>, &SVector<f64, D>)| {
            wanted - row.iter().map(|(other, block)| block * next[*other]).sum::<SVector<f64, D>>()
        };
        let after: Vec<_> = rows.iter().zip(wanted).map(of).collect();
        let size_of = |all: &[SVector<f64, D>]| all.iter().map(SVector::norm_squared).sum::<f64>().sqrt();
        let (before, now) = (size_of(&left), size_of(&after));
        if now < before {
            (change, left) = (next, after);
        }
        if !(now < WORTH_ANOTHER * before) {
            break;
        }
    }
    change.iter().all(|change| change.iter().all(|x| x.is_finite())).then_some(change)
}
