//! A contact problem whatever its mechanics, and what is asked of it.

use crate::arrays::{Global, arrays};
use crate::facts::{Facts, Touching, facts};
use crate::form::{Form, Law, unless_admissible};
use crate::methods::Ours;
use crate::share::{OneShare, Part};
use analysis::Meter;
use anyhow::Result;
use cases::{AnyFrozen, Frozen, Homogenised, slides, to_candidate};
use contact::{Measures, Place, Touch, Truth, Vector};
use partition::{Decomposition, Grid, Partition, Scheme, Share, Team, Whole};
use reference::{Certificate, Certified, distance};
use runner::{Measured, Outcome, Progress, Stop, solve_against};
use std::ops::ControlFlow;

/// Observer of every iterate, which may end the run.
pub type Observe<'o> = dyn FnMut(&Progress) -> ControlFlow<()> + 'o;

/// Conditions of a run.
#[derive(Clone, Copy)]
pub struct Run<'r> {
    /// Impulses of the solutions that are known (N·s).
    pub truths: &'r [Vec<f64>],
    /// Impulses to begin from (N·s).
    pub r0: &'r [f64],
    /// Stop rule.
    pub stop: &'r Stop,
    /// Iterates that are measured wholly.
    pub measured: Measured,
}

/// A contact problem between grains, whatever its mechanics. Impulses `r` (N·s) and velocities are flat lists, in the order of its contacts and grains.
pub trait OneProblem: Send + Sync {
    /// Returns its kind and size.
    fn facts(&self) -> Facts;

    /// Runs a method; the observer sees every iterate, and may end the run.
    ///
    /// # Errors
    /// Says why the method cannot start on the problem.
    fn solve(&self, ours: &Ours, run: Run, observe: &mut Observe) -> Result<Outcome>;

    /// Measures impulses by themselves, beside those of the solutions that are known.
    fn measures(&self, truths: &[Vec<f64>], r: &[f64]) -> Measures;

    /// Returns ‖V − V′‖_M of two impulses over ‖V − `V_free`‖_M of the first (–).
    fn distance(&self, r: &[f64], other: &[f64]) -> f64;

    /// Returns the greatest ‖V − V′‖_M of two of some solutions over ‖V − `V_free`‖_M of the first (–).
    fn spread(&self, solutions: &[&[f64]]) -> f64;

    /// Returns the energy that the free velocity would spend at the contacts (J): 0 where none closes.
    fn scale(&self) -> f64;

    /// Passes on all that a method sees, one number after the other.
    fn numbers(&self, number: &mut dyn FnMut(f64));

    /// Returns the impulses of the time step before; none where they are not known.
    fn start(&self) -> &[f64];

    /// Returns the number of time steps before whose solve did not converge, if it is known.
    fn missed_before(&self) -> Option<u64>;

    /// Refuses an impulse of contact `k` that the law does not admit.
    ///
    /// # Errors
    /// Says what it must be.
    fn unless_admissible(&self, k: usize, r: &[f64]) -> Result<()>;

    /// Computes V = `V_free` + M⁻¹ H r (m/s, rad/s).
    fn velocity(&self, r: &[f64]) -> Vec<f64>;

    /// Returns the size of each tangential impulse, in 2D with the sign along t = (−`n_y`, `n_x`); none without friction.
    fn tangential(&self, r: &[f64]) -> Option<Vec<f64>>;

    /// Returns the impulse of each contact as the vector that acts on the candidate (N·s); z is 0 in 2D.
    fn on_candidates(&self, r: &[f64]) -> Vec<[f64; 3]>;

    /// Returns the status of each contact: 0 if it is open, 1 if it sticks, 2 if it slides; none without friction.
    fn statuses(&self, r: &[f64]) -> Option<Vec<u8>>;

    /// Returns the text of its file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    fn to_json(&self) -> serde_json::Result<String>;

    /// Computes v = Hᵗ V + c (m/s).
    fn relative_velocity(&self, r: &[f64]) -> Vec<f64>;

    /// Returns the law of its contacts, with what is known where it holds.
    fn law(&self) -> Law<'_>;

    /// Certifies impulses.
    fn certify(&self, r: &[f64]) -> Certificate;

    /// Returns the place of each grain (m).
    fn places(&self) -> Vec<[f64; 3]>;

    /// Returns the radius of each grain (m).
    fn radii(&self) -> &[f64];

    /// Returns the contacts.
    fn touching(&self) -> Vec<Touching>;

    /// Distributes the contacts to subdomains, and cuts the problem along them.
    ///
    /// # Errors
    /// If the grid does not fit the problem.
    fn cut(&self, grid: Grid, scheme: Scheme) -> Result<(Partition, Decomposition)>;

