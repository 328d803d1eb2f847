//! Energy balance of a time step.
//!
//! M (V⁺ − V⁻) = h M g + H r, multiplied by the mean velocity, is the balance of the θ-scheme with θ = ½, exactly:
//!
//! ½ V⁺ᵗ M V⁺ − ½ V⁻ᵗ M V⁻ = gravity's work + ½ rᵗ Hᵗ (V⁺ + V⁻)
//!
//! The contacts' work, the last term, has four parts. With c = `c_w` + `c_g` + `c_e`, of the walls' motion, of the law's gap term and of
//! its rebound e v⁻, and v± = Hᵗ V± + `c_w` + `c_g`:
//!
//! - walls: −r · `c_w`, what their motion gives or takes
//! - gap: −½ `r_n` `c_g`, what a gap that closes within the time step takes before its contact does
//! - shocks: ½ `r_n` (`v_n⁺` + `v_n⁻`), where `v_n⁺` is 0, or −e `v_n⁻`, but for what the solver leaves. At a curved wall `c_g` is what
//!   the wall turns towards the grain: of a grain that slides along it, the gap gives back what the shock against the chord takes
//! - sliding: ½ `r_t` (`v_t⁺` + `v_t⁻`), which is friction's

use crate::problem::marched::{Marched, translation};
use crate::problem::time_step::{Terms, TimeStep};
use crate::scene::Scene;
use contact::{Mass, Touch, Vector, number};
use serde::{Deserialize, Serialize};

/// Energy of a time step, or of several (J), with its columns in results. What gives energy to the grains is positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Energy {
    /// Work of the walls' motion, and of the forces on a lid and on driven segments.
    #[serde(rename = "walls_work_j", with = "number")]
    pub walls: f64,
    /// Work of the law's gap term.
    #[serde(rename = "gap_work_j", with = "number")]
    pub gap: f64,
    /// Work of shocks: negative.
    #[serde(rename = "shock_work_j", with = "number")]
    pub shocks: f64,
    /// Work of friction.
    #[serde(rename = "sliding_work_j", with = "number")]
    pub sliding: f64,
    /// Sum of all that changed hands: the sizes of the four, of the change of kinetic and of that of potential energy.
    #[serde(rename = "energy_moved_j", with = "number")]
    pub moved: f64,
    /// Size of what the balance leaves over: round-off where θ = ½, what the scheme itself takes or gives elsewhere.
    #[serde(rename = "energy_left_over_j", with = "number")]
    pub left_over: f64,
}

contact::added!(Energy: walls, gap, shocks, sliding, moved, left_over);

impl Energy {
    /// Computes the energy balance of a time step of a scene with the impulses `r` (N·s), between the velocities before and after
    /// it.
    pub(crate) fn of<M: Marched>(
        time_step: &TimeStep<M>,
        scene: &Scene,
        (before, after): (&[M::Velocity], &[M::Velocity]),
        r: &[f64],
    ) -> Self {
        let Scene { time_step_s: h, theta, .. } = *scene;
        let problem = &time_step.frozen.problem;
        let mean: Vec<M::Velocity> =
            before.iter().zip(after).map(|(before, after)| (*before + *after) * 0.5).collect();
        let mut energy = Self::default();
        for (k, (contact, own)) in problem.contacts().iter().zip(time_step.terms()).enumerate() {
            let (r, c) = (M::Impulse::at(r, k), contact.offset());
            let Terms { gap: c_g, rebound: c_e } = *own;
            let normal = r.first();
            let v = contact.relative(&mean) + c;
            let of_normal = normal * v.first();
            energy.walls += normal * (c_g + c_e) - r.dot_product(c);
            energy.gap -= 0.5 * normal * c_g;
            energy.shocks += of_normal - normal * c_e - 0.5 * normal * c_g;
            energy.sliding += r.dot_product(v) - of_normal;
        }
        let gravity = scene.gravity::<M::Place>();
        let (mut kinetic, mut potential) = (0.0, 0.0);
        for ((before, after), mass) in before.iter().zip(after).zip(problem.mass()) {
            kinetic += 0.5 * (mass.squared(*after) - mass.squared(*before));
            // As far as it moves.
            let moved = translation::<M>(*before * (1.0 - theta) + *after * theta) * h;
            potential += M::weight(*mass) * gravity.dot_product(moved);
        }
        let forces = scene.forces::<M::Place>();
        let bodies = before.len() - forces.len()..;
        for ((_, force), (before, after)) in
            forces.iter().zip(before[bodies.clone()].iter().zip(&after[bodies]))
        {
            let moved = translation::<M>(*before * (1.0 - theta) + *after * theta) * h;
            energy.walls += force.dot_product(moved);
        }
        let parts = [energy.walls, energy.gap, energy.shocks, energy.sliding];
        let changes = [kinetic, potential];
        energy.moved = parts.iter().chain(&changes).map(|part| part.abs()).sum();
        energy.left_over = (kinetic + potential - parts.iter().sum::<f64>()).abs();
        energy
    }
}
