//! Scenes that stand or slide by static friction, with exact answers: how far from these each method ends, and how fast what should
//! stand creeps.

use polars::df;
use polars::prelude::{Column, DataFrame};
use results::simulation::SimulationEnding;

use crate::draw::{
    BEST, Curve, FRAME, Look, MARKS, Mark, Panel, Pen, Plot, Points, Scale, Side, TOLERANCE, Through, log,
    looks_in_time,
};
use crate::read::{Ending, Simulation, milliseconds, number, rising, unique};
use crate::text::{Part, frame};

const KEY: &str = "statics";
/// Micrometres in a metre.
const MICRO: f64 = 1e6;
/// Least creep that is drawn (µm/s): 10 nm in a year. What is below is at the edge of its panel.
const LEAST: f64 = 1e-10;
/// Error above which an answer of the sweep is drawn as wrong (µm/s): what creeps by it is off by the width of a hair in a minute.
const WRONG: f64 = 1.0;

const NOTE: &str = "\nGreatest distance of a grain from where statics or a constant acceleration puts it, over the time simulated (µm/s): where the scene \
                    stands, how fast it creeps. Of several scenes the worst. Start: warm from the impulses of the time step before, cold \
                    from none. A dash: not simulated, or not to the end. Missed: tolerances that a time step \
                    missed.\n";

/// The exact answer of a scene: it stands from some μ on, and below moves with a constant acceleration where that is known.
struct Exact {
    case: &'static str,
    /// Returns the least μ (–) at which it stands.
    least: fn(&Simulation) -> Option<f64>,
    /// Returns the acceleration of what does not (m/s²), at this μ.
    acceleration: Option<fn(&Simulation, f64) -> Option<f64>>,
}

/// Acceleration of a weight of 10 N between two fingers that press with 20 N.
const PAST_TWO_FINGERS: fn(&Simulation, f64) -> Option<f64> = |_, friction| Some(10.0 - 40.0 * friction);

/// The answers that the cases state, with their sources.
const EXACT: &[Exact] = &[
    Exact { case: "block-on-slope", least: steep, acceleration: Some(down_the_slope) },
    Exact { case: "block-on-slope-in-space", least: steep, acceleration: Some(down_the_slope) },
    // A weight of 10 N, pressed by 20 N, on two sides and on one.
    Exact { case: "pinched", least: |_| Some(0.25), acceleration: Some(PAST_TWO_FINGERS) },
    Exact { case: "pinched-in-space", least: |_| Some(0.25), acceleration: Some(PAST_TWO_FINGERS) },
    Exact {
        case: "held-at-wall",
        least: |_| Some(0.5),
        acceleration: Some(|_, friction| Some(10.0 - 20.0 * friction)),
    },
    Exact { case: "stack-of-three", least: |s| stack(s, 3.0_f64.sqrt().recip(), 3.0), acceleration: None },
    Exact { case: "stack-of-four", least: |s| stack(s, 0.5_f64.sqrt(), 4.0), acceleration: None },
];

fn setting(simulation: &Simulation, key: &str) -> Option<f64> {
    simulation.scene_settings.get(key)?.as_f64()
}

fn slope(simulation: &Simulation) -> Option<f64> {
    setting(simulation, "scene.slope_rad")
}

fn steep(simulation: &Simulation) -> Option<f64> {
    Some(slope(simulation)?.tan())
}

fn down_the_slope(simulation: &Simulation, friction: f64) -> Option<f64> {
    let slope = slope(simulation)?;
    Some(simulation.gravity_m_per_s2 * (slope.sin() - friction * slope.cos()))
}

/// Returns the least μ of a heap of one grain on others whose lines of centres have this tangent to the vertical: that of half the angle;
/// on the floor so many times less. One whose floor is smoother than that never stands.
fn stack(simulation: &Simulation, tangent: f64, times: f64) -> Option<f64> {
    let least = (0.5 * tangent.atan()).tan();
    let floor = setting(simulation, "scene.box.friction")?;
    Some(if floor >= least / times { least } else { f64::INFINITY })
}

/// A simulation beside its exact answer.
struct Judged<'s> {
    simulation: &'s Simulation,
    friction: f64,
    stands: bool,
    /// Distance from the exact answer over the time (µm/s); none if it was not simulated to its end, or not measured.
    error: Option<f64>,
}

