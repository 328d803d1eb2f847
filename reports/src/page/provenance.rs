//! Where the rows of a study come from.

use std::collections::BTreeMap;

use polars::df;
use polars::prelude::DataFrame;

use crate::ReportError;
use crate::columns::{bools, texts, u32s};

/// One row per build, machine and number of threads; seconds compare within a row only.
pub(crate) fn provenance(table: &DataFrame) -> Result<DataFrame, ReportError> {
    let (commit, processor) = (texts(table, "commit")?, texts(table, "processor")?);
    let (rustc, profile) = (texts(table, "rustc")?, texts(table, "profile")?);
    let (threads, started) = (u32s(table, "threads")?, texts(table, "started_utc")?);
    let alone = bools(table, "timed_alone")?;
    let mut origins: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for i in 0..table.height() {
        let origin = (&commit[i], &processor[i], threads[i], &rustc[i], &profile[i]);
        origins.entry(origin).or_default().push(i);
    }
    let origins: Vec<_> = origins.into_iter().collect();
    let of = |f: fn(&(&String, &String, u32, &String, &String)) -> String| {
        origins.iter().map(|(origin, _)| f(origin)).collect::<Vec<_>>()
    };
    let first = |rows: &Vec<usize>| rows.iter().map(|i| started[*i].as_str()).min().unwrap_or_default();
    let last = |rows: &Vec<usize>| rows.iter().map(|i| started[*i].as_str()).max().unwrap_or_default();
    Ok(df!(
        "runs" => origins.iter().map(|(_, rows)| rows.len() as u64).collect::<Vec<_>>(),
        "commit" => of(|o| o.0.clone()),
        "processor" => of(|o| o.1.clone()),
        "threads" => origins.iter().map(|(o, _)| o.2).collect::<Vec<_>>(),
        "rustc" => of(|o| o.3.clone()),
        "profile" => of(|o| o.4.clone()),
        "timed_alone" =>
            origins.iter().map(|(_, rows)| rows.iter().filter(|i| alone[**i]).count() as u64).collect::<Vec<_>>(),
        "first_utc" => origins.iter().map(|(_, rows)| first(rows)).collect::<Vec<_>>(),
        "last_utc" => origins.iter().map(|(_, rows)| last(rows)).collect::<Vec<_>>(),
    )?)
}
