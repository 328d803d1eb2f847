//! Accuracy of the simulation: errors of the trajectory against seconds per simulated second.

mod error;
#[cfg(test)]
mod tests;

use std::ops::Deref;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    Canvas, HPos, INK, INSIDE, LOWEST, Legend, Look, Mark, Pen, Place, Room, Scale, Sign, TICK_TEXT,
    TOLERANCE, VPos, log, looks_in_time, row,
};
use crate::read::{Simulation, file_name, in_role, milliseconds, number, padded, span, unique};
use crate::text::{Part, chosen};
use error::{OBSERVABLES, errors};

/// Tells time steps apart, from the longest.
const MARKS: [Mark; 5] = [Mark::Ring, Mark::Square, Mark::Diamond, Mark::Triangle, Mark::Cross];
/// Two references that differ in their tolerance alone: below their distance no error means anything.
const TWINS: Pen = Pen { color: INK, width: 0.3, dash: &[0.4, 0.5] };
/// A run within this factor of the error of its time step alone is as good as exact.
const AT_THE_FLOOR: f64 = 1.5;

/// A simulation beside the reference of its scene.
struct Compared<'s> {
    simulation: &'s Simulation,
    errors: Option<[f64; 4]>,
}

impl Deref for Compared<'_> {
    type Target = Simulation;

    fn deref(&self) -> &Simulation {
        self.simulation
    }
}

impl Compared<'_> {
    /// The i-th error (logarithm).
    fn error(&self, i: usize) -> Option<f64> {
        self.errors.map(|errors| log(errors[i]).max(LOWEST))
    }

    /// Seconds per second (logarithm).
    fn cost(&self) -> Option<f64> {
        self.seconds_per_second().map(log)
    }
}

/// `trajectory-<scene>` for each scene, `trajectory-found` in words, and the table `trajectory` with all errors.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let beside = |s: &Simulation| errors(s, in_role(all, &s.scene, "reference")?);
    let compared: Vec<Compared> =
        all.iter().map(|simulation| Compared { simulation, errors: beside(simulation) }).collect();
    let looks = looks_in_time(all);
    let mut parts = Vec::new();
    let mut text = String::new();
    for scene in unique(all.iter().map(|s| s.scene.as_str())) {
        let of_scene: Vec<&Compared> = compared.iter().filter(|c| c.scene == scene).collect();
        if of_scene.iter().any(|c| c.errors.is_some() && c.role != "reference") {
            let name = format!("trajectory-{}", file_name(scene));
            parts.push(Part::figure(name, figure(scene, &of_scene, &looks)));
        }
        text += &sentences(scene, &of_scene);
    }
    parts.push(Part::text("trajectory-found", text));
    parts.push(Part::table("trajectory", table(&compared), format!("\n{NORMS}\n")));
    parts
}

const NORMS: &str = "Errors over the common times of the series, beside the reference: root of the mean square, for the \
                     impulses of the walls and the kinetic energy over that of the reference, for the greatest overlap \
                     and the mean height in mean diameters d. Seconds are those in the method alone.";

fn table(compared: &[Compared]) -> DataFrame {
    let error = |i: usize| compared.iter().map(|c| c.errors.map(|e| e[i])).collect::<Vec<Option<f64>>>();
    let own = df!(
        "method" => compared.iter().map(|c| c.label()).collect::<Vec<_>>(),
        "wall_impulse" => error(0),
        "kinetic_energy" => error(1),
        "greatest_overlap_mean_diameters" => error(2),
        "mean_height_mean_diameters" => error(3),
        "seconds_per_second" => compared.iter().map(|c| c.seconds_per_second()).collect::<Vec<_>>(),
    );
    let names = "scene role time_step_s method warm_start tolerance max_iterations status wall_impulse kinetic_energy \
                 greatest_overlap_mean_diameters mean_height_mean_diameters seconds_per_second";
    chosen(compared.iter().map(|c| c.simulation), names, own)
}

fn figure(scene: &str, compared: &[&Compared], looks: &[(String, Look)]) -> String {
    let sign = |(h, mark)| (Sign::Mark(mark, Pen::solid(INK, 0.3)), format!("h = {} ms", milliseconds(h)));
    let steps = time_steps(compared).into_iter().zip(MARKS.into_iter().cycle());
    let mut signs: Vec<(Sign, String)> = steps.map(sign).collect();
    let axes: Vec<_> = (0..OBSERVABLES.len()).filter_map(|i| axes(compared, i)).collect();
    if of_role(compared, "floor").any(|c| c.errors.is_some()) {
        signs.push((Sign::Line(TOLERANCE), "error of the time step alone".to_owned()));
    }
    if axes.iter().any(|axes| !axes.twins.is_empty()) {
        let text = "uncertainty of the reference: smaller errors are not meaningful".to_owned();
        signs.push((Sign::Line(TWINS), text));
    }
    let tolerances: Vec<String> = falling(compared, |s| s.tolerance).iter().map(|t| number(*t, 2)).collect();
    let text = format!("Tolerances along a line, from loose to tight: {}.", tolerances.join(", "));
    signs.push((Sign::Word, text));
    signs.push((Sign::Word, "d: mean diameter of the grains.".to_owned()));
    let failed = of_role(compared, "run").filter(|c| c.errors.is_none()).count();
    if failed > 0 {
        signs.push((Sign::Word, format!("Not drawn, since they did not come to the end: {failed}.")));
    }
    let legend = Legend::new(looks.to_vec(), signs, INSIDE);
    let title =
        [format!("{scene}: errors of the trajectory against seconds of the method per simulated second")];
    row(&title, OBSERVABLES.len(), &legend, |canvas, i, room| panel(canvas, compared, looks, i, room))
}

