//! Starts of time steps: iterations and seconds beside those of a start from nothing.

#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    Axis, BLACK, Canvas, DERIVED, Frame, HPos, INK, INSIDE, LEADING, MARGIN, Mark, PAGE, Pen, Scale, Sign,
    Signs, TEXT, TICK_TEXT, TOLERANCE, Ticks, VPos, log, svg, text_width,
};
use crate::read::{Simulation, counted, milliseconds, number, padded, unique};
use crate::text::{Part, chosen};

const KEY: &str = "next-step";
/// The starts that are compared with one from nothing.
const STARTS: [(&str, Mark, Pen); 2] =
    [("previous", Mark::Square, Pen::solid(BLACK, 0.3)), ("extrapolated", Mark::Diamond, DERIVED)];
/// The share of the time steps that may miss the tolerance of a simulation of which it is said that it was solved to it.
const MISSED: f64 = 0.1;

/// Cost by which starts are compared.
type Cost = fn(&Simulation) -> f64;
const COSTS: [(&str, Cost); 2] = [
    ("iterations", |s| s.totals.iterations as f64 / s.totals.time_steps.max(1) as f64),
    ("seconds", |s| s.seconds_per_second().unwrap_or(f64::NAN)),
];

/// Simulations that differ in their start alone: from nothing, and from each of [`STARTS`].
struct Row<'s> {
    nothing: &'s Simulation,
    warm: [Option<&'s Simulation>; 2],
}

impl Row<'_> {
    /// The cost of a start over that from nothing, if both came to the end.
    fn ratio(&self, start: usize, cost: Cost) -> Option<f64> {
        let warm = self.warm[start].filter(|s| is_solved(s) && is_solved(self.nothing))?;
        let ratio = cost(warm) / cost(self.nothing);
        (ratio.is_finite() && ratio > 0.0).then_some(ratio)
    }
}

fn is_solved(s: &Simulation) -> bool {
    s.status == "completed" && s.totals.missed_time_steps as f64 <= MISSED * s.totals.time_steps as f64
}

fn rows(all: &[Simulation]) -> Vec<Row<'_>> {
    let of = |nothing| {
        let start = |name| all.iter().find(|s| s.is_run() && s.start == name && is_like(s, nothing));
        Row { nothing, warm: STARTS.map(|(name, ..)| start(name)) }
    };
    all.iter().filter(|s| s.is_run() && s.start == "nothing").map(of).collect()
}

fn is_like(a: &Simulation, b: &Simulation) -> bool {
    (&a.scene, a.time_step_s, a.tolerance, a.label()) == (&b.scene, b.time_step_s, b.tolerance, b.label())
}

/// The figure, the sentences and the table `next-step`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let rows = rows(all);
    let drawn: Vec<&Row> =
        rows.iter().filter(|row| (0..2).any(|i| row.ratio(i, COSTS[0].1).is_some())).collect();
    let mut parts = Vec::new();
    if !drawn.is_empty() {
        parts.push(Part::figure(KEY, figure(&drawn, rows.len() - drawn.len())));
    }
    parts.push(Part::text("next-step-found", sentences(&rows)));
    parts.push(Part::table(KEY, table(all), format!("\n{MEANING}\n")));
    parts
}

const MEANING: &str = "Starts: nothing, the previous impulses r⁻, or 2 r⁻ − r⁻⁻ extrapolated from the last two time steps, \
                       contact by contact and clipped into its cone. Seconds are those in the method alone.";

fn table(all: &[Simulation]) -> DataFrame {
    let runs: Vec<&Simulation> = all.iter().filter(|s| s.is_run()).collect();
    let of = |cost: Cost| runs.iter().map(|s| cost(s)).collect::<Vec<_>>();
    let own = df!(
        "method" => runs.iter().map(|s| s.label()).collect::<Vec<_>>(),
        "iterations_per_time_step" => of(COSTS[0].1),
        "seconds_per_second" => of(COSTS[1].1),
    );
    let names = "scene time_step_s tolerance method start status time_steps missed_time_steps iterations \
                 iterations_per_time_step seconds_per_second";
    chosen(runs, names, own)
}

/// Scene, time step and tolerance of a row.
fn setting(row: &Row) -> String {
    let Row { nothing, .. } = row;
    let h = milliseconds(nothing.time_step_s);
    format!("{}, h = {h} ms, ≤ {}", nothing.scene, number(nothing.tolerance, 1))
}

/// Pen of the line at a start from nothing.
const NOTHING: Pen = Pen::solid(INK, 0.25);
/// Height of a line (mm).
const LINE: f64 = 3.9;

