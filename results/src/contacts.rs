//! Contacts of a simulation: a row for each contact of a time step, in a table that grows while time goes on.

use crate::columns::{CsvRows, cells, table};
use crate::name::{self, names};
use crate::whole::Unfinished;
use cases::Side;
use contact::number;
use polars::io::parquet::write::BatchedWriter;
use polars::prelude::{DataFrame, ParquetWriter, PolarsResult};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::path::Path;

/// A contact after a time step, with its impulse. The normal points from the antagonist to the candidate, and vectors act on the candidate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactForce {
    /// Time steps made.
    pub time_step: u64,
    /// Time (s).
    #[serde(with = "number")]
    pub time_s: f64,
    /// Index of the candidate grain.
    pub candidate: u32,
    /// Index of the antagonist, if it is a grain, a lid or a driven segment.
    pub antagonist: Option<u32>,
    /// Kind of the antagonist.
    #[serde(with = "name")]
    pub body: Body,
    /// Place of a segment in the list of its case, from 0.
    pub segment: Option<u32>,
    /// Point of the candidate's surface that is nearest to the antagonist (m), where contacts are sought; as below, z is 0 of discs.
    #[serde(with = "number")]
    pub x_m: f64,
    /// Its y (m).
    #[serde(with = "number")]
    pub y_m: f64,
    /// Its z (m).
    #[serde(with = "number")]
    pub z_m: f64,
    /// Unit normal (–).
    #[serde(with = "number")]
    pub normal_x: f64,
    /// Its y (–).
    #[serde(with = "number")]
    pub normal_y: f64,
    /// Its z (–).
    #[serde(with = "number")]
    pub normal_z: f64,
    /// Gap at that place, negative where the two overlap (m).
    #[serde(with = "number")]
    pub gap_m: f64,
    /// μ (–).
    #[serde(with = "number")]
    pub friction: f64,
    /// Normal impulse of the time step, not negative (N·s). Divided by the time step it is the mean force.
    #[serde(with = "number")]
    pub normal_impulse_n_s: f64,
    /// Tangential impulse (N·s): of discs along [−`n_y`, `n_x`], with its sign; between spheres its size; 0 without friction.
    #[serde(with = "number")]
    pub tangential_impulse_n_s: f64,
    /// The whole impulse on the candidate along x (N·s).
    #[serde(with = "number")]
    pub impulse_x_n_s: f64,
    /// Its y (N·s).
    #[serde(with = "number")]
    pub impulse_y_n_s: f64,
    /// Its z (N·s).
    #[serde(with = "number")]
    pub impulse_z_n_s: f64,
    /// Status.
    #[serde(with = "name")]
    pub status: ContactStatus,
}

names! {
    /// Kind of an antagonist.
    Body in "body" {
        /// Another grain.
        #[default]
        Grain = "grain",
        /// The floor.
        Floor = "floor",
        /// The wall at the left.
        Left = "left",
        /// The wall at the right.
        Right = "right",
        /// The wall behind.
        Back = "back",
        /// The wall before.
        Front = "front",
        /// The drum.
        Drum = "drum",
        /// A bump of the floor.
        Bump = "bump",
        /// A segment.
        Segment = "segment",
        /// The lid.
        Lid = "lid",
        /// A guide of a lid or a driven segment, which is the candidate.
        Guide = "guide",
    }
}

impl Body {
    /// Returns the kind of a side, and its place in the list of segments, if it is one.
    pub fn of(side: Side) -> (Self, Option<u32>) {
        let kind = match side {
            Side::Floor => Self::Floor,
            Side::Left => Self::Left,
            Side::Right => Self::Right,
            Side::Back => Self::Back,
            Side::Front => Self::Front,
            Side::Drum => Self::Drum,
            Side::Bump(_) => Self::Bump,
            Side::Segment(number) | Side::Driven(_, number) => return (Self::Segment, Some(number)),
            Side::Grain(_) => Self::Grain,
            Side::Lid(..) => Self::Lid,
            Side::Guide(_) => Self::Guide,
        };
        (kind, None)
    }
}

names! {
    /// Status of a contact.
    ContactStatus in "status" {
        /// No impulse.
        #[default]
        Open = "open",
        /// A normal impulse without friction.
        Closed = "closed",
        /// A tangential impulse inside Coulomb's cone.
        Sticks = "sticks",
        /// A tangential impulse on Coulomb's cone.
        Slides = "slides",
    }
}

