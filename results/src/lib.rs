//! Measurements: the schema of the tables, their storage, their provenance.

pub mod columns;
pub mod contacts;
pub mod error;
pub mod journal;
mod json;
mod median;
pub mod name;
pub mod provenance;
mod reached;
pub mod schema;
mod seal;
pub mod settings;
pub mod simulation;
pub mod store;
pub mod study;
#[cfg(test)]
mod tests;
pub mod whole;

pub use median::{Median, median};
pub use reached::{STAYED, reached};
