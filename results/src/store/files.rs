//! The files of a study: locked, dated, written whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use polars::prelude::{DataFrame, KeyValueMetadata, ParquetReader, ParquetWriter, PolarsResult, SerReader};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::columns::{keys, rows};
use crate::error::{StoreError, at};
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
