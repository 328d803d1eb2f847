//! The folder of a report: it appears as a whole, in place of the one before.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use tempfile::TempDir;

use crate::ReportError;
use crate::part::File;

/// Names the files of the report, so that the next one knows which files it may replace.
const MADE: &str = ".report";

/// Names of the files that the last report left in the folder `out` and that are still there.
pub fn made(out: &Path) -> Vec<String> {
    let list = fs::read_to_string(out.join(MADE)).unwrap_or_default();
    list.lines().filter(|name| out.join(name).is_file()).map(str::to_owned).collect()
}

/// Puts `files` into the folder `out` in place of those of the report before; what that did not make stays.
pub(crate) fn replace(files: &[File], out: &Path) -> Result<Vec<PathBuf>, ReportError> {
    // A file of that name is refused here.
    fs::create_dir_all(out).map_err(at(out))?;
    let before = made(out);
    let someones = |file: &&File| out.join(&file.name).exists() && !before.contains(&file.name);
    if let Some(File { name, .. }) = files.iter().find(someones) {
        let why = "no report made this file, and one would replace it: move it, or give it another name";
        return Err(at(&out.join(name))(io::Error::other(why)));
    }
    // A link to the folder stays: what it leads to is replaced.
    let place = fs::canonicalize(out).map_err(at(out))?;
    let parent = place.parent().unwrap_or(&place);
    let drafts = TempDir::with_prefix_in(".unfinished-", parent).map_err(at(parent))?;
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

fn swap(new: &Path, old: &Path, out: &Path) -> io::Result<()> {
    fs::rename(out, old)?;
    if let Err(error) = fs::rename(new, out) {
        fs::rename(old, out)?;
        return Err(error);
    }
    let list = fs::read_to_string(old.join(MADE)).unwrap_or_default();
    let made: BTreeSet<&str> = list.lines().chain([MADE]).collect();
    for entry in fs::read_dir(old)? {
        let entry = entry?;
        let (name, place) = (entry.file_name(), out.join(entry.file_name()));
        if !name.to_str().is_some_and(|name| made.contains(name)) && !place.exists() {
            fs::rename(entry.path(), place)?;
        }
    }
    Ok(())
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::File { path, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> File {
        File::new(name.to_owned(), text)
    }

    fn entries(folder: &Path) -> Vec<String> {
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(name).collect();
        names.sort();
        names
    }

    #[test]
    fn files_of_the_report_before_go_and_those_of_others_stay() {
        let root = TempDir::new().unwrap();
        let out = root.path().join("a/study");
        replace(&[file("a.svg", "1"), file("b.svg", "1")], &out).unwrap();
        fs::write(out.join("notes.txt"), "mine").unwrap();
        fs::create_dir(out.join("more")).unwrap();
        let paths = replace(&[file("b.svg", "2"), file("c.svg", "2")], &out).unwrap();
        assert_eq!(paths, [out.join("b.svg"), out.join("c.svg")]);
        assert_eq!(entries(&out), [".report", "b.svg", "c.svg", "more", "notes.txt"]);
        assert_eq!(fs::read_to_string(out.join("b.svg")).unwrap(), "2");
        assert_eq!(entries(&root.path().join("a")), ["study"], "no draft is left");
    }

    #[test]
    fn folder_that_no_report_made_keeps_its_files() {
        let root = TempDir::new().unwrap();
        let out = root.path().join("study");
        fs::create_dir(&out).unwrap();
        fs::write(out.join("notes.txt"), "mine").unwrap();
        replace(&[file("a.svg", "1")], &out).unwrap();
        assert_eq!(entries(&out), [".report", "a.svg", "notes.txt"]);
    }

    #[test]
    fn file_of_someone_else_that_a_report_would_replace_is_refused_and_kept() {
        let root = TempDir::new().unwrap();
        let out = root.path().join("study");
        replace(&[file("a.svg", "1")], &out).unwrap();
        fs::write(out.join("b.svg"), "mine").unwrap();
        let error = replace(&[file("a.svg", "2"), file("b.svg", "2")], &out).unwrap_err().to_string();
        assert!(error.contains("b.svg: no report made this file"), "{error}");
        assert_eq!(fs::read_to_string(out.join("b.svg")).unwrap(), "mine");
        assert_eq!(fs::read_to_string(out.join("a.svg")).unwrap(), "1");
        // What a report made and someone removed is made again.
        fs::remove_file(out.join("a.svg")).unwrap();
        assert!(made(&out).is_empty());
        replace(&[file("a.svg", "3")], &out).unwrap();
        assert_eq!(made(&out), ["a.svg"]);
    }

    #[cfg(unix)]
    #[test]
    fn link_to_the_folder_stays_and_its_target_is_filled() {
        let root = TempDir::new().unwrap();
        let (out, target) = (root.path().join("out"), root.path().join("elsewhere"));
        fs::create_dir(&target).unwrap();
        std::os::unix::fs::symlink(&target, &out).unwrap();
        replace(&[file("a.svg", "1")], &out).unwrap();
        fs::write(target.join("notes.txt"), "mine").unwrap();
        let paths = replace(&[file("a.svg", "2")], &out).unwrap();
        assert_eq!(paths, [out.join("a.svg")]);
        assert!(out.is_symlink() && fs::read_to_string(target.join("a.svg")).unwrap() == "2");
        assert_eq!(entries(&target), [".report", "a.svg", "notes.txt"]);
    }

    #[test]
    fn file_in_place_of_the_folder_is_refused_and_kept() {
        let root = TempDir::new().unwrap();
        let out = root.path().join("study");
        fs::write(&out, "mine").unwrap();
        assert!(replace(&[file("a.svg", "1")], &out).is_err());
        assert_eq!(fs::read_to_string(&out).unwrap(), "mine");
    }
}
