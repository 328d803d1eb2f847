//! A row of panels of one size, with lines of text above and a legend below.

use crate::draw::{
    Axis, Canvas, Frame, HPos, LEADING, Legend, MARGIN, PAGE_HEIGHT, Scale, TEXT, VPos, enlarged, page, svg,
};
use crate::own;
use crate::read::{RunRow, counted};

/// Left of a panel for the labels of its ticks, and right of it (mm).
const LEFT: f64 = 10.5;
const RIGHT: f64 = 3.0;
/// Above a panel for the name of its measure, and below it for the labels and the name of its axis (mm).
const ABOVE: f64 = LEADING + 1.8;
const BELOW: f64 = 10.0;
/// Height of a panel, at most its width, and the least of several rows (mm).
const HEIGHT: f64 = 66.0;
const LEAST: f64 = 32.0;

/// Room of a panel on paper (mm).
#[derive(Clone, Copy)]
pub(crate) struct Room {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
    pub(crate) top: f64,
}

impl Room {
    /// The frame of two axes, each with its scale, its range and its name; it is drawn, and what comes next lies above.
    pub(crate) fn frame(self, canvas: &Canvas, x: Span, y: Span) -> Frame {
        let axis = |span: &Span, from, to| Axis { scale: span.0, ..Axis::log(span.1, from, to) };
        let frame = Frame { x: axis(&x, self.left, self.right), y: axis(&y, self.bottom, self.top) };
        frame.draw(canvas);
        frame.name(canvas, x.2, y.2);
        frame
    }
}

/// The scale of an axis, its range and its name.
type Span<'s> = (Scale, (f64, f64), &'s str);

/// Returns the width inside the margins, for legends (mm).
pub(crate) fn inside_width() -> f64 {
    page() - 2.0 * MARGIN
}

/// Height of each of several rows of panels that fill a page (mm).
fn high(rows: usize, taken: f64) -> f64 {
    (PAGE_HEIGHT - 2.0 * MARGIN - taken) / rows as f64 - ABOVE - BELOW
}

/// Reports whether a page has room for so many rows of panels, above a legend of this height (mm), and a line of text for each.
pub(crate) fn fits_a_page(rows: usize, legend: f64) -> bool {
    high(rows, legend + LEADING * rows as f64) >= LEAST
}

/// Draws panels in columns and rows, row by row, with a title and a legend.
pub(crate) fn grid(
    title: &[String],
    (columns, rows): (usize, usize),
    legend: &Legend,
    panel: impl Fn(&Canvas, usize, Room),
) -> String {
    let title = own::title(title);
    let pitch = inside_width() / columns as f64;
    let wide = pitch - LEFT - RIGHT;
    let taken = LEADING * title.len() as f64;
    let high = own::style().panel_height_mm.map_or_else(
        || match rows {
            1 => HEIGHT.min(wide),
            rows => HEIGHT.min(wide).min(high(rows, taken + legend.height()).max(LEAST)),
        },
        |high| high / enlarged(),
    );
    let first = MARGIN + taken + ABOVE;
    let bottom = first + rows as f64 * (high + BELOW + ABOVE) - BELOW - ABOVE;
    svg((page(), (bottom + BELOW + legend.height() + MARGIN).ceil()), |canvas| {
        for (i, line) in title.iter().enumerate() {
            let place = (MARGIN, MARGIN + LEADING * i as f64);
            canvas.text(line, place, TEXT, (HPos::Left, VPos::Top));
        }
        for i in 0..columns * rows {
            let left = MARGIN + pitch * (i % columns) as f64 + LEFT;
            let top = first + (i / columns) as f64 * (high + BELOW + ABOVE);
            panel(canvas, i, Room { left, right: left + wide, bottom: top + high, top });
        }
        legend.draw(canvas, (MARGIN, bottom + BELOW));
    })
}

/// More lines than this are not told apart by anyone, and take a page of legend.
pub(crate) const MOST_LINES: usize = 120;

/// The problem, its size, and how many runs there are on it.
pub(crate) fn title(problem: &str, runs: &[&RunRow]) -> String {
    let size = runs.first().map_or_else(String::new, |run| {
        let contacts = counted(run.contacts as usize, "contact");
        // Where there is W alone, there are none.
        let grains = if run.grains == 0 && run.contacts > 0 {
            "W of ".to_owned()
        } else {
            counted(run.grains as usize, "grain") + ", "
        };
        format!(": {grains}{contacts}")
    });
    format!("{problem}{size}, {}", counted(runs.len(), "run"))
}
