//! Archived rows renewed by those of a later study.

use super::{Row, counted};
use crate::store::tables_as_written;
use crate::terminal::say;
use anyhow::{Result, bail, ensure};
use results::journal::{Entry, Record};
use results::store::write_tables;
use results::study::{Runs, Study as Rows};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// Puts the rows of a study in the place of those of the same method, variant, problem and tolerance in a folder of archived tables, and new
/// ones behind them.
pub(super) fn renew(archived: &Path, study: &Path) -> Result<()> {
    let (old, new) = (tables_as_written(archived)?, tables_as_written(study)?);
    let (before, of_study) = (counted(&old), counted(&new));
    let plan = |rows: &Rows| Row::all(rows).first().map_or_else(String::new, |row| row.plan.to_owned());
    let (of_archive, of_new) = (plan(&old), plan(&new));
    ensure!(
        of_archive == of_new,
        "{} holds rows of plan `{of_new}`, and {} those of `{of_archive}`",
        study.display(),
        archived.display()
    );
    let rows = match (old, new) {
        (Rows::Runs(old), Rows::Runs(new)) => {
            let problems: HashSet<String> = new.records.iter().map(|one| one.run.problem.clone()).collect();
            let (mut grains, mut contacts) = (old.grains, old.contacts);
            grains.retain(|row| !problems.contains(&row.problem));
            contacts.retain(|row| !problems.contains(&row.problem));
            grains.extend(new.grains);
            contacts.extend(new.contacts);
            let ends = |one: &Record| one.run.tolerance;
            Rows::Runs(Runs { records: joined(old.records, new.records, ends)?, grains, contacts })
        }
        (Rows::Simulations(old), Rows::Simulations(new)) => {
            Rows::Simulations(joined(old, new, |one| one.simulation.tolerance)?)
        }
        _ => bail!("one of the two holds runs, the other simulations"),
    };
    check_hashes(&Row::all(&rows))?;
    write_tables(archived, &rows, false)?;
    say(format_args!("{}: {before}, renewed by {of_study}: {} now", archived.display(), counted(&rows)))
}

/// Returns the rows `old`, each replaced by the one in `new` of its name and tolerance if there is one, and then the others of `new`.
fn joined<R: Entry>(mut old: Vec<R>, new: Vec<R>, tolerance: impl Fn(&R) -> f64) -> Result<Vec<R>> {
    let name = |row: &R| format!("{} to {:e}", row.name(), tolerance(row));
    let mut places = HashMap::new();
    for (place, row) in old.iter().enumerate() {
        ensure!(places.insert(name(row), place).is_none(), "two archived rows are of {}", name(row));
    }
    let mut seen = HashSet::new();
    for row in new {
        ensure!(seen.insert(name(&row)), "two rows of the study are of {}", name(&row));
        match places.get(&name(&row)) {
            Some(place) => old[*place] = row,
            None => old.push(row),
        }
    }
    Ok(old)
}

/// Refuses rows that name one problem and are of two: methods are compared on the same problem.
fn check_hashes(rows: &[Row]) -> Result<()> {
    let mut hashes = BTreeMap::new();
    for row in rows {
        let known = *hashes.entry(row.name).or_insert(row.hash);
        ensure!(
            known == row.hash,
            "{}: some rows are of another problem than the rest, by their hashes {known} and {}: make the rows of all of its methods again",
            row.name,
            row.hash
        );
    }
    Ok(())
}
