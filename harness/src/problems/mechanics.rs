//! Mechanics as files and the command line use them: the requirements of the program on each, and the one place that tells
//! them apart.

use crate::plan::{Ours, Settings};
use crate::problems::pool::{known_rough, polished_to};
use crate::problems::reference::known_smooth;
use crate::problems::{Known, Root, spectrum};
use analysis::Bounded;
use anyhow::Result;
use cases::{AnyFrozen, Case, CaseError, Frozen, Marched};
use contact::{
    ContactProblem, Discs, Mechanics, RoughContact, RoughDiscs, RoughMass, RoughSpheres, Smooth, Solver,
    Spheres,
};
use nalgebra::{Vector3, Vector6};
#[cfg(any(feature = "mpi", test))]
use {
    crate::plan::Method, cg::Cg, latin_dd::LatinDd, nsgs_dd::NsgsDd, partition::Distributed,
    serde::Deserialize, serde_json::Value,
};

/// Requirements of the program on a mechanics, beyond those of a march.
pub(crate) trait Studied: Marched + Bounded {
    /// The method in this mechanics, if it has it.
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>>;

    /// The method where ranks share a problem, if it has subdomains.
    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>>;

    /// Returns the known solutions of a problem, read, or computed and kept; none where none can be certified.
    fn known(_: &Root, _: &Frozen<Self>) -> Result<Known<Self>> {
        Ok(Known::default())
    }

    /// The solution, where there are several, to which the end `r` of a run (N·s) is polished: whether it is among those `known`, and
    /// how far it is from r.
    fn polished_to(
        _: &Root,
        _: &Frozen<Self>,
        _known: &Known<Self>,
        _r: &[f64],
    ) -> Result<Option<(bool, f64)>> {
        Ok(None)
    }

    /// Eigenvalues of a problem, where they say something of its methods: with friction, what decides is not W alone.
    fn spectrum(_: &ContactProblem<Self>, _: &Known<Self>) -> Settings {
        Settings::new()
    }

    /// Returns the strength of the coupling between subdomains without mass splitting, if it is known.
    fn coupling(_: &ContactProblem<Self>, _subdomain: &[u32]) -> Option<f64> {
        None
    }

    /// Spin of a grain about the axes that it has (rad/s): none without friction, one in the plane, three in space.
    fn spin(_: &Self::Velocity) -> &[f64] {
        &[]
    }

    /// The sizes of the tangential impulses of `r` (N·s), in the plane with the sign along t = (−`n_y`, `n_x`); none without friction.
    fn tangential(_r: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Returns the status of each contact with the impulses `r` (N·s): 0 if it is open, 1 if it sticks, 2 if it slides; none
    /// without friction.
    fn statuses(_: &[Self::Contact], _r: &[f64]) -> Option<Vec<u8>> {
        None
    }

    /// Everything of a problem that a method sees beside positions, one number after the other.
    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64));

    /// The text of the file.
    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String>;

    /// Wraps the problem as one of any mechanics, as files hold it.
    fn any(frozen: Frozen<Self>) -> AnyFrozen;
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
        Some(&*ours.discs)
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

    fn numbers(problem: &ContactProblem, number: &mut dyn FnMut(f64)) {
        numbers(problem, number);
    }

    fn to_json(frozen: &Frozen) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen) -> AnyFrozen {
        AnyFrozen::Discs(frozen)
    }
}

/// Passes on all that a method sees of frictionless contacts, one number after the other.
fn numbers<const D: usize>(problem: &ContactProblem<Smooth<D>>, number: &mut dyn FnMut(f64)) {
    for contact in problem.contacts() {
        number(f64::from(contact.candidate));
        number(contact.antagonist.map_or(-1.0, f64::from));
        contact.normal.iter().for_each(|x| number(*x));
        number(contact.offset);
    }
}

impl Studied for Spheres {
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>> {
        Some(&*ours.spheres)
    }

    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>> {
        distributed(method)
    }

    fn known(root: &Root, frozen: &Frozen<Self>) -> Result<Known<Self>> {
        known_smooth(root, frozen)
    }

    fn spectrum(problem: &ContactProblem<Self>, known: &Known<Self>) -> Settings {
        spectrum(problem, known)
    }

    fn coupling(problem: &ContactProblem<Self>, subdomain: &[u32]) -> Option<f64> {
        analysis::coupling(problem, subdomain)
    }

    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64)) {
        numbers(problem, number);
    }

    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen<Self>) -> AnyFrozen {
        AnyFrozen::Spheres(frozen)
    }
}

impl Studied for RoughDiscs {
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>> {
        ours.rough_discs.as_deref()
    }

    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>> {
        distributed(method)
    }

    fn known(root: &Root, frozen: &Frozen<Self>) -> Result<Known<Self>> {
        known_rough(root, frozen)
    }

    fn polished_to(
        root: &Root,
        frozen: &Frozen<Self>,
        known: &Known<Self>,
        r: &[f64],
    ) -> Result<Option<(bool, f64)>> {
        polished_to(root, frozen, known, r)
    }

    fn spin(velocity: &Vector3<f64>) -> &[f64] {
        &velocity.as_slice()[2..]
    }

