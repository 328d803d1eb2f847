//! Friction of a sheared packing: against that of its grains, and against the tolerance of the solver.

#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    Canvas, INSIDE, Legend, Look, MARKS, Mark, Pen, Place, Room, Scale, Sign, log, looks_in_time, row,
};
use crate::read::{Simulation, counted, number, padded, unique};
use crate::text::{Part, chosen};

const KEY: &str = "macroscopic";
/// Setting of a scene for the friction of its grains.
const FRICTION: &str = "scene.friction";
/// The share of the time steps that may miss the tolerance of a simulation of which it is said that it was solved to it.
const MISSED: f64 = 0.1;
/// Distance between methods that share a place, over the width of an axis.
const APART: f64 = 0.012;
/// Half the width of the end of an error bar (mm).
const CAP: f64 = 0.7;

/// A simulation whose second half says something; or several of other packings, and their mean.
struct Sheared<'s> {
    /// The first.
    simulation: &'s Simulation,
    packings: usize,
    /// μ of the grains (–).
    grains: f64,
    flow: Flow,
}

impl Sheared<'_> {
    /// Reports whether its time steps were solved to its tolerance.
    fn is_solved(&self) -> bool {
        self.simulation.totals.missed_time_steps as f64 <= MISSED * self.simulation.totals.time_steps as f64
    }
}

/// The second half of a series.
struct Flow {
    /// Mean and standard deviation in time of τ/σ (–).
    friction: f64,
    spread: f64,
    /// Distance of the mean of a quarter of it from that of the next: the possible error of a mean over so long a time (–). Of several
    /// packings the standard error of their mean.
    drift: f64,
    /// Contacts that push, per grain (–).
    coordination: f64,
}

/// Averages the rows after half of its time; `None` if it did not come to its end, or if nothing presses.
fn flow(simulation: &Simulation) -> Option<Flow> {
    let series = simulation.series();
    let half = &series[series.len() / 2..];
    if simulation.status != "completed" || half.len() < 2 {
        return None;
    }
    let ratios: Vec<f64> = half.iter().map(|row| row.stress.ratio()).collect::<Option<_>>()?;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let friction = mean(&ratios);
    let squares: Vec<f64> = ratios.iter().map(|ratio| (ratio - friction).powi(2)).collect();
    let (first, last) = ratios.split_at(ratios.len() / 2);
    let coordination: Vec<f64> = half.iter().map(|row| row.stress.coordination).collect();
    Some(Flow {
        friction,
        spread: mean(&squares).sqrt(),
        drift: (mean(last) - mean(first)).abs(),
        coordination: mean(&coordination),
    })
}

fn sheared<'s>(all: &'s [Simulation]) -> Vec<Sheared<'s>> {
    let of = |simulation: &'s Simulation| {
        let grains = simulation.scene_settings.get(FRICTION)?.as_f64()?;
        Some(Sheared { simulation, packings: 1, grains, flow: flow(simulation)? })
    };
    all.iter().filter(|simulation| simulation.is_run()).filter_map(of).collect()
}

/// The mean over packings of what has the same μ, method and tolerance.
fn over_packings(sheared: Vec<Sheared>) -> Vec<Sheared> {
    let mut groups: Vec<Vec<Sheared>> = Vec::new();
    for one in sheared {
        let is_like = |other: &Sheared| {
            (one.grains, one.simulation.tolerance) == (other.grains, other.simulation.tolerance)
                && one.simulation.label() == other.simulation.label()
        };
        match groups.iter_mut().find(|group| is_like(&group[0])) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups.into_iter().map(mean_of).collect()
}

fn mean_of(group: Vec<Sheared>) -> Sheared {
    let packings = group.len();
    let mean = |of: &dyn Fn(&Flow) -> f64| group.iter().map(|s| of(&s.flow)).sum::<f64>() / packings as f64;
    let friction = mean(&|flow| flow.friction);
    let off = mean(&|flow| (flow.friction - friction).powi(2));
    let drift = if packings == 1 { group[0].flow.drift } else { (off / (packings - 1) as f64).sqrt() };
    let spread = mean(&|flow| flow.spread.powi(2)).sqrt();
    let flow = Flow { friction, spread, drift, coordination: mean(&|flow| flow.coordination) };
    Sheared { packings, flow, ..group.into_iter().next().expect("a group has one that began it") }
}

/// The figure, the sentences and the table `macroscopic`.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let sheared = sheared(all);
    let table = Part::table(KEY, table(&sheared), format!("\n{MEANING}\n"));
    let (solved, missed): (Vec<Sheared>, Vec<Sheared>) = sheared.into_iter().partition(Sheared::is_solved);
    let (runs, solved) = (solved.len() + missed.len(), over_packings(solved));
    let mut parts = Vec::new();
    if !solved.is_empty() {
        parts.push(Part::figure(KEY, figure(&solved, &looks_in_time(all))));
    }
    parts.push(Part::text("macroscopic-found", sentences(all, &solved, (missed.len(), runs))));
    parts.push(table);
    parts
}

