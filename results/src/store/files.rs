//! The files of a study: locked, dated, written whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use polars::prelude::{
    DataFrame, KeyValueMetadata, ParquetReader, ParquetWriter, PolarsError, PolarsResult, SerReader,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::StoreError;
use crate::columns::{keys, rows};
use crate::seal::{OF_TABLE, of_no_table, open_table};

/// Locks a folder by a file inside it, or says who holds it.
pub(super) fn lock(path: &Path) -> Result<File, StoreError> {
    let mut options = OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(false).open(path).map_err(at(path))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let holder = fs::read_to_string(path).map_err(at(path))?;
            let folder = path.parent().unwrap_or(path).to_owned();
            return Err(StoreError::InUse { folder, holder });
        }
        Err(TryLockError::Error(error)) => return Err(at(path)(error)),
    }
    let since = Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ");
    let holder = format!("process {} since {since}", std::process::id());
    file.set_len(0).and_then(|()| file.write_all(holder.as_bytes())).map_err(at(path))?;
    Ok(file)
}

/// A folder named after the time, with `-2`, `-3` … if that exists. Some file systems allow no colon in a name.
pub(super) fn new_dated_folder(parent: &Path) -> Result<PathBuf, StoreError> {
    let time = Timestamp::now().strftime("%Y-%m-%dT%H-%M-%SZ").to_string();
    let mut path = parent.join(&time);
    let mut count = 1;
    loop {
        match fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                count += 1;
                path = parent.join(format!("{time}-{count}"));
            }
            Err(error) => return Err(at(&path)(error)),
        }
    }
}

/// Returns the target of a path that may be a link, even to what is not there yet: renaming a file to the path of a link would
/// replace the link.
///
/// # Errors
///
/// If links lead in a circle.
pub fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    // As many as Linux follows.
    for _ in 0..40 {
        match place.read_link() {
            Ok(to) => place = place.parent().unwrap_or(Path::new("")).join(to),
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("its links lead in a circle"))
}

/// Prefix of the names of incomplete files.
const UNFINISHED: &str = ".unfinished-";

/// Removes what programs that were killed did not finish in the folder of a study, to which nobody else writes.
pub(super) fn remove_unfinished(folder: &Path) -> Result<(), StoreError> {
    for entry in fs::read_dir(folder).map_err(at(folder))? {
        let path = entry.map_err(at(folder))?.path();
        if path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(UNFINISHED))
            && path.is_file()
        {
            fs::remove_file(&path).map_err(at(&path))?;
        }
    }
    Ok(())
}

/// Writes a table beside its place and gives it its name once it is complete; a link stays, and its target is written.
pub(super) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), PolarsError>,
) -> Result<(), StoreError> {
    let target = behind_links(path).map_err(at(path))?;
    let folder = target.parent().unwrap_or(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED);
    // A temporary file is closed to other users unless it asks for what files usually get.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(at(path))?;
    write(file.as_file_mut()).map_err(|source| StoreError::Format { path: path.to_owned(), source })?;
    file.as_file().sync_all().map_err(at(path))?;
    file.persist(&target).map_err(|error| at(path)(error.error))?;
    Ok(())
}

/// Returns a table as a Parquet file, in which the place of its checksum is empty.
pub(super) fn parquet_of(table: &mut DataFrame) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let seal = KeyValueMetadata::from_static(vec![(OF_TABLE.to_owned(), of_no_table())]);
    ParquetWriter::new(&mut bytes).with_key_value_metadata(Some(seal)).finish(table)?;
    Ok(bytes)
}

/// The tables of a study as they are read, one after the other.
#[derive(Default)]
pub(super) struct Tables {
    /// Files without a checksum.
    pub(super) unsealed: Vec<PathBuf>,
    /// The first, and the checksum of all that were written with it, if it has one.
    first: Option<(PathBuf, Option<String>)>,
}

impl Tables {
    fn read<T>(
        &mut self,
        path: &Path,
        take: impl Fn(&DataFrame) -> PolarsResult<T>,
    ) -> Result<T, StoreError> {
        let bytes = fs::read(path).map_err(at(path))?;
        let opened = open_table(bytes);
        let (bytes, all) = opened.map_err(|source| StoreError::Damaged { path: path.to_owned(), source })?;
        if all.is_none() {
            self.unsealed.push(path.to_owned());
        }
        let (other, with) = self.first.get_or_insert_with(|| (path.to_owned(), all.clone()));
        if *with != all {
            return Err(StoreError::Apart { path: path.to_owned(), other: other.clone() });
        }
        let table = ParquetReader::new(Cursor::new(bytes)).finish();
        let format = |source| StoreError::Format { path: path.to_owned(), source };
        table.and_then(|table| take(&table)).map_err(format)
    }

    /// Returns the rows of a table.
    pub(super) fn rows<Row>(&mut self, path: &Path) -> Result<Vec<Row>, StoreError>
    where
        Row: Serialize + DeserializeOwned + Default + Send,
    {
        self.read(path, rows)
    }

    /// Returns the rows of a table whose column `key` says of which of `count` runs or simulations each is; rows of none are left aside.
    pub(super) fn groups<Row>(
        &mut self,
        path: &Path,
        key: &str,
        count: usize,
    ) -> Result<Vec<Vec<Row>>, StoreError>
    where
        Row: Serialize + DeserializeOwned + Default + Send,
    {
        let (keys, rows) = self.read(path, |table| Ok((keys(key, table)?, rows::<Row>(table)?)))?;
        let mut groups: Vec<Vec<Row>> = Vec::new();
        groups.resize_with(count, Vec::new);
        for (key, row) in keys.into_iter().zip(rows) {
            if let Some(group) = groups.get_mut(key as usize) {
                group.push(row);
            }
        }
        Ok(groups)
    }
}

pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::File { path, source }
}
