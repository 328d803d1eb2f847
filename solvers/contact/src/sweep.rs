//! The contacts of a sweep in mass-scaled unknowns: what Gauss-Seidel and Jacobi visit, one after the other.

#![expect(
    clippy::inline_always,
    reason = "what visits are made of is called in two places, and a call would cost a third of a visit"
)]

mod accelerated;
mod renewal;

use crate::acceleration::Trail;
use crate::adjacency::by_levels;
use crate::discs::Discs;
use crate::mechanics::{Column, Mass, Mechanics, Touch, VisitedIn};
use crate::problem::ContactProblem;
use crate::vector::{Numbers, Vector};
use crate::visit::{Row, TOGETHER, Visited, push_all};
use pulp::{Arch, Simd, WithSimd};
use renewal::Renewal;
use std::ops::Range;

pub use accelerated::Accelerated;

/// Visits of an accelerated sweep that are extrapolated and judged together: their impulses stay in the nearest cache.
const NEAR: usize = 16 * TOGETHER;

/// Contacts in the order of a sweep, with their impulses and the velocities of their grains.
pub struct Sweep<M: Mechanics = Discs, C: VisitedIn<M> = <M as Mechanics>::Column> {
    /// In the order of the visits, like all that follows.
    pub rows: Vec<Row<C>>,
    /// The problem's contact of each row.
    pub(crate) contacts: Vec<u32>,
    /// √`W_αα` (kg^-½).
    pub unit: Vec<M::Impulse>,
    /// s = √`W_αα` r (√J).
    pub s: Vec<C::Impulse>,
    /// y = M^½ (`V_free` + M⁻¹ H r) (√J), in places of its own; in mixed precision what it has gained since relative velocities were made anew.
    pub y: Vec<C::Velocity>,
    /// Flags, one for each [`TOGETHER`] rows: true where no two share a grain; empty where visits are faster alone.
    pub(crate) apart: Vec<bool>,
    /// Numbers of places in y that are visited by the end of each [`NEAR`] rows.
    pub(crate) reach: Vec<u32>,
    /// Renewal of the velocities, unless they are in double precision.
    pub(crate) renewal: Option<Renewal<M, C>>,
}

impl<M: Mechanics> Sweep<M> {
    /// All contacts of `problem` in the `order`, with the impulses `r0` (N·s). Whatever that is, the visits are made level by
    /// level, and the grains are numbered as they are visited, which changes no bit.
    pub fn new(problem: &ContactProblem<M>, order: &[u32], r0: &[f64]) -> Self {
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
        let y = problem.scaled_velocity(r0);
        let y = grains.iter().map(|grain| y[*grain as usize]).collect();
        let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
        Self::between(problem, contacts.iter().map(places), inverse_mass, r0, y)
    }

    /// Some contacts of `problem`, each between its places in `y`, visited one after the other, with the `inverse_mass` of each
    /// grain (1/kg) and the problem's impulses `r0` (N·s).
    pub fn between(
        problem: &ContactProblem<M>,
        contacts: impl Iterator<Item = (u32, (u32, Option<u32>))>,
        inverse_mass: impl Fn(u32) -> M::Mass,
        r0: &[f64],
        y: Vec<M::Velocity>,
    ) -> Self {
        let mut sweep = Self {
            rows: Vec::new(),
            contacts: Vec::new(),
            unit: Vec::new(),
            s: Vec::new(),
            y,
            apart: Vec::new(),
            reach: Vec::new(),
            renewal: None,
        };
        let mut ends = Vec::new();
        for (k, places) in contacts {
            ends.push(places);
            let (row, unit) = row::<M>(&problem.contacts()[k as usize], places, &inverse_mass);
            sweep.rows.push(row);
            sweep.contacts.push(k);
            sweep.unit.push(unit);
            sweep.s.push(unit.with(M::Impulse::at(r0, k as usize), |unit, r| unit * r));
        }
        let greatest = |reach: u32, (i, j): &(u32, Option<u32>)| reach.max(i + 1).max(j.map_or(0, |j| j + 1));
        let reach = ends.chunks(NEAR).scan(0, |reach, ends| {
            *reach = ends.iter().fold(*reach, greatest);
            Some(*reach)
        });
        sweep.reach = reach.collect();
        // In the plane without friction a visit takes 2.3 ns alone, and 2.6 in eights.
        if M::Velocity::LEN > 2 {
            sweep.apart = ends.chunks(TOGETHER).map(are_apart).collect();
        }
        sweep
    }
}

