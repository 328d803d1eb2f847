//! Interface of the stages to a mechanics: H of a contact between two places, the law, and directions of its own unknowns.

use analysis::Bounded;
use contact::{Contact, Mechanics, RoughContact, RoughDiscs, RoughSpheres, Smooth, Touch, law};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use std::fmt::Debug;

/// A mechanics that LATIN solves.
pub trait Stages: Bounded {
    /// A contact, apart from what it touches and c.
    type Form: Form<Self>;

    /// The numbers of an impulse, the normal one first.
    fn numbers(r: Self::Impulse) -> impl Iterator<Item = f64>;
}

/// H and the law of a contact between a candidate i and an antagonist j, which at a wall is at rest.
pub trait Form<M: Mechanics>: Copy + Debug + Send + Sync + 'static {
    /// That of a contact of a problem.
    fn new(contact: &M::Contact) -> Self;

    /// l where κ_l = 1 (kg), with `W_αα` = `w` (1/kg) and κ_t; 0 for an unknown that the law leaves at 0.
    fn direction(&self, w: M::Impulse, kappa_t: f64) -> M::Impulse;

    /// (Hᵗ V)_α of the velocities of i and j (m/s).
    fn relative(&self, i: M::Velocity, j: M::Velocity) -> M::Impulse;

    /// The sizes of the terms of which (Hᵗ V)_α is the sum, added up (m/s).
    fn terms(&self, i: M::Velocity, j: M::Velocity) -> M::Impulse;

    /// h_α r at i and at j (N·s).
    fn at_ends(&self, r: M::Impulse) -> [M::Velocity; 2];

    /// h_α of each unknown, at i and at j (–, m).
    fn columns(&self) -> impl Iterator<Item = [M::Velocity; 2]>;

    /// r̂ of the r̂ and v̂ that satisfy the law and r̂ − l⁺ v̂ = `g`, whatever l⁺ (N·s).
    fn admissible(&self, g: M::Impulse) -> M::Impulse;

    /// The v̂ nearest to v that satisfies the law beside `r` (m/s).
    fn beside(&self, r: M::Impulse, v: M::Impulse) -> M::Impulse;
}

/// A contact without friction, by its normal n.
#[derive(Clone, Copy, Debug)]
pub struct Normal<const D: usize>(SVector<f64, D>);

impl<const D: usize> Stages for Smooth<D> {
    type Form = Normal<D>;

    fn numbers(r: f64) -> impl Iterator<Item = f64> {
        std::iter::once(r)
    }
}

impl<const D: usize> Form<Smooth<D>> for Normal<D> {
    fn new(contact: &Contact<D>) -> Self {
        Self(contact.normal)
    }

    fn direction(&self, w: f64, _: f64) -> f64 {
        1.0 / w
    }

    #[inline]
    fn relative(&self, i: SVector<f64, D>, j: SVector<f64, D>) -> f64 {
        self.0.dot(&(i - j))
    }

    fn terms(&self, i: SVector<f64, D>, j: SVector<f64, D>) -> f64 {
        i.norm() + j.norm()
    }

    #[inline]
    fn at_ends(&self, r: f64) -> [SVector<f64, D>; 2] {
        let impulse = self.0 * r;
        [impulse, -impulse]
    }

    fn columns(&self) -> impl Iterator<Item = [SVector<f64, D>; 2]> {
        std::iter::once([self.0, -self.0])
    }

    /// max(0, g)     (2) (6)
    #[inline]
    fn admissible(&self, g: f64) -> f64 {
        law::non_negative(g)
    }

    fn beside(&self, r: f64, v: f64) -> f64 {
        if r > 0.0 { 0.0 } else { law::non_negative(v) }
    }
}

/// A contact with friction.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    /// n (–).
    normal: Vector2<f64>,
    /// `R_i` and `R_j`, 0 at a wall (m).
    arms: [f64; 2],
    /// μ (–).
    friction: f64,
}

/// Tolerance by which |`r_t`| may be below μ `r_n` at the bound, for round-off of either (–).
const ROUND_OFF: f64 = 1e-9;

impl Stages for RoughDiscs {
    type Form = Rough;

    fn numbers(r: Vector2<f64>) -> impl Iterator<Item = f64> {
        [r.x, r.y].into_iter()
    }
}

impl Form<RoughDiscs> for Rough {
    fn new(contact: &RoughContact) -> Self {
        let arm_of_antagonist = contact.antagonist.map_or(0.0, |_| contact.arms.y);
        let arms = [contact.arms.x, arm_of_antagonist];
        Self { normal: contact.normal, arms, friction: contact.friction }
    }

    /// Without friction no tangential impulse is ever needed: `l_t` = 0 takes it out of the linear stage, which then leaves the
    /// spins as they are.
    fn direction(&self, w: Vector2<f64>, kappa_t: f64) -> Vector2<f64> {
        Vector2::new(1.0 / w.x, if self.friction > 0.0 { kappa_t / w.y } else { 0.0 })
    }

    #[inline]
    fn relative(&self, i: Vector3<f64>, j: Vector3<f64>) -> Vector2<f64> {
        let (n, x, y) = (self.normal, i.x - j.x, i.y - j.y);
        let spins = self.arms[0] * i.z + self.arms[1] * j.z;
        Vector2::new(n.x * x + n.y * y, n.x * y - n.y * x - spins)
    }

