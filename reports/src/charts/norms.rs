//! Worth of LMGC90's norm: the natural map where it first meets a tolerance, over packings.

use polars::df;
use polars::prelude::DataFrame;

use crate::read::{Norm, Problems, kinds, norms};
use crate::text::{Part, frame};

/// The table `norms`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let kinds = kinds(&study.runs);
    let all: Vec<Norm> = kinds.iter().flat_map(norms).collect();
    let note = "\nThe natural map at the first sample at which LMGC90's quadratic norm is at most its tolerance: median over the packings of \
                which it is, with an interval that holds it with a probability of at least 90 %, of fewer than five the least and the \
                greatest.\n";
    vec![Part::table("norms", table(&all), note)]
}

fn table(all: &[Norm]) -> DataFrame {
    let of = |of: fn(&Norm) -> f64| all.iter().map(of).collect::<Vec<_>>();
    frame(df!(
        "case" => all.iter().map(|norm| norm.kind.case.as_str()).collect::<Vec<_>>(),
        "kind" => all.iter().map(|norm| norm.kind.name.as_str()).collect::<Vec<_>>(),
        "grains" => all.iter().map(|norm| norm.kind.grains).collect::<Vec<_>>(),
        "method" => all.iter().map(|norm| norm.label.as_str()).collect::<Vec<_>>(),
        "quad_dv" => of(|norm| norm.tolerance),
        "packings" => all.iter().map(|norm| norm.packings as u64).collect::<Vec<_>>(),
        "met" => all.iter().map(|norm| norm.met as u64).collect::<Vec<_>>(),
        "natural_map" => of(|norm| norm.natural_map.median),
        "natural_map_low" => of(|norm| norm.natural_map.low),
        "natural_map_high" => of(|norm| norm.natural_map.high),
    ))
}
