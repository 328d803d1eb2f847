//! Discs with friction: a grain translates and spins, a contact has a normal and a tangential unknown, and Coulomb's law.
//!
//! The tangent is t = (−`n_y`, `n_x`). A contact point lies at `R_i` from the centre of i against the normal, at `R_j` from that of j
//! along it: the two translations enter the relative velocity with opposite signs, the two spins with the same.

mod column;
mod spheres;

pub use column::RoughColumn;
pub use spheres::{RoughSpheres, SphereColumn, frame};

use crate::discs::{Contact, Discs};
use crate::error::{ProblemError, is_not_negative, is_positive};
use crate::gauge::Scaled;
use crate::law::tangential;
use crate::mechanics::{Mass, Mechanics, Touch, Vector};
use crate::problem::ContactProblem;
use nalgebra::{SVector, Vector2, Vector3};

/// Discs with friction. Velocities are [`V_x`, `V_y`, ω], impulses [`r_n`, `r_t`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoughDiscs;

impl Mechanics for RoughDiscs {
    type Place = Vector2<f64>;
    type Velocity = Vector3<f64>;
    type Mass = RoughMass;
    type Impulse = Vector2<f64>;
    type Contact = RoughContact;
    type Column = RoughColumn;
    type Gauge = Scaled<Self>;

    const NAME: &'static str = "rough-discs";
    const HAS_ONE_VELOCITY: bool = false;
}

/// Mass and moment of inertia of a grain; or the inverse of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughMass {
    /// m (kg).
    pub mass: f64,
    /// I about the centre (kg m²).
    pub inertia: f64,
}

impl RoughMass {
    fn each(self, function: impl Fn(f64) -> f64) -> Self {
        Self { mass: function(self.mass), inertia: function(self.inertia) }
    }
}

impl RoughMass {
    /// Returns the fault of the inertia, if any.
    fn fault_of(self) -> Option<(&'static str, f64, &'static str)> {
        let is_good = |m: f64| is_positive(m) && m.recip().is_finite();
        let expected = "positive and finite, and so its inverse";
        [("grains.mass", self.mass), ("grains.inertia", self.inertia)]
            .into_iter()
            .find_map(|(key, m)| (!is_good(m)).then_some((key, m, expected)))
    }
}

impl Mass<Vector3<f64>> for RoughMass {
    fn fault(self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }

    fn inverse(self, times: f64) -> Self {
        self.each(|m| times / m)
    }

    fn root(self) -> Self {
        self.each(f64::sqrt)
    }

    fn times(self, v: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(self.mass * v.x, self.mass * v.y, self.inertia * v.z)
    }

    fn divides(self, r: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(r.x / self.mass, r.y / self.mass, r.z / self.inertia)
    }

    fn squared(self, v: Vector3<f64>) -> f64 {
        self.mass * v.xy().norm_squared() + self.inertia * v.z * v.z
    }

    fn speed(self, y: Vector3<f64>) -> f64 {
        self.mass * y.xy().norm()
    }
}

/// One contact α with friction: `v_n` = n · (`V_i` − `V_j`) + `c_n`, `v_t` = t · (`V_i` − `V_j`) − (`R_i` `ω_i` + `R_j` `ω_j`) + `c_t`, and
///
/// 0 ≤ `v_n` ⊥ `r_n` ≥ 0,  |`r_t`| ≤ μ `r_n`,  `v_t` = 0 or (|`r_t`| = μ `r_n` and `r_t` against `v_t`)  (2′)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughContact<const D: usize = 2> {
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist grain; `None` for a wall, whose motion is in `offset`.
    pub antagonist: Option<u32>,
    /// Unit normal n, from antagonist to candidate (–).
    pub normal: SVector<f64, D>,
    /// `R_i` and `R_j`, from the centres to the contact point (m); the second is 0 at a wall.
    pub arms: Vector2<f64>,
    /// [`c_n`, `c_t`], in space [`c_n`, `c_t1`, `c_t2`]: what the scene imposes: a wall's motion and, along the normal, the law's
    /// gap term (m/s).
    pub offset: SVector<f64, D>,
    /// μ (–).
    pub friction: f64,
}

impl RoughContact {
    /// t (–).
    #[inline]
    pub fn tangent(&self) -> Vector2<f64> {
        tangent(self.normal)
    }

