//! The certificate of a solution: what impulses leave of (1)-(2), recomputed from the problem alone.

use contact::{Contact, ContactProblem, Smooth, greatest, law};
use nalgebra::SVector;
use serde::Serialize;
use std::fmt;

/// What is left of a condition, as it is and over the problem's own scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// In the unit of the condition.
    pub absolute: f64,
    /// Over the scale of the certificate's documentation (–).
    pub relative: f64,
}

impl Residual {
    /// 0 over a scale of 0 is 0.
    pub(crate) fn new(absolute: f64, scale: f64) -> Self {
        Self { absolute, relative: if absolute == 0.0 { 0.0 } else { absolute / scale } }
    }
}

/// What impulses r leave of (1)-(2). V = `V_free` + M⁻¹ H r and v = Hᵗ V + c are computed from r and the problem.
///
/// The scale of velocities is v₀ = max(0, −b), at its greatest: the fastest approach without impulses; that of impulses is
/// max(0, −b)/`W_αα`, at its greatest: what one contact needs to stop it. Where no contact pushes both are 0, and r = 0 alone
/// has a certificate. No residual is asked to be smaller than the round-off of the terms that add up to it: where 1/256 of
/// their sizes, at that contact or grain, is above the scale, it takes its place, so that what a certificate of 1e-12
/// allows is never below 16 units of their last digits. Otherwise a light grain between heavy ones, or one that is squeezed out
/// of a narrow wedge, could not have any; how far such impulses determine the motion is for `natural_map` to say.
///
/// The error in V that is left is about the residuals times the condition of the closed contacts. Guaranteed is, for any
/// solution r*, no more than its square: ‖V − V*‖²_M ≤ rᵗ max(0, v) + r*ᵗ max(0, −v).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// Greatest max(0, −v): the approach that is left, over v₀ (m/s).
    pub approach: Residual,
    /// Greatest max(0, −r): the pull that is left, over the scale of impulses (N·s).
    pub pull: Residual,
    /// Greatest |min(`W_αα` r, v)|, over v₀ (m/s).
    pub complementarity: Residual,
    /// Greatest component of M (V − `V_free`) − H r, over the scale of impulses (N·s).
    pub momentum: Residual,
    /// |½ ‖V − `V_free`‖²_M + q(r)| = |rᵗ v|: the programme in V minus the one in r, over ½ ‖V − `V_free`‖²_M, or 1/256 of the
    /// root of the sum of squares of its terms (J). Where no impulse acts the scale is 0, and so is the gap.
    pub duality_gap: Residual,
    /// √(Σ `W_αα` (r − max(0, r − v/`W_αα`))²) over √(Σ max(0, −b)²/`W_αα`), or 1e-6 of the same of the terms of b: all that is
    /// left, weighed as energy (√J).
    pub natural_map: Residual,
}

/// What a certified solution may leave of each condition (–): some thousand units of round-off.
pub const ROUND_OFF: f64 = 1e-12;

/// What it may leave of all of them together, weighed as energy (–). The rest of each condition may be round-off of greater
/// terms; this is not, and above it impulses in double precision say too little of the motion to be called its solution.
pub const ENERGY_ROUND_OFF: f64 = 1e-8;

/// The share of the speeds of a problem below which the scale of `natural_map` is not (–): a slower approach is round-off.
const APPROACH: f64 = 1e-6;

/// The share of the terms of a residual below which no scale is (–): 1e-12 of it are 16 units of round-off.
pub(crate) const TERMS: f64 = 1.0 / 256.0;

