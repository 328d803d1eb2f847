//! The tables of the atlas: each run with its class, and how often each method has which.

use contact::Measure;
use polars::df;
use polars::prelude::{Column, DataFrame};

use super::class::Class;
use super::hazard::Hazard;
use super::{Judged, Kind, setting};
use crate::text::frame;

/// One row per run.
pub(super) fn runs(judged: &[Judged], hazards: &[Hazard]) -> DataFrame {
    let hazard = |j: &Judged| {
        let of = hazards.iter().find(|hazard| hazard.problems.contains(&j.run.problem));
        of.map(|hazard| hazard.name.clone())
    };
    let spectral = |key: &str| -> Vec<Option<f64>> {
        judged.iter().map(|j| j.run.spectrum.get(key).and_then(serde_json::Value::as_f64)).collect()
    };
    frame(df!(
        "hazard" => judged.iter().map(hazard).collect::<Vec<_>>(),
        "problem" => judged.iter().map(|j| j.run.problem.as_str()).collect::<Vec<_>>(),
        "contacts" => judged.iter().map(|j| j.run.contacts).collect::<Vec<_>>(),
        "method" => judged.iter().map(|j| j.run.method.as_str()).collect::<Vec<_>>(),
        "setting" => judged.iter().map(|j| setting(&j.run.words)).collect::<Vec<_>>(),
        "class" => judged.iter().map(|j| j.class.text()).collect::<Vec<_>>(),
        "reason" => judged.iter().map(|j| j.run.reason.as_str()).collect::<Vec<_>>(),
        "iterations" => judged.iter().map(|j| j.run.iterations).collect::<Vec<_>>(),
        "natural_map" => judged.iter().map(|j| j.run.curve.last().and_then(|end| end.get(Measure::NaturalMap))).collect::<Vec<_>>(),
        "velocity_error" => judged.iter().map(|j| j.run.curve.last().and_then(|end| end.velocity_error())).collect::<Vec<_>>(),
        "zeta_lies" => judged.iter().map(|j| j.zeta_lies).collect::<Vec<_>>(),
        "lambda_max" => spectral("lambda_max"),
        "closed_lambda_max" => spectral("closed_lambda_max"),
        "closed_lambda_min" => spectral("closed_lambda_min"),
        "redundant" => spectral("redundant"),
        "kappa_opt" => spectral("kappa_opt"),
        "multiplicity" => spectral("multiplicity"),
        "coupling" => spectral("coupling"),
    ))
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
