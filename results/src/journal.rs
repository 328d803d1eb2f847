//! The journal of a study: one line of JSON per run, written at once, never changed.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::provenance::ProvenanceError;
use crate::schema::{Run, Sample, Snapshot};
use crate::store::{StoreError, at};

/// What the journal of a study holds, one per line.
pub trait Entry: Serialize + DeserializeOwned {
    /// Hash of all that decides what counts of it: of two with one id the later counts.
    fn id(&self) -> &str;

    /// Refuses what could not be traced.
    ///
    /// # Errors
    ///
    /// Names what is missing.
    fn check(&self) -> Result<(), ProvenanceError>;
}

/// A run with its curve: one line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The row.
    pub run: Run,
    /// Its samples; none for a run that was skipped.
    pub curve: Vec<Sample>,
    /// Some of its iterates, where its plan names it in `[view]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub snapshots: Vec<Snapshot>,
}

impl Entry for Record {
    fn id(&self) -> &str {
        &self.run.id
    }

    fn check(&self) -> Result<(), ProvenanceError> {
        if self.run.problem_hash.is_empty() {
            return Err(ProvenanceError::Unknown("problem_hash"));
        }
        self.run.provenance.check()
    }
}

/// What a journal holds.
#[derive(Debug)]
pub struct Lines<R> {
    /// Its runs, in the order in which they ended.
    pub records: Vec<R>,
    /// Length of a last line that has no end: whoever wrote it was stopped (bytes).
    pub torn: u64,
    /// Length of all lines before it (bytes).
    whole: u64,
}

/// Reads a journal; a file that is not there holds nothing.
///
/// # Errors
///
/// If the file cannot be read, or a line that has an end is not a run.
pub fn read<R: Entry>(path: &Path) -> Result<Lines<R>, StoreError> {
    let mut lines = Lines { records: Vec::new(), torn: 0, whole: 0 };
    let mut reader = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(lines),
        Err(error) => return Err(at(path)(error)),
    };
    let mut line = Vec::new();
    loop {
        line.clear();
        let length = reader.read_until(b'\n', &mut line).map_err(at(path))? as u64;
        if line.last() != Some(&b'\n') {
            lines.torn = length;
            return Ok(lines);
        }
        let number = lines.records.len() + 1;
        let not_a_run = |source| StoreError::Line { path: path.to_owned(), line: number, source };
        lines.records.push(serde_json::from_slice(&line).map_err(not_a_run)?);
        lines.whole += length;
    }
}

/// A journal that is being written.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    length: u64,
    synced: Instant,
}

/// What a power cut may lose; whatever else stops the program loses nothing that was appended.
const UNSYNCED: Duration = Duration::from_secs(1);

impl Journal {
    /// Opens the journal behind its last whole line; what is torn is cut off.
    pub(crate) fn open<R: Entry>(path: &Path) -> Result<(Self, Lines<R>), StoreError> {
        let lines = read(path)?;
        let file = OpenOptions::new().append(true).create(true).open(path).map_err(at(path))?;
        if lines.torn > 0 {
            file.set_len(lines.whole).map_err(at(path))?;
        }
        let journal = Self { path: path.to_owned(), file, length: lines.whole, synced: Instant::now() };
        Ok((journal, lines))
    }

    pub(crate) fn append<R: Entry>(&mut self, record: &R) -> Result<(), StoreError> {
        let mut line = serde_json::to_vec(record).map_err(|e| at(&self.path)(e.into()))?;
        line.push(b'\n');
        if let Err(error) = self.file.write_all(&line) {
            // The next reader would drop the half line all the same.
            let _ = self.file.set_len(self.length);
            return Err(at(&self.path)(error));
        }
        self.length += line.len() as u64;
        if self.synced.elapsed() >= UNSYNCED { self.sync() } else { Ok(()) }
    }

    pub(crate) fn sync(&mut self) -> Result<(), StoreError> {
        self.synced = Instant::now();
        self.file.sync_data().map_err(at(&self.path))
    }
}
