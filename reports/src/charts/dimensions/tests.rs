//! The plane against space, of small studies.

use super::parts;
use crate::charts::sweep_tests::text;
use crate::tests::fixture::{files, object, run, study};
use results::schema::Run;
use serde_json::json;

/// A run of latin-dd on a problem in so many dimensions with so many unknowns per contact.
fn of(problem: &str, (dimensions, unknowns): (u32, u32), grid: &str, status: &str, iterations: u64) -> Run {
    let subdomains = grid.split('x').map(|count| count.parse::<u32>().unwrap()).product();
    let mut run = Run {
        problem: problem.into(),
        subdomains,
        iterations,
        settings: object(&json!({ "subdomains": grid })),
        spectrum: object(&json!({
            "dimensions": dimensions, "unknowns": unknowns, "boundary_share": 0.1 * f64::from(dimensions), "neighbours": subdomains - 1,
        })),
        ..run(0, "latin-dd", grid, status)
    };
    // 20 grains, and 30 entries of each in the plane, 90 in space.
    run.end.work.triangular_solve_entries = iterations * 2 * 20 * if dimensions == 2 { 30 } else { 90 };
    run
}

#[test]
fn the_plane_meets_space_problem_by_problem_on_as_many_subdomains() {
    let converged = "converged";
    let runs = [
        of("rough", (2, 2), "1x1", converged, 1000),
        of("plane", (2, 1), "1x1", converged, 100),
        of("plane", (2, 1), "4x2", converged, 200),
        of("plane", (2, 1), "2x2x2", "skipped", 0),
        of("space", (3, 1), "1x1", converged, 80),
        of("space", (3, 1), "4x2", converged, 500),
        of("space", (3, 1), "2x2x2", converged, 120),
        of("rough-space", (3, 3), "1x1", "iteration-limit", 500),
    ];
    let files = files(&parts(&study(&runs, &[])));
    let rows: Vec<Vec<&str>> =
        text(&files, "dimensions.csv").lines().skip(1).map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 3, "{rows:?}");
    // Of two grids of eight in space that with three axes; none in the plane that it has not.
    assert_eq!(rows[0][..4], ["plane", "space", "latin-dd", "1"]);
    assert_eq!((rows[1][3], rows[1][5], rows[1][6]), ("8", "200.0", "120.0"));
    assert_eq!((rows[1][9], rows[1][10]), ("30.0", "90.0"), "entries of factors per grain");
    assert_eq!(rows[2][..2], ["rough", "rough-space"]);
    let found = text(&files, "dimensions-found.md");
    assert!(found.contains("latin-dd with friction: none of 1\u{a0}pair converged on both sides"), "{found}");
    // The medians of 0.8 and 0.6; what did not converge counts for nothing.
    assert!(
        found.contains("latin-dd without friction: in space 0.70 times the iterations of the plane"),
        "{found}"
    );
    assert!(
        found.contains(
            "3.0 times the entries of factors per grain (2 of 2\u{a0}pairs converged on both sides; medians)"
        ),
        "{found}"
    );
    assert!(
        found.contains("latin-dd without friction on 8 subdomains beside one: 2.00 times the iterations in the plane, 1.50 in space"),
        "{found}"
    );
    assert!(
        found.contains("On 8 subdomains 20 % of their grains are on boundaries in the plane, 30 % in space"),
        "{found}"
    );
}

#[test]
fn without_a_counterpart_nothing_is_compared() {
    for runs in [vec![], vec![of("plane", (2, 1), "4x2", "converged", 100)]] {
        let files = files(&parts(&study(&runs, &[])));
        assert_eq!(text(&files, "dimensions.csv").lines().count(), 1);
        assert!(files.iter().all(|(name, text)| !name.contains("found") || text.is_empty()), "{files:?}");
    }
}
