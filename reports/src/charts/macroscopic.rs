//! Friction of a sheared packing: against that of its grains, and against the tolerance of the solver.

mod means;
#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;
use results::simulation::{Observed, SimulationEnding};

use crate::draw::{
    At, Curve, Guide, Look, MARKS, Mark, Panel, Plot, Scale, Side, Sign, TOLERANCE, Through, log,
    looks_in_time,
};
use crate::read::{Ending, Mean, OF_90, OF_95, Simulation, number, rising, span, unique};
use crate::text::{Part, chosen, frame};

const KEY: &str = "macroscopic";
/// Distance between methods that share a place, over the width of an axis.
const APART: f64 = 0.012;
/// Greatest difference in friction that counts as none (–): 0.4 to 1.2 standard deviations over packings of 200 discs.
const MARGIN: f64 = 0.01;

/// A simulation whose second half says something.
struct Sheared<'s> {
    simulation: &'s Simulation,
    /// μ of the grains (–).
    grains: f64,
    flow: Flow,
}

/// The second half of a series.
struct Flow {
    /// Mean and standard deviation in time of τ/σ (–).
    friction: f64,
    spread: f64,
    /// Distance of the mean of a quarter of it from that of the next: the possible error of a mean over so long a time (–).
    drift: f64,
    /// Contacts that push, per grain (–).
    coordination: f64,
    /// Volume of grains over volume in the bulk (–).
    solid_fraction: f64,
}

/// Averages the rows after half of its time; `None` if it did not come to its end, or if nothing presses.
fn flow(simulation: &Simulation) -> Option<Flow> {
    let series = simulation.series();
    let half = &series[series.len() / 2..];
    if simulation.status != SimulationEnding::Completed || half.len() < 2 {
        return None;
    }
    let ratios: Vec<f64> = half.iter().map(|row| row.stress.ratio()).collect::<Option<_>>()?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let friction = mean(&ratios);
    let squares: Vec<f64> = ratios.iter().map(|ratio| (ratio - friction).powi(2)).collect();
    let (first, last) = ratios.split_at(ratios.len() / 2);
    let of = |of: fn(&Observed) -> f64| mean(&half.iter().map(of).collect::<Vec<_>>());
    Some(Flow {
        friction,
        spread: mean(&squares).sqrt(),
        drift: (mean(last) - mean(first)).abs(),
        coordination: of(|row| row.stress.coordination),
        solid_fraction: of(|row| row.bulk.solid_fraction),
    })
}

fn sheared<'s>(all: &'s [Simulation]) -> Vec<Sheared<'s>> {
    let of = |simulation: &'s Simulation| {
        Some(Sheared { simulation, grains: simulation.friction()?, flow: flow(simulation)? })
    };
    all.iter().filter(|simulation| simulation.is_run()).filter_map(of).collect()
}

/// The figure and the tables `macroscopic`, `macroscopic-differences` and `macroscopic-means`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let sheared = sheared(all);
    let table = Part::table(KEY, table(&sheared), format!("\n{MEANING}\n"));
    let means = means::part(&sheared);
    let solved: Vec<Sheared> = sheared.into_iter().filter(|s| s.simulation.is_solved()).collect();
    let left_out = all.iter().filter(|simulation| simulation.is_run()).count() - solved.len();
    let differences = differences(&solved);
    let figure = (!solved.is_empty())
        .then(|| Part::figure(KEY, figure(&solved, &differences, &looks_in_time(all), left_out)));
    let note = format!(
        "\nDifference of a packing at a tolerance less the same packing, by the same method, at the least tolerance of the plan; of those \
         that met it in every time step of both. Low and high: Student's interval of 95 % of the mean, of five packings or more. \
         Equivalent: the interval of 90 % lies within ±{MARGIN} (two one-sided tests at 5 %); differs: that of 95 % does not hold 0, and \
         it is not equivalent; else not resolved.\n"
    );
    let differences = Part::table(format!("{KEY}-differences"), table_of_differences(&differences), note);
    figure.into_iter().chain([differences, means, table]).collect()
}

const MEANING: &str = "Friction of the packing is the mean of shear over normal stress (Love-Weber) in the second half of the time, \
                       its spread the standard deviation in time, its drift the distance of the means of the third and of the \
                       fourth quarter of the time.";

/// Differences of packings at a tolerance from themselves at the least one.
struct Difference {
    method: String,
    /// μ of the grains (–).
    grains: f64,
    tolerance: f64,
    packings: usize,
    /// Differences of friction, coordination and solid fraction.
    of: [Option<Mean>; 3],
    /// Interval of 90 % of the friction.
    narrow: Option<Mean>,
}

