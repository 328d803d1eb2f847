//! Iterations, the longest subdomain and time, with as many grains in each subdomain however many there are.

use super::scaling::{grains_per_subdomain, path, table, with_path};
use super::subdomains::{Panel, figure};
use crate::draw::{DASHES, Look, Looks, Pen, Series, series};
use crate::read::{Problems, RunRow, counted, find_or_push, stopped_at_1e_2};
use crate::text::{Part, nothing};

/// Iterations to 10⁻² are left out where that is what all runs were stopped at.
fn panels(runs: &[&RunRow]) -> Vec<Panel> {
    let per_grain =
        |_: &Series, run: &RunRow| Some(1e9 * run.seconds_per_iteration()? / f64::from(run.grains));
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
    let names = "method grains_per_subdomain subdomains grains status to_natural_map_1e_2 iterations growth \
                 longest_subdomain seconds_per_iteration";
    let table = table(&all, names, |_, _| true);
    let figure = drawn(all, &Looks::new(runs.iter().copied()), &panels(&runs));
    vec![figure, Part::table("weak", table, NOTE)]
}

/// Of all runs of a series.
fn each(series: &Series) -> f64 {
    grains_per_subdomain(series.runs[0])
}

/// Runs that agree in their settings and in their grains per subdomain, with at least two numbers of subdomains.
fn all<'r>(runs: &[&'r RunRow]) -> Vec<Series<'r>> {
    let mut all = Vec::new();
    for mut whole in series(runs.iter().copied(), &["subdomains"]) {
        let mut runs = std::mem::take(&mut whole.runs);
        runs.sort_by_key(|run| run.subdomains);
        runs.sort_by(|a, b| grains_per_subdomain(a).total_cmp(&grains_per_subdomain(b)));
        let alike = runs.chunk_by(|a, b| grains_per_subdomain(a) == grains_per_subdomain(b));
        let several = alike.filter(|runs| runs[0].subdomains < runs[runs.len() - 1].subdomains);
        all.extend(several.map(|runs| Series { runs: runs.to_vec(), ..whole.clone() }));
    }
    all.sort_by(|a, b| a.method.cmp(b.method).then(a.group.cmp(&b.group)).then(each(a).total_cmp(&each(b))));
    all
}

/// The figure of the numbers of grains per subdomain that come most often, as many as there are dashes.
fn drawn(mut all: Vec<Series>, looks: &Looks, panels: &[Panel]) -> Part {
    let mut often: Vec<(f64, usize)> = Vec::new();
    for series in &all {
        find_or_push(&mut often, |(of, _)| *of == each(series), || (each(series), 0)).1 += series.runs.len();
    }
    often.sort_by(|(a, m), (b, n)| n.cmp(m).then(a.total_cmp(b)));
    often.truncate(DASHES.len());
    all.retain(|series| often.iter().any(|(of, _)| *of == each(series)));
    if all.is_empty() {
        let why = "no number of grains per subdomain comes with several numbers of subdomains";
        return nothing("weak-found", "weak", why);
    }
    let one_method = all.windows(2).all(|pair| pair[0].method == pair[1].method);
    let runs: usize = all.iter().map(|series| series.runs.len()).sum();
    let series = all.into_iter().enumerate().map(|(i, series)| {
        let each = each(&series);
        let rank = often.iter().filter(|(of, _)| *of < each).count();
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
