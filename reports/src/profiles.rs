//! Performance profiles (Dolan & Moré, Math. Program. 91 (2002) 201-213): the share of the problems that a method
//! solves within τ times the cost of the best one.

mod ratios;

use polars::df;
use polars::prelude::DataFrame;
use results::store::Tables;

use crate::ReportError;
use crate::axis::{Axis, Frame, Scale};
use crate::canvas::{Canvas, Place};
use crate::cost::{ACCURACIES, COSTS, Cost, WORK};
use crate::legend::Legend;
use crate::number::{counted, power_of_ten};
use crate::panels::{INSIDE, MOST_LINES, Room, nothing, row, too_many};
use crate::part::Part;
use crate::rows::{problems, repeats, runs};
use crate::series::{Series, draw_empty, series};
use crate::statistics::median;
use crate::study::Study;
use ratios::Ratios;

/// `profiles-seconds`, `profiles-sweeps`, and the table `profiles`: which method for which accuracy.
pub(crate) fn parts(tables: &Tables) -> Result<Vec<Part>, ReportError> {
    let runs = runs(&tables.runs)?;
    let (study, methods) = (Study::of(&runs, tables)?, series(&runs, &[]));
    let mut parts = Vec::new();
    for cost in &COSTS {
        parts.push(Part::figure(format!("profiles-{}", cost.name), figure(&study, &methods, cost)?));
    }
    let table = table(&study, &methods)?;
    let set = problems(&runs).join(", ");
    let repeats = repeats(&tables.runs)?;
    let note = format!(
        "\nProblems: {set}. Reached: with the accuracy reached, the other runs are censored. Best: with no method cheaper. \
         Median ratio: of the cost to the least, where reached. {repeats} {WORK}\n"
    );
    parts.push(Part::table("profiles", table, note));
    Ok(parts)
}

fn figure(study: &Study, methods: &[Series], cost: &Cost) -> Result<String, ReportError> {
    if methods.len() > MOST_LINES {
        return too_many("performance profiles", methods.len());
    }
    let all = ACCURACIES.map(|accuracy| Ratios::of(study, methods, cost, accuracy));
    if all.iter().all(|ratios| ratios.best().is_empty()) {
        return nothing("performance profiles", "no run reaches a known velocity error of 10⁻² or less");
    }
    let entries = methods.iter().map(|method| (method.label(), method.look)).collect();
    let legend = Legend::new(entries, Vec::new(), INSIDE)?;
    let title = [
        format!(
            "Share of {} solved within τ times the least cost, against τ.",
            counted(all[0].problems, "problem")
        ),
        format!("Cost: {}, to a velocity error of 10⁻², 10⁻⁴, 10⁻⁶.", cost.title),
    ];
    row(&title, all.len(), &legend, |canvas, i, room| panel(canvas, methods, &all[i], ACCURACIES[i], room))
}

fn panel(
    canvas: &Canvas,
    methods: &[Series],
    ratios: &Ratios,
    accuracy: f64,
    room: Room,
) -> Result<(), ReportError> {
    /// The axis ends here, or at the greatest ratio if that is less.
    const FAR: f64 = 3.0;
    let greatest = ratios.of_methods.iter().flatten().flatten().copied().fold(10.0, f64::max);
    let frame = Frame {
        x: Axis::log((0.0, greatest.log10().min(FAR) + 0.1), room.left, room.right),
        y: Axis { scale: Scale::Share, ..Axis::log((-0.03, 1.03), room.bottom, room.top) },
    };
    frame.draw(canvas)?;
    let name = power_of_ten(accuracy.log10().round() as i32);
    let (censored, runs) = ratios.censored();
    frame.name(canvas, "τ (–)", &format!("≤ {name}, {censored} of {runs} censored"))?;
    for (k, (method, ratios)) in methods.iter().zip(&ratios.of_methods).enumerate() {
        let stairs = stairs(ratios, frame.x.high);
        canvas
            .line(&stairs.iter().map(|point| frame.place(*point)).collect::<Vec<Place>>(), method.look.pen)?;
        // Where the line rises, at a height of its own: what is flat lies on what others have flat.
        let height = (k as f64 + 0.5) / methods.len() as f64 * stairs.last().map_or(0.0, |(_, share)| *share);
        let rises = |step: &&[(f64, f64)]| step[0].1 < height && height <= step[1].1;
        if let Some(step) = stairs.windows(2).find(rises) {
            canvas.mark(method.look.mark, frame.place((step[1].0, height)), method.look.pen)?;
        }
    }
    if ratios.best().is_empty() { draw_empty(canvas, &frame) } else { Ok(()) }
}

/// ρ(τ) from τ = 1 up to `end` in logarithms; no line for a method that solves nothing.
fn stairs(ratios: &[Option<f64>], end: f64) -> Vec<(f64, f64)> {
    let mut logs: Vec<f64> = ratios.iter().flatten().map(|ratio| ratio.log10()).collect();
    logs.sort_by(f64::total_cmp);
    let share = |solved: usize| solved as f64 / ratios.len() as f64;
    let mut stairs = vec![(0.0, 0.0)];
    for (solved, log) in logs.iter().enumerate().filter(|(_, log)| **log <= end) {
        stairs.extend([(*log, share(solved)), (*log, share(solved + 1))]);
    }
    let last = stairs[stairs.len() - 1].1;
    stairs.push((end, last));
    if logs.is_empty() { Vec::new() } else { stairs }
}

fn table(study: &Study, methods: &[Series]) -> Result<DataFrame, ReportError> {
    let problems = problems(study.runs).len() as u64;
    let mut rows = Vec::new();
    for accuracy in ACCURACIES {
        for cost in &COSTS {
            let ratios = Ratios::of(study, methods, cost, accuracy);
            for (method, of_method) in methods.iter().zip(&ratios.of_methods) {
                let reached: Vec<f64> = of_method.iter().flatten().copied().collect();
                let best = reached.iter().filter(|ratio| **ratio <= 1.0).count() as u64;
                rows.push((accuracy, cost.name, method.label(), reached.len() as u64, best, median(reached)));
            }
        }
    }
    Ok(df!(
        "velocity_error" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        "cost" => rows.iter().map(|row| row.1).collect::<Vec<_>>(),
        "method" => rows.iter().map(|row| row.2.as_str()).collect::<Vec<_>>(),
        "problems" => vec![problems; rows.len()],
        "reached" => rows.iter().map(|row| row.3).collect::<Vec<_>>(),
        "best" => rows.iter().map(|row| row.4).collect::<Vec<_>>(),
        "median_ratio" => rows.iter().map(|row| row.5).collect::<Vec<_>>(),
    )?)
}
