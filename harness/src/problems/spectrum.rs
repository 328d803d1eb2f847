//! What a row says of the spectrum of its problem, and of the partition of its run.

use crate::plan::variants::Variant;
use crate::problems::reference::Known;
use analysis::{Spectrum, coupling};
use contact::{ContactProblem, Packing};
use partition::{Decomposition, Partition};
use serde_json::{Map, Value, json};

/// A contact that opens at less than this share of the greatest |b| is closed (–): references are certified to 1e-12, and come
/// near it where they are not.
const CLOSED: f64 = 1e-8;

/// The eigenvalues of `problem`, of which `known` gives the closed contacts, if it does.
pub(crate) fn of_problem(problem: &ContactProblem, known: &Known) -> Map<String, Value> {
    let closed = known.nearest().map(|truth| {
        let mut v = vec![0.0; problem.contact_count()];
        problem.relative_velocity(truth.velocity(), &mut v);
        let greatest = problem.b().iter().fold(0.0_f64, |greatest, b| greatest.max(b.abs()));
        v.iter().map(|v| *v <= CLOSED * greatest).collect::<Vec<_>>()
    });
    let spectrum = Spectrum::of(problem, closed.as_deref());
    let mut columns = Map::from_iter([("lambda_max".to_owned(), json!(spectrum.greatest))]);
    if let Some(closed) = spectrum.closed {
        columns.extend([
            ("closed_lambda_max".to_owned(), json!(closed.greatest)),
            ("closed_lambda_min".to_owned(), json!(closed.least)),
            ("redundant".to_owned(), json!(closed.redundant)),
            ("kappa_opt".to_owned(), json!(closed.best_direction())),
        ]);
    }
    columns
}

/// What the partition of a run adds: the most copies of a grain and, where masses are whole, how strongly subdomains act
/// on each other.
pub(crate) fn of_partition(problem: &Packing, variant: &Variant) -> Map<String, Value> {
    let Some((grid, scheme)) = variant.partition() else { return Map::new() };
    // A run with a partition that does not fit the problem is skipped, and says why.
    let Ok(partition) = Partition::of_contacts(problem, scheme, grid) else { return Map::new() };
    let multiplicity = Decomposition::new(problem, &partition).multiplicity.iter().copied().max();
    let mut columns = Map::from_iter([("multiplicity".to_owned(), json!(multiplicity))]);
    if variant.setting::<bool>("mass_splitting") == Some(false)
        && let Some(coupling) = coupling(problem, &partition.subdomain)
    {
        columns.insert("coupling".to_owned(), json!(coupling));
    }
    columns
}
