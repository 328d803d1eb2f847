//! Sizes, colours, dashes and marks of all figures, in one place. Lengths are millimetres on paper, text is in points.

use std::fmt;

/// A colour: red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RGBColor(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl fmt::Display for RGBColor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

/// Width of a column of a journal.
pub(crate) const COLUMN: f64 = 85.0;
/// Width of a journal's page.
pub(crate) const PAGE: f64 = 175.0;
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

/// A small sign on a line: tells methods apart without colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mark {
    None,
    Disc,
    Square,
    Diamond,
    Plus,
    Bar,
    Cross,
    Ring,
    Triangle,
}

/// Styles of a method and its variants: one hue in three shades, the first of them the method's own.
pub(crate) struct Family {
    pub(crate) width: f64,
    pub(crate) mark: Mark,
    pub(crate) shades: [RGBColor; 3],
}

/// Style of each method, in every study. The hues are close to those of Okabe and Ito, told apart with any colour vision,
/// and made to differ in lightness where they can; the signs tell the rest in grey. No shade comes near one of another
/// method. `nsgs` is wide, since a method that decomposes into one subdomain may lie exactly upon it.
pub(crate) const METHODS: [(&str, Family); 11] = [
    ("nsgs", family(0.6, Mark::None, [(0, 0, 0), (62, 62, 62), (92, 92, 92)])),
    ("nsgs-dd", family(0.3, Mark::Square, [(230, 159, 0), (180, 125, 0), (246, 196, 90)])),
    ("latin-dd", family(0.3, Mark::Diamond, [(0, 84, 148), (0, 48, 98), (38, 106, 166)])),
    ("jacobi", family(0.3, Mark::Ring, [(178, 62, 0), (228, 100, 30), (148, 50, 0)])),
    ("cg", family(0.3, Mark::Plus, [(0, 164, 112), (0, 112, 77), (85, 200, 160)])),
    ("mprgp", family(0.3, Mark::Cross, [(0, 200, 200), (0, 165, 165), (70, 232, 222)])),
    ("apgd", family(0.3, Mark::Bar, [(86, 180, 233), (140, 205, 245), (66, 165, 218)])),
    ("nncg", family(0.3, Mark::Cross, [(110, 60, 30), (75, 38, 15), (145, 95, 65)])),
    ("active-set", family(0.3, Mark::Disc, [(200, 20, 70), (150, 15, 52), (232, 85, 125)])),
    ("newton-schur", family(0.3, Mark::Cross, [(150, 0, 255), (105, 0, 180), (185, 60, 255)])),
    ("interior-point", family(0.3, Mark::Triangle, [(190, 100, 160), (145, 65, 120), (220, 150, 195)])),
];

/// For methods that have no look of their own, other codes above all, in the order in which a study names them.
pub(crate) const SPARE: [Family; 9] = [
    family(0.3, Mark::Square, [(120, 120, 120), (140, 140, 140), (160, 160, 160)]),
    family(0.3, Mark::Diamond, [(150, 150, 40), (112, 112, 26), (184, 184, 84)]),
    family(0.3, Mark::Ring, [(90, 90, 170), (62, 62, 130), (128, 128, 200)]),
    family(0.3, Mark::Plus, [(225, 0, 0), (175, 0, 0), (255, 75, 75)]),
    family(0.3, Mark::Triangle, [(140, 205, 40), (100, 160, 15), (185, 235, 110)]),
    family(0.3, Mark::Disc, [(255, 0, 200), (205, 0, 160), (255, 90, 220)]),
    family(0.3, Mark::Bar, [(215, 165, 135), (195, 140, 108), (235, 205, 185)]),
    family(0.3, Mark::Square, [(50, 85, 0), (30, 50, 0), (62, 120, 0)]),
    family(0.3, Mark::Diamond, [(165, 130, 255), (140, 100, 240), (205, 185, 255)]),
];

const fn family(width: f64, mark: Mark, [own, second, third]: [(u8, u8, u8); 3]) -> Family {
    const fn color((r, g, b): (u8, u8, u8)) -> RGBColor {
        RGBColor(r, g, b)
    }
    Family { width, mark, shades: [color(own), color(second), color(third)] }
}

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

#[cfg(test)]
mod tests;
