//! Time marching: the θ-scheme around any solver, one contact problem per time step, each started from the impulses
//! of those before (§2).

mod begin;
mod contacts;
pub(crate) mod parts;
mod start;

use crate::case::Case;
use crate::detect::{Grain, Neighbours, Side};
use crate::error::{CaseError, Missed, explosion::explosion};
use crate::observe::bulk::Bulk;
use crate::observe::energy::Energy;
use crate::observe::stress::Stress;
use crate::observe::{Observables, wall_impulses};
use crate::problem::frozen::Frozen;
use crate::problem::marched::Marched;
use crate::problem::time_step::TimeStep;
use crate::scene::drawn::drawn;
use crate::scene::driven;
use crate::scene::joints::Joints;
use crate::scene::lid::Placed;
use crate::scene::{Scene, too_far};
use contact::{Discs, Mass, Mechanics, Packing, Place, Solver, Touch, Vector, greatest, shown};
use runner::{Measured, Outcome, Progress, Status, Stop, solve_against};
pub use start::Start;
use start::recall;
use std::cell::RefCell;
use std::ops::ControlFlow;

/// A scene on its way through time.
#[derive(Clone, Debug)]
pub struct March<M: Mechanics = Discs> {
    name: String,
    scene: Scene,
    joints: Joints,
    radius: Vec<f64>,
    mass: Vec<M::Mass>,
    position: Vec<M::Place>,
    velocity: Vec<M::Velocity>,
    /// What is known of pairs of grains: it spares work, and changes no contact.
    neighbours: RefCell<Neighbours<M::Place>>,
    /// Time steps done.
    done: u64,
    /// Impulses of the last time step, as they are kept, ordered by contact (N·s); none if its solve failed.
    last: Vec<((u32, Side), M::Impulse)>,
    /// Those of the time step before it, if both solves did not fail (N·s).
    before: Vec<((u32, Side), M::Impulse)>,
    /// How the last time step ended, if it did not converge.
    missed: Option<Missed>,
}

impl<M: Marched> March<M> {
    /// The scene of `case` at time 0, every grain at rest but those that the scene throws.
    ///
    /// # Errors
    /// Names the value of which no sample can be made.
    pub fn new(case: &Case) -> Result<Self, CaseError> {
        if case.scene.is_rough() && !M::HAS_FRICTION {
            return Err(CaseError::Friction { name: case.name.clone() });
        }
        Self::of(case, case.grains::<M::Place>()?)
    }

    /// The scene of `case` with `grains`, at time 0.
    pub(crate) fn of(case: &Case, mut grains: Vec<Grain<M::Place>>) -> Result<Self, CaseError> {
        let [x, y] = case.scene.thrown_at_m_per_s;
        let mut velocity = vec![M::Place::of([x, y, 0.0]); grains.len()];
        let height = |k: &usize| grains[*k].position[1];
        if let Some(highest) = (0..grains.len()).rev().max_by(|a, b| height(a).total_cmp(&height(b))) {
            velocity[highest] = M::Place::of([x, y - case.scene.impact_speed_m_per_s, 0.0]);
        }
        let mut mass: Vec<_> = grains.iter().map(M::mass).collect();
        if let Some(lid) = case.scene.lid() {
            let body = lid.body(&grains, case.scene.bump_radius().unwrap_or(0.0));
            mass.push(M::unturned(M::mass(&body)));
            velocity.push(M::Place::of([lid.speed_m_per_s, 0.0, 0.0]));
            grains.push(body);
        }
        for body in case.scene.driven_bodies(&grains) {
            mass.push(M::unturned(M::mass(&body)));
            velocity.push(M::Place::ZERO);
            grains.push(body);
        }
        let march = Self {
            name: case.name.clone(),
            scene: case.scene.clone(),
            joints: Joints::of(&case.scene),
            radius: grains.iter().map(|grain| grain.radius).collect(),
            mass,
            position: grains.iter().map(|grain| grain.position).collect(),
            velocity: velocity.into_iter().map(M::translating).collect(),
            neighbours: RefCell::default(),
            done: 0,
            last: Vec::new(),
            before: Vec::new(),
            missed: None,
        };
        march.check_begin(&case.sample).map_err(|message| case.wrong(message))?;
        Ok(march)
    }

