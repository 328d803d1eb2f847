//! A matrix of classes: hazards down, methods or settings across, one cell per problem of a hazard.

use super::Judged;
use super::class::Class;
use super::hazard::Hazard;
use crate::draw::{
    Canvas, FRAME, HPos, INK, LEADING, MARGIN, PAGE, Pen, Place, Sign, Signs, TEXT, TICK_TEXT, VPos, WHITE,
    ring, svg, text_width, wedge,
};

/// Height of a hazard, and what of it the cells leave free (mm).
const ROW: f64 = 7.0;
const FREE: f64 = 0.7;
/// Greatest width of a column (mm).
const WIDEST: f64 = 16.0;
const THIN: Pen = Pen::solid(WHITE, 0.12);

/// A column, by a short head and, where that is a number, what it stands for.
pub(super) struct Column {
    pub(super) head: String,
    pub(super) entry: Option<String>,
}

pub(super) struct Grid<'g, 'r> {
    pub(super) title: String,
    pub(super) notes: Vec<String>,
    pub(super) columns: Vec<Column>,
    pub(super) hazards: &'g [Hazard],
    /// Cell of a problem and a column.
    pub(super) cell: &'g dyn Fn(usize, &str) -> Option<Cell<'g, 'r>>,
}

/// A run, and whether another setting mends it.
type Cell<'g, 'r> = (&'g Judged<'r>, bool);

/// Position and size of the cells (mm).
struct Layout {
    left: f64,
    top: f64,
    column: f64,
}

impl Grid<'_, '_> {
    pub(super) fn draw(&self) -> String {
        let inside = PAGE - 2.0 * MARGIN;
        let room = (inside - self.label_width()) / self.columns.len().max(1) as f64;
        let longest = self.columns.iter().filter_map(|c| c.entry.as_deref());
        let longest = longest.map(|entry| text_width(entry, TICK_TEXT) + 2.0).fold(0.0, f64::max);
        // Numbers stand for words where these do not fit above their columns.
        let in_words = longest <= room;
        let keys = Signs::new(self.entries(!in_words), inside);
        let head = |column: &Column| match &column.entry {
            Some(entry) if in_words => vec![entry.clone()],
            _ => lines(&column.head).into_iter().map(str::to_owned).collect(),
        };
        let heads: Vec<Vec<String>> = self.columns.iter().map(head).collect();
        let rows: usize = heads.iter().map(Vec::len).max().unwrap_or(0);
        let layout = Layout {
            left: MARGIN + self.label_width(),
            top: MARGIN + 1.5 * LEADING + LEADING * rows as f64,
            column: 0.0,
        };
        let widest = if in_words { longest.max(WIDEST) } else { WIDEST };
        let layout = Layout { column: room.min(widest), ..layout };
        let bottom = layout.top + ROW * self.hazards.len() as f64;
        svg((PAGE, bottom + 1.5 + keys.height() + MARGIN), |canvas| {
            canvas.text(&self.title, (MARGIN, MARGIN + 0.5 * LEADING), TEXT, (HPos::Left, VPos::Center));
            for (i, words) in heads.iter().enumerate() {
                for (n, word) in words.iter().enumerate() {
                    let y = layout.top - LEADING * (words.len() - n) as f64 + 0.3 * LEADING;
                    let x = layout.left + layout.column * (i as f64 + 0.5);
                    canvas.text(word, (x, y), TICK_TEXT, (HPos::Center, VPos::Center));
                }
            }
            for (row, hazard) in self.hazards.iter().enumerate() {
                self.row(canvas, &layout, layout.top + ROW * row as f64, hazard);
            }
            keys.draw(canvas, (MARGIN, bottom + 1.5));
        })
    }

    fn label_width(&self) -> f64 {
        let of = |h: &Hazard| text_width(&h.name, TEXT).max(text_width(&h.knob, TICK_TEXT));
        let width = self.hazards.iter().map(of).fold(0.0, f64::max);
        // Beyond a third of the page, labels would leave no room for what they label.
        (width + 2.0).min(PAGE / 3.0)
    }

    fn row(&self, canvas: &Canvas, layout: &Layout, top: f64, hazard: &Hazard) {
        let knob = if hazard.knob.is_empty() { 0.5 } else { 0.28 };
        let right = layout.left + layout.column * self.columns.len() as f64;
        canvas.line(&[(MARGIN, top), (right, top)], Pen { width: 0.08, ..FRAME });
        canvas.text(&hazard.name, (MARGIN, top + knob * ROW), TEXT, (HPos::Left, VPos::Center));
        canvas.text_in(INK, &hazard.knob, (MARGIN, top + 0.72 * ROW), TICK_TEXT, (HPos::Left, VPos::Center));
        for i in 0..self.columns.len() {
            let width = (layout.column - FREE) / hazard.problems.len() as f64;
            for (k, problem) in hazard.problems.iter().enumerate() {
                let left = layout.left + layout.column * i as f64 + 0.5 * FREE + width * k as f64;
                if let Some((judged, cured)) = (self.cell)(i, problem) {
                    cell(
                        canvas,
                        judged,
                        cured,
                        ((left, top + 0.5 * FREE), (left + width, top + ROW - 0.5 * FREE)),
                    );
                }
            }
        }
    }

    /// The key: classes that occur, the marks, the columns if they are numbered.
    fn entries(&self, numbered: bool) -> Vec<(Sign, String)> {
        let problems = || self.hazards.iter().flat_map(|hazard| &hazard.problems);
        let cells: Vec<_> = (0..self.columns.len())
            .flat_map(|i| problems().filter_map(move |problem| (self.cell)(i, problem)))
            .collect();
        let mut entries: Vec<(Sign, String)> = Class::ALL
            .into_iter()
            .filter(|(class, ..)| cells.iter().any(|(judged, _)| judged.class == *class))
            .map(|(_, text, cell)| (Sign::Cell(cell), text.to_owned()))
            .collect();
        if cells.iter().any(|(_, cured)| *cured) {
            entries.push((Sign::Ring, "another setting of the method mends it".to_owned()));
        }
        if cells.iter().any(|(judged, _)| judged.zeta_lies) {
            entries.push((Sign::Wedge, "ζ met the tolerance far from the solution".to_owned()));
        }
        entries.extend(self.notes.iter().map(|note| (Sign::Word, note.clone())));
        if numbered {
            let entry = |c: &Column| Some((Sign::Word, format!("{} {}", c.head, c.entry.as_ref()?)));
            entries.extend(self.columns.iter().filter_map(entry));
        }
        entries
    }
}

/// A head on several lines: `interior-` and `point`.
fn lines(head: &str) -> Vec<&str> {
    head.split_inclusive('-').collect()
}

fn cell(canvas: &Canvas, judged: &Judged, cured: bool, (from, to): (Place, Place)) {
    judged.class.cell().draw(canvas, from, to, THIN);
    let middle = f64::midpoint(from.0, to.0);
    if cured {
        ring(canvas, (middle, from.1 + 0.8));
    }
    if judged.zeta_lies {
        wedge(canvas, (middle, to.1 - 0.8));
    }
}
