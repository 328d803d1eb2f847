//! Projected Jacobi: the sweep of NSGS with every relative velocity taken at the old impulses.
//!
//! Converges for ω < 2/λmax(`W_D`⁻¹ W) only; `bounded` keeps it there. Cost of an iteration: that of a sweep, and a copy of the velocities.
//! With acceleration ([`contact::acceleration`]) and ω ≤ 1/λmax an iteration is Nesterov's projected gradient in the norm of D: without
//! friction q(r) falls in the iteration after a restart, or stays.

use analysis::Bounded;
use contact::acceleration::{Acceleration, LAG};
use contact::sweep::{Accelerated, Sweep};
use contact::{Iteration, Mechanics, Packing, SetupError, Solver, Work};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of projected Jacobi.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Jacobi {
    /// ω (–). Any positive value is accepted: that a packing diverges at ω = 1 is a result.
    pub relaxation: f64,
    /// Bounded relaxation: ω is `relaxation` times 2/Λ instead, with Λ ≥ λmax(W_D⁻¹W): then any value below 1 converges, on any problem.
    pub bounded: bool,
    /// Extrapolation over the iterations.
    pub acceleration: Acceleration,
    /// q (–): the extrapolation grows as β = j/(j + q) over the j iterations since the last restart.
    pub lag: f64,
    /// ρ (–): acceleration restarts also where an iteration changes the impulses more than ρ times as much as the least since the last
    /// restart; unless given 1.2 with friction, and 5 without.
    pub slack: Option<f64>,
}

/// ω = ½. Equal discs touch at most 6 others, so λmax(`W_D`⁻¹ W) ≤ 3 on them and any ω < 2/3 converges; ½ leaves a
/// margin for unequal discs.
impl Default for Jacobi {
    fn default() -> Self {
        Self { relaxation: 0.5, bounded: false, acceleration: Acceleration::None, lag: LAG, slack: None }
    }
}

struct Run<M: Mechanics> {
    sweep: Sweep<M>,
    /// y of the iteration before, from which all v are taken.
    old_y: Vec<M::Velocity>,
    relaxation: f64,
    bounded: bool,
    accelerated: Option<Accelerated<M::Column>>,
    iterations: u64,
}

impl<M: Mechanics> Iteration for Run<M> {
    fn advance(&mut self) {
        let Self { sweep, old_y, relaxation, .. } = self;
        let mut iteration = |sweep: &mut Sweep<M>| sweep.at_once(old_y, *relaxation);
        match &mut self.accelerated {
            Some(accelerated) => {
                accelerated.iterate(sweep, |sweep, trail| sweep.iterate_after(trail, iteration));
            }
            None => iteration(sweep),
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }

    fn derived(&self) -> Vec<(&'static str, f64)> {
        if self.bounded { vec![("relaxation", self.relaxation)] } else { Vec::new() }
    }

    fn work(&self) -> Work {
        Work {
            contact_updates: self.iterations * self.sweep.rows.len() as u64,
            delassus_products: self.accelerated.as_ref().map_or(0, Accelerated::delassus_products),
            ..Work::default()
        }
    }
}

impl<M: Bounded> Solver<M> for Jacobi {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let order: Vec<u32> = (0..problem.contact_count() as u32).collect();
        let sweep = Sweep::new(problem, &order, r0);
        let bound = M::scaled_delassus_bound(problem);
        let momentum = self.acceleration.momentum(self.lag, self.slack)?;
        let scale = if self.bounded && bound > 0.0 { 2.0 / bound } else { 1.0 };
        Ok(Box::new(Run {
            old_y: sweep.y.clone(),
            accelerated: momentum.map(|momentum| Accelerated::new(momentum, &sweep)),
            sweep,
            relaxation: scale * self.relaxation,
            bounded: self.bounded,
            iterations: 0,
        }))
    }
}
