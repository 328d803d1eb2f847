//! From metres to paper: the scale of a scene and the width of its chains.

use results::schema::GrainRow;

use super::THINNEST_CHAIN;
use crate::draw::{
    CHAIN, COLUMN, Canvas, HPos, MARGIN, Pen, Place, SCALE_BAR, TEXT, VPos, WALL, page, text_width,
};
use crate::read::{Scene, impulse, number, round_down};

/// A scene that is more than so many times as wide as high takes the width of a page.
const WIDE: f64 = 2.0;
/// Greatest height of the scene on paper (mm).
const HIGHEST: f64 = 110.0;
/// A chain is at most so wide (mm), and at most this part of the median radius.
const WIDEST_CHAIN: f64 = 1.2;
const CHAIN_PER_RADIUS: f64 = 0.9;
/// Greatest length of the bar that shows the scale (mm).
const LONGEST_BAR: f64 = 30.0;
/// Length of the key of the impulses (mm).
const KEY: f64 = 7.0;

pub(crate) struct View {
    /// Width of the sheet and height of the scene on it (mm).
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Millimetres on paper per metre.
    pub(crate) scale: f64,
    /// Width of the chain of the greatest impulse (mm), and that impulse (N·s); 0 if none is known.
    pub(crate) widest: f64,
    pub(crate) greatest: f64,
    /// Upper left corner of the scene (m), and of its image (mm).
    corner: (f64, f64),
    image: Place,
    /// The longer side of the scene (m).
    side: f64,
}

impl View {
    /// Fits the discs, with equal scales in both directions.
    pub(crate) fn of(scene: &Scene) -> Self {
        let (mut low, mut high) = ((f64::INFINITY, f64::INFINITY), (f64::NEG_INFINITY, f64::NEG_INFINITY));
        for &GrainRow { x_m: x, y_m: y, radius_m: radius, .. } in &scene.grains {
            low = (low.0.min(x - radius), low.1.min(y - radius));
            high = (high.0.max(x + radius), high.1.max(y + radius));
        }
        let (span, rise) = (high.0 - low.0, high.1 - low.1);
        let drawable = span.is_finite() && rise.is_finite() && span > 0.0 && rise > 0.0;
        let (span, rise, corner) =
            if drawable { (span, rise, (low.0, high.1)) } else { (1.0, 0.2, (0.0, 0.2)) };
        let width = if span > WIDE * rise { page() } else { COLUMN };
        let inside = width - 2.0 * (MARGIN + WALL.width);
        let scale = (inside / span).min(HIGHEST / rise);
        let image = ((width - scale * span) / 2.0, MARGIN + WALL.width);
        let known = scene.contacts.iter().filter_map(impulse).filter(|r| r.is_finite());
        let greatest = known.fold(0.0, f64::max);
        let widest = (CHAIN_PER_RADIUS * scale * median_radius(scene)).clamp(THINNEST_CHAIN, WIDEST_CHAIN);
        Self {
            width,
            height: scale * rise + 2.0 * WALL.width,
            scale,
            widest,
            greatest,
            corner,
            image,
            side: span.max(rise),
        }
    }

    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Place {
        (self.image.0 + self.scale * (x - self.corner.0), self.image.1 + self.scale * (self.corner.1 - y))
    }

    /// Width of the line of an impulse (mm).
    pub(crate) fn chain_width(&self, impulse: f64) -> f64 {
        if self.greatest > 0.0 { self.widest * (impulse / self.greatest).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// A length on the left, the greatest impulse on the right.
    pub(crate) fn draw_scales(&self, canvas: &Canvas, y: f64) {
        const CAP: f64 = 0.8;
        let length = round_down((self.side / 4.0).min(LONGEST_BAR / self.scale));
        let (left, right) = (MARGIN, MARGIN + self.scale * length);
        let bracket =
            [(left, y - CAP), (left, y + CAP), (left, y), (right, y), (right, y - CAP), (right, y + CAP)];
        canvas.line(&bracket, SCALE_BAR);
        canvas.text(&format!("{length} m"), (right + 1.5, y), TEXT, (HPos::Left, VPos::Center));
        if self.greatest > 0.0 {
            let text = format!("{} N·s", number(self.greatest, 2));
            let end = self.width - MARGIN;
            canvas.text(&text, (end, y), TEXT, (HPos::Right, VPos::Center));
            let key = end - text_width(&text, TEXT) - 1.5;
            canvas.line(&[(key - KEY, y), (key, y)], Pen::solid(CHAIN, self.widest));
        }
    }
}

fn median_radius(scene: &Scene) -> f64 {
    let mut radii: Vec<f64> = scene.grains.iter().map(|grain| grain.radius_m).collect();
    radii.sort_by(f64::total_cmp);
    radii.get(radii.len() / 2).copied().unwrap_or(0.0)
}
