//! How much faster subdomains make a method: counted on the longest of them, as if each had a machine of its own, and
//! measured on the threads that there were.

use polars::df;
use polars::prelude::DataFrame;
use results::store::Tables;

use crate::axis::{Axis, Frame, Scale};
use crate::canvas::Canvas;
use crate::ending::Ending;
use crate::legend::Legend;
use crate::panels::{INSIDE, MOST_LINES, Room, row, title, too_many};
use crate::part::Part;
use crate::rows::{RunRow, problems, runs};
use crate::series::{Series, draw_empty, draw_points, reach, series};
use crate::signs::endings;
use crate::{ReportError, file_name};

/// What is compared with that of the fewest subdomains.
struct Cost {
    title: &'static str,
    of: fn(&RunRow) -> Option<f64>,
}

const COSTS: [Cost; 2] = [
    Cost { title: "counted speed-up, a machine per subdomain", of: path },
    Cost { title: "measured speed-up of the iterations", of: |run| run.iterating_s },
];

const NOTE: &str = "\nThe critical path of an iteration is the multiply-adds of the longest subdomain, exchange with its \
                    neighbours included; the latency of messages is not in it. A speed-up is over the run of the same method and \
                    settings on the same problem with the fewest subdomains, both to the same tolerance.\n";

/// Multiply-adds of the longest subdomain in all iterations.
fn path(run: &RunRow) -> Option<f64> {
    Some(run.iterations as f64 * run.derived.get("critical_path")?.as_f64()?)
}

/// `critical-path-<problem>` for each problem, and the table `critical-path`.
pub(crate) fn parts(tables: &Tables) -> Result<Vec<Part>, ReportError> {
    let mut runs = runs(&tables.runs)?;
    runs.retain(|run| run.ending != Ending::Skipped && path(run).is_some());
    let mut parts = Vec::new();
    for problem in problems(&runs) {
        parts.push(Part::figure(format!("critical-path-{}", file_name(problem)), figure(&runs, problem)?));
    }
    parts.push(Part::table("critical-path", table(&series(&runs, &["subdomains"]))?, NOTE));
    Ok(parts)
}

/// How many times more the run with the fewest subdomains costs; of runs that converged.
fn speed_up(series: &Series, run: &RunRow, cost: fn(&RunRow) -> Option<f64>) -> Option<f64> {
    let converged = |run: &&&RunRow| run.ending == Ending::Converged;
    let same = series.runs.iter().filter(|other| other.problem == run.problem);
    let fewest = same.min_by_key(|other| other.subdomains).filter(converged)?;
    Some(cost(fewest)? / cost(run)?).filter(|_| converged(&&run))
}

fn figure(runs: &[RunRow], problem: &str) -> Result<String, ReportError> {
    let mut all = series(runs, &["subdomains"]);
    for series in &mut all {
        series.runs.retain(|run| run.problem == problem);
    }
    all.retain(|series| !series.runs.is_empty());
    if all.len() > MOST_LINES {
        return too_many(problem, all.len());
    }
    let shown: Vec<&RunRow> = all.iter().flat_map(|series| series.runs.iter().copied()).collect();
    let failures = shown.iter().map(|run| run.ending).filter(|ending| *ending != Ending::Converged);
    let entries = all.iter().map(|series| (series.label(), series.look)).collect();
    let legend = Legend::new(entries, endings(failures), INSIDE)?;
    row(&[title(problem, &shown)], COSTS.len(), &legend, |canvas, i, room| {
        panel(canvas, &all, &COSTS[i], room)
    })
}

fn panel(canvas: &Canvas, all: &[Series], cost: &Cost, room: Room) -> Result<(), ReportError> {
    let points = |series: &Series| {
        series.points(|run| f64::from(run.subdomains), |run| speed_up(series, run, cost.of))
    };
    let lines: Vec<_> = all.iter().map(points).collect();
    let frame = Frame {
        x: Axis {
            scale: Scale::Two,
            ..Axis::log(reach(lines.iter().flatten(), |point| point.0), room.left, room.right)
        },
        y: Axis::log(reach(lines.iter().flatten(), |point| point.1), room.bottom, room.top),
    };
    frame.draw(canvas)?;
    frame.name(canvas, "subdomains", cost.title)?;
    for (series, points) in all.iter().zip(&lines) {
        canvas.line(
            &points.iter().map(|(_, point)| frame.place(*point)).collect::<Vec<_>>(),
            series.look.pen,
        )?;
        draw_points(canvas, &frame, series.look, points)?;
    }
    if lines.iter().all(Vec::is_empty) { draw_empty(canvas, &frame) } else { Ok(()) }
}

/// One row per run.
fn table(all: &[Series]) -> Result<DataFrame, ReportError> {
    let rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let visits = |run: &RunRow| f64::from(run.contacts) * run.iterations as f64;
    Ok(df!(
        "problem" => rows.iter().map(|(_, run)| run.problem.as_str()).collect::<Vec<_>>(),
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "contacts" => rows.iter().map(|(_, run)| run.contacts).collect::<Vec<_>>(),
        "subdomains" => rows.iter().map(|(_, run)| run.subdomains).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(_, run)| run.ending.text()).collect::<Vec<_>>(),
        "iterations" => rows.iter().map(|(_, run)| run.iterations).collect::<Vec<_>>(),
        "path_per_iteration" => of(&|_, run| run.derived.get("critical_path")?.as_f64()),
        "counted_speed_up" => of(&|series, run| speed_up(series, run, COSTS[0].of)),
        "measured_speed_up" => of(&|series, run| speed_up(series, run, COSTS[1].of)),
        "ns_per_contact" => of(&|_, run| Some(1e9 * run.iterating_s? / visits(run)).filter(|ns| ns.is_finite())),
    )?)
}
