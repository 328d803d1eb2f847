//! Discs and spheres with friction: a grain translates and spins, a contact has a normal and one or two tangential unknowns, and
//! Coulomb's law.
//!
//! A contact point lies at `R_i` from the centre of i against the normal, at `R_j` from that of j along it: the two translations enter
//! the relative velocity with opposite signs, the two spins with the same.

mod discs;
mod spheres;

pub use discs::RoughColumn;
pub use spheres::{SphereColumn, frame};

use crate::discs::{Contact, Smooth};
use crate::error::{ProblemError, is_not_negative, is_positive};
use crate::mechanics::{Mass, Mechanics, Touch};
use crate::problem::ContactProblem;
use nalgebra::{SVector, Vector2};

/// Grains with friction, in D dimensions. Velocities are translations, then spins; impulses [`r_n`, `r_t`], in space
/// [`r_n`, `r_t1`, `r_t2`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rough<const D: usize>;

/// Discs with friction.
pub type RoughDiscs = Rough<2>;

/// Spheres with friction.
pub type RoughSpheres = Rough<3>;

/// A mechanics with Coulomb's law in D dimensions.
pub trait Frictional<const D: usize>:
    Mechanics<
        Place = SVector<f64, D>,
        Mass = RoughMass,
        Impulse = SVector<f64, D>,
        Contact = RoughContact<D>,
        Column: Cone,
    >
{
    /// Hᵗ V of one grain of a contact, with its arm (m) and the sign of its translation (m/s).
    fn of_grain(contact: &RoughContact<D>, v: &Self::Velocity, arm: f64, sign: f64) -> SVector<f64, D>;

    /// H r at one grain of a contact, with its arm (m) and the sign of its translation (N·s, N·m·s).
    fn at_grain(contact: &RoughContact<D>, r: SVector<f64, D>, arm: f64, sign: f64) -> Self::Velocity;
}

/// A contact in mass-scaled unknowns whose law is a circular cone.
pub trait Cone {
    /// μ √(`w_t`/`w_n`) (–).
    fn friction(&self) -> f64;
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

    /// Inertia of a component of a velocity, of so many.
    #[inline]
    fn of(self, component: usize, components: usize) -> f64 {
        if component < translations(components) { self.mass } else { self.inertia }
    }
}

impl<const N: usize> Mass<SVector<f64, N>> for RoughMass {
    fn fault(self) -> Option<(&'static str, f64, &'static str)> {
        let is_good = |m: f64| is_positive(m) && m.recip().is_finite();
        let expected = "positive and finite, and so its inverse";
        [("grains.mass", self.mass), ("grains.inertia", self.inertia)]
            .into_iter()
            .find_map(|(key, m)| (!is_good(m)).then_some((key, m, expected)))
    }

    fn inverse(self, times: f64) -> Self {
        self.each(|m| times / m)
    }

    fn root(self) -> Self {
        self.each(f64::sqrt)
    }

    fn times(self, v: SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|k, _| self.of(k, N) * v[k])
    }

    fn divides(self, r: SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|k, _| r[k] / self.of(k, N))
    }

    fn squared(self, v: SVector<f64, N>) -> f64 {
        let [translation, spin] = squares(&v);
        self.mass * translation + self.inertia * spin
    }

    fn speed(self, y: SVector<f64, N>) -> f64 {
        self.mass * squares(&y)[0].sqrt()
    }
}

/// Number of the components of a translation, of the N of a velocity: 2 of 3, 3 of 6.
const fn translations(components: usize) -> usize {
    components.div_ceil(2)
}

/// |V|² and |ω|².
fn squares<const N: usize>(v: &SVector<f64, N>) -> [f64; 2] {
    let (translation, spin) = v.as_slice().split_at(translations(N));
    [translation, spin].map(|part| part.iter().map(|x| x * x).sum())
}

/// One contact α with friction: `v_n` = n · (`V_i` − `V_j`) + `c_n`,
///
/// - in the plane `v_t` = t · (`V_i` − `V_j`) − (`R_i` `ω_i` + `R_j` `ω_j`) + `c_t`, with t = (−`n_y`, `n_x`),
/// - in space `v_t` = Tᵗ (`V_i` − `V_j` − (`R_i` `ω_i` + `R_j` `ω_j`) × n) + `c_t`, with T = [t₁ t₂] of a [`frame`] chosen from n alone, and
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

