//! Spheres with friction: a grain translates and spins about any axis, a contact has a normal and two tangential unknowns.
//!
//! `v_t` = Tᵗ (`V_i` − `V_j` − (`R_i` `ω_i` + `R_j` `ω_j`) × n), with T = [t₁ t₂] of a frame chosen from n alone.

#![expect(clippy::inline_always, reason = "a call for each contact would cost a sweep a third of its time")]

use super::{RoughContact, RoughMass, RoughMeter, Rubbing};
use crate::discs::{Contact, Spheres};
use crate::error::{ProblemError, is_not_negative};
use crate::law;
use crate::mechanics::{Column, Mass, Mechanics, Touch};
use crate::problem::ContactProblem;
use nalgebra::{Vector3, Vector6};

/// Spheres with friction. Velocities are [V, ω], impulses [`r_n`, `r_t1`, `r_t2`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoughSpheres;

impl Mechanics for RoughSpheres {
    type Place = Vector3<f64>;
    type Velocity = Vector6<f64>;
    type Mass = RoughMass;
    type Impulse = Vector3<f64>;
    type Contact = RoughContact<3>;
    type Column = SphereColumn;
    type Meter<'p> = RoughMeter<'p, Self>;

    const NAME: &'static str = "rough-spheres";
    const HAS_ONE_VELOCITY: bool = false;
}

/// The tangents t₁ and t₂ that make a right-handed frame with the unit normal n.
///
/// T. Duff et al., Building an orthonormal basis, revisited, J. Computer Graphics Techniques 6(1) (2017) 1-8.
#[inline]
pub fn frame(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        Vector3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vector3::new(b, sign + n.y * n.y * a, -n.y),
    ]
}

/// Translation and spin.
#[inline]
fn parts(v: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5])]
}

#[inline]
fn joined(translation: Vector3<f64>, spin: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(translation.x, translation.y, translation.z, spin.x, spin.y, spin.z)
}

impl Mass<Vector6<f64>> for RoughMass {
    fn fault(self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }

    fn inverse(self, times: f64) -> Self {
        self.each(|m| times / m)
    }

    fn root(self) -> Self {
        self.each(f64::sqrt)
    }

    fn times(self, v: Vector6<f64>) -> Vector6<f64> {
        let [translation, spin] = parts(&v);
        joined(translation * self.mass, spin * self.inertia)
    }

    fn divides(self, r: Vector6<f64>) -> Vector6<f64> {
        let [translation, spin] = parts(&r);
        joined(translation / self.mass, spin / self.inertia)
    }

    fn squared(self, v: Vector6<f64>) -> f64 {
        let [translation, spin] = parts(&v);
        self.mass * translation.norm_squared() + self.inertia * spin.norm_squared()
    }

    fn speed(self, y: Vector6<f64>) -> f64 {
        self.mass * parts(&y)[0].norm()
    }
}

/// The tangential part of an impulse, [0, s₁, s₂] of [s, s₁, s₂], or the nearest one of at most `bound` in size.
#[inline]
fn clipped(s: Vector3<f64>, bound: f64) -> Vector3<f64> {
    let squared = s.y * s.y + s.z * s.z;
    // A NaN is handed on.
    let factor = if squared > bound * bound { bound / squared.sqrt() } else { 1.0 };
    Vector3::new(0.0, factor * s.y, factor * s.z)
}

impl RoughContact<3> {
    /// Hᵗ V of one grain, with the sign of its translation (m/s).
    fn of_grain(&self, v: &Vector6<f64>, arm: f64, sign: f64) -> Vector3<f64> {
        let ([translation, spin], [first, second]) = (parts(v), frame(&self.normal));
        let slip = translation * sign - (spin * arm).cross(&self.normal);
        Vector3::new(sign * self.normal.dot(&translation), first.dot(&slip), second.dot(&slip))
    }

