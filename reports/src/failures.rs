//! The runs that failed, each with its reason; one that proves that there is no solution has not.

use polars::df;
use polars::prelude::DataFrame;
use results::store::Tables;

use crate::ReportError;
use crate::columns::{newer, texts};
use crate::ending::Ending;
use crate::number::{count, number};
use crate::rows::{RunRow, Verdicts, made, runs};

/// One row per run that failed.
pub(crate) fn failures(tables: &Tables) -> Result<DataFrame, ReportError> {
    let table = made(&tables.runs)?;
    let runs = runs(&table)?;
    let reached = reached(&table, &runs)?;
    let errors = newer(&table, "velocity_error")?;
    let natural_maps = newer(&table, "natural_map")?;
    let (id, verdicts) = (texts(&table, "id")?, Verdicts::of(&runs));
    let failed: Vec<usize> = (0..runs.len()).filter(|i| !verdicts.is_right(&runs[*i])).collect();
    let column = |of: &dyn Fn(&RunRow) -> String| failed.iter().map(|i| of(&runs[*i])).collect::<Vec<_>>();
    Ok(df!(
        "problem" => column(&|run| run.problem.clone()),
        "method" => column(&|run| run.method.clone()),
        "variant" => column(&|run| run.words.clone()),
        "ended" => column(&|run| run.ending.text().to_owned()),
        "iterations" => failed.iter().map(|i| runs[*i].iterations).collect::<Vec<_>>(),
        "run" => failed.iter().map(|i| id[*i].clone()).collect::<Vec<_>>(),
        "reason" => failed.iter().map(|i| reason(&runs[*i], reached[*i], errors[*i], natural_maps[*i])).collect::<Vec<_>>(),
    )?)
}

/// The value of its own measure that each run ended with.
fn reached(table: &DataFrame, runs: &[RunRow]) -> Result<Vec<Option<f64>>, ReportError> {
    let mut reached = vec![None; runs.len()];
    for measure in ["zeta", "natural_map", "penetration_rate_m_per_s", "quad_dv", "max_dv", "velocity_error"]
    {
        let values = newer(table, measure)?;
        for (i, value) in values.into_iter().enumerate() {
            if measure.starts_with(&runs[i].stop_on) {
                reached[i] = value;
            }
        }
    }
    Ok(reached)
}

/// What the row says, or what its ending means.
fn reason(run: &RunRow, reached: Option<f64>, error: Option<f64>, natural_map: Option<f64>) -> String {
    if !run.reason.is_empty() {
        return run.reason.clone();
    }
    let (iterations, measure) = (count(run.iterations as usize), run.stop_on.replace('_', " "));
    let value = |value: Option<f64>| value.map_or("undefined".to_owned(), |value| number(value, 2));
    match run.ending {
        Ending::IterationLimit => format!(
            "all {iterations} iterations made, and {measure} is {} where {} was asked",
            value(reached),
            value(run.tolerance)
        ),
        Ending::Stalled => format!(
            "after {iterations} iterations no further one makes it better, and {measure} is {} where {} was asked",
            value(reached),
            value(run.tolerance)
        ),
        Ending::Diverged => {
            format!("not finite, or far above its own scale of energy, at iteration {iterations}")
        }
        Ending::Infeasible => {
            format!(
                "at iteration {iterations} it claimed to prove that there is no solution, and there is one"
            )
        }
        Ending::FalseConvergence => {
            let but = match error {
                Some(error) => format!("the velocity error is {}", number(error, 2)),
                None => format!("the natural map is {}", value(natural_map)),
            };
            format!("{measure} met its tolerance while {but}")
        }
        Ending::Converged | Ending::Skipped | Ending::Failed => "no reason is stored".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use results::schema::{Run, Sample};

    use super::*;
    use crate::fixture::{run, sample, tables};
    use crate::table::csv;

    #[test]
    fn each_failure_has_its_reason_and_success_is_not_among_them() {
        let lies = Run {
            end: sample(9, 1e-5, 0.5),
            stop_on: "zeta".into(),
            ..run(3, "nsgs", "", "false-convergence")
        };
        let unknown = Run {
            end: Sample { velocity_error: f64::NAN, ..sample(9, 1e-5, 0.7) },
            stop_on: "quad_dv".into(),
            ..run(7, "nsgs", "", "false-convergence")
        };
        let runs = [
            run(0, "cg", "", "converged"),
            // There is a solution.
            run(5, "cg", "", "infeasible"),
            // No run found one.
            Run { problem: "wedge".into(), end: sample(9, 1.0, f64::NAN), ..run(6, "cg", "", "infeasible") },
            Run { end: sample(100, 1e-3, 3e-2), ..run(1, "nsgs", "", "iteration-limit") },
            Run { reason: "`subdomains` is 8x8".into(), ..run(2, "nsgs-dd", "8x8", "skipped") },
            lies,
            unknown,
            // Impulses of another code, after all runs.
            run(4, "given", "", "given"),
        ];
        let text = csv(&failures(&tables(&runs, &[])).unwrap()).unwrap();
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
}
