//! Non-linear Gauss-Seidel by subdomains (NSGS-DD), §4.2: each subdomain sweeps over its own contacts with split
//! masses, the interface impulses kept; then the copies of the boundary grains are glued, eq. (3).
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §4.2. With split masses and 0 < ω < 2, q(r) never increases, for
//! any number of subdomains and of inner sweeps. Cost of an iteration: `inner_sweeps` sweeps over all contacts, and the gluing.

mod exchange;
mod subdomain;

use contact::{Iteration, Packing, SetupError, Solver, Work, together};
use exchange::{Colours, add_increments};
use nalgebra::Vector2;
use partition::{Decomposition, Grid, Scheme};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use subdomain::Sweeper;

/// Settings of NSGS-DD.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NsgsDd {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// How the contacts are distributed.
    pub partition: Scheme,
    /// `n_in`: sweeps of each subdomain between two gluings.
    pub inner_sweeps: u32,
    /// ω of the sweeps (–): 1 solves (2) exactly at each contact; above, over-relaxation.
    pub relaxation: f64,
    /// When a subdomain sees what the others did.
    pub exchange: Exchange,
    /// Whether each copy of a boundary grain has its share `M_i/m_i` of the mass. Without it (Schwarz) each copy has
    /// the whole mass and the changes of velocity are added up; nothing bounds q(r) then.
    pub mass_splitting: bool,
}

/// The paper's choices, on one subdomain.
impl Default for NsgsDd {
    fn default() -> Self {
        Self {
            subdomains: Grid::ONE,
            partition: Scheme::Boxes,
            inner_sweeps: 1,
            relaxation: 1.0,
            exchange: Exchange::Jacobi,
            mass_splitting: true,
        }
    }
}

/// When a subdomain sees what the others did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exchange {
    /// After all of them: all subdomains at once, then one gluing. The paper's.
    Jacobi,
    /// After each colour of subdomains, which share no grain: one gluing per colour.
    GaussSeidel,
}

struct Run {
    decomposition: Decomposition,
    sweepers: Vec<Sweeper>,
    /// y = M^½ V of the copies, with the copies' masses, subdomain by subdomain (√J).
    y: Vec<Vec<Vector2<f64>>>,
    /// 1/√mass of a copy of each boundary grain: V = y times it (kg^-½).
    unit: Vec<f64>,
    /// y of each boundary grain after the last gluing (√J).
    glued: Vec<Vector2<f64>>,
    /// Subdomains that work at the same time, group after group.
    groups: Colours,
    settings: NsgsDd,
    velocity_jump: f64,
    iterations: u64,
}

impl Iteration for Run {
    fn advance(&mut self) {
        self.velocity_jump = 0.0;
        for group in 0..self.groups.contacts.len() as u32 {
            self.sweep(group);
            self.velocity_jump = self.velocity_jump.max(self.glue());
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweepers.iter().for_each(|sweeper| sweeper.impulses(r));
    }

    fn velocity_jump(&self) -> f64 {
        self.velocity_jump
    }

    /// Multiply-adds of the longest subdomain of each group: eight per contact updated, one per value exchanged.
    fn critical_path(&self) -> Option<u64> {
        let sweeps = self.settings.inner_sweeps as usize;
        let mut longest = vec![0; self.groups.contacts.len()];
        let copies = self.decomposition.copies_by_subdomain();
        for ((sweeper, copies), group) in self.sweepers.iter().zip(copies).zip(&self.groups.of_subdomain) {
            let longest = &mut longest[*group as usize];
            *longest = (8 * sweeps * sweeper.contacts() + 2 * copies).max(*longest);
        }
        Some(longest.iter().sum::<usize>() as u64)
    }

    fn work(&self) -> Work {
        let contacts: usize = self.groups.contacts.iter().sum();
        let sweeps = self.iterations * u64::from(self.settings.inner_sweeps);
        Work {
            contact_updates: sweeps * contacts as u64,
            // Every copy belongs to one group and sends its two components once per iteration.
            interface_values: self.iterations * 2 * self.decomposition.copy_count() as u64,
            ..Work::default()
        }
    }
}

/// What an update of a contact takes, about (ns).
const NS_PER_UPDATE: usize = 5;

impl Run {
    /// From the glued velocity, `inner_sweeps` sweeps in each subdomain of `group`, F fixed.
    fn sweep(&mut self, group: u32) {
        let NsgsDd { inner_sweeps: sweeps, relaxation, .. } = self.settings;
        let colour = &self.groups.of_subdomain;
        let updates = self.groups.contacts[group as usize] * sweeps as usize;
        let work = |(e, (sweeper, y)): (usize, (&mut Sweeper, &mut Vec<Vector2<f64>>))| {
            if colour[e] == group {
                (0..sweeps).for_each(|_| sweeper.sweep(y, relaxation));
            }
        };
        let subdomains = self.sweepers.par_iter_mut().zip(&mut self.y).enumerate();
        subdomains.with_min_len(together(NS_PER_UPDATE * updates)).for_each(work);
    }

    /// Brings the copies together and returns the greatest disagreement before (m/s).
    fn glue(&mut self) -> f64 {
        let glue = if self.settings.mass_splitting { Decomposition::glue } else { add_increments };
        glue(&self.decomposition, &mut self.y, &self.unit, &mut self.glued)
    }
}

impl Solver for NsgsDd {
    fn start<'p>(&self, problem: &'p Packing, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        if self.inner_sweeps == 0 {
            return Err(SetupError::new("inner_sweeps", 0, "at least 1"));
        }
        SetupError::unless_positive("relaxation", self.relaxation)?;
        let partition = self.partition.partition(problem, self.subdomains)?;
        let decomposition = Decomposition::new(problem, &partition);
        let inverse_mass = |grain: u32| {
            let share = if self.mass_splitting { decomposition.multiplicity[grain as usize] } else { 1 };
            f64::from(share) / problem.mass()[grain as usize]
        };
        let sweepers = decomposition
            .subdomains
            .par_iter()
            .map(|subdomain| Sweeper::new(problem, subdomain, &inverse_mass, r0))
            .collect();

        // Every copy starts at V_free + M⁻¹ H r0.
        let mut start = vec![Vector2::zeros(); problem.grain_count()];
        problem.velocity(r0, &mut start);
        let y_of = |grain: &u32| start[*grain as usize] / inverse_mass(*grain).sqrt();
        let subdomains = decomposition.subdomains.iter();
        let y = subdomains.map(|subdomain| subdomain.grains.iter().map(y_of).collect()).collect();
        let glued = decomposition.boundary_grains().map(|grain| y_of(&grain)).collect();
        let unit = decomposition.boundary_grains().map(|grain| inverse_mass(grain).sqrt()).collect();
        let groups = match self.exchange {
            Exchange::Jacobi => Colours::all_at_once(&decomposition),
            Exchange::GaussSeidel => Colours::greedy(&decomposition),
        };
        let settings = *self;
        Ok(Box::new(Run {
            decomposition,
            sweepers,
            y,
            unit,
            glued,
            groups,
            settings,
            velocity_jump: 0.0,
            iterations: 0,
        }))
    }
}
