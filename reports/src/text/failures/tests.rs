use results::schema::Run;

use super::*;
use crate::tests::fixture::{end, run, sample, tables, whole};
use crate::text::csv;

#[test]
fn each_failure_has_its_reason_and_success_is_not_among_them() {
    let lies = Run {
        end: end(sample(9, 1e-5, 0.5)),
        stop_on: "zeta".into(),
        ..run(3, "nsgs", "", "false-convergence")
    };
    let mut unknown = Run {
        end: end(sample(9, 1e-5, 0.7)),
        stop_on: "quad_dv".into(),
        ..run(7, "nsgs", "", "false-convergence")
    };
    unknown.end.measures.velocity_error = f64::NAN;
    let runs = [
        run(0, "cg", "", "converged"),
        // There is a solution.
        run(5, "cg", "", "infeasible"),
        // No run found one.
        Run { problem: "wedge".into(), end: end(sample(9, 1.0, f64::NAN)), ..run(6, "cg", "", "infeasible") },
        Run { end: end(sample(100, 1e-3, 3e-2)), ..run(1, "nsgs", "", "iteration-limit") },
        Run { reason: "`subdomains` is 8x8".into(), ..run(2, "nsgs-dd", "8x8", "skipped") },
        lies,
        unknown,
        // Impulses of another code, after all runs.
        run(4, "given", "", "given"),
    ];
    let text = csv(&failures(&whole(&tables(&runs, &[])))).unwrap();
    let rows: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(rows.len(), 5, "{text}");
    assert!(rows[0].ends_with("no solution, and there is one\""), "{text}");
    let rows = &rows[1..];
    assert!(
        rows[0].ends_with("all 100 iterations made, and natural map is 0.030 where 10⁻⁴ was asked\""),
        "{text}"
    );
    assert!(rows[1].ends_with("`subdomains` is 8x8"), "{text}");
    assert!(rows[2].ends_with("zeta met its tolerance while the velocity error is 0.50"), "{text}");
    assert!(rows[3].ends_with("quad dv met its tolerance while the natural map is 0.70"), "{text}");
}
