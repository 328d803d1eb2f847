//! The discs and contacts of the pictures, row by row.

use std::collections::{BTreeMap, BTreeSet};

use polars::prelude::DataFrame;

use crate::ReportError;
use crate::columns::{bools, f64s, measures, texts, u32s};
use crate::style::SUBDOMAINS;

/// A disc of a problem under a partition.
pub(crate) struct GrainRow {
    pub(crate) centre: (f64, f64),
    pub(crate) radius: f64,
    pub(crate) subdomain: Option<u32>,
    pub(crate) multiplicity: u32,
}

/// A contact of a problem under a partition: from the candidate's centre to the antagonist's, or to the wall.
pub(crate) struct ContactRow {
    pub(crate) from: (f64, f64),
    pub(crate) to: (f64, f64),
    pub(crate) wall: bool,
    pub(crate) subdomain: u32,
    pub(crate) impulse: Option<f64>,
}

/// The discs and contacts of one figure.
#[derive(Default)]
pub(crate) struct Scene {
    pub(crate) grains: Vec<GrainRow>,
    pub(crate) contacts: Vec<ContactRow>,
}

impl Scene {
    /// The subdomains that hold contacts, in order.
    pub(crate) fn subdomains(&self) -> BTreeSet<u32> {
        self.contacts.iter().map(|contact| contact.subdomain).collect()
    }
}

/// The fill of a subdomain, its place in [`SUBDOMAINS`]: by its column and row in the grid of the partition alone, so that
/// it is the same at all moments of a study. Neighbours differ, in colour and in grey.
pub(crate) fn fill(partition: &str, subdomain: u32) -> usize {
    let fills = SUBDOMAINS.len() as u32;
    let number = |text: &str| text.split(|c: char| !c.is_ascii_digit()).next()?.parse::<u32>().ok();
    let grid = partition.split_once('x').and_then(|(columns, rows)| Some((number(columns)?, number(rows)?)));
    let place = match grid {
        // A row further on lies as far off as eight fills allow.
        Some((columns, rows)) if columns > 0 && columns.saturating_mul(rows) > fills => {
            subdomain % columns + fills / 2 * (subdomain / columns)
        }
        _ => subdomain,
    };
    (place % fills) as usize
}

/// The scenes by problem and partition.
pub(crate) fn scenes(
    grains: &DataFrame,
    contacts: &DataFrame,
) -> Result<BTreeMap<(String, String), Scene>, ReportError> {
    let mut scenes: BTreeMap<(String, String), Scene> = BTreeMap::new();
    for (name, grain) in names(grains)?.into_iter().zip(grain_rows(grains)?) {
        scenes.entry(name).or_default().grains.push(grain);
    }
    for (name, contact) in names(contacts)?.into_iter().zip(contact_rows(contacts)?) {
        scenes.entry(name).or_default().contacts.push(contact);
    }
    Ok(scenes)
}

fn names(table: &DataFrame) -> Result<Vec<(String, String)>, ReportError> {
    Ok(texts(table, "problem")?.into_iter().zip(texts(table, "partition")?).collect())
}

fn grain_rows(table: &DataFrame) -> Result<Vec<GrainRow>, ReportError> {
    let (x, y, radius) = (f64s(table, "x_m")?, f64s(table, "y_m")?, f64s(table, "radius_m")?);
    let subdomain = table.column("subdomain")?.u32()?;
    let multiplicity = u32s(table, "multiplicity")?;
    let row = |i: usize| GrainRow {
        centre: (x[i], y[i]),
        radius: radius[i],
        subdomain: subdomain.get(i),
        multiplicity: multiplicity[i],
    };
    Ok((0..table.height()).map(row).collect())
}

fn contact_rows(table: &DataFrame) -> Result<Vec<ContactRow>, ReportError> {
    let (x0, y0) = (f64s(table, "x0_m")?, f64s(table, "y0_m")?);
    let (x1, y1) = (f64s(table, "x1_m")?, f64s(table, "y1_m")?);
    let (wall, impulse) = (bools(table, "wall")?, measures(table, "impulse_n_s")?);
    let subdomain = u32s(table, "subdomain")?;
    let row = |i: usize| ContactRow {
        from: (x0[i], y0[i]),
        to: (x1[i], y1[i]),
        wall: wall[i],
        subdomain: subdomain[i],
        impulse: impulse[i],
    };
    Ok((0..table.height()).map(row).collect())
}

#[cfg(test)]
mod tests {
    use plotters::style::RGBColor;

    use super::*;

    fn lightness(fill: usize) -> f64 {
        let RGBColor(r, g, b) = SUBDOMAINS[fill];
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    }

    #[test]
    fn subdomains_side_by_side_differ_in_grey_and_those_across_differ_too() {
        for (columns, rows) in
            [(2, 1), (4, 2), (2, 4), (3, 2), (8, 1), (1, 8), (8, 8), (1, 16), (16, 1), (5, 5)]
        {
            for name in [format!("{columns}x{rows}"), format!("{columns}x{rows}-balanced")] {
                let fill_at = |column: u32, row: u32| fill(&name, column + columns * row);
                for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
                    let here = fill_at(column, row);
                    for (right, up, apart) in [(1, 0, 20.0), (0, 1, 20.0), (1, 1, 10.0)] {
                        if column + right < columns && row + up < rows {
                            let there = fill_at(column + right, row + up);
                            let differ = (lightness(here) - lightness(there)).abs();
                            assert!(differ >= apart, "{name}: {here} and {there} differ by {differ} of 255");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn up_to_eight_subdomains_have_as_many_fills() {
        for name in ["4x2", "2x4", "8x1", "2x2-balanced"] {
            let fills: BTreeSet<usize> = (0..8).map(|subdomain| fill(name, subdomain)).collect();
            assert_eq!(fills.len(), 8, "{name}");
        }
    }
}