/// Number of rows that are written at once to a Parquet table: some megabytes.
const AT_ONCE: usize = 1 << 16;

/// Table of contacts that is being written: as CSV row by row, so that a program that is killed leaves what it wrote; as Parquet whole or
/// not at all.
pub struct ContactTable(Kind);

enum Kind {
    Csv(CsvRows),
    Parquet { unfinished: Unfinished, writer: Box<BatchedWriter<File>>, rows: Vec<ContactForce> },
}

/// Format of a table.
#[derive(Clone, Copy, Debug)]
pub enum ContactFormat {
    /// CSV.
    Csv,
    /// Parquet.
    Parquet,
}

impl ContactFormat {
    /// Returns the format of a file by the ending of its name, `.csv` or `.parquet`.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "csv" => Some(Self::Csv),
            "parquet" => Some(Self::Parquet),
            _ => None,
        }
    }
}

impl ContactTable {
    /// Begins a table in a file that is not there.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn begin(path: &Path, format: ContactFormat) -> PolarsResult<Self> {
        Ok(Self(match format {
            ContactFormat::Csv => Kind::Csv(CsvRows::begin(path, cells(&ContactForce::default())?)?),
            ContactFormat::Parquet => {
                let unfinished = Unfinished::beside(path)?;
                let writer = ParquetWriter::new(unfinished.handle()?);
                let columns = table::<ContactForce>([])?;
                let writer = Box::new(writer.batched(columns.schema())?);
                Kind::Parquet { unfinished, writer, rows: Vec::new() }
            }
        }))
    }

    /// Adds the rows of a time step.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn add(&mut self, new: Vec<ContactForce>) -> PolarsResult<()> {
        match &mut self.0 {
            Kind::Csv(file) => Ok(file.add(new.iter().map(cells).collect::<PolarsResult<Vec<_>>>()?)?),
            Kind::Parquet { writer, rows, .. } => {
                rows.extend(new);
                if rows.len() >= AT_ONCE { write(writer, rows) } else { Ok(()) }
            }
        }
    }

    /// Ends the table.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn finish(self) -> PolarsResult<()> {
        let Kind::Parquet { unfinished, mut writer, mut rows } = self.0 else { return Ok(()) };
        write(&mut writer, &mut rows)?;
        writer.finish()?;
        Ok(unfinished.finish()?)
    }
}

/// Writes the rows and forgets them.
fn write(writer: &mut BatchedWriter<File>, rows: &mut Vec<ContactForce>) -> PolarsResult<()> {
    let columns: DataFrame = table(&*rows)?;
    rows.clear();
    writer.write_batch(&columns)
}

#[cfg(test)]
mod tests {
    use super::{Body, ContactForce, ContactFormat, ContactStatus, ContactTable};
    use crate::columns::rows;
    use polars::prelude::{ParquetReader, SerReader};
    use std::fs::{self, File};
    use std::path::Path;

    fn row(candidate: u32) -> ContactForce {
        let (segment, status) = (Some(7), ContactStatus::Slides);
        ContactForce {
            candidate,
            body: Body::Segment,
            segment,
            status,
            gap_m: -0.5,
            ..ContactForce::default()
        }
    }

    fn begun(path: &Path) -> ContactTable {
        ContactTable::begin(path, ContactFormat::of(path).unwrap()).unwrap()
    }

    #[test]
    fn parquet_holds_the_rows_of_all_time_steps_and_is_not_there_before_its_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contacts.parquet");
        let mut table = begun(&path);
        table.add(vec![row(1), row(2)]).unwrap();
        table.add(Vec::new()).unwrap();
        table.add(vec![row(3)]).unwrap();
        assert!(!path.exists());
        table.finish().unwrap();
        let read = ParquetReader::new(File::open(&path).unwrap()).finish().unwrap();
        assert_eq!(rows::<ContactForce>(&read).unwrap(), [row(1), row(2), row(3)]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn csv_is_there_at_any_moment_and_another_ending_makes_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contacts.csv");
        let mut table = begun(&path);
        table.add(vec![row(1)]).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 2);
        assert!(ContactFormat::of(&folder.path().join("contacts.txt")).is_none());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
