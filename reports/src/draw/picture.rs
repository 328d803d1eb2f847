//! A figure in other formats: PNG for slides, PDF for a paper. Both have the font in them.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::Pixmap;
use svg2pdf::usvg::fontdb::Database;
use svg2pdf::usvg::{Options, Transform, Tree};

use crate::error::ReportError;
use crate::own;

/// Which formats of a figure are wanted beside SVG.
#[derive(Clone, Copy, Debug, Default)]
pub struct Formats {
    /// Pixels, 300 to the inch.
    pub png: bool,
    /// A page of the figure's size.
    pub pdf: bool,
}

impl Formats {
    /// These, and those that are among the files `names`: what a person once wanted is drawn again.
    #[must_use]
    pub fn and_those_of(self, names: &[String]) -> Self {
        let there = |ending: &str| names.iter().any(|name| name.ends_with(ending));
        Self { png: self.png || there(".png"), pdf: self.pdf || there(".pdf") }
    }
}

/// Fonts of the layout, and no others: the same picture on every machine.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(include_bytes!("../../fonts/DejaVuSans.ttf").to_vec());
    if let Some((_, bytes, _)) = own::font() {
        fonts.load_font_data(bytes.to_vec());
    }
    Arc::new(fonts)
});

/// Pixels per inch of paper.
const DPI: f32 = 300.0;

/// Dots per inch that give lengths in SVG, by the standard for style sheets.
const SVG_DPI: f32 = 96.0;

pub(crate) fn png(svg: &str) -> Result<Vec<u8>, ReportError> {
    let tree = tree(svg)?;
    let size = tree.size();
    let scale = DPI / SVG_DPI;
    let pixels = |length: f32| (length * scale).round() as u32;
    let mut pixmap = Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| ReportError::Drawing("it has no size in pixels".to_owned()))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(refused)
}

pub(crate) fn pdf(svg: &str) -> Result<Vec<u8>, ReportError> {
    let page = svg2pdf::PageOptions { dpi: SVG_DPI };
    svg2pdf::to_pdf(&tree(svg)?, svg2pdf::ConversionOptions::default(), page).map_err(refused)
}

fn tree(svg: &str) -> Result<Tree, ReportError> {
    let options = Options { fontdb: FONTS.clone(), dpi: SVG_DPI, ..Options::default() };
    Tree::from_str(svg, &options).map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> ReportError {
    ReportError::Drawing(error.to_string())
}