    /// Hᵗ V of the velocities of candidate and antagonist (m/s).
    #[inline]
    fn of_grains(&self, i: Vector3<f64>, j: Option<Vector3<f64>>) -> Vector2<f64> {
        let along = |v: Vector3<f64>, arm: f64, sign: f64| {
            let (n, t) = (self.normal.dot(&v.xy()), self.tangent().dot(&v.xy()));
            Vector2::new(sign * n, sign * t - arm * v.z)
        };
        let candidate = along(i, self.arms.x, 1.0);
        j.map_or(candidate, |j| candidate + along(j, self.arms.y, -1.0))
    }

    /// H r at the candidate and at the antagonist (N·s, N·m·s).
    #[inline]
    fn at_ends(&self, r: Vector2<f64>) -> [Vector3<f64>; 2] {
        let impulse = self.normal * r.x + self.tangent() * r.y;
        let at = |sign: f64, arm: f64| Vector3::new(sign * impulse.x, sign * impulse.y, -arm * r.y);
        [at(1.0, self.arms.x), at(-1.0, self.arms.y)]
    }
}

/// (−`n_y`, `n_x`).
#[inline]
fn tangent(n: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-n.y, n.x)
}

/// Size below which the norm of an impulse may be wrong, since squares underflow (N·s).
const UNDERFLOW: f64 = 1e-150;

/// Reports whether impulses r (N·s), the normal one first, are in Coulomb's cone of friction μ, but for round-off.
pub(crate) fn obeys_friction<const D: usize>(r: SVector<f64, D>, friction: f64) -> bool {
    is_not_negative(r[0]) && tangential(r).1 <= (1.0 + 1e-9) * friction * r[0] + UNDERFLOW
}

/// Description of the impulses that Coulomb's law admits.
const ADMISSIBLE: &str =
    "finite, with a normal part that is not negative and a tangential part of at most μ times it";

impl Touch<RoughDiscs> for RoughContact {
    const ADMISSIBLE: &'static str = ADMISSIBLE;

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> Vector2<f64> {
        self.normal
    }

    fn offset(&self) -> Vector2<f64> {
        self.offset
    }

    #[inline]
    fn relative(&self, velocity: &[Vector3<f64>]) -> Vector2<f64> {
        self.of_grains(velocity[self.candidate as usize], self.antagonist.map(|j| velocity[j as usize]))
    }

    #[inline]
    fn push(&self, r: Vector2<f64>, resultant: &mut [Vector3<f64>]) {
        let [i, j] = self.at_ends(r);
        resultant[self.candidate as usize] += i;
        if let Some(antagonist) = self.antagonist {
            resultant[antagonist as usize] += j;
        }
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> RoughMass) -> Vector2<f64> {
        let of = |grain: u32, arm: f64| {
            let RoughMass { mass, inertia } = inverse_mass(grain);
            Vector2::new(mass, mass + arm * arm * inertia)
        };
        let candidate = of(self.candidate, self.arms.x);
        self.antagonist.map_or(candidate, |j| candidate + of(j, self.arms.y))
    }

    fn is_admissible(&self, r: Vector2<f64>) -> bool {
        obeys_friction(r, self.friction)
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        self.fault_of()
    }
}

impl<const D: usize> RoughContact<D> {
    /// Returns the fault of the law's own numbers, if any.
    fn fault_of(&self) -> Option<(&'static str, f64, &'static str)> {
        let arm = self.arms.iter().copied().find(|arm| !is_not_negative(*arm));
        let friction = (!is_not_negative(self.friction)).then_some(("contacts.friction", self.friction));
        let (key, value) = arm.map(|arm| ("grains.radius", arm)).or(friction)?;
        Some((key, value, "finite and not negative"))
    }
}

impl ContactProblem<RoughDiscs> {
    /// Returns the same grains and contacts without friction.
    ///
    /// # Errors
    /// None: what is left was valid before.
    pub fn without_friction(&self) -> Result<ContactProblem<Discs>, ProblemError> {
        let contact = |at: &RoughContact| Contact {
            candidate: at.candidate,
            antagonist: at.antagonist,
            normal: at.normal,
            offset: at.offset.first(),
        };
        ContactProblem::new(
            self.mass().iter().map(|mass| mass.mass).collect(),
            self.free_velocity().iter().map(Vector3::xy).collect(),
            self.contacts().iter().map(contact).collect(),
        )
    }
}
