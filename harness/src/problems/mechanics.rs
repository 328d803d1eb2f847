//! Where files and the command line meet the mechanics: what the program asks of each, and the one place that tells them apart.

use crate::plan::{Ours, Programme, Settings};
use crate::problems::reference::{known_rough, known_smooth};
use crate::problems::{Known, Root, spectrum};
use crate::run::{Ended, Observe, climb};
use analysis::Bounded;
use anyhow::{Result, bail};
use cases::{AnyFrozen, Frozen, Marched};
use contact::{Contact, ContactProblem, Discs, Mechanics, RoughContact, RoughDiscs, Solver, Truth};
use nalgebra::{Vector2, Vector3};
use runner::Stop;
#[cfg(any(feature = "mpi", test))]
use {
    crate::plan::Method, cg::Cg, latin_dd::LatinDd, nsgs_dd::NsgsDd, partition::Distributed,
    serde::Deserialize, serde_json::Value,
};

/// What the program asks of a mechanics, beside what a march does.
pub(crate) trait Studied: Marched + Bounded {
    /// The method in this mechanics, if it has it.
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>>;

    /// The method where ranks share a problem, if it has subdomains.
    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>>;

    /// What is known of the solutions of a problem: read, or computed and kept.
    fn known(root: &Root, frozen: &Frozen<Self>) -> Result<Known<Self>>;

    /// Eigenvalues of a problem, where they say something of its methods.
    fn spectrum(problem: &ContactProblem<Self>, known: &Known<Self>) -> Settings;

    /// How strongly subdomains act on each other where masses are whole, if that is known.
    fn coupling(problem: &ContactProblem<Self>, subdomain: &[u32]) -> Option<f64>;

    /// Spin of a grain (rad/s), if it has any.
    fn spin(velocity: Self::Velocity) -> Option<f64>;

    /// What frames tell of contacts with the impulses `r` (N·s) beside their normal impulses, by name.
    fn of_contacts(contacts: &[Self::Contact], r: &[f64]) -> Vec<(&'static str, Vec<f64>)>;

    /// Everything of a problem that a method sees beside positions, one number after the other.
    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64));

    /// The text of the file.
    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String>;

    /// The same as what files hold.
    fn any(frozen: Frozen<Self>) -> AnyFrozen;

    /// Runs another code, if it knows the mechanics.
    fn elsewhere(
        programme: &Programme,
        truth: Option<&Truth<Self>>,
        frozen: &Frozen<Self>,
        r0: &[f64],
        stop: &Stop,
        observe: &mut Observe,
    ) -> Result<Ended<Self>>;
}

/// The methods that ranks may share.
#[cfg(any(feature = "mpi", test))]
fn distributed<M: Mechanics>(method: &Method) -> Option<Box<dyn Distributed<M>>>
where
    NsgsDd: Distributed<M>,
    LatinDd: Distributed<M>,
    Cg: Distributed<M>,
{
    let settings = Value::Object(method.settings.clone());
    Some(match method.name {
        "nsgs-dd" => Box::new(NsgsDd::deserialize(settings).ok()?),
        "latin-dd" => Box::new(LatinDd::deserialize(settings).ok()?),
        "cg" => Box::new(Cg::deserialize(settings).ok()?),
        _ => return None,
    })
}

/// A tangential impulse that is nearer to its bound than this slides (–).
const SLIDES: f64 = 1e-6;

impl Studied for Discs {
    fn solver(ours: &Ours) -> Option<&dyn Solver> {
        Some(&*ours.smooth)
    }

    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>> {
        distributed(method)
    }

    fn known(root: &Root, frozen: &Frozen) -> Result<Known> {
        known_smooth(root, frozen)
    }

    fn spectrum(problem: &ContactProblem, known: &Known) -> Settings {
        spectrum(problem, known)
    }

    fn coupling(problem: &ContactProblem, subdomain: &[u32]) -> Option<f64> {
        analysis::coupling(problem, subdomain)
    }