impl<'s> Judged<'s> {
    fn of(simulation: &'s Simulation) -> Option<Self> {
        let exact = EXACT.iter().find(|exact| exact.case == simulation.case())?;
        let friction = simulation.friction()?;
        let stands = friction >= (exact.least)(simulation)?;
        let acceleration = match exact.acceleration {
            _ if stands => 0.0,
            Some(of) => of(simulation, friction)?,
            None => return None,
        };
        let last = simulation.series().last().filter(|_| simulation.status == SimulationEnding::Completed);
        let error = last.map(|row| {
            let moved = 0.5 * acceleration * row.time_s * row.time_s;
            MICRO * (row.greatest_displacement_m - moved).abs() / row.time_s
        });
        let error = error.filter(|error| error.is_finite());
        Some(Self { simulation, friction, stands, error })
    }

    /// Returns the group of its scene: those of one case, law, time step and answer.
    fn group(&self) -> Group<'s> {
        let law = self.simulation.scene_settings.get("scene.law").and_then(|law| law.as_str());
        let milliseconds = milliseconds(self.simulation.time_step_s);
        Group { case: self.simulation.case(), law, milliseconds, stands: self.stands }
    }
}

/// Scenes of one case, law, time step and answer.
#[derive(Clone, Copy, PartialEq)]
struct Group<'s> {
    case: &'s str,
    law: Option<&'s str>,
    milliseconds: f64,
    stands: bool,
}

impl Group<'_> {
    /// Returns its name among others: with its time step where the case has several.
    fn title(&self, all: &[Self]) -> String {
        let law = self.law.map(|law| format!(", {law}")).unwrap_or_default();
        let same = |other: &Self| {
            (other.case, other.law) != (self.case, self.law) || other.milliseconds == self.milliseconds
        };
        let step =
            if all.iter().all(same) { String::new() } else { format!(", h = {} ms", self.milliseconds) };
        format!("{}{law}{step}", self.case)
    }
}

/// The figures `statics-warm`, `statics-cold`, `statics-boundary` and the table `statics`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let judged: Vec<Judged> = all.iter().filter(|one| one.is_run()).filter_map(Judged::of).collect();
    let looks = looks_in_time(all);
    let mut parts = Vec::new();
    for (name, warm) in [("statics-warm", true), ("statics-cold", false)] {
        if judged.iter().any(|one| one.stands && one.simulation.warm_start == warm) {
            parts.push(Part::figure(name, creep(&judged, &looks, warm)));
        }
    }
    if judged.iter().any(|one| one.simulation.case() == "block-on-slope" && one.simulation.warm_start) {
        parts.push(Part::figure(format!("{KEY}-boundary"), boundary(&judged)));
    }
    parts.push(Part::table(KEY, table(&judged), NOTE));
    parts
}

/// The worst of some simulations.
struct Worst {
    /// Greatest error (µm/s).
    error: f64,
    /// Set where a time step of one of them missed its tolerance.
    missed: bool,
}

/// Returns the worst of the simulations that `are`; `None` if there are none, or one came to no end.
fn worst(judged: &[Judged], are: impl Fn(&Judged) -> bool) -> Option<Worst> {
    let of: Vec<&Judged> = judged.iter().filter(|one| are(one)).collect();
    let errors: Option<Vec<f64>> = of.iter().map(|one| one.error).collect();
    let error = errors?.into_iter().reduce(f64::max)?;
    Some(Worst { error, missed: of.iter().any(|one| !one.simulation.is_solved()) })
}

/// Creep against tolerance of simulations that began each time step warm, or cold: a panel for each group that stands.
fn creep(judged: &[Judged], looks: &[(String, Look)], warm: bool) -> String {
    let groups = unique(judged.iter().filter(|one| one.stands).map(Judged::group));
    let tolerances = rising(judged.iter().map(|one| one.simulation.tolerance));
    let panel = |group: &Group| {
        let curve = |((label, look), mark): (&(String, Look), Mark)| {
            let at = |tolerance: &f64| {
                let of = |one: &Judged| {
                    let start = one.simulation.warm_start;
                    let is_of_group = one.group() == *group && one.simulation.label() == *label;
                    is_of_group && start == warm && one.simulation.tolerance == *tolerance
                };
                let worst = worst(judged, of).filter(|worst| !worst.missed)?;
                Some((Ending::Converged, (log(*tolerance), log(worst.error.max(LEAST)))))
            };
            let points: Points = tolerances.iter().filter_map(at).collect();
            Curve::new(label.clone(), Look { mark, ..*look }, points, Through::Points)
        };
        let curves = looks.iter().zip(MARKS.into_iter().cycle()).map(curve).collect();
        let y = Side::new(Scale::Ten, group.title(&groups));
        let x = Side::new(Scale::Ten, "tolerance: natural map (–)");
        Panel::new(x, y.holding([log(LEAST)]), curves)
    };
    let panels = groups.iter().map(panel).collect();
    let start = if warm { "from the impulses of the one before" } else { "from none" };
    let title = vec![
        format!("Creep of what stands (µm/s), each time step begun {start}"),
        format!(
            "On the lower edge: {} µm/s and less; left out where a time step missed its tolerance",
            number(LEAST, 1)
        ),
    ];
    Plot { title, panels, ..Plot::default() }.svg()
}

