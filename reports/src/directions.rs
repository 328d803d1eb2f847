//! Search directions: iterations over (κ_l, κ_d), and the derived directions among them.

mod against_size;
mod field;
mod heat;
mod table;
#[cfg(test)]
mod tests;
mod words;

use results::store::Tables;

use crate::rows::{problems, runs};
use crate::{File, ReportError, csv, file_name};
use field::{Field, fields};

/// `directions-<problem>.svg` where runs span κ_l and κ_d, `derived-direction.svg` where they span κ_l with κ_d = κ_l,
/// each with its table.
pub(crate) fn files(tables: &Tables) -> Result<Vec<File>, ReportError> {
    let runs = runs(&tables.runs)?;
    let (planes, lines): (Vec<Field>, Vec<Field>) = fields(&runs).into_iter().partition(Field::is_plane);
    let mut files = Vec::new();
    for problem in problems(&runs) {
        let fields: Vec<&Field> = planes.iter().filter(|field| field.problem == problem).collect();
        for (page, svg) in heat::pages(problem, &fields)?.into_iter().enumerate() {
            let number = if page == 0 { String::new() } else { format!("-{}", page + 1) };
            files.push((format!("directions-{}{number}.svg", file_name(problem)), svg));
        }
    }
    if !planes.is_empty() || lines.is_empty() {
        files.extend(table_files("directions", &planes)?);
    }
    if !lines.is_empty() {
        files.push(("derived-direction.svg".to_owned(), against_size::figure(&lines)?));
        files.extend(table_files("derived-direction", &lines)?);
    }
    Ok(files)
}

fn table_files(name: &str, fields: &[Field]) -> Result<[File; 2], ReportError> {
    let table = table::table(fields)?;
    Ok([(format!("{name}.csv"), csv(&table)?), (format!("{name}.md"), table::text(fields)?)])
}