impl<M: Mechanics, C: VisitedIn<M>> Sweep<M, C> {
    /// Contact by contact: v = Hᵗ V + c; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
    #[inline]
    pub fn forward(&mut self, relaxation: f64) {
        self.pass(relaxation, false, 0..self.rows.len());
    }

    /// Sweeps from the last contact to the first.
    #[inline]
    pub fn backward(&mut self, relaxation: f64) {
        self.pass(relaxation, true, 0..self.rows.len());
    }

    /// Makes the passes of an iteration, each forward or `backward`.
    #[inline]
    pub fn iterate(&mut self, relaxation: f64, passes: impl Iterator<Item = bool>) {
        passes.for_each(|backward| self.pass(relaxation, backward, 0..self.rows.len()));
    }

    /// Visits all contacts at the velocities that it begins with, kept in `old`: v = Hᵗ `V_old` + c; r⁺ = max(0, r − ω v/`W_αα`), or
    /// what the law says; V ← V + M⁻¹ `h_α` (r⁺ − r).
    pub fn at_once(&mut self, old: &mut [C::Velocity], relaxation: f64) {
        old.copy_from_slice(&self.y);
        for (row, s) in self.rows.iter().zip(&mut self.s) {
            let change = row.change(*s, row.relative(old), relaxation);
            row.push(change, &mut self.y);
            *s += change;
        }
    }

    /// Makes the passes of an accelerated iteration. A single pass forward extrapolates and judges some visits at a time, with the velocities
    /// that they first read: what these need is then near.
    pub fn iterate_ahead(
        &mut self,
        relaxation: f64,
        passes: impl Iterator<Item = bool> + Clone,
        trail: &mut Trail<C>,
    ) {
        Arch::new().dispatch(Ahead { sweep: self, relaxation, passes, trail });
    }

    /// Makes an accelerated iteration that reads all velocities before it changes one: all is extrapolated, and then judged.
    pub fn iterate_after(&mut self, trail: &mut Trail<C>, iteration: impl FnOnce(&mut Self)) {
        let grains = self.y.len();
        trail.extrapolate(&mut self.y, grains);
        trail.impulses.extrapolate(&mut self.s, 0..self.rows.len());
        iteration(self);
        trail.impulses.judge(&self.s, 0..self.rows.len());
    }

    /// Returns the trail of accelerated iterations that begin here; velocities are `free` without impulses (√J).
    pub fn trail(&self, free: Vec<C::Velocity>) -> Trail<C> {
        Trail::new(&self.s, &self.y, free)
    }

    /// Returns the velocities y without the impulses (√J).
    pub fn without_impulses(&self) -> Vec<C::Velocity> {
        let mut free = self.y.clone();
        push_all(&self.rows, &self.s, -1.0, &mut free);
        free
    }

    /// Makes y anew from the impulses: without the round-off of all sweeps so far.
    pub fn renew(&mut self, trail: &Trail<C>) {
        if self.renewal.is_some() {
            return self.refine();
        }
        self.y.copy_from_slice(trail.free());
        push_all(&self.rows, &self.s, 1.0, &mut self.y);
    }

    /// Visits some rows, of which the first is a multiple of [`TOGETHER`].
    #[inline(always)]
    fn pass(&mut self, relaxation: f64, backward: bool, here: Range<usize>) {
        let Self { rows, s, y, apart, .. } = self;
        let (rows, s) = (&rows[here.clone()], &mut s[here.clone()]);
        if apart.is_empty() {
            in_turn(rows, s, y, relaxation, backward);
        } else {
            let apart = &apart[here.start / TOGETHER..here.end.div_ceil(TOGETHER)];
            Arch::new().dispatch(Pass { rows, s, y, apart, relaxation, backward });
        }
    }

    /// The problem's contact of each row.
    pub fn contacts(&self) -> &[u32] {
        &self.contacts
    }

    /// Puts the impulses in the problem's order (N·s).
    pub fn impulses(&self, r: &mut [f64]) {
        C::Impulse::unscale((&self.s, &self.unit), &self.contacts, r);
    }
}

