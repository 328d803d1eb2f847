//! Provenance of the rows of a study.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;
use results::schema::Provenance;

use crate::text::frame;

/// Provenance of a row, and whether no other run went on beside it.
pub(crate) type Origin<'r> = (&'r Provenance, bool);

/// One row per build, machine and number of threads; seconds compare within a row only.
pub(crate) fn provenance(all: &[Origin]) -> DataFrame {
    let mut groups: BTreeMap<_, Vec<&Origin>> = BTreeMap::new();
    for origin @ (o, _) in all {
        groups
            .entry((&o.commit, &o.processor, o.threads, &o.rustc, &o.profile, &o.other_code))
            .or_default()
            .push(origin);
    }
    let groups: Vec<Vec<&Origin>> = groups.into_values().collect();
    let of = |f: fn(&Provenance) -> &str| groups.iter().map(|group| f(group[0].0)).collect::<Vec<_>>();
    let count = |f: fn(&&&Origin) -> bool| {
        groups.iter().map(|group| group.iter().filter(f).count() as u64).collect::<Vec<_>>()
    };
    let started = |group: &Vec<&Origin>| -> Vec<String> {
        let mut times: Vec<String> = group.iter().map(|(o, _)| o.started_utc.clone()).collect();
        times.sort();
        times
    };
    frame(df!(
        "runs" => count(|_| true),
        "commit" => of(|o| &o.commit),
        "processor" => of(|o| &o.processor),
        "threads" => groups.iter().map(|group| group[0].0.threads).collect::<Vec<_>>(),
        "rustc" => of(|o| &o.rustc),
        "profile" => of(|o| &o.profile),
        "other_code" => of(|o| &o.other_code),
        "timed_alone" => count(|(_, alone)| *alone),
        "first_utc" => groups.iter().map(|group| started(group).swap_remove(0)).collect::<Vec<_>>(),
        "last_utc" => groups.iter().map(|group| started(group).pop()).collect::<Vec<_>>(),
    ))
}
