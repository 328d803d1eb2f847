//! A run: the two stages in turn, with the interface between the subdomains, (3) and (7).

use crate::LatinDd;
use crate::balance::Balance;
use crate::coarse::Coarse;
use crate::directions::Directions;
use crate::sent::Sent;
use crate::stages::Stages;
use crate::subdomain::Latin;
use contact::memory::Reserved;
use contact::{ContactProblem, Discs, Iteration, Packing, SetupError, Vector, Work, threads};
use nalgebra::SVector;
use partition::{CopySums, Decomposition, Partition, Refused, Team};
use std::borrow::Cow;

/// Approximate cost of a stage per contact (ns).
const NS_PER_CONTACT: usize = 20;

/// LATIN-DD on one problem, with D unknowns of a grain, T of them translations. `advance` takes its stages in turn; alone, they are
/// for those who look at one of them.
pub struct Run<'p, M: Stages = Discs, const D: usize = 2, const T: usize = 2> {
    problem: &'p ContactProblem<M>,
    team: Team,
    /// Decomposition of the own subdomains.
    pub(crate) decomposition: Cow<'p, Decomposition>,
    pub(crate) subdomains: Vec<Latin<M, D>>,
    pub(crate) directions: Directions,
    relaxation: f64,
    pub(crate) coarse: Option<Coarse<D, T>>,
    balance: Option<Balance>,
    /// The memory of the factors of directions that are found on the way, beside that of those before.
    _second: Option<Reserved>,
    /// Sums of what [`Latin::send`] gives for each copy of a boundary grain.
    sums: CopySums<Sent<D>>,
    iterations: u64,
    work: Work,
}

