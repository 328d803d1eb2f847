//! The folder of a report: it appears as a whole, in place of the one before.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use tempfile::TempDir;

use crate::error::ReportError;
use crate::text::File;

/// Names the files of the report, so that the next one knows which files it may replace.
const MADE: &str = ".report";

/// A file among drafts that is locked as long as somebody works on them.
const LOCK: &str = "lock";

/// Names of the files that the last report left in the folder `out` and that are still there.
pub fn made(out: &Path) -> Vec<String> {
    let list = fs::read_to_string(out.join(MADE)).unwrap_or_default();
    list.lines().filter(|name| out.join(name).is_file()).map(str::to_owned).collect()
}

/// Puts `files` into the folder `out` in place of those of the report before; what that did not make stays.
pub(crate) fn replace(files: &[File], out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    // A file of that name is refused here.
    fs::create_dir_all(out).map_err(at(out))?;
    // A link to the folder stays: what it leads to is replaced.
    let place = fs::canonicalize(out).map_err(at(out))?;
    let parent = place.parent().unwrap_or(&place);
    let prefix = format!(".unfinished-{}-", place.file_name().unwrap_or_default().to_string_lossy());
    clear(parent, &prefix, &place)?;
    let before = made(out);
    let someones = |file: &&File| out.join(&file.name).exists() && !before.contains(&file.name);
    if let Some(File { name, .. }) = files.iter().find(someones) {
        let why = "no report made this file, and one would replace it: move it, or give it another name";
        return Err(at(&out.join(name))(io::Error::other(why)));
    }
    let drafts = TempDir::with_prefix_in(&prefix, parent).map_err(at(parent))?;
    // As long as this one is locked, nobody takes the drafts for abandoned.
    let lock = fs::File::create(drafts.path().join(LOCK)).map_err(at(parent))?;
    let _ = lock.try_lock();
    // Folders inside the temporary one, since the temporary one is closed to other users.
    let (new, old) = (drafts.path().join("new"), drafts.path().join("old"));
    fs::create_dir(&new).map_err(at(&new))?;
    for File { name, content } in files {
        fs::write(new.join(name), content).map_err(at(&new.join(name)))?;
    }
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    fs::write(new.join(MADE), names.join("\n") + "\n").map_err(at(&new))?;
    let swapped = swap(&new, &old, &place);
    if swapped.is_err() && old.exists() {
        // What is in it may be someone's: it stays where it is rather than go with the drafts.
        let _ = drafts.keep();
    }
    swapped.map_err(at(out))?;
    Ok(names.into_iter().map(|name| out.join(name)).collect())
}

/// Removes the drafts that programs left which were killed while they wrote this report; what in them is of others comes back.
fn clear(parent: &Path, prefix: &str, out: &Path) -> Result<(), ReportError> {
    for entry in fs::read_dir(parent).map_err(at(parent))? {
        let drafts = entry.map_err(at(parent))?.path();
        let name = drafts.file_name().unwrap_or_default().to_string_lossy();
        // Behind the prefix stand letters and digits; more is of another report, whose name begins as this one's.
        if !name.strip_prefix(prefix).is_some_and(|end| end.chars().all(char::is_alphanumeric)) {
            continue;
        }
        if fs::File::open(drafts.join(LOCK)).is_ok_and(|lock| lock.try_lock().is_err()) {
            continue;
        }
        let old = drafts.join("old");
        if !old.is_dir() || bring_back(&old, out).map_err(at(&old))? {
            fs::remove_dir_all(&drafts).map_err(at(&drafts))?;
        }
    }
    Ok(())
}

fn swap(new: &Path, old: &Path, out: &Path) -> io::Result<()> {
    fs::rename(out, old)?;
    if let Err(error) = fs::rename(new, out) {
        fs::rename(old, out)?;
        return Err(error);
    }
    bring_back(old, out).map(drop)
}

/// Moves what no report made from the folder of an old one to its place; `false` if some of it is there already.
fn bring_back(old: &Path, out: &Path) -> io::Result<bool> {
    let mut all = true;
    let list = fs::read_to_string(old.join(MADE)).unwrap_or_default();
    let made: BTreeSet<&str> = list.lines().chain([MADE]).collect();
    for entry in fs::read_dir(old)? {
        let entry = entry?;
        let (name, place) = (entry.file_name(), out.join(entry.file_name()));
        if name.to_str().is_some_and(|name| made.contains(name)) {
            continue;
        }
        if place.exists() {
            all = false;
        } else {
            fs::rename(entry.path(), place)?;
        }
    }
    Ok(all)
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::File { path, source }
}

#[cfg(test)]
mod tests;