const MEANING: &str = "Friction of the packing is the mean of shear over normal stress (Love-Weber) in the second half of the time, \
                       its spread the standard deviation in time, its drift the distance of the means of the third and of the \
                       fourth quarter of the time.";

fn table(sheared: &[Sheared]) -> DataFrame {
    let of = |value: fn(&Sheared) -> f64| sheared.iter().map(value).collect::<Vec<_>>();
    let own = df!(
        "method" => sheared.iter().map(|s| s.simulation.label()).collect::<Vec<_>>(),
        "friction_of_grains" => of(|s| s.grains),
        "friction_of_packing" => of(|s| s.flow.friction),
        "spread" => of(|s| s.flow.spread),
        "drift" => of(|s| s.flow.drift),
        "coordination" => of(|s| s.flow.coordination),
    );
    let names = "scene method tolerance friction_of_grains friction_of_packing spread drift coordination time_steps \
                 missed_time_steps iterations iterating_s";
    chosen(sheared.iter().map(|s| s.simulation), names, own)
}

/// The μ with which tolerances are compared: the middle one.
fn middle(sheared: &[Sheared]) -> f64 {
    let mut grains = unique(sheared.iter().map(|s| s.grains));
    grains.sort_by(f64::total_cmp);
    grains[grains.len() / 2]
}

/// The least tolerance that a method met with this μ.
fn tightest(sheared: &[Sheared], grains: f64) -> f64 {
    let tolerances = sheared.iter().filter(|s| s.grains == grains).map(|s| s.simulation.tolerance);
    tolerances.fold(f64::INFINITY, f64::min)
}

fn figure(sheared: &[Sheared], looks: &[(String, Look)]) -> String {
    let marks = [Mark::Disc, Mark::Diamond, Mark::Square].into_iter().chain(MARKS).cycle();
    let looks: Vec<(String, Look)> = looks
        .iter()
        .zip(marks)
        .map(|((label, look), mark)| (label.clone(), Look { mark, ..*look }))
        .collect();
    let middle = middle(sheared);
    let bars =
        (Sign::Word, "Bars: standard deviation in time. Methods stand a little apart to be seen.".to_owned());
    let legend = Legend::new(looks.clone(), vec![bars], INSIDE);
    let title = [format!(
        "Friction of the packing: at the least tolerance met, against μ of its grains; with μ = {middle}, against the tolerance"
    )];
    row(&title, 2, &legend, |canvas, i, room| {
        let name = ["friction μ of the grains (–)", "tolerance of a time step (–)"][i];
        let shown: Vec<(&Sheared, f64)> = if i == 0 {
            let is_tightest = |s: &&Sheared| s.simulation.tolerance == tightest(sheared, s.grains);
            sheared.iter().filter(is_tightest).map(|s| (s, s.grains)).collect()
        } else {
            sheared.iter().filter(|s| s.grains == middle).map(|s| (s, log(s.simulation.tolerance))).collect()
        };
        let scale = [Scale::Share, Scale::Ten][i];
        panel(canvas, &shown, sheared, &looks, (scale, name), room);
    })
}

