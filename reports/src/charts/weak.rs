//! Iterations, the longest subdomain and time, with as many grains in each subdomain however many there are.

use std::collections::{BTreeMap, BTreeSet};

use polars::df;
use polars::prelude::DataFrame;

use super::critical_path::with_path;
use crate::charts::critical_path::path;
use crate::charts::subdomains::{Panel, figure, growth, seconds_per_iteration};
use crate::draw::{DASHES, Look, Looks, Pen, Series, series};
use crate::read::{Problems, RunRow, counted, stopped_at_1e_2};
use crate::text::{Part, frame, nothing};

/// Iterations to 10⁻² are left out where that is what all runs were stopped at.
fn panels(runs: &[&RunRow]) -> Vec<Panel> {
    let per_grain =
        |_: &Series, run: &RunRow| Some(1e9 * seconds_per_iteration(run)? / f64::from(run.grains));
    let others = [
        Panel::iterations(),
        Panel::new("longest subdomain (multiply-adds)", |_, run| path(run)),
        Panel { on_the_way: true, ..Panel::new("time per iteration and grain (ns)", per_grain) },
    ];
    let first = (!stopped_at_1e_2(runs.iter().copied())).then(Panel::iterations_to_1e_2);
    first.into_iter().chain(others).collect()
}

const NOTE: &str = "\nThe longest subdomain: its multiply-adds in all iterations, exchange with its neighbours included; with a \
                    machine per subdomain the time to the tolerance goes with it, and constant is ideal. Growth: iterations over \
                    those with the fewest subdomains, as many grains in each.\n";

/// The figure `weak`, and the table of all runs whose grains per subdomain come with several numbers of subdomains.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = with_path(study);
    let all = all(&runs);
    let figure = drawn(all.clone(), &Looks::new(runs.iter().copied()), &panels(&runs));
    vec![figure, Part::table("weak", table(&all), NOTE)]
}

/// Runs that agree in their settings and in their grains per subdomain, with at least two numbers of subdomains.
fn all<'r>(runs: &[&'r RunRow]) -> Vec<(f64, Series<'r>)> {
    let mut all = Vec::new();
    for whole in series(runs.iter().copied(), &["subdomains"]) {
        // Equal ratios have equal bits.
        let mut by_each: BTreeMap<u64, Vec<&RunRow>> = BTreeMap::new();
        for run in &whole.runs {
            let each = f64::from(run.grains) / f64::from(run.subdomains);
            by_each.entry(each.to_bits()).or_default().push(run);
        }
        for (each, runs) in by_each {
            let counts: BTreeSet<u32> = runs.iter().map(|run| run.subdomains).collect();
            if counts.len() > 1 {
                all.push((f64::from_bits(each), Series { runs, ..whole.clone() }));
            }
        }
    }
    all.sort_by(|(a, x), (b, y)| x.method.cmp(y.method).then(x.group.cmp(&y.group)).then(a.total_cmp(b)));
    all
}

/// The figure of the numbers of grains per subdomain that come most often, as many as there are dashes.
fn drawn(mut all: Vec<(f64, Series)>, looks: &Looks, panels: &[Panel]) -> Part {
    let mut often: BTreeMap<u64, usize> = BTreeMap::new();
    for (each, series) in &all {
        *often.entry(each.to_bits()).or_default() += series.runs.len();
    }
    let mut often: Vec<(f64, usize)> =
        often.into_iter().map(|(each, runs)| (f64::from_bits(each), runs)).collect();
    often.sort_by_key(|(_, runs)| std::cmp::Reverse(*runs));
    often.truncate(DASHES.len());
    often.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    all.retain(|(each, _)| often.iter().any(|(of, _)| of == each));
    if all.is_empty() {
        let why = "no number of grains per subdomain comes with several numbers of subdomains";
        return nothing("weak-found", "weak", why);
    }
    let one_method = all.windows(2).all(|pair| pair[0].1.method == pair[1].1.method);
    let runs: usize = all.iter().map(|(_, series)| series.runs.len()).sum();
    let series = all.into_iter().enumerate().map(|(i, (each, series))| {
        let rank = often.iter().take_while(|(of, _)| *of < each).count();
        let look = if one_method { looks.variant_alone(series.method, i).signed() } else { series.look };
        let look = Look { pen: Pen { dash: DASHES[rank], ..look.pen }, ..look };
        let each = format!("{each} grains each");
        let group = if series.group.is_empty() { each } else { format!("{}, {each}", series.group) };
        Series { group, look, ..series }
    });
    let title =
        format!("{}; the number of grains in each subdomain is the same along a line.", counted(runs, "run"));
    figure("weak".to_owned(), title, &series.collect::<Vec<_>>(), panels, Vec::new())
}

/// One row per run.
fn table(all: &[(f64, Series)]) -> DataFrame {
    let rows: Vec<(f64, &Series, &RunRow)> = all
        .iter()
        .flat_map(|(each, series)| {
            let mut runs = series.runs.clone();
            runs.sort_by_key(|run| run.subdomains);
            runs.into_iter().map(move |run| (*each, series, run))
        })
        .collect();
    frame(df!(
        "method" => rows.iter().map(|(_, series, _)| series.label()).collect::<Vec<_>>(),
        "grains_per_subdomain" => rows.iter().map(|(each, ..)| *each).collect::<Vec<_>>(),
        "subdomains" => rows.iter().map(|(.., run)| run.subdomains).collect::<Vec<_>>(),
        "grains" => rows.iter().map(|(.., run)| run.grains).collect::<Vec<_>>(),
        "status" => rows.iter().map(|(.., run)| run.ending.text()).collect::<Vec<_>>(),
        "to_natural_map_1e_2" => rows.iter().map(|(.., run)| run.iterations_to_natural_map_1e_2).collect::<Vec<_>>(),
        "iterations" => rows.iter().map(|(.., run)| run.iterations).collect::<Vec<_>>(),
        "growth" => rows.iter().map(|(_, series, run)| growth(run, series.runs.iter().copied())).collect::<Vec<_>>(),
        "longest_subdomain" => rows.iter().map(|(.., run)| path(run)).collect::<Vec<_>>(),
        "seconds_per_iteration" => rows.iter().map(|(.., run)| seconds_per_iteration(run)).collect::<Vec<_>>(),
    ))
}