/// Returns the distinct values of the runs, the greatest first.
fn falling(compared: &[&Compared], of: fn(&Simulation) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = of_role(compared, "run").map(|c| of(c)).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values.dedup();
    values
}

fn time_steps(compared: &[&Compared]) -> Vec<f64> {
    falling(compared, |s| s.time_step_s)
}

fn of_role<'c>(
    compared: &'c [&'c Compared<'c>],
    role: &'static str,
) -> impl Iterator<Item = &'c Compared<'c>> {
    compared.iter().copied().filter(move |c| c.role == role)
}

/// Ranges of a panel, and the distances of two references that are in it.
struct Axes {
    x: (f64, f64),
    y: (f64, f64),
    twins: Vec<f64>,
}

/// The axes of the panel of the i-th error; none if it is known of no run.
fn axes(compared: &[&Compared], i: usize) -> Option<Axes> {
    let runs = || of_role(compared, "run");
    let x = padded(runs().filter_map(|c| c.error(i).and(c.cost())), 0.05);
    let floors = of_role(compared, "floor").filter_map(|c| c.error(i));
    let y = span(runs().filter_map(|c| c.error(i)).chain(floors))?;
    let (low, high) = padded([y.0, y.1].into_iter(), 0.08);
    let twins = of_role(compared, "twin").filter_map(|c| c.error(i));
    let twins = twins.filter(|at| (low..=high).contains(at)).collect();
    Some(Axes { x, y: (low, high.max(low + 1.0)), twins })
}

fn panel(canvas: &Canvas, compared: &[&Compared], looks: &[(String, Look)], i: usize, room: Room) {
    let runs = || of_role(compared, "run");
    let Some(Axes { x, y, twins }) = axes(compared, i) else {
        return canvas.text("no error known", (room.left, room.top), TICK_TEXT, (HPos::Left, VPos::Top));
    };
    let error = format!("error of the {}", OBSERVABLES[i]);
    let frame = room.frame(canvas, (Scale::Ten, x, "seconds per simulated second"), (Scale::Ten, y, &error));
    for twin in twins {
        frame.across(canvas, twin, TWINS);
    }
    for floor in of_role(compared, "floor") {
        let Some(at) = floor.error(i) else { continue };
        frame.across(canvas, at, TOLERANCE);
        let text = format!("{} ms", milliseconds(floor.time_step_s));
        // Beside the ticks.
        let place = (room.left + 2.0, frame.y.place(at) - 0.2);
        canvas.text(&text, place, TICK_TEXT, (HPos::Left, VPos::Bottom));
    }
    for (label, look) in looks {
        for (step, mark) in time_steps(compared).iter().zip(MARKS.iter().cycle()) {
            let mut points: Vec<(f64, Place)> = runs()
                .filter(|c| c.label() == *label && c.time_step_s == *step)
                .filter_map(|c| Some((c.tolerance, frame.place((c.cost()?, c.error(i)?)))))
                .collect();
            points.sort_by(|a, b| b.0.total_cmp(&a.0));
            let places: Vec<Place> = points.into_iter().map(|(_, place)| place).collect();
            canvas.line(&places, look.pen);
            for place in places {
                canvas.mark(*mark, place, look.pen);
            }
        }
    }
}

/// Summarises the rows of a scene, in one sentence for each time step.
fn sentences(scene: &str, compared: &[&Compared]) -> String {
    let Some(twin) = of_role(compared, "twin").next().and_then(|c| c.errors) else {
        return format!("{scene}: no reference was made, so no error is known.\n");
    };
    let words = |errors: &[f64; 4]| {
        let [walls, energy, overlap, height] = errors.map(|e| number(e, 2));
        format!(
            "{walls} in the impulses of the walls, {energy} in kinetic energy, {overlap} d in overlap, {height} d in height"
        )
    };
    let mut text = String::new();
    for step in time_steps(compared) {
        let at = |c: &&Compared| c.time_step_s == step;
        let floor = of_role(compared, "floor").find(at).and_then(|c| c.errors);
        let Some(floor) = floor else { continue };
        let good = |c: &&Compared| {
            c.errors.is_some_and(|e| e.iter().zip(floor).all(|(e, floor)| *e <= AT_THE_FLOOR * floor))
        };
        let cost = |c: &Compared| c.seconds_per_second().unwrap_or(f64::INFINITY);
        let runs = of_role(compared, "run").filter(at).filter(good);
        let cheapest = runs.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let h = milliseconds(step);
        text.extend([format!("{scene}: with h = {h} ms the time step alone costs {}; ", words(&floor))]);
        text.extend([match cheapest {
            Some(c) => format!(
                "the cheapest run within a factor of {AT_THE_FLOOR} of all four is {} at a tolerance of {}, with {} s per simulated second.\n",
                c.label(),
                number(c.tolerance, 2),
                number(cost(c), 2)
            ),
            None => format!("no run comes within a factor of {AT_THE_FLOOR} of all four.\n"),
        }]);
    }
    // What the errors above may mean, after what they are.
    text + &format!("{scene}: two references whose tolerances differ tenfold differ by {}.\n", words(&twin))
}
