//! Work and precision: the velocity error against seconds and against counted work, with the Pareto front.

use super::against_truth::AgainstTruth;
use crate::draw::{
    Axis, Canvas, Frame, INSIDE, LOWEST, Line, Lines, LogPoint, PARETO, Place, Room, Scale, Sign, TOLERANCE,
    draw_lines, log, log_point, range, row, title,
};
use crate::read::{
    ACCURACIES, COSTS, Cost, Problems, RunRow, WORK, accuracy_text, number, padded, reached, repeats,
};
use crate::text::Part;

/// `work-precision-<problem>` for each problem, and `work-precision` with the first to each accuracy.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let mut note = String::new();
    for given in &study.given {
        if let Some(error) = given.end.velocity_error() {
            let (problem, code, error) = (&given.problem, &given.variant, number(error, 2));
            note.extend([
                problem,
                ": the impulses that ",
                code,
                " gave have a velocity error of ",
                &error,
                ".\n",
            ]);
        }
    }
    note.extend(["\n", &repeats(&study.runs), " ", WORK, "\n"]);
    AgainstTruth { name: "work-precision", lacks: "nothing to compare", figure, sentences, note }.parts(study)
}

fn figure(study: &Lines, problem: &str, runs: &[&RunRow]) -> String {
    let more = vec![
        (Sign::Line(PARETO), "Pareto front: nothing is cheaper and as accurate".to_owned()),
        (Sign::Line(TOLERANCE), "accuracies of the tables".to_owned()),
        (
            Sign::Word,
            "Counted work is without factorisations that a library makes; runs with more than a few have none.".to_owned(),
        ),
    ];
    let legend = study.legend_of_best(runs, more, INSIDE);
    row(&[title(problem, runs)], COSTS.len(), &legend, |canvas, i, room| {
        panel(canvas, study, runs, &COSTS[i], room);
    })
}

fn panel(canvas: &Canvas, study: &Lines, runs: &[&RunRow], cost: &Cost, room: Room) {
    let lines = study.lines_of_best(runs, |run, point| {
        (cost.of)(run, point).and_then(|cost| log_point(cost, point.velocity_error()))
    });
    let x = padded(lines.iter().flat_map(|line| &line.points).flatten().map(|point| point.0), 0.05);
    // The same in all panels.
    let y = range(
        &study.lines(runs, |_, point| Some(point.velocity_error().map(|error| (0.0, log(error))))),
        &[],
    );
    let y = (y.0.max(LOWEST), y.1);
    let frame = room.frame(canvas, (Scale::Ten, x, cost.title), (Scale::Ten, y, "velocity error (–)"));
    for accuracy in
        ACCURACIES.map(f64::log10).into_iter().filter(|log| (frame.y.low..frame.y.high).contains(log))
    {
        frame.across(canvas, accuracy, TOLERANCE);
    }
    draw_front(canvas, &frame, &lines);
    draw_lines(canvas, &frame, &lines);
}

/// A broad pale line under the curves.
fn draw_front(canvas: &Canvas, frame: &Frame, lines: &[Line]) {
    let front = front(lines.iter().flat_map(|line| &line.points));
    let clamp = |axis: &Axis, at: f64| axis.place(at.clamp(axis.low, axis.high));
    let place = |&(x, y): &(f64, f64)| -> Place { (clamp(&frame.x, x), clamp(&frame.y, y)) };
    canvas.line(&front.iter().map(place).collect::<Vec<_>>(), PARETO);
}

/// Corners of the stairs below which no sample lies, from the cheapest to the most accurate.
fn front<'p>(points: impl Iterator<Item = &'p LogPoint>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = points.copied().flatten().collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for (x, y) in points {
        match stairs.last() {
            Some(&(_, lowest)) if y >= lowest => {}
            Some(&(_, lowest)) => stairs.extend([(x, lowest), (x, y)]),
            None => stairs.push((x, y)),
        }
    }
    stairs
}

/// Which run is the first to each accuracy, in each cost.
fn sentences(study: &Lines, problem: &str) -> String {
    ACCURACIES.map(|accuracy| first(study, problem, accuracy)).concat()
}

fn first(study: &Lines, problem: &str, accuracy: f64) -> String {
    let runs = study.runs_of(problem);
    let says = |cost: &Cost| {
        let price = |run: &RunRow| (cost.of)(run, reached(&run.curve, accuracy)?);
        let prices = runs.iter().filter_map(|run| Some((price(run)?, run)));
        let (price, run) = prices.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!("{} ({} {})", run.label(), number(price, 2), cost.name))
    };
    let name = accuracy_text(accuracy);
    let [seconds, work] = COSTS.each_ref().map(says);
    match (seconds, work) {
        (None, _) => format!("{problem}: no run reaches a velocity error of {name}.\n"),
        (Some(seconds), None) => format!("{problem}: first to a velocity error of {name} is {seconds}.\n"),
        (Some(seconds), Some(work)) => {
            format!("{problem}: first to a velocity error of {name} is {seconds}; in counted work {work}.\n")
        }
    }
}

#[cfg(test)]
mod tests;
