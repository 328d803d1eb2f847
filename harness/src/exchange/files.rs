//! Files of other codes: formats that are read, and their conversion.

use super::dat;
use super::fclib::{self, Held};
use super::symmetry::check;
use crate::terminal::read_text;
use anyhow::{Context, Result, anyhow, bail};
use cases::AnyFrozen;
use std::path::Path;

/// Returns the extension of a file, in lower case.
fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Reports whether a file has the extension of a format of another code.
pub(crate) fn is_foreign(path: &Path) -> bool {
    matches!(&*ending(path), "hdf5" | "h5" | "dat" | "npz")
}

/// The problem in a file of another code; says what it makes of one that is not as it should be.
///
/// # Errors
/// Names the file, and the dataset or the part of it that has no meaning.
pub(crate) fn read(path: &Path) -> Result<Held> {
    if !path.is_file() {
        bail!("{}: there is no such file", path.display());
    }
    let text = (ending(path) == "dat").then(|| read_text(path)).transpose()?;
    let mut notes = Vec::new();
    let mut read = || {
        let held = match (&text, &*ending(path)) {
            (Some(text), _) => Held::Local(dat::problem(text, &mut notes)?),
            (None, "npz") => bail!(
                "an archive of NumPy, as ContactBench writes, is not read: its W, q and μ are as an FCLIB file, which h5py writes"
            ),
            (None, _) => fclib::read(path, &mut notes)?,
        };
        if let Held::Local(problem) = &held {
            notes.extend(check(problem)?);
        }
        Ok(held)
    };
    let held = read().with_context(|| path.display().to_string())?;
    for note in notes {
        eprintln!("{}: {note}", path.display());
    }
    Ok(held)
}

/// The bytes of the file `to`, made of what the file `from` held.
///
/// # Errors
/// Says what has no meaning, or no place in a file of that kind.
pub(crate) fn converted(from: &Path, held: Held, to: &Path) -> Result<Vec<u8>> {
    let title = from.file_stem().unwrap_or_default().to_string_lossy();
    match (held, &*ending(to)) {
        (Held::Ours(text), "json") => {
            // What is no problem is not handed on.
            AnyFrozen::of_text(from, &text)?;
            Ok(text.into_bytes())
        }
        (Held::Ours(text), "hdf5" | "h5") => {
            let frozen = AnyFrozen::of_text(from, &text)?;
            let (name, problem) = (frozen.name().to_owned(), lineup::problem(frozen));
            fclib::write_global((&name, Some(&text)), problem.facts().dimensions, &problem.arrays())
        }
        (Held::Local(problem), "hdf5" | "h5") => fclib::write_local(&title, &problem),
        (Held::Local(_), "json") => Err(anyhow!(
            "{}: it has W but no grains, which a problem file needs: `gravel solve` takes it as it is",
            from.display()
        )),
        _ => Err(anyhow!("{}: the name of the file must end in .hdf5 (FCLIB) or .json", to.display())),
    }
}
