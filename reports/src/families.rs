//! Methods that figures and texts know by name, each with a hue and a sign of its own.

use std::fmt;

use serde::Deserialize;

/// A colour: red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RGBColor(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl RGBColor {
    /// Reads a colour such as `#0072B2`.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
        let part = |n: usize| u8::from_str_radix(&digits[2 * n..2 * n + 2], 16).ok();
        Some(Self(part(0)?, part(1)?, part(2)?))
    }

    /// Mixes it with a share of another (–).
    pub(crate) fn mixed(self, other: Self, share: f64) -> Self {
        let mix =
            |own: u8, other: u8| ((1.0 - share) * f64::from(own) + share * f64::from(other)).round() as u8;
        Self(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }
}

impl fmt::Display for RGBColor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

/// A small sign on a line: tells methods apart without colour.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// No sign.
    None,
    /// Filled disc.
    Disc,
    /// Open square.
    Square,
    /// Open diamond.
    Diamond,
    /// Upright cross.
    Plus,
    /// Upright line.
    Bar,
    /// Slanting cross.
    Cross,
    /// Open circle.
    Ring,
    /// Open triangle.
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
