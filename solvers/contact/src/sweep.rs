//! The contacts of a sweep in mass-scaled unknowns: what Gauss-Seidel and Jacobi visit, one after the other.

use crate::law;
use crate::problem::{Contact, ContactProblem};
use crate::scaled::{ScaledContact, by_levels, inverse_masses, scaled_velocity};
use nalgebra::Vector2;

/// One contact as a sweep needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    contact: ScaledContact,
    /// c/√`W_αα` (√J).
    offset: f64,
}

impl Row {
    /// The row of a contact between two places of y, or one and a wall, and √`W_αα` (kg^-½), with the `inverse_mass` of the
    /// contact's grains (1/kg).
    pub fn new(
        contact: &Contact,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> f64,
    ) -> (Self, f64) {
        let (inverse_mass, unit) = inverse_masses(contact.ends(), inverse_mass);
        let scaled = ScaledContact::new(places, contact.normal, inverse_mass, unit);
        (Self { contact: scaled, offset: contact.offset / unit }, unit)
    }

    /// (H̃ᵗ y)_α + c/√`W_αα` (√J).
    #[inline]
    pub fn relative(&self, y: &[Vector2<f64>]) -> f64 {
        self.contact.relative(y) + self.offset
    }

    /// y ← y + h̃_α Δs.
    #[inline]
    pub fn push(&self, change: f64, y: &mut [Vector2<f64>]) {
        self.contact.push(change, y);
    }

    /// v = Hᵗ V + c at α; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r). Returns √`W_αα` (r⁺ − r) (√J).
    #[inline]
    pub fn solve(&self, s: &mut f64, y: &mut [Vector2<f64>], relaxation: f64) -> f64 {
        let change = law::change(*s, self.relative(y), relaxation);
        self.push(change, y);
        *s += change;
        change
    }
}

/// All contacts of a problem in the order of a sweep. Whatever that is, the visits are made level by level, and the grains are
/// numbered as they are visited, which changes no bit.
pub struct Sweep {
    /// Level by level, like all that follows.
    pub rows: Vec<Row>,
    /// The contact of each row.
    contacts: Vec<u32>,
    /// √`W_αα` (kg^-½).
    pub unit: Vec<f64>,
    /// s = √`W_αα` r (√J).
    pub s: Vec<f64>,
    /// y = M^½ (`V_free` + M⁻¹ H r) (√J); grains in the order of their first visit.
    pub y: Vec<Vector2<f64>>,
}

impl Sweep {
    /// The contacts of `problem` in the `order`, with the impulses `r0` (N·s).
    pub fn new(problem: &ContactProblem, order: &[u32], r0: &[f64]) -> Self {
        let contacts = in_levels(problem, order);
        let grains = by_first_visit(problem, &contacts);
        let mut place = vec![0; problem.grain_count()];
        for (new, grain) in (0_u32..).zip(&grains) {
            place[*grain as usize] = new;
        }
        let place = |grain: u32| place[grain as usize];
        let row = |contact: &u32| {
            let contact = &problem.contacts()[*contact as usize];
            let places = (place(contact.candidate), contact.antagonist.map(place));
            Row::new(contact, places, |grain| 1.0 / problem.mass()[grain as usize])
        };
        let (rows, unit): (Vec<Row>, Vec<f64>) = contacts.iter().map(row).unzip();
        let y = scaled_velocity(problem, r0);
        let y = grains.iter().map(|grain| y[*grain as usize]).collect();
        let s = contacts.iter().zip(&unit).map(|(contact, unit)| unit * r0[*contact as usize]).collect();
        Self { rows, contacts, unit, s, y }
    }

    /// Puts the impulses in the problem's order (N·s).
    pub fn impulses(&self, r: &mut [f64]) {
        for ((s, unit), contact) in self.s.iter().zip(&self.unit).zip(&self.contacts) {
            r[*contact as usize] = s / unit;
        }
    }
}

/// The same sweep, level by level.
fn in_levels(problem: &ContactProblem, order: &[u32]) -> Vec<u32> {
    let ends = order.iter().map(|contact| problem.contacts()[*contact as usize].ends());
    by_levels(ends, problem.grain_count()).iter().map(|place| order[*place as usize]).collect()
}

/// The grains that have contacts, in the order in which a sweep first visits them: those that it needs one after the other
/// then lie close together.
fn by_first_visit(problem: &ContactProblem, order: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; problem.grain_count()];
    let visits = order.iter().flat_map(|contact| problem.contacts()[*contact as usize].grains());
    visits.filter(|grain| !std::mem::replace(&mut seen[*grain as usize], true)).collect()
}
