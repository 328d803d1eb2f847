//! The certificate of a solution: what impulses leave of (1)-(2), recomputed from the problem alone.

use contact::{ContactProblem, law};
use nalgebra::Vector2;
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
    fn new(absolute: f64, scale: f64) -> Self {
        Self { absolute, relative: if absolute == 0.0 { 0.0 } else { absolute / scale } }
    }
}

/// What impulses r leave of (1)-(2). V = `V_free` + M⁻¹ H r and v = Hᵗ V + c are computed from r and the problem.
///
/// The scales depend on the problem alone. That of velocities is v₀ = max(0, −b), at its greatest: the fastest approach
/// without impulses; that of impulses is max(0, −b)/`W_αα`, at its greatest: what one contact needs to stop it. Where no
/// contact pushes both are 0, and r = 0 alone has a certificate.
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
    /// |½ ‖V − `V_free`‖²_M + q(r)| = |rᵗ v|: the programme in V minus the one in r, over ½ ‖V − `V_free`‖²_M (J). Where no
    /// impulse acts the scale is 0, and so is the gap.
    pub duality_gap: Residual,
}

/// What a certified solution may leave of each condition (–): some thousand units of round-off.
pub const ROUND_OFF: f64 = 1e-12;

impl Certificate {
    /// Names and residuals.
    pub fn residuals(&self) -> [(&'static str, Residual); 5] {
        [
            ("approach", self.approach),
            ("pull", self.pull),
            ("complementarity", self.complementarity),
            ("momentum", self.momentum),
            ("duality_gap", self.duality_gap),
        ]
    }

    /// Whether every condition holds to [`ROUND_OFF`].
    pub fn certified(&self) -> bool {
        self.worst() <= ROUND_OFF
    }

    /// The greatest relative residual (–); NaN if one is.
    pub fn worst(&self) -> f64 {
        greatest(self.residuals().into_iter().map(|(_, residual)| residual.relative))
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
pub fn certify(problem: &ContactProblem, r: &[f64]) -> Certificate {
    assert_eq!(r.len(), problem.contact_count(), "one impulse per contact");
    let (b, w) = (problem.b(), problem.delassus_diagonal());
    let (mut velocity, mut resultant) =
        (vec![Vector2::zeros(); problem.grain_count()], vec![Vector2::zeros(); problem.grain_count()]);
    problem.velocity(r, &mut velocity);
    problem.resultant(r, &mut resultant);
    let mut v = vec![0.0; r.len()];
    problem.relative_velocity(&velocity, &mut v);

    let speed = greatest(b.iter().map(|b| law::non_negative(-b)));
    let impulse = greatest(b.iter().zip(&w).map(|(b, w)| law::non_negative(-b) / w));
    let distance = problem.velocity_distance(&velocity, problem.free_velocity());
    let pairs = || r.iter().zip(&v).zip(&w);
    let momentum = velocity.iter().zip(problem.free_velocity()).zip(problem.mass()).zip(&resultant);
    Certificate {
        approach: Residual::new(greatest(v.iter().map(|v| law::non_negative(-v))), speed),
        pull: Residual::new(greatest(r.iter().map(|r| law::non_negative(-r))), impulse),
        complementarity: Residual::new(greatest(pairs().map(|((r, v), w)| least(w * r, *v).abs())), speed),
        momentum: Residual::new(
            greatest(momentum.map(|(((v, free), m), h_r)| ((v - free) * *m - h_r).amax())),
            impulse,
        ),
        duality_gap: Residual::new(
            pairs().map(|((r, v), _)| r * v).sum::<f64>().abs(),
            0.5 * distance * distance,
        ),
    }
}

/// The greatest value; NaN if there is one, 0 for none.
fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |greatest: f64, x| if greatest.is_nan() || x <= greatest { greatest } else { x })
}

/// The lesser value; NaN if there is one.
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a <= b { a } else { b }
}
