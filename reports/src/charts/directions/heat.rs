//! Iterations over (κ_l, κ_d) as maps, one per μ and group, on pages with one scale of colours.

use super::field::{Cell, Field};
use crate::draw::{
    Axis, BEST, COLUMN, Canvas, ColorScale, DERIVED, FAILED_CELL, FAILED_SIGN, Frame, HALO, HPos, LEADING,
    MARGIN, Mark, PAGE_HEIGHT, Pen, Place, RGBColor, Sign, Signs, TEXT, TICK_TEXT, Ticks, VPos, endings,
    page, rectangle, svg, text_width,
};
use crate::own;
use crate::read::{Ending, count, counted, rising, span};

/// Left of the panels for labels, right of them for the scale of colours, between them (mm).
const LEFT: f64 = 13.0;
const RIGHT: f64 = 15.0;
const GAP: f64 = 2.5;
/// Above a panel for its title and what the derived directions cost, and below it for labels (mm).
const ABOVE: f64 = 2.0 * LEADING + 0.6;
const BELOW: f64 = 5.5;
/// Bounds of the side of a panel (mm).
const LEAST: f64 = 21.0;
const GREATEST: f64 = 52.0;
/// A line of text above all, and the name of the x axis below (mm).
const HEAD: f64 = 1.5 * LEADING;
const FOOT: f64 = LEADING + 1.0;
/// A cell at least so wide and high has its number in it (mm).
const ROOMY: (f64, f64) = (8.5, 6.0);

/// The maps of a problem on as many pages as they need.
pub(crate) fn pages(problem: &str, fields: &[&Field]) -> Vec<String> {
    if fields.is_empty() {
        return Vec::new();
    }
    let page = Page::of(problem, fields);
    let chunks = fields.chunks(page.columns * page.rows).enumerate();
    chunks.map(|(number, fields)| page.draw(fields, number)).collect()
}

/// Layout shared by the pages of a problem.
struct Page {
    width: f64,
    columns: usize,
    rows: usize,
    side: f64,
    head: String,
    /// Ranges of log κ_l and log κ_d.
    kappa_l: (f64, f64),
    kappa_d: (f64, f64),
    scale: Option<ColorScale>,
    signs: Signs,
}

impl Page {
    fn of(problem: &str, fields: &[&Field]) -> Self {
        let mut least = LEAST;
        for line in fields.iter().flat_map(|field| [title(field), cost(field)]) {
            least = least.max(text_width(&line, TICK_TEXT) + 0.5);
        }
        let room = |width: f64| width - 2.0 * MARGIN - LEFT - RIGHT + GAP;
        let first_row = fields.iter().take_while(|field| field.relaxation == fields[0].relaxation).count();
        let columns = first_row.clamp(1, ((room(page()) / (least + GAP)) as usize).max(1));
        let side = (room(page()) / columns as f64 - GAP).min(GREATEST);
        let head = head(problem, fields);
        let panels = page() - room(page()) + columns as f64 * (side + GAP);
        let width = COLUMN.max(panels).max(text_width(&head, TEXT) + 2.0 * MARGIN);
        let signs = Signs::new(signs(fields), width - 2.0 * MARGIN);
        let free = PAGE_HEIGHT - 2.0 * MARGIN - HEAD - FOOT - signs.height();
        let iterations = || fields.iter().flat_map(|f| &f.cells).filter_map(converged);
        Self {
            width,
            columns,
            rows: ((free / (ABOVE + side + BELOW)) as usize).max(1),
            side,
            head,
            kappa_l: range(fields, |cell| cell.kappa_l, |kappa| kappa.0),
            kappa_d: range(fields, |cell| cell.kappa_d, |kappa| kappa.1),
            scale: ColorScale::of(iterations()),
            signs,
        }
    }

