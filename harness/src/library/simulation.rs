//! A simulation that another program steers: time steps at its call, with what they show as lists of numbers.

use super::{root, wrong_key};
use crate::plan::{Method, Rule};
use crate::problems::read_case;
use crate::run::{End, Seen, Until, Watch, contact_forces, in_the_pool, missed, observed, through_time};
use crate::terminal::{prepare_new, write_sealed};
use anyhow::{Context, Result, anyhow};
use cases::{Case, Start};
use lineup::{OneMarch, march};
use results::columns::{Values, lists};
use results::contacts::ContactForce;
use results::simulation::{Observed, Totals};
use runner::Stop;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Request for a simulation: method, settings, stop rule of each time step, condition.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    /// Name of the method; without it that of `gravel simulate`.
    method: Option<String>,
    settings: Map<String, Value>,
    stop: Stop,
    start: Start,
    until: Option<Until>,
    over: Option<f64>,
}

/// A scene on its way through time.
pub struct Simulation {
    case: Case,
    march: Box<dyn OneMarch>,
    method: Method,
    rule: Rule,
    watch: Option<Watch>,
    /// File of its state, if that is asked for.
    state: Option<PathBuf>,
    totals: Totals,
}

/// Columns of a table, each with its name.
pub type Table = Vec<(String, Values)>;

/// Time steps that were made.
pub struct Advanced {
    /// `status`, `reason`, `is_met` and the counts of [`Totals`], of all time steps so far.
    pub told: Value,
    /// A row for each time step, as `gravel simulate -o` writes it.
    pub series: Table,
    /// The contacts of the last time step, as `gravel simulate --contacts` writes them.
    pub contacts: Table,
}

/// The bodies of a scene, in flat lists: the grains, and last a lid or driven segments.
pub struct Bodies {
    /// Numbers of a place and a velocity, of a spin, 0 without friction, and of the grains.
    pub sizes: [usize; 3],
    /// Radius of each (m).
    pub radius: Vec<f64>,
    /// Mass of each (kg).
    pub mass: Vec<f64>,
    /// Centre of each (m).
    pub position: Vec<f64>,
    /// Velocity of each (m/s).
    pub velocity: Vec<f64>,
    /// Spin of each (rad/s).
    pub spin: Vec<f64>,
}

impl Simulation {
    /// Begins a simulation of a case with values replaced, or resumes one from the file of a state; it will be saved in the file `state`.
    ///
    /// # Errors
    /// Says what `gravel` would print.
    pub fn new(
        name: &str,
        scene: &[(String, String)],
        request: &str,
        restart: Option<&Path>,
        state: Option<PathBuf>,
    ) -> Result<Self, String> {
        let begin = || -> Result<Self> {
            if let Some(file) = &state {
                prepare_new(file).context("`state`")?;
            }
            let root = root()?;
            let request: Value = serde_json::from_str(request)?;
            let request: Request =
                serde_path_to_error::deserialize(request).map_err(|error| wrong_key(&error))?;
            let case = read_case(&root.case(name)?, scene)?;
            let mut march = march(&case)?;
            let method = Method::unless_named()?.or_named(request.method.as_deref(), request.settings)?;
            request.stop.check()?;
            march.check(method.ours()?)?;
            if let Some(file) = restart {
                march.resume(&case, file)?;
            }
            let scale = (case.scene.gravity_m_per_s2, march.mean_diameter(), case.scene.time_step_s);
            let watch = request.until.map(|until| Watch::new(until, request.over, scale)).transpose()?;
            let rule = Rule { stop: request.stop, warm_start: request.start };
            Ok(Self { case, march, method, rule, watch, state, totals: Totals::default() })
        };
        begin().map_err(|error| crate::in_one_paragraph(&error))
    }

    /// Returns the unusual values of its scene, each by its key.
    pub fn warnings(&self) -> Vec<String> {
        self.march.warnings()
    }

    /// Returns the number of time steps since time began, and the time (s).
    pub fn time(&self) -> (u64, f64) {
        (self.march.time_steps(), self.march.time())
    }

    /// Makes time steps, fewer if the condition is met; `stops` is asked after every iteration whether to end.
    ///
    /// # Errors
    /// Says what `gravel` would print. Where a scene has exploded, that is no error.
    pub fn advance(
        &mut self,
        time_steps: u64,
        with_contacts: bool,
        stops: &(dyn Fn() -> bool + Sync),
    ) -> Result<Advanced, String> {
        in_the_pool(|| self.advanced(time_steps, with_contacts, stops))
            .map_err(|error| crate::in_one_paragraph(&error))
    }

    fn advanced(
        &mut self,
        time_steps: u64,
        with_contacts: bool,
        stops: &dyn Fn() -> bool,
    ) -> Result<Advanced> {
        let Self { march, method, rule, watch, .. } = self;
        let last = march.time_steps().saturating_add(time_steps);
        let (mut rows, mut contacts, mut is_met): (Vec<Observed>, Vec<ContactForce>, _) =
            (Vec::new(), Vec::new(), false);
        let see = &mut |seen: &Seen| {
            let row = observed(seen);
            is_met = watch.as_mut().is_some_and(|watch| watch.is_met(&row));
            if with_contacts && (is_met || seen.march.time_steps() == last) {
                contacts = contact_forces(seen);
            }
            rows.push(Observed { iterations: seen.outcome.iterations, ..row });
            Ok(if is_met { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
        let (totals, end) = through_time(&mut **march, method.ours()?, rule, time_steps, stops, see)?;
        self.totals += totals;
        if let End::Refused(why) = &end {
            return Err(anyhow!("method `{}`, {why}", self.method.name));
        }
        let missed = missed(&self.totals, &rule.stop);
        let reason =
            if matches!(end, End::Completed) { missed.unwrap_or_default() } else { end.reason().to_owned() };
        let told = json!({
            "status": end.status(),
            "reason": reason,
            "is_met": self.watch.as_ref().map(|_| is_met),
            "method": self.method.name,
            "settings": self.method.settings,
            "totals": self.totals,
        });
        Ok(Advanced { told, series: lists(&rows)?, contacts: lists(&contacts)? })
    }

    /// Returns the bodies as they are.
    pub fn bodies(&self) -> Bodies {
        let (bodies, size) = (self.march.bodies(), self.march.dimensions());
        let flat = |vector: fn(&lineup::Body) -> [f64; 3]| {
            bodies.iter().flat_map(|body| vector(body).into_iter().take(size)).collect()
        };
        Bodies {
            sizes: [size, bodies.first().map_or(0, |body| body.spin.len()), self.march.grain_count()],
            radius: bodies.iter().map(|body| body.radius).collect(),
            mass: bodies.iter().map(|body| body.mass).collect(),
            position: flat(|body| body.place),
            velocity: flat(|body| body.velocity),
            spin: bodies.iter().flat_map(|body| body.spin.iter().copied()).collect(),
        }
    }

    /// Returns the walls as they are drawn, each by its corners (m).
    pub fn walls(&self) -> Vec<Vec<[f64; 3]>> {
        self.march.walls().into_iter().map(|(_, corners)| corners).collect()
    }

    /// Writes its state where that was asked for, whole or not at all.
    ///
    /// # Errors
    /// Says what `gravel` would print.
    pub fn save(&self) -> Result<(), String> {
        let Some(path) = &self.state else { return Ok(()) };
        let write = || -> Result<()> {
            prepare_new(path)?;
            write_sealed(path, &self.march.state(&self.case)?)
        };
        write().map_err(|error| crate::in_one_paragraph(&error))
    }
}
