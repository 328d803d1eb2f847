//! The table of directions: the best of a field beside the derived ones.

use polars::df;
use polars::prelude::DataFrame;

use super::field::{Field, iterations, kappa};
use crate::read::Ending;
use crate::text::frame;

/// One row per problem, μ and group.
pub(crate) fn table(fields: &[Field]) -> DataFrame {
    let best =
        |of: fn(&super::field::Cell) -> f64| fields.iter().map(|f| f.best().map(of)).collect::<Vec<_>>();
    let count = |ending| fields.iter().map(|f| f.count(ending) as u64).collect::<Vec<_>>();
    let others = |f: &Field| {
        let counted: usize = [Ending::Converged, Ending::Diverged, Ending::IterationLimit, Ending::Skipped]
            .into_iter()
            .map(|ending| f.count(ending))
            .sum();
        (f.cells.len() - counted) as u64
    };
    frame(df!(
        "problem" => fields.iter().map(|f| f.problem).collect::<Vec<_>>(),
        "grains" => fields.iter().map(|f| f.grains).collect::<Vec<_>>(),
        "method" => fields.iter().map(|f| f.method).collect::<Vec<_>>(),
        "relaxation" => fields.iter().map(|f| f.relaxation).collect::<Vec<_>>(),
        "group" => fields.iter().map(|f| f.group.as_str()).collect::<Vec<_>>(),
        "subdomains" => fields.iter().map(|f| f.subdomains).collect::<Vec<_>>(),
        "best_kappa_l" => best(|cell| cell.kappa_l),
        "best_kappa_d" => best(|cell| cell.kappa_d),
        "at_edge" => fields.iter().map(Field::edge).collect::<Vec<_>>(),
        "best_iterations" => fields.iter().map(|f| f.best().map(|c| c.run.iterations)).collect::<Vec<_>>(),
        "derived_kappa_l" => fields.iter().map(|f| f.kappa.map(|(l, _)| l)).collect::<Vec<_>>(),
        "derived_kappa_d" => fields.iter().map(|f| f.kappa.map(|(_, d)| d)).collect::<Vec<_>>(),
        "derived_status" => fields.iter().map(|f| f.derived.map(|run| run.ending.text())).collect::<Vec<_>>(),
        "derived_iterations" => fields.iter().map(|f| iterations(f.derived)).collect::<Vec<_>>(),
        "derived_over_best" => fields.iter().map(|f| f.ratio(f.derived)).collect::<Vec<_>>(),
        "adaptive_kappa_l" =>
            fields.iter().map(|f| f.adaptive.and_then(|run| kappa(run, "kappa_l_minus"))).collect::<Vec<_>>(),
        "adaptive_iterations" => fields.iter().map(|f| iterations(f.adaptive)).collect::<Vec<_>>(),
        "adaptive_over_best" => fields.iter().map(|f| f.ratio(f.adaptive)).collect::<Vec<_>>(),
        "runs" => fields.iter().map(|f| f.cells.len() as u64).collect::<Vec<_>>(),
        "diverged" => count(Ending::Diverged),
        "iteration_limit" => count(Ending::IterationLimit),
        "skipped" => count(Ending::Skipped),
        "other_failures" => fields.iter().map(others).collect::<Vec<_>>(),
    ))
}

/// Meaning of its columns.
pub(crate) const NOTE: &str = "\nIterations are those to the stop rule of the plan. Best: the fewest among the converged runs with given \
                               directions; `at_edge` says which of them is the least or greatest of the grid, which may then hold \
                               no best at all. Derived: the run of the same method that derives its own; none where it did not \
                               converge. Adaptive: the run that begins with them and adapts them; its κ_l is the last.\n";
