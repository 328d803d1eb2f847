//! The key of the discs: boundary grains, and grains without contact. Subdomains have their names in the scene.

use crate::draw::{
    BOUNDARY_GRAIN, Canvas, GRAIN, HPos, IDLE, LEADING, Pen, Place, RGBColor, TEXT, VPos, WHITE, text_width,
};
use crate::read::Scene;

/// Radius of a disc of the key, space to its text, and to the next disc (mm).
const RADIUS: f64 = 1.3;
const GAP: f64 = 0.8;
const NEXT: f64 = 3.0;

/// Fill, outline and meaning of a disc.
type Entry = (RGBColor, Pen, &'static str);

pub(crate) struct Key {
    entries: Vec<Entry>,
}

impl Key {
    /// What the scene has of discs that need a word.
    pub(crate) fn of(scene: &Scene) -> Self {
        let boundary = scene.grains.iter().any(|grain| grain.multiplicity > 1);
        let idle = scene.grains.iter().any(|grain| grain.subdomain.is_none());
        let entries = [
            boundary.then_some((WHITE, BOUNDARY_GRAIN, "boundary grain")),
            idle.then_some((IDLE, GRAIN, "no contact")),
        ];
        Self { entries: entries.into_iter().flatten().collect() }
    }

    /// Height of its line (mm).
    pub(crate) fn height(&self) -> f64 {
        if self.entries.is_empty() { 0.0 } else { LEADING }
    }

    pub(crate) fn draw(&self, canvas: &Canvas, (left, top): Place) {
        let (mut x, y) = (left, top + LEADING / 2.0);
        for (fill, outline, text) in &self.entries {
            canvas.disc((x + RADIUS, y), RADIUS, *fill, Some(*outline));
            x += 2.0 * RADIUS + GAP;
            canvas.text(text, (x, y), TEXT, (HPos::Left, VPos::Center));
            x += text_width(text, TEXT) + NEXT;
        }
    }
}
