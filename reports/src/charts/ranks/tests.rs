//! Predictions from runs of known work and messages.

use super::parts;
use crate::charts::sweep_tests::{on, text};
use crate::tests::fixture::{files, object, run, study};
use results::schema::Ending;
use results::schema::{Exchange, Run};
use serde_json::json;

#[test]
fn ranks_are_predicted_from_work_messages_and_sums() {
    let counted = |path: u32, run: Run| Run {
        derived: object(&json!({ "critical_path": path })),
        spectrum: object(&json!({ "neighbours": 3, "sent_bytes": 1200 })),
        ..run
    };
    let mut cg = Run { iterating_s: 0.2, iterations: 50, ..run(2, "cg", "", Ending::Converged) };
    cg.end.work.delassus_products = 100;
    let runs = [
        counted(800, Run { iterating_s: 1.0, ..on(0, 1, "null", 100) }),
        counted(200, on(1, 4, "null", 128)),
        cg,
    ];
    let files = files(&parts(&study(&runs, &[])));
    let rows: Vec<Vec<&str>> =
        text(&files, "ranks.csv").lines().skip(1).map(|row| row.split(',').collect()).collect();
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs(), "{a} for {b}");
    // A quarter of 10 ms, three messages of 1.5 µs with 1200 bytes at 12 GB/s; of cg twice, and four sums over 2² ranks.
    let messages_s = 3.0 * 1.5e-6 + 1200.0 / 12e9;
    assert_eq!((rows[3][1], rows[3][2], rows[1][1], rows[1][2]), ("cg", "4", "latin-dd", "4"));
    near(number(1, 7), 2.5e-3);
    near(number(1, 8), messages_s);
    near(number(1, 10), 128.0 * (2.5e-3 + messages_s));
    near(number(3, 10), 50.0 * (1e-3 + 2.0 * messages_s + 4.0 * 1.5e-6 * 2.0));
    near(number(1, 11), 1.0 / number(1, 10));
    assert!(text(&files, "ranks-column.svg").contains("4\u{a0}runs"));
}

#[test]
fn ranks_are_not_predicted_where_exchanges_are_not_known_or_the_tolerance_was_not_met() {
    let counted = |method: &str, exchange: &str, status: Ending, run: Run| Run {
        method: method.into(),
        status,
        settings: object(&json!({ "exchange": exchange, "subdomains": format!("{}x1", run.subdomains) })),
        derived: object(&json!({ "critical_path": 800 / run.subdomains })),
        spectrum: object(&json!({ "neighbours": 3, "sent_bytes": 1200 })),
        ..run
    };
    let predicted = |method, exchange, status, threads| {
        let runs = [1, 4].map(|subdomains| {
            let mut run = counted(method, exchange, status, on(subdomains, subdomains, "null", 100));
            run.provenance.threads = threads;
            run
        });
        let files = files(&parts(&study(&runs, &[])));
        let rows: Vec<String> = text(&files, "ranks.csv").lines().skip(1).map(str::to_owned).collect();
        rows.iter().map(|row| row.split(',').nth(10).unwrap().parse::<f64>().is_ok()).collect::<Vec<_>>()
    };
    assert_eq!(predicted("nsgs-dd", "jacobi", Ending::Converged, 1), [true, true]);
    assert_eq!(predicted("nsgs-dd", "gauss-seidel", Ending::Converged, 1), [false, false]);
    assert_eq!(predicted("newton-schur", "jacobi", Ending::Converged, 1), [false, false]);
    assert_eq!(predicted("nsgs-dd", "jacobi", Ending::IterationLimit, 1), [false, false]);
    assert_eq!(predicted("nsgs-dd", "jacobi", Ending::Converged, 2), [false, false]);
}

#[test]
fn what_ranks_took_stands_beside_what_is_predicted_of_them() {
    let on_ranks = |number: u32, ranks: u32, iterating_s: f64| Run {
        settings: object(&json!({ "ranks": ranks })),
        iterating_s,
        exchange: Exchange {
            ranks,
            // Each of the 100 iterations, three of each rank with 1200 bytes in all.
            messages: if ranks > 1 { 300 * u64::from(ranks) } else { 0 },
            message_bytes: if ranks > 1 { 120_000 * u64::from(ranks) } else { 0 },
            latency_s: 1e-6,
            seconds_per_byte: 1e-10,
            ..Exchange::default()
        },
        ..run(number, "nsgs-dd", "", Ending::IterationLimit)
    };
    let runs = [on_ranks(0, 1, 0.1), on_ranks(1, 2, 0.06), on_ranks(2, 4, 0.02)];
    let of = |runs: &[Run]| {
        let files = files(&parts(&study(runs, &[])));
        assert!(text(&files, "ranks-measured.svg").contains("as predicted"));
        let rows = text(&files, "ranks.csv").lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
        let last = |row: &String| row.rsplit(',').next().unwrap().parse::<f64>().ok();
        rows.iter().map(last).collect::<Vec<_>>()
    };
    let ratios = of(&runs);
    let messages_s = 3.0 * 1e-6 + 1200.0 * 1e-10;
    let expected = [1.0, 6e-4 / (5e-4 + messages_s), 2e-4 / (2.5e-4 + messages_s)];
    for (ratio, expected) in ratios.iter().zip(expected) {
        assert!((ratio.unwrap() - expected).abs() < 1e-9, "{ratios:?} for {expected}");
    }
    // Nothing is predicted from one rank of another machine.
    let mut elsewhere = runs;
    elsewhere[0].provenance.processor = "another".into();
    assert_eq!(of(&elsewhere), [Some(1.0), None, None]);
}
