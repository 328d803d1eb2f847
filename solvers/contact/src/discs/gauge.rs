//! The kernel without friction: eight contacts at the same time.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

use super::{Contact, Smooth};
use crate::adjacency::Adjacency;
use crate::mechanics::{Ends, Gauge, Touch};
use crate::sums::{Known, Lanes, Sums, TILE, natural_map, squared};
use nalgebra::SVector;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Constants of the contacts, list by list. Its y is V − `V_free` (m/s), and has a wall behind all grains.
pub struct Plain<const D: usize> {
    adjacency: Adjacency,
    /// n (–).
    normal: Vec<SVector<f64, D>>,
    /// Candidate and antagonist. A wall is behind all grains.
    ends: Vec<[u32; 2]>,
    /// v without contact impulses (m/s).
    b: Vec<f64>,
    /// `W_αα` (1/kg).
    delassus: Vec<f64>,
    /// 1/`W_αα` (kg).
    inverse: Vec<f64>,
    /// The greatest `W_αα` (1/kg).
    greatest_delassus: f64,
    /// m of each grain (kg).
    mass: Vec<f64>,
    /// 1/m of each grain (1/kg); 0 of the wall.
    inverse_mass: Vec<f64>,
}

/// v = n · (ΔV_i − ΔV_j) + b, eq. (1), with what the impulses add to the velocities of the two grains (m/s).
#[inline(always)]
fn relative<const D: usize>(normal: SVector<f64, D>, i: SVector<f64, D>, j: SVector<f64, D>, b: f64) -> f64 {
    normal.dot(&(i - j)) + b
}

impl<const D: usize> Gauge<Smooth<D>> for Plain<D> {
    fn new(
        mass: &[f64],
        free_velocity: &[SVector<f64, D>],
        of: &[Contact<D>],
        contacts: impl Iterator<Item = (usize, Ends)> + Clone,
        grains: impl ExactSizeIterator<Item = usize>,
    ) -> Self {
        let all = || contacts.clone().map(|(k, _)| &of[k]);
        let diagonal = |contact: &Contact<D>| contact.diagonal(|grain| 1.0 / mass[grain as usize]);
        let (wall, mass): (_, Vec<f64>) = (grains.len() as u32, grains.map(|grain| mass[grain]).collect());
        let delassus: Vec<f64> = all().map(diagonal).collect();
        Self {
            adjacency: Adjacency::new(contacts.clone().map(|(_, ends)| ends), mass.len()),
            normal: all().map(|contact| contact.normal).collect(),
            ends: contacts.clone().map(|(_, (i, j))| [i, j.unwrap_or(wall)]).collect(),
            b: all().map(|contact| contact.relative(free_velocity) + contact.offset).collect(),
            inverse: delassus.iter().map(|w| 1.0 / w).collect(),
            greatest_delassus: delassus.iter().copied().fold(0.0, f64::max),
            delassus,
            inverse_mass: mass.iter().map(|mass| 1.0 / mass).chain([0.0]).collect(),
            mass,
        }
    }

    fn places(&self) -> usize {
        self.inverse_mass.len()
    }

    fn push(&self, r: &[f64], y: &mut [SVector<f64, D>]) {
        Arch::new().dispatch(Push { gauge: self, r, y });
    }

    fn gather(&self, place: usize, r: &[f64]) -> SVector<f64, D> {
        let mut resultant = SVector::zeros();
        if place < self.mass.len() {
            for contact in self.adjacency.around(place) {
                let contact = *contact as usize;
                let impulse = self.normal[contact] * r[contact];
                resultant += if self.ends[contact][0] as usize == place { impulse } else { -impulse };
            }
        }
        resultant * self.inverse_mass[place]
    }

    fn sums(&self, contacts: Range<usize>, r: &[f64], y: &[SVector<f64, D>], alone: bool) -> Sums {
        Arch::new().dispatch(Pull { gauge: self, contacts, r, y, alone })
    }

    fn alone(&self, contact: usize, r: &[f64]) -> (f64, f64) {
        let [i, j] = self.ends[contact].map(|grain| self.gather(grain as usize, r));
        let v = relative(self.normal[contact], i, j, self.b[contact]);
        (natural_map(r[contact], v, self.delassus[contact], self.inverse[contact]), -v)
    }

    /// |s| ≤ √max `W_αα` |r|.
    fn size(&self, r: &[f64]) -> f64 {
        (self.greatest_delassus * Arch::new().dispatch(Squared(r))).sqrt()
    }

    fn size_of_b(&self) -> f64 {
        self.b.iter().zip(&self.inverse).map(|(b, inverse)| b * b * inverse).sum::<f64>().sqrt()
    }

    fn scaled(_: f64, velocity: SVector<f64, D>) -> SVector<f64, D> {
        velocity
    }

    fn squared(&self, grain: usize, y: SVector<f64, D>) -> f64 {
        self.mass[grain] * y.norm_squared()
    }
}

/// First pass. A closure would not be inlined where the processor's instructions are chosen.
struct Push<'a, const D: usize> {
    gauge: &'a Plain<D>,
    r: &'a [f64],
    y: &'a mut [SVector<f64, D>],
}

impl<const D: usize> WithSimd for Push<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { gauge: Plain { normal, ends, inverse_mass, mass, .. }, r, y } = self;
        y.fill(SVector::zeros());
        for ((normal, [i, j]), r) in normal.iter().zip(ends).zip(r) {
            let impulse = normal * *r;
            y[*i as usize] += impulse;
            y[*j as usize] -= impulse;
        }
        // Walls stay at rest even if an impulse overflows.
        y[mass.len()] = SVector::zeros();
        y.iter_mut().zip(inverse_mass).for_each(|(y, inverse)| *y *= *inverse);
    }
}

/// Second pass, over some contacts.
struct Pull<'a, const D: usize> {
    gauge: &'a Plain<D>,
    contacts: Range<usize>,
    r: &'a [f64],
    y: &'a [SVector<f64, D>],
    alone: bool,
}

impl<const D: usize> WithSimd for Pull<'_, D> {
    type Output = Sums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        let Self { gauge, contacts, r, y, alone } = self;
        let mut lanes = Lanes::default();
        let mut v = [0.0; TILE];
        for start in contacts.clone().step_by(TILE) {
            let tile = start..contacts.end.min(start + TILE);
            let known = Known {
                delassus: &gauge.delassus[tile.clone()],
                inverse: &gauge.inverse[tile.clone()],
                b: &gauge.b[tile.clone()],
            };
            let (r, v) = (&r[tile.clone()], &mut v[..tile.len()]);
            let of_contacts = gauge.normal[tile.clone()].iter().zip(&gauge.ends[tile]).zip(known.b);
            for (v, ((normal, [i, j]), b)) in v.iter_mut().zip(of_contacts) {
                *v = relative(*normal, y[*i as usize], y[*j as usize], *b);
            }
            lanes.natural_map(r, v, &known);
            if !alone {
                lanes.others(r, v, &known);
                lanes.rate(v, start - contacts.start);
            }
        }
        lanes.sums()
    }
}

/// Sum of squares.
struct Squared<'a>(&'a [f64]);

impl WithSimd for Squared<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        squared(self.0)
    }
}
