//! Convergence, and the cost of subdomains: iterations to an accuracy over those of the method without them.

use contact::Measure;

use super::declared::CONVERGENCE;
use crate::draw::{
    At, Guide, Line, Lines, LogPoint, MOST_LINES, Panel, Plot, Scale, Side, Sign, TOLERANCE, title,
};
use crate::read::{Ending, LEAST, Problems, RunRow, file_name, first, problems, unique, without_subdomains};
use crate::text::Part;

/// The panels and the names of their axes.
pub(super) const MEASURES: [(Measure, &str); 2] =
    [(Measure::Zeta, "ζ reached (–)"), (Measure::NaturalMap, "natural map reached (–)")];
const RATIO: &str = "iterations over those without subdomains (–)";

/// The least axis (in logarithms): less would show differences that are none.
const NARROWEST: [f64; 2] = [-0.02, 0.222];

/// The figures `convergence`, and `ratios-<problem>` for each problem.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let mut parts = CONVERGENCE.parts(study);
    let lines = Lines::of(&study.runs);
    parts.extend(problems(&study.runs).into_iter().filter_map(|problem| figure(&lines, problem)));
    parts
}

/// `ratios-<problem>`; nothing where no run has another to be compared with.
fn figure(study: &Lines, problem: &str) -> Option<Part> {
    let runs = study.runs_of(problem);
    let pairs: Vec<(&RunRow, &RunRow)> =
        runs.iter().filter_map(|run| Some((*run, without_subdomains(run, &runs)?))).collect();
    let panels = MEASURES.map(|(measure, name)| panel(study, &pairs, measure, name));
    let drawn = |i: usize| panels.iter().any(|panel| !panel.lines[i].points.is_empty());
    let shown: Vec<&RunRow> = (0..pairs.len()).filter(|&i| drawn(i)).map(|i| pairs[i].0).collect();
    if shown.is_empty() || shown.len() > MOST_LINES {
        return None;
    }
    let (title, signs) = (vec![title(problem, &shown)], words(&shown));
    let svg = Plot { title, panels: panels.into(), signs, ..Plot::default() }.svg();
    let caption =
        format!("{problem}: iterations with subdomains over those without, against the accuracy reached.");
    Some(Part::figure(format!("ratios-{}", file_name(problem)), svg).captioned(caption))
}

fn panel(study: &Lines, pairs: &[(&RunRow, &RunRow)], measure: Measure, name: &str) -> Panel {
    let line = |&(run, base): &(&RunRow, &RunRow)| {
        let (points, ending) = ratios(run, base, measure);
        Line { label: run.label(), look: study.looks.look(run), ending, points }
    };
    let (x, y) = (Side::new(Scale::Ten, name), Side::new(Scale::Ten, RATIO).holding(NARROWEST));
    let panel =
        Panel::new(x, y, Vec::new()).guided([Guide::new(At::Y(0.0), TOLERANCE, "as many iterations")]);
    Panel { lines: pairs.iter().map(line).collect(), ..panel }
}

/// Logarithms of accuracies that both reach, ten to a decade, and of the ratio of iterations; and how the run ended that does
/// not reach the next. Of curves with gaps the whole decades alone, which are kept exactly.
fn ratios(run: &RunRow, base: &RunRow, measure: Measure) -> (Vec<LogPoint>, Ending) {
    let step = if has_gaps(run) || has_gaps(base) { 10 } else { 1 };
    let mut points = Vec::new();
    for tenth in (-20..=120).filter(|tenth| tenth % step == 0) {
        let log = -f64::from(tenth) / 10.0;
        let Some(of_base) = first(&base.curve, measure, log) else { return (points, base.status) };
        let Some(of_run) = first(&run.curve, measure, log) else { return (points, run.status) };
        if of_base >= LEAST {
            points.push(Some((log, (of_run as f64 / of_base as f64).log10())));
        }
    }
    (points, run.status)
}

/// Reports whether two neighbouring points of a curve are more than one iteration and 2 % apart.
fn has_gaps(run: &RunRow) -> bool {
    run.curve.windows(2).any(|pair| pair[1].iteration * 100 > pair[0].iteration * 102 + 100)
}

/// Says which runs the shown ones are compared with.
fn words(shown: &[&RunRow]) -> Vec<(Sign, String)> {
    let others = unique(shown.iter().map(|run| (run.method.as_str(), run.without_subdomains())));
    let apart = others.iter().filter(|(method, whole)| method != whole);
    let mut words: Vec<String> = apart.map(|(method, whole)| format!("{method}: over {whole}.")).collect();
    if others.len() > words.len() {
        let who = if words.is_empty() { "Each" } else { "Others" };
        words.push(format!("{who}: over the same method on one subdomain."));
    }
    words.push(format!("Shown from iteration {LEAST} of these."));
    words.into_iter().map(|text| (Sign::Word, text)).collect()
}

#[cfg(test)]
mod tests;
