//! The declared charts: a new one is one more declaration here, and its line in `CHARTS`.

use contact::Measure;
use serde::Deserialize;

use super::curves::{Curves, Of, Sampled};
use super::lines::{Each, Ideal, Lines};
use super::quantities::{UnknownQuantity, named};
use crate::draw::Through;
use crate::read::{COSTS, Ending, RunRow, Sample};

const fn cost(title: &'static str, of: fn(&RunRow, &Sample) -> Option<f64>) -> Sampled {
    Sampled { title, short: title, of: Of::Cost(of) }
}

const fn measure(title: &'static str, short: &'static str, measure: Measure) -> Sampled {
    Sampled { title, short, of: Of::Measure(measure) }
}

const ITERATION: Sampled = cost("iterations", |_, point| Some(point.iteration as f64));
const SECONDS: Sampled = cost(COSTS[0].title, COSTS[0].of);
const WORK: Sampled = cost(COSTS[1].title, COSTS[1].of);
const ZETA: Sampled = measure("ζ, relative change in the last iteration (–)", "ζ (–)", Measure::Zeta);
const NATURAL_MAP: Sampled = measure("natural map (–)", "natural map (–)", Measure::NaturalMap);
const QUAD_DV: Sampled =
    measure("quadratic norm of LMGC90 (–)", "quadratic norm of LMGC90 (–)", Measure::QuadDv);
const ERROR: Sampled = measure("velocity error (–)", "velocity error (–)", Measure::VelocityError);

/// Measures against iterations: ζ, the paper's indicator, on the left, and the natural map of the same runs.
pub(super) const CONVERGENCE: Curves = Curves {
    name: "convergence",
    title: "How the paper's indicator ζ and a residual, the natural map, fall with the iterations",
    panels: &[(ITERATION, ZETA), (ITERATION, NATURAL_MAP)],
    of_truth: false,
    against_error: false,
    stairs: false,
    key: &[],
};

/// Speed and accuracy: the natural map against seconds, of problems whose solutions need not be known.
pub(super) const SPEED: Curves = Curves {
    name: "speed",
    title: "The residual that each method leaves after so many seconds",
    panels: &[(SECONDS, NATURAL_MAP)],
    stairs: true,
    ..CONVERGENCE
};

/// Work and precision: the velocity error against seconds and against counted work.
pub(super) const WORK_PRECISION: Curves = Curves {
    name: "work-precision",
    title: "The error that is left after so many seconds, and after so much counted work",
    panels: &[(SECONDS, ERROR), (WORK, ERROR)],
    of_truth: true,
    stairs: true,
    key: &[
        "Counted work is without factorisations that a library makes; runs with more than a few have none.",
    ],
    ..CONVERGENCE
};

/// Measures against the velocity error.
pub(super) const TRUTH: Curves = Curves {
    name: "truth",
    title: "Each measure against the velocity error of the same iterate",
    panels: &[(ERROR, ZETA), (ERROR, NATURAL_MAP), (ERROR, QUAD_DV)],
    of_truth: true,
    against_error: true,
    stairs: false,
    key: &["A band holds a curve that goes up and down; the line in it is the median."],
};

const AS_MANY_TIMES: &str = "ideal: as many times faster as there are subdomains";
const AS_MANY: Ideal = Ideal::X(AS_MANY_TIMES);

pub(super) const OF_SUBDOMAINS: Lines = Lines {
    name: "subdomains",
    title: "What subdomains cost: iterations to the tolerance, and seconds of one",
    figures: "",
    x: "subdomains",
    y: "iterations seconds_per_iteration",
    varied: "subdomains",
    apart: None,
    each: Each::Problem,
    through: Through::Points,
    of: |_| true,
    ideals: &[],
    key: "",
    columns: "problem method subdomains status iterations growth seconds_per_iteration setup_s seconds",
    note: "\nGrowth: iterations over those of the same method and settings with the fewest subdomains. Iterations of different \
           methods are different work: one of active-set, convex, interior-point or newton-schur may factorise.\n",
};

