//! What the figures read of the stored tables, row by row.

use std::collections::{BTreeMap, BTreeSet};

use polars::prelude::DataFrame;

use crate::ReportError;

/// A run, without its curve.
pub(crate) struct RunRow {
    pub(crate) run: u32,
    pub(crate) problem: String,
    pub(crate) grains: u32,
    pub(crate) contacts: u32,
    pub(crate) method: String,
    pub(crate) variant: String,
    pub(crate) subdomains: u32,
    pub(crate) warm_start: bool,
    pub(crate) stop_on: String,
    pub(crate) tolerance: Option<f64>,
    pub(crate) status: String,
}

/// A sample of a curve; `None` where the measure is undefined.
pub(crate) struct Point {
    pub(crate) iteration: u64,
    pub(crate) zeta: Option<f64>,
    pub(crate) natural_map: Option<f64>,
}

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

pub(crate) fn runs(table: &DataFrame) -> Result<Vec<RunRow>, ReportError> {
    let (run, grains) = (u32s(table, "run")?, u32s(table, "grains")?);
    let (contacts, subdomains) = (u32s(table, "contacts")?, u32s(table, "subdomains")?);
    let (problem, method) = (texts(table, "problem")?, texts(table, "method")?);
    let (variant, status) = (texts(table, "variant")?, texts(table, "status")?);
    let (stop_on, tolerance) = (texts(table, "stop_on")?, measures(table, "tolerance")?);
    let warm_start = bools(table, "warm_start")?;
    let row = |i: usize| RunRow {
        run: run[i],
        problem: problem[i].clone(),
        grains: grains[i],
        contacts: contacts[i],
        method: method[i].clone(),
        variant: variant[i].clone(),
        subdomains: subdomains[i],
        warm_start: warm_start[i],
        stop_on: stop_on[i].clone(),
        tolerance: tolerance[i],
        status: status[i].clone(),
    };
    Ok((0..table.height()).map(row).collect())
}

/// The curves by run, each in the order of its iterations.
pub(crate) fn curves(table: &DataFrame) -> Result<BTreeMap<u32, Vec<Point>>, ReportError> {
    let (run, iteration) = (u32s(table, "run")?, u64s(table, "iteration")?);
    let (zeta, natural_map) = (measures(table, "zeta")?, measures(table, "natural_map")?);
    let mut curves: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    for i in 0..table.height() {
        let point = Point { iteration: iteration[i], zeta: zeta[i], natural_map: natural_map[i] };
        curves.entry(run[i]).or_default().push(point);
    }
    for curve in curves.values_mut() {
        curve.sort_by_key(|point| point.iteration);
    }
    Ok(curves)
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

fn filled<T>(column: &str, values: impl Iterator<Item = Option<T>>) -> Result<Vec<T>, ReportError> {
    let null = |row| ReportError::Null { column: column.to_owned(), row };
    values.enumerate().map(|(row, value)| value.ok_or_else(|| null(row))).collect()
}

fn texts(table: &DataFrame, column: &str) -> Result<Vec<String>, ReportError> {
    filled(column, table.column(column)?.str()?.iter().map(|text| text.map(str::to_owned)))
}

fn u32s(table: &DataFrame, column: &str) -> Result<Vec<u32>, ReportError> {
    filled(column, table.column(column)?.u32()?.iter())
}

fn u64s(table: &DataFrame, column: &str) -> Result<Vec<u64>, ReportError> {
    filled(column, table.column(column)?.u64()?.iter())
}

fn bools(table: &DataFrame, column: &str) -> Result<Vec<bool>, ReportError> {
    filled(column, table.column(column)?.bool()?.iter())
}

fn f64s(table: &DataFrame, column: &str) -> Result<Vec<f64>, ReportError> {
    filled(column, table.column(column)?.f64()?.iter())
}

/// A measure may be undefined; a NaN that reached the table means the same as a null.
fn measures(table: &DataFrame, column: &str) -> Result<Vec<Option<f64>>, ReportError> {
    Ok(table.column(column)?.f64()?.iter().map(|value| value.filter(|v| !v.is_nan())).collect())
}
