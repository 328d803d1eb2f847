//! What ranks took beside what is predicted of them: one rank's seconds shared by all, and messages at the prices of the machine.

use polars::df;

use crate::charts::subdomains::Panel;
use crate::draw::{
    Canvas, INSIDE, Legend, Points, Room, Scale, Series, Sign, TOLERANCE, draw_empty, draw_signs, grid, key,
    on_the_way, reach, series,
};
use crate::read::{Ending, RunRow, counted, number, problems};
use crate::text::{Part, chosen};

const NOTE: &str = "\nPredicted of an iteration on p ranks: T = w/p + m α + β B. w: the seconds of one rank; m and B: messages and bytes of a rank, \
     those of sums over all ranks included, counted; α and β: what `gravel-mpi ping` measures before the runs. It knows nothing of \
     ranks that share a memory's bandwidth or a processor, of caches, nor of those that are late.\n";

/// Seconds of an iteration: of the own share of work, and of messages.
struct Predicted {
    work: f64,
    messages: f64,
}

impl Predicted {
    /// Of a run of a series whose run on one rank of the same machine and build is there.
    fn of(series: &Series, run: &RunRow) -> Option<Self> {
        let is_alone = |other: &&&RunRow| {
            other.problem == run.problem
                && other.exchange.ranks == 1
                && other.provenance.comparable(&run.provenance)
        };
        let alone = series.runs.iter().find(is_alone)?.seconds_per_iteration()?;
        let exchange = &run.exchange;
        let ranks = f64::from(exchange.ranks);
        let of_rank = |count: u64| count as f64 / (ranks * run.iterations as f64);
        let messages = if exchange.ranks == 1 {
            0.0
        } else {
            of_rank(exchange.messages) * exchange.latency_s
                + of_rank(exchange.message_bytes) * exchange.seconds_per_byte
        };
        Some(Self { work: alone / ranks, messages }).filter(|predicted| predicted.messages.is_finite())
    }
}

/// Measured over predicted (–).
fn ratio(series: &Series, run: &RunRow) -> Option<f64> {
    let Predicted { work, messages } = Predicted::of(series, run)?;
    Some(run.seconds_per_iteration()? / (work + messages))
}

/// Whether some runs were shared by ranks.
pub(super) fn has_ranks(runs: &[RunRow]) -> bool {
    runs.iter().any(|run| run.exchange.ranks > 1)
}

/// The figure `ranks-measured`, its sentence, and the table `ranks`.
pub(super) fn parts(runs: &[RunRow]) -> Vec<Part> {
    let all = series(runs.iter().filter(|run| run.ending != Ending::Skipped), &["ranks"]);
    let mut parts = vec![figure(runs, &all)];
    let found = sentence(&all);
    parts.extend((!found.is_empty()).then(|| Part::text("ranks-found", found)));
    parts.push(table(&all));
    parts
}

fn figure(runs: &[RunRow], all: &[Series]) -> Part {
    let problems = problems(runs);
    let panel_of = |problem: &str| {
        let grains = runs.iter().find(|run| run.problem == problem).map_or(0, |run| run.grains);
        Panel::new(format!("measured / predicted, {} (–)", counted(grains as usize, "grain")), ratio)
    };
    let panels: Vec<Panel> = problems.iter().map(|problem| panel_of(problem)).collect();
    // By panel, then by series.
    let on = |panel: &Panel, series: &Series, problem: &str| -> Points {
        let mut here = series.clone();
        here.runs.retain(|run| run.problem == problem);
        on_the_way(panel.points(&here, |run| f64::from(run.exchange.ranks)))
    };
    let lines: Vec<Vec<Points>> = panels
        .iter()
        .zip(&problems)
        .map(|(panel, problem)| all.iter().map(|series| on(panel, series, problem)).collect())
        .collect();
    let keyed = all.iter().enumerate().map(|(i, series)| {
        (series.label(), series.look, lines.iter().map(|lines| &lines[i]).collect(), false)
    });
    let (entries, mut signs) = key(keyed);
    signs.push((Sign::Line(TOLERANCE), "as predicted; of one rank by definition".to_owned()));
    signs.push((Sign::Word, "More ranks than processors take longer.".to_owned()));
    let legend = Legend::new(entries, signs, INSIDE);
    let flat = || lines.iter().flatten().flatten();
    let (x, (low, high)) = (reach(flat(), |point| point.0), reach(flat(), |point| point.1));
    // All panels have the same axes, on which a factor of two is seen as what it is.
    let y = (low.min(-0.35), high.max(0.35));
    let title = "Seconds of an iteration on ranks: measured over predicted, T = w/p + m α + β B.".to_owned();
    let columns = match panels.len() {
        4 => 2,
        count => count.clamp(1, 3),
    };
    let svg = grid(&[title], (columns, panels.len().div_ceil(columns)), &legend, |canvas, i, room| {
        if let Some(lines) = lines.get(i) {
            panel(canvas, all, lines, (x, y), (&panels[i].title, room));
        }
    });
    Part::figure("ranks-measured", svg)
}