    /// H r at one grain, with the sign of its translation (N·s, N·m·s).
    fn at_grain(&self, r: Vector3<f64>, arm: f64, sign: f64) -> Vector6<f64> {
        let [first, second] = frame(&self.normal);
        let along = first * r.y + second * r.z;
        joined((self.normal * r.x + along) * sign, self.normal.cross(&along) * -arm)
    }
}

impl Touch<RoughSpheres> for RoughContact<3> {
    const ADMISSIBLE: &'static str = super::ADMISSIBLE;

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    fn offset(&self) -> Vector3<f64> {
        self.offset
    }

    fn relative(&self, velocity: &[Vector6<f64>]) -> Vector3<f64> {
        let candidate = self.of_grain(&velocity[self.candidate as usize], self.arms.x, 1.0);
        let of = |j: u32| self.of_grain(&velocity[j as usize], self.arms.y, -1.0);
        self.antagonist.map_or(candidate, |j| candidate + of(j))
    }

    fn push(&self, r: Vector3<f64>, resultant: &mut [Vector6<f64>]) {
        resultant[self.candidate as usize] += self.at_grain(r, self.arms.x, 1.0);
        if let Some(antagonist) = self.antagonist {
            resultant[antagonist as usize] += self.at_grain(r, self.arms.y, -1.0);
        }
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> RoughMass) -> Vector3<f64> {
        let of = |grain: u32, arm: f64| {
            let RoughMass { mass, inertia } = inverse_mass(grain);
            let along = mass + arm * arm * inertia;
            Vector3::new(mass, along, along)
        };
        let candidate = of(self.candidate, self.arms.x);
        self.antagonist.map_or(candidate, |j| candidate + of(j, self.arms.y))
    }

    fn admissible(&self, r: Vector3<f64>, v: Vector3<f64>, diagonal: Vector3<f64>) -> Vector3<f64> {
        let moved = r - v.component_div(&diagonal);
        let mut plus = clipped(moved, self.friction * law::non_negative(r.x));
        plus.x = law::non_negative(moved.x);
        plus
    }

    fn is_admissible(&self, r: Vector3<f64>) -> bool {
        is_not_negative(r.x) && r.yz().norm() <= (1.0 + 1e-9) * self.friction * r.x
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }
}

impl ContactProblem<RoughSpheres> {
    /// The same grains and contacts without friction.
    ///
    /// # Errors
    /// None: what is left was valid before.
    pub fn without_friction(&self) -> Result<ContactProblem<Spheres>, ProblemError> {
        let contact = |at: &RoughContact<3>| Contact {
            candidate: at.candidate,
            antagonist: at.antagonist,
            normal: at.normal,
            offset: at.offset.x,
        };
        ContactProblem::new(
            self.mass().iter().map(|mass| mass.mass).collect(),
            self.free_velocity().iter().map(|v| parts(v)[0]).collect(),
            self.contacts().iter().map(contact).collect(),
        )
    }
}

/// The three columns of H̃ of a contact: along its normal, and along its tangents with the spins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereColumn {
    candidate: u32,
    /// At a wall the candidate itself, which a ratio and an arm of 0 leave out.
    antagonist: u32,
    /// n (–).
    normal: Vector3<f64>,
    /// t₁ and t₂ of its frame, which a visit would take longer to make anew (–).
    tangents: [Vector3<f64>; 2],
    /// 1/√(`m_candidate` `w_n`), and of `w_t` (–).
    roots: [f64; 2],
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    ratio: f64,
    /// `R_i`/√(`I_i` `w_t`), and of j likewise (–); 0 at a wall.
    arms: [f64; 2],
    /// μ √(`w_t`/`w_n`) (–): a circular cone stays circular.
    friction: f64,
}

