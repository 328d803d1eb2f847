//! The files of a study: locked, dated, written whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use polars::prelude::{DataFrame, ParquetReader, PolarsError, SerReader};

use super::StoreError;

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

/// Where a path leads that may be a link, even to what is not there yet: who renames a file to the path of a link replaces
/// the link.
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

/// Writes a table beside its place and gives it its name once it is complete; a link stays, and its target is written.
pub(super) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), PolarsError>,
) -> Result<(), StoreError> {
    let target = behind_links(path).map_err(at(path))?;
    let folder = target.parent().unwrap_or(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-");
    // A temporary file is closed to other users unless it asks for what files usually get.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(at(path))?;
    write(file.as_file_mut()).map_err(|source| StoreError::Format { path: path.to_owned(), source })?;
    file.as_file().sync_all().map_err(at(path))?;
    file.persist(&target).map_err(|error| at(path)(error.error))?;
    Ok(())
}

pub(super) fn read_parquet(path: &Path) -> Result<DataFrame, StoreError> {
    let file = File::open(path).map_err(at(path))?;
    let format = |source| StoreError::Format { path: path.to_owned(), source };
    ParquetReader::new(file).finish().map_err(format)
}

pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> StoreError {
    let path = path.to_owned();
    |source| StoreError::File { path, source }
}