/// Two panels side by side, a line for each row below a heading for each setting.
fn figure(rows: &[&Row], left_out: usize) -> String {
    let mut lines: Vec<(String, Option<&Row>)> = Vec::new();
    for each in unique(rows.iter().map(|row| setting(row))) {
        let of_setting = rows.iter().filter(|row| setting(row) == each);
        let of_setting: Vec<_> = of_setting.map(|row| (row.nothing.label(), Some(*row))).collect();
        lines.push((each, None));
        lines.extend(of_setting);
    }
    let labels = lines.iter().filter(|(_, row)| row.is_some()).map(|(label, _)| text_width(label, TICK_TEXT));
    let left = MARGIN + labels.fold(0.0, f64::max) + 2.0;
    let wide = (PAGE - MARGIN - left - 4.0) / 2.0;
    let top = MARGIN + 2.0 * LEADING + 1.0;
    let bottom = top + LINE * lines.len() as f64;
    let key = key(left_out);
    let below = bottom + 2.0 * LEADING + 2.5;
    svg((PAGE, (below + key.height() + MARGIN).ceil()), |canvas| {
        let title = "Cost of the time steps, started from earlier impulses, over that of the same started from nothing";
        canvas.text(title, (MARGIN, MARGIN), TEXT, (HPos::Left, VPos::Top));
        for (k, (name, cost)) in COSTS.iter().enumerate() {
            let from = left + (wide + 4.0) * k as f64;
            let ratios = rows.iter().flat_map(|row| (0..2).filter_map(|i| row.ratio(i, *cost)));
            let x = Axis {
                scale: Scale::Ten,
                ..Axis::log(padded(ratios.map(log).chain([0.0]), 0.06), from, from + wide)
            };
            // Rows have names in place of ticks.
            let y = Axis { scale: Scale::Share, ..Axis::log((2.0, 3.0), bottom, top) };
            let frame = Frame { x, y };
            panel(canvas, &frame, &lines, *cost);
            frame.name(canvas, &format!("{name} over those from nothing (–)"), name);
        }
        for (i, (label, row)) in lines.iter().enumerate() {
            let y = top + LINE * (i as f64 + 0.5);
            let (x, side) = if row.is_some() { (left - 1.0, HPos::Right) } else { (left + 1.0, HPos::Left) };
            canvas.text(label, (x, y), TICK_TEXT, (side, VPos::Center));
        }
        key.draw(canvas, (MARGIN, below));
    })
}

fn panel(canvas: &Canvas, frame: &Frame, lines: &[(String, Option<&Row>)], cost: Cost) {
    let top = frame.y.to;
    frame.draw_border(canvas, Ticks::Outside);
    frame.label_x(canvas, Ticks::Outside);
    let one = frame.x.place(0.0);
    for (i, (_, row)) in lines.iter().enumerate() {
        let y = top + LINE * (i as f64 + 0.5);
        if row.is_some() {
            canvas.line(&[(one, y - 0.5 * LINE), (one, y + 0.5 * LINE)], NOTHING);
        }
        let places = [0, 1].map(|start| {
            let ratio = row.and_then(|row| row.ratio(start, cost))?;
            Some((frame.x.place(log(ratio)), y))
        });
        if let [Some(a), Some(b)] = places {
            canvas.line(&[a, b], TOLERANCE);
        }
        for ((_, mark, pen), place) in STARTS.iter().zip(places) {
            place.inspect(|place| canvas.mark(*mark, *place, *pen));
        }
    }
}

fn key(left_out: usize) -> Signs {
    let mut signs: Vec<(Sign, String)> = STARTS
        .iter()
        .map(|(name, mark, pen)| (Sign::Mark(*mark, *pen), format!("from {name} impulses")))
        .collect();
    signs.push((Sign::Line(NOTHING), "from nothing: 1".to_owned()));
    signs.push((Sign::Word, "h: time step; ≤: tolerance.".to_owned()));
    if left_out > 0 {
        let text = format!(
            "Not drawn, since they missed their tolerance in more than a tenth of the time steps: {left_out}."
        );
        signs.push((Sign::Word, text));
    }
    Signs::new(signs, INSIDE)
}

/// For each method what each start takes, and whether extrapolating pays.
fn sentences(rows: &[Row]) -> String {
    let mut text = String::new();
    for label in unique(rows.iter().map(|row| row.nothing.label())) {
        let of = |start: usize, cost: Cost| -> Vec<f64> {
            let all = rows.iter().filter(|row| row.nothing.label() == label);
            // Of those that have both starts.
            all.filter_map(|row| row.ratio(1 - start, cost).and(row.ratio(start, cost))).collect()
        };
        let [iterations, seconds] = COSTS.map(|(_, cost)| [of(0, cost), of(1, cost)]);
        let count = seconds[0].len().min(iterations[0].len());
        if count == 0 {
            text.extend([format!("{label}: nothing to compare, since time steps missed their tolerance.\n")]);
            continue;
        }
        let [i, s] = [&iterations, &seconds].map(|both| [0, 1].map(|k| number(mean(&both[k]), 2)));
        let faster = seconds[0].iter().zip(&seconds[1]).filter(|(old, new)| new < old).count();
        text.extend([format!(
            "{label}: of the iterations from nothing, previous impulses take {} and extrapolated ones {}; of the seconds {} and {} \
             (geometric means of {}). Extrapolating takes fewer seconds than previous impulses in {faster} of {count}.\n",
            i[0],
            i[1],
            s[0],
            s[1],
            counted(count, "simulation")
        )]);
    }
    text
}

/// The geometric mean.
fn mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp()
}