/// An accelerated iteration.
struct Ahead<'a, M: Mechanics, C: VisitedIn<M>, P> {
    sweep: &'a mut Sweep<M, C>,
    relaxation: f64,
    passes: P,
    trail: &'a mut Trail<C>,
}

impl<M: Mechanics, C: VisitedIn<M>, P: Iterator<Item = bool> + Clone> WithSimd for Ahead<'_, M, C, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sweep, relaxation, passes, trail } = self;
        let rows = sweep.rows.len();
        let length = if passes.clone().eq([false]) { NEAR } else { rows.max(1) };
        for first in (0..rows).step_by(length) {
            let here = first..rows.min(first + length);
            trail.extrapolate(&mut sweep.y, sweep.reach[here.end.div_ceil(NEAR) - 1] as usize);
            trail.impulses.extrapolate(&mut sweep.s, here.clone());
            passes.clone().for_each(|backward| sweep.pass(relaxation, backward, here.clone()));
            trail.impulses.judge(&sweep.s, here);
        }
    }
}

/// One visit after the other, or `backward` from the last.
#[inline(always)]
fn in_turn<C: Visited>(
    rows: &[Row<C>],
    s: &mut [C::Impulse],
    y: &mut [C::Velocity],
    relaxation: f64,
    backward: bool,
) {
    let visits = rows.iter().zip(s);
    if backward {
        for (row, s) in visits.rev() {
            row.solve(s, y, relaxation);
        }
    } else {
        for (row, s) in visits {
            row.solve(s, y, relaxation);
        }
    }
}

/// A sweep in which some visits are made at a time.
struct Pass<'a, C: Visited> {
    rows: &'a [Row<C>],
    s: &'a mut [C::Impulse],
    y: &'a mut [C::Velocity],
    apart: &'a [bool],
    relaxation: f64,
    backward: bool,
}

impl<C: Visited> WithSimd for Pass<'_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { rows, s, y, apart, relaxation, backward } = self;
        for k in 0..apart.len() {
            let k = if backward { apart.len() - 1 - k } else { k };
            let here = TOGETHER * k..rows.len().min(TOGETHER * (k + 1));
            let (rows, s) = (&rows[here.clone()], &mut s[here]);
            match (rows.try_into(), <&mut [_; TOGETHER]>::try_from(&mut *s)) {
                (Ok(rows), Ok(s)) if apart[k] => C::visit(simd, rows, s, y, relaxation),
                _ => in_turn(rows, s, y, relaxation, backward),
            }
        }
    }
}

/// The row of a contact between two places of y, or one and a wall, and √`W_αα` (kg^-½), with the `inverse_mass` of the
/// contact's grains (1/kg).
fn row<M: Mechanics>(
    contact: &M::Contact,
    places: (u32, Option<u32>),
    inverse_mass: impl Fn(u32) -> M::Mass,
) -> (Row<M::Column>, M::Impulse) {
    let (column, unit) = M::Column::new(contact, places, inverse_mass, true);
    (Row { column, offset: contact.offset().with(unit, |c, unit| c / unit) }, unit)
}

/// Reports whether no two of some contacts share a place.
fn are_apart(ends: &[(u32, Option<u32>)]) -> bool {
    let places = || ends.iter().flat_map(|(i, j)| std::iter::once(*i).chain(*j));
    places().enumerate().all(|(k, place)| places().skip(k + 1).all(|other| other != place))
}

/// Returns the contacts of `order`, level by level.
fn in_levels<M: Mechanics>(problem: &ContactProblem<M>, order: &[u32]) -> Vec<u32> {
    let ends = order.iter().map(|contact| problem.contacts()[*contact as usize].ends());
    by_levels(ends, problem.grain_count()).iter().map(|place| order[*place as usize]).collect()
}

/// The grains that have contacts, in the order in which a sweep first visits them: those that it needs one after the other
/// then lie close together.
fn by_first_visit<M: Mechanics>(problem: &ContactProblem<M>, order: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; problem.grain_count()];
    let visits = order.iter().flat_map(|contact| problem.contacts()[*contact as usize].grains());
    visits.filter(|grain| !std::mem::replace(&mut seen[*grain as usize], true)).collect()
}