    fn tangential(r: &[f64]) -> Option<Vec<f64>> {
        Some(r.iter().skip(1).step_by(2).copied().collect())
    }

    fn statuses(contacts: &[RoughContact], r: &[f64]) -> Option<Vec<u8>> {
        Some(statuses(contacts, r.iter().step_by(2), &Self::tangential(r)?))
    }

    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64)) {
        rough_numbers(problem.mass(), problem.contacts(), number);
    }

    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen<Self>) -> AnyFrozen {
        AnyFrozen::RoughDiscs(frozen)
    }
}

impl Studied for RoughSpheres {
    fn solver(ours: &Ours) -> Option<&dyn Solver<Self>> {
        ours.rough_spheres.as_deref()
    }

    #[cfg(any(feature = "mpi", test))]
    fn distributed(method: &Method) -> Option<Box<dyn Distributed<Self>>> {
        distributed(method)
    }

    fn known(root: &Root, frozen: &Frozen<Self>) -> Result<Known<Self>> {
        known_rough(root, frozen)
    }

    fn polished_to(
        root: &Root,
        frozen: &Frozen<Self>,
        known: &Known<Self>,
        r: &[f64],
    ) -> Result<Option<(bool, f64)>> {
        polished_to(root, frozen, known, r)
    }

    fn spin(velocity: &Vector6<f64>) -> &[f64] {
        &velocity.as_slice()[3..]
    }

    fn tangential(r: &[f64]) -> Option<Vec<f64>> {
        Some(r.chunks_exact(3).map(|r| r[1].hypot(r[2])).collect())
    }

    fn statuses(contacts: &[RoughContact<3>], r: &[f64]) -> Option<Vec<u8>> {
        Some(statuses(contacts, r.iter().step_by(3), &Self::tangential(r)?))
    }

    fn numbers(problem: &ContactProblem<Self>, number: &mut dyn FnMut(f64)) {
        rough_numbers(problem.mass(), problem.contacts(), number);
    }

    fn to_json(frozen: &Frozen<Self>) -> serde_json::Result<String> {
        frozen.to_json()
    }

    fn any(frozen: Frozen<Self>) -> AnyFrozen {
        AnyFrozen::RoughSpheres(frozen)
    }
}

/// The statuses of contacts with these impulses along their normals and their tangents (N·s).
fn statuses<'r, const D: usize>(
    contacts: &[RoughContact<D>],
    normal: impl Iterator<Item = &'r f64>,
    tangential: &[f64],
) -> Vec<u8> {
    let status = |((contact, normal), along): ((&RoughContact<D>, &f64), &f64)| {
        if *normal <= 0.0 {
            0
        } else if along.abs() < (1.0 - SLIDES) * contact.friction * normal {
            1
        } else {
            2
        }
    };
    contacts.iter().zip(normal).zip(tangential).map(status).collect()
}

/// Passes on all that a method sees of frictional grains and contacts, one number after the other.
fn rough_numbers<const D: usize>(
    mass: &[RoughMass],
    contacts: &[RoughContact<D>],
    number: &mut dyn FnMut(f64),
) {
    for mass in mass {
        number(mass.inertia);
    }
    for contact in contacts {
        number(f64::from(contact.candidate));
        number(contact.antagonist.map_or(-1.0, f64::from));
        contact.normal.iter().chain(&contact.arms).chain(&contact.offset).for_each(|x| number(*x));
        number(contact.friction);
    }
}

/// A problem of a study, whatever its mechanics.
pub(crate) type AnyProblem = Box<dyn crate::run::OneProblem>;

/// Visitor of a frozen problem, whatever its mechanics.
pub(crate) trait Visit {
    /// Result of the visit.
    type Output;

    /// Visits it.
    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Self::Output;
}

/// Tells the mechanics apart.
pub(crate) fn visit<V: Visit>(frozen: AnyFrozen, visitor: V) -> V::Output {
    match frozen {
        AnyFrozen::Discs(frozen) => visitor.visit(frozen),
        AnyFrozen::RoughDiscs(frozen) => visitor.visit(frozen),
        AnyFrozen::Spheres(frozen) => visitor.visit(frozen),
        AnyFrozen::RoughSpheres(frozen) => visitor.visit(frozen),
    }
}

/// The mechanics of a problem, as a reader would say it.
pub(crate) fn in_words<M: Mechanics>() -> &'static str {
    match M::NAME {
        Discs::NAME => "discs without friction",
        Spheres::NAME => "spheres without friction",
        RoughSpheres::NAME => "spheres with friction",
        _ => "discs with friction",
    }
}

/// Visitor of a case, whatever its mechanics.
pub(crate) trait Enter {
    /// Result of the visit.
    type Output;

    /// Visits it.
    fn enter<M: Studied>(self) -> Self::Output;
}

/// Tells the mechanics of cases apart.
pub(crate) fn enter<E: Enter>(case: &Case, visitor: E) -> Result<E::Output, CaseError> {
    match (case.in_space()?, case.scene.is_rough()) {
        (false, false) => Ok(visitor.enter::<Discs>()),
        (false, true) => Ok(visitor.enter::<RoughDiscs>()),
        (true, false) => Ok(visitor.enter::<Spheres>()),
        (true, true) => Ok(visitor.enter::<RoughSpheres>()),
    }
}
