//! The discs and contacts of the pictures, row by row.

use std::collections::{BTreeMap, BTreeSet};

use polars::prelude::DataFrame;

use crate::ReportError;
use crate::columns::{bools, f64s, measures, texts, u32s};

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
