use super::*;
use tempfile::TempDir;

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

#[test]
fn files_of_a_report_that_was_killed_are_replaced_by_the_next() {
    let root = TempDir::new().unwrap();
    let out = root.path().join("study");
    fs::create_dir(&out).unwrap();
    // Killed while it wrote its third file, with one of the report before still there.
    for (name, text) in
        [(MADE, "a.svg\nc.svg\nb.svg\n"), ("a.svg", "2"), ("b.svg", "1"), (".unfinished-xxxxxx", "2")]
    {
        fs::write(out.join(name), text).unwrap();
    }
    fs::write(out.join("notes.txt"), "mine").unwrap();
    replace(&[file("a.svg", "3"), file("c.svg", "3")], &out).unwrap();
    assert_eq!(entries(&out), [".report", "a.svg", "c.svg", "notes.txt"]);
    assert_eq!(fs::read_to_string(out.join("a.svg")).unwrap(), "3");
}
