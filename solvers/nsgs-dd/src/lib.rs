//! Non-linear Gauss-Seidel by subdomains (NSGS-DD), §4.2: each subdomain sweeps over its own contacts with split
//! masses, the interface impulses kept; then the copies of the boundary grains are glued, eq. (3).
//!
//! Iceta, Dureisseix, Alart, Giens 2009, hal-00413720, §4.2. With split masses and 0 < ω < 2, q(r) never increases without friction, for
//! any number of subdomains and of inner sweeps; where contacts wait for each other as well (`contact_exchange`, a reading that the paper's words
//! leave open), only for small ω. Cost of an iteration: `inner_sweeps` sweeps over all contacts, and the gluing. With
//! acceleration ([`contact::acceleration`]) impulses and glued velocities are extrapolated at the beginning of an iteration: copies of
//! a grain have one velocity there, and one β, so nothing more is exchanged but two sums.

mod subdomain;

use contact::acceleration::{Acceleration, LAG, Momentum};
use contact::{Iteration, Mass, Mechanics, Packing, SetupError, Solver, Vector, Work, threads};
use partition::{CopySums, Decomposition, Distributed, Grid, Partition, Refused, Scheme, Share, Team};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use subdomain::{Sweeper, scaled};

/// Settings of NSGS-DD.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NsgsDd {
    /// Subdomains, as columns × rows.
    pub subdomains: Grid,
    /// Scheme by which the contacts are distributed.
    pub partition: Scheme,
    /// `n_in`: sweeps of each subdomain between two gluings.
    pub inner_sweeps: u32,
    /// ω of the sweeps (–): 1 solves (2) exactly at each contact; above, over-relaxation.
    pub relaxation: f64,
    /// When a subdomain sees what the others did.
    pub exchange: Exchange,
    /// When a contact sees what the others of its subdomain did.
    pub contact_exchange: Exchange,
    /// Mass splitting: each copy of a boundary grain has its share `M_i/m_i` of the mass. Without it (Schwarz) each copy has
    /// the whole mass and the changes of velocity are added up; nothing bounds q(r) then.
    pub mass_splitting: bool,
    /// Extrapolation over the iterations.
    pub acceleration: Acceleration,
    /// q (–): the extrapolation grows as β = j/(j + q) over the j iterations since the last restart.
    pub lag: f64,
    /// ρ (–): acceleration restarts also where an iteration changes the impulses more than ρ times as much as the least since the last
    /// restart; unless given 1.2 with friction, and 5 without.
    pub slack: Option<f64>,
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
            contact_exchange: Exchange::GaussSeidel,
            mass_splitting: true,
            acceleration: Acceleration::None,
            lag: LAG,
            slack: None,
        }
    }
}

/// When one sees what the others did: a subdomain, or a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exchange {
    /// After all of them. Subdomains all at once, then one gluing: the paper's. Contacts all at once: converges for ω < 2/λmax(`W_D`⁻¹ W)
    /// only, as `jacobi`.
    Jacobi,
    /// After each colour of subdomains, which share no grain: one gluing per colour. After each contact.
    GaussSeidel,
}

struct Run<M: Mechanics> {
    team: Team,
    sweepers: Vec<Sweeper<M>>,
    sums: CopySums<M::Velocity>,
    /// True where copies have sent their velocities and are not yet glued.
    is_apart: bool,
    /// Contacts of each group of own subdomains: those of one group work at the same time, group after group.
    groups: Vec<usize>,
    settings: NsgsDd,
    momentum: Option<Momentum>,
    /// |g|² and ⟨g, d⟩ of each own subdomain (J).
    progress: Vec<[f64; 2]>,
    iterations: u64,
    restarts: u64,
}

impl<M: Mechanics> Iteration for Run<M> {
    fn advance(&mut self) {
        if self.momentum.as_ref().is_some_and(Momentum::has_restarted) {
            self.renew();
        }
        for group in 0..self.groups.len() {
            self.glue_and_sweep(group);
        }
        if let Some(momentum) = &mut self.momentum {
            let of_subdomains = self.progress.iter_mut().zip(&self.sweepers);
            of_subdomains.for_each(|(sums, sweeper)| *sums = sweeper.progress());
            momentum.turn(self.team.sum_of(&self.progress));
        }
        self.iterations += 1;
    }

    fn impulses(&self, r: &mut [f64]) {
        self.sweepers.iter().for_each(|sweeper| sweeper.sweep.impulses(r));
    }

