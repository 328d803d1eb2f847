//! Iterations, the longest subdomain and time, with as many grains in each subdomain however many there are.

use super::declared::WEAK;
use super::scaling::{grains_per_subdomain, with_path};
use crate::draw::{DASHES, Look, Looks, Pen, Series, series};
use crate::read::{Problems, RunRow, counted, find_or_push};
use crate::text::{Part, nothing};

/// The figure `weak`, and the table of all runs whose grains per subdomain come with several numbers of subdomains.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = with_path(study);
    let all = all(&runs);
    let table = WEAK.table(&all, |_, _| true);
    vec![drawn(all, &study.runs), table]
}

/// Returns the grains per subdomain of all runs of a series.
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
fn drawn(mut all: Vec<Series>, rows: &[RunRow]) -> Part {
    let looks = Looks::new(all.iter().flat_map(|series| series.runs.iter().copied()));
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
    WEAK.figure("weak".to_owned(), &[title], &series.collect::<Vec<_>>(), rows)
}
