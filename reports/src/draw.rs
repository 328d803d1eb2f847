//! Paper: a canvas in millimetres, axes and frames, lines, keys, and the looks of methods.

mod axis;
mod canvas;
mod curve;
mod legend;
mod lines;
mod panels;
mod picture;
mod scale;
mod series;
mod signs;
mod style;

pub(crate) use plotters::style::RGBColor;
pub(crate) use plotters::style::text_anchor::{HPos, VPos};

pub(crate) use axis::{Axis, Frame, Scale, Ticks};
pub(crate) use canvas::{Canvas, Place, rectangle, svg, text_width};
pub(crate) use curve::{LOWEST, LogPoint, along, inside, log, log_point, range};
pub(crate) use legend::{Legend, Look, Looks, looks_in_time};
pub(crate) use lines::{Line, Lines, draw_lines};
pub(crate) use panels::{INSIDE, MOST_LINES, Room, grid, row, title};
pub use picture::Formats;
pub(crate) use picture::{pdf, png};
pub(crate) use scale::ColorScale;
pub(crate) use series::{Points, Series, draw_empty, draw_signs, has_line, key, on_the_way, reach, series};
pub(crate) use signs::{Cell, Sign, Signs, endings, ring, wedge};
pub(crate) use style::{
    BEST, BLACK, BOUNDARY_GRAIN, CHAIN, COLUMN, DASHES, DERIVED, FAILED_CELL, FAILED_SIGN, FRAME, Family,
    GRAIN, GRID, HALO, IDLE, INK, LEADING, MARGIN, MARKS, METHODS, Mark, OTHERS, PAGE, PAGE_HEIGHT, PARETO,
    Pen, SCALE_BAR, SPARE, SUBDOMAINS, TEXT, TICK_TEXT, TOLERANCE, WALL, WHITE, subdomain_fill,
};