    fn velocity_jump(&self) -> f64 {
        let mass_splitting = self.settings.mass_splitting;
        let of = |(e, sweeper): (usize, &Sweeper<M>)| {
            let last = if self.is_apart { sweeper.jump(mass_splitting, self.sums.sums(e)) } else { 0.0 };
            sweeper.velocity_jump.max(last)
        };
        self.sweepers.iter().enumerate().map(of).fold(0.0, f64::max)
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
            interface_values: (self.iterations + self.restarts) * (M::Velocity::LEN * copies) as u64,
            // H r alone, half of a product.
            delassus_products: self.restarts.div_ceil(2),
            ..Work::default()
        }
    }
}

/// Approximate cost of an update of a contact (ns).
const NS_PER_UPDATE: usize = 5;

impl<M: Mechanics> Run<M> {
    /// Glues the copies, if they are apart; then makes `inner_sweeps` sweeps in each subdomain of `group` from the glued velocity, F fixed.
    fn glue_and_sweep(&mut self, group: usize) {
        let NsgsDd { inner_sweeps: sweeps, relaxation, mass_splitting, .. } = self.settings;
        let updates = self.groups[group] * sweeps as usize;
        let Self { sweepers, sums, momentum, is_apart, .. } = self;
        let factor = momentum.as_ref().map(Momentum::factor);
        sums.exchange(sweepers, NS_PER_UPDATE * updates, |sweeper, sums, sent| {
            if *is_apart {
                sweeper.glue(mass_splitting, sums);
            }
            if group == 0 {
                sweeper.begin(factor);
            }
            if sweeper.group == group {
                sweeper.advance(sweeps, relaxation);
            }
            sweeper.send(mass_splitting, sent);
        });
        *is_apart = true;
    }

    /// Makes the velocities of all subdomains anew from their impulses.
    fn renew(&mut self) {
        let mass_splitting = self.settings.mass_splitting;
        let contacts: usize = self.groups.iter().sum();
        self.sums.send(&mut self.sweepers, NS_PER_UPDATE * contacts, |sweeper, sent| {
            sweeper.renew();
            sweeper.send(mass_splitting, sent);
        });
        self.is_apart = true;
        self.restarts += 1;
    }
}

impl<M: Mechanics> Solver<M> for NsgsDd {
    fn start<'p>(&self, problem: &'p Packing<M>, r0: &[f64]) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let momentum = self.check()?;
        let partition = Partition::of_contacts(problem, self.partition, self.subdomains)?;
        let decomposition = Decomposition::new(problem, &partition);
        let team = Team::alone(decomposition.subdomains.len());
        // Every copy starts at V_free + M⁻¹ H r0.
        let mut start = vec![M::Velocity::ZERO; problem.grain_count()];
        problem.velocity(r0, &mut start);
        Ok(Box::new(self.bind(problem, &decomposition, &team, momentum, (r0, &start))))
    }
}

impl<M: Mechanics> Distributed<M> for NsgsDd {
    fn start_in<'p>(
        &self,
        share: &'p Share<M>,
        r0: &[f64],
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let momentum = self.check()?;
        let start = share.velocity(r0, team);
        Ok(Box::new(self.bind(&share.problem, &share.decomposition, team, momentum, (r0, &start))))
    }
}

impl NsgsDd {
    fn check(&self) -> Result<Option<Momentum>, SetupError> {
        SetupError::unless(self.inner_sweeps > 0, "inner_sweeps", 0, "at least 1")?;
        SetupError::unless_positive("relaxation", self.relaxation)?;
        self.acceleration.momentum(self.lag, self.slack)
    }

    /// A run on the subdomains of `decomposition`, which are all or those of a rank, from impulses and their velocities.
    fn bind<M: Mechanics>(
        &self,
        problem: &Packing<M>,
        decomposition: &Decomposition,
        team: &Team,
        momentum: Option<Momentum>,
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
            let mut sweeper =
                Sweeper::new(problem, &subdomains[e], of_subdomain[e], &inverse_mass, multiplicity, start);
            sweeper.old_y = (self.contact_exchange == Exchange::Jacobi).then(|| sweeper.sweep.y.clone());
            sweeper.trail = momentum.map(|_| {
                let free = scaled(problem.free_velocity(), &subdomains[e], &inverse_mass);
                sweeper.sweep.trail(free)
            });
            sweeper
        };
        Run {
            team: team.clone(),
            sweepers: threads::make(subdomains.len(), &sweeper),
            sums: CopySums::over(decomposition, team),
            is_apart: false,
            groups,
            settings: *self,
            momentum: momentum.map(|momentum| momentum.of_problem(M::HAS_FRICTION)),
            progress: vec![[0.0; 2]; subdomains.len()],
            iterations: 0,
            restarts: 0,
        }
    }
}