/// Size below which the norm of an impulse may be wrong, since squares underflow (N·s).
const UNDERFLOW: f64 = 1e-150;

/// Reports whether an impulse r (N·s), its normal part first, is finite and in Coulomb's cone of friction μ, but for round-off.
pub fn obeys_friction(r: &[f64], friction: f64) -> bool {
    let along = r[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
    is_not_negative(r[0]) && along <= (1.0 + 1e-9) * friction * r[0] + UNDERFLOW
}

impl<const D: usize> Touch<Rough<D>> for RoughContact<D>
where
    Rough<D>: Frictional<D>,
{
    const ADMISSIBLE: &'static str =
        "finite, with a normal part that is not negative and a tangential part of at most μ times it";

    fn ends(&self) -> (u32, Option<u32>) {
        (self.candidate, self.antagonist)
    }

    fn between(self, candidate: u32, antagonist: Option<u32>) -> Self {
        Self { candidate, antagonist, ..self }
    }

    fn normal(&self) -> SVector<f64, D> {
        self.normal
    }

    fn offset(&self) -> SVector<f64, D> {
        self.offset
    }

    #[inline]
    fn relative(&self, velocity: &[<Rough<D> as Mechanics>::Velocity]) -> SVector<f64, D> {
        let of = |grain: u32, arm, sign| Rough::of_grain(self, &velocity[grain as usize], arm, sign);
        let candidate = of(self.candidate, self.arms.x, 1.0);
        self.antagonist.map_or(candidate, |j| candidate + of(j, self.arms.y, -1.0))
    }

    #[inline]
    fn push(&self, r: SVector<f64, D>, resultant: &mut [<Rough<D> as Mechanics>::Velocity]) {
        resultant[self.candidate as usize] += Rough::at_grain(self, r, self.arms.x, 1.0);
        if let Some(antagonist) = self.antagonist {
            resultant[antagonist as usize] += Rough::at_grain(self, r, self.arms.y, -1.0);
        }
    }

    fn diagonal(&self, inverse_mass: impl Fn(u32) -> RoughMass) -> SVector<f64, D> {
        let of = |grain: u32, arm: f64| {
            let RoughMass { mass, inertia } = inverse_mass(grain);
            SVector::from_fn(|k, _| if k == 0 { mass } else { mass + arm * arm * inertia })
        };
        let candidate = of(self.candidate, self.arms.x);
        self.antagonist.map_or(candidate, |j| candidate + of(j, self.arms.y))
    }

    fn arms(&self) -> Vector2<f64> {
        self.arms
    }

    fn friction(&self) -> f64 {
        self.friction
    }

    fn is_admissible(&self, r: SVector<f64, D>) -> bool {
        obeys_friction(r.as_slice(), self.friction)
    }

    fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let arm = self.arms.iter().copied().find(|arm| !is_not_negative(*arm));
        let friction = (!is_not_negative(self.friction)).then_some(("contacts.friction", self.friction));
        let (key, value) = arm.map(|arm| ("grains.radius", arm)).or(friction)?;
        Some((key, value, "finite and not negative"))
    }
}

impl<const D: usize, const N: usize> ContactProblem<Rough<D>>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Returns the same grains and contacts without friction.
    ///
    /// # Errors
    /// None: what is left was valid before.
    pub fn without_friction(&self) -> Result<ContactProblem<Smooth<D>>, ProblemError> {
        let contact = |at: &RoughContact<D>| Contact {
            candidate: at.candidate,
            antagonist: at.antagonist,
            normal: at.normal,
            offset: at.offset[0],
        };
        ContactProblem::new(
            self.mass().iter().map(|mass| mass.mass).collect(),
            self.free_velocity().iter().map(|v| SVector::from_fn(|k, _| v[k])).collect(),
            self.contacts().iter().map(contact).collect(),
        )
    }
}
