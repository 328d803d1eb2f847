//! The contacts of a sweep in mass-scaled unknowns: what Gauss-Seidel and Jacobi visit, one after the other.

use crate::law;
use crate::problem::{Contact, ContactProblem};
use crate::scaled::{ScaledContact, by_levels, scaled_velocity, unscale};
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
    fn new(contact: &Contact, places: (u32, Option<u32>), inverse_mass: impl Fn(u32) -> f64) -> (Self, f64) {
        let (scaled, unit) = ScaledContact::new(contact, places, inverse_mass, true);
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

/// Contacts in the order of a sweep, with their impulses and the velocities of their grains.
pub struct Sweep {
    /// In the order of the visits, like all that follows.
    pub rows: Vec<Row>,
    /// The problem's contact of each row.
    contacts: Vec<u32>,
    /// √`W_αα` (kg^-½).
    pub unit: Vec<f64>,
    /// s = √`W_αα` r (√J).
    pub s: Vec<f64>,
    /// y = M^½ (`V_free` + M⁻¹ H r) (√J), in places of its own.
    pub y: Vec<Vector2<f64>>,
}

impl Sweep {
    /// All contacts of `problem` in the `order`, with the impulses `r0` (N·s). Whatever that is, the visits are made level by
    /// level, and the grains are numbered as they are visited, which changes no bit.
    pub fn new(problem: &ContactProblem, order: &[u32], r0: &[f64]) -> Self {
        let contacts = in_levels(problem, order);
        let grains = by_first_visit(problem, &contacts);
        let mut place = vec![0; problem.grain_count()];
        for (new, grain) in (0_u32..).zip(&grains) {
            place[*grain as usize] = new;
        }
        let place = |grain: u32| place[grain as usize];
        let places = |contact: &u32| {
            let (candidate, antagonist) = problem.contacts()[*contact as usize].ends();
            (*contact, (place(candidate), antagonist.map(place)))
        };
        let y = scaled_velocity(problem, r0);
        let y = grains.iter().map(|grain| y[*grain as usize]).collect();
        let inverse_mass = |grain: u32| 1.0 / problem.mass()[grain as usize];
        Self::between(problem, contacts.iter().map(places), inverse_mass, r0, y)
    }

    /// Some contacts of `problem`, each between its places in `y`, visited one after the other, with the `inverse_mass` of each
    /// grain (1/kg) and the problem's impulses `r0` (N·s).
    pub fn between(
        problem: &ContactProblem,
        contacts: impl Iterator<Item = (u32, (u32, Option<u32>))>,
        inverse_mass: impl Fn(u32) -> f64,
        r0: &[f64],
        y: Vec<Vector2<f64>>,
    ) -> Self {
        let mut sweep = Self { rows: Vec::new(), contacts: Vec::new(), unit: Vec::new(), s: Vec::new(), y };
        for (k, places) in contacts {
            let (row, unit) = Row::new(&problem.contacts()[k as usize], places, &inverse_mass);
            sweep.rows.push(row);
            sweep.contacts.push(k);
            sweep.unit.push(unit);
            sweep.s.push(unit * r0[k as usize]);
        }
        sweep
    }

    /// Contact by contact: v = Hᵗ V + c; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
    #[inline]
    pub fn forward(&mut self, relaxation: f64) {
        for (row, s) in self.rows.iter().zip(&mut self.s) {
            row.solve(s, &mut self.y, relaxation);
        }
    }

    /// The same from the last contact to the first.
    #[inline]
    pub fn backward(&mut self, relaxation: f64) {
        for (row, s) in self.rows.iter().zip(&mut self.s).rev() {
            row.solve(s, &mut self.y, relaxation);
        }
    }

    /// Puts the impulses in the problem's order (N·s).
    pub fn impulses(&self, r: &mut [f64]) {
        unscale((&self.s, &self.unit), &self.contacts, r);
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
