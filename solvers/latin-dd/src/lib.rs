//! LATIN by subdomains (LATIN-DD), §4.1: a linear stage per subdomain and a local stage per contact and per boundary
//! grain take turns, joined by search directions, eq. (4)-(7).
//!
//! Linear stage, in each subdomain E, from the hatted quantities of the local stage, of which it needs t = r̂ + l⁻ v̂ and
//! τ_E = F̂_E + d⁻ V̂ alone:
//!
//! - M_E (V_E − V_free) = H_E r + F_E and v = H_Eᵗ V_E + c     (1)
//! - r + l⁻ v = t     (4)
//! - F_E + d⁻ V_E = τ_E     (5)
//!
//! Local stage, contact by contact and boundary grain by boundary grain:
//!
//! - 0 ≤ v̂ ⊥ r̂ ≥ 0     (2) with r̂ − l⁺ v̂ = r − l⁺ v     (6)
//! - Σ_E F̂_E = 0 with one V̂ for all copies     (3) and F̂_E − d⁺ V̂ = F_E − d⁺ V_E     (7)
//!
//! With r and F_E eliminated, (1) (4) (5) are (M_E + H_E l⁻ H_Eᵗ + d⁻) V_E = M_E V_free + H_E (t − l⁻ c) + τ_E; (3) (7) are
//! V̂ = Σ_E (d⁺ V_E − F_E) / Σ_E d⁺.
//!
//! With friction a contact has two unknowns and a grain a spin: l is κ_l/w_n along the normal and κ_t κ_l/w_t along the tangent,
//! d holds the moment of inertia beside the mass, and with g = r − l⁺ v of the linear stage, μ being the coefficient of friction,
//! r̂_n = max(0, g_n), r̂_t = clip(g_t, μ r̂_n) and v̂ = (r̂ − g)/l⁺     (2′) (6). A fixed point solves Coulomb's law; that the
//! iterates come to one is not proved, and there are problems where they do not.
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §4.1. Without friction, conjugate directions (l⁻ = l⁺, d⁻ = d⁺) make it a
//! Peaceman-Rachford splitting (μ = 1) or ADMM (μ = ½), which converges for 0 < μ < 1 and any positive direction. Cost of
//! an iteration: one pair of triangular solves per subdomain, a pass over the contacts, and the gluing.

mod assembly;
mod balance;
mod coarse;
mod directions;
mod run;
mod sent;
mod stages;
mod subdomain;
#[cfg(test)]
mod tests;

pub use directions::{Directions, deepen, depth_of, derived_kappa, fastest_wall, pushed};
pub use run::Run;
pub use stages::{Form, Stages};

use contact::{ContactProblem, Iteration, Mechanics, Packing, SetupError, Solver};
use nalgebra::SVector;
use partition::{Distributed, Grid, Refused, Scheme, Share, Team};
use run::Beginning;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Settings of LATIN-DD.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LatinDd {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// Scheme by which the contacts are distributed.
    pub partition: Scheme,
    /// μ (–), in (0, 1]: the share of a new local stage that the next linear stage takes.
    pub relaxation: f64,
    /// κ_l of conjugate directions at contacts, l⁻ = l⁺ = κ_l/W_αα (–); without it [`derived_kappa`].
    pub kappa_l: Option<f64>,
    /// κ_t (–): along the tangent of a contact with friction, l is κ_t κ_l/w_t. Without friction it is of no effect.
    pub kappa_t: f64,
    /// κ_d of conjugate directions at the interface, d⁻ = d⁺ = κ_d M_i/m_i (–); without it that of l⁺.
    pub kappa_d: Option<f64>,
    /// κ of l⁻ alone (–).
    pub kappa_l_minus: Option<f64>,
    /// κ of l⁺ alone (–).
    pub kappa_l_plus: Option<f64>,
    /// κ of d⁻ alone (–).
    pub kappa_d_minus: Option<f64>,
    /// κ of d⁺ alone (–).
    pub kappa_d_plus: Option<f64>,
    /// Adaptive directions: all are scaled a few times so that impulses and velocities change alike; if unset, where no
    /// direction is given and there is no friction.
    pub adaptive: Option<bool>,
    /// Coarse problem that keeps the resultants of every interface at zero.
    pub coarse: bool,
}

