//! Proof, by a velocity, that a problem with friction has a solution.
//!
//! Where some V has `v_n` ≥ μ|`v_t`| at every contact, v = Hᵗ V + c, there is a solution. Where none has, there may be one all the same.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175.

use active_set::Conic;
use contact::{Frictional, Mechanics, Packing, Rough, Touch, greatest, law};
use nalgebra::SVector;

/// Reason why a problem with friction is known to have a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existence {
    /// Rest: no wall drives a contact, and no gap is negative.
    AtRest,
    /// With a velocity that a linear programme has.
    Moving,
}

/// Margin required of the velocity, over the fastest approach without impulses (–): far more than round-off, and than an interior
/// point leaves.
const MARGIN: f64 = 1e-4;

/// Returns the reason why `problem` is known to have a solution; `None` where no velocity was found that says so.
pub fn existence<const D: usize, const N: usize>(problem: &Packing<Rough<D>>) -> Option<Existence>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    let room = |velocity: &[SVector<f64, N>]| {
        let of = |contact: &<Rough<D> as Mechanics>::Contact| {
            let v = contact.relative(velocity) + contact.offset();
            v[0] - contact.friction * law::tangential(v).1
        };
        problem.contacts().iter().map(of).fold(f64::INFINITY, f64::min)
    };
    let mut velocity = vec![SVector::zeros(); problem.grain_count()];
    if room(&velocity) >= 0.0 {
        return Some(Existence::AtRest);
    }
    let approach = problem.b().into_iter().step_by(D).map(|b| law::non_negative(-b));
    let margin = MARGIN * greatest(approach);
    let mut convex = Conic::relaxation(problem).ok()?;
    convex.ask_for(margin);
    convex.advance();
    let mut r = vec![0.0; problem.impulse_count()];
    convex.impulses(&mut r);
    problem.velocity(&r, &mut velocity);
    (room(&velocity) > 0.5 * margin).then_some(Existence::Moving)
}
