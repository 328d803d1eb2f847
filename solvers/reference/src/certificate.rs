//! The certificate of a solution: what impulses leave of the contact problem, recomputed from the problem alone. One for all
//! mechanics: without friction there is no tangential part.

use contact::{
    Column, ContactProblem, Frictional, Mass, Mechanics, Rough, RoughMass, Smooth, Touch, Vector, greatest,
    law,
};
use nalgebra::SVector;
use serde::Serialize;
use std::fmt;

/// Residual of a condition, as it is and over the problem's own scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// In the unit of the condition.
    pub absolute: f64,
    /// Over the scale of the certificate's documentation (–).
    pub relative: f64,
}

impl Residual {
    /// 0 over a scale of 0 is 0.
    fn new(absolute: f64, scale: f64) -> Self {
        Self { absolute, relative: if absolute == 0.0 { 0.0 } else { absolute / scale } }
    }
}

/// Residuals of impulses r in (1) and the law, (2) or (2′). V = `V_free` + M⁻¹ H r and v = Hᵗ V + c are computed from r and the problem,
/// and what is left of the law in the form that does not cancel, however large r is: min(`w_n` `r_n`, `v_n`) along the normal.
///
/// The scale of velocities is v₀ = max(0, −`b_n`), at its greatest: the fastest approach without impulses; that of impulses is
/// max(0, −`b_n`)/`w_n`, at its greatest: what one contact needs to stop it. Where no contact pushes both are 0, and r = 0 alone
/// has a certificate. No residual is asked to be smaller than the round-off of the terms that add up to it: where 1/256 of
/// their sizes, at that contact or grain, is above the scale, it takes its place, so that what a certificate of 1e-12
/// allows is never below 16 units of their last digits. Otherwise a light grain between heavy ones, or one that is squeezed out
/// of a narrow wedge, could not have any; how far such impulses determine the motion is for `natural_map` to say.
///
/// There is an end to this: huge impulses make anything round-off. No scale of a velocity is above 1e5 v₀, or 1e-1 of the contact's
/// own speeds |c| + |`V_free`|, if that is more. So what is certified is no faster than 1e-7 v₀ where it should be at rest.
///
/// Without friction, the error in V that is left is about the residuals times the condition of the closed contacts. Guaranteed is,
/// for any solution r*, no more than its square: ‖V − V*‖²_M ≤ rᵗ max(0, v) + r*ᵗ max(0, −v).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// Greatest max(0, −`v_n`): the approach that is left (m/s).
    pub approach: Residual,
    /// Greatest max(0, −`r_n`): the pull that is left, over the scale of impulses (N·s).
    pub pull: Residual,
    /// With friction, greatest max(0, |`r_t`| − μ `r_n`): how far outside the cone (N·s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cone: Option<Residual>,
    /// Greatest |min(`w_n` `r_n`, `v_n`)| (m/s).
    pub complementarity: Residual,
    /// With friction, greatest `w_t` |`r_t` − clip(`r_t` − `v_t`/`w_t`, μ `r_n`)|: what sticks and moves, or slides against too little
    /// (m/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sliding: Option<Residual>,
    /// Greatest component of M (V − `V_free`) − H r, moments over the arms, over the scale of impulses (N·s).
    pub momentum: Residual,
    /// Without friction, |½ ‖V − `V_free`‖²_M + q(r)| = |rᵗ v|: the programme in V minus the one in r, over ½ ‖V − `V_free`‖²_M, or
    /// 1/256 of the root of the sum of squares of its terms (J). Where no impulse acts the scale is 0, and so is the gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duality_gap: Option<Residual>,
    /// √(Σ `W_αα` |r − r⁺|²) over √(Σ max(0, −`b_n`)²/`w_n`), or 1e-6 of the same of the terms of b: all that is left, weighed as
    /// energy (√J).
    pub natural_map: Residual,
}

/// Largest residual of each condition in a certified solution (–): some thousand units of round-off.
pub const ROUND_OFF: f64 = 1e-12;

/// Largest residual of all of them together, weighed as energy (–). The rest of each condition may be round-off of greater
/// terms; this is not, and above it impulses in double precision say too little of the motion to be called its solution.
pub const ENERGY_ROUND_OFF: f64 = 1e-8;

/// The share of the speeds of a problem below which the scale of `natural_map` is not (–): a slower approach is round-off.
const APPROACH: f64 = 1e-6;

/// The share of v₀ above which no velocity is round-off (–): of 256 random chains of grains with a solution one keeps 2e-8.
const SLOW: f64 = 1e-7;

/// The share of the terms of a residual below which no scale is (–): 1e-12 of it are 16 units of round-off.
const TERMS: f64 = 1.0 / 256.0;

impl Certificate {
    /// Names and residuals of the conditions that the mechanics has.
    pub fn residuals(&self) -> impl Iterator<Item = (&'static str, Residual)> {
        let all = [
            ("approach", Some(self.approach)),
            ("pull", Some(self.pull)),
            ("cone", self.cone),
            ("complementarity", Some(self.complementarity)),
            ("sliding", self.sliding),
            ("momentum", Some(self.momentum)),
            ("duality_gap", self.duality_gap),
            ("natural_map", Some(self.natural_map)),
        ];
        all.into_iter().filter_map(|(name, residual)| Some((name, residual?)))
    }

