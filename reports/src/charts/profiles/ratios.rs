//! Costs of all methods on all problems, over the least on each.

use crate::draw::Series;
use crate::read::{Cost, RunRow, problems, reached, span};

pub(super) struct Ratios {
    pub(super) problems: usize,
    /// For each method and problem the cost over the least one; `None` where the accuracy is not reached.
    pub(super) of_methods: Vec<Vec<Option<f64>>>,
}

impl Ratios {
    pub(super) fn of(runs: &[RunRow], methods: &[Series], cost: &Cost, accuracy: f64) -> Self {
        let problems = problems(runs);
        let price = |method: &Series, problem: &str| {
            let run = method.runs.iter().find(|run| run.problem == problem)?;
            (cost.of)(run, reached(&run.curve, accuracy)?)
        };
        let prices: Vec<Vec<Option<f64>>> = methods
            .iter()
            .map(|method| problems.iter().map(|problem| price(method, problem)).collect())
            .collect();
        let least =
            |p: usize| span(prices.iter().filter_map(|of_method| of_method[p])).map(|(least, _)| least);
        let ratio = |p: usize, price: Option<f64>| {
            let (price, least) = (price?, least(p)?);
            // Nothing to do for the best one: any other is as good if it has nothing to do either.
            if price <= least { Some(1.0) } else { Some((price / least).min(f64::MAX)) }
        };
        let ratios = |of_method: &Vec<Option<f64>>| {
            of_method.iter().enumerate().map(|(p, price)| ratio(p, *price)).collect()
        };
        Self { problems: problems.len(), of_methods: prices.iter().map(ratios).collect() }
    }

    /// The ratios of those that nothing undercuts: none if no method reaches the accuracy.
    pub(super) fn best(&self) -> Vec<f64> {
        self.of_methods.iter().flatten().flatten().copied().filter(|ratio| *ratio <= 1.0).collect()
    }

    /// Counts the pairs of method and problem that do not reach the accuracy, and all pairs.
    pub(super) fn not_reached(&self) -> (usize, usize) {
        let pairs = || self.of_methods.iter().flatten();
        (pairs().filter(|ratio| ratio.is_none()).count(), pairs().count())
    }
}
