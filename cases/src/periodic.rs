//! Periodic sides: what leaves the box at one side comes in at the other, and grains touch through the boundary.

use crate::walls::Walls;
use contact::{Place, shown};

/// The width after which a scene repeats itself along x (m), if it does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Period(pub(crate) Option<f64>);

/// The least width of a periodic box, in greatest radii: a grain then meets at most one image of another, as far as contacts are
/// sought at the greatest speed that is not an explosion.
const LEAST_WIDTH: f64 = 12.0;

impl Period {
    /// Of the differences between the images of two places the least.
    #[inline]
    pub(crate) fn nearest<P: Place>(self, between: P) -> P {
        self.0.map_or(between, |width| between - P::of([width * (between[0] / width).round(), 0.0, 0.0]))
    }

    /// The image of a place that is in the box, from 0 to its width.
    pub(crate) fn wrapped<P: Place>(self, place: P) -> P {
        self.0.map_or(place, |width| {
            let wrapped = place - P::of([width * (place[0] / width).floor(), 0.0, 0.0]);
            // A hair left of 0 rounds to the width itself.
            if wrapped[0] < width { wrapped } else { wrapped - P::of([width, 0.0, 0.0]) }
        })
    }

    /// Whether the box is wide enough for grains of this greatest radius (m).
    pub(crate) fn check(self, greatest_radius: f64) -> Result<(), String> {
        match self.0 {
            Some(width) if width < LEAST_WIDTH * greatest_radius => Err(format!(
                "`scene.box.width_m` is {}: a periodic box must be at least {LEAST_WIDTH} greatest radii wide, here {}",
                shown(width),
                shown(LEAST_WIDTH * greatest_radius)
            )),
            _ => Ok(()),
        }
    }
}

impl Walls {
    /// What does not go with periodic sides, or without them.
    pub(crate) fn check_periodic(&self) -> Result<(), String> {
        if !self.periodic {
            return match self.lid {
                Some(_) => Err("`scene.box.lid` asks for `scene.box.periodic` = true".to_owned()),
                None => Ok(()),
            };
        }
        let Some(width) = self.width_m else {
            return Err("`scene.box.periodic` is true: it needs `scene.box.width_m`".to_owned());
        };
        let of_sides = [
            ("tilt_rate_rad_per_s", self.tilt_rate_rad_per_s),
            ("closing_speed_m_per_s", self.closing_speed_m_per_s),
        ];
        if let Some((key, value)) = of_sides.iter().find(|(_, value)| *value != 0.0) {
            return Err(format!(
                "`scene.box.{key}` is {}: periodic sides are no walls, so it must be 0",
                shown(*value)
            ));
        }
        if let Some(bumps) = self.bump_radius_m {
            let count = width / (2.0 * bumps);
            if (count - count.round()).abs() > 1e-9 * count {
                return Err(format!(
                    "`scene.box.bump_radius_m` is {}: the width of a periodic box, {}, must be a multiple of twice that",
                    shown(bumps),
                    shown(width)
                ));
            }
        }
        self.lid.map_or(Ok(()), |lid| lid.check())
    }
}