    /// Reports whether every condition holds to [`ROUND_OFF`], and all together to [`ENERGY_ROUND_OFF`].
    pub fn certified(&self) -> bool {
        self.worst() <= ROUND_OFF && self.natural_map.relative <= ENERGY_ROUND_OFF
    }

    /// The greatest relative residual of a condition (–); NaN if one is.
    pub fn worst(&self) -> f64 {
        let conditions = self.residuals().filter(|(name, _)| *name != "natural_map");
        greatest(conditions.map(|(_, left)| left.relative))
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.certified() { "certified" } else { "not certified" })?;
        for (name, residual) in self.residuals() {
            write!(f, ", {name} {:.1e}", residual.relative)?;
        }
        Ok(())
    }
}

/// A mechanics whose solutions are certified.
pub trait Certified: Mechanics {
    /// Translation and spin, if there is one, of a velocity (m/s, rad/s) or of a resultant (N·s, N·m·s).
    fn parts(velocity: &Self::Velocity) -> (&[f64], &[f64]);

    /// m (kg) and the moment of inertia (kg m²), if there is one.
    fn mass(mass: Self::Mass) -> RoughMass;
}

impl<const D: usize> Certified for Smooth<D> {
    fn parts(velocity: &SVector<f64, D>) -> (&[f64], &[f64]) {
        (velocity.as_slice(), &[])
    }

    fn mass(mass: f64) -> RoughMass {
        RoughMass { mass, inertia: 0.0 }
    }
}

impl<const D: usize, const N: usize> Certified for Rough<D>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    fn parts(velocity: &SVector<f64, N>) -> (&[f64], &[f64]) {
        velocity.as_slice().split_at(D)
    }

    fn mass(mass: RoughMass) -> RoughMass {
        mass
    }
}

/// The sizes of the terms that velocities are sums of: a residual may be 16 units of their last digits.
struct Terms {
    /// v₀ (m/s).
    speed: f64,
    /// Impulse that stops v₀ at one contact (N·s).
    impulse: f64,
    /// Σ |r| of the contacts around each grain (N·s), and the least arm of these (m).
    pushes: Vec<f64>,
    arms: Vec<f64>,
}

impl Terms {
    fn new<M: Certified>(problem: &ContactProblem<M>, r: &[f64], w: &[f64]) -> Self {
        let b = problem.b();
        let approaches = || b.iter().zip(w).step_by(M::Impulse::LEN).map(|(b, w)| (law::non_negative(-b), w));
        let grains = problem.grain_count();
        let (mut pushes, mut arms) = (vec![0.0; grains], vec![f64::INFINITY; grains]);
        for (k, contact) in problem.contacts().iter().enumerate() {
            let own = M::Impulse::at(r, k);
            for (grain, arm) in contact.grains().zip(contact.arms().iter()) {
                pushes[grain as usize] += own.dot_product(own).sqrt();
                arms[grain as usize] = arm.min(arms[grain as usize]);
            }
        }
        Self {
            speed: greatest(approaches().map(|(b, _)| b)),
            impulse: greatest(approaches().map(|(b, w)| b / w)),
            pushes,
            arms,
        }
    }

    /// Returns the sum of the terms of b at a contact (m/s).
    fn of_b<M: Certified>(problem: &ContactProblem<M>, contact: &M::Contact) -> f64 {
        let free = contact.grains().map(|grain| speed::<M>(&problem.free_velocity()[grain as usize]));
        greatest_of(contact.offset()) + free.sum::<f64>()
    }

    /// Returns the sum of the terms of v at a contact (m/s).
    fn of_v<M: Certified>(&self, problem: &ContactProblem<M>, contact: &M::Contact) -> f64 {
        let pushed = |grain: u32| self.pushes[grain as usize] / M::mass(problem.mass()[grain as usize]).mass;
        Self::of_b(problem, contact) + contact.grains().map(pushed).sum::<f64>()
    }

    /// The scale of velocities at a contact (m/s).
    fn scale<M: Certified>(&self, problem: &ContactProblem<M>, contact: &M::Contact) -> f64 {
        let own = self.speed.max(APPROACH * Self::of_b(problem, contact));
        self.speed.max((TERMS * self.of_v(problem, contact)).min(SLOW / ROUND_OFF * own))
    }
}

/// The greatest component of a translation.
fn speed<M: Certified>(velocity: &M::Velocity) -> f64 {
    greatest(M::parts(velocity).0.iter().map(|x| x.abs()))
}

/// The greatest size of a component.
fn greatest_of<V: Vector>(list: V) -> f64 {
    greatest(list.components().map(f64::abs))
}

/// The size of all components but the first, the normal one.
fn tangential<V: Vector>(list: V) -> f64 {
    f64::sqrt(list.components().skip(1).fold(0.0, |squares, x| squares + x * x))
}

