//! The journal of a study: one line of JSON per run, written at once, never changed. The last key of each line is the
//! checksum of all before it.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use seal::{opened, sealed};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::{RowError, StoreError, at};
use crate::name::Name;
use crate::schema::{Provenance, Run, Sample, Snapshot, Timing};

/// Entry of a study's journal, one per line.
pub trait Entry: Serialize + DeserializeOwned {
    /// Hash of all that decides what counts of it: of two with one id the later counts.
    fn id(&self) -> &str;

    /// Name of the method.
    fn method(&self) -> &str;

    /// Returns a name for the user: the method, and its problem or scene.
    fn name(&self) -> String;

    /// Returns its timing.
    fn timing(&self) -> &Timing;

    /// Returns its provenance.
    fn provenance(&self) -> &Provenance;

    /// Returns the counts in which all entries of one id must agree, whatever made them: name and value of each.
    fn counts(&self) -> Vec<(String, String)>;

    /// Refuses what could not be traced.
    ///
    /// # Errors
    ///
    /// Names what is missing.
    fn check(&self) -> Result<(), RowError>;

    /// The first count in which two of one id differ: its name, the value here, that of the `other`.
    fn difference(&self, other: &Self) -> Option<(String, String, String)> {
        let (mut ours, mut theirs) = (self.counts().into_iter(), other.counts().into_iter());
        let none = || "none".to_owned();
        loop {
            match (ours.next(), theirs.next()) {
                (None, None) => return None,
                (Some((_, a)), Some((_, b))) if a == b => {}
                (Some((name, a)), Some((_, b))) => return Some((name, a, b)),
                (Some((name, a)), None) => return Some((name, a, none())),
                (None, Some((name, b))) => return Some((name, none(), b)),
            }
        }
    }
}

/// A run with its curve: one line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

    fn method(&self) -> &str {
        &self.run.method
    }

    fn name(&self) -> String {
        let Run { method, variant, problem, .. } = &self.run;
        format!("{} on {problem}", format!("{method} {variant}").trim_end())
    }

    fn timing(&self) -> &Timing {
        &self.run.timing
    }

    fn provenance(&self) -> &Provenance {
        &self.run.provenance
    }

    fn counts(&self) -> Vec<(String, String)> {
        let iterations = [("iterations", self.run.iterations)];
        named(self.run.status.name(), iterations.into_iter().chain(self.run.end.work.named()))
    }

    fn check(&self) -> Result<(), RowError> {
        if self.run.problem_hash.is_empty() {
            return Err(RowError::Untraced("problem_hash"));
        }
        self.run.provenance.check()
    }
}

/// Returns a status and counts as names and values.
pub(crate) fn named(
    status: &str,
    counts: impl Iterator<Item = (&'static str, u64)>,
) -> Vec<(String, String)> {
    let counts = counts.map(|(name, count)| (name.to_owned(), count.to_string()));
    std::iter::once(("status".to_owned(), status.to_owned())).chain(counts).collect()
}

/// Content of a journal.
#[derive(Debug)]
pub struct Lines<R> {
    /// Its runs, in the order in which they ended.
    pub records: Vec<R>,
    /// Number of runs whose lines are from before there were checksums: the first ones.
    pub unsealed: usize,
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
    let mut records = Vec::new();
    let mut texts = match File::open(path) {
        Ok(file) => Texts::new(path, file),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(Lines { records, unsealed: 0, torn: 0, whole: 0 });
        }
        Err(error) => return Err(at(path)(error)),
    };
    for text in &mut texts {
        records.push(entry(&text?).map_err(at_line(path, records.len()))?);
    }
    let Texts { unsealed, torn, whole, .. } = texts;
    Ok(Lines { records, unsealed, torn, whole })
}

/// Reads a line of a journal, without its checksum.
///
/// # Errors
///
/// If it is no row.
pub fn entry<R: Entry>(text: &[u8]) -> Result<R, RowError> {
    let record: R = serde_json::from_slice(text)?;
    record.check()?;
    Ok(record)
}

/// The lines of a journal that have an end, each without its checksum, which is checked. Their ends may be those of Windows. Lines
/// from before there were checksums have none; they stand before all others.
pub struct Texts {
    path: PathBuf,
    reader: BufReader<File>,
    number: usize,
    unsealed: usize,
    torn: u64,
    whole: u64,
}

impl Texts {
    /// Reads the journal `file`, whose path is for errors.
    pub fn new(path: &Path, file: File) -> Self {
        let reader = BufReader::new(file);
        Self { path: path.to_owned(), reader, number: 0, unsealed: 0, torn: 0, whole: 0 }
    }

    /// Returns the number of lines so far that are from before there were checksums.
    pub fn unsealed(&self) -> usize {
        self.unsealed
    }
}

impl Iterator for Texts {
    type Item = Result<Vec<u8>, StoreError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut line = Vec::new();
        let length = match self.reader.read_until(b'\n', &mut line) {
            Ok(length) => length as u64,
            Err(error) => return Some(Err(at(&self.path)(error))),
        };
        if line.pop_if(|end| *end == b'\n').is_none() {
            self.torn = length;
            return None;
        }
        let text = match opened(&line) {
            Ok(Some(text)) => Ok(text),
            Ok(None) if self.unsealed == self.number => {
                self.unsealed += 1;
                Ok(line)
            }
            Ok(None) => Err(RowError::Unsealed),
            Err(damaged) => Err(damaged.into()),
        };
        self.number += 1;
        self.whole += length;
        Some(text.map_err(at_line(&self.path, self.number - 1)))
    }
}

fn at_line(path: &Path, index: usize) -> impl FnOnce(RowError) -> StoreError {
    move |source| StoreError::Line { path: path.to_owned(), line: index + 1, source }
}

impl<R: Entry> Lines<R> {
    /// Refuses a method that is none of the `known` ones where no checksum says that it was written so: whoever wrote a
    /// line with one knew the method, which may be gone since.
    ///
    /// # Errors
    ///
    /// Names the line of the journal `path`, the method and those that are known.
    pub fn check_methods(&self, path: &Path, known: &[&'static str]) -> Result<(), StoreError> {
        for (index, record) in self.records[..self.unsealed].iter().enumerate() {
            RowError::unless_known("method", record.method(), known).map_err(at_line(path, index))?;
        }
        Ok(())
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

/// Time between syncs: a power cut may lose the entries of this time; whatever else stops the program loses nothing that was
/// appended.
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
        let object = serde_json::to_string(record).map_err(|e| at(&self.path)(e.into()))?;
        let line = sealed(&object) + "\n";
        if let Err(error) = self.file.write_all(line.as_bytes()) {
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

#[cfg(test)]
mod tests;
