//! LATIN by subdomains (LATIN-DD), §4.1: a linear stage per subdomain and a local stage per contact and per boundary
//! grain take turns, joined by search directions, eq. (4)-(7).
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §4.1. Conjugate directions (l⁻ = l⁺, d⁻ = d⁺) make it a
//! Peaceman-Rachford splitting (μ = 1) or ADMM (μ = ½), which converges for 0 < μ < 1 and any positive direction. Cost of
//! an iteration: one pair of triangular solves per subdomain, two passes over the contacts, and the gluing.

mod balance;
mod coarse;
mod directions;
mod factor;
mod subdomain;
#[cfg(test)]
mod tests;

pub use directions::{Directions, derived_kappa};

use balance::Balance;
use coarse::Coarse;
use contact::{ContactProblem, Iteration, SetupError, Solver, Work};
use documented::DocumentedFields;
use nalgebra::Vector2;
use partition::{Decomposition, Grid, Scheme};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use subdomain::Latin;

/// Settings of LATIN-DD.
#[derive(Clone, Copy, Debug, PartialEq, DocumentedFields, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LatinDd {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// How the contacts are distributed.
    pub partition: Scheme,
    /// μ (–), in (0, 1]: the share of a new local stage that the next linear stage takes.
    pub relaxation: f64,
    /// κ_l of conjugate directions at contacts, l⁻ = l⁺ = κ_l/W_αα (–); without it [`derived_kappa`].
    pub kappa_l: Option<f64>,
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
    /// Whether all directions are scaled a few times so that impulses and velocities change alike; without it, where no
    /// direction is given.
    pub adaptive: Option<bool>,
    /// Whether a coarse problem keeps the resultants of every interface at zero.
    pub coarse: bool,
}