    /// Homogenises `count` subdomains, see [`Homogenised::of`].
    fn homogenised(&self, grains: usize, parts: (&[u32], usize), r: &[f64]) -> Vec<Homogenised>;

    /// Returns M, H, f and w.
    fn arrays(&self) -> Global;

    /// Returns the facts about the whole that every rank must know.
    fn whole(&self, grid: Grid, scheme: Scheme) -> Whole;

    /// Returns the subdomain `e` as a share, as the first line of its file, and as a problem of its own.
    ///
    /// # Errors
    /// None: what is taken from a problem is valid.
    fn part(
        &self,
        cut: &Decomposition,
        e: usize,
        whole: Whole,
        problem_hash: &str,
    ) -> Result<(Box<dyn OneShare>, Part, AnyFrozen)>;

    /// Returns the share of a rank.
    ///
    /// # Errors
    /// None: what is taken from a problem is valid.
    fn share(&self, cut: &Decomposition, team: &Team, whole: Whole) -> Result<Box<dyn OneShare>>;
}

/// A tangential impulse that is nearer to its bound than this slides (–).
const SLIDES: f64 = 1e-6;

impl<M: Form> OneProblem for Frozen<M> {
    fn facts(&self) -> Facts {
        facts::<M>(self.problem.grain_count(), self.problem.contact_count())
    }

    fn solve(&self, ours: &Ours, run: Run, observe: &mut Observe) -> Result<Outcome> {
        let Run { truths, r0, stop, measured } = run;
        let solver = ours.engine_of(&self.facts().in_words())?.solver();
        let truths: Vec<Truth<M>> = truths.iter().map(|r| Truth::new(&self.problem, r)).collect();
        Ok(solve_against(&truths, solver, &self.problem, r0, stop, measured, observe)?)
    }

    fn measures(&self, truths: &[Vec<f64>], r: &[f64]) -> Measures {
        let truths = truths.iter().map(|r| Truth::new(&self.problem, r));
        let meter = Meter::new(&self.problem);
        truths.fold(meter, |meter, truth| meter.against(&truth)).measure_after(&[], r, 0.0)
    }

    fn distance(&self, r: &[f64], other: &[f64]) -> f64 {
        distance(&self.problem, r, other)
    }

    fn spread(&self, solutions: &[&[f64]]) -> f64 {
        let problem = &self.problem;
        let velocities: Vec<_> = solutions.iter().map(|r| Truth::new(problem, r)).collect();
        let [first, _, ..] = &velocities[..] else { return 0.0 };
        let pairs =
            velocities.iter().enumerate().flat_map(|(k, a)| velocities[..k].iter().map(move |b| (a, b)));
        let apart = pairs.map(|(a, b)| problem.velocity_distance(a.velocity(), b.velocity()));
        let greatest = apart.fold(0.0, f64::max);
        let size = problem.velocity_distance(first.velocity(), problem.free_velocity());
        if greatest == 0.0 { 0.0 } else { greatest / size }
    }

    fn scale(&self) -> f64 {
        self.problem.scale()
    }

    fn numbers(&self, number: &mut dyn FnMut(f64)) {
        let problem = &self.problem;
        // The lengths first: no two problems are the same numbers otherwise cut.
        number(problem.grain_count() as f64);
        number(problem.contact_count() as f64);
        problem.mass().iter().for_each(|m| number(M::weight(*m)));
        problem.position().iter().for_each(|x| x.components().for_each(&mut *number));
        problem.free_velocity().iter().for_each(|v| v.components().for_each(&mut *number));
        if M::HAS_FRICTION {
            problem.mass().iter().for_each(|m| number(<M as Certified>::mass(*m).inertia));
        }
        for contact in problem.contacts() {
            let (candidate, antagonist) = contact.ends();
            number(f64::from(candidate));
            number(antagonist.map_or(-1.0, f64::from));
            contact.normal().components().for_each(&mut *number);
            let (arms, friction) = (contact.arms(), contact.friction());
            if M::HAS_FRICTION {
                arms.components().for_each(&mut *number);
            }
            contact.offset().components().for_each(&mut *number);
            if M::HAS_FRICTION {
                number(friction);
            }
        }
        self.start.iter().for_each(|r| number(*r));
    }

    fn start(&self) -> &[f64] {
        &self.start
    }

    fn missed_before(&self) -> Option<u64> {
        self.missed_before
    }

    fn unless_admissible(&self, k: usize, r: &[f64]) -> Result<()> {
        unless_admissible::<M>(&self.problem.contacts()[k], M::Impulse::at(r, 0))
    }