    fn spin(_: Vector2<f64>) -> Option<f64> {
        None
    }

    fn of_contacts(_: &[Contact], _: &[f64]) -> Vec<(&'static str, Vec<f64>)> {
        Vec::new()
    }

    fn numbers(problem: &ContactProblem, number: &mut dyn FnMut(f64)) {
        for contact in problem.contacts() {
            number(f64::from(contact.candidate));
            number(contact.antagonist.map_or(-1.0, f64::from));
            contact.normal.iter().for_each(|x| number(*x));
            number(contact.offset);
        }
    }

    fn to_json(frozen: &Frozen) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen) -> AnyFrozen {
        AnyFrozen::Discs(frozen)
    }

    fn elsewhere(
        programme: &Programme,
        truth: Option<&Truth>,
        frozen: &Frozen,
        r0: &[f64],
        stop: &Stop,
        observe: &mut Observe,
    ) -> Result<Ended> {
        climb(programme, truth, frozen, r0, stop, observe)
    }
}

impl Studied for RoughDiscs {
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>> {
        ours.rough.as_deref()
    }

    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>> {
        distributed(method)
    }

    fn known(root: &Root, frozen: &Frozen<Self>) -> Result<Known<Self>> {
        known_rough(root, frozen)
    }

    /// None: what decides with friction is not W alone.
    fn spectrum(_: &ContactProblem<Self>, _: &Known<Self>) -> Settings {
        Settings::new()
    }

    fn coupling(_: &ContactProblem<Self>, _: &[u32]) -> Option<f64> {
        None
    }

    fn spin(velocity: Vector3<f64>) -> Option<f64> {
        Some(velocity.z)
    }

    /// Tangential impulses along t = (−`n_y`, `n_x`); and 0 for a contact that is open, 1 for one that sticks, 2 for one that slides.
    fn of_contacts(contacts: &[RoughContact], r: &[f64]) -> Vec<(&'static str, Vec<f64>)> {
        let status = |(contact, r): (&RoughContact, &[f64])| {
            if r[0] <= 0.0 {
                0.0
            } else if r[1].abs() < (1.0 - SLIDES) * contact.friction * r[0] {
                1.0
            } else {
                2.0
            }
        };
        let tangential = r.iter().skip(1).step_by(2).copied().collect();
        let statuses = contacts.iter().zip(r.chunks_exact(2)).map(status).collect();
        vec![("tangential_impulse_n_s", tangential), ("status", statuses)]
    }

    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64)) {
        problem.mass().iter().for_each(|mass| number(mass.inertia));
        for contact in problem.contacts() {
            number(f64::from(contact.candidate));
            number(contact.antagonist.map_or(-1.0, f64::from));
            let vectors = [contact.normal, contact.arms, contact.offset];
            vectors.iter().flatten().for_each(|x| number(*x));
            number(contact.friction);
        }
    }

    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen<Self>) -> AnyFrozen {
        AnyFrozen::RoughDiscs(frozen)
    }

    fn elsewhere(
        programme: &Programme,
        _: Option<&Truth<Self>>,
        _: &Frozen<Self>,
        _: &[f64],
        _: &Stop,
        _: &mut Observe,
    ) -> Result<Ended<Self>> {
        bail!("{} does not solve problems of {}", programme.code.name, Self::NAME)
    }
}

/// A problem of a study, whatever its mechanics.
pub(crate) type AnyProblem = Box<dyn crate::run::OneProblem>;

/// What is done with a frozen problem, whatever its mechanics.
pub(crate) trait Visit {
    /// What it gives.
    type Output;

    /// Does it.
    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Self::Output;
}

/// Tells the mechanics apart.
pub(crate) fn visit<V: Visit>(frozen: AnyFrozen, visitor: V) -> V::Output {
    match frozen {
        AnyFrozen::Discs(frozen) => visitor.visit(frozen),
        AnyFrozen::RoughDiscs(frozen) => visitor.visit(frozen),
    }
}
