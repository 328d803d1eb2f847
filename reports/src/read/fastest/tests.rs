use results::schema::{Ending, Run, Timing};

use super::*;
use crate::tests::fixture::{run, sample};

/// Seconds to 1e-4 of each of some problems, of runs whose repeats spread by a tenth of that; `None` of one that stays above.
fn rows(method: &'static str, seconds: &[Option<f64>], spread: f64) -> Vec<RunRow> {
    let row = |(k, seconds): (usize, &Option<f64>)| {
        let time = seconds.unwrap_or(1.0);
        let timing = Timing {
            repeats: 5,
            setup_spread_s: spread * time,
            iterating_spread_s: 0.0,
            ..Timing::default()
        };
        let of = Run {
            problem: format!("p{k}"),
            setup_s: time,
            iterating_s: 0.0,
            timing,
            ..run(0, method, "", Ending::Converged)
        };
        let map = if seconds.is_some() { 1e-5 } else { 1e-3 };
        RunRow::of(
            0,
            &results::journal::Record { run: of, curve: vec![sample(0, 0.1, map)], snapshots: Vec::new() },
        )
    };
    seconds.iter().enumerate().map(row).collect()
}

fn ranked(rows: &[RunRow]) -> Vec<(String, usize, bool)> {
    let all = standings(&rows.iter().collect::<Vec<_>>(), 1e-4);
    all.into_iter().map(|standing| (standing.label, standing.reached, standing.ties)).collect()
}

fn place(method: &str, reached: usize, ties: bool) -> (String, usize, bool) {
    (method.to_owned(), reached, ties)
}

/// `often` is the slowest, and the only one that reaches the accuracy on all problems.
#[test]
fn first_comes_what_reaches_the_accuracy_most_often() {
    let often = rows("often", &[Some(9.0), Some(9.0)], 0.01);
    let fast = rows("fast", &[Some(1.0), None], 0.01);
    let never = rows("never", &[None, None], 0.01);
    let all = [never, fast, often].concat();
    assert_eq!(ranked(&all), [place("often", 2, true), place("fast", 1, false)]);
}

/// A method that is slower on four of five packings, and faster on the fifth, is not known to be slower.
#[test]
fn who_is_faster_on_one_of_five_packings_ties() {
    let first = rows("first", &[Some(1.0); 5], 0.01);
    let mixed = rows("mixed", &[Some(1.2), Some(1.2), Some(0.9), Some(1.2), Some(1.2)], 0.01);
    let slower = rows("slower", &[Some(1.2); 5], 0.01);
    let all = [slower, mixed, first].concat();
    let ranked = ranked(&all);
    assert_eq!(ranked[0], place("first", 5, true));
    for place in [place("slower", 5, false), place("mixed", 5, true)] {
        assert!(ranked.contains(&place), "{place:?} is not in {ranked:?}");
    }
}

/// Times whose intervals overlap are a tie, and so are all that were measured once.
#[test]
fn times_that_spread_tie() {
    let pair = |spread| [rows("a", &[Some(1.0); 5], spread), rows("b", &[Some(1.1); 5], spread)].concat();
    assert_eq!(ranked(&pair(0.01)), [place("a", 5, true), place("b", 5, false)]);
    assert_eq!(ranked(&pair(0.06)), [place("a", 5, true), place("b", 5, true)]);
    assert_eq!(ranked(&pair(f64::NAN)), [place("a", 5, true), place("b", 5, true)]);
}