impl<M, const D: usize, const T: usize> Iteration for Run<'_, M, D, T>
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    fn advance(&mut self) {
        self.linear_stage();
        let factor = self.balance.as_mut().and_then(|balance| {
            balance.factor(self.iterations + 1, self.directions.l_minus, &self.subdomains, &self.team)
        });
        self.local_stage();
        self.iterations += 1;
        self.count();
        if let Some(factor) = factor {
            self.turn(self.directions.scaled(factor));
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        for (subdomain, latin) in self.decomposition.subdomains.iter().zip(&self.subdomains) {
            for (contact, r_hat) in subdomain.contacts.iter().zip(&latin.r_hat) {
                r_hat.put(r, *contact as usize);
            }
        }
    }

    fn velocity_jump(&self) -> f64 {
        self.subdomains.iter().map(|subdomain| subdomain.velocity_jump).fold(0.0, f64::max)
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

    /// Multiply-adds of the longest subdomain: eight per unknown of a contact, one per entry of its factor in each pass, one per value
    /// exchanged; and the coarse problem, which waits for all.
    fn critical_path(&self) -> Option<u64> {
        let work = |latin: &Latin<M, D>| {
            let unknowns = M::Impulse::LEN * latin.r_hat.len();
            8 * unknowns + 2 * latin.factor.entries() + D * latin.boundary.len()
        };
        let longest = self.subdomains.iter().map(work).max().unwrap_or(0);
        let [factor, influences] = self.coarse.as_ref().map_or([0; 2], Coarse::entries);
        let longest = self.team.max(longest as f64) as u64;
        Some(longest + factor as u64 + self.team.count(influences as u64))
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl<M, const D: usize, const T: usize> Run<'_, M, D, T>
where
    M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
{
    /// The linear stage of all subdomains, (1) (4) (5), and the coarse problem.
    pub fn linear_stage(&mut self) {
        self.in_subdomains(Latin::linear_stage);
        if let Some(coarse) = &mut self.coarse {
            coarse.correct(&mut self.subdomains);
        }
    }

    /// The local stage of all contacts, (2) (6), and of the boundary grains, (3) (7).
    pub fn local_stage(&mut self) {
        let (nanoseconds, relaxation) = (self.nanoseconds(), self.relaxation);
        let Self { subdomains, sums, .. } = self;
        sums.send(subdomains, nanoseconds, |latin, sent| {
            latin.local_stage(relaxation);
            latin.send(sent);
        });
        sums.receive(subdomains, 0, |latin, sums| latin.interface(relaxation, sums));
    }

    pub(crate) fn in_subdomains(&mut self, stage: impl Fn(&mut Latin<M, D>) + Sync) {
        let nanoseconds = self.nanoseconds();
        threads::each(&mut self.subdomains, nanoseconds, &|_, latin| stage(latin));
    }

    /// Returns the approximate cost of a stage (ns).
    fn nanoseconds(&self) -> usize {
        NS_PER_CONTACT * self.problem.contact_count()
    }

    /// Takes other directions; where a matrix of theirs cannot be factorised, all stays as it is.
    pub(crate) fn turn(&mut self, directions: Directions) {
        let subdomains = &self.subdomains;
        let factors = threads::make(subdomains.len(), &|e| subdomains[e].factorise(&directions));
        let factors: Result<Vec<_>, _> = factors.into_iter().collect();
        self.count_factorisations();
        if !self.team.all(factors.is_ok()) {
            return;
        }
        let Ok(factors) = factors else { return };
        if self.coarse.is_some() {
            let factor_of = |e: usize| &factors[e];
            let (cut, kappa) = ((&*self.decomposition, &self.team), directions.d_minus);
            let coarse = Coarse::new(self.problem, cut, &self.subdomains, factor_of, kappa);
            let Ok(coarse) = coarse else { return };
            self.coarse = Some(coarse);
        }
        for (subdomain, factor) in self.subdomains.iter_mut().zip(factors) {
            subdomain.turn(&directions, factor);
        }
        self.directions = directions;
    }

    /// A factorisation of each own subdomain's matrix, and of the coarse one, which is counted once.
    fn count_factorisations(&mut self) {
        let of_subdomains = self.subdomains.iter().map(|latin| latin.factor.structure().work());
        let coarse = self.coarse.as_ref().filter(|_| self.team.rank() == 0);
        for multiply_adds in of_subdomains.chain(coarse.map(Coarse::factorisation)) {
            self.work.factorisations += 1;
            self.work.factorisation_multiply_adds += multiply_adds;
        }
    }

    /// Adds the work of one iteration.
    fn count(&mut self) {
        let entries: usize = self.subdomains.iter().map(|latin| latin.factor.entries()).sum();
        let once = usize::from(self.team.rank() == 0);
        let (entries_of_coarse, values_of_coarse) = self.coarse.as_ref().map_or((0, 0), |coarse| {
            let [factor, influences] = coarse.entries();
            (once * factor + influences, once * 2 * T * coarse.interfaces())
        });
        self.work.contact_updates += self.problem.contact_count() as u64;
        self.work.interface_values += (D * self.decomposition.copy_count() + values_of_coarse) as u64;
        self.work.triangular_solve_entries += (2 * entries + entries_of_coarse) as u64;
    }
}

/// The whole problem's numbers that directions adapt by, or a rank's share of the problem begins with.
pub(crate) struct Beginning<'r, const D: usize> {
    pub(crate) directions: Directions,
    /// Λ ≥ λmax(W_D⁻¹ W) (–), where the directions adapt.
    pub(crate) scaled_delassus_bound: f64,
    /// Impulses (N·s), and the velocities of their grains (m/s).
    pub(crate) start: (&'r [f64], &'r [SVector<f64, D>]),
}

impl LatinDd {
    /// A run on the whole problem, with these directions, factorised.
    pub(crate) fn bind<'p, M, const D: usize, const T: usize>(
        &self,
        problem: &'p Packing<M>,
        directions: Directions,
        r0: &[f64],
    ) -> Result<Run<'p, M, D, T>, SetupError>
    where
        M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
    {
        let partition = Partition::of_contacts(problem, self.partition, self.subdomains)?;
        let decomposition = Decomposition::new(problem, &partition);
        let team = Team::alone(decomposition.subdomains.len());
        let scaled_delassus_bound =
            if self.adapts::<M>() { M::scaled_delassus_bound(problem) } else { f64::NAN };
        let mut velocity = vec![SVector::zeros(); problem.grain_count()];
        problem.velocity(r0, &mut velocity);
        let beginning = Beginning { directions, scaled_delassus_bound, start: (r0, &velocity) };
        Ok(self.begin(problem, Cow::Owned(decomposition), &team, &beginning)?)
    }

    /// A run on the subdomains of `decomposition`, which are all or those of a rank.
    pub(crate) fn begin<'p, M, const D: usize, const T: usize>(
        &self,
        problem: &'p Packing<M>,
        decomposition: Cow<'p, Decomposition>,
        team: &Team,
        &Beginning { directions, scaled_delassus_bound, start: (r0, velocity) }: &Beginning<'_, D>,
    ) -> Result<Run<'p, M, D, T>, Refused>
    where
        M: Stages<Velocity = SVector<f64, D>, Place = SVector<f64, T>>,
    {
        let subdomains = threads::make(decomposition.subdomains.len(), &|e| {
            Latin::new(problem, &decomposition, e, (&directions, self.kappa_t), r0, velocity)
        });
        let subdomains: Vec<_> = team.unless_refused(subdomains.into_iter().collect())?;
        let coarse = self
            .coarse
            .then(|| {
                let factor_of = |e: usize| &subdomains[e].factor;
                Coarse::new(problem, (&decomposition, team), &subdomains, factor_of, directions.d_minus)
            })
            .transpose()?;
        let bytes = subdomains.iter().map(Latin::factor_bytes).sum();
        let second = team.unless_refused(self.adapts::<M>().then(|| Reserved::new(bytes)).transpose())?;
        let balance = self.adapts::<M>().then(|| {
            let iterates = subdomains.iter().flat_map(Latin::linear_iterate).count();
            Balance::new::<M>(scaled_delassus_bound, iterates, self.kappa_t)
        });
        let mut run = Run {
            problem,
            team: team.clone(),
            sums: CopySums::over(&decomposition, team),
            decomposition,
            subdomains,
            directions,
            relaxation: self.relaxation,
            coarse,
            balance,
            _second: second,
            iterations: 0,
            work: Work::default(),
        };
        run.count_factorisations();
        Ok(run)
    }
}
