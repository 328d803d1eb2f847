use contact::Measure;
use results::name::StopOn;
use results::schema::Ending;
use results::schema::Run;

use super::*;
use crate::tests::fixture::{end, run, sample, tables, whole};
use crate::text::csv;

#[test]
fn each_failure_has_its_reason_and_success_is_not_among_them() {
    let lies = Run {
        end: end(sample(9, 1e-5, 0.5)),
        stop_on: StopOn(Measure::Zeta),
        ..run(3, "nsgs", "", Ending::FalseConvergence)
    };
    let mut of_unknown = end(sample(9, 1e-5, 0.7));
    of_unknown.measures.velocity_error = f64::NAN;
    let unknown = Run {
        end: of_unknown,
        stop_on: StopOn(Measure::QuadDv),
        ..run(7, "nsgs", "", Ending::FalseConvergence)
    };
    let runs = [
        run(0, "cg", "", Ending::Converged),
        // There is a solution.
        run(5, "cg", "", Ending::Infeasible),
        // No run found one.
        Run {
            problem: "wedge".into(),
            end: end(sample(9, 1.0, f64::NAN)),
            ..run(6, "cg", "", Ending::Infeasible)
        },
        Run { end: end(sample(100, 1e-3, 3e-2)), ..run(1, "nsgs", "", Ending::IterationLimit) },
        Run { reason: "`subdomains` is 8x8".into(), ..run(2, "nsgs-dd", "8x8", Ending::Skipped) },
        lies,
        unknown,
        // Impulses of another code, after all runs.
        run(4, "given", "", Ending::Given),
    ];
    let text = csv(&failures(&whole(&tables(&runs, &[])))).unwrap();
    let rows: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(rows.len(), 5, "{text}");
    let starts = [
        "cg,\"\",infeasible",
        "nsgs,\"\",iteration limit,100,natural_map,0.0001,0.03,,,0.03",
        "nsgs-dd,\"\",skipped",
    ];
    for (row, start) in rows.iter().zip(starts) {
        assert!(row.starts_with(&format!("column,{start}")), "{row}");
    }
    assert!(rows[2].ends_with("`subdomains` is 8x8"), "{text}");
    assert!(rows[3].contains("false convergence,100,zeta,0.0001,0.5,,,0.5,"), "{text}");
}
