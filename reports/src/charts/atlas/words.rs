//! One sentence for each region where a method fails: how, why, and what mends it.

use super::cause::{Cause, causes};
use super::class::Class;
use super::hazard::Hazard;
use super::{Judged, Kind, find};
use crate::read::{counted, number};

/// Returns the sentences on each method, and the meaning of the classes.
pub(super) fn text(judged: &[Judged], hazards: &[Hazard], kinds: &[Kind]) -> String {
    let mut text = String::new();
    for kind in kinds {
        let sentences: Vec<String> =
            hazards.iter().filter_map(|hazard| region(judged, hazard, kind)).collect();
        match sentences.as_slice() {
            [] => text.extend([kind.method, ": no setting of the plan fails on any hazard.\n"]),
            sentences => {
                text.extend(sentences.iter().map(|sentence| format!("{}, {sentence}\n", kind.method)));
            }
        }
        let mut skipped = judged.iter().filter(|j| j.run.method == kind.method && j.class == Class::Skipped);
        if let Some(first) = skipped.next() {
            let runs = counted(1 + skipped.count(), "run");
            let (method, reason) = (kind.method, &first.run.reason);
            text.extend([method, ", skipped ", &runs, ": ", reason, "; and alike, as the table says.\n"]);
        }
    }
    text + &zeta(judged)
}

/// Meaning of the classes and the letters.
pub(super) const RULE: &str = "\nConverged: the measure met the tolerance; false convergence: it did, with a velocity error of more than 100 \
tolerances, or where there is no solution. Infeasible: it was proved that there is no solution; failed: it was claimed, and \
there is one. Slow: all iterations were made, and the least measure of \
their second half is at least 1 % below that of the first; stalled: it is not. Diverged: not finite, or an energy beyond all \
scales. Skipped: the method cannot start, and says why. W_D is the diagonal of W; λ̃ are eigenvalues of W_D⁻¹W over the \
contacts that the solution keeps closed, κ_opt = 1/√(λ̃min λ̃max); W_off is what of W couples contacts of different \
subdomains. All are computed, where the contacts are few enough; elsewhere λmax is a lower bound by power iteration.\n";

/// A setting that fails on a hazard: its classes with their numbers of problems, and its causes with their ranges.
struct Failing {
    setting: String,
    how: String,
    why: String,
}

/// Describes a method on a hazard; `None` where all its settings do well.
fn region(judged: &[Judged], hazard: &Hazard, kind: &Kind) -> Option<String> {
    let mut groups: Vec<(Vec<String>, String, String)> = Vec::new();
    let mut good = Vec::new();
    for variant in &kind.variants {
        let runs: Vec<&Judged> = hazard
            .problems
            .iter()
            .filter_map(|problem| find(judged, kind.method, variant, problem))
            .collect();
        let begun: Vec<&Judged> = runs.into_iter().filter(|run| run.class != Class::Skipped).collect();
        let failing: Vec<&Judged> = begun.iter().copied().filter(|run| !run.class.is_good()).collect();
        if failing.is_empty() {
            good.extend((!begun.is_empty()).then(|| kind.label(variant)));
            continue;
        }
        let Failing { setting, how, why } = failing_of(judged, &failing, begun.len(), kind.label(variant));
        match groups.iter_mut().find(|(_, h, w)| *h == how && *w == why) {
            Some((settings, ..)) => settings.push(setting),
            None => groups.push((vec![setting], how, why)),
        }
    }
    if groups.is_empty() {
        return None;
    }
    let group = |(settings, how, why): &(Vec<String>, String, String)| {
        format!("{}: {how} ({why})", settings.join(", "))
    };
    let failures = groups.iter().map(group).collect::<Vec<_>>().join("; ");
    let knob = if hazard.knob.is_empty() { String::new() } else { format!(" ({})", hazard.knob) };
    let mends = match good.as_slice() {
        [] => "No setting of the plan does well on all of it.".to_owned(),
        good => format!("Well on all of it: {}.", good.join(", ")),
    };
    Some(format!("{}{knob}: {failures}. {mends}", hazard.name))
}

fn failing_of(judged: &[Judged], failing: &[&Judged], problems: usize, setting: String) -> Failing {
    let classes = Class::ALL.into_iter().filter_map(|(class, text, _)| {
        let count = failing.iter().filter(|run| run.class == class).count();
        let of = if problems == 1 { String::new() } else { format!(" on {count} of {problems}") };
        (count > 0).then(|| format!("{text}{of}"))
    });
    Failing { setting, how: classes.collect::<Vec<_>>().join(", "), why: why(judged, failing) }
}

/// Causes of the same words are one, with the range of their numbers.
fn why(judged: &[Judged], failing: &[&Judged]) -> String {
    let mut ranges: Vec<(Cause, f64, f64)> = Vec::new();
    let (mut unsolvable, mut unknown) = (0, 0);
    for run in failing {
        let mut of_problem = judged.iter().filter(|other| other.run.problem == run.run.problem);
        if of_problem.any(|other| other.class == Class::Infeasible) {
            unsolvable += 1;
            continue;
        }
        let causes = causes(run);
        unknown += usize::from(causes.is_empty());
        for cause in causes {
            match ranges.iter_mut().find(|(c, ..)| (c.before, c.after) == (cause.before, cause.after)) {
                Some((_, low, high)) => (*low, *high) = (low.min(cause.value), high.max(cause.value)),
                None => ranges.push((cause, cause.value, cause.value)),
            }
        }
    }
    let mut words = Vec::new();
    if unsolvable > 0 {
        words.push("there is no solution, as other runs prove".to_owned());
    }
    words.extend(ranges.into_iter().map(|(cause, low, high)| {
        let (low, high) = (number(low, 3), number(high, 3));
        let range = if low == high { low } else { format!("{low} to {high}") };
        format!("{}{range}{}", cause.before, cause.after)
    }));
    if unknown > 0 {
        let of = if unknown == failing.len() { String::new() } else { format!(" for {unknown}") };
        words.push(format!("no spectral reason is known{of}"));
    }
    words.join("; ")
}

/// Counts the runs in which ζ met the tolerance wrongly.
fn zeta(judged: &[Judged]) -> String {
    let begun: Vec<&Judged> = judged.iter().filter(|run| run.class != Class::Skipped).collect();
    let lies = begun.iter().filter(|run| run.zeta_lies).count();
    format!(
        "ζ met the tolerance at an iterate with a velocity error of more than 100 tolerances, or of a problem without solution, in {} of {}.\n",
        lies,
        counted(begun.len(), "run")
    )
}
