//! Performance profiles (Dolan & Moré, Math. Program. 91 (2002) 201-213): the share of the problems that a method
//! solves within τ times the cost of the best one.

use std::collections::BTreeSet;

use contact::Measure;
use polars::df;
use polars::prelude::DataFrame;
use results::Median;

use crate::draw::{Curve, Look, MOST_LINES, Mark, Panel, Plot, Scale, Series, Side, Through, series};
use crate::read::{
    ACCURACIES, COSTS, Cost, Ending, Problems, RunRow, WORK, accuracy_text, counted, file_name, find_or_push,
    median, problems, repeats, span,
};
use crate::text::{Part, frame, nothing, too_many};

/// A share of fewer problems than this moves by too much with each of them to be drawn.
const PROBLEMS: usize = 10;

/// Problems whose profiles are drawn together.
struct Group<'r> {
    /// With or without friction, warm or not, where a study has both; empty elsewhere.
    words: String,
    runs: Vec<&'r RunRow>,
}

fn groups(runs: &[RunRow]) -> Vec<Group<'_>> {
    let words = |run: &RunRow| {
        let friction = run.friction().map(|mu| if mu > 0.0 { "with friction" } else { "without friction" });
        friction.into_iter().chain(run.warm_start.then_some("warm")).collect::<Vec<_>>().join(", ")
    };
    let mut groups: Vec<Group> = Vec::new();
    // A method that takes none of the problems has no share of them.
    for run in runs.iter().filter(|run| run.status != Ending::Skipped) {
        let words = words(run);
        let new = || Group { words: words.clone(), runs: Vec::new() };
        find_or_push(&mut groups, |group| group.words == words, new).runs.push(run);
    }
    if let [only] = &mut groups[..] {
        only.words.clear();
    }
    groups
}

/// `profiles-seconds`, `profiles-sweeps`, of enough problems, and the tables `profiles`, which method for which accuracy, and `pairs`, which
/// of two; with and without friction, and warm, apart.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let groups = groups(&study.runs);
    let is_known = |run: &RunRow| run.curve.iter().any(|point| point.velocity_error().is_some());
    let error = if study.runs.iter().any(is_known) { Measure::VelocityError } else { Measure::NaturalMap };
    let mut parts: Vec<Part> = groups.iter().flat_map(|group| figures(group, error)).collect();
    let few = groups.iter().any(|group| problems(group.runs.iter().copied()).len() < PROBLEMS);
    let why = if few || groups.is_empty() {
        format!("A performance profile needs {PROBLEMS} problems; of fewer the table says all. ")
    } else {
        String::new()
    };
    let note = format!(
        "\n{why}Reached: on so many of the problems the accuracy was reached. Best: the cheapest, or in seconds one whose \
         interval overlaps its own; undefined where none reaches it, or runs are repeated less than five times. \
         Median ratio: of the cost to the least, where reached. {} {WORK}\n",
        repeats(&study.runs)
    );
    parts.push(Part::table("profiles", table(&groups, error), note));
    parts.push(Part::table("pairs", pairs(&groups, error), PAIRS));
    parts
}

/// The profiles of a group, by the velocity error, or the natural map where that is not known of any run.
fn figures(group: &Group, error: Measure) -> Vec<Part> {
    let methods = series(group.runs.iter().copied(), &[]);
    if problems(group.runs.iter().copied()).len() < PROBLEMS {
        Vec::new()
    } else if methods.len() > MOST_LINES {
        vec![too_many(named("profiles-found", group), "performance profiles", methods.len())]
    } else {
        COSTS.iter().map(|cost| figure(group, &methods, cost, error)).collect()
    }
}

/// A name with the words of a group.
fn named(name: &str, group: &Group) -> String {
    if group.words.is_empty() { name.to_owned() } else { format!("{name}-{}", file_name(&group.words)) }
}

/// For each method and problem the cost over the least one; `None` where the accuracy is not reached.
type Ratios = Vec<Vec<Option<f64>>>;