impl SphereColumn {
    /// The places of candidate and antagonist; at a wall twice that of the candidate.
    #[inline]
    pub fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    /// μ √(`w_t`/`w_n`) (–).
    #[inline]
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// h̃ s of an impulse s at the candidate and at the antagonist: 0 at a wall.
    #[inline]
    pub fn at_ends(&self, s: Vector3<f64>) -> [Vector6<f64>; 2] {
        let [push, turn] = self.pushes(s);
        [joined(push, turn * self.arms[0]), joined(push * -self.ratio, turn * self.arms[1])]
    }

    /// What an impulse does to both: the translation of the candidate, and the turn of which each takes its arm.
    #[inline]
    fn pushes(&self, s: Vector3<f64>) -> [Vector3<f64>; 2] {
        let [first, second] = self.tangents;
        let along = first * s.y + second * s.z;
        [self.normal * (self.roots[0] * s.x) + along * self.roots[1], along.cross(&self.normal)]
    }
}

impl Column<RoughSpheres> for SphereColumn {
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
        let column = Self {
            candidate: places.0,
            antagonist: places.1.unwrap_or(places.0),
            normal: contact.normal,
            tangents: frame(&contact.normal),
            roots: [root / unit.x, root / unit.y],
            ratio: j.mass.sqrt() / root,
            arms: [contact.arms.x * i.inertia.sqrt() / unit.y, contact.arms.y * j.inertia.sqrt() / unit.y],
            friction: contact.friction * (unit.y / unit.x),
        };
        (column, unit)
    }

    #[inline(always)]
    fn relative(&self, y: &[Vector6<f64>]) -> Vector3<f64> {
        RoughSpheres::between(self, [y[self.candidate as usize], y[self.antagonist as usize]])
    }

    #[inline(always)]
    fn push(&self, s: Vector3<f64>, y: &mut [Vector6<f64>]) {
        let [candidate, antagonist] = self.at_ends(s);
        y[self.candidate as usize] += candidate;
        y[self.antagonist as usize] += antagonist;
    }

    /// `s_n⁺` = max(0, `s_n` − ω `v_n`), then `s_t⁺` = clip(`s_t` − ω `v_t`, μ̃ `s_n⁺`) to the disc of that radius: the two lines
    /// solve (2′), since `W_αα` is diagonal and the same along both tangents.
    #[inline]
    fn change(&self, s: Vector3<f64>, v: Vector3<f64>, relaxation: f64) -> Vector3<f64> {
        let normal = law::change(s.x, v.x, relaxation);
        let along = clipped(s - v * relaxation, self.friction * (s.x + normal));
        Vector3::new(normal, along.y - s.y, along.z - s.z)
    }

    #[inline]
    fn residual(&self, s: Vector3<f64>, v: Vector3<f64>) -> Vector3<f64> {
        let normal = if v.x >= s.x { s.x } else { v.x };
        let (bound, moved) = (self.friction * law::non_negative(s.x), s - v);
        let sticks = moved.y * moved.y + moved.z * moved.z <= bound * bound;
        let mut left = if sticks { v } else { s - clipped(moved, bound) };
        left.x = normal;
        left
    }
}

impl Rubbing for RoughSpheres {
    fn places(column: &SphereColumn) -> [u32; 2] {
        column.places()
    }

    #[inline]
    fn between(column: &SphereColumn, [i, j]: [Vector6<f64>; 2]) -> Vector3<f64> {
        let ([v_i, spin_i], [v_j, spin_j]) = (parts(&i), parts(&j));
        let apart = v_i - v_j * column.ratio;
        let spins = spin_i * column.arms[0] + spin_j * column.arms[1];
        let slip = apart * column.roots[1] - spins.cross(&column.normal);
        let [first, second] = column.tangents;
        Vector3::new(column.roots[0] * column.normal.dot(&apart), first.dot(&slip), second.dot(&slip))
    }

    fn push_at(column: &SphereColumn, grain: u32, s: Vector3<f64>) -> Vector6<f64> {
        let [candidate, antagonist] = column.at_ends(s);
        if grain == column.candidate { candidate } else { antagonist }
    }
}
