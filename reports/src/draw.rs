//! Paper: a canvas in millimetres, axes and frames, lines, keys, and the looks of methods.

mod axis;
mod canvas;
mod curve;
mod legend;
mod lines;
mod panels;
mod picture;
mod plot;
mod scale;
mod series;
mod signs;
mod style;

pub(crate) use crate::families::{Family, METHODS, Mark, RGBColor, SPARE};
pub(crate) use axis::{Axis, Frame, Scale, Ticks};
pub(crate) use canvas::{Canvas, HPos, Place, VPos, rectangle, svg, text_width};
pub(crate) use curve::{LOWEST, LogPoint, along, inside, log, range};
pub(crate) use legend::{Legend, Look, Looks, looks_in_time};
pub(crate) use lines::{Line, Lines, draw_lines};
pub(crate) use panels::{MOST_LINES, Room, fits_a_page, grid, inside_width, title};
pub use picture::Formats;
pub(crate) use picture::{pdf, png};
pub(crate) use plot::{At, Curve, Guide, Panel, Plot, Points, Side, Through, medians};
pub(crate) use scale::ColorScale;
pub(crate) use series::{Series, series};
pub(crate) use signs::{Cell, Sign, Signs, endings};
pub(crate) use style::{
    BEST, BLACK, BOUNDARY_GRAIN, CHAIN, COLUMN, DASHES, DERIVED, FAILED_CELL, FAILED_SIGN, FRAME, GRAIN,
    GRID, HALO, IDLE, INK, LEADING, MARGIN, MARKS, OTHERS, PAGE_HEIGHT, PARETO, Pen, SCALE_BAR, SUBDOMAINS,
    TEXT, TICK_TEXT, TOLERANCE, WALL, WHITE, enlarged, page, subdomain_fill,
};
