//! The atlas of stability: where each method converges, is slow, stalls, diverges or converges falsely.

mod class;
mod hazard;
pub(super) mod in_time;
#[cfg(test)]
mod tests;

use contact::Measure;
use polars::df;
use polars::prelude::{Column, DataFrame};
use serde_json::Value;

use super::grid::{Grid, Head, Tile};
use crate::read::{Problems, RunRow, Sample, Verdicts, file_name, unique};
use crate::text::{Part, chosen, frame};
use class::{Class, counts, zeta_is_false};
use hazard::{Hazard, hazards};

/// Height of a hazard (mm).
const ROW: f64 = 7.0;
/// Greatest width of a column (mm).
const WIDEST: f64 = 16.0;

/// A run with its class.
struct Judged<'r> {
    run: &'r RunRow,
    class: Class,
    /// True where ζ met the tolerance far from the solution on the way.
    zeta_is_false: bool,
}

/// A method with its settings, in the order of the study.
struct Kind<'r> {
    method: &'r str,
    variants: Vec<&'r str>,
}

/// Meaning of the classes and the letters.
const RULE: &str = "\nConverged: the measure met the tolerance; false convergence: it did, with a velocity error of more than 100 \
tolerances, or where there is no solution. Infeasible: it was proved that there is no solution; failed: it was claimed, and \
there is one. Slow: all iterations were made, and the least measure of \
their second half is at least 1 % below that of the first; stalled: it is not. Diverged: not finite, or an energy beyond all \
scales. Skipped: the method cannot start, and says why. False ζ: it met the tolerance at an iterate with a velocity error of more \
than 100 tolerances, or of a problem without solution. λmax is the greatest eigenvalue of W_D⁻¹W, where W_D is the diagonal of W; \
closed: over the contacts that the solution keeps closed, λ̃; κ_opt = 1/√(λ̃min λ̃max); the coupling is that of what of W couples \
contacts of different subdomains. All are computed, where the contacts are few enough; elsewhere λmax is a lower bound by power \
iteration. Jacobi needs ω λmax < 2; nsgs and a gradient need ω, or a step, below 2; iterations grow with λ̃max/λ̃min.\n";

/// `atlas`, every method on every hazard; `atlas-<method>`, every setting of a method; the tables `atlas-counts`, and `atlas` with
/// every run.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let verdicts = Verdicts::of(runs);
    let judge = |run| {
        let class = match Class::of(run) {
            // Another run, or the reference, has a solution.
            Class::Infeasible if !verdicts.is_proof(run) => Class::Failed,
            class => class,
        };
        Judged { run, class, zeta_is_false: zeta_is_false(run) }
    };
    let judged: Vec<Judged> = runs.iter().map(judge).collect();
    let hazards = hazards(runs);
    let of_method = |method| {
        let of = runs.iter().filter(|run| run.method == method);
        Kind { method, variants: unique(of.map(|run| run.words.as_str())) }
    };
    let methods = unique(runs.iter().map(|run| run.method.as_str()));
    let kinds: Vec<Kind> = methods.into_iter().map(of_method).collect();
    let mut parts = Vec::new();
    if !judged.is_empty() {
        parts.push(Part::figure("atlas", matrix(&judged, &hazards, &kinds)));
    }
    for kind in kinds.iter().filter(|kind| kind.variants.len() > 1) {
        parts.push(Part::figure(format!("atlas-{}", file_name(kind.method)), map(&judged, &hazards, kind)));
    }
    let classes = kinds.iter().map(|kind| {
        let of = judged.iter().filter(|j| j.run.method == kind.method).map(|j| j.class);
        (kind.method.to_owned(), kind.variants.len(), of.collect())
    });
    let classes: Vec<_> = classes.collect();
    let of_runs = Class::all().take_while(|class| *class < Class::Stable);
    parts.push(Part::table("atlas-counts", counts(&classes, of_runs), RULE));
    parts.push(Part::table("atlas", table(&judged, &hazards), ""));
    parts
}

/// The run of a method with a setting on a problem.
fn find<'j, 'r>(
    judged: &'j [Judged<'r>],
    method: &str,
    variant: &str,
    problem: &str,
) -> Option<&'j Judged<'r>> {
    judged.iter().find(|j| j.run.problem == problem && j.run.method == method && j.run.words == variant)
}

