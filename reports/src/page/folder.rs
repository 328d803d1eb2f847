//! The folder of a report: its files, each written whole, in place of those of the report before.

use std::path::{Path, PathBuf};
use std::{fs, io};

use results::whole;

use crate::error::ReportError;
use crate::text::File;

/// Names the files of the report, so that the next one knows which files it may replace.
const MADE: &str = ".report";

/// Names of the files that the last report left in the folder `out` and that are still there.
pub fn made(out: &Path) -> Vec<String> {
    let list = fs::read_to_string(out.join(MADE)).unwrap_or_default();
    list.lines().filter(|name| out.join(name).is_file()).map(str::to_owned).collect()
}

/// Puts `files` into the folder `out` in place of those of the report before; what that did not make stays. The first file,
/// the page, is written last.
pub(crate) fn replace(files: &[File], out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    // A file of that name is refused here.
    fs::create_dir_all(out).map_err(at(out))?;
    whole::remove_abandoned(out).map_err(at(out))?;
    let before = made(out);
    let someones = |file: &&File| out.join(&file.name).exists() && !before.contains(&file.name);
    if let Some(File { name, .. }) = files.iter().find(someones) {
        let why = "no report made this file, and one would replace it: move it, or give it another name";
        return Err(at(&out.join(name))(io::Error::other(why)));
    }
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let gone: Vec<&str> =
        before.iter().map(String::as_str).filter(|before| !names.contains(before)).collect();
    // A report that is killed leaves files of both, and all are its own.
    write(out, MADE, ([&names[..], &gone].concat().join("\n") + "\n").as_bytes())?;
    for File { name, content } in files.iter().rev() {
        write(out, name, content)?;
    }
    for name in gone {
        fs::remove_file(out.join(name)).map_err(at(&out.join(name)))?;
    }
    write(out, MADE, (names.join("\n") + "\n").as_bytes())?;
    Ok(names.into_iter().map(|name| out.join(name)).collect())
}

fn write(out: &Path, name: &str, content: &[u8]) -> Result<(), ReportError> {
    let path = out.join(name);
    whole::write(&path, |file| io::Write::write_all(file, content)).map_err(at(&path))
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::File { path, source }
}

#[cfg(test)]
mod tests;
