//! A file that this program wrote and others may have edited since. Its arrays are the problem; the text in it says only what FCLIB
//! has no place for, such as normals, radii and names.

use anyhow::{Result, bail};
use cases::AnyFrozen;
use lineup::{Global, Triplets};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Dataset of a file that holds the text of a problem file of ours.
pub(super) const OURS: &str = "gravel/problem";

/// Numbers that differ by less, relative to the greater, are the same (–): a product and its quotient are rounded.
const ROUND_OFF: f64 = 1e-12;

/// The text of the problem whose arrays are `theirs`, with unknowns of a contact, and all else as in `text`.
///
/// # Errors
/// Names an entry of an array that contradicts the text.
pub(super) fn reconciled(
    text: &str,
    dimension: usize,
    theirs: &Global,
    notes: &mut Vec<String>,
) -> Result<String> {
    let written = OfOurs::of(AnyFrozen::of_text(Path::new(OURS), text)?);
    if written.unknowns != dimension {
        bail!("`spacedim` is {dimension}, and `{OURS}` has {}: {ADVICE}", written.unknowns);
    }
    let edits = differences(&written.global, theirs)?;
    if edits.is_empty() {
        return Ok(text.to_owned());
    }
    let mut file: Value = serde_json::from_str(text)?;
    for edit in &edits {
        written.take(edit, theirs, &mut file);
    }
    let names: BTreeSet<&str> = edits.iter().map(|edit| edit.array).collect();
    let names = names.into_iter().collect::<Vec<_>>().join(", ");
    if let Some(source) = file["source"].as_str() {
        file["source"] = format!("{source} {names} as edited in an FCLIB file.").into();
    }
    let edited = AnyFrozen::of_text(Path::new(OURS), &file.to_string())?;
    let text = edited.to_json()?;
    if let Some(left) = differences(&OfOurs::of(edited).global, theirs)?.first() {
        let ((row, column), array) = (left.at, left.array);
        let at = if array.contains('/') { format!("{row}") } else { format!("{row}, {column}") };
        let (found, expected) = (left.theirs, left.ours);
        bail!("`fclib_global/{array}[{at}]` is {found:?}, and `{OURS}` makes {expected:?} of it: {ADVICE}");
    }
    notes.push(format!(
        "{names} were edited after gravel wrote the file: the arrays are the problem, the rest is from `{OURS}`"
    ));
    Ok(text)
}

const ADVICE: &str = "without the group `gravel`, the arrays are read alone, as a problem without grains";

/// A problem of ours as FCLIB has it.
struct OfOurs {
    /// Unknowns of a grain, and of a contact.
    size: usize,
    unknowns: usize,
    global: Global,
}

/// An entry of an array that is not as the text has it.
struct Edit {
    array: &'static str,
    at: (usize, usize),
    theirs: f64,
    ours: f64,
}

impl OfOurs {
    fn of(frozen: AnyFrozen) -> Self {
        let problem = lineup::problem(frozen);
        let facts = problem.facts();
        Self { size: facts.of_grain, unknowns: facts.dimensions, global: problem.arrays() }
    }

    /// Puts an entry of theirs into the file of the problem, if there is a place for it.
    fn take(&self, edit: &Edit, theirs: &Global, file: &mut Value) {
        let (row, d) = (edit.at.0, self.unknowns);
        match edit.array {
            "M" | "vectors/f" => {
                let mass = sums(&theirs.mass);
                let mass = |k: usize| mass.get(&(k, k)).copied().unwrap_or(0.0);
                let (grain, first) = (row / self.size, row - row % self.size);
                let grains = &mut file["grains"];
                grains["mass"][grain] = mass(first).into();
                if self.size > d {
                    grains["inertia"][grain] = mass(first + d).into();
                }
                let velocity: Vec<f64> = (first..first + self.size).map(|k| theirs.f[k] / mass(k)).collect();
                grains["free_velocity"][grain] = json!(velocity);
            }
            "vectors/w" => {
                let offset = &mut file["contacts"]["offset"][row / d];
                if let Some(part) = offset.get_mut(row % d) {
                    *part = edit.theirs.into();
                } else if row % d == 0 {
                    *offset = edit.theirs.into();
                }
            }
            "vectors/mu" => {
                let contacts = &mut file["contacts"];
                if let Some(friction) = contacts.get_mut("friction") {
                    friction[row] = edit.theirs.into();
                }
                // An impulse of the time step before may be outside of another cone.
                if let Some(contacts) = contacts.as_object_mut() {
                    contacts.remove("start");
                }
            }
            // Normals and arms are the text's.
            _ => {}
        }
    }
}

/// The entries of a matrix that are not zero, of which those of one place are added up.
fn sums(matrix: &Triplets) -> BTreeMap<(usize, usize), f64> {
    let mut sums = BTreeMap::new();
    for (row, column, x) in &matrix.entries {
        *sums.entry((*row, *column)).or_default() += x;
    }
    sums
}

/// Every entry that differs, array by array.
fn differences(ours: &Global, theirs: &Global) -> Result<Vec<Edit>> {
    type Array = (&'static str, [usize; 2], BTreeMap<(usize, usize), f64>);
    let matrix = |name, matrix: &Triplets| -> Array { (name, [matrix.rows, matrix.columns], sums(matrix)) };
    let list = |name, list: &[f64]| -> Array {
        (name, [list.len(), 1], list.iter().enumerate().map(|(k, x)| ((k, 0), *x)).collect())
    };
    let arrays = |of: &Global| {
        [
            matrix("M", &of.mass),
            matrix("H", &of.h),
            list("vectors/f", &of.f),
            list("vectors/w", &of.w),
            list("vectors/mu", &of.friction),
        ]
    };
    let mut edits = Vec::new();
    for ((array, size, ours), (_, theirs_size, theirs)) in arrays(ours).into_iter().zip(arrays(theirs)) {
        if size != theirs_size {
            bail!(
                "`fclib_global/{array}` is of size {theirs_size:?}, and `{OURS}` makes {size:?} of it: {ADVICE}"
            );
        }
        let places: BTreeSet<_> = ours.keys().chain(theirs.keys()).copied().collect();
        let of = |map: &BTreeMap<_, f64>, at: &(usize, usize)| map.get(at).copied().unwrap_or(0.0);
        let pairs =
            places.into_iter().map(|at| Edit { array, at, theirs: of(&theirs, &at), ours: of(&ours, &at) });
        let differs = |edit: &Edit| {
            let Edit { theirs, ours, .. } = edit;
            !((theirs - ours).abs() <= ROUND_OFF * theirs.abs().max(ours.abs()))
        };
        edits.extend(pairs.filter(differs));
    }
    Ok(edits)
}