/// The sweep of the block over slope and friction at the middle tolerance: a panel for each method.
fn boundary(judged: &[Judged]) -> String {
    let sweep: Vec<&Judged> = judged.iter().filter(|one| one.simulation.case() == "block-on-slope").collect();
    let tolerances = rising(sweep.iter().map(|one| one.simulation.tolerance));
    let tolerance = tolerances[tolerances.len() / 2];
    let sweep =
        || sweep.iter().filter(|one| one.simulation.tolerance == tolerance && one.simulation.warm_start);
    let at = |one: &Judged| slope(one.simulation).map(|slope| (slope, one.friction));
    let steepest = sweep().filter_map(|one| at(one)).map(|(slope, _)| slope).fold(0.0, f64::max);
    let panel = |label: String| {
        let of = |name: &str, mark: Mark, pen: Pen, is: &dyn Fn(&Judged) -> bool| {
            let points =
                sweep().filter(|one| one.simulation.label() == label && is(one)).filter_map(|one| at(one));
            Curve::of(name, Look { pen, mark }, points, Through::Nothing)
        };
        let wrong = |one: &Judged| one.error.is_none_or(|error| error > WRONG);
        let line = (0..=64).map(|k| steepest * f64::from(k) / 64.0).map(|slope| (slope, slope.tan()));
        let exact = Look { pen: TOLERANCE, mark: Mark::None };
        let curves = vec![
            Curve::of("exact: it stands above tan(slope)", exact, line, Through::Points),
            of("stands", Mark::Disc, FRAME, &|one| one.stands && !wrong(one)),
            of("slides", Mark::Ring, FRAME, &|one| !one.stands && !wrong(one)),
            of("off by more than 1 µm/s, or not simulated to its end", Mark::Cross, BEST, &wrong),
        ];
        Panel::new(
            Side::new(Scale::Share, "slope (rad)"),
            Side::new(Scale::Share, format!("{label}: μ (–)")),
            curves,
        )
    };
    let panels = unique(sweep().map(|one| one.simulation.label())).into_iter().map(panel).collect();
    let title = vec![format!(
        "A block on a slope: what stands and what slides, at a tolerance of {}, begun warm",
        number(tolerance, 1)
    )];
    Plot { title, panels, ..Plot::default() }.svg()
}

fn table(judged: &[Judged]) -> DataFrame {
    fn key<'s>(one: &Judged<'s>) -> (Group<'s>, String, bool) {
        (one.group(), one.simulation.label(), one.simulation.warm_start)
    }
    let keys = unique(judged.iter().map(key));
    let groups: Vec<Group> = keys.iter().map(|(group, ..)| *group).collect();
    let text = |of: &dyn Fn(&Group, &str, bool) -> String| -> Vec<String> {
        keys.iter().map(|(group, label, warm)| of(group, label, *warm)).collect()
    };
    let mut table = frame(df!(
        "scene" => text(&|group, _, _| group.title(&groups)),
        "answer" => text(&|group, _, _| if group.stands { "stands" } else { "slides" }.to_owned()),
        "method" => text(&|_, label, _| label.to_owned()),
        "start" => text(&|_, _, warm| if warm { "warm" } else { "cold" }.to_owned()),
    ));
    let mut missed = vec![Vec::new(); keys.len()];
    let mut add = |name: String, column: Column| {
        table.with_column(column.with_name(name.into())).expect("columns are as long");
    };
    for tolerance in rising(judged.iter().map(|one| one.simulation.tolerance)).into_iter().rev() {
        let at = |(group, label, warm): &(Group, String, bool)| {
            worst(judged, |one| {
                key(one) == (*group, label.clone(), *warm) && one.simulation.tolerance == tolerance
            })
        };
        let column: Vec<Option<Worst>> = keys.iter().map(at).collect();
        for (missed, _) in missed
            .iter_mut()
            .zip(&column)
            .filter(|(_, worst)| worst.as_ref().is_some_and(|worst| worst.missed))
        {
            missed.push(number(tolerance, 1));
        }
        let errors: Vec<Option<f64>> = column.into_iter().map(|worst| Some(worst?.error)).collect();
        add(format!("at {}", number(tolerance, 1)), Column::new("".into(), errors));
    }
    let missed: Vec<Option<String>> =
        missed.into_iter().map(|missed| (!missed.is_empty()).then(|| missed.join(", "))).collect();
    add("missed".to_owned(), Column::new("".into(), missed));
    table
}

#[cfg(test)]
mod tests;
