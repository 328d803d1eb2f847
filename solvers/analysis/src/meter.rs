//! Measures of iterates, recomputed from the impulses alone: on one machine, or of all ranks together. Each subdomain pushes its grains
//! and sums up its contacts, copies are added up in between, and the subdomains along a tree. One machine is a team of one with a single
//! subdomain.

mod partial;

use crate::infeasible::Proof;
use contact::mechanics::Gauge;
use contact::sums::{BLOCK, Sums};
use contact::{ContactProblem, Measures, Mechanics, Touch, Truth, Vector, law, ratio, threads};
use partition::{self, CopySums, Share, Team};

/// Approximate cost of an unknown (ns), and of a contact of a subdomain.
const NS_PER_UNKNOWN: usize = 3;
const NS_PER_CONTACT: usize = 20;

/// Meter of the iterates of runs on one problem. Where ranks share it, all must ask alike, and get the same answers.
pub struct Meter<'p, M: Mechanics> {
    problem: &'p ContactProblem<M>,
    share: Option<&'p Share<M>>,
    team: Team,
    parts: Vec<Part<M>>,
    /// Sums over the copies of grains, where a share may have some.
    copies: Option<CopySums<M::Velocity>>,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    solutions: Vec<Solution>,
    /// The iterate that [`Meter::measure`] measured before (N·s); empty before the first.
    previous: Vec<f64>,
    bounds: partial::Bounds,
}

/// Size of a known solution.
struct Solution {
    /// ‖V* − `V_free`‖_M (√J).
    distance: f64,
    /// q* (J).
    energy: f64,
}

/// A subdomain, or the whole problem.
struct Part<M: Mechanics> {
    gauge: M::Gauge,
    /// Its contacts in the list of the rank; `None` for all, in their order.
    contacts: Option<Vec<u32>>,
    /// Places of its copies of boundary grains.
    boundary: Vec<u32>,
    /// 1 over the number of copies of each grain: a sum over grains then counts each once.
    weight: Vec<f64>,
    /// y of the iterate measured last.
    y: Vec<M::Velocity>,
    /// y of each known solution.
    solutions: Vec<Vec<M::Velocity>>,
    blocks: Vec<Sums>,
    sums: Sums,
    /// The impulses of its own contacts, of the iterate before and of this one.
    own: [Vec<f64>; 2],
}

impl<M: Mechanics> Part<M> {
    fn new(gauge: M::Gauge, contacts: Option<Vec<u32>>, count: usize, weight: Vec<f64>) -> Self {
        Self {
            y: vec![M::Velocity::ZERO; gauge.places()],
            gauge,
            contacts,
            boundary: Vec::new(),
            weight,
            solutions: Vec::new(),
            blocks: vec![Sums::default(); count.div_ceil(BLOCK)],
            sums: Sums::default(),
            own: [Vec::new(), Vec::new()],
        }
    }

    /// Takes its impulses of an iterate `r` (N·s) and of the one `before`.
    fn take(&mut self, iterates: [&[f64]; 2]) {
        if let Some(contacts) = &self.contacts {
            for (own, r) in self.own.iter_mut().zip(iterates) {
                own.clear();
                if !r.is_empty() {
                    let numbers =
                        |k: &u32| M::Impulse::LEN * *k as usize..M::Impulse::LEN * (*k as usize + 1);
                    for k in contacts {
                        own.extend_from_slice(&r[numbers(k)]);
                    }
                }
            }
        }
    }

    /// Computes y of its own contacts.
    fn push(&mut self, r: &[f64]) {
        let Self { gauge, y, own: [_, own], contacts, .. } = self;
        let r = if contacts.is_some() { own } else { r };
        if threads::pay(NS_PER_UNKNOWN * r.len()) {
            let mut blocks: Vec<_> = y.chunks_mut(BLOCK).collect();
            threads::each(&mut blocks, usize::MAX, &|block, y| {
                (block * BLOCK..).zip(&mut **y).for_each(|(place, y)| *y = gauge.gather(place, r));
            });
        } else {
            gauge.push(r, y);
        }
    }

    /// Sums up its contacts, with y of the grains as they were pushed last; only the natural map, if `alone`.
    fn pull(&mut self, [before, r]: [&[f64]; 2], alone: bool) {
        let Self { gauge, y, own: [own_before, own], contacts, blocks, .. } = self;
        let [before, r]: [&[f64]; 2] = if contacts.is_some() { [own_before, own] } else { [before, r] };
        let length = M::Impulse::LEN;
        let count = r.len() / length;
        threads::each(blocks, NS_PER_UNKNOWN * r.len(), &|block, sums| {
            let here = block * BLOCK..count.min((block + 1) * BLOCK);
            let numbers = length * here.start..length * here.end;
            *sums = gauge.sums(here, r, y, alone);
            if !before.is_empty() {
                sums.take_change(&before[numbers.clone()], &r[numbers]);
            }
        });
        self.sums = Sums::default();
        for (block, sums) in self.blocks.iter().enumerate() {
            self.sums.join(sums, |k| block * BLOCK + k);
        }
    }

