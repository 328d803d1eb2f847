//! Performance profiles (Dolan & Moré, Math. Program. 91 (2002) 201-213): the share of the problems that a method
//! solves within τ times the cost of the best one.

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{Curve, Look, MOST_LINES, Mark, Panel, Plot, Scale, Series, Side, Through, series};
use crate::read::{
    ACCURACIES, COSTS, Cost, Problems, RunRow, WORK, accuracy_text, counted, median, problems, repeats, span,
};
use crate::text::{Part, frame, nothing, too_many};

/// A share of fewer problems than this moves by too much with each of them to be drawn.
const PROBLEMS: usize = 10;

/// `profiles-seconds`, `profiles-sweeps`, of enough problems, and the table `profiles`: which method for which accuracy.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let methods = series(runs, &[]);
    let (mut parts, mut why) = (Vec::new(), String::new());
    let problems = problems(runs);
    if problems.len() < PROBLEMS {
        let there_are = counted(problems.len(), "problem");
        why = format!("A performance profile needs {PROBLEMS} problems; of {there_are} the table says all. ");
    } else if methods.len() > MOST_LINES {
        parts.push(too_many("profiles-found", "performance profiles", methods.len()));
    } else {
        for cost in &COSTS {
            parts.push(figure(runs, &methods, cost));
        }
    }
    let table = table(runs, &methods);
    let (set, repeats) = (problems.join(", "), repeats(runs));
    let note = format!(
        "\n{why}Problems: {set}. Reached: on so many of them the accuracy was reached. Best: with no method cheaper. \
         Median ratio: of the cost to the least, where reached. {repeats} {WORK}\n"
    );
    parts.push(Part::table("profiles", table, note));
    parts
}

/// For each method and problem the cost over the least one; `None` where the accuracy is not reached.
type Ratios = Vec<Vec<Option<f64>>>;

fn ratios(runs: &[RunRow], methods: &[Series], cost: &Cost, accuracy: f64) -> Ratios {
    let mut ratios = vec![Vec::new(); methods.len()];
    for problem in problems(runs) {
        let price = |method: &Series| {
            let run = method.runs.iter().find(|run| run.problem == problem)?;
            cost.to(run, accuracy)
        };
        let prices: Vec<Option<f64>> = methods.iter().map(price).collect();
        let least = span(prices.iter().copied().flatten()).map_or(0.0, |(least, _)| least);
        // A cost of 0 is the least, whatever others there are.
        let over_least = |price: f64| if price <= least { 1.0 } else { (price / least).min(f64::MAX) };
        for (of_method, price) in ratios.iter_mut().zip(prices) {
            of_method.push(price.map(over_least));
        }
    }
    ratios
}

fn figure(runs: &[RunRow], methods: &[Series], cost: &Cost) -> Part {
    let name = format!("profiles-{}", cost.name);
    let all = ACCURACIES.map(|accuracy| ratios(runs, methods, cost, accuracy));
    if all.iter().flatten().flatten().all(Option::is_none) {
        let why = "no run reaches a known velocity error of 10⁻² or less";
        return nothing(name, "performance profiles", why);
    }
    let not_reached = |(accuracy, ratios): (f64, &Ratios)| {
        let pairs = || ratios.iter().flatten();
        let not_reached = pairs().filter(|ratio| ratio.is_none()).count();
        format!("{} by {not_reached} of {}", accuracy_text(accuracy), pairs().count())
    };
    let not_reached: Vec<String> = ACCURACIES.into_iter().zip(&all).map(not_reached).collect();
    let title = vec![
        format!(
            "Share of {} solved within τ times the least cost, against τ.",
            counted(problems(runs).len(), "problem")
        ),
        format!("Cost: {}, to a velocity error of 10⁻², 10⁻⁴, 10⁻⁶.", cost.title),
        format!("Not reached, in pairs of method and problem: {}.", not_reached.join(", ")),
    ];
    let panels = ACCURACIES.into_iter().zip(&all).map(|(accuracy, ratios)| panel(methods, ratios, accuracy));
    let plot = Plot { title, panels: panels.collect(), ..Plot::default() };
    Part::figure(name, plot.svg())
}

/// Returns the end of the axis: the greatest ratio, or less (logarithm).
fn far(ratios: &Ratios) -> f64 {
    const FAR: f64 = 3.0;
    let greatest = ratios.iter().flatten().flatten().copied().fold(10.0, f64::max);
    greatest.log10().min(FAR) + 0.1
}

fn panel(methods: &[Series], ratios: &Ratios, accuracy: f64) -> Panel {
    let mut curves = Vec::new();
    for (k, (method, of_method)) in methods.iter().zip(ratios).enumerate() {
        let stairs = stairs(of_method, far(ratios));
        // Its sign where the line rises, at a height of its own: what is flat lies on what others have flat.
        let height = (k as f64 + 0.5) / methods.len() as f64 * stairs.last().map_or(0.0, |(_, share)| *share);
        let rises = |step: &&[(f64, f64)]| step[0].1 < height && height <= step[1].1;
        let sign = stairs.windows(2).find(rises).map(|step| (step[1].0, height));
        let bare = Look { mark: Mark::None, ..method.look };
        curves.push(Curve::of(method.label(), method.look, sign, Through::Nothing));
        curves.push(Curve::of(method.label(), bare, stairs, Through::Points));
    }
    let share = format!("share solved to {} (–)", accuracy_text(accuracy));
    let (x, y) = (Side::new(Scale::Ten, "τ (–)"), Side::new(Scale::Share, share));
    Panel::new(x, y.holding([0.0, 1.0]), curves)
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

fn table(runs: &[RunRow], methods: &[Series]) -> DataFrame {
    let problems = problems(runs).len() as u64;
    let mut rows = Vec::new();
    for accuracy in ACCURACIES {
        for cost in &COSTS {
            let ratios = ratios(runs, methods, cost, accuracy);
            for (method, of_method) in methods.iter().zip(&ratios) {
                let reached: Vec<f64> = of_method.iter().flatten().copied().collect();
                let best = reached.iter().filter(|ratio| **ratio <= 1.0).count() as u64;
                rows.push((accuracy, cost.name, method.label(), reached.len() as u64, best, median(reached)));
            }
        }
    }
    frame(df!(
        "velocity_error" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        "cost" => rows.iter().map(|row| row.1).collect::<Vec<_>>(),
        "method" => rows.iter().map(|row| row.2.as_str()).collect::<Vec<_>>(),
        "problems" => vec![problems; rows.len()],
        "reached" => rows.iter().map(|row| row.3).collect::<Vec<_>>(),
        "best" => rows.iter().map(|row| row.4).collect::<Vec<_>>(),
        "median_ratio" => rows.iter().map(|row| row.5).collect::<Vec<_>>(),
    ))
}
