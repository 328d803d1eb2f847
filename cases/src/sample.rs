//! Samples: discs with radius, mass and place before time begins. What is random comes from the sample's seed.

use crate::deposit;
use crate::frozen::Frozen;
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
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// The grains of a frozen problem, at rest where it found them.
    Frozen {
        /// File of the problem, seen from the folder of the case.
        file: PathBuf,
    },
}

impl Sample {
    /// The discs, for a box of `width` (m), if it has side walls; `folder` is that of the case.
    pub(crate) fn discs(&self, width: Option<f64>, folder: &Path) -> Result<Vec<Disc>, String> {
        let discs = match *self {
            Self::Discs { ref discs, density_kg_per_m2 } => {
                discs.iter().map(|&[x, y, radius]| disc(x, y, radius, density_kg_per_m2)).collect()
            }
            Self::Column { grains, radius_m, density_kg_per_m2 } => (0..grains)
                .map(|k| disc(0.0, (2.0 * f64::from(k) + 1.0) * radius_m, radius_m, density_kg_per_m2))
                .collect(),
            Self::Triangular { columns, rows, radius_m, density_kg_per_m2 } => {
                triangular(columns, rows, radius_m, density_kg_per_m2)
            }
            Self::Deposited { grains, seed, radius_m, density_kg_per_m2 } => {
                let width = width.ok_or("`sample.kind` is deposited: it needs `scene.box.width_m`")?;
                let [least, greatest] = radius_m;
                if !(least > 0.0 && least <= greatest && greatest.is_finite()) {
                    return Err(format!(
                        "`sample.radius_m` is [{least}, {greatest}]: it must be positive, and not falling"
                    ));
                }
                if width < 4.0 * greatest {
                    return Err(format!(
                        "`scene.box.width_m` is {width}: it must be at least 4 greatest radii"
                    ));
                }
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let radii = (0..grains).map(|_| least + (greatest - least) * rng.random::<f64>());
                deposit::deposit(radii, width)
                    .map_err(|radius| {
                        format!("`sample`: no place in the box holds a disc of radius {radius} m")
                    })?
                    .into_iter()
                    .map(|(x, radius)| disc(x.x, x.y, radius, density_kg_per_m2))
                    .collect()
            }
            Self::Frozen { ref file } => {
                let frozen =
                    Frozen::read(&folder.join(file)).map_err(|error| format!("`sample.file`: {error}"))?;
                let problem = frozen.problem;
                let grains = problem.position().iter().zip(problem.mass()).zip(frozen.radius);
                grains
                    .map(|((position, mass), radius)| Disc { radius, mass: *mass, position: *position })
                    .collect()
            }
        };
        let valid = |disc: &&Disc| {
            let positive = |x: f64| x > 0.0 && x.is_finite();
            positive(disc.mass) && positive(disc.radius) && disc.position.iter().all(|x| x.is_finite())
        };
        match discs.iter().find(|disc| !valid(disc)) {
            Some(Disc { radius, mass, position }) => Err(format!(
                "`sample` has a disc of radius {radius} m and mass {mass} kg at ({}, {}) m: radius and mass must be \
                 positive, all finite",
                position.x, position.y
            )),
            None if discs.is_empty() => Err("`sample` has no grain".to_owned()),
            None => Ok(discs),
        }
    }
}

fn disc(x: f64, y: f64, radius: f64, density: f64) -> Disc {
    Disc { radius, mass: density * std::f64::consts::PI * radius * radius, position: Vector2::new(x, y) }
}

fn triangular(columns: u32, rows: u32, radius: f64, density: f64) -> Vec<Disc> {
    let mut discs = Vec::new();
    for row in 0..rows {
        let odd = row % 2;
        for column in 0..columns.saturating_sub(odd) {
            let x = (2.0 * f64::from(column) + 1.0 + f64::from(odd)) * radius;
            let y = radius * (1.0 + 3.0_f64.sqrt() * f64::from(row));
            discs.push(disc(x, y, radius, density));
        }
    }
    discs
}