    fn velocity(&self, r: &[f64]) -> Vec<f64> {
        let mut velocity = vec![M::Velocity::ZERO; self.problem.grain_count()];
        self.problem.velocity(r, &mut velocity);
        flat(velocity)
    }

    fn tangential(&self, r: &[f64]) -> Option<Vec<f64>> {
        let size = |r: &[f64]| match r {
            [_, x, y] => x.hypot(*y),
            _ => r[1],
        };
        M::HAS_FRICTION.then(|| r.chunks_exact(M::Impulse::LEN).map(size).collect())
    }

    fn on_candidates(&self, r: &[f64]) -> Vec<[f64; 3]> {
        let vector = |(k, contact)| to_candidate::<M>(contact, M::Impulse::at(r, k)).space();
        self.problem.contacts().iter().enumerate().map(vector).collect()
    }

    fn statuses(&self, r: &[f64]) -> Option<Vec<u8>> {
        let status = |(k, contact): (usize, &M::Contact)| {
            let r = M::Impulse::at(r, k);
            match r.first() {
                ..=0.0 => 0,
                _ => 1 + u8::from(slides::<M>(contact, r, SLIDES)),
            }
        };
        M::HAS_FRICTION.then(|| self.problem.contacts().iter().enumerate().map(status).collect())
    }

    fn to_json(&self) -> serde_json::Result<String> {
        Self::to_json(self)
    }

    fn relative_velocity(&self, r: &[f64]) -> Vec<f64> {
        let mut velocity = vec![M::Velocity::ZERO; self.problem.grain_count()];
        self.problem.velocity(r, &mut velocity);
        let mut v = vec![0.0; self.problem.impulse_count()];
        self.problem.relative_velocity(&velocity, &mut v);
        v
    }

    fn law(&self) -> Law<'_> {
        M::under(&self.problem)
    }

    fn certify(&self, r: &[f64]) -> Certificate {
        reference::certify(&self.problem, r)
    }

    fn places(&self) -> Vec<[f64; 3]> {
        self.problem.position().iter().map(|place| place.space()).collect()
    }

    fn radii(&self) -> &[f64] {
        &self.radius
    }

    fn touching(&self) -> Vec<Touching> {
        let touching = |(contact, gap): (&M::Contact, &f64)| {
            let (candidate, antagonist) = contact.ends();
            let (normal, friction) = (contact.normal().space(), contact.friction());
            Touching { candidate, antagonist, normal, gap: *gap, friction }
        };
        self.problem.contacts().iter().zip(&self.gap).map(touching).collect()
    }

    fn cut(&self, grid: Grid, scheme: Scheme) -> Result<(Partition, Decomposition)> {
        let partition = Partition::of_contacts(&self.problem, scheme, grid)?;
        let decomposition = Decomposition::new(&self.problem, &partition);
        Ok((partition, decomposition))
    }

    fn homogenised(&self, grains: usize, parts: (&[u32], usize), r: &[f64]) -> Vec<Homogenised> {
        Homogenised::of(self, grains, parts, r)
    }

    fn arrays(&self) -> Global {
        arrays(&self.problem)
    }

    fn whole(&self, grid: Grid, scheme: Scheme) -> Whole {
        ranks::whole(&self.problem, grid, scheme)
    }

    fn part(
        &self,
        cut: &Decomposition,
        e: usize,
        whole: Whole,
        problem_hash: &str,
    ) -> Result<(Box<dyn OneShare>, Part, AnyFrozen)> {
        let share = Share::of_subdomain(&self.problem, cut, e, whole)?;
        let part = Part::of(&share, problem_hash);
        let of = |all: &[f64], some: &[u32]| some.iter().map(|k| all[*k as usize]).collect();
        let begins = self.start.iter().any(|r| *r != 0.0);
        let alone = Frozen {
            name: self.name.clone(),
            source: self.source.clone(),
            time_step: self.time_step,
            radius: of(&self.radius, &share.grains),
            gap: of(&self.gap, &share.contacts),
            start: if begins { (&share as &dyn OneShare).own(&self.start) } else { Vec::new() },
            problem: share.problem.clone(),
            missed_before: self.missed_before,
        };
        Ok((Box::new(share), part, alone.into()))
    }

    fn share(&self, cut: &Decomposition, team: &Team, whole: Whole) -> Result<Box<dyn OneShare>> {
        Ok(Box::new(Share::of_rank(&self.problem, cut, team, whole)?))
    }
}

/// The numbers of all, one after the other.
pub(crate) fn flat<V: Vector>(list: impl IntoIterator<Item = V>) -> Vec<f64> {
    list.into_iter().flat_map(V::components).collect()
}