impl Difference {
    fn verdict(&self) -> &'static str {
        match (self.of[0], self.narrow) {
            (Some(_), Some(narrow)) if narrow.low >= -MARGIN && narrow.high <= MARGIN => "equivalent",
            (Some(of), _) if of.low > 0.0 || of.high < 0.0 => "differs",
            (Some(_), _) => "not resolved",
            (None, _) => "fewer than five packings",
        }
    }
}

/// Method, μ and tolerance of a packing, and the differences of its friction, coordination and solid fraction.
type Pair = ((String, f64, f64), [f64; 3]);

fn differences(solved: &[Sheared]) -> Vec<Difference> {
    let least = solved.iter().map(|s| s.simulation.tolerance).fold(f64::INFINITY, f64::min);
    let pair = |s: &Sheared| -> Option<Pair> {
        let is_same = |other: &&Sheared| {
            other.simulation.scene == s.simulation.scene
                && other.simulation.label() == s.simulation.label()
                && other.simulation.tolerance == least
        };
        let (flow, exact) = (&s.flow, &solved.iter().find(is_same)?.flow);
        let differences = [
            flow.friction - exact.friction,
            flow.coordination - exact.coordination,
            flow.solid_fraction - exact.solid_fraction,
        ];
        Some(((s.simulation.label(), s.grains, s.simulation.tolerance), differences))
    };
    let coarser = solved.iter().filter(|s| s.simulation.tolerance > least);
    let pairs: Vec<Pair> = coarser.filter_map(pair).collect();
    let of_kind = |kind: (String, f64, f64)| {
        let own: Vec<[f64; 3]> = pairs.iter().filter(|pair| pair.0 == kind).map(|pair| pair.1).collect();
        let mean =
            |k: usize, quantile| Mean::of(&own.iter().map(|pair| pair[k]).collect::<Vec<_>>(), quantile);
        let (method, grains, tolerance) = kind;
        let of = [0, 1, 2].map(|k| mean(k, OF_95));
        Difference { method, grains, tolerance, packings: own.len(), of, narrow: mean(0, OF_90) }
    };
    unique(pairs.iter().map(|pair| pair.0.clone())).into_iter().map(of_kind).collect()
}

fn table_of_differences(all: &[Difference]) -> DataFrame {
    let of = |k: usize, of: fn(&Mean) -> f64| {
        let value =
            |difference: &Difference| difference.of[k].as_ref().map(of).filter(|value| value.is_finite());
        all.iter().map(value).collect::<Vec<_>>()
    };
    frame(df!(
        "method" => all.iter().map(|d| d.method.as_str()).collect::<Vec<_>>(),
        "friction_of_grains" => all.iter().map(|d| d.grains).collect::<Vec<_>>(),
        "tolerance" => all.iter().map(|d| d.tolerance).collect::<Vec<_>>(),
        "packings" => all.iter().map(|d| d.packings as u64).collect::<Vec<_>>(),
        "friction" => of(0, |mean| mean.middle),
        "friction_low" => of(0, |mean| mean.low),
        "friction_high" => of(0, |mean| mean.high),
        "verdict" => all.iter().map(Difference::verdict).collect::<Vec<_>>(),
        "coordination" => of(1, |mean| mean.middle),
        "coordination_low" => of(1, |mean| mean.low),
        "coordination_high" => of(1, |mean| mean.high),
        "solid_fraction" => of(2, |mean| mean.middle),
        "solid_fraction_low" => of(2, |mean| mean.low),
        "solid_fraction_high" => of(2, |mean| mean.high),
    ))
}

fn table(sheared: &[Sheared]) -> DataFrame {
    let of = |value: fn(&Sheared) -> f64| sheared.iter().map(value).collect::<Vec<_>>();
    let own = df!(
        "method" => sheared.iter().map(|s| s.simulation.label()).collect::<Vec<_>>(),
        "friction_of_grains" => of(|s| s.grains),
        "friction_of_packing" => of(|s| s.flow.friction),
        "spread" => of(|s| s.flow.spread),
        "drift" => of(|s| s.flow.drift),
        "coordination" => of(|s| s.flow.coordination),
        "solid_fraction" => of(|s| s.flow.solid_fraction),
    );
    let names = "scene method tolerance friction_of_grains friction_of_packing spread drift coordination solid_fraction time_steps \
                 missed_time_steps iterations iterating_s";
    chosen(sheared.iter().map(|s| s.simulation), names, own)
}

/// A place on the x axis, and a value there between the bounds of its interval.
pub(super) type Place = (f64, [f64; 3]);

