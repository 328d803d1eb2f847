//! A contact between spheres with friction in mass-scaled unknowns: 128 bytes.

#![expect(
    clippy::inline_always,
    reason = "a call for each contact would cost a third of a visit, and lack the instructions that a sweep is made for"
)]

use super::{frame, joined, parts};
use crate::lanes::{Lanes, Number, Side};
use crate::law::{self, Coulomb};
use crate::mechanics::{Column, Touch};
use crate::rough::{Cone, RoughContact, RoughMass, RoughSpheres};
use crate::vector::Numbers;
use crate::visit::{Row, TOGETHER, Visited, look_then_push};
use nalgebra::{Vector3, Vector6};
use pulp::Simd;

/// The three columns of H̃ of a contact: along its normal, and along its tangents with the spins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereColumn<N = f64> {
    candidate: u32,
    /// At a wall the candidate itself, which a ratio and an arm of 0 leave out.
    antagonist: u32,
    columns: Columns<N>,
}

const _: () = assert!(size_of::<SphereColumn>() == 128);

/// Coefficients of the equations of a contact; or of several, where `N` is [`Side`]. They lie in this order, since several contacts are
/// read by pairs.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Columns<N = f64> {
    /// n (–).
    normal: Vector3<N>,
    /// t₁ and t₂ of its frame, which a visit would take longer to make anew (–).
    tangents: [Vector3<N>; 2],
    /// 1/√(`m_candidate` `w_n`), and of `w_t` (–).
    roots: [N; 2],
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    ratio: N,
    /// `R_i`/√(`I_i` `w_t`), and of j likewise (–); 0 at a wall.
    arms: [N; 2],
    /// μ √(`w_t`/`w_n`) (–): a circular cone stays circular.
    friction: N,
}

#[inline(always)]
fn dot<N: Lanes>(a: &Vector3<N>, b: &Vector3<N>) -> N {
    a.x * b.x + a.y * b.y + a.z * b.z
}

impl<N: Lanes> Columns<N> {
    /// H̃ᵗ y of [translation, spin] in the y of candidate and antagonist; the latter has no effect at a wall.
    #[inline(always)]
    fn between(&self, [[v_i, spin_i], [v_j, spin_j]]: [[Vector3<N>; 2]; 2]) -> Vector3<N> {
        let apart = v_i - v_j * self.ratio;
        let spins = spin_i * self.arms[0] + spin_j * self.arms[1];
        let slip = apart * self.roots[1] - spins.cross(&self.normal);
        let [first, second] = &self.tangents;
        Vector3::new(self.roots[0] * dot(&self.normal, &apart), dot(first, &slip), dot(second, &slip))
    }

    /// h̃ s of an impulse s, as [translation, spin] of the candidate and of the antagonist: 0 at a wall.
    #[inline(always)]
    fn at_ends(&self, s: Vector3<N>) -> [[Vector3<N>; 2]; 2] {
        let [first, second] = self.tangents;
        let along = first * s.y + second * s.z;
        let push = self.normal * (self.roots[0] * s.x) + along * self.roots[1];
        let turn = along.cross(&self.normal);
        [[push, turn * self.arms[0]], [push * -self.ratio, turn * self.arms[1]]]
    }
}

impl<S: Simd, N: Number> Columns<Side<S, N>> {
    #[inline(always)]
    fn new(simd: S, rows: &[Row<SphereColumn<N>>]) -> Self {
        let of = |k: usize| &rows[k].column.columns;
        let pair = |numbers: fn(&Columns<N>) -> [N; 2]| Side::pair(simd, |k| numbers(of(k)));
        let [n_x, n_y] = pair(|of| [of.normal.x, of.normal.y]);
        let [n_z, first_x] = pair(|of| [of.normal.z, of.tangents[0].x]);
        let [first_y, first_z] = pair(|of| [of.tangents[0].y, of.tangents[0].z]);
        let [second_x, second_y] = pair(|of| [of.tangents[1].x, of.tangents[1].y]);
        let [second_z, of_normal] = pair(|of| [of.tangents[1].z, of.roots[0]]);
        let [of_tangents, ratio] = pair(|of| [of.roots[1], of.ratio]);
        Self {
            normal: Vector3::new(n_x, n_y, n_z),
            tangents: [Vector3::new(first_x, first_y, first_z), Vector3::new(second_x, second_y, second_z)],
            roots: [of_normal, of_tangents],
            ratio,
            arms: pair(|of| of.arms),
            friction: Side::new(simd, |k| of(k).friction),
        }
    }
}

impl Cone for SphereColumn {
    #[inline]
    fn friction(&self) -> f64 {
        self.columns.friction
    }
}

impl<N: Number> Visited for SphereColumn<N> {
    type Velocity = Vector6<N>;
    type Impulse = Vector3<N>;
    type Law = Coulomb<N>;

    #[inline]
    fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    #[inline(always)]
    fn between(&self, ends: [Vector6<N>; 2]) -> Vector3<N> {
        self.columns.between(ends.map(|y| parts(&y)))
    }

    #[inline(always)]
    fn pushes(&self, s: Vector3<N>) -> [Vector6<N>; 2] {
        self.columns.at_ends(s).map(|[translation, spin]| joined(translation, spin))
    }

    #[inline(always)]
    fn law(&self) -> Coulomb<N> {
        Coulomb(self.columns.friction)
    }

