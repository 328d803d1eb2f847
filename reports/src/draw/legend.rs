//! Which line is which run, below the panels and covering nothing.

use std::collections::BTreeMap;

use crate::draw::{
    Canvas, DASHES, Family, HPos, LEADING, MARKS, METHODS, Mark, Pen, Place, SPARE, Sign, Signs, TEXT, VPos,
    text_width,
};
use crate::own;
use crate::read::{RunRow, Simulation, find_or_push, unique};

/// Length of the sample of a line (mm).
const KEY: f64 = 9.0;
/// Between a key and its text, and between columns (mm).
const GAP: f64 = 1.3;
const COLUMN_GAP: f64 = 5.0;

/// Style of the curve of a run.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) pen: Pen,
    pub(crate) mark: Mark,
}

impl Look {
    /// Adds a sign to the look, for points that no line joins.
    pub(crate) fn signed(self) -> Self {
        Self { mark: if self.mark == Mark::None { Mark::Disc } else { self.mark }, ..self }
    }
}

impl Family {
    /// Returns the look with the family's own shade and sign, and the n-th dashes.
    pub(crate) fn dashed(&self, n: usize) -> Look {
        let pen = Pen { color: self.shades[0], width: self.width, dash: DASHES[n % DASHES.len()] };
        Look { pen, mark: self.mark }
    }
}

/// Looks for all runs of a study, so that a method looks the same on every problem.
pub(crate) struct Looks<'t> {
    /// Methods in the order of the study, each with the places of its kinds of run in the order of their subdomains.
    methods: Vec<(&'t str, BTreeMap<Kind<'t>, usize>)>,
}

/// Subdomains and variant: what tells two runs of a method on a problem apart.
type Kind<'t> = (u32, &'t str);

fn kind(run: &RunRow) -> Kind<'_> {
    (run.subdomains, &run.variant)
}

impl<'t> Looks<'t> {
    pub(crate) fn new(runs: impl IntoIterator<Item = &'t RunRow>) -> Self {
        let mut methods: Vec<(&str, BTreeMap<Kind, usize>)> = Vec::new();
        for run in runs {
            let new = || (run.method.as_str(), BTreeMap::new());
            let (_, kinds) = find_or_push(&mut methods, |(method, _)| *method == run.method, new);
            let next = kinds.len();
            kinds.entry(kind(run)).or_insert(next);
        }
        for (_, kinds) in &mut methods {
            // Kinds with as many subdomains stay in the order of the study.
            let mut order: Vec<(Kind, usize)> = kinds.iter().map(|(kind, place)| (*kind, *place)).collect();
            order.sort_by_key(|((subdomains, _), place)| (*subdomains, *place));
            kinds.extend(order.into_iter().enumerate().map(|(place, (kind, _))| (kind, place)));
        }
        Self { methods }
    }

    /// Place of a run in the order of the legend.
    pub(crate) fn rank(&self, run: &RunRow) -> (usize, usize) {
        let method = self.methods.iter().position(|(method, _)| *method == run.method).unwrap_or(0);
        let place = |(_, kinds): &(&str, BTreeMap<Kind, usize>)| kinds.get(&kind(run)).copied();
        (method, self.methods.get(method).and_then(place).unwrap_or(0))
    }

    pub(crate) fn look(&self, run: &RunRow) -> Look {
        self.variant(&run.method, self.rank(run).1)
    }

    /// A method looks the same in every study; one without a look of its own takes the next spare one.
    fn family(&self, name: &str) -> &'static Family {
        if let Some(own) = family(name) {
            return own;
        }
        let mut others = self.methods.iter().map(|(other, _)| *other).filter(|other| family(other).is_none());
        &SPARE[others.position(|other| other == name).unwrap_or(0) % SPARE.len()]
    }

    /// The look of the n-th variant of a method: a shade of its hue, with dashes and the method's sign.
    pub(crate) fn variant(&self, name: &str, n: usize) -> Look {
        let family = self.family(name);
        let dashed = family.dashed(n);
        let color = family.shades[n % family.shades.len()];
        Look { pen: Pen { color, ..dashed.pen }, ..dashed }
    }

    /// Returns the look of a variant where no other method is drawn, and signs are free to tell variants apart.
    pub(crate) fn variant_alone(&self, name: &str, n: usize) -> Look {
        let look = self.variant(name, n);
        let own = MARKS.iter().position(|mark| *mark == look.mark).unwrap_or(0);
        Look { pen: Pen { width: look.pen.width.min(0.3), ..look.pen }, mark: MARKS[(own + n) % MARKS.len()] }
    }

    /// The look of a method where its runs are not told apart.
    pub(crate) fn of_method(&self, name: &str) -> Look {
        self.variant(name, 0)
    }
}

/// The look that a method has of its own.
fn family(name: &str) -> Option<&'static Family> {
    own::family(name).or_else(|| METHODS.iter().find(|(known, _)| *known == name).map(|(_, family)| family))
}

/// Entries in columns, filled downwards so that the variants of a method stand together; the key of the signs below.
pub(crate) struct Legend {
    entries: Vec<(String, Look)>,
    rows: usize,
    /// Widths of the columns (mm).
    column: f64,
    signs: Signs,
}

impl Legend {
    /// Lays entries out in a width (mm).
    pub(crate) fn new(entries: Vec<(String, Look)>, signs: Vec<(Sign, String)>, width: f64) -> Self {
        let wide = entries.iter().map(|(label, _)| KEY + GAP + text_width(label, TEXT) + COLUMN_GAP);
        let column = wide.fold(0.0, f64::max);
        let columns = if column > 0.0 { ((width / column) as usize).max(1) } else { 1 };
        Self { rows: entries.len().div_ceil(columns), entries, column, signs: Signs::new(signs, width) }
    }

    /// Height (mm).
    pub(crate) fn height(&self) -> f64 {
        LEADING * self.rows as f64 + self.signs.height()
    }

    pub(crate) fn draw(&self, canvas: &Canvas, (left, top): Place) {
        for (i, (label, look)) in self.entries.iter().enumerate() {
            let x = left + self.column * (i / self.rows) as f64;
            let y = top + LEADING * ((i % self.rows) as f64 + 0.5);
            canvas.line(&[(x, y), (x + KEY, y)], look.pen);
            canvas.mark(look.mark, (x + KEY / 2.0, y), look.pen);
            canvas.text(label, (x + KEY + GAP, y), TEXT, (HPos::Left, VPos::Center));
        }
        self.signs.draw(canvas, (left, top + LEADING * self.rows as f64));
    }
}

/// Each method of the runs of simulations as a key says it, in the colour that it has in every study; its dashes
/// are for grey, since signs stand for time steps.
pub(crate) fn looks_in_time(all: &[Simulation]) -> Vec<(String, Look)> {
    let runs = || all.iter().filter(|s| s.is_run());
    let methods = unique(runs().map(|run| run.method.as_str()));
    let look = |(n, (label, method)): (usize, (String, &str))| {
        let spare = methods.iter().position(|other| *other == method).unwrap_or(0);
        let own = family(method).unwrap_or(&SPARE[spare % SPARE.len()]);
        (label, Look { mark: Mark::None, ..own.dashed(n) })
    };
    let labels = unique(runs().map(|run| (run.label(), run.method.as_str())));
    labels.into_iter().enumerate().map(look).collect()
}