/// One subdomain, derived directions that adapt without friction, μ = 0.8, which without friction converges for any of them, and κ_t = 1, measured:
/// on `rough-991-mu08` at κ = 3, factors of 3 and 10 either way lose; with friction lowered to 0.3, those above 1 gain a tenth of
/// the iterations to 1e-4 at most and a fifth of those to 1e-6.
impl Default for LatinDd {
    fn default() -> Self {
        Self {
            subdomains: Grid::ONE,
            partition: Scheme::Boxes,
            relaxation: 0.8,
            kappa_l: None,
            kappa_t: 1.0,
            kappa_d: None,
            kappa_l_minus: None,
            kappa_l_plus: None,
            kappa_d_minus: None,
            kappa_d_plus: None,
            adaptive: None,
            coarse: false,
        }
    }
}

impl LatinDd {
    /// The directions that these settings mean on `problem`.
    pub fn directions<M: Mechanics>(&self, problem: &ContactProblem<M>) -> Directions {
        self.directions_with(|| derived_kappa(problem))
    }

    fn directions_with(&self, derived_kappa: impl FnOnce() -> f64) -> Directions {
        let kappa_l = self.kappa_l.unwrap_or_else(derived_kappa);
        let kappa_d = self.kappa_d.unwrap_or_else(|| self.kappa_l_plus.unwrap_or(kappa_l));
        Directions {
            l_minus: self.kappa_l_minus.unwrap_or(kappa_l),
            l_plus: self.kappa_l_plus.unwrap_or(kappa_l),
            d_minus: self.kappa_d_minus.unwrap_or(kappa_d),
            d_plus: self.kappa_d_plus.unwrap_or(kappa_d),
        }
    }

    /// Reports whether the directions adapt in a mechanics `M`.
    fn adapts<M: Mechanics>(&self) -> bool {
        let given = [
            self.kappa_l,
            self.kappa_d,
            self.kappa_l_minus,
            self.kappa_l_plus,
            self.kappa_d_minus,
            self.kappa_d_plus,
        ];
        self.adaptive.unwrap_or(!M::HAS_FRICTION && given.iter().all(Option::is_none))
    }

    /// The run that [`Solver::start`] begins, with its stages open to be taken alone.
    ///
    /// # Errors
    /// As there.
    pub fn run<'p, M, const D: usize, const T: usize>(
        &self,
        problem: &'p Packing<M>,
        r0: &[f64],
    ) -> Result<Run<'p, M, D, T>, SetupError>
    where
        M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
    {
        self.check()?;
        let directions = self.directions(problem);
        self.check_directions::<M>(&directions)?;
        self.bind(problem, directions, r0)
    }

    fn check(&self) -> Result<(), SetupError> {
        let is_share = self.relaxation > 0.0 && self.relaxation <= 1.0;
        SetupError::unless(is_share, "relaxation", self.relaxation, "above 0 and at most 1")?;
        for (key, value) in [("kappa_l", self.kappa_l), ("kappa_d", self.kappa_d)] {
            value.map_or(Ok(()), |value| SetupError::unless_positive(key, value))?;
        }
        SetupError::unless_positive("kappa_t", self.kappa_t)
    }

    fn check_directions<M: Mechanics>(&self, directions: &Directions) -> Result<(), SetupError> {
        directions.check()?;
        if self.adapts::<M>() && directions.l_minus == 0.0 {
            return Err(SetupError::new("adaptive", true, "false where kappa_l_minus is 0"));
        }
        if self.coarse && directions.d_minus == 0.0 {
            return Err(SetupError::new("coarse", true, "false where kappa_d_minus is 0"));
        }
        Ok(())
    }
}

impl<M, const D: usize, const T: usize> Solver<M> for LatinDd
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.run(problem, r0)?))
    }
}

impl<M, const D: usize, const T: usize> Distributed<M> for LatinDd
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    fn start_in<'p>(
        &self,
        share: &'p Share<M>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let whole = &share.whole;
        self.check()?;
        let steepest = directions::steepest(team.max(directions::greatest_friction(&share.problem)));
        let directions = self.directions_with(|| {
            directions::kappa_of(whole.depth, whole.contacts, whole.grains).min(steepest)
        });
        self.check_directions::<M>(&directions)?;
        let velocity = share.velocity(r0, team);
        let scaled_delassus_bound = whole.scaled_delassus_bound;
        let beginning = Beginning { directions, scaled_delassus_bound, start: (r0, &velocity) };
        let run = self.begin(&share.problem, Cow::Borrowed(&share.decomposition), team, &beginning)?;
        Ok(Box::new(run))
    }
}
