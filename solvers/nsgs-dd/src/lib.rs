//! Non-linear Gauss-Seidel by subdomains (NSGS-DD), §4.2: each subdomain sweeps over its own contacts with split
//! masses, the interface impulses kept; then the copies of the boundary grains are glued, eq. (3).
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §4.2. With split masses and 0 < ω < 2, q(r) never increases without friction, for
//! any number of subdomains and of inner sweeps. Cost of an iteration: `inner_sweeps` sweeps over all contacts, and the gluing.

mod subdomain;

use contact::{Iteration, Mass, Mechanics, Packing, SetupError, Solver, Vector, Work, threads};
use partition::{CopySums, Decomposition, Distributed, Grid, Partition, Refused, Scheme, Share, Team};
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

struct Run<M: Mechanics> {
    team: Team,
    sweepers: Vec<Sweeper<M>>,
    sums: CopySums<M::Velocity>,
    /// Contacts of each group of own subdomains: those of one group work at the same time, group after group.
    groups: Vec<usize>,
    settings: NsgsDd,
    iterations: u64,
}

impl<M: Mechanics> Iteration for Run<M> {
    fn advance(&mut self) {
        self.sweepers.iter_mut().for_each(|sweeper| sweeper.velocity_jump = 0.0);
        for group in 0..self.groups.len() {
            self.sweep_and_glue(group);
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweepers.iter().for_each(|sweeper| sweeper.sweep.impulses(r));
    }

    fn velocity_jump(&self) -> f64 {
        self.sweepers.iter().map(|sweeper| sweeper.velocity_jump).fold(0.0, f64::max)
    }

    /// Multiply-adds of the longest subdomain of each group: eight per unknown of a contact updated, one per value exchanged.
    fn critical_path(&self) -> Option<u64> {
        let sweeps = self.settings.inner_sweeps as usize;
        let mut longest = vec![0; self.groups.len()];
        for sweeper in &self.sweepers {
            let longest = &mut longest[sweeper.group];
            *longest = (8 * M::Impulse::LEN * sweeps * sweeper.sweep.rows.len()
                + M::Velocity::LEN * sweeper.copies.len())
            .max(*longest);
        }
        Some(longest.iter().map(|longest| self.team.max(*longest as f64) as u64).sum())
    }

    fn work(&self) -> Work {
        let contacts: usize = self.groups.iter().sum();
        let copies: usize = self.sweepers.iter().map(|sweeper| sweeper.copies.len()).sum();
        let sweeps = self.iterations * u64::from(self.settings.inner_sweeps);
        Work {
            contact_updates: sweeps * contacts as u64,
            // Every copy belongs to one group and sends its components once per iteration.
            interface_values: self.iterations * (M::Velocity::LEN * copies) as u64,
            ..Work::default()
        }
    }
}

/// What an update of a contact takes, about (ns).
const NS_PER_UPDATE: usize = 5;

impl<M: Mechanics> Run<M> {
    /// From the glued velocity, `inner_sweeps` sweeps in each subdomain of `group`, F fixed; then the copies of all are brought
    /// together.
    fn sweep_and_glue(&mut self, group: usize) {
        let NsgsDd { inner_sweeps: sweeps, relaxation, mass_splitting, .. } = self.settings;
        let updates = self.groups[group] * sweeps as usize;
        let Self { sweepers, sums, .. } = self;
        sums.send(sweepers, NS_PER_UPDATE * updates, |sweeper, sent| {
            if sweeper.group == group {
                (0..sweeps).for_each(|_| sweeper.sweep.forward(relaxation));
            }
            sweeper.send(mass_splitting, sent);
        });
        sums.receive(sweepers, 0, |sweeper, sums| sweeper.glue(mass_splitting, sums));
    }
}

impl<M: Mechanics> Solver<M> for NsgsDd {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        self.check()?;
        let partition = Partition::of_contacts(problem, self.partition, self.subdomains)?;
        let decomposition = Decomposition::new(problem, &partition);
        let team = Team::alone(decomposition.subdomains.len());
        // Every copy starts at V_free + M⁻¹ H r0.
        let mut start = vec![M::Velocity::ZERO; problem.grain_count()];
        problem.velocity(r0, &mut start);
        Ok(Box::new(self.bind(problem, &decomposition, &team, (r0, &start))))
    }
}

impl<M: Mechanics> Distributed<M> for NsgsDd {
    fn start_in<'p>(
        &self,
        share: &'p Share<M>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        self.check()?;
        let start = share.velocity(r0, team);
        Ok(Box::new(self.bind(&share.problem, &share.decomposition, team, (r0, &start))))
    }
}

impl NsgsDd {
    fn check(&self) -> Result<(), SetupError> {
        SetupError::unless(self.inner_sweeps > 0, "inner_sweeps", 0, "at least 1")?;
        SetupError::unless_positive("relaxation", self.relaxation)
    }

    /// A run on the subdomains of `decomposition`, which are all or those of a rank, from impulses and their velocities.
    fn bind<M: Mechanics>(
        &self,
        problem: &Packing<M>,
        decomposition: &Decomposition,
        team: &Team,
        start: (&[f64], &[M::Velocity]),
    ) -> Run<M> {
        let Decomposition { subdomains, multiplicity, .. } = decomposition;
        let inverse_mass = |grain: u32| {
            let share = if self.mass_splitting { multiplicity[grain as usize] } else { 1 };
            problem.mass()[grain as usize].inverse(f64::from(share))
        };
        let of_all = match self.exchange {
            Exchange::Jacobi => vec![0; team.subdomains()],
            Exchange::GaussSeidel => decomposition.colours(team),
        };
        let mut groups = vec![0; of_all.iter().max().map_or(0, |greatest| *greatest as usize + 1)];
        let of_subdomain = &of_all[team.mine()];
        for (group, subdomain) in of_subdomain.iter().zip(subdomains) {
            groups[*group as usize] += subdomain.contacts.len();
        }
        let sweeper = |e: usize| {
            Sweeper::new(problem, &subdomains[e], of_subdomain[e], &inverse_mass, multiplicity, start)
        };
        Run {
            team: team.clone(),
            sweepers: threads::make(subdomains.len(), &sweeper),
            sums: CopySums::over(decomposition, team),
            groups,
            settings: *self,
            iterations: 0,
        }
    }
}