/// Returns the residual of M (V − `V_free`) = H r at each grain.
fn momentum<M: Certified>(
    problem: &ContactProblem<M>,
    r: &[f64],
    velocity: &[M::Velocity],
    terms: &Terms,
) -> Residual {
    let mut resultant = vec![M::Velocity::ZERO; problem.grain_count()];
    problem.resultant(r, &mut resultant);
    worst((0..velocity.len()).map(|k| {
        let (RoughMass { mass, inertia }, free) = (M::mass(problem.mass()[k]), &problem.free_velocity()[k]);
        let sizes = mass * (speed::<M>(&velocity[k]) + speed::<M>(free)) + terms.pushes[k];
        let change = velocity[k] - *free;
        let ((translation, spin), (pushed, turned)) = (M::parts(&change), M::parts(&resultant[k]));
        let left = |inertia: f64, (change, pushed): (&f64, &f64)| (change * inertia - pushed).abs();
        let pushing = translation.iter().zip(pushed).map(|at| left(mass, at));
        let turning = spin.iter().zip(turned).map(|at| left(inertia, at) / terms.arms[k]);
        Residual::new(greatest(pushing.chain(turning)), terms.impulse.max(TERMS * sizes))
    }))
}

/// The certificate of impulses `r` (N·s), a flat list.
///
/// # Panics
/// If there are not as many numbers per contact as it has unknowns.
pub fn certify<M: Certified>(problem: &ContactProblem<M>, r: &[f64]) -> Certificate {
    assert_eq!(r.len(), problem.impulse_count(), "as many impulses per contact as it has unknowns");
    let w = problem.delassus_diagonal();
    let (mut velocity, mut v) = (vec![M::Velocity::ZERO; problem.grain_count()], vec![0.0; r.len()]);
    problem.velocity(r, &mut velocity);
    problem.relative_velocity(&velocity, &mut v);
    let terms = Terms::new(problem, r, &w);
    let contacts = || {
        let at = |(k, contact)| (contact, M::Impulse::at(r, k), M::Impulse::at(&v, k));
        problem.contacts().iter().enumerate().map(at)
    };
    let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
    // √W_αα (r − r⁺) (√J), its scale √W_αα, and the scale of velocities.
    let left: Vec<(M::Impulse, M::Impulse, f64)> = contacts()
        .map(|(contact, r, v)| {
            let (column, unit) = M::Column::new(contact, contact.ends(), inverse_mass, true);
            let left = column.residual(r.with(unit, |r, unit| r * unit), v.with(unit, |v, unit| v / unit));
            (left, unit, terms.scale(problem, contact))
        })
        .collect();
    // W_αα (r − r⁺) (m/s).
    let speeds =
        || left.iter().map(|(left, unit, scale)| (left.with(*unit, |left, unit| left * unit), *scale));
    let squares: f64 = left.iter().map(|(left, ..)| left.dot_product(*left)).sum();
    let of_b = problem.contacts().iter().zip(w.iter().step_by(M::Impulse::LEN));
    let of_b = of_b.map(|(contact, w)| Terms::of_b(problem, contact).powi(2) / w).sum::<f64>();
    let approaches = contacts().zip(&left);
    let cone = contacts().map(|(contact, r, _)| {
        let bound = contact.friction() * law::non_negative(r.first());
        Residual::new(law::non_negative(tangential(r) - bound), terms.impulse.max(TERMS * bound))
    });
    let is_rough = M::HAS_FRICTION;
    Certificate {
        approach: worst(
            approaches.map(|((.., v), (.., scale))| Residual::new(law::non_negative(-v.first()), *scale)),
        ),
        pull: worst(contacts().map(|(_, r, _)| Residual::new(law::non_negative(-r.first()), terms.impulse))),
        cone: is_rough.then(|| worst(cone)),
        complementarity: worst(speeds().map(|(left, scale)| Residual::new(left.first().abs(), scale))),
        sliding: is_rough
            .then(|| worst(speeds().map(|(left, scale)| Residual::new(tangential(left), scale)))),
        momentum: momentum(problem, r, &velocity, &terms),
        duality_gap: (!is_rough).then(|| {
            let gap = contacts().map(|(_, r, v)| r.dot_product(v)).sum::<f64>();
            let sizes = contacts().map(|(contact, r, _)| (r.first() * terms.of_v(problem, contact)).powi(2));
            let distance = problem.velocity_distance(&velocity, problem.free_velocity());
            Residual::new(gap.abs(), f64::max(0.5 * distance * distance, TERMS * sizes.sum::<f64>().sqrt()))
        }),
        natural_map: Residual::new(
            squares.sqrt(),
            f64::max(problem.scale(), APPROACH * APPROACH * of_b).sqrt(),
        ),
    }
}

/// The residual that is greatest relative to its scale; one that is NaN, if there is one.
fn worst(residuals: impl Iterator<Item = Residual>) -> Residual {
    residuals.fold(Residual::new(0.0, 1.0), |worst, residual| {
        if worst.relative.is_nan() || residual.relative <= worst.relative { worst } else { residual }
    })
}