/// One subdomain, derived directions that adapt, and μ = 0.8, which converges for any of them.
impl Default for LatinDd {
    fn default() -> Self {
        Self {
            subdomains: Grid::ONE,
            partition: Scheme::Boxes,
            relaxation: 0.8,
            kappa_l: None,
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
    pub fn directions(&self, problem: &ContactProblem) -> Directions {
        let kappa_l = self.kappa_l.unwrap_or_else(|| derived_kappa(problem));
        let kappa_d = self.kappa_d.unwrap_or_else(|| self.kappa_l_plus.unwrap_or(kappa_l));
        Directions {
            l_minus: self.kappa_l_minus.unwrap_or(kappa_l),
            l_plus: self.kappa_l_plus.unwrap_or(kappa_l),
            d_minus: self.kappa_d_minus.unwrap_or(kappa_d),
            d_plus: self.kappa_d_plus.unwrap_or(kappa_d),
        }
    }

    /// Whether the directions adapt.
    fn adapts(&self) -> bool {
        let given = [
            self.kappa_l,
            self.kappa_d,
            self.kappa_l_minus,
            self.kappa_l_plus,
            self.kappa_d_minus,
            self.kappa_d_plus,
        ];
        self.adaptive.unwrap_or(given.iter().all(Option::is_none))
    }
}

/// Below this many contacts, waking the threads costs more than they save. The result does not depend on it.
const WORTH_THREADS: usize = 2_000;

struct Run<'p> {
    problem: &'p ContactProblem,
    decomposition: Decomposition,
    subdomains: Vec<Latin>,
    directions: Directions,
    relaxation: f64,
    coarse: Option<Coarse>,
    balance: Option<Balance>,
    velocity_jump: f64,
    iterations: u64,
    work: Work,
}

impl Iteration for Run<'_> {
    fn advance(&mut self) {
        let relaxation = self.relaxation;
        self.in_subdomains(Latin::linear_stage);
        if let Some(coarse) = &self.coarse {
            coarse.correct(&mut self.subdomains);
        }
        let factor = self.balance.as_mut().and_then(|balance| {
            balance.factor(self.iterations + 1, self.directions.l_minus, &self.subdomains)
        });
        self.in_subdomains(|subdomain| subdomain.local_stage(relaxation));
        self.velocity_jump = self.interface();
        self.iterations += 1;
        self.count();
        if let Some(factor) = factor {
            self.turn(self.directions.scaled(factor));
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        self.decomposition.in_problem_order(self.subdomains.iter().map(Latin::impulses), r);
    }

    fn velocity_jump(&self) -> f64 {
        self.velocity_jump
    }

    fn derived(&self) -> Vec<(&'static str, f64)> {
        let Directions { l_minus, l_plus, d_minus, d_plus } = self.directions;
        vec![
            ("kappa_l_minus", l_minus),
            ("kappa_l_plus", l_plus),
            ("kappa_d_minus", d_minus),
            ("kappa_d_plus", d_plus),
        ]
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl Run<'_> {
    fn in_subdomains(&mut self, stage: impl Fn(&mut Latin) + Sync + Send) {
        if self.subdomains.len() > 1 && self.problem.contact_count() >= WORTH_THREADS {
            self.subdomains.par_iter_mut().for_each(stage);
        } else {
            self.subdomains.iter_mut().for_each(stage);
        }
    }

    /// Takes other directions; where they cannot be factorised, the old ones stay.
    fn turn(&mut self, directions: Directions) {
        let factors: Result<Vec<_>, _> =
            self.subdomains.par_iter().map(|subdomain| subdomain.factorise(&directions)).collect();
        let Ok(factors) = factors else { return };
        for (subdomain, factor) in self.subdomains.iter_mut().zip(factors) {
            subdomain.turn(&directions, factor);
        }
        self.directions = directions;
        self.work.factorisations += self.subdomains.len() as u64;
        if self.coarse.is_some() {
            self.assemble_coarse();
        }
    }

    /// The coarse problem for the present factors; none, where it cannot be factorised.
    fn assemble_coarse(&mut self) {
        let kappa = self.directions.d_minus;
        self.coarse = Coarse::new(self.problem, &self.decomposition, &self.subdomains, kappa).ok();
        self.work.factorisations += 1;
    }

    /// Adds the work of one iteration.
    fn count(&mut self) {
        let entries: usize = self.subdomains.iter().map(Latin::factor_entries).sum();
        let coarse = self.coarse.as_ref();
        let (entries_of_coarse, values_of_coarse) =
            coarse.map_or((0, 0), |coarse| (coarse.entries(), 4 * coarse.interfaces()));
        self.work.contact_updates += self.problem.contact_count() as u64;
        self.work.interface_values += (2 * self.decomposition.copy_count() + values_of_coarse) as u64;
        self.work.triangular_solve_entries += (2 * entries + entries_of_coarse) as u64;
    }

    /// Local stage of the boundary grains, with F_E = τ − d⁻ V_E:
    /// V̂ = Σ_E (d⁺ V_E − F_E) / Σ_E d⁺,   F̂_E = F_E + d⁺ (V̂ − V_E)     (3) (7);   τ ← τ + μ (F̂ + d⁻ V̂ − τ)
    ///
    /// Returns the greatest |V_E − V̄| (m/s).
    fn interface(&mut self) -> f64 {
        let Self { decomposition, subdomains, directions, relaxation, problem, .. } = self;
        let mut jump: f64 = 0.0;
        for copies in decomposition.boundary() {
            let (e, local) = copies[0];
            let grain = decomposition.subdomains[e as usize].grains[local as usize] as usize;
            let mass = problem.mass()[grain] / copies.len() as f64;
            let (d_minus, d_plus) = (directions.d_minus * mass, directions.d_plus * mass);
            let (mut sum, mut mean) = (Vector2::zeros(), Vector2::zeros());
            for (e, local) in copies {
                let (v, tau) = subdomains[*e as usize].boundary(*local);
                sum += (d_plus + d_minus) * v - *tau;
                mean += v / copies.len() as f64;
            }
            let v_hat = sum / (d_plus * copies.len() as f64);
            for (e, local) in copies {
                let (v, tau) = subdomains[*e as usize].boundary(*local);
                jump = jump.max((v - mean).norm());
                let f_hat = *tau - d_minus * v + d_plus * (v_hat - v);
                *tau += *relaxation * (f_hat + d_minus * v_hat - *tau);
            }
        }
        jump
    }
}

impl Solver for LatinDd {
    fn start<'p>(
        &self,
        problem: &'p ContactProblem,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        if !(self.relaxation > 0.0 && self.relaxation <= 1.0) {
            return Err(SetupError::new("relaxation", self.relaxation, "above 0 and at most 1"));
        }
        for (key, value) in [("kappa_l", self.kappa_l), ("kappa_d", self.kappa_d)] {
            value.map_or(Ok(()), |value| SetupError::unless_positive(key, value))?;
        }
        let directions = self.directions(problem);
        directions.check()?;
        if self.adapts() && directions.l_minus == 0.0 {
            return Err(SetupError::new("adaptive", true, "false where kappa_l_minus is 0"));
        }
        if self.coarse && directions.d_minus == 0.0 {
            return Err(SetupError::new("coarse", true, "false where kappa_d_minus is 0"));
        }
        Ok(Box::new(self.bind(problem, directions, r0)?))
    }
}

impl LatinDd {
    /// A run with these directions, factorised.
    fn bind<'p>(
        &self,
        problem: &'p ContactProblem,
        directions: Directions,
        r0: &[f64],
    ) -> Result<Run<'p>, SetupError> {
        let partition = self.partition.partition(problem, self.subdomains)?;
        let decomposition = Decomposition::new(problem, &partition);
        let mut start = vec![Vector2::zeros(); problem.grain_count()];
        problem.velocity(r0, &mut start);
        let subdomains = (0..decomposition.subdomains.len())
            .into_par_iter()
            .map(|e| Latin::new(problem, &decomposition, e, &directions, r0, &start))
            .collect::<Result<Vec<_>, _>>()?;
        let coarse = self
            .coarse
            .then(|| Coarse::new(problem, &decomposition, &subdomains, directions.d_minus))
            .transpose()?;
        let factorisations = subdomains.len() as u64 + u64::from(self.coarse);
        Ok(Run {
            problem,
            decomposition,
            subdomains,
            directions,
            relaxation: self.relaxation,
            coarse,
            balance: self.adapts().then(Balance::default),
            velocity_jump: 0.0,
            iterations: 0,
            work: Work { factorisations, ..Work::default() },
        })
    }
}
