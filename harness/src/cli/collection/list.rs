//! `gravel collection list`: the problems, their numbers, or how far apart their solutions are.

use super::size;
use crate::collection::{Collection, Entry, Standing, State, Status};
use crate::plan::key_value;
use crate::terminal::{say, say_table};
use anyhow::{Result, ensure};
use results::median;
use std::collections::BTreeMap;
use wildmatch::WildMatch;

#[derive(clap::Args)]
pub(super) struct List {
    /// Only problems with this name, mechanics, state, status, grains or friction (the greatest μ), such as mechanics=rough*; may be
    /// repeated: a problem must match all
    #[arg(long, value_name = "KEY=PATTERN", value_parser = key_value)]
    only: Vec<(String, String)>,
    /// Print ids alone: of a hidden collection they may be published, and promise what it holds
    #[arg(long, conflicts_with_all = ["summary", "spread"])]
    ids: bool,
    /// Print a Markdown table of the numbers of problems of each mechanics, size and state, by status
    #[arg(long, conflicts_with = "spread")]
    summary: bool,
    /// Print a Markdown table of how far apart in velocity the known solutions with friction are, by mechanics, state and μ
    #[arg(long)]
    spread: bool,
}

impl List {
    pub(super) fn run(&self, collection: &Collection) -> Result<()> {
        let mut entries = collection.entries()?;
        for (key, pattern) in &self.only {
            let pattern = WildMatch::new(pattern);
            ensure!(KEYS.contains(&key.as_str()), "--only {key}: there is {}", KEYS.join(", "));
            entries.retain(|entry| pattern.matches(&value(entry, key)));
        }
        if self.ids {
            return entries.iter().try_for_each(|entry| say(format_args!("{}", entry.id)));
        }
        if self.summary {
            return summary(&entries);
        }
        if self.spread {
            return spread(&entries);
        }
        for entry in &entries {
            say(format_args!(
                "{}  {:<11} {}; {}",
                entry.id,
                entry.known.status.name(),
                size(entry),
                entry.name
            ))?;
        }
        let of = |status| entries.iter().filter(|entry| entry.known.status == status).count();
        let counts = Status::ALL.map(|status| format!("{} {}", of(status), status.name()));
        say(format_args!("{} problems: {}", entries.len(), counts.join(", ")))
    }
}

/// Keys by which problems are listed.
const KEYS: [&str; 6] = ["name", "mechanics", "state", "status", "grains", "friction"];

fn value(entry: &Entry, key: &str) -> String {
    match key {
        "name" => entry.name.clone(),
        "mechanics" => entry.mechanics.clone(),
        "state" => entry.state.name().to_owned(),
        "status" => entry.known.status.name().to_owned(),
        "grains" => entry.grains.to_string(),
        _ => entry.friction[1].to_string(),
    }
}

/// Prints the numbers of problems of each mechanics, size and state, by status.
fn summary(entries: &[Entry]) -> Result<()> {
    let mut groups: BTreeMap<(&str, usize, State), [usize; Status::ALL.len()]> = BTreeMap::new();
    for entry in entries {
        let group = groups.entry((&entry.mechanics, entry.grains, entry.state)).or_default();
        let status = Status::ALL.iter().position(|status| *status == entry.known.status);
        group[status.unwrap_or(0)] += 1;
    }
    let row = |head: [String; 3], counts: &[usize; Status::ALL.len()]| {
        let all: usize = counts.iter().sum();
        head.into_iter().chain([all.to_string()]).chain(counts.iter().map(usize::to_string)).collect()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut total = [0; Status::ALL.len()];
    for ((mechanics, grains, state), counts) in &groups {
        rows.push(row([(*mechanics).to_owned(), grains.to_string(), state.name().to_owned()], counts));
        total.iter_mut().zip(counts).for_each(|(total, count)| *total += count);
    }
    rows.push(row(["all".to_owned(), String::new(), String::new()], &total));
    let headings =
        [&["mechanics", "grains", "state", "problems"][..], &Status::ALL.map(Status::name)].concat();
    say_table(&headings, &rows)
}

/// Prints the spread of the solutions of problems with one μ, by mechanics, state and μ: the least, the median and the greatest of those with
/// several.
fn spread(entries: &[Entry]) -> Result<()> {
    let mut groups: BTreeMap<(&str, State, String), Vec<&Standing>> = BTreeMap::new();
    for Entry { mechanics, grains, state, friction: [least, greatest], known, .. } in entries {
        if *grains > 0 && least == greatest && *greatest > 0.0 {
            groups.entry((mechanics, *state, greatest.to_string())).or_default().push(known);
        }
    }
    let row = |((mechanics, state, friction), known): (&(&str, State, String), &Vec<&Standing>)| {
        let of = |least: usize| known.iter().filter(|known| known.solutions >= least).count().to_string();
        let spreads: Vec<f64> = known.iter().filter_map(|known| known.spread).collect();
        let text = |spread: Option<f64>| spread.map_or_else(String::new, |spread| format!("{spread:.1e}"));
        let [least, greatest] = [f64::min, f64::max].map(|of| text(spreads.iter().copied().reduce(of)));
        let [mechanics, state] = [*mechanics, state.name()].map(str::to_owned);
        let counts = [known.len().to_string(), of(1), of(2)];
        [[mechanics, state, friction.clone()], counts, [least, text(median(spreads)), greatest]].concat()
    };
    let rows: Vec<Vec<String>> = groups.iter().map(row).collect();
    say_table(
        &[
            "mechanics",
            "state",
            "μ",
            "problems",
            "with a solution",
            "several",
            "least spread",
            "median",
            "greatest",
        ],
        &rows,
    )
}
