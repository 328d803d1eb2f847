//! A problem as M V = H r + f, v = Hᵗ V + w.

use crate::form::Form;
use contact::{Mass, Packing, Place, Touch, Vector, frame};

/// A matrix by its entries: row, column, value.
pub struct Triplets {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Entries; those of one place are added up.
    pub entries: Vec<(usize, usize, f64)>,
}

/// A contact problem with the bodies in it.
pub struct Global {
    /// M (kg, kg m²).
    pub mass: Triplets,
    /// H (–, m).
    pub h: Triplets,
    /// M `V_free` (N·s).
    pub f: Vec<f64>,
    /// Relative velocity at V = 0 (m/s).
    pub w: Vec<f64>,
    /// μ of each contact (–).
    pub friction: Vec<f64>,
}

/// The arrays of a problem; contacts without friction get tangents with μ = 0.
pub(crate) fn arrays<M: Form>(problem: &Packing<M>) -> Global {
    const { assert!(M::Impulse::LEN == 1 || M::Impulse::LEN == M::Place::LEN, "a row for each direction") };
    let (size, d) = (M::Velocity::LEN, M::Place::LEN);
    let unit = |k: usize| {
        let list: Vec<f64> = (0..size).map(|other| f64::from(u8::from(other == k))).collect();
        M::Velocity::at(&list, 0)
    };
    let units: Vec<M::Velocity> = (0..size).map(unit).collect();
    let numbers = |velocity: M::Velocity| velocity.components().collect::<Vec<_>>();
    let bodies = problem.grain_count();
    let mut mass = Triplets { rows: size * bodies, columns: size * bodies, entries: Vec::new() };
    let mut f = Vec::new();
    for (grain, (m, free)) in problem.mass().iter().zip(problem.free_velocity()).enumerate() {
        for (k, unit) in units.iter().enumerate() {
            mass.entries.push((size * grain + k, size * grain + k, numbers(m.times(*unit))[k]));
        }
        f.extend(numbers(m.times(*free)));
    }
    let mut h = Triplets { rows: size * bodies, columns: d * problem.contact_count(), entries: Vec::new() };
    let (mut w, mut friction) = (Vec::new(), Vec::new());
    let mut velocity = vec![M::Velocity::ZERO; bodies];
    for (at, contact) in problem.contacts().iter().enumerate() {
        let (candidate, antagonist) = contact.ends();
        let across = if M::Impulse::LEN == 1 { tangents(contact.normal()) } else { Vec::new() };
        for (sign, grain) in [(1.0, Some(candidate)), (-1.0, antagonist)] {
            let Some(grain) = grain.map(|grain| grain as usize) else { continue };
            for (k, unit) in units.iter().enumerate() {
                velocity[grain] = *unit;
                let mut along = vec![0.0; M::Impulse::LEN];
                contact.relative(&velocity).put(&mut along, 0);
                // Where there is a spin there are no tangents to be added.
                along.extend(across.iter().map(|tangent| sign * tangent[k]));
                let entries = along.iter().enumerate().filter(|(_, x)| **x != 0.0);
                h.entries.extend(entries.map(|(row, x)| (size * grain + k, d * at + row, *x)));
            }
            velocity[grain] = M::Velocity::ZERO;
        }
        let mut offset = vec![0.0; M::Impulse::LEN];
        contact.offset().put(&mut offset, 0);
        offset.resize(d, 0.0);
        w.extend(offset);
        friction.push(contact.friction());
    }
    Global { mass, h, f, w, friction }
}

/// Unit vectors across a normal, each as its components: those of the mechanics with friction.
fn tangents<P: Place>(normal: P) -> Vec<Vec<f64>> {
    let n = normal.space();
    if P::LEN == 2 {
        return vec![vec![-n[1], n[0]]];
    }
    frame(&n.into()).map(|tangent| tangent.as_slice().to_vec()).to_vec()
}
