//! The key of the signs in a figure, in lines below it.

use std::collections::BTreeSet;

use crate::draw::{
    BLACK, Canvas, FRAME, HPos, INK, LEADING, Mark, Pen, Place, RGBColor, TEXT, TICK_TEXT, VPos, WHITE,
    text_width,
};
use crate::read::Ending;

/// Room of a sign, of the sample of a line, and between entries (mm).
const SIGN: f64 = 2.6;
const SAMPLE: f64 = 8.0;
const NEXT: f64 = 4.0;

/// What an entry explains.
pub(crate) enum Sign {
    /// Text alone.
    Word,
    Ending(Ending),
    Line(Pen),
    Mark(Mark, Pen),
    /// A cell of an atlas: its ground, its letter, the colour of that; and its marks.
    Cell(RGBColor, &'static str, RGBColor),
    Ring,
    Wedge,
}

impl Sign {
    fn width(&self) -> f64 {
        match self {
            Self::Word => 0.0,
            Self::Line(_) => SAMPLE + 1.2,
            Self::Ending(_) | Self::Mark(..) | Self::Ring | Self::Wedge => SIGN,
            Self::Cell(..) => SIGN + 1.4,
        }
    }

    fn draw(&self, canvas: &Canvas, (x, y): Place) {
        match self {
            Self::Word => {}
            Self::Ending(ending) => canvas.ending(*ending, (x + 0.9, y), INK),
            Self::Line(pen) => canvas.line(&[(x, y), (x + SAMPLE, y)], *pen),
            Self::Mark(mark, pen) => canvas.mark(*mark, (x + 0.9, y), *pen),
            Self::Cell(fill, letter, ink) => swatch(canvas, (*fill, letter, *ink), (x + 1.4, y)),
            Self::Ring => ring(canvas, (x + 0.9, y)),
            Self::Wedge => wedge(canvas, (x + 0.9, y)),
        }
    }
}

/// An entry for each way in which some of the runs ended.
pub(crate) fn endings(runs: impl IntoIterator<Item = Ending>) -> Vec<(Sign, String)> {
    let seen: BTreeSet<Ending> = runs.into_iter().collect();
    seen.into_iter().map(|ending| (Sign::Ending(ending), ending.text().to_owned())).collect()
}

/// Entries, each with its place from the upper left corner of the key.
pub(crate) struct Signs {
    entries: Vec<(Place, Sign, String)>,
    lines: usize,
}

impl Signs {
    /// Lays entries out in lines of a width (mm).
    pub(crate) fn new(entries: Vec<(Sign, String)>, width: f64) -> Self {
        let (mut x, mut line) = (0.0, 0);
        let mut placed = Vec::new();
        for (sign, text) in entries {
            let length = sign.width() + text_width(&text, TEXT);
            if x > 0.0 && x + length > width {
                (x, line) = (0.0, line + 1);
            }
            placed.push(((x, LEADING * (line as f64 + 0.5)), sign, text));
            x += length + NEXT;
        }
        let lines = if placed.is_empty() { 0 } else { line + 1 };
        Self { entries: placed, lines }
    }

    /// Height (mm).
    pub(crate) fn height(&self) -> f64 {
        LEADING * self.lines as f64
    }

    pub(crate) fn draw(&self, canvas: &Canvas, (left, top): Place) {
        for ((x, y), sign, text) in &self.entries {
            let (x, y) = (left + x, top + y);
            sign.draw(canvas, (x, y));
            canvas.text(text, (x + sign.width(), y), TEXT, (HPos::Left, VPos::Center));
        }
    }
}

/// The mark of a failure that another setting mends.
pub(crate) fn ring(canvas: &Canvas, place: Place) {
    canvas.disc(place, 0.5, WHITE, Some(Pen::solid(BLACK, 0.2)));
}

/// The mark of a ζ that promised too much.
pub(crate) fn wedge(canvas: &Canvas, (x, y): Place) {
    let corners = [(x - 0.6, y + 0.5), (x, y - 0.5), (x + 0.6, y + 0.5)];
    canvas.polygon(&corners, BLACK, Some(Pen::solid(WHITE, 0.12)));
}

/// A swatch with its letter, as in a cell.
fn swatch(canvas: &Canvas, (fill, letter, ink): (RGBColor, &str, RGBColor), (x, y): Place) {
    let (low, high) = (y - 1.5, y + 1.5);
    canvas.polygon(
        &[(x - 1.4, low), (x + 1.4, low), (x + 1.4, high), (x - 1.4, high)],
        fill,
        Some(Pen { width: 0.08, ..FRAME }),
    );
    canvas.text_in(ink, letter, (x, y), TICK_TEXT, (HPos::Center, VPos::Center));
}