    /// Its part of ‖V − V*‖²_M (J), of the grains as they were pushed last and a solution; of ‖V − `V_free`‖²_M without one.
    fn squared_distance(&self, solution: Option<usize>) -> f64 {
        let squared = |grain: usize| {
            let to = solution.map_or(M::Velocity::ZERO, |k| self.solutions[k][grain]);
            self.weight[grain] * self.gauge.squared(grain, self.y[grain] - to)
        };
        let sum = |block: usize| {
            (block * BLOCK..self.weight.len().min((block + 1) * BLOCK)).map(squared).sum::<f64>()
        };
        (0..self.weight.len().div_ceil(BLOCK)).map(sum).sum()
    }
}

impl<'p, M: Mechanics> Meter<'p, M> {
    /// Prepares the measures on one machine.
    pub fn new(problem: &'p ContactProblem<M>) -> Self {
        let (contacts, grains) = (problem.contacts(), problem.grain_count());
        let gauge = problem.gauge(contacts.iter().map(Touch::ends).enumerate(), 0..grains);
        let part = Part::new(gauge, None, contacts.len(), vec![1.0; grains]);
        Self {
            problem,
            share: None,
            team: Team::alone(1),
            copies: None,
            scale: problem.scale(),
            solutions: Vec::new(),
            previous: Vec::new(),
            bounds: partial::Bounds::new::<M>(&part.gauge, problem),
            parts: vec![part],
        }
    }

    /// Prepares the measures of all ranks of a `team`, of which this one has a `share`.
    pub fn over(share: &'p Share<M>, team: &Team) -> Self {
        let problem = &*share.problem;
        let (b, w) = (problem.b(), problem.delassus_diagonal());
        let part = |e: &partition::Subdomain| {
            let contacts = e.contacts.iter().map(|k| *k as usize).zip(e.ends.iter().copied());
            let gauge = problem.gauge(contacts, e.grains.iter().map(|grain| *grain as usize));
            let multiplicity = |grain: &u32| f64::from(share.decomposition.multiplicity[*grain as usize]);
            let weight = e.grains.iter().map(|grain| 1.0 / multiplicity(grain)).collect();
            let part = Part::new(gauge, Some(e.contacts.clone()), e.contacts.len(), weight);
            Part { boundary: e.boundary.clone(), ..part }
        };
        let pushing = |e: &partition::Subdomain| {
            let term = |k: &u32| {
                let [b, w] = [&b, &w].map(|list| M::Impulse::at(list, *k as usize).first());
                law::non_negative(-b) * law::non_negative(-b) / w
            };
            [e.contacts.iter().map(term).sum()]
        };
        let subdomains = &share.decomposition.subdomains;
        let [scale] = team.sum(subdomains.iter().map(pushing));
        Self {
            problem,
            share: Some(share),
            team: team.clone(),
            parts: subdomains.iter().map(part).collect(),
            copies: Some(CopySums::over(&share.decomposition, team)),
            scale,
            solutions: Vec::new(),
            previous: Vec::new(),
            bounds: partial::Bounds::default(),
        }
    }

    /// Measures the distance to `truth` as well, a solution of the same problem; of several, to the nearest. For one machine.
    ///
    /// # Panics
    /// If the truth is that of another number of grains.
    #[must_use]
    pub fn against(mut self, truth: &Truth<M>) -> Self {
        let (problem, velocity) = (self.problem, truth.velocity());
        assert_eq!(velocity.len(), problem.grain_count(), "one true velocity per grain");
        let y = velocity.iter().zip(problem.free_velocity()).zip(problem.mass());
        let y = y.map(|((v, free), mass)| M::Gauge::scaled(*mass, *v - *free)).collect();
        self.parts[0].solutions.push(y);
        let distance = problem.velocity_distance(problem.free_velocity(), velocity);
        self.solutions.push(Solution { distance, energy: truth.energy() });
        self
    }

    /// Measures the distance to the solution with this rank's impulses `r` (N·s) as well; returns its natural map.
    pub fn against_impulses(&mut self, r: &[f64]) -> f64 {
        let Measures { natural_map, energy, .. } = self.measure_after(&[], r, 0.0);
        let distance = self.distance(None);
        self.parts.iter_mut().for_each(|part| part.solutions.push(part.y.clone()));
        self.solutions.push(Solution { distance, energy });
        natural_map
    }

