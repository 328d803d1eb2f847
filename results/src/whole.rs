//! Files that appear whole or not at all.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Prefix of the names of incomplete files, and the number of random letters and digits after it.
const UNFINISHED: &str = ".unfinished-";
const RANDOM: usize = 6;

/// Writes a file beside its place and gives it its name once it is complete; a link stays, and its target is written.
///
/// # Errors
///
/// Those of the system, and of `write`.
pub fn write<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let mut unfinished = Unfinished::beside(path)?;
    write(unfinished.file.as_file_mut())?;
    Ok(unfinished.finish()?)
}

/// A file beside its place that has not got its name yet. Without the name it is removed.
pub struct Unfinished {
    file: NamedTempFile,
    target: PathBuf,
}

impl Unfinished {
    /// Begins a file beside `path`; a link stays, and its target is written.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let target = behind_links(path)?;
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        builder.prefix(UNFINISHED).rand_bytes(RANDOM);
        // A temporary file is closed to other users unless it asks for what files usually get.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = locked(&builder, folder.unwrap_or(Path::new(".")))?;
        Ok(Self { file, target })
    }

    /// Returns another handle of the file.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn handle(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Gives the file its name.
    ///
    /// # Errors
    ///
    /// Those of the system.
    pub fn finish(self) -> io::Result<()> {
        self.file.persist(&self.target).map_err(|error| error.error)?;
        Ok(())
    }
}

/// Attempts at a file that nobody takes for abandoned before it is locked.
const ATTEMPTS: usize = 100;

/// Makes a locked file in `folder`. A program that removes abandoned files may lock a new one first: then another is made.
fn locked(builder: &tempfile::Builder, folder: &Path) -> io::Result<NamedTempFile> {
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder)?;
        // Where files cannot be locked, none is taken for abandoned either.
        let is_taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !is_taken && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::Error::other("another program removes each new file"))
}

/// Removes incomplete files to which no program writes any more: whoever writes one has locked it.
///
/// # Errors
///
/// If the folder cannot be listed.
pub fn remove_abandoned(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let is_ours = |name: &str| {
            let random = name.strip_prefix(UNFINISHED).unwrap_or_default();
            random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        };
        if !entry.file_name().to_str().is_some_and(is_ours)
            || !entry.file_type().is_ok_and(|kind| kind.is_file())
        {
            continue;
        }
        // It stays locked until it is gone, so that whoever has just made it sees that.
        if let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            // Another program may have been faster.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
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
