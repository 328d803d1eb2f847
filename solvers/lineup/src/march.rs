//! A march through time, whatever the mechanics.

use crate::facts::facts;
use crate::form::Form;
use crate::methods::Ours;
use anyhow::Result;
use cases::{AnyFrozen, Case, CaseError, March, Observables, Side, Start, TimeStep};
use contact::{Place, Vector};
use runner::{Outcome, Stop};
use std::path::Path;

/// A grain, a lid or a driven segment, as it is.
pub struct Body {
    /// Radius (m).
    pub radius: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Place (m).
    pub place: [f64; 3],
    /// Velocity (m/s).
    pub velocity: [f64; 3],
    /// Spin about the axes that it has (rad/s): none without friction, one in 2D, three in 3D.
    pub spin: Vec<f64>,
}

/// A time step that was to be solved.
pub struct Attempt {
    /// The problem.
    pub frozen: AnyFrozen,
    /// The antagonist of each of its contacts.
    pub sides: Vec<Side>,
    /// The end of its solve, and what the scene shows after it; or the reason why there is none.
    pub solved: Result<(Outcome, Observables), CaseError>,
}

/// A march through time.
pub trait OneMarch: Send {
    /// Returns the unusual values of its scene, each by its key.
    fn warnings(&self) -> Vec<String>;

    /// Returns the warnings of the last time step, see [`March::time_step_warnings`].
    fn time_step_warnings(&self) -> [Option<String>; 2];

    /// Refuses a method that the mechanics lacks.
    ///
    /// # Errors
    /// Names both.
    fn check(&self, ours: &Ours) -> Result<()>;

    /// Returns the number of components of a place.
    fn dimensions(&self) -> usize;

    /// Returns the number of time steps done.
    fn time_steps(&self) -> u64;

    /// Returns the time (s).
    fn time(&self) -> f64;

    /// Returns the text of the file of its state, see [`March::state`].
    ///
    /// # Errors
    /// Those of JSON, which none of its numbers causes.
    fn state(&self, case: &Case) -> serde_json::Result<String>;

    /// Takes over the state of a file, see [`March::resume`].
    ///
    /// # Errors
    /// Names the file, the key and the value.
    fn resume(&mut self, case: &Case, path: &Path) -> Result<(), CaseError>;

    /// Returns the number of grains; a lid is none, nor is a driven segment.
    fn grain_count(&self) -> usize;

    /// Returns the mean diameter of the grains (m).
    fn mean_diameter(&self) -> f64;

    /// Returns the contact problem of the next time step: `how` it was reached is added to its source, and how many time steps before it
    /// did not converge.
    ///
    /// # Errors
    /// A simulation that exploded has none.
    fn frozen(&self, how: &str, missed_before: Option<u64>) -> Result<AnyFrozen, CaseError>;

    /// Solves the next time step, see [`March::solve`].
    ///
    /// # Errors
    /// Names the mechanics that the method lacks; a simulation that exploded has no next time step.
    fn solve(&mut self, ours: &Ours, stop: &Stop, start: Start, halt: &dyn Fn() -> bool) -> Result<Attempt>;

    /// Returns the grains, and last a lid or driven segments.
    fn bodies(&self) -> Vec<Body>;

    /// Returns the place of grain `other`, or of its periodic image if that is nearer to a place (m); `None` for other bodies.
    fn beside(&self, place: [f64; 3], other: u32) -> Option<[f64; 3]>;

    /// Returns the walls and other bodies as they are drawn, by their corners (m).
    fn walls(&self) -> Vec<(Side, Vec<[f64; 3]>)>;
}

impl<M: Form> OneMarch for March<M> {
    fn warnings(&self) -> Vec<String> {
        self.warnings()
    }

    fn time_step_warnings(&self) -> [Option<String>; 2] {
        self.time_step_warnings()
    }

    fn check(&self, ours: &Ours) -> Result<()> {
        ours.engine_of::<M>(&facts::<M>(0, 0).in_words()).map(drop)
    }

    fn dimensions(&self) -> usize {
        M::Place::LEN
    }

    fn time_steps(&self) -> u64 {
        self.time_steps()
    }

    fn time(&self) -> f64 {
        self.time()
    }

    fn state(&self, case: &Case) -> serde_json::Result<String> {
        self.state(case)
    }

    fn resume(&mut self, case: &Case, path: &Path) -> Result<(), CaseError> {
        self.resume(case, path)
    }

    fn grain_count(&self) -> usize {
        self.grain_count()
    }

    fn mean_diameter(&self) -> f64 {
        self.mean_diameter()
    }

    fn frozen(&self, how: &str, missed_before: Option<u64>) -> Result<AnyFrozen, CaseError> {
        let mut frozen = self.next()?.frozen;
        frozen.source += how;
        frozen.missed_before = missed_before;
        Ok(frozen.into())
    }

    fn solve(&mut self, ours: &Ours, stop: &Stop, start: Start, halt: &dyn Fn() -> bool) -> Result<Attempt> {
        let solver = ours.engine_of(&facts::<M>(0, 0).in_words())?.solver();
        let time_step = self.next()?;
        let solved = self.solve(&time_step, solver, stop, start, halt);
        let TimeStep { frozen, sides, .. } = time_step;
        Ok(Attempt { frozen: frozen.into(), sides, solved })
    }

    #[expect(clippy::type_complexity, reason = "the lists of the grains, zipped")]
    fn bodies(&self) -> Vec<Body> {
        let body = |(((radius, place, velocity), mass), motion): (
            ((_, M::Place, M::Place), &M::Mass),
            &M::Velocity,
        )| Body {
            radius,
            mass: M::weight(*mass),
            place: place.space(),
            velocity: velocity.space(),
            spin: M::parts(motion).1.to_vec(),
        };
        self.grains().zip(self.mass()).zip(self.velocity()).map(body).collect()
    }

    fn beside(&self, place: [f64; 3], other: u32) -> Option<[f64; 3]> {
        self.beside(M::Place::of(place), other).map(Place::space)
    }

    fn walls(&self) -> Vec<(Side, Vec<[f64; 3]>)> {
        let corners = |ends: Vec<M::Place>| ends.into_iter().map(Place::space).collect();
        self.walls().into_iter().map(|(side, ends)| (side, corners(ends))).collect()
    }
}
