//! Grains whose places and radii are in a CSV file.

use crate::detect::{Side, detect};
use contact::shown;
use nalgebra::Vector3;
use serde::Deserialize;
use std::path::Path;

/// A line of the file; other columns are ignored.
#[derive(Deserialize)]
struct Line {
    #[serde(rename = "x_m")]
    x: f64,
    #[serde(rename = "y_m")]
    y: f64,
    #[serde(default, rename = "z_m")]
    z: Option<f64>,
    #[serde(rename = "radius_m")]
    radius: f64,
}

/// The share of the smaller radius by which two grains may overlap (–): what another code left of its contacts.
pub(crate) const OVERLAP: f64 = 0.1;

/// [x, y, z, radius] of each grain (m); discs have z = 0.
///
/// # Errors
/// Names the file, and the line or the column of it that has no meaning.
pub(crate) fn placed(file: &Path, in_space: bool) -> Result<Vec<[f64; 4]>, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("`sample.file`: {}: {error}", file.display());
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(file).map_err(|error| wrong(&error))?;
    let headers = reader.headers().map_err(|error| wrong(&error))?.clone();
    if let Some(name) = separated_otherwise(&headers) {
        let line = headers.as_slice();
        return Err(wrong(&format!(
            "line 1 is {line:?}, with {name} between values: commas are asked there, and points in decimals, as in 0.25"
        )));
    }
    let (mut grains, mut lines) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } if len > expected_len => wrong(
                &format!("{error}: commas are asked between values, and points in decimals, as in 0.25"),
            ),
            _ => wrong(&error),
        })?;
        let number = record.position().map_or(0, csv::Position::line);
        let Line { x, y, z, radius } = record.deserialize(Some(&headers)).map_err(|error| wrong(&error))?;
        let z = match (z, in_space) {
            (Some(z), true) => z,
            (None, false) => 0.0,
            (None, true) => return Err(wrong(&"a sphere needs the column `z_m`")),
            (Some(_), false) => return Err(wrong(&"a disc has no `z_m`: spheres are `placed-spheres`")),
        };
        let grain = [x, y, z, radius];
        if !(grain.iter().all(|x| x.is_finite()) && radius > 0.0) {
            let found = grain.map(shown).join(", ");
            return Err(wrong(&format!(
                "line {number}: [x, y, z, radius] is [{found}]: finite numbers and a positive radius are asked"
            )));
        }
        grains.push(grain);
        lines.push(number);
    }
    if grains.is_empty() {
        return Err(wrong(&"it has no grain"));
    }
    match overlapping(&grains) {
        Some([i, j]) => Err(wrong(&format!(
            "the grains of lines {} and {} overlap by more than {OVERLAP} of the smaller radius",
            lines[i], lines[j]
        ))),
        None => Ok(grains),
    }
}

/// Returns the separator of the names of columns where it is no comma.
fn separated_otherwise(headers: &csv::StringRecord) -> Option<&'static str> {
    let separators = [(";", "semicolons"), ("\t", "tabs")];
    let found = |separator: &str| headers.iter().any(|name| name.contains(separator));
    separators.into_iter().find(|(separator, _)| found(separator)).map(|(_, name)| name)
}

/// Two grains that overlap too much.
fn overlapping(grains: &[[f64; 4]]) -> Option<[usize; 2]> {
    let position: Vec<Vector3<f64>> = grains.iter().map(|[x, y, z, _]| Vector3::new(*x, *y, *z)).collect();
    let radius: Vec<f64> = grains.iter().map(|[.., radius]| *radius).collect();
    detect(&position, &radius, 0.0).into_iter().find_map(|contact| {
        let Side::Grain(other) = contact.antagonist else { return None };
        let pair = [contact.candidate as usize, other as usize];
        let least = radius[pair[0]].min(radius[pair[1]]);
        (contact.gap < -OVERLAP * least).then_some(pair)
    })
}

#[cfg(test)]
mod tests;