    fn terms(&self, i: Vector3<f64>, j: Vector3<f64>) -> Vector2<f64> {
        let translations = i.xy().norm() + j.xy().norm();
        let spins = self.arms[0] * i.z.abs() + self.arms[1] * j.z.abs();
        Vector2::new(translations, translations + spins)
    }

    #[inline]
    fn at_ends(&self, r: Vector2<f64>) -> [Vector3<f64>; 2] {
        let n = self.normal;
        let (x, y) = (n.x * r.x - n.y * r.y, n.y * r.x + n.x * r.y);
        [Vector3::new(x, y, -self.arms[0] * r.y), Vector3::new(-x, -y, -self.arms[1] * r.y)]
    }

    fn columns(&self) -> impl Iterator<Item = [Vector3<f64>; 2]> {
        [Vector2::x(), Vector2::y()].map(|r| self.at_ends(r)).into_iter()
    }

    /// `r̂_n` = max(0, `g_n`),   `r̂_t` = clip(`g_t`, μ `r̂_n`)     (2′) (6)
    #[inline]
    fn admissible(&self, g: Vector2<f64>) -> Vector2<f64> {
        let normal = law::non_negative(g.x);
        Vector2::new(normal, law::clip(g.y, self.friction * normal))
    }

    /// Along the tangent a contact slides against a `r_t` that is at its bound, and sticks elsewhere.
    fn beside(&self, r: Vector2<f64>, v: Vector2<f64>) -> Vector2<f64> {
        let normal = if r.x > 0.0 { 0.0 } else { law::non_negative(v.x) };
        let bound = (1.0 - ROUND_OFF) * self.friction * r.x;
        let slides = if v.y < 0.0 { r.y >= bound } else { r.y <= -bound };
        Vector2::new(normal, if slides { v.y } else { 0.0 })
    }
}

/// A contact of spheres with friction: the contact itself, between its own two grains.
#[derive(Clone, Copy, Debug)]
pub struct RoughInSpace(RoughContact<3>);

impl Stages for RoughSpheres {
    type Form = RoughInSpace;

    fn numbers(r: Vector3<f64>) -> impl Iterator<Item = f64> {
        [r.x, r.y, r.z].into_iter()
    }
}

impl Form<RoughSpheres> for RoughInSpace {
    fn new(contact: &RoughContact<3>) -> Self {
        let arm_of_antagonist = contact.antagonist.map_or(0.0, |_| contact.arms.y);
        let arms = Vector2::new(contact.arms.x, arm_of_antagonist);
        Self(RoughContact { candidate: 0, antagonist: Some(1), arms, ..*contact })
    }

    fn direction(&self, w: Vector3<f64>, kappa_t: f64) -> Vector3<f64> {
        let along = if self.0.friction > 0.0 { kappa_t / w.y } else { 0.0 };
        Vector3::new(1.0 / w.x, along, along)
    }

    #[inline]
    fn relative(&self, i: Vector6<f64>, j: Vector6<f64>) -> Vector3<f64> {
        self.0.relative(&[i, j])
    }

    fn terms(&self, i: Vector6<f64>, j: Vector6<f64>) -> Vector3<f64> {
        let [translations, spins] = [0, 3].map(|first| [i, j].map(|v| v.fixed_rows::<3>(first).norm()));
        let (translations, spins) =
            (translations[0] + translations[1], self.0.arms.x * spins[0] + self.0.arms.y * spins[1]);
        Vector3::new(translations, translations + spins, translations + spins)
    }

    #[inline]
    fn at_ends(&self, r: Vector3<f64>) -> [Vector6<f64>; 2] {
        let mut ends = [Vector6::zeros(); 2];
        self.0.push(r, &mut ends);
        ends
    }

    fn columns(&self) -> impl Iterator<Item = [Vector6<f64>; 2]> {
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|r| self.at_ends(r)).into_iter()
    }

    /// As in the plane, with the tangential part clipped to a disc.
    #[inline]
    fn admissible(&self, g: Vector3<f64>) -> Vector3<f64> {
        let normal = law::non_negative(g.x);
        let (bound, size) = (self.0.friction * normal, g.yz().norm());
        let factor = if size > bound { bound / size } else { 1.0 };
        Vector3::new(normal, factor * g.y, factor * g.z)
    }

    /// Along the tangents a contact slides against a `r_t` that is at its bound, and sticks elsewhere.
    fn beside(&self, r: Vector3<f64>, v: Vector3<f64>) -> Vector3<f64> {
        let normal = if r.x > 0.0 { 0.0 } else { law::non_negative(v.x) };
        let (size, bound) = (r.yz().norm(), (1.0 - ROUND_OFF) * self.0.friction * r.x);
        let slides = if size == 0.0 {
            v.yz()
        } else {
            let against = r.yz() / size;
            against * f64::min(0.0, against.dot(&v.yz()))
        };
        if size >= bound { Vector3::new(normal, slides.x, slides.y) } else { Vector3::new(normal, 0.0, 0.0) }
    }
}
