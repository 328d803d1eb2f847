//! The cost of subdomains over several packings: iterations to each accuracy over those without subdomains, as medians with intervals.

use polars::df;
use polars::prelude::DataFrame;
use results::Median;

use super::convergence::MEASURES;
use crate::draw::{At, Curve, Guide, Looks, Panel, Plot, RGBColor, Scale, Side, TOLERANCE, Through};
use crate::read::{Ending, Growth, Kind, LEAST, Problems, counted, file_name, growth, kinds, rising, unique};
use crate::text::{Part, frame};

/// Ground of the interval of the most subdomains.
const INTERVAL: RGBColor = RGBColor(228, 228, 228);

/// The figures `growth-<kind>`, and the table `growth`.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let kinds = kinds(&study.runs);
    let ratios: Vec<Growth> = kinds.iter().flat_map(growth).collect();
    let looks = Looks::new(&study.runs);
    let mut parts = Vec::new();
    for kind in &kinds {
        let of_kind: Vec<&Growth> = ratios.iter().filter(|ratio| std::ptr::eq(ratio.kind, kind)).collect();
        if of_kind.iter().any(|ratio| ratio.ratio.is_some()) {
            let words = kind.name.replace([',', '='], "");
            let words: Vec<&str> =
                std::iter::once(kind.case.as_str()).chain(words.split_whitespace()).collect();
            let name = format!("growth-{}", file_name(&words.join("-")));
            // Sizes are told apart where there are several.
            let is_same = |other: &&Kind| (&other.case, &other.name) == (&kind.case, &kind.name);
            let several = kinds.iter().filter(is_same).count() > 1;
            let name = if several { format!("{name}-{}", kind.grains) } else { name };
            parts.push(Part::figure(name, figure(kind, &of_kind, &looks)));
        }
    }
    let note = format!(
        "\nRatio: iterations to the accuracy over those of the same method and settings on one subdomain, of NSGS-DD over NSGS; the median \
         over the packings of which both reach it, the one without subdomains after {LEAST} iterations or more, and an interval that \
         holds it with a probability of at least 90 %, of fewer than five the least and the greatest.\n"
    );
    parts.push(Part::table("growth", table(&ratios), note));
    parts
}

/// A row of panels for each method, a line for each number of subdomains, as far as all packings reach the accuracy.
fn figure(kind: &Kind, ratios: &[&Growth], looks: &Looks) -> String {
    let mut panels = Vec::new();
    for label in unique(ratios.iter().map(|ratio| ratio.label.as_str())) {
        let of_method: Vec<&Growth> = ratios.iter().filter(|ratio| ratio.label == label).copied().collect();
        let most = of_method.iter().map(|ratio| ratio.subdomains).max().unwrap_or(1);
        for (measure, name) in MEASURES {
            let line = |subdomains: u32| -> Vec<(f64, Median)> {
                let here = |ratio: &&&Growth| ratio.subdomains == subdomains && ratio.measure == measure;
                let whole = |ratio: &&Growth| {
                    Some((ratio.log, ratio.ratio.filter(|_| ratio.packings == ratio.pairs)?))
                };
                of_method.iter().filter(here).filter_map(whole).collect()
            };
            let curve = |subdomains: u32| {
                let run =
                    of_method.iter().find(|ratio| ratio.subdomains == subdomains).map(|ratio| ratio.run)?;
                let points = line(subdomains)
                    .iter()
                    .map(|(log, ratio)| (*log, ratio.median.log10()))
                    .collect::<Vec<_>>();
                let points = points.into_iter().map(|point| (Ending::Converged, point)).collect();
                let look = looks.look(run).signed();
                Some(Curve::new(format!("{label}, {subdomains} subdomains"), look, points, Through::Points))
            };
            let numbers = rising(of_method.iter().map(|ratio| f64::from(ratio.subdomains)));
            let interval: Vec<(f64, f64)> = {
                let (low, high): (Vec<_>, Vec<_>) = line(most)
                    .iter()
                    .map(|(log, ratio)| ((*log, ratio.low.log10()), (*log, ratio.high.log10())))
                    .unzip();
                low.into_iter().chain(high.into_iter().rev()).collect()
            };
            let (x, y) = (
                Side::new(Scale::Ten, name),
                Side::new(Scale::Ten, format!("{label}: ratio of iterations (–)")),
            );
            let guide = Guide::new(At::Y(0.0), TOLERANCE, "as many iterations");
            let curves = numbers.iter().filter_map(|number| curve(*number as u32)).collect();
            let ends = interval.iter().map(|(_, y)| *y).chain([-0.02, 0.222]).collect::<Vec<_>>();
            panels.push(Panel {
                areas: if interval.len() > 2 { vec![(INTERVAL, interval)] } else { Vec::new() },
                ..Panel::new(x, y.holding(ends), curves).guided([guide])
            });
        }
    }
    let title = vec![
        format!("{}, {}, {}: medians of iterations over those without subdomains.", kind.case, kind.name, counted(kind.problems(), "packing")),
        "Grey: the interval of the median, with the most subdomains. A line ends where not every packing reaches the accuracy.".to_owned(),
    ];
    Plot { title, panels, columns: MEASURES.len(), ..Plot::default() }.svg()
}

fn table(ratios: &[Growth]) -> DataFrame {
    let ratios: Vec<&Growth> = ratios.iter().filter(|ratio| ratio.ratio.is_some()).collect();
    let of =
        |of: fn(&Median) -> f64| ratios.iter().map(|ratio| ratio.ratio.as_ref().map(of)).collect::<Vec<_>>();
    frame(df!(
        "case" => ratios.iter().map(|ratio| ratio.kind.case.as_str()).collect::<Vec<_>>(),
        "kind" => ratios.iter().map(|ratio| ratio.kind.name.as_str()).collect::<Vec<_>>(),
        "grains" => ratios.iter().map(|ratio| ratio.kind.grains).collect::<Vec<_>>(),
        "method" => ratios.iter().map(|ratio| ratio.label.as_str()).collect::<Vec<_>>(),
        "subdomains" => ratios.iter().map(|ratio| ratio.subdomains).collect::<Vec<_>>(),
        "measure" => ratios.iter().map(|ratio| ratio.measure.name()).collect::<Vec<_>>(),
        "accuracy" => ratios.iter().map(|ratio| 10f64.powf(ratio.log)).collect::<Vec<_>>(),
        "packings" => ratios.iter().map(|ratio| ratio.pairs as u64).collect::<Vec<_>>(),
        "reached" => ratios.iter().map(|ratio| ratio.packings as u64).collect::<Vec<_>>(),
        "ratio" => of(|ratio| ratio.median),
        "ratio_low" => of(|ratio| ratio.low),
        "ratio_high" => of(|ratio| ratio.high),
    ))
}

#[cfg(test)]
mod tests;
