//! Periodic sides: what leaves the box at one side comes in at the other, and grains touch through the boundary.

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
