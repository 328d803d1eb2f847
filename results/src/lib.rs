//! What was measured: the schema of the tables, how they are stored, where they come from.

pub mod journal;
mod number;
pub mod provenance;
pub mod schema;
pub mod simulation;
pub mod store;
pub mod tables;
