use results::schema::Ending;
use results::schema::{Run, Snapshot};
use results::study::Runs;
use serde_json::json;

use super::*;
use crate::Chart;
use crate::tests::about;
use crate::tests::fixture::{decay, explosion, object, run, sample, scene, tables, whole};
use crate::text;

fn made(runs: &Runs) -> String {
    let study = &whole(runs);
    let mut chapters = vec![Chapter::new("iterations", vec![text::rows(study).unwrap()])];
    chapters.extend(Chart::all().iter().map(|chart| Chapter::of_chart(*chart, study)));
    let page = page(study, &chapters, &about(), Formats::default()).unwrap();
    assert!(page.contains("What &lt;it&gt; asks."), "texts are escaped");
    for network in ["http://", "https://", "src=\"", "@import", "url("] {
        let foreign = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!foreign.contains(network), "{network}");
    }
    page
}

#[test]
fn no_row_one_row_only_failures_and_undefined_values_make_a_page_that_says_so() {
    assert!(made(&tables(&[], &[])).contains("0\u{a0}runs of 0\u{a0}methods"));
    let one = made(&tables(&[run(0, "cg", "", Ending::Converged)], &[(0, decay())]));
    assert!(one.contains("1 converged.") && one.contains("failures: none."));
    let failed = Run { reason: "why </script> not".into(), ..run(0, "jacobi", "", Ending::Skipped) };
    let failed = made(&tables(&[failed, run(1, "cg", "", Ending::Diverged)], &[(1, explosion())]));
    assert!(failed.contains("1 diverged, 1 skipped.") && failed.contains("why &lt;/script&gt; not"));
    let odd = Run { tolerance: f64::NAN, setup_s: f64::NAN, ..run(0, "cg", "", Ending::Converged) };
    made(&tables(&[odd], &[(0, vec![sample(0, f64::NAN, f64::NAN), sample(1, f64::INFINITY, f64::NAN)])]));
}

#[test]
fn sentences_of_the_page_change_with_the_rows() {
    let page = |status| {
        let cg = run(0, "cg", "", status);
        made(&tables(&[cg, run(1, "nsgs", "", Ending::Converged)], &[(0, decay()), (1, decay())]))
    };
    assert!(page(Ending::Converged).contains("in all of their runs: cg (1), nsgs (1)."));
    assert!(page(Ending::Diverged).contains("in all of their runs: nsgs (1)."));
}

#[test]
fn viewer_holds_the_sample_and_the_snapshots_of_its_runs() {
    let (grains, contacts) = scene(2.0);
    let kept = |iteration, impulse| Snapshot {
        iteration,
        natural_map: 0.5,
        impulses_n_s: vec![impulse, 1.0, f64::NAN],
        sliding: vec![1],
        spins_rad_per_s: vec![impulse, -4.0],
    };
    let mut study = tables(&[Run { problem: "pair".into(), ..run(0, "cg", "", Ending::Converged) }], &[]);
    (study.grains, study.contacts) = (grains, contacts);
    study.records[0].snapshots = vec![kept(0, 0.0), kept(3, 2.0)];
    let page = made(&study);
    // Thousandths of the greatest impulse of the solution, 2 N·s.
    assert!(page.contains(r#""frames":[{"iteration":0,"natural_map":0.5,"impulses":[0,500,0],"sliding":[1],"spins":[0,-1000]},{"iteration":3,"natural_map":0.5,"impulses":[1000,500,0],"sliding":[1],"spins":[500,-1000]}]"#), "{page}");
    assert!(page.contains(r#""label":"solution""#) && page.contains("sample-pair-2x1.svg"));
    study.records[0].snapshots.clear();
    assert!(made(&study).contains("<code>gravel view PROBLEM --run"), "what shows the iterations is said");
}

#[test]
fn more_rows_than_a_browser_likes_are_left_to_the_file() {
    let runs: Vec<Run> = (0..6000).map(|i| run(i, "cg", "", Ending::Converged)).collect();
    let study = whole(&tables(&runs, &[]));
    let chapters = [Chapter::new("iterations", vec![text::rows(&study).unwrap()])];
    assert!(
        page(&study, &chapters, &about(), Formats::default())
            .unwrap()
            .contains("The first 5000 of 6000 rows")
    );
}

#[test]
fn hundred_thousand_runs_of_as_many_kinds_are_a_page_that_leaves_lines_and_rows_out() {
    let many: Vec<Run> = (0..100_000)
        .map(|i| {
            let settings = object(&json!({ "relaxation": i }));
            Run { settings, ..run(i, "nsgs", &format!("relaxation={i}"), Ending::Converged) }
        })
        .collect();
    let study = whole(&tables(&many, &[(0, decay())]));
    let chapters = Chart::default_set(false).into_iter().map(|chart| Chapter::of_chart(chart, &study));
    let mut chapters: Vec<Chapter> = chapters.collect();
    chapters.push(Chapter::new("iterations", vec![text::rows(&study).unwrap()]));
    let page = page(&study, &chapters, &about(), Formats::default()).unwrap();
    assert!(page.contains("100\u{202f}000\u{a0}lines are too many for a figure"));
    assert!(page.contains("The first 5000 of 100000 rows"));
}
