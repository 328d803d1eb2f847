//! Interface of the stages to a mechanics: H of a contact between two places, the law, and directions of its own unknowns.

use analysis::Bounded;
use contact::law::{self, tangential};
use contact::{Contact, Frictional, Mechanics, Rough, RoughContact, RoughDiscs, RoughSpheres, Smooth, Touch};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use std::fmt::Debug;

/// A mechanics that LATIN solves.
pub trait Stages: Bounded {
    /// A contact, apart from what it touches and c.
    type Form: Form<Self>;
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

/// A contact with friction: the contact itself, between its own two grains.
#[derive(Clone, Copy, Debug)]
pub struct Rubbing<const D: usize>(RoughContact<D>);

/// Tolerance by which |`r_t`| may be below μ `r_n` at the bound, for round-off of either (–).
const ROUND_OFF: f64 = 1e-9;

/// Relative velocities of two grains, in the order of operations that each dimension has.
trait Pair<const D: usize>: Frictional<D> + Bounded {
    /// (Hᵗ V)_α of the velocities of i and j (m/s).
    fn relative(contact: &RoughContact<D>, i: Self::Velocity, j: Self::Velocity) -> SVector<f64, D>;
}

impl Pair<2> for RoughDiscs {
    #[inline]
    fn relative(contact: &RoughContact, i: Vector3<f64>, j: Vector3<f64>) -> Vector2<f64> {
        let (n, x, y) = (contact.normal, i.x - j.x, i.y - j.y);
        let spins = contact.arms.x * i.z + contact.arms.y * j.z;
        Vector2::new(n.x * x + n.y * y, n.x * y - n.y * x - spins)
    }
}

impl Pair<3> for RoughSpheres {
    #[inline]
    fn relative(contact: &RoughContact<3>, i: Vector6<f64>, j: Vector6<f64>) -> Vector3<f64> {
        contact.relative(&[i, j])
    }
}

impl<const D: usize, const N: usize> Stages for Rough<D>
where
    Rough<D>: Pair<D, Velocity = SVector<f64, N>>,
{
    type Form = Rubbing<D>;
}

impl<const D: usize, const N: usize> Form<Rough<D>> for Rubbing<D>
where
    Rough<D>: Pair<D, Velocity = SVector<f64, N>>,
{
    fn new(contact: &RoughContact<D>) -> Self {
        let arm_of_antagonist = contact.antagonist.map_or(0.0, |_| contact.arms.y);
        let arms = Vector2::new(contact.arms.x, arm_of_antagonist);
        Self(RoughContact { candidate: 0, antagonist: Some(1), arms, ..*contact })
    }

    /// Without friction no tangential impulse is ever needed: `l_t` = 0 takes it out of the linear stage, which then leaves the
    /// spins as they are.
    fn direction(&self, w: SVector<f64, D>, kappa_t: f64) -> SVector<f64, D> {
        let along = if self.0.friction > 0.0 { kappa_t } else { 0.0 };
        SVector::from_fn(|k, _| if k == 0 { 1.0 } else { along } / w[k])
    }

    #[inline]
    fn relative(&self, i: SVector<f64, N>, j: SVector<f64, N>) -> SVector<f64, D> {
        Rough::relative(&self.0, i, j)
    }

    fn terms(&self, i: SVector<f64, N>, j: SVector<f64, N>) -> SVector<f64, D> {
        let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [i, j] = [&i, &j].map(|v| v.as_slice().split_at(D)).map(|(v, spin)| (size(v), size(spin)));
        let (translations, spins) = (i.0 + j.0, self.0.arms.x * i.1 + self.0.arms.y * j.1);
        SVector::from_fn(|k, _| if k == 0 { translations } else { translations + spins })
    }

    #[inline]
    fn at_ends(&self, r: SVector<f64, D>) -> [SVector<f64, N>; 2] {
        let at = |arm: f64, sign: f64| Rough::at_grain(&self.0, r, arm, sign);
        [at(self.0.arms.x, 1.0), at(self.0.arms.y, -1.0)]
    }

    fn columns(&self) -> impl Iterator<Item = [SVector<f64, N>; 2]> {
        (0..D).map(|unknown| self.at_ends(SVector::from_fn(|k, _| f64::from(u8::from(k == unknown)))))
    }

    /// `r̂_n` = max(0, `g_n`),   `r̂_t` = clip(`g_t`, μ `r̂_n`)     (2′) (6)
    #[inline]
    fn admissible(&self, g: SVector<f64, D>) -> SVector<f64, D> {
        law::admissible(g, self.0.friction)
    }

    /// Along the tangents a contact slides against a `r_t` that is at its bound, and sticks elsewhere.
    fn beside(&self, r: SVector<f64, D>, v: SVector<f64, D>) -> SVector<f64, D> {
        let ((along, size), bound) = (tangential(r), (1.0 - ROUND_OFF) * self.0.friction * r[0]);
        let mut beside = if size < bound {
            SVector::zeros()
        } else if size == 0.0 {
            v
        } else {
            let against = along / size;
            against * f64::min(0.0, against.dot(&v))
        };
        beside[0] = if r[0] > 0.0 { 0.0 } else { law::non_negative(v[0]) };
        beside
    }
}