    /// Returns the unusual values of its scene, each by its key.
    pub fn warnings(&self) -> Vec<String> {
        self.scene.warnings(self.radius.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// The warning of a grain that the last time step moved by more than its radius, if there is one.
    pub fn moved_too_far(&self) -> Option<String> {
        let h = self.scene.time_step_s;
        let moved = (0..self.grain_count()).map(|k| (k, M::translation(self.velocity[k]).length() * h));
        let (grain, by) = moved.into_iter().find(|(k, by)| *by > self.radius[*k])?;
        let moves = format!("time step {} moves grain {grain} by {} m", self.done, shown(by));
        Some(too_far(h, &moves, self.radius[grain]))
    }

    /// Time steps done.
    pub fn time_steps(&self) -> u64 {
        self.done
    }

    /// Number of grains; a lid is none, nor is a driven segment.
    pub fn grain_count(&self) -> usize {
        self.radius.len() - self.scene.body_count()
    }

    /// Mean diameter of the grains (m).
    pub fn mean_diameter(&self) -> f64 {
        let radius = &self.radius[..self.grain_count()];
        2.0 * radius.iter().sum::<f64>() / radius.len() as f64
    }

    /// Where another grain is, seen from a place: through a periodic side if that is nearer; none of other bodies, which
    /// are everywhere.
    pub fn beside(&self, place: M::Place, other: u32) -> Option<M::Place> {
        let there = (self.position.get(other as usize)).filter(|_| (other as usize) < self.grain_count())?;
        let period = self.scene.period();
        // To the bit where nothing is periodic.
        Some(period.0.map_or(*there, |_| place - period.nearest(place - *there)))
    }

    /// The lid among the bodies at these places.
    fn lid(&self, position: &[M::Place]) -> Option<Placed<'_, M::Place>> {
        self.scene.lid()?;
        let body = self.grain_count();
        let foot = position[body] - M::Place::of([0.0, self.radius[body], 0.0]);
        Some(Placed { scene: &self.scene, body: body as u32, foot })
    }

    /// The grains, and last a lid or driven segments, as they are: radius (m), place (m) and velocity (m/s) of each.
    pub fn grains(&self) -> impl Iterator<Item = (f64, M::Place, M::Place)> {
        self.radius
            .iter()
            .zip(&self.position)
            .zip(&self.velocity)
            .map(|((r, q), v)| (*r, *q, M::translation(*v)))
    }

    /// Mass of each grain (kg), and its moment of inertia (kg m²), if it spins.
    pub fn mass(&self) -> &[M::Mass] {
        &self.mass
    }

    /// Velocity of each grain (m/s), and its spin (rad/s), if it has any.
    pub fn velocity(&self) -> &[M::Velocity] {
        &self.velocity
    }

    /// The walls and other bodies as they stand, to be drawn, by their corners (m): the floor from left to right, the others from their
    /// feet to as high as the highest grain. What is not between walls is as wide as the grains. In the plane each is a segment, in
    /// space of four corners.
    pub fn walls(&self) -> Vec<(Side, Vec<M::Place>)> {
        let reach = |along: M::Place| {
            let reaches = self.position.iter().zip(&self.radius).map(|(q, r)| along.dot_product(*q) + r);
            reaches.fold(f64::NEG_INFINITY, f64::max)
        };
        let mut walls = drawn(&self.scene, self.done as f64 * self.scene.time_step_s, reach);
        walls.extend(self.lid(&self.position).and_then(Placed::drawn));
        walls.extend(
            self.scene.driven_at(&self.position, |_| M::Place::ZERO).iter().flat_map(driven::Placed::drawn),
        );
        walls
    }

    /// The contact problem of the next time step.
    ///
    /// # Errors
    /// A simulation that exploded has none.
    pub fn next(&self) -> Result<TimeStep<M>, CaseError> {
        let (position, free_velocity) = self.free();
        let reach = self.reach(&position, &free_velocity);
        self.next_within(reach, position, free_velocity)
    }

    /// Where contacts are sought, and the velocities without them.
    fn free(&self) -> (Vec<M::Place>, Vec<M::Velocity>) {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        // Contacts are sought at q + h(1−θ)V⁻, and V_free = V⁻ + M⁻¹Rᵈ.
        let position: Vec<_> = self
            .position
            .iter()
            .zip(&self.velocity)
            .map(|(q, v)| *q + M::translation(*v) * (h * (1.0 - theta)))
            .collect();
        let taken = M::translating(self.scene.gravity::<M::Place>() * h);
        let mut free_velocity: Vec<_> = self.velocity.iter().map(|v| *v - taken).collect();
        let grains = self.grain_count();
        for (free, (mass, force)) in free_velocity[grains..].iter_mut().zip(self.scene.forces::<M::Place>()) {
            *free += M::translating(force * h / mass);
        }
        (position, free_velocity)
    }

    /// The contact problem with contacts up to a gap of `reach` (m).
    fn next_within(
        &self,
        reach: f64,
        position: Vec<M::Place>,
        free_velocity: Vec<M::Velocity>,
    ) -> Result<TimeStep<M>, CaseError> {
        let Scene { time_step_s: h, law, .. } = self.scene;
        let (contacts, near) = self.contacts(&position, &free_velocity, reach);
        let keys = near.iter().map(|(contact, _)| (contact.candidate, contact.antagonist));
        let start = recall::<M>(&self.last, keys, &contacts);
        let gap = near.iter().map(|(contact, _)| contact.gap).collect();
        let sides = near.iter().map(|(contact, _)| contact.antagonist).collect();
        let terms = near.iter().map(|(_, terms)| *terms).collect();
        let problem = Packing::new(self.mass.clone(), position, free_velocity, contacts)
            .map_err(|source| CaseError::TimeStep { time_step: self.done + 1, source })?;
        let frozen = Frozen {
            name: format!("{}-t{}", self.name, self.done + 1),
            source: format!("Case {}, time step {} of {h} s, law {}.", self.name, self.done + 1, law.name()),
            time_step: h,
            radius: self.radius.clone(),
            gap,
            problem,
            start,
            missed_before: None,
        };
        Ok(TimeStep { frozen, sides, terms })
    }

    /// Ends the time step with the impulses `r` (N·s) and velocities `velocity` (m/s) found for it:
    /// q ← q + h((1−θ)V⁻ + θV).
    ///
    /// # Panics
    /// If the impulses or velocities are not those of the time step's problem.
    pub fn advance(&mut self, time_step: &TimeStep<M>, r: &[f64], velocity: &[M::Velocity]) -> Observables {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        let problem = &time_step.frozen.problem;
        assert_eq!(r.len(), problem.impulse_count(), "one impulse per contact");
        assert_eq!(velocity.len(), problem.grain_count(), "one velocity per grain");
        let period = self.scene.period();
        let energy = Energy::of(time_step, &self.scene, (&self.velocity, velocity), r);
        for ((q, detected), v) in self.position.iter_mut().zip(problem.position()).zip(velocity) {
            *q = period.wrapped(*detected + M::translation(*v) * (h * theta));
        }
        self.velocity.copy_from_slice(velocity);
        let kept = |k: usize| M::kept(&problem.contacts()[k], M::Impulse::at(r, k));
        let last = time_step.keys().enumerate().map(|(k, key)| (key, kept(k))).collect();
        self.before = std::mem::replace(&mut self.last, last);
        self.done += 1;
        self.observe(time_step, r, energy)
    }

    /// Solves one time step with `solver`, from the impulses of the time step before.
    ///
    /// # Errors
    /// Those of [`March::solve`].
    pub fn time_step(
        &mut self,
        solver: &dyn Solver<M>,
        stop: &Stop,
    ) -> Result<(Outcome<M>, Observables), CaseError> {
        let next = self.next()?;
        self.solve(&next, solver, stop, Start::Previous, &|| false)
    }

    /// Solves the time step that [`March::next`] gave with `solver`, from `start`; from no impulses if the solve of the one
    /// before failed. `halt` is called after every iteration.
    ///
    /// # Errors
    /// Names a setting of the solver without meaning, or says how the simulation has exploded: `next` is then the problem
    /// of its last good state. If `halt` said yes, the time step is not done.
    pub fn solve(
        &mut self,
        next: &TimeStep<M>,
        solver: &dyn Solver<M>,
        stop: &Stop,
        start: Start,
        halt: &dyn Fn() -> bool,
    ) -> Result<(Outcome<M>, Observables), CaseError> {
        let (Frozen { problem, gap, .. }, start) = (&next.frozen, self.start(next, start));
        let mut observe =
            |_: &Progress| if halt() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let measured = Measured::Needed;
        let outcome = solve_against(None, solver, problem, &start, stop, measured, &mut observe)?;
        let (time_step, status) = (self.done + 1, outcome.status);
        if status == Status::Interrupted {
            return Err(CaseError::Interrupted { time_step, iterations: outcome.iterations });
        }
        let observables = self.advance(next, &outcome.impulses, &outcome.velocity);
        let missed = (status != Status::Converged).then_some(Missed { time_step, status });
        if missed.is_some_and(Missed::failed) {
            self.last.clear();
        }
        let before = std::mem::replace(&mut self.missed, missed);
        let contacts = problem.contacts().iter().map(Touch::ends);
        let translations: Vec<_> = self.velocity.iter().map(|v| M::translation(*v)).collect();
        match explosion(contacts, gap, &self.radius, &translations, self.scene.time_step_s) {
            None => Ok((outcome, observables)),
            // Speeds are those of this time step; overlaps were found at its beginning, where the one before had led.
            Some(why) => {
                let recent = || missed.into_iter().chain(before);
                let solved = recent().find(|missed| missed.failed()).or_else(|| recent().next());
                Err(CaseError::Exploded { time_step, why, solved })
            }
        }
    }

    fn observe(&self, time_step: &TimeStep<M>, r: &[f64], energy: Energy) -> Observables {
        let kinetic = self.mass.iter().zip(&self.velocity).map(|(m, v)| 0.5 * m.squared(*v));
        let grains = self.grain_count();
        let mass = || self.mass[..grains].iter().map(|mass| M::weight(*mass));
        let moment = mass().zip(&self.position).map(|(m, q)| m * q[1]);
        let height = self.lid(time_step.frozen.problem.position()).map(|lid| lid.foot[1]);
        let area = self.scene.period().0.zip(height).map(|(width, height)| width * height);
        let overlaps = || time_step.frozen.gap.iter().map(|gap| f64::max(0.0, -gap));
        let time = self.done as f64 * self.scene.time_step_s;
        Observables {
            time,
            kinetic_energy: kinetic.sum(),
            mean_height: moment.sum::<f64>() / mass().sum::<f64>(),
            greatest_overlap: overlaps().fold(0.0, f64::max),
            mean_overlap: overlaps().sum::<f64>() / grains as f64,
            wall_impulses: wall_impulses(&time_step.sides, &r.iter().step_by(M::Impulse::LEN).copied()),
            contacts: time_step.sides.len(),
            energy,
            stress: Stress::of(time_step, &self.scene, (grains, area), r),
            bulk: Bulk::of(time_step, &self.scene, (grains, time), r),
            greatest_speed: greatest(self.velocity.iter().map(|v| M::translation(*v).length())),
        }
    }
}