fn panel(
    canvas: &Canvas,
    all: &[Series],
    lines: &[Points],
    (x, y): ((f64, f64), (f64, f64)),
    (title, room): (&str, Room),
) {
    let frame = room.frame(canvas, (Scale::Two, x, "ranks"), (Scale::Ten, y, title));
    frame.across(canvas, 0.0, TOLERANCE);
    for (series, points) in all.iter().zip(lines) {
        let places: Vec<_> = points.iter().map(|(_, point)| frame.place(*point)).collect();
        canvas.line(&places, series.look.pen);
    }
    let signs: Vec<_> =
        all.iter().zip(lines).map(|(series, points)| (series.look, points.as_slice())).collect();
    draw_signs(canvas, &frame, &signs);
    if lines.iter().all(Vec::is_empty) {
        draw_empty(canvas, &frame);
    }
}

/// How far predictions are off, for each number of ranks.
fn sentence(all: &[Series]) -> String {
    let mut counts: Vec<u32> = all.iter().flat_map(|s| &s.runs).map(|run| run.exchange.ranks).collect();
    counts.sort_unstable();
    counts.dedup();
    let of = |ranks: u32| {
        let range = |series: &Series| {
            let runs = series.runs.iter().filter(|run| run.exchange.ranks == ranks);
            let ratios: Vec<f64> = runs.filter_map(|run| ratio(series, run)).collect();
            let low = ratios.iter().copied().reduce(f64::min)?;
            let high = ratios.iter().copied().reduce(f64::max)?;
            let range = if ratios.len() == 1 { String::new() } else { format!(" to {}", number(high, 2)) };
            Some(format!("{} {}{range}", series.label(), number(low, 2)))
        };
        let ranges: Vec<String> = all.iter().filter_map(range).collect();
        (!ranges.is_empty()).then(|| {
            let ranks = counted(ranks as usize, "rank");
            format!("Measured over predicted seconds of an iteration on {ranks}: {}.\n", ranges.join("; "))
        })
    };
    counts.into_iter().filter(|ranks| *ranks > 1).filter_map(of).collect()
}

fn table(all: &[Series]) -> Part {
    let mut rows: Vec<(&Series, &RunRow)> =
        all.iter().flat_map(|series| series.runs.iter().map(move |run| (series, *run))).collect();
    rows.sort_by_key(|(series, run)| (run.grains, run.problem.clone(), series.label(), run.exchange.ranks));
    let of = |value: &dyn Fn(&Series, &RunRow) -> Option<f64>| {
        rows.iter().map(|(series, run)| value(series, run)).collect::<Vec<_>>()
    };
    let part = |part: fn(&Predicted) -> f64| of(&|series, run| Some(part(&Predicted::of(series, run)?)));
    let ranks = rows.iter().map(|(_, run)| run.exchange.ranks).collect::<Vec<_>>();
    let own = df!(
        "method" => rows.iter().map(|(series, _)| series.label()).collect::<Vec<_>>(),
        "ranks" => ranks,
        "seconds_per_iteration" => of(&|_, run| run.seconds_per_iteration()),
        "work_s" => part(|predicted| predicted.work),
        "messages_s" => part(|predicted| predicted.messages),
        "predicted_s" => part(|predicted| predicted.work + predicted.messages),
        "measured_over_predicted" => of(&ratio),
    );
    let names = "problem method ranks iterations seconds_per_iteration work_s messages_s predicted_s \
                 measured_over_predicted";
    Part::table("ranks", chosen(rows.iter().map(|(_, run)| *run), names, own), NOTE)
}
