//! A grid of cells: tiles for what each row and each column have in common.

use crate::draw::{
    BLACK, Canvas, Cell, FRAME, HPos, INK, LEADING, MARGIN, Mark, Pen, Place, Sign, Signs, TEXT, TICK_TEXT,
    VPos, WHITE, page, svg, text_width,
};
use crate::own;

/// Gaps between tiles: share of the height of a row (–), and part of the width of a column (mm).
const FREE: f64 = 0.1;
const APART: f64 = 0.7;
/// Part of the width of a tile that is left free (–).
const BETWEEN: f64 = 0.06;
const THIN: Pen = Pen::solid(WHITE, 0.12);
/// Marks in the upper and the lower half of a tile.
const MARKS: [Sign; 2] =
    [Sign::Mark(Mark::Ring, Pen::solid(BLACK, 0.2)), Sign::Mark(Mark::Triangle, Pen::solid(BLACK, 0.2))];

/// A head, and what it stands for where that is a number.
pub(super) struct Head {
    pub(super) short: String,
    pub(super) long: Option<String>,
}

/// Cells side by side, and whether they have each of the marks.
pub(super) struct Tile {
    pub(super) cells: Vec<Cell>,
    pub(super) marks: [bool; 2],
}

pub(super) struct Grid<'g> {
    pub(super) title: String,
    pub(super) notes: Vec<String>,
    /// Names of the rows, and what varies in them.
    pub(super) rows: Vec<(&'g str, &'g str)>,
    /// Height of a row (mm).
    pub(super) height: f64,
    /// Greatest width of a column (mm).
    pub(super) widest: f64,
    pub(super) columns: Vec<Head>,
    /// Meaning of each cell, of which the key names those that occur, and of the marks.
    pub(super) cells: Vec<(Cell, String)>,
    pub(super) marks: [&'g str; 2],
    /// Tiles of a row and a column.
    pub(super) tiles: &'g dyn Fn(usize, usize) -> Vec<Option<Tile>>,
}

impl<'g> Grid<'g> {
    pub(super) fn svg(&'g self) -> String {
        let inside = page() - 2.0 * MARGIN;
        let left = MARGIN + self.label_width();
        let room = (page() - MARGIN - left) / self.columns.len().max(1) as f64;
        let longest = self.columns.iter().filter_map(|head| head.long.as_deref());
        let longest = longest.map(|long| text_width(long, TICK_TEXT) + 2.0).fold(0.0, f64::max);
        // Numbers stand for words where these do not fit above their columns.
        let in_words = longest <= room;
        let keys = Signs::new(self.entries(!in_words), inside);
        let head = |head: &'g Head| match &head.long {
            Some(long) if in_words => vec![long.as_str()],
            _ => head.short.split_inclusive('-').collect(),
        };
        let heads: Vec<Vec<&str>> = self.columns.iter().map(head).collect();
        let lines = heads.iter().map(Vec::len).max().unwrap_or(0);
        let top = MARGIN + 1.5 * LEADING + LEADING * lines as f64;
        let wide = room.min(if in_words { longest.max(self.widest) } else { self.widest });
        let bottom = top + self.height * self.rows.len() as f64;
        svg((page(), bottom + 1.5 + keys.height() + MARGIN), |canvas| {
            if let Some(title) = own::title(std::slice::from_ref(&self.title)).first() {
                canvas.text(title, (MARGIN, MARGIN + 0.5 * LEADING), TEXT, (HPos::Left, VPos::Center));
            }
            for (i, words) in heads.iter().enumerate() {
                for (n, word) in words.iter().enumerate() {
                    let y = top - LEADING * (words.len() - n) as f64 + 0.3 * LEADING;
                    let x = left + wide * (i as f64 + 0.5);
                    canvas.text(word, (x, y), TICK_TEXT, (HPos::Center, VPos::Center));
                }
            }
            for i in 0..self.rows.len() {
                self.draw_row(canvas, i, (left, top + self.height * i as f64), wide);
            }
            keys.draw(canvas, (MARGIN, bottom + 1.5));
        })
    }

    fn label_width(&self) -> f64 {
        let of = |(name, setting): &(&str, &str)| text_width(name, TEXT).max(text_width(setting, TICK_TEXT));
        let width = self.rows.iter().map(of).fold(0.0, f64::max);
        // Beyond a third of the page, labels would leave no room for what they label.
        (width + 2.0).min(page() / 3.0)
    }

    fn draw_row(&self, canvas: &Canvas, i: usize, (left, top): Place, wide: f64) {
        let ((name, setting), height) = (self.rows[i], self.height);
        let middle = if setting.is_empty() { 0.5 } else { 0.28 };
        let right = left + wide * self.columns.len() as f64;
        canvas.line(&[(MARGIN, top), (right, top)], Pen { width: 0.08, ..FRAME });
        canvas.text(name, (MARGIN, top + middle * height), TEXT, (HPos::Left, VPos::Center));
        canvas.text_in(INK, setting, (MARGIN, top + 0.72 * height), TICK_TEXT, (HPos::Left, VPos::Center));
        for column in 0..self.columns.len() {
            let tiles = (self.tiles)(i, column);
            let width = (wide - APART) / tiles.len().max(1) as f64;
            for (k, tile) in tiles.into_iter().enumerate() {
                let left = left + wide * column as f64 + 0.5 * APART + width * k as f64;
                let corners = (top + 0.5 * FREE * height, top + (1.0 - 0.5 * FREE) * height);
                if let Some(tile) = tile {
                    tile.draw(canvas, (left, corners.0), (left + width, corners.1));
                }
            }
        }
    }

    /// The key: cells and marks that occur, the columns if they are numbered.
    fn entries(&self, numbered: bool) -> Vec<(Sign, String)> {
        let places = (0..self.rows.len()).flat_map(|i| (0..self.columns.len()).map(move |k| (i, k)));
        let tiles: Vec<Tile> = places.flat_map(|(i, k)| (self.tiles)(i, k)).flatten().collect();
        let cells = self.cells.iter().filter(|(cell, _)| tiles.iter().any(|tile| tile.cells.contains(cell)));
        let mut entries: Vec<(Sign, String)> =
            cells.map(|(cell, meaning)| (Sign::Cell(*cell), meaning.clone())).collect();
        let marks = (0..2).filter(|mark| tiles.iter().any(|tile| tile.marks[*mark]));
        entries.extend(marks.map(|mark| (MARKS[mark], self.marks[mark].to_owned())));
        entries.extend(self.notes.iter().map(|note| (Sign::Word, note.clone())));
        if numbered {
            let entry = |head: &Head| Some((Sign::Word, format!("{} {}", head.short, head.long.as_ref()?)));
            entries.extend(self.columns.iter().filter_map(entry));
        }
        entries
    }
}

impl Tile {
    fn draw(self, canvas: &Canvas, from: Place, to: Place) {
        let width = (1.0 - BETWEEN) * (to.0 - from.0) / self.cells.len() as f64;
        for (k, cell) in self.cells.into_iter().enumerate() {
            let left = from.0 + width * k as f64;
            cell.draw(canvas, (left, from.1), (left + width, to.1), THIN);
        }
        let middle = f64::midpoint(from.0, to.0);
        for ((has, mark), y) in self.marks.into_iter().zip(MARKS).zip([from.1 + 0.8, to.1 - 0.8]) {
            if has {
                mark.draw(canvas, (middle - 0.9, y));
            }
        }
    }
}
