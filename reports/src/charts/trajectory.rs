//! Accuracy of the simulation: errors of the trajectory against seconds per simulated second.

mod error;
#[cfg(test)]
mod tests;

use polars::df;
use polars::prelude::DataFrame;

use crate::draw::{
    Canvas, HPos, INK, INSIDE, LOWEST, Legend, Look, Mark, Pen, Place, Room, Scale, Sign, TICK_TEXT,
    TOLERANCE, VPos, log, looks_in_time, row,
};
use crate::read::{Simulation, file_name, in_role, milliseconds, number, padded, span, unique};
use crate::text::{Part, frame};
use error::{OBSERVABLES, errors};

/// Tells time steps apart, from the longest.
const MARKS: [Mark; 5] = [Mark::Ring, Mark::Square, Mark::Diamond, Mark::Triangle, Mark::Cross];
/// Two references that differ in their tolerance alone: below their distance no error is told.
const TWINS: Pen = Pen { color: INK, width: 0.3, dash: &[0.4, 0.5] };
/// A run within this factor of the error of its time step alone is as good as exact.
const AT_THE_FLOOR: f64 = 1.5;

/// A simulation beside the reference of its scene.
struct Compared<'s> {
    simulation: &'s Simulation,
    errors: Option<[f64; 4]>,
}

/// `trajectory-<scene>` for each scene, `trajectory-found` in words, and the table `trajectory` with all errors.
pub(crate) fn parts(all: &[Simulation]) -> Vec<Part> {
    let compared: Vec<Compared> = all
        .iter()
        .map(|simulation| {
            let reference = in_role(all, &simulation.scene, "reference");
            Compared { simulation, errors: reference.and_then(|reference| errors(simulation, reference)) }
        })
        .collect();
    let looks = looks_in_time(all);
    let mut parts = Vec::new();
    let mut text = String::new();
    for scene in unique(all.iter().map(|s| s.scene.as_str())) {
        let of_scene: Vec<&Compared> = compared.iter().filter(|c| c.simulation.scene == scene).collect();
        if of_scene.iter().any(|c| c.errors.is_some() && c.simulation.role != "reference") {
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
    fn column<'c, T>(compared: &[Compared<'c>], of: impl Fn(&'c Simulation) -> T) -> Vec<T> {
        compared.iter().map(|c| of(c.simulation)).collect()
    }
    let error = |i: usize| compared.iter().map(|c| c.errors.map(|e| e[i])).collect::<Vec<Option<f64>>>();
    frame(df!(
        "scene" => column(compared, |s| s.scene.as_str()),
        "role" => column(compared, |s| s.role.as_str()),
        "time_step_s" => column(compared, |s| s.time_step_s),
        "method" => column(compared, Simulation::label),
        "warm_start" => column(compared, |s| s.warm_start),
        "tolerance" => column(compared, |s| s.tolerance),
        "max_iterations" => column(compared, |s| s.max_iterations),
        "status" => column(compared, |s| s.status.as_str()),
        "wall_impulse" => error(0),
        "kinetic_energy" => error(1),
        "greatest_overlap_mean_diameters" => error(2),
        "mean_height_mean_diameters" => error(3),
        "seconds_per_second" => column(compared, Simulation::seconds_per_second),
    ))
}

fn figure(scene: &str, compared: &[&Compared], looks: &[(String, Look)]) -> String {
    let steps = time_steps(compared);
    let mut signs: Vec<(Sign, String)> = steps
        .iter()
        .zip(MARKS.iter().cycle())
        .map(|(h, mark)| {
            let pen = Pen::solid(INK, 0.3);
            (Sign::Mark(*mark, pen), format!("h = {} ms", milliseconds(*h)))
        })
        .collect();
    let axes: Vec<_> = (0..OBSERVABLES.len()).filter_map(|i| axes(compared, i)).collect();
    if of_role(compared, "floor").any(|c| c.errors.is_some()) {
        signs.push((Sign::Line(TOLERANCE), "error of the time step alone".to_owned()));
    }
    if axes.iter().any(|axes| !axes.twins.is_empty()) {
        let text = "uncertainty of the reference: smaller errors are not meaningful".to_owned();
        signs.push((Sign::Line(TWINS), text));
    }
    signs.push((Sign::Word, tolerances(compared)));
    signs.push((Sign::Word, "d: mean diameter of the grains.".to_owned()));
    let failed = compared.iter().filter(|c| c.simulation.is_run() && c.errors.is_none()).count();
    if failed > 0 {
        signs.push((Sign::Word, format!("Not drawn, since they did not come to the end: {failed}.")));
    }
    let legend = Legend::new(looks.to_vec(), signs, INSIDE);
    let title =
        [format!("{scene}: errors of the trajectory against seconds of the method per simulated second")];
    row(&title, OBSERVABLES.len(), &legend, |canvas, i, room| panel(canvas, compared, looks, i, room))
}

/// The time steps of the runs, the longest first.
fn time_steps(compared: &[&Compared]) -> Vec<f64> {
    let mut steps: Vec<f64> =
        compared.iter().filter(|c| c.simulation.is_run()).map(|c| c.simulation.time_step_s).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    steps
}

/// The tolerances along a line.
fn tolerances(compared: &[&Compared]) -> String {
    let runs = compared.iter().filter(|c| c.simulation.is_run());
    let mut tolerances: Vec<f64> = runs.map(|c| c.simulation.tolerance).collect();
    tolerances.sort_by(|a, b| b.total_cmp(a));
    tolerances.dedup();
    let texts: Vec<String> = tolerances.iter().map(|tolerance| number(*tolerance, 2)).collect();
    format!("Tolerances along a line, from loose to tight: {}.", texts.join(", "))
}

fn of_role<'c>(
    compared: &'c [&'c Compared<'c>],
    role: &'static str,
) -> impl Iterator<Item = &'c Compared<'c>> {
    compared.iter().copied().filter(move |c| c.simulation.role == role)
}

