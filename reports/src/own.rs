//! A style of one's own for the figures of a process: size, title, font, and the names, colours and signs of methods.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::OnceLock;

use ab_glyph::FontRef;
use serde::Deserialize;
use svg2pdf::usvg::fontdb::Database;

use crate::families::{Family, METHODS, Mark, RGBColor, SPARE};

/// Style of the figures, as a style file has it. What it leaves out stays as it is.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Title of each figure; empty for none.
    pub title: Option<String>,
    /// Width of a figure (mm).
    pub width_mm: Option<f64>,
    /// Height of a panel (mm).
    pub panel_height_mm: Option<f64>,
    /// Panels side by side.
    pub columns: Option<usize>,
    /// Size of the text (pt); lines and signs grow with it.
    pub text_pt: Option<f64>,
    /// File of a font, TrueType or OpenType.
    pub font: Option<PathBuf>,
    /// Looks of methods, by their names.
    pub methods: BTreeMap<String, MethodStyle>,
}

/// Look of a method in the figures.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MethodStyle {
    /// Its name in keys.
    pub name: Option<String>,
    /// Its colour, such as `"#0072B2"`; its variants have a darker and a lighter one.
    pub colour: Option<String>,
    /// Its sign.
    pub mark: Option<Mark>,
    /// Width of its lines (mm).
    pub line_mm: Option<f64>,
}

/// Style in use.
#[derive(Default)]
struct InUse {
    style: Style,
    /// Families of methods whose look is replaced.
    families: Vec<(String, Family)>,
    font: Option<OwnFont>,
}

/// Font of one's own.
struct OwnFont {
    face: FontRef<'static>,
    bytes: &'static [u8],
    family: String,
}

static IN_USE: OnceLock<InUse> = OnceLock::new();

/// Draws all figures of this process in a style of one's own, with the bytes of its font.
///
/// # Errors
///
/// Names the key whose value is wrong. A second call is an error too, and one after the first figure.
pub fn use_style(style: Style, font: Option<Vec<u8>>) -> Result<(), String> {
    let bounded = [
        ("width_mm", style.width_mm, 20.0, 400.0),
        ("panel_height_mm", style.panel_height_mm, 20.0, 400.0),
        ("text_pt", style.text_pt, 4.0, 40.0),
    ];
    for (key, value, least, most) in bounded {
        if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
            return Err(format!("`{key}` = {value}: it is {least} to {most}"));
        }
    }
    if let Some(columns) = style.columns.filter(|columns| !(1..=12).contains(columns)) {
        return Err(format!("`columns` = {columns}: it is 1 to 12"));
    }
    let family = |(method, own): (&String, &MethodStyle)| Ok((method.clone(), own.family(method)?));
    let families = style.methods.iter().map(family).collect::<Result<_, String>>()?;
    let font = font.map(OwnFont::new).transpose()?;
    let again = "one style is for all figures of a process".to_owned();
    IN_USE.set(InUse { style, families, font }).map_err(|_| again)
}

fn in_use() -> &'static InUse {
    IN_USE.get_or_init(InUse::default)
}

impl MethodStyle {
    /// Returns the method's family with what this style replaces.
    fn family(&self, method: &str) -> Result<Family, String> {
        let own = METHODS.iter().find(|(known, _)| *known == method).map_or(&SPARE[0], |(_, family)| family);
        let shades = match &self.colour {
            None => own.shades,
            Some(text) => {
                let colour = RGBColor::read(text).ok_or_else(|| {
                    format!("`methods.{method}.colour` = \"{text}\": it is like \"#0072B2\"")
                })?;
                [colour, colour.mixed(RGBColor(0, 0, 0), 0.35), colour.mixed(RGBColor(255, 255, 255), 0.35)]
            }
        };
        let width = self.line_mm.unwrap_or(own.width);
        if !(width > 0.0 && width <= 10.0) {
            return Err(format!("`methods.{method}.line_mm` = {width}: it is above 0, and at most 10"));
        }
        Ok(Family { width, mark: self.mark.unwrap_or(own.mark), shades })
    }
}

impl OwnFont {
    fn new(bytes: Vec<u8>) -> Result<Self, String> {
        let bytes: &'static [u8] = bytes.leak();
        let face = FontRef::try_from_slice(bytes).map_err(|error| format!("`font`: {error}"))?;
        let mut fonts = Database::new();
        fonts.load_font_data(bytes.to_vec());
        let family = fonts.faces().find_map(|face| Some(face.families.first()?.0.clone()));
        let family = family.ok_or("`font`: it has no name")?;
        Ok(Self { face, bytes, family })
    }
}

/// Returns the title of a figure, given its own.
pub(crate) fn title(own: &[String]) -> Vec<String> {
    match &in_use().style.title {
        None => own.to_vec(),
        Some(title) => title.lines().map(str::to_owned).collect(),
    }
}

/// Returns the style in use.
pub(crate) fn style() -> &'static Style {
    &in_use().style
}

/// Returns the name of a method in keys.
pub(crate) fn shown(method: &str) -> &str {
    in_use().style.methods.get(method).and_then(|own| own.name.as_deref()).unwrap_or(method)
}

/// Returns the family of a method whose look is replaced.
pub(crate) fn family(method: &str) -> Option<&'static Family> {
    in_use().families.iter().find(|(known, _)| known == method).map(|(_, family)| family)
}

/// Returns the font, if another takes the place of the program's: its face, its bytes and its name.
pub(crate) fn font() -> Option<(&'static FontRef<'static>, &'static [u8], &'static str)> {
    in_use().font.as_ref().map(|font| (&font.face, font.bytes, font.family.as_str()))
}
