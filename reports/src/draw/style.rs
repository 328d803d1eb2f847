//! Sizes, colours, dashes and marks of all figures, in one place. Lengths are millimetres on paper, text is in points.

use crate::families::{Mark, RGBColor};
use crate::own;

/// Width of a column of a journal.
pub(crate) const COLUMN: f64 = 85.0;
/// Width of a journal's page.
const PAGE: f64 = 175.0;
/// Greatest height that leaves room for a caption below.
pub(crate) const PAGE_HEIGHT: f64 = 235.0;
/// Text, never smaller than 7 pt in print.
pub(crate) const TEXT: f64 = 7.5;
/// Numbers at ticks.
pub(crate) const TICK_TEXT: f64 = 7.0;
/// From a line of text to the next.
pub(crate) const LEADING: f64 = 3.9;
/// White at the edges of a figure.
pub(crate) const MARGIN: f64 = 1.5;

pub(crate) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(crate) const WHITE: RGBColor = RGBColor(255, 255, 255);
const GRID_GREY: RGBColor = RGBColor(222, 222, 222);
/// Signs of no method.
pub(crate) const INK: RGBColor = RGBColor(90, 90, 90);
const OUTLINE_GREY: RGBColor = RGBColor(140, 140, 140);
/// Fill of a grain without contact.
pub(crate) const IDLE: RGBColor = RGBColor(245, 245, 245);

/// Style of a line.
#[derive(Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) color: RGBColor,
    pub(crate) width: f64,
    /// Lengths drawn and left out in turn; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

impl Pen {
    pub(crate) const fn solid(color: RGBColor, width: f64) -> Self {
        Self { color, width, dash: &[] }
    }
}

pub(crate) const FRAME: Pen = Pen::solid(BLACK, 0.18);
pub(crate) const GRID: Pen = Pen::solid(GRID_GREY, 0.1);
pub(crate) const TOLERANCE: Pen = Pen { color: INK, width: 0.16, dash: &[1.2, 0.8] };
/// Outline of a grain with contacts in one subdomain, and of a boundary grain.
pub(crate) const GRAIN: Pen = Pen::solid(OUTLINE_GREY, 0.06);
pub(crate) const BOUNDARY_GRAIN: Pen = Pen::solid(BLACK, 0.24);
pub(crate) const WALL: Pen = Pen::solid(BLACK, 0.5);
/// Curves that are not told apart.
pub(crate) const OTHERS: Pen = Pen::solid(RGBColor(190, 190, 190), 0.18);
/// Under the curves that no other undercuts.
pub(crate) const PARETO: Pen = Pen::solid(RGBColor(255, 214, 150), 1.8);
/// Around the best cell of a map, on a line that shows on dark cells; and the derived directions.
pub(crate) const BEST: Pen = Pen::solid(BLACK, 0.35);
pub(crate) const HALO: Pen = Pen::solid(WHITE, 0.8);
pub(crate) const DERIVED: Pen = Pen::solid(RGBColor(190, 70, 0), 0.3);
/// Ground of a cell whose run failed, and its sign: of many, paler than what converged.
pub(crate) const FAILED_CELL: RGBColor = RGBColor(240, 240, 240);
pub(crate) const FAILED_SIGN: RGBColor = RGBColor(140, 140, 140);
pub(crate) const SCALE_BAR: Pen = Pen::solid(BLACK, 0.4);
/// Line of a contact, to be given a width in proportion to its impulse.
pub(crate) const CHAIN: RGBColor = RGBColor(45, 20, 20);

/// Signs of variants, where no other method is beside them.
pub(crate) const MARKS: [Mark; 8] =
    [Mark::Disc, Mark::Square, Mark::Diamond, Mark::Ring, Mark::Plus, Mark::Triangle, Mark::Cross, Mark::Bar];

/// Dashes of the variants of a method, in the order of their subdomains.
pub(crate) const DASHES: [&[f64]; 6] =
    [&[], &[2.6, 0.8], &[1.1, 0.7], &[2.6, 0.7, 0.5, 0.7], &[0.4, 0.5], &[2.6, 0.6, 0.4, 0.6, 0.4, 0.6]];

/// Fills of subdomains, soft enough for a dark line above. Two whose places differ by 1 to 4, or are the first and the last,
/// differ by 20 of 255 in grey, any others by 10: neighbours of a grid are told apart without colour.
pub(crate) const SUBDOMAINS: [RGBColor; 8] = [
    RGBColor(208, 238, 250),
    RGBColor(214, 142, 80),
    RGBColor(70, 140, 186),
    RGBColor(236, 195, 216),
    RGBColor(160, 210, 152),
    RGBColor(255, 241, 205),
    RGBColor(193, 150, 186),
    RGBColor(96, 156, 130),
];

/// The fill of a subdomain, its place in [`SUBDOMAINS`]: by its column and row in the grid of the partition alone, so that
/// it is the same at all moments of a study. Neighbours differ, in colour and in grey.
pub(crate) fn subdomain_fill(partition: &str, subdomain: u32) -> usize {
    let fills = SUBDOMAINS.len() as u32;
    let number = |text: &str| text.split(|c: char| !c.is_ascii_digit()).next()?.parse::<u32>().ok();
    let grid = partition.split_once('x').and_then(|(columns, rows)| Some((number(columns)?, number(rows)?)));
    let place = match grid {
        // A row further on lies as far off as eight fills allow.
        Some((columns, rows)) if columns > 0 && columns.saturating_mul(rows) > fills => {
            subdomain % columns + fills / 2 * (subdomain / columns)
        }
        _ => subdomain,
    };
    (place % fills) as usize
}

/// Returns the millimetres on paper of a millimetre of the layout (–), whose text has always the same size.
pub(crate) fn enlarged() -> f64 {
    own::style().text_pt.map_or(1.0, |size| size / TEXT)
}

/// Returns the width of a figure in the layout (mm).
pub(crate) fn page() -> f64 {
    own::style().width_mm.map_or(PAGE, |width| width / enlarged())
}

#[cfg(test)]
mod tests;
