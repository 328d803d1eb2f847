use super::parts;
use crate::tests::assert_well_formed;
use crate::tests::fixture::{File, files, object, run, sample, study};
use results::schema::Ending;
use results::schema::{Run, Sample};
use serde_json::json;

/// Falls from 1 by a decade in so many iterations, for so many decades.
fn decay(decade: u64, decades: u64) -> Vec<Sample> {
    let value = |i: u64| 10f64.powf(-(i as f64) / decade as f64);
    (0..=decade * decades).map(|i| sample(i, value(i), value(i))).collect()
}

fn on(number: u32, method: &str, subdomains: u32, status: Ending) -> Run {
    let grid = format!("{subdomains}x1");
    let settings = object(&json!({ "relaxation": 1.0, "subdomains": grid }));
    Run { settings, subdomains, ..run(number, method, &grid, status) }
}

fn nsgs(number: u32) -> Run {
    Run { settings: object(&json!({ "relaxation": 1.0 })), ..run(number, "nsgs", "", Ending::Converged) }
}

fn figures(runs: &[Run], curves: &[(u32, Vec<Sample>)]) -> Vec<File> {
    let files = files(&parts(&study(runs, curves)));
    for (name, svg) in &files {
        assert_well_formed(name, svg);
    }
    files
}

fn ratios(files: &[File]) -> Option<&str> {
    files.iter().find(|(name, _)| name == "ratios-column.svg").map(|(_, svg)| svg.as_str())
}

#[test]
fn a_run_of_twice_the_iterations_has_the_ratio_two_at_every_accuracy() {
    let runs = [nsgs(0), on(1, "nsgs-dd", 2, Ending::Converged)];
    let study = study(&runs, &[(0, decay(20, 4)), (1, decay(40, 4))]);
    let (points, ending) = super::ratios(&study.runs[1], &study.runs[0], contact::Measure::NaturalMap);
    assert_eq!(ending, crate::read::Ending::Converged);
    let all: Vec<(f64, f64)> = points.into_iter().flatten().collect();
    assert_eq!(all.len(), 36, "ten to a decade, from half a decade on, where nsgs has made ten iterations");
    assert!(all.iter().all(|(_, ratio)| (ratio - 2f64.log10()).abs() < 1e-12), "{all:?}");
    assert!((all[35].0 + 4.0).abs() < 1e-12, "the accuracy at which both stop is one of them");
}

#[test]
fn ratios_are_those_of_runs_that_have_one_without_subdomains() {
    let curves = || vec![(0, decay(20, 4)), (1, decay(30, 4)), (2, decay(30, 4)), (3, decay(60, 4))];
    let dd = |number| on(number, "nsgs-dd", 4, Ending::Converged);
    let latin = |number, subdomains| on(number, "latin-dd", subdomains, Ending::Converged);
    let all = figures(&[nsgs(0), dd(1), latin(2, 1), latin(3, 4)], &curves());
    let svg = ratios(&all).unwrap();
    assert!(svg.contains("\nnsgs-dd\n") && svg.contains("latin-dd 4x1") && !svg.contains("latin-dd 1x1"));
    assert!(
        svg.contains("nsgs-dd: over nsgs.") && svg.contains("Others: over the same method on one subdomain.")
    );
    // Neither has the run that it would be compared with.
    assert!(ratios(&figures(&[dd(0), latin(1, 4)], &curves())).is_none());
    let relaxed = Run { settings: object(&json!({ "relaxation": 0.8 })), ..nsgs(0) };
    assert!(ratios(&figures(&[relaxed, dd(1)], &curves())).is_none(), "another relaxation");
    assert!(ratios(&figures(&[nsgs(0), dd(1)], &[])).is_none(), "no curve");
}

#[test]
fn a_ratio_ends_as_the_run_that_reached_less() {
    let runs = [nsgs(0), on(1, "nsgs-dd", 2, Ending::IterationLimit), on(2, "nsgs-dd", 4, Ending::Converged)];
    let svg = |curves: &[(u32, Vec<Sample>)]| ratios(&figures(&runs, curves)).unwrap().to_owned();
    assert!(svg(&[(0, decay(20, 4)), (1, decay(40, 2)), (2, decay(20, 4))]).contains("iteration limit"));
    let nothing = svg(&[(0, decay(20, 4)), (2, decay(20, 4))]);
    assert!(!nothing.contains("iteration limit") && !nothing.contains("nsgs-dd 2x1"), "no point, no sign");
}

#[test]
fn curves_with_gaps_are_compared_at_whole_decades() {
    let ends = |decade: u64| -> Vec<Sample> {
        let kept = |s: &Sample| s.iteration.is_power_of_two() || s.iteration.is_multiple_of(decade);
        decay(decade, 4).into_iter().filter(kept).collect()
    };
    let study = study(&[nsgs(0), on(1, "nsgs-dd", 2, Ending::Converged)], &[(0, ends(20)), (1, ends(60))]);
    let (points, _) = super::ratios(&study.runs[1], &study.runs[0], contact::Measure::Zeta);
    let all: Vec<(f64, f64)> = points.into_iter().flatten().collect();
    assert_eq!(all.len(), 4);
    assert!(all.iter().all(|(_, ratio)| (ratio - 3f64.log10()).abs() < 1e-12), "{all:?}");
}
