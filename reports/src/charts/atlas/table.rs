//! The tables of the atlas: each run with its class, and how often each method has which.

use contact::Measure;
use polars::df;
use polars::prelude::{Column, DataFrame};
use serde_json::Value;

use super::class::Class;
use super::hazard::Hazard;
use super::{Judged, Kind, setting};
use crate::read::Point;
use crate::text::{chosen, frame};

/// One row per run.
pub(super) fn runs(judged: &[Judged], hazards: &[Hazard]) -> DataFrame {
    let hazard = |j: &Judged| {
        let of = hazards.iter().find(|hazard| hazard.problems.contains(&j.run.problem));
        of.map(|hazard| hazard.name.clone())
    };
    let last = |of: fn(&Point) -> Option<f64>| -> Vec<Option<f64>> {
        judged.iter().map(|j| j.run.curve.last().and_then(of)).collect()
    };
    let own = frame(df!(
        "hazard" => judged.iter().map(hazard).collect::<Vec<_>>(),
        "setting" => judged.iter().map(|j| setting(&j.run.words)).collect::<Vec<_>>(),
        "class" => judged.iter().map(|j| j.class.text()).collect::<Vec<_>>(),
        "natural_map" => last(|end| end.get(Measure::NaturalMap)),
        "velocity_error" => last(Point::velocity_error),
        "zeta_lies" => judged.iter().map(|j| j.zeta_lies).collect::<Vec<_>>(),
    ));
    let spectrum = "lambda_max closed_lambda_max closed_lambda_min redundant kappa_opt multiplicity coupling";
    let spectral = |key: &str| {
        let of = |j: &Judged| j.run.spectrum.get(key).and_then(Value::as_f64);
        Column::new(key.into(), judged.iter().map(of).collect::<Vec<Option<f64>>>())
    };
    let own = own.hstack(&spectrum.split(' ').map(spectral).collect::<Vec<_>>());
    let names =
        "hazard problem contacts method setting class reason iterations natural_map velocity_error zeta_lies";
    chosen(judged.iter().map(|j| j.run), &format!("{names} {spectrum}"), own)
}

/// One row per method: its settings, and its runs by class.
pub(super) fn counts(judged: &[Judged], kinds: &[Kind]) -> DataFrame {
    let count = |(class, text, _): (Class, &str, _)| {
        let of = |kind: &Kind| {
            judged.iter().filter(|j| j.run.method == kind.method && j.class == class).count() as u64
        };
        Column::new(text.replace(' ', "_").into(), kinds.iter().map(of).collect::<Vec<_>>())
    };
    let table = frame(df!(
        "method" => kinds.iter().map(|kind| kind.method).collect::<Vec<_>>(),
        "settings" => kinds.iter().map(|kind| kind.variants.len() as u64).collect::<Vec<_>>(),
    ));
    frame(table.hstack(&Class::ALL.map(count)))
}
