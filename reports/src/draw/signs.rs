//! The key of the signs in a figure, in lines below it.

use std::collections::BTreeSet;

use crate::draw::{
    Canvas, FRAME, HPos, INK, LEADING, Mark, Pen, Place, RGBColor, TEXT, TICK_TEXT, VPos, rectangle,
    text_width,
};
use crate::read::{Ending, ending_text};

/// Room of a sign, of the sample of a line, and between entries (mm).
const SIGN: f64 = 2.6;
const SAMPLE: f64 = 8.0;
const NEXT: f64 = 4.0;

/// Sign that an entry explains.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    /// Text alone.
    Word,
    Ending(Ending),
    Line(Pen),
    Mark(Mark, Pen),
    /// A cell of an atlas, and its marks.
    Cell(Cell),
    /// A grain: its fill and outline.
    Grain(RGBColor, Pen),
}

impl Sign {
    fn width(&self) -> f64 {
        match self {
            Self::Word => 0.0,
            Self::Line(_) => SAMPLE + 1.2,
            Self::Ending(_) | Self::Mark(..) => SIGN,
            Self::Cell(_) | Self::Grain(..) => SIGN + 1.4,
        }
    }

    pub(crate) fn draw(&self, canvas: &Canvas, (x, y): Place) {
        match self {
            Self::Word => {}
            Self::Ending(ending) => canvas.ending(*ending, (x + 0.9, y), INK),
            Self::Line(pen) => canvas.line(&[(x, y), (x + SAMPLE, y)], *pen),
            Self::Mark(mark, pen) => canvas.mark(*mark, (x + 0.9, y), *pen),
            Self::Cell(cell) => {
                cell.draw(canvas, (x, y - 1.5), (x + 2.8, y + 1.5), Pen { width: 0.08, ..FRAME });
            }
            Self::Grain(fill, outline) => canvas.disc((x + 1.3, y), 1.3, *fill, Some(*outline)),
        }
    }
}

/// An entry for each way in which some of the runs ended.
pub(crate) fn endings(runs: impl IntoIterator<Item = Ending>) -> Vec<(Sign, String)> {
    let seen: BTreeSet<Ending> = runs.into_iter().collect();
    seen.into_iter().map(|ending| (Sign::Ending(ending), ending_text(ending))).collect()
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

/// A cell of a grid.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub(crate) fill: RGBColor,
    pub(crate) letter: &'static str,
    pub(crate) ink: RGBColor,
}

impl Cell {
    /// Between two corners; with its letter where there is room.
    pub(crate) fn draw(self, canvas: &Canvas, from: Place, to: Place, outline: Pen) {
        /// Room of a letter (mm).
        const LETTER: f64 = 1.7;
        canvas.polygon(&rectangle(from, to), self.fill, Some(outline));
        if to.0 - from.0 >= LETTER {
            let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
            canvas.text_in(self.ink, self.letter, middle, TICK_TEXT, (HPos::Center, VPos::Center));
        }
    }
}