/// Each method by the first of its settings in the plan, with a ring where another one converges.
fn matrix(judged: &[Judged], hazards: &[Hazard], kinds: &[Kind]) -> String {
    let several = kinds.iter().filter(|kind| kind.variants.len() > 1);
    let notes = several.map(|kind| format!("{}: {}", kind.method, setting(kind.variants[0]))).collect();
    let heads = kinds.iter().map(|kind| Head { short: kind.method.to_owned(), long: None }).collect();
    let title = "Every method, by the first of its settings in the plan".to_owned();
    of_hazards(hazards, (title, notes, heads), &|column, problem| {
        let Kind { method, variants } = &kinds[column];
        let Judged { class, zeta_is_false, .. } = *find(judged, method, variants[0], problem)?;
        let mut others = variants.iter().filter_map(|variant| find(judged, method, variant, problem));
        let mended = !class.is_good() && others.any(|other| other.class.is_good());
        Some(Tile { cells: vec![class.cell()], marks: [mended, zeta_is_false] })
    })
}

/// Every setting of one method.
fn map(judged: &[Judged], hazards: &[Hazard], Kind { method, variants }: &Kind) -> String {
    let long =
        |(i, variant): (usize, &&str)| Head { short: (i + 1).to_string(), long: Some(setting(variant)) };
    let heads = variants.iter().enumerate().map(long).collect();
    let title = format!("{method}, every setting in the plan");
    of_hazards(hazards, (title, Vec::new(), heads), &|column, problem| {
        let Judged { class, zeta_is_false, .. } = *find(judged, method, variants[column], problem)?;
        Some(Tile { cells: vec![class.cell()], marks: [false, zeta_is_false] })
    })
}

/// A grid of hazards, with the tile of a column on each of their problems.
fn of_hazards(
    hazards: &[Hazard],
    (title, notes, columns): (String, Vec<String>, Vec<Head>),
    tile: &dyn Fn(usize, &str) -> Option<Tile>,
) -> String {
    let rows = hazards.iter().map(|hazard| (hazard.name.as_str(), hazard.setting.as_str())).collect();
    let tiles: &dyn Fn(usize, usize) -> Vec<Option<Tile>> =
        &|row, column| hazards[row].problems.iter().map(|problem| tile(column, problem)).collect();
    let cells = Class::cells();
    let marks = ["converges with another setting", "ζ met the tolerance far from the solution"];
    Grid { title, notes, rows, height: ROW, widest: WIDEST, columns, cells, marks, tiles }.svg()
}

/// A variant as it is read: one without words has the method's defaults.
fn setting(variant: &str) -> String {
    if variant.is_empty() { "default".to_owned() } else { variant.to_owned() }
}

/// One row per run.
fn table(judged: &[Judged], hazards: &[Hazard]) -> DataFrame {
    let hazard = |j: &Judged| {
        let of = hazards.iter().find(|hazard| hazard.problems.contains(&j.run.problem));
        of.map(|hazard| hazard.name.clone())
    };
    let last = |of: fn(&Sample) -> Option<f64>| -> Vec<Option<f64>> {
        judged.iter().map(|j| j.run.curve.last().and_then(of)).collect()
    };
    let own = frame(df!(
        "hazard" => judged.iter().map(hazard).collect::<Vec<_>>(),
        "setting" => judged.iter().map(|j| setting(&j.run.words)).collect::<Vec<_>>(),
        "class" => judged.iter().map(|j| j.class.text()).collect::<Vec<_>>(),
        "natural_map" => last(|end| end.get(Measure::NaturalMap)),
        "velocity_error" => last(Sample::velocity_error),
        "zeta_is_false" => judged.iter().map(|j| j.zeta_is_false).collect::<Vec<_>>(),
    ));
    let spectrum = "lambda_max closed_lambda_max closed_lambda_min redundant kappa_opt multiplicity coupling";
    let spectral = |key: &str| {
        let of = |j: &Judged| j.run.spectrum.get(key).and_then(Value::as_f64);
        Column::new(key.into(), judged.iter().map(of).collect::<Vec<Option<f64>>>())
    };
    let own = own.hstack(&spectrum.split(' ').map(spectral).collect::<Vec<_>>());
    let names = "hazard problem contacts method setting class reason iterations natural_map velocity_error zeta_is_false";
    chosen(judged.iter().map(|j| j.run), &format!("{names} {spectrum}"), own)
}
