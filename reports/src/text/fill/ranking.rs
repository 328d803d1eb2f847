//! Which method for which accuracy: all of them on some problems, in the order in which one would take them.

use std::collections::BTreeMap;

use minijinja::Value;
use minijinja::value::Kwargs;
use minijinja::{Error, context};
use results::journal::Record;

use crate::read::median;

/// A method with its settings: method and variant.
type Name = (String, String);

/// Returns the seconds, set-up included, after which a run's natural map is at most the accuracy and stays there.
fn seconds(record: &Record, accuracy: f64) -> Option<f64> {
    let first = results::reached(record.curve.iter().map(|sample| sample.measures.natural_map), accuracy)?;
    Some(record.run.setup_s + record.curve[first].iterating_s)
}

/// The methods on the `problems`, for a natural map of `accuracy`: those that reach it on more problems first, then those that are
/// less far behind the fastest where they are farthest. Each has `method` and `variant`; `reached`, on how many problems; `worst`,
/// the greatest ratio to the fastest there; and `least`, `median` and `most`, its seconds there. One that reaches it on none is not
/// in the list.
///
/// # Errors
///
/// If there is no such problem.
pub(super) fn ranking(records: &[Record], wanted: &Kwargs) -> Result<Vec<Value>, Error> {
    let (problems, accuracy): (Vec<String>, f64) = (wanted.get("problems")?, wanted.get("accuracy")?);
    wanted.assert_all_used()?;
    let mut of_methods: BTreeMap<Name, Vec<(f64, f64)>> = BTreeMap::new();
    for problem in &problems {
        let on_it = || records.iter().filter(|record| record.run.problem == *problem);
        if on_it().next().is_none() {
            let what = format!("there is no run on `{problem}`");
            return Err(Error::new(minijinja::ErrorKind::InvalidOperation, what));
        }
        let times: Vec<(&Record, f64)> =
            on_it().filter_map(|record| Some((record, seconds(record, accuracy)?))).collect();
        let fastest = times.iter().map(|(_, seconds)| *seconds).fold(f64::INFINITY, f64::min);
        for (record, seconds) in times {
            let name = (record.run.method.clone(), record.run.variant.clone());
            of_methods.entry(name).or_default().push((seconds, seconds / fastest));
        }
    }
    let worst = |times: &[(f64, f64)]| times.iter().map(|(_, ratio)| *ratio).fold(1.0, f64::max);
    let mut ranked: Vec<(Name, Vec<(f64, f64)>)> = of_methods.into_iter().collect();
    ranked.sort_by(|(_, a), (_, b)| b.len().cmp(&a.len()).then(worst(a).total_cmp(&worst(b))));
    let row = |((method, variant), times): &(Name, Vec<(f64, f64)>)| {
        let seconds: Vec<f64> = times.iter().map(|(seconds, _)| *seconds).collect();
        context! {
            method, variant,
            reached => times.len(),
            worst => worst(times),
            least => seconds.iter().copied().fold(f64::INFINITY, f64::min),
            median => median(seconds.clone()),
            most => seconds.iter().copied().fold(0.0, f64::max),
        }
    };
    Ok(ranked.iter().map(row).collect())
}
