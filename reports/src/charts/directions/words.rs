//! The words of the maps.

use super::field::{Field, iterations};
use crate::draw::{BEST, DERIVED, Mark, Sign, endings};
use crate::read::{Ending, count, counted};

/// Which panel it is.
pub(super) fn title(field: &Field) -> [String; 1] {
    let group = if field.group.is_empty() {
        counted(field.subdomains as usize, "subdomain")
    } else {
        field.group.clone()
    };
    [format!("{group}, relaxation {}", field.relaxation)]
}

/// Iterations of the best, and how many times as many the derived and the adapted directions take.
pub(super) fn notes(field: &Field) -> Vec<String> {
    let best = field.best().map_or_else(
        || "none converged".to_owned(),
        |cell| {
            format!(
                "best on grid {}{}",
                count(cell.run.iterations as usize),
                if field.edge().is_some() { "*" } else { "" }
            )
        },
    );
    let cost = |run| match (iterations(run), field.ratio(run)) {
        (Some(iterations), Some(ratio)) => format!("{} (×{ratio:.2})", count(iterations as usize)),
        (Some(iterations), None) => count(iterations as usize),
        (None, _) => "failed".to_owned(),
    };
    let line = |word, run: Option<_>| run.map(|run| format!("{word} {}", cost(Some(run))));
    let derived = line("derived", field.derived).unwrap_or_else(|| "derived not run".to_owned());
    let alone = field.is_plane() && field.subdomains == 1;
    let no_effect = alone.then(|| "κ_d has no effect".to_owned());
    [Some(best), Some(derived), line("adapted", field.adaptive), no_effect].into_iter().flatten().collect()
}

/// Returns the title: the content of the figure, and the number of failed runs.
pub(super) fn head(problem: &str, fields: &[&Field]) -> [String; 2] {
    let method = fields[0].method;
    let rule = fields[0].cells.first().and_then(|cell| cell.run.rule());
    let stop = rule.map_or(String::new(), |rule| format!(" to {rule}"));
    let runs = fields.iter().map(|f| f.cells.len()).sum();
    let mut counts = vec![counted(runs, "run")];
    for (ending, text) in Ending::ALL.into_iter().filter(|(ending, _)| *ending != Ending::Converged) {
        let number: usize = fields.iter().map(|f| f.count(ending)).sum();
        if number > 0 {
            counts.push(format!("{} {text}", count(number)));
        }
    }
    [format!("{problem}, {method}: iterations{stop}, over the search directions"), counts.join(", ")]
}

/// The key.
pub(super) fn signs(fields: &[&Field]) -> Vec<(Sign, String)> {
    let mut signs = Vec::new();
    if fields.iter().any(|f| f.best().is_some()) {
        signs.push((Sign::Mark(Mark::Square, BEST), "best on the grid".to_owned()));
    }
    if fields.iter().any(|f| f.kappa.is_some()) {
        let text = "derived directions, between the cells; ×: iterations over those of the best on the grid"
            .to_owned();
        signs.push((Sign::Mark(Mark::Diamond, DERIVED), text));
    }
    if fields.iter().any(|f| f.adaptive.is_some()) {
        let text = "adapted: begun with the derived directions; it has no cell of its own".to_owned();
        signs.push((Sign::Word, text));
    }
    if fields.iter().any(|f| f.edge().is_some()) {
        signs.push((Sign::Word, "* at the edge of the grid: there may be better beyond".to_owned()));
    }
    let cells = fields.iter().flat_map(|f| &f.cells).map(|cell| cell.run.ending);
    signs.extend(endings(cells.filter(|ending| *ending != Ending::Converged)));
    signs
}