fn ratios(group: &Group, methods: &[Series], cost: &Cost, (measure, accuracy): (Measure, f64)) -> Ratios {
    let mut ratios = vec![Vec::new(); methods.len()];
    for problem in problems(group.runs.iter().copied()) {
        let price = |method: &Series| {
            let run = method.runs.iter().find(|run| run.problem == problem)?;
            cost.to(run, measure, accuracy)
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

fn figure(group: &Group, methods: &[Series], cost: &Cost, error: Measure) -> Part {
    let name = named(&format!("profiles-{}", cost.name), group);
    let said = error.name().replace('_', " ");
    let all = ACCURACIES.map(|accuracy| ratios(group, methods, cost, (error, accuracy)));
    if all.iter().flatten().flatten().all(Option::is_none) {
        let why = format!("no run reaches a {said} of 10⁻² or less");
        return nothing(name, "performance profiles", &why);
    }
    let not_reached = |(accuracy, ratios): (f64, &Ratios)| {
        let pairs = || ratios.iter().flatten();
        let not_reached = pairs().filter(|ratio| ratio.is_none()).count();
        format!("{} by {not_reached} of {}", accuracy_text(accuracy), pairs().count())
    };
    let not_reached: Vec<String> = ACCURACIES.into_iter().zip(&all).map(not_reached).collect();
    let problems = counted(problems(group.runs.iter().copied()).len(), "problem");
    let of = if group.words.is_empty() { String::new() } else { format!(" {}", group.words) };
    let title = vec![
        format!("Share of {problems}{of} solved within τ times the least cost, against τ."),
        format!("Cost: {}, to a {said} of 10⁻², 10⁻⁴, 10⁻⁶.", cost.title),
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

fn table(groups: &[Group], measure: Measure) -> DataFrame {
    let mut rows = Vec::new();
    for (group, accuracy, cost) in groups
        .iter()
        .flat_map(|group| ACCURACIES.map(|a| COSTS.iter().map(move |cost| (group, a, cost))))
        .flatten()
    {
        let problems = problems(group.runs.iter().copied());
        let methods = series(group.runs.iter().copied(), &[]);
        let ratios = ratios(group, &methods, cost, (measure, accuracy));
        let on = |problem: &&str| -> Vec<&RunRow> {
            group.runs.iter().copied().filter(|run| run.problem == *problem).collect()
        };
        let first = problems.iter().flat_map(|problem| cost.least(&on(problem), measure, accuracy));
        let first: BTreeSet<u32> = first.map(|run| run.run).collect();
        for (method, of_method) in methods.iter().zip(&ratios) {
            let reached: Vec<f64> = of_method.iter().flatten().copied().collect();
            let best = method.runs.iter().filter(|run| first.contains(&run.run)).count() as u64;
            rows.push(Row {
                words: &group.words,
                accuracy,
                cost: cost.name,
                method: method.label(),
                problems: problems.len() as u64,
                reached: reached.len() as u64,
                best: (!first.is_empty()).then_some(best),
                ratio: median(reached),
            });
        }
    }
    frame(df!(
        measure.name() => rows.iter().map(|row| row.accuracy).collect::<Vec<_>>(),
        "cost" => rows.iter().map(|row| row.cost).collect::<Vec<_>>(),
        "method" => rows.iter().map(|row| row.method.as_str()).collect::<Vec<_>>(),
        "problems" => rows.iter().map(|row| row.problems).collect::<Vec<_>>(),
        "reached" => rows.iter().map(|row| row.reached).collect::<Vec<_>>(),
        "best" => rows.iter().map(|row| row.best).collect::<Vec<_>>(),
        "median_ratio" => rows.iter().map(|row| row.ratio).collect::<Vec<_>>(),
        "problems_of" => rows.iter().map(|row| row.words).collect::<Vec<_>>(),
    ))
}

/// Meaning of the columns of pairs.
const PAIRS: &str = "\nOn so many problems, of those that both were run on, the method is faster to the accuracy than the other by more than \
                     the intervals of both times, or reaches it alone (wins); no difference shows (ties); the other is (losses); or \
                     neither reaches it. A profile measures each method against the fastest of all, and changes with who else is in it; \
                     a pair does not.\n";

/// Two methods on the problems that both were run on.
pub(crate) struct Pair {
    pub(crate) method: String,
    pub(crate) against: String,
    pub(crate) problems: u64,
    /// Problems that the method wins, that are ties, and that it loses; on the others neither reaches the accuracy.
    pub(crate) counts: [u64; 3],
}

/// Compares every two methods of some runs by their seconds to an accuracy of a measure.
pub(crate) fn paired<'r>(
    runs: impl IntoIterator<Item = &'r RunRow>,
    (measure, accuracy): (Measure, f64),
) -> Vec<Pair> {
    let runs: Vec<&RunRow> = runs.into_iter().filter(|run| run.status != Ending::Skipped).collect();
    let (methods, problems) = (series(runs.iter().copied(), &[]), problems(runs.iter().copied()));
    let times = |method: &Series| -> Vec<Option<Option<Median>>> {
        let on = |problem: &&str| method.runs.iter().find(|run| run.problem == **problem);
        problems.iter().map(|at| on(at).map(|run| COSTS[0].within(run, measure, accuracy))).collect()
    };
    let all: Vec<(String, Vec<_>)> = methods.iter().map(|of| (of.label(), times(of))).collect();
    let pair = |(method, own): &(String, Vec<_>), (against, others): &(String, Vec<_>)| {
        let mut pair = Pair { method: method.clone(), against: against.clone(), problems: 0, counts: [0; 3] };
        for (own, other) in own.iter().zip(others).filter_map(|(a, b): (&Option<_>, &Option<_>)| a.zip(*b)) {
            let wins = |a: Option<Median>, b: Option<Median>| {
                a.is_some_and(|a| b.is_none_or(|b: Median| a.high < b.low))
            };
            pair.problems += 1;
            let place = if wins(own, other) { 0 } else { 1 + usize::from(wins(other, own)) };
            if own.is_some() || other.is_some() {
                pair.counts[place] += 1;
            }
        }
        pair
    };
    all.iter().flat_map(|a| all.iter().filter(|b| a.0 != b.0).map(|b| pair(a, b))).collect()
}

/// Makes the table `pairs`, each pair once.
fn pairs(groups: &[Group], measure: Measure) -> DataFrame {
    let mut rows: Vec<(&str, f64, Pair)> = Vec::new();
    for (group, accuracy) in groups.iter().flat_map(|group| ACCURACIES.map(|accuracy| (group, accuracy))) {
        let all = paired(group.runs.iter().copied(), (measure, accuracy));
        let each = all.into_iter().filter(|pair| pair.method < pair.against);
        rows.extend(each.map(|pair| (group.words.as_str(), accuracy, pair)));
    }
    let count = |k: usize| rows.iter().map(|(_, _, pair)| pair.counts[k]).collect::<Vec<_>>();
    frame(df!(
        measure.name() => rows.iter().map(|row| row.1).collect::<Vec<_>>(),
        "method" => rows.iter().map(|row| row.2.method.as_str()).collect::<Vec<_>>(),
        "against" => rows.iter().map(|row| row.2.against.as_str()).collect::<Vec<_>>(),
        "problems" => rows.iter().map(|row| row.2.problems).collect::<Vec<_>>(),
        "wins" => count(0),
        "ties" => count(1),
        "losses" => count(2),
        "neither" => rows.iter().map(|row| row.2.problems - row.2.counts.iter().sum::<u64>()).collect::<Vec<_>>(),
        "problems_of" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
    ))
}

/// A row of the table.
struct Row<'g> {
    words: &'g str,
    accuracy: f64,
    cost: &'static str,
    method: String,
    problems: u64,
    reached: u64,
    /// `None` where none is ranked.
    best: Option<u64>,
    ratio: Option<f64>,
}
