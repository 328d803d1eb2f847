//! Samples: discs or spheres with radius, mass and place before time begins. What is random comes from the sample's seed.

pub(crate) mod deposit;
pub(crate) mod placed;
pub(crate) mod shapes;
pub(crate) mod sizes;
pub(crate) mod strips;

use crate::detect::Grain;
use crate::problem::rough::AnyFrozen;
use crate::sample::deposit::Placed;
use crate::sample::placed::placed;
use crate::sample::sizes::{Radii, Sizes, with_room};
use crate::sample::strips::{Strips, no_place};
use contact::{Place, is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How the grains of a scene are made: discs in the plane, or spheres in space.
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
    /// Discs with radii drawn from a range, laid one by one at the lowest place left where two others, or one
    /// and a wall, hold it: close to a packing at rest, which time then settles.
    Deposited {
        /// Number of discs.
        grains: u32,
        /// Seed of the radii.
        seed: u64,
        /// Least and greatest radius (m).
        radius_m: [f64; 2],
        /// How the radii are distributed between these two; without it evenly by number.
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
        /// How the radii are distributed between these two; without it evenly by number.
        #[serde(default)]
        sizes: Sizes,
        /// Mass per volume (kg/m³).
        density_kg_per_m3: f64,
    },
    /// Discs at the places of a CSV file, with the columns `x_m`, `y_m` and `radius_m`; others are ignored.
    Placed {
        /// The file, seen from the folder of the case.
        file: PathBuf,
        /// Mass per area (kg/m²).
        density_kg_per_m2: f64,
    },
    /// Spheres at the places of a CSV file, with the columns `x_m`, `y_m`, `z_m` and `radius_m`.
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

    /// Whether its grains are spheres; `folder` is that of the case.
    pub(crate) fn in_space(&self, folder: &Path) -> Result<bool, String> {
        Ok(match self {
            Self::Discs { .. }
            | Self::Column { .. }
            | Self::Triangular { .. }
            | Self::Zigzag { .. }
            | Self::Rollers { .. }
            | Self::Deposited { .. }
            | Self::Placed { .. } => false,
            Self::Spheres { .. }
            | Self::ColumnOfSpheres { .. }
            | Self::SimpleCubic { .. }
            | Self::FaceCentred { .. }
            | Self::DepositedSpheres { .. }
            | Self::PlacedSpheres { .. } => true,
            Self::Frozen { file } => frozen(&folder.join(file))?.in_space(),
        })
    }

    /// The grains, for a box of `width` and `depth` (m), if it has these walls; `folder` is that of the case.
    pub(crate) fn grains_in<P: Place>(
        &self,
        [width, depth]: [Option<f64>; 2],
        folder: &Path,
    ) -> Result<Vec<Grain<P>>, String> {
        self.check_size([width, depth])?;
        let walls = || width.ok_or("`sample.kind` asks for side walls: it needs `scene.box.width_m`");
        // [x, y, z, radius] of each (m), mass per area or volume (kg/m², kg/m³), and the mass of the last over what its size gives (–).
        let (placed, density, top_mass_ratio) = match *self {
            Self::Discs { ref discs, density_kg_per_m2 } => (in_plane(discs), density_kg_per_m2, 1.0),
            Self::Column { grains, radius_m, density_kg_per_m2: density, top_mass_ratio }
            | Self::ColumnOfSpheres { grains, radius_m, density_kg_per_m3: density, top_mass_ratio } => {
                (in_plane(&shapes::column(grains, radius_m)), density, top_mass_ratio)
            }
            Self::Triangular { columns, rows, radius_m, density_kg_per_m2, overlap } => {
                (in_plane(&shapes::triangular(columns, rows, radius_m, overlap)), density_kg_per_m2, 1.0)
            }
            Self::Zigzag { grains, radius_m, density_kg_per_m2 } => {
                (in_plane(&shapes::zigzag(grains, radius_m, walls()?)?), density_kg_per_m2, 1.0)
            }
            Self::Rollers { rollers, radius_m, top_radius_m, density_kg_per_m2, top_mass_ratio } => {
                let rollers = shapes::rollers(rollers, radius_m, top_radius_m)?;
                (in_plane(&rollers), density_kg_per_m2, top_mass_ratio)
            }
            Self::Deposited {
                grains,
                seed,
                radius_m,
                ref sizes,
                intruder_radius_m,
                width_m,
                density_kg_per_m2,
                ..
            } => {
                let deposited = if let Some(strips) = self.strips(width)? {
                    strips.whole()?
                } else {
                    let radii = Radii { sizes, range: radius_m, dimensions: 2 }.drawn(grains, seed)?;
                    let laid = match width_m {
                        Some(width) => ("sample.width_m", width),
                        None => ("scene.box.width_m", walls()?),
                    };
                    let radii = with_room(radii, radius_m[1], intruder_radius_m, &[laid])?;
                    deposit::deposit(&radii, laid.1).map_err(no_place)?
                };
                (self.lifted(&deposited), density_kg_per_m2, 1.0)
            }
            Self::Spheres { ref spheres, density_kg_per_m3 } => (spheres.clone(), density_kg_per_m3, 1.0),
            Self::SimpleCubic { counts, radius_m, density_kg_per_m3 } => {
                (shapes::simple_cubic(counts, radius_m), density_kg_per_m3, 1.0)
            }
            Self::FaceCentred { counts, radius_m, density_kg_per_m3 } => {
                (shapes::face_centred(counts, radius_m), density_kg_per_m3, 1.0)
            }
            Self::Placed { ref file, density_kg_per_m2 } => {
                (placed(&folder.join(file), false)?, density_kg_per_m2, 1.0)
            }
            Self::PlacedSpheres { ref file, density_kg_per_m3 } => {
                (placed(&folder.join(file), true)?, density_kg_per_m3, 1.0)
            }
            Self::DepositedSpheres { grains, seed, radius_m, ref sizes, density_kg_per_m3 } => {
                let behind = "`sample.kind` asks for walls behind and before: it needs `scene.box.depth_m`";
                let size = [walls()?, depth.ok_or(behind)?];
                let radii = Radii { sizes, range: radius_m, dimensions: 3 }.drawn(grains, seed)?;
                let room = [("scene.box.width_m", size[0]), ("scene.box.depth_m", size[1])];
                let radii = with_room(radii, radius_m[1], None, &room)?;
                (deposit::deposit_spheres(&radii, size, seed), density_kg_per_m3, 1.0)
            }
            Self::Frozen { ref file } => return checked(frozen(&folder.join(file))?.grains()),
        };
        let mut grains = homogeneous(&placed, density);
        grains.iter_mut().rev().take(1).for_each(|top| top.mass *= top_mass_ratio);
        checked(grains)
    }

    /// The strips that it is deposited in, if it is in some, for a box of `width` (m).
    pub(crate) fn strips(&self, width: Option<f64>) -> Result<Option<Strips<'_>>, String> {
        let Self::Deposited {
            grains,
            seed,
            radius_m,
            sizes,
            intruder_radius_m,
            width_m,
            strips: Some(count),
            ..
        } = self
        else {
            return Ok(None);
        };
        if *count == 0 {
            return Err("`sample.strips` is 0: it must be at least 1".to_owned());
        }
        for (key, value) in [("intruder_radius_m", intruder_radius_m), ("width_m", width_m)] {
            if let Some(value) = value {
                return Err(format!(
                    "`sample.{key}` is {}: with `sample.strips` it must be left out",
                    shown(*value)
                ));
            }
        }
        let width = width.ok_or("`sample.strips` asks for side walls: it needs `scene.box.width_m`")?;
        let radii = Radii { sizes, range: *radius_m, dimensions: 2 };
        let strips = Strips { radii, seed: *seed, grains: *grains, count: *count, width };
        strips.check()?;
        Ok(Some(strips))
    }

    /// Discs that were deposited, at their level, as [x, y, z, radius] (m).
    fn lifted(&self, deposited: &[Placed]) -> Vec<[f64; 4]> {
        let lift_m = if let Self::Deposited { lift_m, .. } = self { *lift_m } else { 0.0 };
        deposited.iter().map(|(x, radius)| [x.x, x.y + lift_m, 0.0, *radius]).collect()
    }

    /// The grains that some discs of its strips are.
    pub(crate) fn grains_of<P: Place>(&self, deposited: &[Placed]) -> Result<Vec<Grain<P>>, String> {
        let density =
            if let Self::Deposited { density_kg_per_m2, .. } = self { *density_kg_per_m2 } else { 0.0 };
        checked(homogeneous(&self.lifted(deposited), density))
    }
}

