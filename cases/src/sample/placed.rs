//! Grains whose places and radii are in a CSV file.

use crate::detect::{OVERLAP, Side, detect};
use crate::file::json::read_text;
use contact::{is_positive, shown};
use nalgebra::Vector3;
use std::path::Path;

/// Advice on the form of a file.
const ADVICE: &str = "values are separated by commas, and decimals have points, as in 0.25";

/// A grain of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed {
    /// Centre [x, y, z] and radius (m); discs have z = 0.
    pub(crate) ball: [f64; 4],
    /// Mass per area (kg/m²) or per volume (kg/m³), if the file has it.
    pub(crate) density: Option<f64>,
    /// Velocity along x, y and z (m/s), and spin about them (rad/s).
    pub(crate) motion: [f64; 6],
}

/// Names of the columns of densities, and of velocities and spins, of discs and of spheres; all may be left out.
pub(crate) const DENSITY: [&str; 2] = ["density_kg_per_m2", "density_kg_per_m3"];
pub(crate) const MOTION: [[Option<&str>; 6]; 2] = [
    [Some("velocity_x_m_per_s"), Some("velocity_y_m_per_s"), None, None, None, Some("spin_rad_per_s")],
    [
        Some("velocity_x_m_per_s"),
        Some("velocity_y_m_per_s"),
        Some("velocity_z_m_per_s"),
        Some("spin_x_rad_per_s"),
        Some("spin_y_rad_per_s"),
        Some("spin_z_rad_per_s"),
    ],
];

/// Returns the grains of a file.
///
/// # Errors
/// Names the file, the line, the column and the value that has no meaning.
pub(crate) fn placed(file: &Path, in_space: bool) -> Result<Vec<Placed>, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("`sample.file`: {}: {error}", file.display());
    let text = read_text(file).map_err(|error| format!("`sample.file`: {error}"))?;
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| wrong(&error))?.clone();
    let columns = Columns::of(&headers, in_space).map_err(|error| wrong(&error))?;
    let (mut grains, mut lines) = (Vec::new(), Vec::new());
    for row in reader.records() {
        let row = row.map_err(|error| wrong(&error))?;
        let number = row.position().map_or(0, csv::Position::line);
        grains.push(columns.grain(&row).map_err(|error| wrong(&format!("line {number}{error}")))?);
        lines.push(number);
    }
    if grains.is_empty() {
        return Err(wrong(&"it has no grain"));
    }
    let balls: Vec<[f64; 4]> = grains.iter().map(|grain: &Placed| grain.ball).collect();
    match overlapping(&balls) {
        Some([i, j]) => Err(wrong(&format!(
            "the grains of lines {} and {} overlap by more than {OVERLAP} of the smaller radius",
            lines[i], lines[j]
        ))),
        None => Ok(grains),
    }
}

/// Places of the columns in a line.
struct Columns<'f> {
    headers: &'f csv::StringRecord,
    x: usize,
    y: usize,
    z: Option<usize>,
    radius: usize,
    density: Option<usize>,
    motion: [Option<usize>; 6],
    in_space: bool,
}

impl<'f> Columns<'f> {
    fn of(headers: &'f csv::StringRecord, in_space: bool) -> Result<Self, String> {
        let head = format!("line 1 is {:?}", joined(headers));
        if let Some(name) = separated_otherwise(headers) {
            return Err(format!("{head}, with {name} between values: {ADVICE}"));
        }
        let column = |name: &str| {
            let mut found = (0..headers.len()).filter(|k| &headers[*k] == name);
            let first = found.next();
            if found.next().is_some() {
                return Err(format!("{head}: the column `{name}` is there twice"));
            }
            Ok(first)
        };
        let needed = |name| column(name)?.ok_or_else(|| format!("{head}: the column `{name}` is missing"));
        let (x, y, radius, z) = (needed("x_m")?, needed("y_m")?, needed("radius_m")?, column("z_m")?);
        if in_space && z.is_none() {
            return Err("a sphere needs the column `z_m`".to_owned());
        }
        let (density, mut motion) = (column(DENSITY[usize::from(in_space)])?, [None; 6]);
        for (place, name) in motion.iter_mut().zip(MOTION[usize::from(in_space)]) {
            *place = name.map_or(Ok(None), column)?;
        }
        Ok(Self { headers, x, y, z, radius, density, motion, in_space })
    }

    /// The grain in a row.
    fn grain(&self, row: &csv::StringRecord) -> Result<Placed, String> {
        let (count, columns) = (row.len(), self.headers.len());
        if let Some(name) = self.headers.get(count) {
            return Err(format!(
                " is {:?}: `{name}` is missing, since it has {count} values and line 1 has {columns}: one is asked for each column",
                joined(row)
            ));
        }
        if count > columns {
            return Err(format!(
                " is {:?}, of {count} values, where line 1 has {columns}: {ADVICE}",
                joined(row)
            ));
        }
        let value = |k: usize| {
            let (name, is) = (&self.headers[k], &row[k]);
            is.parse::<f64>().map_err(|_| format!(": `{name}` is {is:?}: a number is asked; {ADVICE}"))
        };
        let z = match self.z {
            Some(z) if self.in_space => value(z)?,
            Some(z) if !row[z].is_empty() => {
                return Err(": a disc has no `z_m`: spheres are `placed-spheres`".to_owned());
            }
            _ => 0.0,
        };
        let grain = [value(self.x)?, value(self.y)?, z, value(self.radius)?];
        let density = self.density.map(value).transpose()?;
        let mut motion = [0.0; 6];
        for (own, column) in motion.iter_mut().zip(self.motion) {
            *own = column.map_or(Ok(0.0), value)?;
        }
        let named =
            self.density.into_iter().zip(density).map(|(k, density)| (k, density, is_positive(density)));
        let moving = self.motion.into_iter().zip(motion).filter_map(|(k, v)| Some((k?, v, v.is_finite())));
        if let Some((k, value, _)) = named.chain(moving).find(|(.., valid)| !valid) {
            let (name, value) = (&self.headers[k], shown(value));
            return Err(format!(": `{name}` is {value}: numbers must be finite, and densities positive"));
        }
        if grain.iter().all(|x| x.is_finite()) && grain[3] > 0.0 {
            return Ok(Placed { ball: grain, density, motion });
        }
        let found = grain.map(shown).join(", ");
        Err(format!(": [x, y, z, radius] is [{found}]: numbers must be finite, and the radius positive"))
    }
}

/// The values of a line, with commas between them.
fn joined(line: &csv::StringRecord) -> String {
    line.iter().collect::<Vec<_>>().join(",")
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