impl Certificate {
    /// Names and residuals.
    pub fn residuals(&self) -> [(&'static str, Residual); 6] {
        [
            ("approach", self.approach),
            ("pull", self.pull),
            ("complementarity", self.complementarity),
            ("momentum", self.momentum),
            ("duality_gap", self.duality_gap),
            ("natural_map", self.natural_map),
        ]
    }

    /// Whether every condition holds to [`ROUND_OFF`], and all together to [`ENERGY_ROUND_OFF`].
    pub fn certified(&self) -> bool {
        self.worst() <= ROUND_OFF && self.natural_map.relative <= ENERGY_ROUND_OFF
    }

    /// The greatest relative residual of a condition (–); NaN if one is.
    pub fn worst(&self) -> f64 {
        let conditions = self.residuals().into_iter().filter(|(name, _)| *name != "natural_map");
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

/// The certificate of impulses `r` (N·s).
///
/// # Panics
/// If there is not one impulse per contact.
pub fn certify<const D: usize>(problem: &ContactProblem<Smooth<D>>, r: &[f64]) -> Certificate {
    assert_eq!(r.len(), problem.contact_count(), "one impulse per contact");
    let (b, w) = (problem.b(), problem.delassus_diagonal());
    let (mut velocity, mut resultant) =
        (vec![SVector::zeros(); problem.grain_count()], vec![SVector::zeros(); problem.grain_count()]);
    problem.velocity(r, &mut velocity);
    problem.resultant(r, &mut resultant);
    let mut v = vec![0.0; r.len()];
    problem.relative_velocity(&velocity, &mut v);

    let speed = greatest(b.iter().map(|b| law::non_negative(-b)));
    let impulse = greatest(b.iter().zip(&w).map(|(b, w)| law::non_negative(-b) / w));
    let distance = problem.velocity_distance(&velocity, problem.free_velocity());
    let pushes = term_sizes(problem, r);
    // Σ |n| |r|/m at a grain and its |V_free|, and those of a contact's grains with its |c|: the terms of V and of v.
    let of_velocity =
        |grain: usize| pushes[grain] / problem.mass()[grain] + problem.free_velocity()[grain].amax();
    let of_contact = |contact: &Contact<D>| {
        contact.offset.abs() + contact.grains().map(|grain| of_velocity(grain as usize)).sum::<f64>()
    };
    let speeds: Vec<f64> =
        problem.contacts().iter().map(|contact| speed.max(TERMS * of_contact(contact))).collect();
    let momentum = (0..velocity.len()).map(|grain| {
        let (v, free, m) = (velocity[grain], problem.free_velocity()[grain], problem.mass()[grain]);
        let terms = m * (v.amax() + free.amax()) + pushes[grain];
        Residual::new(((v - free) * m - resultant[grain]).amax(), impulse.max(TERMS * terms))
    });
    let contacts = || r.iter().zip(&v).zip(w.iter().zip(&speeds));
    let approach = contacts().map(|((_, v), (_, speed))| Residual::new(law::non_negative(-v), *speed));
    let complementarity =
        contacts().map(|((r, v), (w, speed))| Residual::new(least(w * r, *v).abs(), *speed));
    let left = contacts().map(|((r, v), (w, _))| least(w * r, *v).powi(2) / w).sum::<f64>();
    let gap = r.iter().zip(&v).map(|(r, v)| r * v).sum::<f64>();
    let gap_terms = r.iter().zip(problem.contacts()).map(|(r, contact)| (r * of_contact(contact)).powi(2));
    let energy = f64::max(0.5 * distance * distance, TERMS * gap_terms.sum::<f64>().sqrt());
    let terms = |contact: &Contact<D>| {
        let free = contact.grains().map(|grain| problem.free_velocity()[grain as usize].amax());
        contact.offset.abs() + free.sum::<f64>()
    };
    let terms = problem.contacts().iter().zip(&w).map(|(contact, w)| terms(contact).powi(2) / w);
    let scale = f64::max(problem.scale(), APPROACH * APPROACH * terms.sum::<f64>()).sqrt();
    Certificate {
        approach: worst(approach),
        pull: Residual::new(greatest(r.iter().map(|r| law::non_negative(-r))), impulse),
        complementarity: worst(complementarity),
        momentum: worst(momentum),
        duality_gap: Residual::new(gap.abs(), energy),
        natural_map: Residual::new(left.sqrt(), scale),
    }
}

/// Σ |n r| of the contacts around each grain (N·s).
fn term_sizes<const D: usize>(problem: &ContactProblem<Smooth<D>>, r: &[f64]) -> Vec<f64> {
    let mut sizes = vec![0.0; problem.grain_count()];
    for (contact, r) in problem.contacts().iter().zip(r) {
        contact.grains().for_each(|grain| sizes[grain as usize] += r.abs());
    }
    sizes
}

/// The residual that is greatest relative to its scale; one that is NaN, if there is one.
pub(crate) fn worst(residuals: impl Iterator<Item = Residual>) -> Residual {
    residuals.fold(Residual::new(0.0, 1.0), |worst, residual| {
        if worst.relative.is_nan() || residual.relative <= worst.relative { worst } else { residual }
    })
}

/// The lesser value; NaN if there is one.
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a <= b { a } else { b }
}
