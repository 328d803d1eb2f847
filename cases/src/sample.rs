//! Samples: discs or spheres with radius, mass and place before time begins. What is random comes from the sample's seed.

pub(crate) mod deposit;
pub(crate) mod made;
pub(crate) mod placed;
pub(crate) mod shapes;
pub(crate) mod sizes;
pub(crate) mod strips;

use crate::sample::sizes::Sizes;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Initial grains of a scene: discs in the plane, or spheres in space.
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
        /// Overlap of neighbours, over a diameter (–).
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
    /// Discs with radii drawn from a range, laid one by one at the lowest place left where two others, or one
    /// and a wall, hold it: close to a packing at rest, which time then settles.
    Deposited {
        /// Number of discs.
        grains: u32,
        /// Seed of the radii.
        seed: u64,
        /// Least and greatest radius (m).
        radius_m: [f64; 2],
        /// Distribution of the radii between these two; without it uniform by number.
        #[serde(default)]
        sizes: Sizes,
        /// Radius of one disc in the midst of the others, in place of its own (m).
        intruder_radius_m: Option<f64>,
        /// Width of the place that they are laid in, from x = 0 on, where the box is wider or there is none (m).
        width_m: Option<f64>,
        /// Height of the level that they are laid on, such as above the gate of a hopper (m).
        #[serde(default)]
        lift_m: f64,
        /// Number of strips, side by side, each deposited on its own before the seams between them are filled: so
        /// `gravel-mpi split` makes a sample that no machine holds. Without it the box is filled as a whole.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 1))]
        strips: Option<u32>,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// Spheres given one by one.
    Spheres {
        /// Centres and radius of each, as [x, y, z, radius] (m).
        spheres: Vec<[f64; 4]>,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// Equal spheres, each on top of the one before, the first on the floor.
    ColumnOfSpheres {
        /// Number of spheres.
        grains: u32,
        /// Their radius (m).
        radius_m: f64,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
        /// Mass of the highest sphere over that of the others (–).
        #[serde(default = "one")]
        top_mass_ratio: f64,
    },
    /// Equal spheres in a simple cubic crystal, each right above another, the lowest on the floor, those outside at the walls.
    SimpleCubic {
        /// Spheres along x, y and z.
        counts: [u32; 3],
        /// Their radius (m).
        radius_m: f64,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// Equal spheres in a face-centred cubic crystal, closest packed: square layers, each in the hollows of the one below.
    FaceCentred {
        /// Spheres along x and z in the lowest layer, and number of layers, as [x, layers, z].
        counts: [u32; 3],
        /// Their radius (m).
        radius_m: f64,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// Spheres with radii drawn from a range, let fall one by one over places that are drawn too: each rolls down to where
    /// others and walls hold it, and a few stop on the way. Loose, and near a packing at rest, which time then settles.
    DepositedSpheres {
        /// Number of spheres.
        grains: u32,
        /// Seed of radii and places.
        seed: u64,
        /// Least and greatest radius (m).
        radius_m: [f64; 2],
        /// Distribution of the radii between these two; without it uniform by number.
        #[serde(default)]
        sizes: Sizes,
        /// Width of the place that they are laid in, from x = 0 on, where the box is wider or there is none (m).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        width_m: Option<f64>,
        /// Its depth, from z = 0 on, likewise (m).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        depth_m: Option<f64>,
        /// Height of the level that they are laid on, such as above the gate of a hopper (m).
        #[serde(default, skip_serializing_if = "is_zero")]
        lift_m: f64,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// Discs at the places of a CSV file, with the columns `x_m`, `y_m` and `radius_m`, and where they are there `density_kg_per_m2`,
    /// `velocity_x_m_per_s`, `velocity_y_m_per_s` and `spin_rad_per_s`; others are ignored.
    Placed {
        /// The file, seen from the folder of the case.
        file: PathBuf,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// Spheres at the places of a CSV file, with the columns `x_m`, `y_m`, `z_m` and `radius_m`, and where they are there
    /// `density_kg_per_m3`, `velocity_x_m_per_s`, `velocity_y_m_per_s` and `velocity_z_m_per_s`, `spin_x_rad_per_s`, `spin_y_rad_per_s`
    /// and `spin_z_rad_per_s`.
    PlacedSpheres {
        /// The file, seen from the folder of the case.
        file: PathBuf,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// The grains of a frozen problem, at rest where it found them.
    Frozen {
        /// File of the problem, seen from the folder of the case.
        file: PathBuf,
    },
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn one() -> f64 {
    1.0
}

impl Sample {
    /// Key and number of the grains that it makes; `None` where they are in the case, or in another file.
    pub fn grains(&self) -> Option<(&'static str, u64)> {
        match *self {
            Self::Column { grains, .. }
            | Self::Zigzag { grains, .. }
            | Self::Deposited { grains, .. }
            | Self::ColumnOfSpheres { grains, .. }
            | Self::DepositedSpheres { grains, .. } => Some(("sample.grains", grains.into())),
            Self::SimpleCubic { counts, .. } | Self::FaceCentred { counts, .. } => Some((
                "sample.counts",
                counts.iter().map(|count| u64::from(*count)).fold(1, u64::saturating_mul),
            )),
            Self::Triangular { columns, rows, .. } => {
                let less = u64::from(rows) / 2;
                let all = u64::from(columns) * u64::from(rows);
                Some(("sample.columns times sample.rows", all.saturating_sub(less)))
            }
            Self::Rollers { rollers, .. } => Some(("sample.rollers", rollers.into())),
            Self::Discs { .. }
            | Self::Spheres { .. }
            | Self::Placed { .. }
            | Self::PlacedSpheres { .. }
            | Self::Frozen { .. } => None,
        }
    }

    /// Mass per area of discs (kg/m²), or per volume of spheres (kg/m³), and whether they are spheres; none of grains that
    /// another file describes.
    fn density(&self) -> Option<(f64, bool)> {
        match *self {
            Self::Discs { density_kg_per_m2: density, .. }
            | Self::Column { density_kg_per_m2: density, .. }
            | Self::Triangular { density_kg_per_m2: density, .. }
            | Self::Zigzag { density_kg_per_m2: density, .. }
            | Self::Rollers { density_kg_per_m2: density, .. }
            | Self::Deposited { density_kg_per_m2: density, .. }
            | Self::Placed { density_kg_per_m2: density, .. } => Some((density, false)),
            Self::Spheres { density_kg_per_m3: density, .. }
            | Self::ColumnOfSpheres { density_kg_per_m3: density, .. }
            | Self::SimpleCubic { density_kg_per_m3: density, .. }
            | Self::FaceCentred { density_kg_per_m3: density, .. }
            | Self::DepositedSpheres { density_kg_per_m3: density, .. }
            | Self::PlacedSpheres { density_kg_per_m3: density, .. } => Some((density, true)),
            Self::Frozen { .. } => None,
        }
    }
}
