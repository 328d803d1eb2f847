//! Time marching: the θ-scheme around any solver, one contact problem per time step, each started from the impulses
//! of those before (§2).

mod begin;
mod contacts;
pub(crate) mod parts;
mod start;
pub(crate) mod state;
mod view;

use crate::bodies::joints::Joints;
use crate::case::Case;
use crate::detect::{Grain, Neighbours, Side};
use crate::error::{
    CaseError, Missed,
    explosion::{deepest, explosion},
};
use crate::observe::Observables;
use crate::observe::energy::Energy;
use crate::problem::frozen::Frozen;
use crate::problem::marched::{Marched, inertia, kept, translating, translation};
use crate::problem::time_step::TimeStep;
use crate::scene::Scene;
use contact::{Discs, Mechanics, Packing, Place, Solver, Touch, Vector};
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
    /// Places when time began (m).
    origin: Vec<M::Place>,
    velocity: Vec<M::Velocity>,
    /// Cached pairs of close grains: they save work and change no contact.
    neighbours: RefCell<Neighbours<M::Place>>,
    /// Time steps done.
    done: u64,
    /// Impulses of the last time step, as they are kept, ordered by contact (N·s); none if its solve failed.
    last: Vec<((u32, Side), M::Impulse)>,
    /// Impulses of the time step before it, likewise; none if its solve failed (N·s).
    before: Vec<((u32, Side), M::Impulse)>,
    /// Contacts that slid in the last time step, in order; kept where static friction is another.
    sliding: Vec<(u32, Side)>,
    /// Status of the last time step, if it did not converge.
    missed: Option<Missed>,
    /// Deepest overlap of the problem last solved, see [`deepest`].
    overlap: Option<(u32, f64, f64)>,
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
        let spins = |grain: &Grain<M::Place>| grain.motion[3..].iter().any(|spin| *spin != 0.0);
        if let Some(grain) = grains.iter().position(|grain| case.scene.spinless && spins(grain)) {
            return Err(case.wrong(format!("`scene.spinless` is true: grain {grain} of the sample spins")));
        }
        let mut mass: Vec<_> = grains.iter().map(|grain| inertia::<M>(grain, !case.scene.spinless)).collect();
        for (body, at) in case.scene.bodies(&grains) {
            mass.push(inertia::<M>(&body, false));
            velocity.push(at);
            grains.push(body);
        }
        let mut velocity: Vec<_> = velocity.into_iter().map(translating::<M>).collect();
        for (velocity, Grain { motion, .. }) in velocity.iter_mut().zip(&grains) {
            // To the bit, and to the sign of a zero, where nothing is given.
            if motion.iter().any(|value| *value != 0.0) {
                let [x, y, .., spin] = *motion;
                let of_disc = [x, y, spin];
                *velocity += M::Velocity::at(if M::Place::LEN > 2 { motion } else { &of_disc }, 0);
            }
        }
        let march = Self {
            name: case.name.clone(),
            scene: case.scene.clone(),
            joints: Joints::of(&case.scene, M::Place::LEN > 2),
            radius: grains.iter().map(|grain| grain.radius).collect(),
            mass,
            position: grains.iter().map(|grain| grain.position).collect(),
            origin: grains.iter().map(|grain| grain.position).collect(),
            velocity,
            neighbours: RefCell::default(),
            done: 0,
            last: Vec::new(),
            before: Vec::new(),
            sliding: Vec::new(),
            missed: None,
            overlap: None,
        };
        march.check_begin(&case.sample).map_err(|message| case.wrong(message))?;
        Ok(march)
    }

    /// Time steps done.
    pub fn time_steps(&self) -> u64 {
        self.done
    }

    /// Returns the time (s).
    pub fn time(&self) -> f64 {
        self.done as f64 * self.scene.time_step_s
    }

    /// Number of grains; a lid is none, nor is a driven segment.
    pub fn grain_count(&self) -> usize {
        self.radius.len() - self.scene.body_count()
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

    /// Returns the positions at which contacts are detected, and the free velocities.
    fn free(&self) -> (Vec<M::Place>, Vec<M::Velocity>) {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        // Contacts are sought at q + h(1−θ)V⁻, and V_free = V⁻ + M⁻¹Rᵈ.
        let position: Vec<_> = self
            .position
            .iter()
            .zip(&self.velocity)
            .map(|(q, v)| *q + translation::<M>(*v) * (h * (1.0 - theta)))
            .collect();
        let taken = translating::<M>(self.scene.gravity::<M::Place>() * h);
        let mut free_velocity: Vec<_> = self.velocity.iter().map(|v| *v - taken).collect();
        let grains = self.grain_count();
        for (free, (mass, force)) in free_velocity[grains..].iter_mut().zip(self.scene.forces::<M::Place>()) {
            *free += translating::<M>(force * h / mass);
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

    /// Ends the time step with the impulses `r` (N·s) found for it: q ← q + h((1−θ)V⁻ + θV).
    ///
    /// # Panics
    /// If the impulses are not those of the time step's problem.
    pub fn advance(&mut self, time_step: &TimeStep<M>, r: &[f64]) -> Observables {
        let Scene { time_step_s: h, theta, .. } = self.scene;
        let problem = &time_step.frozen.problem;
        assert_eq!(r.len(), problem.impulse_count(), "one impulse per contact");
        let mut velocity = vec![M::Velocity::ZERO; problem.grain_count()];
        problem.velocity(r, &mut velocity);
        let period = self.scene.period();
        let energy = Energy::of(time_step, &self.scene, (&self.velocity, &velocity), r);
        for ((q, detected), v) in self.position.iter_mut().zip(problem.position()).zip(&velocity) {
            *q = period.wrapped(*detected + translation::<M>(*v) * (h * theta));
        }
        self.velocity = velocity;
        let kept_at = |k: usize| kept::<M>(&problem.contacts()[k], M::Impulse::at(r, k));
        let last = time_step.keys().enumerate().map(|(k, key)| (key, kept_at(k))).collect();
        self.before = std::mem::replace(&mut self.last, last);
        self.sliding = self.sliding(time_step, r);
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
    ) -> Result<(Outcome, Observables), CaseError> {
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
    ) -> Result<(Outcome, Observables), CaseError> {
        let (Frozen { problem, gap, .. }, start) = (&next.frozen, self.start(next, start));
        let mut observe =
            |_: &Progress| if halt() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let measured = Measured::Needed;
        let outcome = solve_against(None, solver, problem, &start, stop, measured, &mut observe)?;
        let (time_step, status) = (self.done + 1, outcome.status);
        if status == Status::Interrupted {
            return Err(CaseError::Interrupted { time_step, iterations: outcome.iterations });
        }
        let observables = self.advance(next, &outcome.impulses);
        let missed = (status != Status::Converged).then_some(Missed { time_step, status });
        if missed.is_some_and(Missed::failed) {
            self.last.clear();
            self.sliding.clear();
        }
        let before = std::mem::replace(&mut self.missed, missed);
        self.overlap = deepest(problem.contacts().iter().map(Touch::ends), gap, &self.radius);
        let translations: Vec<_> = self.velocity.iter().map(|v| translation::<M>(*v)).collect();
        match explosion(self.overlap, &self.radius, &translations, self.scene.time_step_s) {
            None => Ok((outcome, observables)),
            // Speeds are those of this time step; overlaps were found at its beginning, where the one before had led.
            Some(why) => {
                let recent = || missed.into_iter().chain(before);
                let solved = recent().find(|missed| missed.failed()).or_else(|| recent().next());
                Err(CaseError::Exploded { time_step, why, solved })
            }
        }
    }
}