fn panel(
    canvas: &Canvas,
    shown: &[(&Sheared, f64)],
    all: &[Sheared],
    looks: &[(String, Look)],
    (scale, name): (Scale, &str),
    room: Room,
) {
    let x = padded(shown.iter().map(|(_, x)| *x), 0.06);
    let ends = all.iter().flat_map(|s| [s.flow.friction - s.flow.spread, s.flow.friction + s.flow.spread]);
    let y = padded(ends.chain([0.0]), 0.04);
    let frame = room.frame(canvas, (scale, x, name), (Scale::Share, y, "friction τ/σ of the packing (–)"));
    let mut values = unique(shown.iter().map(|(_, x)| *x));
    values.sort_by(f64::total_cmp);
    let rank = |x: f64| values.partition_point(|value| *value < x);
    for (n, (label, look)) in looks.iter().enumerate() {
        let beside = (n as f64 - 0.5 * (looks.len() - 1) as f64) * APART * (x.1 - x.0);
        let mut points: Vec<(f64, &Flow)> = shown
            .iter()
            .filter(|(s, _)| s.simulation.label() == *label)
            .map(|(s, x)| (*x, &s.flow))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let place = |x: f64, friction: f64| frame.place((x + beside, friction));
        // A line does not pass over a place where others stand and this method does not.
        for joined in points.chunk_by(|a, b| rank(b.0) == rank(a.0) + 1) {
            let places: Vec<Place> = joined.iter().map(|(x, flow)| place(*x, flow.friction)).collect();
            canvas.line(&places, look.pen);
        }
        let bar = Pen::solid(look.pen.color, 0.2);
        for (x, flow) in points {
            let ends = [-flow.spread, flow.spread].map(|by| place(x, flow.friction + by));
            canvas.line(&ends, bar);
            for (x, y) in ends {
                canvas.line(&[(x - CAP, y), (x + CAP, y)], bar);
            }
            canvas.mark(look.mark, place(x, flow.friction), Pen { dash: &[], ..look.pen });
        }
    }
}

/// For each μ, what friction is at the least tolerance, and from which tolerance on no method is farther from it than the means
/// themselves are sure.
fn sentences(all: &[Simulation], sheared: &[Sheared], (missed, telling): (usize, usize)) -> String {
    let mut text = String::new();
    let mut grains = unique(sheared.iter().map(|s| s.grains));
    grains.sort_by(f64::total_cmp);
    for grains in grains {
        let of_grains: Vec<&Sheared> = sheared.iter().filter(|s| s.grains == grains).collect();
        let mut tolerances = unique(of_grains.iter().map(|s| s.simulation.tolerance));
        tolerances.sort_by(f64::total_cmp);
        let at = |tolerance: f64| {
            of_grains.iter().copied().filter(move |s| s.simulation.tolerance == tolerance).collect::<Vec<_>>()
        };
        let tight = at(tolerances[0]);
        let packings = tight.iter().map(|s| s.packings).max().unwrap_or(1);
        let friction = tight.iter().map(|s| s.flow.friction).sum::<f64>() / tight.len() as f64;
        // Of a mean over so long a time, and of methods that all solve as well as they can.
        let apart = tight.iter().map(|s| (s.flow.friction - friction).abs());
        let sure = apart.chain(tight.iter().map(|s| s.flow.drift)).fold(0.0, f64::max);
        let off = |tolerance: f64| {
            at(tolerance).iter().map(|s| (s.flow.friction - friction).abs()).fold(0.0, f64::max)
        };
        let near = tolerances.iter().take_while(|tolerance| off(**tolerance) <= sure).count();
        let found = match tolerances.get(near) {
            _ if tolerances.len() == 1 => "no other tolerance was met".to_owned(),
            None => {
                format!("no tolerance up to {} changes it by more", number(tolerances[near - 1], 2))
            }
            Some(far) => {
                let enough = match near {
                    0 | 1 => "already".to_owned(),
                    near => format!("a tolerance of {} is enough;", number(tolerances[near - 1], 2)),
                };
                format!("{enough} one of {} is off by {}", number(*far, 2), number(off(*far), 2))
            }
        };
        text.extend([format!(
            "μ = {grains}: the packing has a friction of {} ± {} when solved to {} (mean of {}{} in the second half of the time; ±: \
             the farthest method, or {}); {found}.\n",
            number(friction, 3),
            number(sure, 2),
            number(tolerances[0], 2),
            counted(tight.len(), "method"),
            if packings > 1 { format!(" and {packings} packings") } else { String::new() },
            if packings > 1 { "the standard error" } else { "the drift between the quarters of that half" },
        )]);
    }
    let runs = all.iter().filter(|simulation| simulation.is_run()).count();
    if missed > 0 {
        text.extend([format!(
            "{missed} of {runs} simulations are left out of figure and sentences: they missed their tolerance in more than a tenth \
             of their time steps.\n"
        )]);
    }
    let silent = runs - telling;
    if silent > 0 {
        text.extend([format!(
            "{silent} of {runs} simulations say nothing: they did not come to their end, or nothing pressed.\n"
        )]);
    }
    text
}