/// Left, at the least tolerance, against the μ of the grains; right, at the middle μ, the differences against the tolerance.
fn figure(
    solved: &[Sheared],
    differences: &[Difference],
    looks: &[(String, Look)],
    left_out: usize,
) -> String {
    let grains = rising(solved.iter().map(|s| s.grains));
    let middle = grains[grains.len() / 2];
    let tolerances = rising(solved.iter().map(|s| s.simulation.tolerance));
    let of_grains = |label: &str| {
        let at = |mu: &f64| {
            let here = solved.iter().filter(|s| s.grains == *mu && s.simulation.tolerance == tolerances[0]);
            let values: Vec<f64> =
                here.filter(|s| s.simulation.label() == label).map(|s| s.flow.friction).collect();
            Some((*mu, bounds(Mean::of(&values, OF_95)?)))
        };
        grains.iter().filter_map(at).collect()
    };
    let of_tolerance = |label: &str| {
        let here = differences.iter().filter(|d| d.grains == middle && d.method == label);
        here.filter_map(|d| Some((log(d.tolerance), bounds(d.of[0]?)))).collect()
    };
    let packings = grains.iter().map(|mu| {
        let here = solved.iter().filter(|s| s.grains == *mu && s.simulation.tolerance == tolerances[0]);
        unique(here.map(|s| s.simulation.scene.as_str())).len() as f64
    });
    let packings = match span(packings) {
        Some((least, most)) if least < most => format!("{least} to {most} packings"),
        counts => format!("{} packings", counts.map_or(0.0, |(least, _)| least)),
    };
    let apart = if looks.len() > 1 { "; methods stand a little apart to be seen" } else { "" };
    let text = format!("Means over {packings} for each μ at the left, with intervals of 95 %{apart}.");
    let mut signs = vec![(Sign::Word, text)];
    if left_out > 0 {
        let text = format!("Left out, not completed or with a time step missed: {left_out}.");
        signs.push((Sign::Word, text));
    }
    let title = vec![
        format!(
            "Friction of the packing against that of its grains, solved to {};",
            number(tolerances[0], 1)
        ),
        format!("and, with μ = {middle}, what a coarser tolerance changes, packing by packing."),
    ];
    let x = |scale, name: &str, values: &[f64]| Side::new(scale, name).holding(values.to_vec());
    let logs: Vec<f64> = tolerances.iter().skip(1).map(|tolerance| log(*tolerance)).collect();
    let y = |name: &str, holds: &[f64]| Side::new(Scale::Share, name).holding(holds.to_vec());
    let of_grains_sides =
        [x(Scale::Share, "friction μ of the grains (–)", &grains), y("friction τ/σ of the packing (–)", &[])];
    let of_tolerance_sides =
        [x(Scale::Ten, "tolerance of a time step (–)", &logs), y("change of τ/σ (–)", &[-MARGIN, MARGIN])];
    let left = panel(looks, &of_grains, &grains, of_grains_sides);
    let right = panel(looks, &of_tolerance, &logs, of_tolerance_sides);
    let margins = [-MARGIN, MARGIN]
        .map(|y| (y, Guide::new(At::Y(y), TOLERANCE, format!("±{MARGIN}, the margin of equivalence"))))
        .map(|(y, guide)| Guide { beside: y.to_string().replace('-', "−"), ..guide });
    let panels = vec![left, right.guided(margins)];
    Plot { title, panels, signs, ..Plot::default() }.svg()
}

fn bounds(Mean { low, middle, high }: Mean) -> [f64; 3] {
    [low, middle, high]
}

/// Values of each of some looks, with their intervals as bars.
pub(super) fn panel(
    looks: &[(String, Look)],
    places: &dyn Fn(&str) -> Vec<Place>,
    values: &[f64],
    [x, y]: [Side; 2],
) -> Panel {
    let wide = match values {
        [first, .., last] => last - first,
        _ => 1.0,
    };
    let marks = [Mark::Disc, Mark::Diamond, Mark::Square].into_iter().chain(MARKS).cycle();
    let mut curves = Vec::new();
    for (n, ((label, look), mark)) in looks.iter().zip(marks).enumerate() {
        let beside = (n as f64 - 0.5 * (looks.len() - 1) as f64) * APART * wide;
        let places = places(label);
        let point = |x: f64, y: f64| (Ending::Converged, (x + beside, y));
        let middle = places.iter().map(|(x, [_, middle, _])| point(*x, *middle)).collect();
        curves.push(Curve::new(label.clone(), Look { mark, ..*look }, middle, Through::Nothing));
        let bare = Look { mark: Mark::None, ..*look };
        curves.extend(places.iter().map(|(x, [low, _, high])| {
            Curve::new("", bare, vec![point(*x, *low), point(*x, *high)], Through::Points)
        }));
    }
    // Differences are small beside the room that an axis of shares leaves.
    let ends =
        curves.iter().flat_map(|curve| &curve.points).map(|(_, (_, y))| *y).chain(y.holds.iter().copied());
    let range = span(ends).map(|(low, high)| (low - 0.1 * (high - low), high + 0.1 * (high - low)));
    Panel::new(x, Side { range, ..y }, curves)
}
