//! Samples: discs with radius, mass and place before time begins. What is random comes from the sample's seed.

use crate::deposit;
use crate::rough::AnyFrozen;
use crate::shapes;
use contact::{is_positive, shown};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A rigid disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Radius (m).
    pub radius: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Centre (m).
    pub position: Vector2<f64>,
}

/// How the discs of a scene are made.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Sample {
    /// Discs given one by one.
    Discs {
        /// Centres and radius of each, as [x, y, radius] (m).
        discs: Vec<[f64; 3]>,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// Equal discs, each on top of the one before, the first on the floor.
    Column {
        /// Number of discs.
        grains: u32,
        /// Their radius (m).
        radius_m: f64,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
        /// Mass of the highest disc over that of the others (–).
        #[serde(default = "one")]
        top_mass_ratio: f64,
    },
    /// Equal discs in a triangular crystal: rows of `columns` and `columns` − 1 in turn, the first on the floor, between
    /// walls that are `columns` diameters apart.
    Triangular {
        /// Discs in the longer rows.
        columns: u32,
        /// Number of rows.
        rows: u32,
        /// Their radius (m).
        radius_m: f64,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
        /// How far neighbours overlap, over a diameter (–).
        #[serde(default)]
        overlap: f64,
    },
    /// Equal discs in a zigzag from wall to wall, low and high in turn, each touching the next; the low ones on the
    /// floor. The width of the box, up to `grains` diameters, says how flat it is.
    Zigzag {
        /// Number of discs.
        grains: u32,
        /// Their radius (m).
        radius_m: f64,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// A disc on a row of rollers, which stand apart on the floor and all touch it.
    Rollers {
        /// Number of rollers.
        rollers: u32,
        /// Radius of a roller right below (m); those aside are larger.
        radius_m: f64,
        /// Radius of the disc above (m).
        top_radius_m: f64,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
        /// Mass of the disc above over what its area gives (–).
        #[serde(default = "one")]
        top_mass_ratio: f64,
    },
    /// Discs with radii drawn evenly from a range, laid one by one at the lowest place left where two others, or one
    /// and a wall, hold it: close to a packing at rest, which time then settles.
    Deposited {
        /// Number of discs.
        grains: u32,
        /// Seed of the radii.
        seed: u64,
        /// Least and greatest radius (m).
        radius_m: [f64; 2],
        /// Radius of one disc in the midst of the others, in place of its own (m).
        intruder_radius_m: Option<f64>,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// The grains of a frozen problem, at rest where it found them.
    Frozen {
        /// File of the problem, seen from the folder of the case.
        file: PathBuf,
    },
}

fn one() -> f64 {
    1.0
}

impl Sample {
    /// Key and number of the grains that it makes; `None` where they are in the case, or in another file.
    pub fn grains(&self) -> Option<(&'static str, u64)> {
        match *self {
            Self::Column { grains, .. } | Self::Zigzag { grains, .. } | Self::Deposited { grains, .. } => {
                Some(("sample.grains", grains.into()))
            }
            Self::Triangular { columns, rows, .. } => {
                let less = u64::from(rows) / 2;
                let all = u64::from(columns) * u64::from(rows);
                Some(("sample.columns times sample.rows", all.saturating_sub(less)))
            }
            Self::Rollers { rollers, .. } => Some(("sample.rollers", rollers.into())),
            Self::Discs { .. } | Self::Frozen { .. } => None,
        }
    }

    /// The discs, for a box of `width` (m), if it has side walls; `folder` is that of the case.
    pub(crate) fn discs(&self, width: Option<f64>, folder: &Path) -> Result<Vec<Disc>, String> {
        let walls = || width.ok_or("`sample.kind` asks for side walls: it needs `scene.box.width_m`");
        // [x, y, radius] of each (m), mass per area (kg/m²), and the mass of the last over what its area gives (–).
        let (placed, density, top_mass_ratio) = match *self {
            Self::Discs { ref discs, density_kg_per_m2 } => (discs.clone(), density_kg_per_m2, 1.0),
            Self::Column { grains, radius_m, density_kg_per_m2, top_mass_ratio } => {
                (shapes::column(grains, radius_m), density_kg_per_m2, top_mass_ratio)
            }
            Self::Triangular { columns, rows, radius_m, density_kg_per_m2, overlap } => {
                (shapes::triangular(columns, rows, radius_m, overlap), density_kg_per_m2, 1.0)
            }
            Self::Zigzag { grains, radius_m, density_kg_per_m2 } => {
                (shapes::zigzag(grains, radius_m, walls()?)?, density_kg_per_m2, 1.0)
            }
            Self::Rollers { rollers, radius_m, top_radius_m, density_kg_per_m2, top_mass_ratio } => {
                (shapes::rollers(rollers, radius_m, top_radius_m)?, density_kg_per_m2, top_mass_ratio)
            }
            Self::Deposited { grains, seed, radius_m, intruder_radius_m, density_kg_per_m2 } => {
                let radii = drawn(grains, seed, radius_m, intruder_radius_m, walls()?)?;
                let deposited = deposit::deposit(&radii, walls()?).map_err(|radius| {
                    format!("`sample`: no place in the box holds a disc of radius {} m", shown(radius))
                })?;
                let discs = deposited.into_iter().map(|(x, radius)| [x.x, x.y, radius]);
                (discs.collect(), density_kg_per_m2, 1.0)
            }
            Self::Frozen { ref file } => return checked(frozen_discs(&folder.join(file))?),
        };
        let disc = |&[x, y, radius]: &[f64; 3]| {
            let mass = density * std::f64::consts::PI * radius * radius;
            Disc { radius, mass, position: Vector2::new(x, y) }
        };
        let mut discs: Vec<Disc> = placed.iter().map(disc).collect();
        discs.iter_mut().rev().take(1).for_each(|top| top.mass *= top_mass_ratio);
        checked(discs)
    }
}

fn frozen_discs(file: &Path) -> Result<Vec<Disc>, String> {
    Ok(AnyFrozen::read(file).map_err(|error| format!("`sample.file`: {error}"))?.discs())
}

/// The discs, if there are some and all have a meaning.
fn checked(discs: Vec<Disc>) -> Result<Vec<Disc>, String> {
    let valid = |disc: &&Disc| {
        is_positive(disc.mass) && is_positive(disc.radius) && disc.position.iter().all(|x| x.is_finite())
    };
    match discs.iter().find(|disc| !valid(disc)) {
        Some(Disc { radius, mass, position }) => Err(format!(
            "`sample` has a disc of radius {} m and mass {} kg at ({}, {}) m: radius and mass must be positive, all finite",
            shown(*radius),
            shown(*mass),
            shown(position.x),
            shown(position.y)
        )),
        None if discs.is_empty() => Err("`sample` has no grain".to_owned()),
        None => Ok(discs),
    }
}

/// Radii drawn evenly from a range, that of the intruder in the middle of the list.
fn drawn(
    grains: u32,
    seed: u64,
    [least, greatest]: [f64; 2],
    intruder: Option<f64>,
    width: f64,
) -> Result<Vec<f64>, String> {
    if !(least > 0.0 && least <= greatest && greatest.is_finite()) {
        return Err(format!(
            "`sample.radius_m` is [{}, {}]: it must be positive, and not falling",
            shown(least),
            shown(greatest)
        ));
    }
    if let Some(radius) = intruder.filter(|radius| !is_positive(*radius)) {
        return Err(format!(
            "`sample.intruder_radius_m` is {}: it must be positive and finite",
            shown(radius)
        ));
    }
    if width < 4.0 * f64::max(greatest, intruder.unwrap_or(0.0)) {
        return Err(format!("`scene.box.width_m` is {}: it must be at least 4 greatest radii", shown(width)));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut radii: Vec<f64> = (0..grains).map(|_| least + (greatest - least) * rng.random::<f64>()).collect();
    if let (Some(intruder), Some(middle)) = (intruder, radii.get_mut(grains as usize / 2)) {
        *middle = intruder;
    }
    Ok(radii)
}