    /// [`ContactProblem::scale`] of the whole problem (J).
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The greatest approach velocity of r = 0 (m/s).
    pub fn greatest_rate(&self) -> f64 {
        let rates = self.problem.b();
        self.team.max(rates.iter().step_by(M::Impulse::LEN).fold(0.0, |rate: f64, b| rate.max(-b)))
    }

    /// Reports the logical OR over all ranks.
    pub fn any(&self, here: bool) -> bool {
        !self.team.all(!here)
    }

    /// Reports whether one of the `rays`, or impulses near one, [proves](crate::proves_infeasible) that there is no solution.
    pub fn any_proves_infeasible(&self, rays: &[Vec<f64>]) -> bool {
        self.share
            .map_or_else(|| Proof::alone(self.problem), |share| Proof::of(share, &self.team))
            .any_proves_infeasible(rays)
    }

    /// Measures the iterate `r` (N·s); ζ compares it with the iterate measured before.
    pub fn measure(&mut self, r: &[f64], velocity_jump: f64) -> Measures {
        let mut previous = std::mem::take(&mut self.previous);
        let measures = self.measure_after(&previous, r, velocity_jump);
        previous.resize(r.len(), 0.0);
        previous.copy_from_slice(r);
        self.previous = previous;
        measures
    }

    /// Measures the iterate `r` (N·s); ζ compares it with the iterate `before`, which is empty if there is none.
    pub fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        self.push(before, r);
        let sums = self.pull([before, r], velocity_jump, false);
        let measures = sums.measures(self.scale);
        self.bounds.take(&measures);
        Measures {
            velocity_error: self.velocity_error(),
            energy_gap: self.energy_gap(measures.energy),
            ..measures
        }
    }

    /// Computes y of all grains; the iterate `before` is that of the pull to come.
    fn push(&mut self, before: &[f64], r: &[f64]) {
        let push = |part: &mut Part<M>| {
            part.take([before, r]);
            part.push(r);
        };
        let Some(copies) = &mut self.copies else { return self.parts.iter_mut().for_each(push) };
        let nanoseconds = NS_PER_CONTACT * self.problem.contact_count();
        copies.send(&mut self.parts, nanoseconds, |part, sent| {
            push(part);
            part.boundary.iter().zip(sent).for_each(|(place, sent)| *sent = part.y[*place as usize]);
        });
        copies.receive(&mut self.parts, nanoseconds, |part, sums| {
            part.boundary.iter().zip(sums).for_each(|(place, sum)| part.y[*place as usize] = sum);
        });
    }

    /// Sums up the contacts of all ranks, with the grains as they were pushed last; only the natural map, if `alone`.
    fn pull(&mut self, iterates: [&[f64]; 2], velocity_jump: f64, alone: bool) -> Sums {
        let nanoseconds = self.copies.as_ref().map_or(0, |_| NS_PER_CONTACT * self.problem.contact_count());
        threads::each(&mut self.parts, nanoseconds, &|_, part| part.pull(iterates, alone));
        let of_part = |part: &Part<M>| {
            let mut sums = Sums::default();
            sums.velocity_jump = velocity_jump;
            sums.join(&part.sums, |k| self.number(part, k));
            sums
        };
        if let ([part], true) = (&self.parts[..], self.team.size() == 1) {
            return of_part(part);
        }
        let joined = |a, b| {
            let mut sums = Sums::of(a);
            sums.join(&Sums::of(b), |k| k);
            sums.numbers()
        };
        Sums::of(self.team.join(self.parts.iter().map(|part| of_part(part).numbers()), joined))
    }

    /// The whole problem's number of a contact of a part.
    fn number(&self, part: &Part<M>, contact: usize) -> usize {
        let of_rank = part.contacts.as_ref().map_or(contact, |contacts| contacts[contact] as usize);
        self.share.map_or(of_rank, |share| share.contacts[of_rank] as usize)
    }

    /// ‖V − V*‖_M (√J) of the grains as they were pushed last and a solution; ‖V − `V_free`‖_M without one.
    fn distance(&self, solution: Option<usize>) -> f64 {
        let [squared] = self.team.sum(self.parts.iter().map(|part| [part.squared_distance(solution)]));
        squared.sqrt()
    }

    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M to the nearest solution; NaN if none is known.
    fn velocity_error(&self) -> f64 {
        let error = |(k, known): (usize, &Solution)| ratio(self.distance(Some(k)), known.distance);
        self.solutions.iter().enumerate().map(error).reduce(f64::min).unwrap_or(f64::NAN)
    }

    /// (q − q*) / |q*|, where all solutions have one energy. Where the solution is r = 0, it is 0 there and infinite elsewhere.
    fn energy_gap(&self, energy: f64) -> f64 {
        let solution = self.solutions.first().filter(|_| M::HAS_ONE_VELOCITY);
        solution.map_or(f64::NAN, |known| ratio(energy - known.energy, known.energy.abs()))
    }
}