    fn draw(&self, fields: &[&Field], number: usize) -> String {
        let rows = fields.len().div_ceil(self.columns);
        let panels = rows as f64 * (ABOVE + self.side + BELOW);
        let below = MARGIN + HEAD + panels + FOOT;
        svg((self.width, (below + self.signs.height() + MARGIN).ceil()), |canvas| {
            let more = if number > 0 { " (continued)" } else { "" };
            let title = format!("{}{more}", self.head);
            if let Some(title) = own::title(&[title]).first() {
                canvas.text(title, (MARGIN, MARGIN), TEXT, (HPos::Left, VPos::Top));
            }
            for (i, field) in fields.iter().enumerate() {
                // The last panel of a column has the labels of its κ_l.
                self.panel(
                    canvas,
                    field,
                    (i / self.columns, i % self.columns),
                    i + self.columns >= fields.len(),
                );
            }
            let columns = fields.len().min(self.columns) as f64;
            let middle = MARGIN + LEFT + (columns * (self.side + GAP) - GAP) / 2.0;
            canvas.text("κ_l, at contacts (–)", (middle, below - FOOT), TEXT, (HPos::Center, VPos::Top));
            if let Some(scale) = &self.scale {
                let left = MARGIN + LEFT + columns * (self.side + GAP) + 0.5;
                let top = MARGIN + HEAD + ABOVE;
                scale.draw(
                    canvas,
                    "iterations",
                    (left, top),
                    self.side.max(30.0).min(panels - ABOVE - BELOW),
                );
            }
            self.signs.draw(canvas, (MARGIN, below));
        })
    }

    fn panel(&self, canvas: &Canvas, field: &Field, (row, column): (usize, usize), last: bool) {
        let left = MARGIN + LEFT + column as f64 * (self.side + GAP);
        let top = MARGIN + HEAD + row as f64 * (ABOVE + self.side + BELOW) + ABOVE;
        let frame = Frame {
            x: Axis::log(self.kappa_l, left, left + self.side),
            y: Axis::log(self.kappa_d, top + self.side, top),
        };
        for (i, line) in [title(field), cost(field)].into_iter().enumerate() {
            let place = (left, top - ABOVE + LEADING * i as f64);
            canvas.text(&line, place, TICK_TEXT, (HPos::Left, VPos::Top));
        }
        self.cells(canvas, &frame, field);
        frame.draw_border(canvas, Ticks::Outside);
        if last {
            frame.label_x(canvas, Ticks::Outside);
        }
        if column == 0 {
            frame.label_y(canvas, Ticks::Outside);
            let middle = (MARGIN, frame.middle().1);
            for (line, text) in ["κ_d", "(–)"].into_iter().enumerate() {
                let place = (middle.0, middle.1 + LEADING * (line as f64 - 0.5));
                canvas.text(text, place, TEXT, (HPos::Left, VPos::Center));
            }
        }
        if let Some((l, d)) = field.kappa {
            canvas.mark(Mark::Diamond, frame.place((l.log10(), d.log10())), DERIVED);
        }
    }

    fn cells(&self, canvas: &Canvas, frame: &Frame, field: &Field) {
        let edges_l = edges(field.cells.iter().map(|cell| cell.kappa_l));
        let edges_d = edges(field.cells.iter().map(|cell| cell.kappa_d));
        let corners = |cell: &Cell| {
            let (l, d) = (around(&edges_l, cell.kappa_l), around(&edges_d, cell.kappa_d));
            (frame.place((l.0, d.1)), frame.place((l.1, d.0)))
        };
        for cell in &field.cells {
            self.cell(canvas, cell, corners(cell));
        }
        if let Some(best) = field.best() {
            let ((x0, y0), (x1, y1)) = corners(best);
            let around = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)];
            canvas.line(&around, HALO);
            canvas.line(&around, BEST);
        }
    }

    fn cell(&self, canvas: &Canvas, cell: &Cell, ((x0, y0), (x1, y1)): (Place, Place)) {
        let corners = rectangle((x0, y0), (x1, y1));
        let Some((iterations, scale)) = converged(cell).zip(self.scale.as_ref()) else {
            canvas.polygon(&corners, FAILED_CELL, Some(seam(FAILED_CELL)));
            return canvas.ending(
                cell.run.status,
                (f64::midpoint(x0, x1), f64::midpoint(y0, y1)),
                FAILED_SIGN,
            );
        };
        let fill = scale.color(iterations);
        canvas.polygon(&corners, fill, Some(seam(fill)));
        if x1 - x0 >= ROOMY.0 && y1 - y0 >= ROOMY.1 {
            let place = (f64::midpoint(x0, x1), y1 - 0.7);
            let text = count(cell.run.iterations as usize);
            canvas.text_in(ColorScale::ink_on(fill), &text, place, TICK_TEXT, (HPos::Center, VPos::Bottom));
        }
    }
}