pub(super) const CRITICAL_PATH: Lines = Lines {
    name: "critical-path",
    title: "Speed-up by subdomains, counted on the longest of them and measured",
    y: "counted_speed_up measured_speed_up",
    of: |run| run.status != Ending::Skipped && run.path_per_iteration().is_some(),
    ideals: &[("counted_speed_up", AS_MANY), ("measured_speed_up", Ideal::OnThreads(AS_MANY_TIMES))],
    key: "Counted: multiply-adds of the longest subdomain, no communication cost.",
    columns: "problem method contacts subdomains status iterations path_per_iteration counted_speed_up \
              measured_speed_up ns_per_contact",
    note: "\nThe critical path of an iteration is the multiply-adds of the longest subdomain, exchange with its \
           neighbours included; messages between machines cost nothing in it. A speed-up is over the run of the same \
           method and settings on the same problem with the fewest subdomains, both to the same tolerance. It passes \
           the ideal where the factors of smaller subdomains have fewer entries per contact, or iterations are fewer.\n",
    ..OF_SUBDOMAINS
};

pub(super) const WEAK: Lines = Lines {
    name: "weak",
    title: "What more subdomains of the same size cost",
    y: "to_natural_map_1e_2 iterations longest_subdomain time",
    apart: Some(|run| format!("{} grains each", f64::from(run.grains) / f64::from(run.subdomains))),
    each: Each::Study,
    of: |run| run.status != Ending::Skipped && run.path_per_iteration().is_some(),
    key: "As many grains in each subdomain along a line.",
    columns: "method grains_per_subdomain subdomains grains status to_natural_map_1e_2 iterations growth \
              longest_subdomain seconds_per_iteration",
    note: "\nThe longest subdomain: its multiply-adds in all iterations, exchange with its neighbours included; with a \
           machine per subdomain the time to the tolerance goes with it, and constant is ideal. Growth: iterations over \
           those with the fewest subdomains, as many grains in each. Of the numbers of grains in each subdomain, those \
           that come most often.\n",
    ..OF_SUBDOMAINS
};

pub(super) const SIZE: Lines = Lines {
    name: "size",
    title: "How cost grows with the number of grains",
    x: "grains",
    y: "to_natural_map_1e_2 iterations seconds work",
    varied: "",
    // Sizes of other cases are no sizes of this one.
    apart: Some(|_| String::new()),
    each: Each::Study,
    through: Through::Fit,
    columns: "",
    note: "\nCost = a · grains^exponent, least squares in logarithms over the runs that converged, or reached 10⁻² on their \
           way; none on fewer than 3 sizes. Low and high: Student's interval of 95 %, of six runs or more; those that did not \
           converge are not in it. {WORK}\n",
    ..OF_SUBDOMAINS
};

/// The plane and space side by side, with and without friction, for as many subdomains.
pub(super) const DIMENSIONS: Lines = Lines {
    name: "dimensions",
    title: "Cost in the plane and in space, for as many subdomains",
    x: "dimensions",
    y: "iterations work entries_per_grain boundary_share",
    apart: Some(in_each_dimension),
    each: Each::Study,
    through: Through::Medians,
    of: |run| run.spectrum.contains_key("dimensions"),
    columns: "problem dimensions grains method subdomains status iterations work entries_per_grain boundary_share neighbours",
    note: "\nLines join medians. Work: counted, in sweeps. Entries: those of the triangular factors of all subdomains, per grain; \
           of factors that are made anew the mean. Boundary: of the grains of all subdomains, copies counted each, the share \
           that others hold too.\n",
    ..OF_SUBDOMAINS
};

fn in_each_dimension(run: &RunRow) -> String {
    let unknowns = run.spectrum.get("unknowns").and_then(serde_json::Value::as_f64);
    let friction = if unknowns > Some(1.0) { "with friction" } else { "without friction" };
    if run.subdomains == 1 {
        friction.to_owned()
    } else {
        format!("{} subdomains {friction}", run.subdomains)
    }
}