/// Grains at [x, y, z, radius] (m), of one mass per area or volume (kg/m², kg/m³).
fn homogeneous<P: Place>(placed: &[[f64; 4]], density: f64) -> Vec<Grain<P>> {
    let grain = |&[x, y, z, radius]: &[f64; 4]| {
        let of_disc = density * std::f64::consts::PI * radius * radius;
        let mass = if P::LEN > 2 { of_disc * radius * 4.0 / 3.0 } else { of_disc };
        Grain { radius, mass, position: P::of([x, y, z]) }
    };
    placed.iter().map(grain).collect()
}

impl Sample {
    /// Whether a crystal of spheres is between the walls of a box of this width and depth (m), up to round-off.
    fn check_size(&self, size: [Option<f64>; 2]) -> Result<(), String> {
        let (Self::SimpleCubic { counts: [columns, _, deep], radius_m, .. }
        | Self::FaceCentred { counts: [columns, _, deep], radius_m, .. }) = *self
        else {
            return Ok(());
        };
        for ((key, count), length) in [("width_m", columns), ("depth_m", deep)].into_iter().zip(size) {
            let needed = 2.0 * radius_m * f64::from(count);
            if let Some(length) = length.filter(|length| *length < needed * (1.0 - 1e-9)) {
                return Err(format!(
                    "`scene.box.{key}` is {}: {count} spheres of `sample.radius_m` {} side by side need {}",
                    shown(length),
                    shown(radius_m),
                    shown(needed)
                ));
            }
        }
        Ok(())
    }
}

fn in_plane(discs: &[[f64; 3]]) -> Vec<[f64; 4]> {
    discs.iter().map(|&[x, y, radius]| [x, y, 0.0, radius]).collect()
}

fn frozen(file: &Path) -> Result<AnyFrozen, String> {
    AnyFrozen::read(file).map_err(|error| format!("`sample.file`: {error}"))
}

/// The grains, if there are some and all have a meaning.
fn checked<P: Place>(grains: Vec<Grain<P>>) -> Result<Vec<Grain<P>>, String> {
    let valid = |grain: &&Grain<P>| {
        is_positive(grain.mass) && is_positive(grain.radius) && grain.position.is_finite()
    };
    match grains.iter().find(|grain| !valid(grain)) {
        Some(Grain { radius, mass, position }) => Err(format!(
            "`sample` has a grain of radius {} m and mass {} kg at {} m: radius and mass must be positive, all finite",
            shown(*radius),
            shown(*mass),
            position.text()
        )),
        None if grains.is_empty() => Err("`sample` has no grain".to_owned()),
        None => Ok(grains),
    }
}