/// Which panel it is.
fn title(field: &Field) -> String {
    let group = if field.group.is_empty() {
        counted(field.subdomains as usize, "subdomain")
    } else {
        field.group.clone()
    };
    format!("{group}, relaxation {}", field.relaxation)
}

/// Cost of the derived and of the adapted directions.
fn cost(field: &Field) -> String {
    let times = |word, run: Option<_>| {
        let ratio = field.ratio(Some(run?)).map_or("failed".to_owned(), |ratio| format!("×{ratio:.2}"));
        Some(format!("{word} {ratio}"))
    };
    let words = [times("derived", field.derived), times("adapted", field.adaptive)];
    words.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Returns the title: the content of the figure.
fn head(problem: &str, fields: &[&Field]) -> String {
    let rule = fields[0].cells.first().and_then(|cell| cell.run.rule());
    let stop = rule.map_or(String::new(), |rule| format!(" to {rule}"));
    let runs = counted(fields.iter().map(|f| f.cells.len()).sum(), "run");
    format!("{problem}, {}: iterations{stop}, over the search directions, {runs}", fields[0].method)
}

/// The key.
fn signs(fields: &[&Field]) -> Vec<(Sign, String)> {
    let mut signs = Vec::new();
    if fields.iter().any(|f| f.best().is_some()) {
        signs.push((Sign::Mark(Mark::Square, BEST), "best on the grid".to_owned()));
    }
    if fields.iter().any(|f| f.kappa.is_some()) {
        let text = "derived directions, between the cells; ×: iterations over those of the best on the grid"
            .to_owned();
        signs.push((Sign::Mark(Mark::Diamond, DERIVED), text));
    }
    if fields.iter().any(|f| f.adaptive.is_some()) {
        let text = "adapted: begun with the derived directions; it has no cell of its own".to_owned();
        signs.push((Sign::Word, text));
    }
    let cells = fields.iter().flat_map(|f| &f.cells).map(|cell| cell.run.status);
    signs.extend(endings(cells.filter(|ending| *ending != Ending::Converged)));
    signs
}

/// Covers the hairline that renderers leave between two cells.
fn seam(color: RGBColor) -> Pen {
    Pen::solid(color, 0.06)
}

fn converged(cell: &Cell) -> Option<f64> {
    (cell.run.has_converged()).then(|| cell.run.iterations.max(1) as f64)
}

/// Edges between the values on a logarithmic axis, half a step beyond the first and the last; with each its value.
fn edges(values: impl Iterator<Item = f64>) -> Vec<(f64, (f64, f64))> {
    const ALONE: f64 = 0.25;
    let values = rising(values);
    let logs: Vec<f64> = values.iter().map(|value| value.log10()).collect();
    let half = |i: usize| logs.get(i + 1).map(|next| (next - logs[i]) / 2.0);
    let around = |i: usize| {
        let before = i.checked_sub(1).and_then(half);
        let (low, high) = (before.or(half(i)).unwrap_or(ALONE), half(i).or(before).unwrap_or(ALONE));
        (values[i], (logs[i] - low, logs[i] + high))
    };
    (0..values.len()).map(around).collect()
}

fn around(edges: &[(f64, (f64, f64))], value: f64) -> (f64, f64) {
    edges.iter().find(|(of, _)| *of == value).map_or((0.0, 0.0), |(_, around)| *around)
}

/// Range of the logarithms of the cells with their edges, and of the derived directions.
fn range(fields: &[&Field], of: fn(&Cell) -> f64, derived: fn((f64, f64)) -> f64) -> (f64, f64) {
    const ROOM: f64 = 0.15;
    let cells = edges(fields.iter().flat_map(|f| &f.cells).map(of)).into_iter();
    let cells = cells.flat_map(|(_, (low, high))| [low, high]);
    let derived = fields.iter().filter_map(|f| f.kappa).map(|kappa| derived(kappa).log10());
    span(cells.chain(derived.flat_map(|log| [log - ROOM, log + ROOM]))).unwrap_or_default()
}

#[cfg(test)]
mod tests;
