//! A sheet to draw on in millimetres. It becomes an SVG of that size on paper.

use std::cell::RefCell;
use std::fmt::{self, Write};
use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, ScaleFont};

use crate::draw::{BLACK, Mark, Pen, RGBColor, WHITE, enlarged};
use crate::own;
use crate::read::Ending;

/// Coordinates are integers of a fiftieth of a millimetre.
const UNITS_PER_MM: f64 = 50.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// Height of a line of the font over its size (–): widths are measured by it.
const HEIGHT_PER_EM: f64 = 1.24;
/// Fonts of nearly the same widths, for a reader without the font that the layout is made with.
const FONTS: &str = "DejaVu Sans, Verdana, sans-serif";

/// The font whose widths a layout is made with, on any machine.
static FONT: LazyLock<FontRef> = LazyLock::new(|| {
    let bytes = include_bytes!("../../fonts/DejaVuSans.ttf");
    FontRef::try_from_slice(bytes).expect("the font that is part of this program is a font")
});

/// A place on the sheet (mm), from its upper left corner.
pub(crate) type Place = (f64, f64);

/// Side of a text that stands at its place.
#[derive(Clone, Copy)]
pub(crate) enum HPos {
    Left,
    Center,
    Right,
}

/// Height of a text that stands at its place.
#[derive(Clone, Copy)]
pub(crate) enum VPos {
    Top,
    Center,
    Bottom,
}

/// The elements drawn so far.
pub(crate) struct Canvas {
    svg: RefCell<String>,
}

/// Draws a sheet of `width` by `height` mm on a white ground.
pub(crate) fn svg((width, height): (f64, f64), draw: impl FnOnce(&Canvas)) -> String {
    let (columns, rows) = (units(width), units(height));
    let [width, height] = [width, height].map(|length| length * enlarged());
    let canvas = Canvas { svg: RefCell::default() };
    canvas.add(format_args!(
        "<svg width=\"{width}mm\" height=\"{height}mm\" stroke-linejoin=\"round\" viewBox=\"0 0 {columns} {rows}\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<rect x=\"0\" y=\"0\" width=\"{columns}\" height=\"{rows}\" \
         fill=\"{WHITE}\" stroke=\"none\"/>"
    ));
    draw(&canvas);
    canvas.svg.into_inner() + "</svg>\n"
}

/// A text with the index of each κ_l or κ_d set as one.
fn lowered(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let text = text.replace('"', "&quot;").replace('\'', "&apos;");
    let mut pieces = text.split("κ_");
    let mut lowered = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (index, rest) = piece.split_at(piece.chars().next().map_or(0, char::len_utf8));
        // Down by three tenths of the smaller letter, and up again.
        lowered.extend([r#"κ<tspan font-size="70%" dy="0.3em">"#, index, r#"</tspan><tspan dy="-0.21em">"#]);
        lowered.extend([rest, "</tspan>"]);
    }
    lowered
}

/// Width of a text (mm).
pub(crate) fn text_width(text: &str, size_pt: f64) -> f64 {
    let font =
        own::font().map_or(&*FONT, |(font, ..)| font).as_scaled((font_size(size_pt) * HEIGHT_PER_EM) as f32);
    let mut width = 0.0;
    let mut before = None;
    for glyph in text.chars().map(|letter| font.glyph_id(letter)) {
        width += font.h_advance(glyph);
        width += before.map_or(0.0, |before| font.kern(before, glyph));
        before = Some(glyph);
    }
    f64::from(width as i32) / UNITS_PER_MM
}

impl Canvas {
    fn add(&self, element: fmt::Arguments) {
        writeln!(self.svg.borrow_mut(), "{element}").expect("a text takes what is written to it");
    }

    pub(crate) fn line(&self, places: &[Place], pen: Pen) {
        if places.is_empty() {
            return;
        }
        let (stroke, points) = (stroke(Some(pen)), points(places));
        self.add(format_args!("<polyline fill=\"none\" {stroke} points=\"{points}\"/>"));
    }

    pub(crate) fn polygon(&self, corners: &[Place], fill: RGBColor, pen: Option<Pen>) {
        let (stroke, points) = (stroke(pen), points(corners));
        self.add(format_args!("<polygon fill=\"{fill}\" {stroke} points=\"{points}\"/>"));
    }

    pub(crate) fn disc(&self, centre: Place, radius: f64, fill: RGBColor, pen: Option<Pen>) {
        let (x, y, r) = (units(centre.0), units(centre.1), units(radius).max(1));
        let stroke = stroke(pen);
        self.add(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\" {stroke}/>"));
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
        (side, height): (HPos, VPos),
    ) {
        let side = match side {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        // Half the height of a digit in the middle, which every renderer knows; few agree on `ex`.
        let height = match height {
            VPos::Top => "0.76em",
            VPos::Center => "0.36em",
            VPos::Bottom => "-0.5ex",
        };
        self.add(format_args!(
            "<text x=\"{}\" y=\"{}\" dy=\"{height}\" text-anchor=\"{side}\" font-family=\"{}\" \
             font-size=\"{}\" fill=\"{color}\">\n{}\n</text>",
            units(place.0),
            units(place.1),
            own::font().map_or(FONTS, |(.., family)| family),
            font_size(size_pt),
            lowered(text)
        ));
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
            Mark::Bar => stroke(1.7 * HALF, UPRIGHT),
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
            Ending::Failed | Ending::Given => {
                for ends in [ACROSS, UPRIGHT] {
                    stroke(HALF, ends);
                }
            }
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

/// Places as an element has them, each but once in a row.
fn points(places: &[Place]) -> String {
    let mut places: Vec<(i32, i32)> = places.iter().map(|&(x, y)| (units(x), units(y))).collect();
    places.dedup();
    places.into_iter().fold(String::new(), |mut text, (x, y)| {
        let _ = write!(text, "{x},{y} ");
        text
    })
}

/// Size of a font of so many points, in units.
fn font_size(size_pt: f64) -> f64 {
    size_pt * MM_PER_PT * UNITS_PER_MM
}

/// Attributes of what a pen draws; without one nothing is.
fn stroke(pen: Option<Pen>) -> String {
    let Some(Pen { color, width, dash }) = pen else { return "stroke=\"none\"".to_owned() };
    let dash: Vec<String> = dash.iter().map(|length| units(*length).to_string()).collect();
    let dash =
        if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", dash.join(" ")) };
    format!("stroke=\"{color}\" stroke-width=\"{}\"{dash}", units(width).max(1))
}

#[cfg(test)]
mod tests;
