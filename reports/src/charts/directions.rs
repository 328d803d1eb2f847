//! Search directions: iterations over (κ_l, κ_d), and the derived directions among them.

mod against_size;
mod field;
mod heat;
mod table;
#[cfg(test)]
mod tests;
mod words;

use crate::read::{Problems, file_name, problems};
use crate::text::Part;
use field::{Field, fields};

/// `directions-<problem>` where runs span κ_l and κ_d, `derived-direction` where they span κ_l with κ_d = κ_l, each with
/// its table.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let runs = &study.runs;
    let (planes, lines): (Vec<Field>, Vec<Field>) = fields(runs).into_iter().partition(Field::is_plane);
    let mut parts = Vec::new();
    for problem in problems(runs) {
        let fields: Vec<&Field> = planes.iter().filter(|field| field.problem == problem).collect();
        for (page, svg) in heat::pages(problem, &fields).into_iter().enumerate() {
            let number = if page == 0 { String::new() } else { format!("-{}", page + 1) };
            parts.push(Part::figure(format!("directions-{}{number}", file_name(problem)), svg));
        }
    }
    if !planes.is_empty() || lines.is_empty() {
        parts.push(Part::table("directions", table::table(&planes), table::NOTE));
    }
    if !lines.is_empty() {
        let figure = Part::figure("derived-direction", against_size::figure(&lines));
        parts.push(figure.captioned(
            "The best and the derived κ_l, and what the derived one costs, against the number of grains.",
        ));
        parts.push(Part::table("derived-direction", table::table(&lines), table::NOTE));
    }
    parts
}
