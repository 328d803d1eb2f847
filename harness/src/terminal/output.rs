//! Lines on standard output, and files that appear whole or not at all.

use crate::terminal::exit;
use anyhow::{Context, Result, bail};
use cases::compressed;
use results::whole::{self, behind_links, remove_abandoned};
use seal::{opened, sealed};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt::Arguments;
use std::fs::OpenOptions;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Prints a line. Whoever reads may have left, as `head` does: the work goes on without.
pub(crate) fn say(line: Arguments) -> Result<()> {
    match writeln!(io::stdout(), "{line}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints a table of Markdown.
pub(crate) fn say_table(headings: &[&str], rows: &[Vec<String>]) -> Result<()> {
    say(format_args!("| {} |", headings.join(" | ")))?;
    say(format_args!("|{}", "---|".repeat(headings.len())))?;
    rows.iter().try_for_each(|row| say(format_args!("| {} |", row.join(" | ").replace('\n', " "))))
}

/// An object with the keys of another one after its own.
pub(crate) fn merged(mut object: Value, more: Value) -> Value {
    if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
        object.extend(more);
    }
    object
}

/// Refuses a place where no file can be: known before the work, not after it. What programs that were killed did not finish
/// there is removed.
pub(crate) fn prepare_place(path: &Path) -> Result<()> {
    if path.is_dir() {
        bail!("{} is a folder: give the path of a file", path.display());
    }
    let target = behind_links(path).with_context(|| path.display().to_string())?;
    if !folder(&target).is_dir() {
        bail!("{}: there is no folder {}", path.display(), folder(&target).display());
    }
    // A folder that cannot be listed may still take a file.
    let _ = remove_abandoned(folder(&target));
    Ok(())
}

/// Prepares the place of a file, as [`prepare_place`] does, and refuses one that is there.
pub(crate) fn prepare_new(path: &Path) -> Result<()> {
    if path.exists() {
        bail!("{} exists: give another file", path.display());
    }
    prepare_place(path)
}

/// Refuses two files, each named by its argument, that are one: the second would replace the first.
pub(crate) fn check_apart(files: &[(&str, &Path)]) -> Result<()> {
    for (k, (argument, path)) in files.iter().enumerate() {
        if let Some((other, _)) = files[..k].iter().find(|(_, other)| is_one_file(path, other)) {
            bail!("{other} and {argument} are one file, {}: give another path", path.display());
        }
    }
    Ok(())
}

/// Reports whether two paths lead to one file, which need not be there yet. Devices and pipes may be written to twice.
pub(crate) fn is_one_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| -> Option<PathBuf> {
        let target = behind_links(path).ok()?;
        Some(folder(&target).canonicalize().ok()?.join(target.file_name()?))
    };
    let is_file = |path: &Path| !is_stdout(path) && path.metadata().map_or(true, |found| found.is_file());
    is_file(a) && is_file(b) && place(a).is_some_and(|a| place(b) == Some(a))
}

/// Reports whether writing to `path` replaces a file.
pub(crate) fn replaces(path: &Path) -> bool {
    path.is_file() && !is_stdout(path)
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The text of a file.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    Ok(cases::read_text(path)?)
}

/// Creates the folder of a file where it is not there.
pub(crate) fn create_folder_of(path: &Path) -> Result<()> {
    std::fs::create_dir_all(folder(path)).with_context(|| folder(path).display().to_string())
}

/// Returns the text of a file that [`write_sealed`] wrote, without its checksum; and whether it has one, as those from before there were any
/// have not.
pub(crate) fn read_sealed(path: &Path) -> Result<(String, bool)> {
    let text = read_text(path)?;
    let opened = opened(text.as_bytes()).with_context(|| path.display().to_string())?;
    Ok(opened.map_or((text, false), |text| (String::from_utf8_lossy(&text).into_owned(), true)))
}

/// Returns the content that `read` makes of a file that is kept to spare computing it again; says why where it cannot.
pub(crate) fn at_hand<T>(path: &Path, read: impl FnOnce() -> Result<T>) -> Option<T> {
    path.exists().then(|| read().inspect_err(|error| eprintln!("{error:#}: computed again")).ok())?
}

/// Writes an object of JSON with its checksum, whole, in a folder that need not be there.
pub(crate) fn write_sealed(path: &Path, object: &str) -> Result<()> {
    write_kept(path, &sealed(object))
}

/// Writes a file whole, in a folder that need not be there. What programs that were killed did not finish there is removed.
pub(crate) fn write_kept(path: &Path, content: &str) -> Result<()> {
    create_folder_of(path)?;
    remove_abandoned(folder(path)).with_context(|| folder(path).display().to_string())?;
    write_whole(path, content)
}

/// Writes a file whole, and says so where it takes the place of another.
pub(crate) fn write_instead(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    if replaces(path) {
        eprintln!("replacing {}", path.display());
    }
    write_whole(path, content)
}

/// Writes `content` to a file beside `path` and gives it that name once it is complete; compressed, if the name ends in `.gz`. A link stays and its target is
/// written; what is no regular file, such as a pipe or a terminal, is written to as it is.
pub(crate) fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let (mut content, _whole) = (Cow::from(content.as_ref()), exit::whole());
    if path.extension().is_some_and(|ending| ending == "gz") {
        content = compressed(&content)?.into();
    }
    let write = || -> io::Result<()> {
        if is_stdout(path) {
            return io::stdout().write_all(&content);
        }
        if path.metadata().is_ok_and(|found| !found.is_file()) {
            return OpenOptions::new().write(true).open(path)?.write_all(&content);
        }
        whole::write(path, |file| file.write_all(&content))
    };
    write().with_context(|| format!("writing {}", path.display()))
}

/// Reports whether it is standard output, which may be a file that whoever called has open.
fn is_stdout(path: &Path) -> bool {
    ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|stdout| path == Path::new(stdout))
}