/// The i-th error of a simulation (logarithm).
fn value(compared: &Compared, i: usize) -> Option<f64> {
    compared.errors.map(|errors| log(errors[i]).max(LOWEST))
}

fn cost(compared: &Compared) -> Option<f64> {
    compared.simulation.seconds_per_second().map(log)
}

/// Ranges of a panel, and the distances of two references that are in it.
struct Axes {
    x: (f64, f64),
    y: (f64, f64),
    twins: Vec<f64>,
}

/// The axes of the panel of the i-th error; none if it is known of no run.
fn axes(compared: &[&Compared], i: usize) -> Option<Axes> {
    let runs = || compared.iter().filter(|c| c.simulation.is_run());
    let x = padded(runs().filter_map(|c| value(c, i).and(cost(c))), 0.05);
    let floors = of_role(compared, "floor").filter_map(|c| value(c, i));
    let y = span(runs().filter_map(|c| value(c, i)).chain(floors))?;
    let (low, high) = padded([y.0, y.1].into_iter(), 0.08);
    let twins = of_role(compared, "twin").filter_map(|c| value(c, i));
    let twins = twins.filter(|at| (low..=high).contains(at)).collect();
    Some(Axes { x, y: (low, high.max(low + 1.0)), twins })
}

fn panel(canvas: &Canvas, compared: &[&Compared], looks: &[(String, Look)], i: usize, room: Room) {
    let runs = || compared.iter().filter(|c| c.simulation.is_run());
    let Some(Axes { x, y, twins }) = axes(compared, i) else {
        return canvas.text("no error known", (room.left, room.top), TICK_TEXT, (HPos::Left, VPos::Top));
    };
    let error = format!("error of the {}", OBSERVABLES[i]);
    let frame = room.frame(canvas, (Scale::Ten, x, "seconds per simulated second"), (Scale::Ten, y, &error));
    let across = |canvas: &Canvas, at: f64, pen: Pen| {
        canvas.line(&[(room.left, frame.y.place(at)), (room.right, frame.y.place(at))], pen);
    };
    for twin in twins {
        across(canvas, twin, TWINS);
    }
    let steps = time_steps(compared);
    for floor in of_role(compared, "floor") {
        let Some(at) = value(floor, i) else { continue };
        across(canvas, at, TOLERANCE);
        let text = format!("{} ms", milliseconds(floor.simulation.time_step_s));
        // Beside the ticks.
        let place = (room.left + 2.0, frame.y.place(at) - 0.2);
        canvas.text(&text, place, TICK_TEXT, (HPos::Left, VPos::Bottom));
    }
    for (label, look) in looks {
        for (step, mark) in steps.iter().zip(MARKS.iter().cycle()) {
            let mut points: Vec<(f64, Place)> = runs()
                .filter(|c| c.simulation.label() == *label && c.simulation.time_step_s == *step)
                .filter_map(|c| Some((c.simulation.tolerance, frame.place((cost(c)?, value(c, i)?)))))
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

/// What the rows of a scene say, one sentence for each time step.
fn sentences(scene: &str, compared: &[&Compared]) -> String {
    let Some(twin) = compared.iter().find(|c| c.simulation.role == "twin").and_then(|c| c.errors) else {
        return format!("{scene}: no reference was made, so no error is known.\n");
    };
    let words = |errors: &[f64; 4]| {
        let [walls, energy, overlap, height] = errors.map(|e| number(e, 2));
        format!(
            "{walls} in the impulses of the walls, {energy} in kinetic energy, {overlap} d in overlap, {height} d in height"
        )
    };
    let mut text =
        format!("{scene}: two references whose tolerances differ tenfold differ by {}.\n", words(&twin));
    for step in time_steps(compared) {
        let at = |c: &&&Compared| c.simulation.time_step_s == step;
        let floor = compared.iter().filter(at).find(|c| c.simulation.role == "floor").and_then(|c| c.errors);
        let Some(floor) = floor else { continue };
        let good = |c: &&&Compared| {
            c.errors.is_some_and(|e| e.iter().zip(floor).all(|(e, floor)| *e <= AT_THE_FLOOR * floor))
        };
        let cost = |c: &&&Compared| c.simulation.seconds_per_second().unwrap_or(f64::INFINITY);
        let cheapest = compared
            .iter()
            .filter(|c| c.simulation.is_run())
            .filter(at)
            .filter(good)
            .min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let h = milliseconds(step);
        text.extend([format!("{scene}: with h = {h} ms the time step alone costs {}; ", words(&floor))]);
        text.extend([match cheapest {
            Some(c) => format!(
                "the cheapest run within a factor of {AT_THE_FLOOR} of all four is {} at a tolerance of {}, with {} s per simulated second.\n",
                c.simulation.label(),
                number(c.simulation.tolerance, 2),
                number(cost(&c), 2)
            ),
            None => format!("no run comes within a factor of {AT_THE_FLOOR} of all four.\n"),
        }]);
    }
    text
}