    #[inline(always)]
    fn visit<S: Simd>(
        simd: S,
        rows: &[Row<Self>; TOGETHER],
        s: &mut [Vector3<N>; TOGETHER],
        y: &mut [Vector6<N>],
        relaxation: f64,
    ) {
        if N::lanes::<S>() != N::SIDE {
            return look_then_push(rows, s, y, relaxation);
        }
        const { assert!(TOGETHER.is_multiple_of(N::SIDE), "a remainder would not be visited") };
        for (rows, s) in rows.chunks_exact(N::SIDE).zip(s.chunks_exact_mut(N::SIDE)) {
            visit_several(simd, rows, s, y, relaxation);
        }
    }
}

impl Column<RoughSpheres> for SphereColumn {
    type Single = SphereColumn<f32>;

    fn new(
        contact: &RoughContact<3>,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> RoughMass,
        scaled: bool,
    ) -> (Self, Vector3<f64>) {
        let none = RoughMass { mass: 0.0, inertia: 0.0 };
        let i = inverse_mass(contact.candidate);
        let j = contact.antagonist.map_or(none, &inverse_mass);
        let unit = if scaled { contact.diagonal(inverse_mass).map(f64::sqrt) } else { Vector3::repeat(1.0) };
        let root = i.mass.sqrt();
        let columns = Columns {
            normal: contact.normal,
            tangents: frame(&contact.normal),
            roots: [root / unit.x, root / unit.y],
            ratio: j.mass.sqrt() / root,
            arms: [contact.arms.x * i.inertia.sqrt() / unit.y, contact.arms.y * j.inertia.sqrt() / unit.y],
            friction: contact.friction * (unit.y / unit.x),
        };
        (Self { candidate: places.0, antagonist: places.1.unwrap_or(places.0), columns }, unit)
    }

    fn single(&self) -> SphereColumn<f32> {
        let Self { candidate, antagonist, columns } = self;
        let columns = Columns {
            normal: Numbers::nearest(columns.normal),
            tangents: columns.tangents.map(Numbers::nearest),
            roots: columns.roots.map(Numbers::nearest),
            ratio: Numbers::nearest(columns.ratio),
            arms: columns.arms.map(Numbers::nearest),
            friction: Numbers::nearest(columns.friction),
        };
        SphereColumn { candidate: *candidate, antagonist: *antagonist, columns }
    }

    #[inline]
    fn residual(&self, s: Vector3<f64>, v: Vector3<f64>) -> Vector3<f64> {
        let normal = if v.x >= s.x { s.x } else { v.x };
        let bound = self.columns.friction * law::non_negative(s.x);
        let (s, v) = (s.yz(), v.yz());
        // |s − v|² − bound², where v may be round-off of s.
        let beyond = if 4.0 * v.norm_squared() <= s.norm_squared() {
            (s.norm() - bound) * (s.norm() + bound) + v.dot(&(v - 2.0 * s))
        } else {
            (s - v).norm_squared() - bound * bound
        };
        if beyond <= 0.0 {
            return Vector3::new(normal, v.x, v.y);
        }
        // s − bound (s − v)/|s − v|
        let length = (beyond + bound * bound).sqrt();
        let tangential = (s * (beyond / (length + bound)) + v * bound) / length;
        Vector3::new(normal, tangential.x, tangential.y)
    }
}

/// Translation and spin of each of several velocities.
#[inline(always)]
fn several<'y, S: Simd, N: Number>(
    simd: S,
    of: impl Fn(usize) -> &'y Vector6<N>,
) -> [Vector3<Side<S, N>>; 2] {
    let [a, b] = Side::pair(simd, |k| [of(k)[0], of(k)[1]]);
    let [c, d] = Side::pair(simd, |k| [of(k)[2], of(k)[3]]);
    let [e, f] = Side::pair(simd, |k| [of(k)[4], of(k)[5]]);
    [Vector3::new(a, b, c), Vector3::new(d, e, f)]
}

/// [`Number::SIDE`] visits at once.
#[inline(always)]
fn visit_several<S: Simd, N: Number>(
    simd: S,
    rows: &[Row<SphereColumn<N>>],
    s: &mut [Vector3<N>],
    y: &mut [Vector6<N>],
    relaxation: f64,
) {
    let i = |k: usize| rows[k].column.candidate as usize;
    let j = |k: usize| rows[k].column.antagonist as usize;
    let columns = Columns::new(simd, rows);
    let ends = [several(simd, |k| &y[i(k)]), several(simd, |k| &y[j(k)])];
    let v = columns.between(ends) + Side::vector(simd, |k| rows[k].offset.into());
    let before = Side::vector(simd, |k| s[k].into());
    let change = law::change_in_space(before, v, columns.friction, relaxation);
    let after = Side::apart(before + change);
    let [[push_i, turn_i], [push_j, turn_j]] = columns.at_ends(change);
    let of_i = (Side::apart(push_i), Side::apart(turn_i));
    let of_j = (Side::apart(push_j), Side::apart(turn_j));
    for k in 0..N::SIDE {
        s[k] = after(k);
        y[i(k)] += joined(of_i.0(k), of_i.1(k));
        y[j(k)] += joined(of_j.0(k), of_j.1(k));
    }
}

#[cfg(test)]
mod tests;
