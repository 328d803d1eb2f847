//! The discs and contacts of the pictures, row by row.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use plotters::style::RGBColor;
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

    /// The fill of each subdomain, its place in [`SUBDOMAINS`]: the one of its number, or the next that its neighbours do
    /// not have, in colour or in grey.
    pub(crate) fn fills(&self) -> BTreeMap<u32, usize> {
        let place = |(x, y): (f64, f64)| (x.to_bits(), y.to_bits());
        let of_grain = |grain: &GrainRow| Some((place(grain.centre), grain.subdomain?));
        let of_grains: HashMap<_, u32> = self.grains.iter().filter_map(of_grain).collect();
        let mut neighbours: BTreeMap<u32, BTreeSet<u32>> =
            of_grains.values().map(|subdomain| (*subdomain, BTreeSet::new())).collect();
        for contact in &self.contacts {
            let [from, to] = [contact.from, contact.to].map(|centre| of_grains.get(&place(centre)));
            if let (Some(e), Some(f)) = (from, to) {
                neighbours.entry(*e).or_default().insert(*f);
                neighbours.entry(*f).or_default().insert(*e);
            }
        }
        let mut fills: BTreeMap<u32, usize> = BTreeMap::new();
        for (e, neighbours) in neighbours {
            let taken: Vec<f64> =
                neighbours.iter().filter_map(|f| fills.get(f)).map(|fill| lightness(*fill)).collect();
            let apart = |fill: &usize| {
                taken.iter().map(|other| (other - lightness(*fill)).abs()).fold(f64::INFINITY, f64::min)
            };
            let all = (0..SUBDOMAINS.len()).map(|k| (e as usize + k) % SUBDOMAINS.len());
            let farthest = || all.clone().max_by(|a, b| apart(a).total_cmp(&apart(b)));
            let fill = all.clone().find(|fill| apart(fill) >= APART).or_else(farthest);
            fills.insert(e, fill.unwrap_or(0));
        }
        fills
    }
}

/// Two greys of 255 that differ by this are told apart side by side.
const APART: f64 = 20.0;

/// Of a fill in grey, of 255.
fn lightness(fill: usize) -> f64 {
    let RGBColor(r, g, b) = SUBDOMAINS[fill];
    0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
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
    use super::*;

    /// Subdomains of one disc each, in rows of `columns`; each touches those beside and above, and if asked those across.
    fn grid(columns: u32, rows: u32, across: bool) -> Scene {
        let centre = |e: u32| (f64::from(e % columns), f64::from(e / columns));
        let grain = |e| GrainRow { centre: centre(e), radius: 0.7, subdomain: Some(e), multiplicity: 2 };
        let all = 0..columns * rows;
        let touch = |(e, f): &(u32, u32)| {
            let ((x, y), (u, v)) = (centre(*e), centre(*f));
            let (dx, dy) = ((x - u).abs(), (y - v).abs());
            e < f && dx.max(dy) <= 1.0 && (across || dx + dy <= 1.0)
        };
        let pairs = all.clone().flat_map(|e| all.clone().map(move |f| (e, f))).filter(touch);
        let contact =
            |(e, f)| ContactRow { from: centre(e), to: centre(f), wall: false, subdomain: e, impulse: None };
        Scene { grains: all.clone().map(grain).collect(), contacts: pairs.map(contact).collect() }
    }

    #[test]
    fn neighbours_have_other_fills_and_those_side_by_side_differ_in_grey() {
        for (columns, rows) in [(2, 1), (4, 2), (8, 8), (1, 16), (16, 1), (5, 5)] {
            for (across, apart) in [(false, APART), (true, 10.0)] {
                let scene = grid(columns, rows, across);
                let fills = scene.fills();
                assert_eq!(fills.len(), (columns * rows) as usize);
                for contact in &scene.contacts {
                    let (e, f) = (contact.subdomain, contact.to.1 as u32 * columns + contact.to.0 as u32);
                    let differ = (lightness(fills[&e]) - lightness(fills[&f])).abs();
                    assert!(differ >= apart, "{columns}x{rows}: {e} and {f} differ by {differ} of 255");
                }
            }
        }
    }
}
