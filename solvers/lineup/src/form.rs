//! Requirements of the line-up on a mechanics.

use active_set::ActiveSet;
use analysis::{Bounded, Spectrum, proves_infeasible};
use anyhow::{Result, ensure};
use cases::Marched;
use contact::{Mechanics, Packing, Rough, Smooth, Solver, Touch, Vector};
use reference::{
    Answer, Certified, Existence, Isolation, Provable, RoughSolution, continued, polished, solve_rough,
};
use std::ops::RangeInclusive;

/// A mechanics in which problems are solved, marched and certified.
pub(crate) trait Form: Marched + Bounded + Certified {
    /// Returns the problem under the law of its contacts.
    fn under(problem: &Packing<Self>) -> Law<'_>;
}

impl<const D: usize> Form for Smooth<D>
where
    Self: Marched + Bounded + Certified,
{
    fn under(problem: &Packing<Self>) -> Law<'_> {
        Law::Frictionless(problem)
    }
}

impl<const D: usize> Form for Rough<D>
where
    Self: Marched + Bounded + Certified,
    Packing<Self>: Frictional,
{
    fn under(problem: &Packing<Self>) -> Law<'_> {
        Law::Frictional(problem)
    }
}

/// Refuses an impulse that the law of a contact does not admit.
pub(crate) fn unless_admissible<M: Mechanics>(contact: &M::Contact, r: M::Impulse) -> Result<()> {
    ensure!(contact.is_admissible(r), "is {}: it must be {}", r.text(), M::Contact::ADMISSIBLE);
    Ok(())
}

/// Law of the contacts of a problem, and what is known where it holds.
#[derive(Clone, Copy)]
pub enum Law<'p> {
    /// The Signorini condition.
    Frictionless(&'p dyn Frictionless),
    /// The Signorini condition and Coulomb's law.
    Frictional(&'p dyn Frictional),
}

/// A problem without friction, whose solutions have one velocity.
pub trait Frictionless {
    /// Solves it to round-off.
    fn reference(&self) -> Answer;

    /// Reports whether a ray (N·s) proves that it has no solution.
    fn proves_infeasible(&self, ray: &[f64]) -> bool;

    /// Computes eigenvalues of W; `closed` tells which contacts a solution keeps closed.
    fn spectrum(&self, closed: Option<&[bool]>) -> Spectrum;

    /// Computes the strength of the coupling between subdomains without mass splitting, where they are few enough.
    fn coupling(&self, subdomain: &[u32]) -> Option<f64>;
}

impl<const D: usize> Frictionless for Packing<Smooth<D>>
where
    Smooth<D>: Marched + Bounded + Certified,
{
    fn reference(&self) -> Answer {
        reference::solve(self)
    }

    fn proves_infeasible(&self, ray: &[f64]) -> bool {
        proves_infeasible(self, ray)
    }

    fn spectrum(&self, closed: Option<&[bool]>) -> Spectrum {
        Spectrum::of(self, closed)
    }

    fn coupling(&self, subdomain: &[u32]) -> Option<f64> {
        analysis::coupling(self, subdomain)
    }
}

/// A problem with friction, which may have several solutions.
pub trait Frictional {
    /// Solves it from some starts, each of which is `seen`: [`solve_rough`].
    fn solutions(&self, starts: RangeInclusive<u64>, seen: &mut dyn FnMut()) -> Vec<RoughSolution>;

    /// Returns normal impulses (N·s) that prove that it has no solution, if some do.
    fn ray(&self) -> Option<Vec<f64>>;

    /// Reports whether normal impulses (N·s) prove that it has no solution.
    fn proves_infeasible(&self, ray: &[f64]) -> bool;

    /// Returns the reason why it is known to have a solution: [`reference::existence`].
    fn existence(&self) -> Option<Existence>;

    /// Returns the isolation of the solution `r` (N·s) from others: [`reference::isolation`].
    fn isolation(&self, r: &[f64]) -> Isolation;

    /// Returns the certified solution to which the end of a run (N·s) is polished, if there is one: [`polished`].
    fn polished(&self, r: &[f64]) -> Option<RoughSolution>;

    /// Returns the certified solution to which a continuation in the offsets leads, if there is one: [`continued`].
    fn continued(&self, seen: &mut dyn FnMut()) -> Option<RoughSolution>;
}

impl<M: Provable> Frictional for Packing<M>
where
    ActiveSet: Solver<M>,
{
    fn solutions(&self, starts: RangeInclusive<u64>, seen: &mut dyn FnMut()) -> Vec<RoughSolution> {
        solve_rough(self, starts, seen)
    }

    fn ray(&self) -> Option<Vec<f64>> {
        M::ray(self)
    }

    fn proves_infeasible(&self, ray: &[f64]) -> bool {
        M::proves_infeasible(self, ray)
    }

    fn existence(&self) -> Option<Existence> {
        M::existence(self)
    }

    fn isolation(&self, r: &[f64]) -> Isolation {
        M::isolation(self, r)
    }

    fn polished(&self, r: &[f64]) -> Option<RoughSolution> {
        polished(self, r)
    }

    fn continued(&self, seen: &mut dyn FnMut()) -> Option<RoughSolution> {
        continued(self, seen)
    }
}
