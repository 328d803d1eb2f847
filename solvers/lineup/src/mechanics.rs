//! The mechanics by name. To add one: its name in [`of_each_mechanics`].

use crate::form::Form;
use crate::march::OneMarch;
use crate::problem::OneProblem;
use crate::share::{Joined, Read, joined_of};
use anyhow::Result;
use cases::{AnyFrozen, Case, CaseError, March};
use contact::{Vector, of_each_mechanics};

/// A mechanics behind interfaces in which it does not show.
struct OfMechanics {
    name: &'static str,
    in_space: bool,
    has_friction: bool,
    problem: fn(AnyFrozen) -> Option<Box<dyn OneProblem>>,
    joined: fn(Vec<Read>) -> Result<Joined>,
    march: fn(&Case) -> Result<Box<dyn OneMarch>, CaseError>,
}

/// Every mechanics. A static, for a constant would be compiled again, methods and all, where it is used.
static MECHANICS: &[OfMechanics] = &of_each_mechanics!(of);

const fn of<M: Form>() -> OfMechanics {
    OfMechanics {
        name: M::NAME,
        in_space: M::Place::LEN > 2,
        has_friction: M::HAS_FRICTION,
        problem: |frozen| Some(Box::new(frozen.of::<M>()?)),
        joined: joined_of::<M>,
        march: |case| Ok(Box::new(March::<M>::new(case)?)),
    }
}

/// The mechanics of this name.
///
/// # Panics
/// If it is of none.
fn named(name: &str) -> &'static OfMechanics {
    MECHANICS.iter().find(|one| one.name == name).expect("a problem is of a mechanics in the table")
}

/// Returns a problem whatever its mechanics.
///
/// # Panics
/// Of a mechanics that is not in the table.
pub fn problem(frozen: AnyFrozen) -> Box<dyn OneProblem> {
    (named(frozen.mechanics()).problem)(frozen).expect("a mechanics has its own name")
}

/// Joins subdomains that follow each other to the share of a rank.
///
/// # Errors
/// Names the file of a subdomain that contradicts itself or the first.
///
/// # Panics
/// Of no subdomain; of a mechanics that is not in the table.
pub fn joined(parts: Vec<Read>) -> Result<Joined> {
    (named(parts[0].2.mechanics()).joined)(parts)
}

/// Returns the march of a case, at time 0.
///
/// # Errors
/// Names the value of which no sample can be made.
///
/// # Panics
/// Of a mechanics that is not in the table.
pub fn march(case: &Case) -> Result<Box<dyn OneMarch>, CaseError> {
    (of_case(case)?.march)(case)
}

/// Returns the mechanics of a case.
fn of_case(case: &Case) -> Result<&'static OfMechanics, CaseError> {
    let wanted = (case.in_space()?, case.scene.is_rough());
    let fits = |one: &&OfMechanics| (one.in_space, one.has_friction) == wanted;
    Ok(MECHANICS.iter().find(fits).expect("there is one of each"))
}

/// Returns the name of the mechanics of a case.
///
/// # Errors
/// Names the file of its sample that cannot be read.
///
/// # Panics
/// Of a mechanics that is not in the table.
pub fn name_of(case: &Case) -> Result<&'static str, CaseError> {
    Ok(of_case(case)?.name)
}
