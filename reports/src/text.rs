//! Tables, sentences and templates: what a report says in words and numbers.

mod answer;
mod failures;
mod fill;
mod html;
mod part;
mod pick;
mod rows;
mod table;

pub(crate) use answer::answer;
pub(crate) use failures::failures;
pub(crate) use fill::fill;
pub(crate) use html::html;
pub(crate) use part::{File, Kind, Part, Table, chosen, frame, nothing, too_many};
pub use pick::{Pick, TableFormat};
pub(crate) use rows::rows;
pub use rows::summary;
#[cfg(test)]
pub(crate) use table::csv;
pub(crate) use table::{Column, columns, markdown};
