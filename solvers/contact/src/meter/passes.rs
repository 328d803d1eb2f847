//! The two passes over a problem that its measures are made of: v − b = W r, through the velocities of the grains.
//!
//! Impulses are added up at each grain in the order of the list, whether contacts push one after the other or, in threads, each
//! grain gathers its own. So the operations and their order are the same on any machine with any number of threads, and a contact
//! that is looked at alone has the very bits that it has among all.

use super::sums::{Known, Lanes, Sums, TILE};
use crate::adjacency::Adjacency;
use crate::discs::Smooth;
use crate::problem::ContactProblem;
use nalgebra::SVector;

/// Constants of the problem's contacts.
pub(super) struct Columns<const D: usize> {
    adjacency: Adjacency,
    /// n (–).
    normal: Vec<SVector<f64, D>>,
    /// Candidate and antagonist. A wall is behind all grains.
    ends: Vec<[u32; 2]>,
    /// Without contact impulses (m/s).
    b: Vec<f64>,
    /// `W_αα` (1/kg).
    delassus: Vec<f64>,
    /// 1/`W_αα` (kg).
    inverse: Vec<f64>,
    /// 1/m of each grain (1/kg); 0 of the wall.
    inverse_mass: Vec<f64>,
}

impl<const D: usize> Columns<D> {
    pub(super) fn new(problem: &ContactProblem<Smooth<D>>) -> Self {
        let wall = problem.grain_count() as u32;
        let delassus = problem.delassus_diagonal();
        let contacts = problem.contacts();
        Self {
            adjacency: Adjacency::of(problem),
            normal: contacts.iter().map(|contact| contact.normal).collect(),
            ends: contacts.iter().map(|at| [at.candidate, at.antagonist.unwrap_or(wall)]).collect(),
            b: problem.b(),
            inverse: delassus.iter().map(|w| 1.0 / w).collect(),
            delassus,
            inverse_mass: problem.mass().iter().map(|mass| 1.0 / mass).chain([0.0]).collect(),
        }
    }

    /// √(Σ b²/`W_αα`) (√J).
    pub(super) fn size_of_b(&self) -> f64 {
        self.b.iter().zip(&self.inverse).map(|(b, inverse)| b * b * inverse).sum::<f64>().sqrt()
    }

    /// The greatest `W_αα` (1/kg).
    pub(super) fn greatest_delassus(&self) -> f64 {
        self.delassus.iter().copied().fold(0.0, f64::max)
    }

    /// V − `V_free` = M⁻¹ H r of all grains and the wall (m/s).
    #[inline(always)]
    pub(super) fn push(&self, r: &[f64], pushed: &mut [SVector<f64, D>]) {
        pushed.fill(SVector::zeros());
        for ((normal, [i, j]), r) in self.normal.iter().zip(&self.ends).zip(r) {
            let impulse = normal * *r;
            pushed[*i as usize] += impulse;
            pushed[*j as usize] -= impulse;
        }
        // A wall never moves, whatever is too much for a number.
        pushed[self.adjacency.grain_count()] = SVector::zeros();
        pushed.iter_mut().zip(&self.inverse_mass).for_each(|(pushed, inverse)| *pushed *= *inverse);
    }

    /// Returns the velocity change of one grain, or of the wall, under the impulses `r`.
    pub(super) fn gather(&self, grain: usize, r: &[f64]) -> SVector<f64, D> {
        let mut resultant = SVector::zeros();
        if grain < self.adjacency.grain_count() {
            for contact in self.adjacency.around(grain) {
                let contact = *contact as usize;
                let impulse = self.normal[contact] * r[contact];
                resultant += if self.ends[contact][0] as usize == grain { impulse } else { -impulse };
            }
        }
        resultant * self.inverse_mass[grain]
    }

    /// v of a contact whose grains are looked at alone (m/s).
    pub(super) fn alone(&self, contact: usize, r: &[f64]) -> f64 {
        let [i, j] = self.ends[contact].map(|grain| self.gather(grain as usize, r));
        relative(self.normal[contact], i, j, self.b[contact])
    }

    /// `W_αα` (1/kg) and its inverse (kg).
    pub(super) fn diagonal(&self, contact: usize) -> (f64, f64) {
        (self.delassus[contact], self.inverse[contact])
    }

    /// Sums over the contacts from `first` on, as many as there are impulses `r`, with `before`, those of the iterate before,
    /// which may be empty. Only the natural map, if `alone`.
    #[inline(always)]
    pub(super) fn sums(
        &self,
        first: usize,
        (before, r): (&[f64], &[f64]),
        pushed: &[SVector<f64, D>],
        alone: bool,
    ) -> Sums {
        let mut lanes = Lanes::default();
        let mut v = [0.0; TILE];
        for start in (0..r.len()).step_by(TILE) {
            let tile = start..r.len().min(start + TILE);
            let here = first + tile.start..first + tile.end;
            let known = Known {
                delassus: &self.delassus[here.clone()],
                inverse: &self.inverse[here.clone()],
                b: &self.b[here.clone()],
            };
            let (r, v) = (&r[tile.clone()], &mut v[..tile.len()]);
            let contacts = self.normal[here.clone()].iter().zip(&self.ends[here]).zip(known.b);
            for (v, ((normal, [i, j]), b)) in v.iter_mut().zip(contacts) {
                *v = relative(*normal, pushed[*i as usize], pushed[*j as usize], *b);
            }
            lanes.natural_map(r, v, &known);
            if !alone {
                lanes.others(r, v, &known);
                lanes.rate(v, tile.start);
                if !before.is_empty() {
                    lanes.change(&before[tile], r);
                }
            }
        }
        lanes.sums()
    }
}

/// v = n · (ΔV_i − ΔV_j) + b, eq. (1), with what the impulses add to the velocities of the two grains (m/s).
#[inline(always)]
fn relative<const D: usize>(normal: SVector<f64, D>, i: SVector<f64, D>, j: SVector<f64, D>, b: f64) -> f64 {
    normal.dot(&(i - j)) + b
}
