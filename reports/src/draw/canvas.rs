//! A sheet to draw on in millimetres. It becomes an SVG of that size on paper.

use std::sync::OnceLock;

use crate::draw::{BLACK, Mark, Pen, WHITE};
use crate::error::ReportError;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, RGBColor, ShapeStyle, TextStyle, register_font,
};

/// The drawing library rounds to integers, so its unit is a fiftieth of a millimetre.
const UNITS_PER_MM: f64 = 50.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The drawing library writes a font's size divided by this.
const SIZE_PER_EM: f64 = 1.24;
/// Fonts of nearly the same widths, for a reader without the font that the layout is made with.
const FONTS: &str = "DejaVu Sans, Verdana, sans-serif";

/// A place on the sheet (mm), from its upper left corner.
pub(crate) type Place = (f64, f64);

pub(crate) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Draws a sheet of `width` by `height` mm on a white ground.
pub(crate) fn svg(
    (width, height): (f64, f64),
    draw: impl FnOnce(&Canvas) -> Result<(), ReportError>,
) -> Result<String, ReportError> {
    use_own_font()?;
    let (columns, rows) = (units(width) as u32, units(height) as u32);
    let mut text = String::new();
    let canvas = Canvas { area: SVGBackend::with_string(&mut text, (columns, rows)).into_drawing_area() };
    canvas.area.fill(&WHITE).map_err(refused)?;
    draw(&canvas)?;
    canvas.area.present().map_err(refused)?;
    drop(canvas);
    let size = |width: &str, height: &str| format!(r#"width="{width}" height="{height}""#);
    let text: String = text.split_inclusive('\n').map(lowered).collect();
    Ok(text
        .replacen(
            &size(&columns.to_string(), &rows.to_string()),
            &format!("{} stroke-linejoin=\"round\"", size(&format!("{width}mm"), &format!("{height}mm"))),
            1,
        )
        .replace(r#"font-family="sans-serif""#, &format!(r#"font-family="{FONTS}""#))
        // Half the height of a digit, which every renderer knows; few agree on `ex`.
        .replace(r#"dy="0.5ex""#, r#"dy="0.36em""#)
        .replace(r#" opacity="1""#, ""))
}

/// A line of SVG with the index of each κ_l or κ_d set as one.
fn lowered(line: &str) -> String {
    let mut pieces = line.split("κ_");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (index, rest) = piece.split_at(piece.chars().next().map_or(0, char::len_utf8));
        // Down by three tenths of the smaller letter, and up again.
        text.extend([r#"κ<tspan font-size="70%" dy="0.3em">"#, index, r#"</tspan><tspan dy="-0.21em">"#]);
        text.extend([rest.trim_end_matches('\n'), "</tspan>", if rest.ends_with('\n') { "\n" } else { "" }]);
    }
    text
}

/// Width of a text (mm).
pub(crate) fn text_width(text: &str, size_pt: f64) -> Result<f64, ReportError> {
    use_own_font()?;
    let (width, _) = font(size_pt).box_size(text).map_err(refused)?;
    Ok(f64::from(width) / UNITS_PER_MM)
}

impl Canvas<'_> {
    pub(crate) fn line(&self, places: &[Place], pen: Pen) -> Result<(), ReportError> {
        let style = ShapeStyle::from(&pen.color).stroke_width(units(pen.width).max(1) as u32);
        for piece in dashes(places, pen.dash) {
            self.area.draw(&PathElement::new(rounded(&piece), style)).map_err(refused)?;
        }
        Ok(())
    }

    pub(crate) fn polygon(
        &self,
        corners: &[Place],
        fill: RGBColor,
        pen: Option<Pen>,
    ) -> Result<(), ReportError> {
        self.area.draw(&Polygon::new(rounded(corners), fill.filled())).map_err(refused)?;
        let closed: Vec<Place> = corners.iter().chain(corners.first()).copied().collect();
        pen.map_or(Ok(()), |pen| self.line(&closed, pen))
    }

    pub(crate) fn disc(
        &self,
        centre: Place,
        radius: f64,
        fill: RGBColor,
        pen: Option<Pen>,
    ) -> Result<(), ReportError> {
        let (centre, radius) = ((units(centre.0), units(centre.1)), units(radius).max(1));
        self.area.draw(&Circle::new(centre, radius, fill.filled())).map_err(refused)?;
        let Some(pen) = pen else { return Ok(()) };
        let style = ShapeStyle::from(&pen.color).stroke_width(units(pen.width).max(1) as u32);
        self.area.draw(&Circle::new(centre, radius, style)).map_err(refused)
    }

    pub(crate) fn text(
        &self,
        text: &str,
        place: Place,
        size_pt: f64,
        anchor: (HPos, VPos),
    ) -> Result<(), ReportError> {
        self.text_in(BLACK, text, place, size_pt, anchor)
    }

    pub(crate) fn text_in(
        &self,
        color: RGBColor,
        text: &str,
        place: Place,
        size_pt: f64,
        anchor: (HPos, VPos),
    ) -> Result<(), ReportError> {
        let style = TextStyle::from(font(size_pt)).pos(Pos::new(anchor.0, anchor.1)).color(&color);
        self.area.draw_text(text, &style, (units(place.0), units(place.1))).map_err(refused)
    }

    /// A sign on a line, white inside.
    pub(crate) fn mark(&self, mark: Mark, (x, y): Place, pen: Pen) -> Result<(), ReportError> {
        const HALF: f64 = 0.6;
        let pen = Pen { width: pen.width.min(0.3), dash: &[], ..pen };
        match mark {
            Mark::None => Ok(()),
            Mark::Disc => {
                self.disc((x, y), 0.7, pen.color, Some(Pen { color: WHITE, width: 0.1, dash: &[] }))
            }
            Mark::Square => {
                let h = 0.9 * HALF;
                self.polygon(
                    &[(x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)],
                    WHITE,
                    Some(pen),
                )
            }
            Mark::Diamond => {
                let h = 1.3 * HALF;
                self.polygon(&[(x - h, y), (x, y - h), (x + h, y), (x, y + h)], WHITE, Some(pen))
            }
            Mark::Plus => {
                self.line(&[(x - HALF, y), (x + HALF, y)], pen)?;
                self.line(&[(x, y - HALF), (x, y + HALF)], pen)
            }
            Mark::Ring => self.disc((x, y), HALF, WHITE, Some(pen)),
            Mark::Triangle => {
                let h = 1.1 * HALF;
                self.polygon(&[(x - h, y + h), (x, y - h), (x + h, y + h)], WHITE, Some(pen))
            }
            Mark::Cross => {
                let h = 0.8 * HALF;
                self.line(&[(x - h, y - h), (x + h, y + h)], pen)?;
                self.line(&[(x - h, y + h), (x + h, y - h)], pen)
            }
            Mark::Bar => self.line(&[(x, y - HALF), (x, y + HALF)], pen),
        }
    }
}

fn units(mm: f64) -> i32 {
    (mm * UNITS_PER_MM).round() as i32
}

fn rounded(places: &[Place]) -> Vec<(i32, i32)> {
    let mut places: Vec<(i32, i32)> = places.iter().map(|&(x, y)| (units(x), units(y))).collect();
    places.dedup();
    places
}

fn font(size_pt: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, size_pt * MM_PER_PT * UNITS_PER_MM * SIZE_PER_EM, FontStyle::Normal)
}

/// Layout needs the widths of a font on machines that have none.
fn use_own_font() -> Result<(), ReportError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let bytes = include_bytes!("../../fonts/DejaVuSans.ttf");
    let register = || register_font("sans-serif", FontStyle::Normal, bytes).is_ok();
    if *REGISTERED.get_or_init(register) {
        Ok(())
    } else {
        Err(ReportError::Drawing("its font cannot be read".to_owned()))
    }
}

fn refused(error: impl std::error::Error) -> ReportError {
    ReportError::Drawing(error.to_string())
}

/// The drawn pieces of a line under a pattern of lengths drawn and left out.
fn dashes(places: &[Place], pattern: &[f64]) -> Vec<Vec<Place>> {
    let Some(&first) = places.first() else { return Vec::new() };
    if pattern.is_empty() {
        return vec![places.to_vec()];
    }
    let (mut pieces, mut piece) = (Vec::new(), vec![first]);
    let (mut index, mut left) = (0, pattern[0]);
    for ends in places.windows(2) {
        let (mut from, to) = (ends[0], ends[1]);
        let mut length = (to.0 - from.0).hypot(to.1 - from.1);
        while length > left {
            let t = left / length;
            from = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
            length -= left;
            if index % 2 == 0 {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
        left -= length;
        if index % 2 == 0 {
            piece.push(to);
        }
    }
    if piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests;
