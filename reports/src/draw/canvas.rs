//! A sheet to draw on in millimetres. It becomes an SVG of that size on paper.
//!
//! What the drawing library leaves to be done by hand is done here and nowhere else: its coordinates are integers, hence fine
//! units; its SVG has a size in pixels, one font and `ex`, hence a few replacements in the text. A backend of our own would
//! have to write every element itself to save them.

use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, RGBColor, ShapeStyle, TextStyle, register_font,
};

use crate::draw::{BLACK, Mark, Pen, WHITE};
use crate::read::Ending;

/// The drawing library rounds to integers, so its unit is a fiftieth of a millimetre.
const UNITS_PER_MM: f64 = 50.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The drawing library writes a font's size divided by this.
const SIZE_PER_EM: f64 = 1.24;
/// Fonts of nearly the same widths, for a reader without the font that the layout is made with.
const FONTS: &str = "DejaVu Sans, Verdana, sans-serif";

/// A place on the sheet (mm), from its upper left corner.
pub(crate) type Place = (f64, f64);

pub(crate) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Draws a sheet of `width` by `height` mm on a white ground.
pub(crate) fn svg((width, height): (f64, f64), draw: impl FnOnce(&Canvas)) -> String {
    use_own_font();
    let (columns, rows) = (units(width) as u32, units(height) as u32);
    let mut text = String::new();
    let canvas = Canvas { area: SVGBackend::with_string(&mut text, (columns, rows)).into_drawing_area() };
    drawn(canvas.area.fill(&WHITE));
    draw(&canvas);
    drawn(canvas.area.present());
    drop(canvas);
    let size = |width: &str, height: &str| format!(r#"width="{width}" height="{height}""#);
    let text: String = text.split_inclusive('\n').map(lowered).collect();
    text.replacen(
        &size(&columns.to_string(), &rows.to_string()),
        &format!("{} stroke-linejoin=\"round\"", size(&format!("{width}mm"), &format!("{height}mm"))),
        1,
    )
    .replace(r#"font-family="sans-serif""#, &format!(r#"font-family="{FONTS}""#))
    // Half the height of a digit, which every renderer knows; few agree on `ex`.
    .replace(r#"dy="0.5ex""#, r#"dy="0.36em""#)
    .replace(r#" opacity="1""#, "")
}

/// A line of SVG with the index of each κ_l or κ_d set as one.
fn lowered(line: &str) -> String {
    let mut pieces = line.split("κ_");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (index, rest) = piece.split_at(piece.chars().next().map_or(0, char::len_utf8));
        // Down by three tenths of the smaller letter, and up again.
        text.extend([r#"κ<tspan font-size="70%" dy="0.3em">"#, index, r#"</tspan><tspan dy="-0.21em">"#]);
        text.extend([rest.trim_end_matches('\n'), "</tspan>", if rest.ends_with('\n') { "\n" } else { "" }]);
    }
    text
}

/// Width of a text (mm).
pub(crate) fn text_width(text: &str, size_pt: f64) -> f64 {
    use_own_font();
    f64::from(drawn(font(size_pt).box_size(text)).0) / UNITS_PER_MM
}

impl Canvas<'_> {
    pub(crate) fn line(&self, places: &[Place], pen: Pen) {
        let style = ShapeStyle::from(&pen.color).stroke_width(units(pen.width).max(1) as u32);
        for piece in dashes(places, pen.dash) {
            drawn(self.area.draw(&PathElement::new(rounded(&piece), style)));
        }
    }

    pub(crate) fn polygon(&self, corners: &[Place], fill: RGBColor, pen: Option<Pen>) {
        drawn(self.area.draw(&Polygon::new(rounded(corners), fill.filled())));
        let closed: Vec<Place> = corners.iter().chain(corners.first()).copied().collect();
        if let Some(pen) = pen {
            self.line(&closed, pen);
        }
    }

    pub(crate) fn disc(&self, centre: Place, radius: f64, fill: RGBColor, pen: Option<Pen>) {
        let (centre, radius) = ((units(centre.0), units(centre.1)), units(radius).max(1));
        drawn(self.area.draw(&Circle::new(centre, radius, fill.filled())));
        let Some(pen) = pen else { return };
        let style = ShapeStyle::from(&pen.color).stroke_width(units(pen.width).max(1) as u32);
        drawn(self.area.draw(&Circle::new(centre, radius, style)));
    }

    pub(crate) fn text(&self, text: &str, place: Place, size_pt: f64, anchor: (HPos, VPos)) {
        self.text_in(BLACK, text, place, size_pt, anchor);
    }

    pub(crate) fn text_in(
        &self,
        color: RGBColor,
        text: &str,
        place: Place,
        size_pt: f64,
        anchor: (HPos, VPos),
    ) {
        let style = TextStyle::from(font(size_pt)).pos(Pos::new(anchor.0, anchor.1)).color(&color);
        drawn(self.area.draw_text(text, &style, (units(place.0), units(place.1))));
    }

    /// A sign on a line, white inside.
    pub(crate) fn mark(&self, mark: Mark, place: Place, pen: Pen) {
        const HALF: f64 = 0.6;
        let pen = Pen { width: pen.width.min(0.3), dash: &[], ..pen };
        let closed =
            |half: f64, corners: &[Place]| self.polygon(&around(place, half, corners), WHITE, Some(pen));
        let stroke = |half: f64, ends: [Place; 2]| self.line(&around(place, half, &ends), pen);
        match mark {
            Mark::None => {}
            Mark::Disc => self.disc(place, 0.7, pen.color, Some(Pen::solid(WHITE, 0.1))),
            Mark::Square => closed(0.9 * HALF, &SQUARE),
            Mark::Diamond => closed(1.3 * HALF, &[(-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)]),
            Mark::Plus => [ACROSS, UPRIGHT].into_iter().for_each(|ends| stroke(HALF, ends)),
            Mark::Ring => self.disc(place, HALF, WHITE, Some(pen)),
            Mark::Triangle => closed(1.1 * HALF, &[(-1.0, 1.0), (0.0, -1.0), (1.0, 1.0)]),
            Mark::Cross => [FALLING, RISING].into_iter().for_each(|ends| stroke(0.8 * HALF, ends)),
            Mark::Bar => stroke(HALF, UPRIGHT),
        }
    }

    /// The sign of how a run ended, of a shape of its own.
    pub(crate) fn ending(&self, ending: Ending, place: Place, color: RGBColor) {
        const HALF: f64 = 0.85;
        let pen = Pen::solid(color, 0.3);
        let closed = |corners: &[Place]| self.polygon(&around(place, HALF, corners), WHITE, Some(pen));
        let stroke =
            |half: f64, ends: [Place; 2]| self.line(&around(place, half, &ends), Pen::solid(color, 0.45));
        match ending {
            Ending::Converged => self.mark(Mark::Disc, place, pen),
            Ending::IterationLimit => closed(&[(-0.7, -1.0), (1.0, 0.0), (-0.7, 1.0)]),
            Ending::Stalled => closed(&SQUARE),
            Ending::Diverged => [FALLING, RISING].into_iter().for_each(|ends| stroke(HALF, ends)),
            Ending::Infeasible => {
                self.disc(place, HALF, WHITE, Some(pen));
                stroke(0.7 * HALF, RISING);
            }
            Ending::FalseConvergence => self.disc(place, 0.7, WHITE, Some(pen)),
            Ending::Skipped => stroke(HALF, ACROSS),
            Ending::Failed => [ACROSS, UPRIGHT].into_iter().for_each(|ends| stroke(HALF, ends)),
        }
    }
}

const SQUARE: [Place; 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
const ACROSS: [Place; 2] = [(-1.0, 0.0), (1.0, 0.0)];
const UPRIGHT: [Place; 2] = [(0.0, -1.0), (0.0, 1.0)];
const FALLING: [Place; 2] = [(-1.0, -1.0), (1.0, 1.0)];
const RISING: [Place; 2] = [(-1.0, 1.0), (1.0, -1.0)];

/// The corners of a shape of this half width.
fn around((x, y): Place, half: f64, corners: &[Place]) -> Vec<Place> {
    corners.iter().map(|(dx, dy)| (x + half * dx, y + half * dy)).collect()
}

/// The corners of a rectangle.
pub(crate) fn rectangle((x0, y0): Place, (x1, y1): Place) -> [Place; 4] {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
}

fn units(mm: f64) -> i32 {
    (mm * UNITS_PER_MM).round() as i32
}

fn rounded(places: &[Place]) -> Vec<(i32, i32)> {
    let mut places: Vec<(i32, i32)> = places.iter().map(|&(x, y)| (units(x), units(y))).collect();
    places.dedup();
    places
}

fn font(size_pt: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, size_pt * MM_PER_PT * UNITS_PER_MM * SIZE_PER_EM, FontStyle::Normal)
}

/// Layout needs the widths of a font on machines that have none.
fn use_own_font() {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let bytes = include_bytes!("../../fonts/DejaVuSans.ttf");
    let register = || register_font("sans-serif", FontStyle::Normal, bytes).is_ok();
    assert!(*REGISTERED.get_or_init(register), "the font that is part of this program is a font");
}

/// Unwraps the result of a drawing: in memory, with a font that is there, no file, device or size can refuse it.
fn drawn<T, E: std::fmt::Debug>(result: Result<T, E>) -> T {
    result.expect("drawing in memory does not fail")
}

/// The drawn pieces of a line under a pattern of lengths drawn and left out.
fn dashes(places: &[Place], pattern: &[f64]) -> Vec<Vec<Place>> {
    let Some(&first) = places.first() else { return Vec::new() };
    if pattern.is_empty() {
        return vec![places.to_vec()];
    }
    let (mut pieces, mut piece) = (Vec::new(), vec![first]);
    let (mut index, mut left) = (0, pattern[0]);
    for ends in places.windows(2) {
        let (mut from, to) = (ends[0], ends[1]);
        let mut length = (to.0 - from.0).hypot(to.1 - from.1);
        while length > left {
            let t = left / length;
            from = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
            length -= left;
            if index % 2 == 0 {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
        left -= length;
        if index % 2 == 0 {
            piece.push(to);
        }
    }
    if piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests;
