//! The grains that a sample describes, made for a box.

use super::Sample;
use crate::detect::Grain;
use crate::problem::any::AnyFrozen;
use crate::sample::deposit::{self, Disc};
use crate::sample::placed::{Placed, placed};
use crate::sample::shapes;
use crate::sample::sizes::{Radii, with_room};
use crate::sample::strips::{Strips, no_place};
use contact::{Place, is_positive, shown};
use std::path::Path;

/// Centre [x, y, z] and radius of a grain (m).
type Ball = [f64; 4];

impl Sample {
    /// Reports whether the grains are spheres; `folder` is that of the case.
    pub(crate) fn in_space(&self, folder: &Path) -> Result<bool, String> {
        match self {
            Self::Frozen { file } => Ok(frozen(&folder.join(file))?.in_space()),
            _ => Ok(self.density().is_some_and(|(_, in_space)| in_space)),
        }
    }

    /// The grains, for a box of `width` and `depth` (m), if it has these walls; `folder` is that of the case.
    pub(crate) fn grains_in<P: Place>(
        &self,
        [width, depth]: [Option<f64>; 2],
        folder: &Path,
    ) -> Result<Vec<Grain<P>>, String> {
        let walls = || width.ok_or("`sample.kind` asks for side walls: it needs `scene.box.width_m`");
        let balls = match *self {
            Self::Discs { ref discs, .. } => discs.iter().map(|&[x, y, r]| [x, y, 0.0, r]).collect(),
            Self::Spheres { ref spheres, .. } => spheres.clone(),
            Self::Column { grains, radius_m, .. } | Self::ColumnOfSpheres { grains, radius_m, .. } => {
                shapes::column(grains, radius_m)
            }
            Self::Triangular { columns, rows, radius_m, overlap, .. } => {
                shapes::triangular(columns, rows, radius_m, overlap)
            }
            Self::Zigzag { grains, radius_m, .. } => shapes::zigzag(grains, radius_m, walls()?)?,
            Self::Rollers { rollers, radius_m, top_radius_m, .. } => {
                shapes::rollers(rollers, radius_m, top_radius_m)?
            }
            Self::SimpleCubic { counts, radius_m, .. } => {
                shapes::check_room(counts, radius_m, [width, depth])?;
                shapes::simple_cubic(counts, radius_m)
            }
            Self::FaceCentred { counts, radius_m, .. } => {
                shapes::check_room(counts, radius_m, [width, depth])?;
                shapes::face_centred(counts, radius_m)
            }
            Self::Deposited { grains, seed, radius_m, ref sizes, intruder_radius_m, width_m, .. } => {
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
                self.lifted(&deposited)
            }
            Self::DepositedSpheres {
                grains, seed, radius_m, ref sizes, width_m, depth_m, lift_m, ..
            } => {
                let behind = "`sample.kind` asks for walls behind and before: it needs `scene.box.depth_m`";
                let own = |key, size: Option<f64>| size.map(|size| (key, size));
                let width = own("sample.width_m", width_m);
                let width = width.map_or_else(|| Ok::<_, String>(("scene.box.width_m", walls()?)), Ok)?;
                let of_box = || Ok::<_, String>(("scene.box.depth_m", depth.ok_or(behind)?));
                let depth = own("sample.depth_m", depth_m).map_or_else(of_box, Ok)?;
                let radii = Radii { sizes, range: radius_m, dimensions: 3 }.drawn(grains, seed)?;
                let radii = with_room(radii, radius_m[1], None, &[width, depth])?;
                let mut spheres = deposit::deposit_spheres(&radii, [width.1, depth.1], seed);
                for sphere in &mut spheres {
                    sphere[1] += lift_m;
                }
                spheres
            }
            Self::Placed { ref file, .. } => return self.placed(&folder.join(file), false),
            Self::PlacedSpheres { ref file, .. } => return self.placed(&folder.join(file), true),
            Self::Frozen { ref file } => return checked(frozen(&folder.join(file))?.grains()),
        };
        self.grains_at(&balls)
    }

    /// The grains of a CSV file.
    fn placed<P: Place>(&self, file: &Path, in_space: bool) -> Result<Vec<Grain<P>>, String> {
        let density = self.density().map_or(0.0, |(density, _)| density);
        let placed = placed(file, in_space)?;
        let balls: Vec<Ball> = placed.iter().map(|grain| grain.ball).collect();
        let mut grains = self.grains_at(&balls)?;
        for (grain, Placed { density: own, motion, .. }) in grains.iter_mut().zip(placed) {
            grain.motion = motion;
            if let Some(own) = own {
                grain.mass *= own / density;
            }
        }
        Ok(grains)
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

    /// Discs that were deposited, at their level.
    fn lifted(&self, deposited: &[Disc]) -> Vec<Ball> {
        let lift_m = if let Self::Deposited { lift_m, .. } = self { *lift_m } else { 0.0 };
        deposited.iter().map(|(x, radius)| [x.x, x.y + lift_m, 0.0, *radius]).collect()
    }

    /// The grains that some discs of its strips are.
    pub(crate) fn grains_of<P: Place>(&self, deposited: &[Disc]) -> Result<Vec<Grain<P>>, String> {
        self.grains_at(&self.lifted(deposited))
    }

    /// Its grains at some places; the last may have another mass than its size gives.
    fn grains_at<P: Place>(&self, balls: &[Ball]) -> Result<Vec<Grain<P>>, String> {
        let density = self.density().map_or(0.0, |(density, _)| density);
        let grain = |&[x, y, z, radius]: &Ball| {
            let mass = mass_of(density, radius, P::LEN > 2);
            Grain { radius, mass, position: P::of([x, y, z]), motion: [0.0; 6] }
        };
        let mut grains: Vec<_> = balls.iter().map(grain).collect();
        if let (
            Self::Column { top_mass_ratio, .. }
            | Self::ColumnOfSpheres { top_mass_ratio, .. }
            | Self::Rollers { top_mass_ratio, .. },
            Some(top),
        ) = (self, grains.last_mut())
        {
            top.mass *= top_mass_ratio;
        }
        checked(grains)
    }
}

fn frozen(file: &Path) -> Result<AnyFrozen, String> {
    AnyFrozen::read(file).map_err(|error| format!("`sample.file`: {error}"))
}

/// Returns the mass of a disc of some density (kg/m²) and radius (m), or of a sphere (kg/m³), in kg.
pub(crate) fn mass_of(density: f64, radius: f64, in_space: bool) -> f64 {
    let of_disc = density * std::f64::consts::PI * radius * radius;
    if in_space { of_disc * radius * 4.0 / 3.0 } else { of_disc }
}

/// The grains, if there are some and all have a meaning.
fn checked<P: Place>(grains: Vec<Grain<P>>) -> Result<Vec<Grain<P>>, String> {
    let valid = |grain: &&Grain<P>| {
        is_positive(grain.mass) && is_positive(grain.radius) && grain.position.is_finite()
    };
    match grains.iter().find(|grain| !valid(grain)) {
        Some(Grain { radius, mass, position, .. }) => Err(format!(
            "`sample` has a grain of radius {} m and mass {} kg at {} m: radius and mass must be positive, all finite",
            shown(*radius),
            shown(*mass),
            position.text()
        )),
        None if grains.is_empty() => Err("`sample` has no grain".to_owned()),
        None => Ok(grains),
    }
}
