//! Checks that a collection is what its entries say.

use super::entry::facts;
use super::folder::Collection;
use super::submission::Submission;
use anyhow::{Result, ensure};

/// Returns files that belong to no entry.
pub(crate) fn orphans(collection: &Collection, ids: &[String]) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    for kind in ["problems", "answers"] {
        let names = collection.names(kind)?.into_iter().filter(|name| !ids.contains(name));
        faults.extend(names.map(|name| format!("{kind}/{name}: there is no entry of this id")));
    }
    Ok(faults)
}

/// Checks an entry; returns whether its problem is at hand.
pub(crate) fn checked(collection: &Collection, id: &str) -> Result<bool> {
    let entry = collection.entry(id)?;
    let answers = collection.answers(id)?;
    let Some(problem) = collection.problem(&entry)? else {
        ensure!(
            entry.made.is_some() || entry.foreign.is_some(),
            "its problem is missing, and it has no recipe"
        );
        return Ok(false);
    };
    let (mechanics, grains, contacts, friction) = facts(&problem.posed);
    for (key, written, found) in [
        ("name", &entry.name, &problem.name),
        ("mechanics", &entry.mechanics, &mechanics),
        ("grains", &entry.grains.to_string(), &grains.to_string()),
        ("contacts", &entry.contacts.to_string(), &contacts.to_string()),
        ("friction", &format!("{:?}", entry.friction), &format!("{friction:?}")),
    ] {
        ensure!(written == found, "`{key}` is {written}: the problem has {found}");
    }
    let known = answers.standing(&problem.posed)?;
    ensure!(known.agrees(&entry.known), "`known` is {:?}: the stored answers give {known:?}", entry.known);
    Ok(true)
}

/// Checks a submission that was accepted.
pub(crate) fn submitted(collection: &Collection, name: &str) -> Result<()> {
    let submission = Submission::read(&collection.file("submissions", &format!("{name}.json.gz")))?;
    ensure!(submission.name() == name, "the file is named after another submission: it was changed");
    ensure!(submission.verified.is_some(), "it has no `verified`: `gravel accept` files submissions");
    let entry = collection.entry(&submission.problem)?;
    let problem = collection.problem(&entry)?;
    problem.map_or(Ok(()), |problem| submission.verify(&problem.posed).map(drop))
}