/// With a rank for each subdomain, from counts.
pub(super) const ON_RANKS: Lines = Lines {
    name: "ranks",
    title: "Predicted speed-up with a rank for each subdomain",
    y: "iterations predicted_s predicted_speed_up",
    ideals: &[("predicted_speed_up", AS_MANY)],
    key: "Predicted for a rank per subdomain, messages of 1.5 µs and 12 GB/s.",
    columns: "problem method subdomains status iterations neighbours sent_bytes work_s messages_s sums_s predicted_s \
              predicted_speed_up",
    note: "\nPredicted, with a rank for each subdomain, of nsgs-dd with one exchange an iteration, latin-dd and cg: \
           T = w + e (m α + β B) + k α ⌈log₂ p⌉ for an iteration. w: the seconds of the run with the fewest subdomains, on one \
           thread, in proportion to the counted work of the longest subdomain; of cg, to their number. m and B: counted \
           neighbours and bytes of the subdomain that has most; e: exchanges, of cg one for each product with W; k: sums over all \
           ranks, of cg four, of coarse problems one. α = 1.5 µs and 1/β = 12 GB/s, those of a cluster. It knows nothing of ranks \
           that share a memory's bandwidth, of caches, nor of those that are late.\n",
    ..OF_SUBDOMAINS
};

/// Seconds of runs on ranks over their prediction.
pub(super) const MEASURED_ON_RANKS: Lines = Lines {
    name: "ranks",
    title: "Seconds of an iteration on ranks, measured over predicted",
    figures: "ranks-measured",
    x: "ranks",
    y: "measured_over_predicted",
    varied: "ranks",
    each: Each::PanelOfProblem,
    ideals: &[("measured_over_predicted", Ideal::One("as predicted; of one rank by definition"))],
    key: "More ranks than processors take longer.",
    columns: "problem method ranks iterations seconds_per_iteration work_s messages_s predicted_s=iteration_s \
              measured_over_predicted",
    note: "\nPredicted of an iteration on p ranks: T = w/p + m α + β B. w: the seconds of one rank; m and B: messages and bytes of \
           a rank, those of sums over all ranks included, counted; α and β: what `gravel-mpi ping` measures before the runs. It \
           knows nothing of ranks that share a memory's bandwidth or a processor, of caches, nor of those that are late.\n",
    ..OF_SUBDOMAINS
};

/// A chart "y against x by series" that a plan declares; quantities stand by their names.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnChart {
    /// Name of its table, and begin of those of its figures.
    pub name: String,
    /// First line of its figures; without it the names of its quantities.
    pub title: Option<String>,
    /// Quantity on the x axis.
    pub x: String,
    /// Quantities on the y axes, a panel each.
    pub y: Vec<String>,
    /// Setting in which the runs of a line differ; the name of x without it.
    pub varied: Option<String>,
    /// True where a figure of all problems has powers of x fitted to the runs; false where each problem has a figure.
    #[serde(default)]
    pub fit: bool,
}

/// Declares what a plan asks for; its texts are kept as long as the program runs, as those of other charts are.
pub(super) fn own(own: OwnChart) -> Result<Lines, UnknownQuantity> {
    let unknown = |name: &&String| named(name).is_none();
    if let Some(name) = std::iter::once(&own.x).chain(&own.y).find(unknown) {
        return Err(UnknownQuantity(name.clone()));
    }
    let kept = |text: String| -> &'static str { text.leak() };
    let (x, y) = (kept(own.x), kept(own.y.join(" ")));
    let (each, through) =
        if own.fit { (Each::Study, Through::Fit) } else { (Each::Problem, Through::Points) };
    Ok(Lines {
        name: kept(own.name),
        title: kept(own.title.unwrap_or_else(|| format!("{} against {x}", y.replace(' ', ", ")))),
        x,
        y,
        varied: own.varied.map_or(x, kept),
        each,
        through,
        columns: if own.fit { "" } else { kept(format!("problem method {x} status {y}")) },
        note: "",
        ..OF_SUBDOMAINS
    })
}
