//! Files that a command writes where something is already: links stay, pipes and devices are written to.

use crate::common::{command, entries, gravel, pair, text, write};
use cases::Frozen;
use contact::Discs;
use serde_json::Value;
use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The commands that write a file to a given place, each with the arguments before its path.
fn writers(folder: &TempDir) -> Vec<Vec<String>> {
    let problem = write(folder, "pair.json", &pair().to_string());
    let solve = ["solve", text(&problem), "--impulses"].map(str::to_owned).to_vec();
    let freeze = ["freeze", "column", "--time-step", "1", "--force", "-o"].map(str::to_owned).to_vec();
    let view = ["view", text(&problem), "--run", "nsgs", "-o"].map(str::to_owned).to_vec();
    vec![solve, freeze, view]
}

fn run(writer: &[String], place: &Path) {
    let args: Vec<&str> = writer.iter().map(String::as_str).chain([text(place)]).collect();
    gravel(&args).succeeded();
}

fn fifo(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    path
}

#[test]
fn link_stays_and_its_target_is_written() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    for writer in writers(&folder) {
        let (link, target) = (folder.path().join("link"), folder.path().join("elsewhere/target"));
        // Seen from the folder of the link.
        symlink("elsewhere/target", &link).unwrap();
        // First the target is not there, then it is.
        for _ in 0..2 {
            run(&writer, &link);
            assert!(link.is_symlink(), "{writer:?}");
            assert!(fs::metadata(&target).unwrap().len() > 10, "{writer:?}");
            fs::write(&target, "old").unwrap();
        }
        fs::remove_file(link).unwrap();
        fs::remove_file(target).unwrap();
    }
}

#[test]
fn pipe_and_device_are_written_to_and_stay() {
    let folder = TempDir::new().unwrap();
    let pipe = fifo(&folder);
    for writer in writers(&folder) {
        let reader = Command::new("cat").arg(&pipe).stdout(std::process::Stdio::piped()).spawn().unwrap();
        run(&writer, &pipe);
        assert!(reader.wait_with_output().unwrap().stdout.len() > 10, "{writer:?}");
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo(), "{writer:?}");
        let null = folder.path().join("null");
        symlink("/dev/null", &null).unwrap();
        run(&writer, &null);
        assert!(null.is_symlink() && Path::new("/dev/null").metadata().unwrap().file_type().is_char_device());
        fs::remove_file(null).unwrap();
    }
}

#[test]
fn standard_output_takes_a_file_before_what_is_said() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let args = ["freeze", "column", "--time-step", "1", "-o", "/dev/stdout"];
    let status = command(&args).stdout(fs::File::create(&out).unwrap()).status().unwrap();
    assert!(status.success());
    let printed = fs::read_to_string(out).unwrap();
    let (frozen, said) = printed.split_once('\n').unwrap();
    assert!(
        serde_json::from_str::<Value>(frozen).is_ok() && said.starts_with("/dev/stdout: 20 grains"),
        "{said}"
    );
    let file = write(&folder, "again.json", frozen);
    assert_eq!(Frozen::<Discs>::read(&file).unwrap().name, "stdout");
}

#[test]
fn two_outputs_to_one_file_and_an_output_over_its_problem_are_refused_before_the_work() {
    let folder = TempDir::new().unwrap();
    let problem = write(&folder, "pair.json", &pair().to_string());
    let before = fs::read(&problem).unwrap();
    let link = folder.path().join("link");
    symlink("out", &link).unwrap();
    let out = folder.path().join("out");
    let solve = ["solve", text(&problem), "--impulses"];
    // Through a link to what is not there yet, too.
    for other in
        [&out, &link, &folder.path().join("../").join(folder.path().file_name().unwrap()).join("out")]
    {
        gravel(&[&solve[..], &[text(&out), "--homogenised", text(other)]].concat())
            .refused(&["--impulses and --homogenised are one file", "give another path"]);
        assert!(!out.exists());
    }
    gravel(&[&solve[..], &[text(&problem)]].concat()).refused(&["the problem and --impulses are one file"]);
    let simulate = ["simulate", "two-discs", "--time-steps", "2", "-o", text(&out), "--vtk"];
    gravel(&[&simulate[..], &[text(&link)]].concat())
        .refused(&["--output and --vtk are one", "give another path"]);
    assert!(!out.exists());
    gravel(&["convert", text(&problem), text(&problem)]).refused(&["the problem and FILE are one file"]);
    assert_eq!(fs::read(&problem).unwrap(), before);
    gravel(&[&solve[..], &["/dev/null", "--homogenised", "/dev/null"]].concat()).succeeded();
    gravel(&[&solve[..], &[text(&out), "--homogenised", text(&folder.path().join("other"))]].concat())
        .succeeded();
}

/// Name of a file that a program which was killed did not finish.
const ABANDONED: &str = ".unfinished-aB3xYz";

#[test]
fn what_killed_programs_left_beside_an_output_is_removed_and_no_other_file() {
    let folder = TempDir::new().unwrap();
    let problem = write(&folder, "pair.json", &pair().to_string());
    let out = folder.path().join("out.hdf5");
    // Files of others, and one to which a program still writes.
    write(&folder, ".unfinished-chapter.tex", "mine");
    fs::create_dir(folder.path().join(".unfinished-folder")).unwrap();
    let under_way = fs::File::create(folder.path().join(".unfinished-000000")).unwrap();
    under_way.lock().unwrap();
    for writer in [
        &["freeze", "column", "--time-step", "1", "-o"][..],
        &["convert", text(&problem)],
        &["simulate", "two-discs", "--time-steps", "1", "-o"],
        &["solve", text(&problem), "--impulses"],
    ] {
        write(&folder, ABANDONED, "half");
        run(&writer.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>(), &out);
        let kept =
            [".unfinished-000000", ".unfinished-chapter.tex", ".unfinished-folder", "out.hdf5", "pair.json"];
        assert_eq!(entries(folder.path()), kept, "{writer:?}");
        fs::remove_file(&out).unwrap();
    }
}

#[test]
fn links_that_lead_in_a_circle_are_refused_before_the_work() {
    let folder = TempDir::new().unwrap();
    let link = folder.path().join("loop");
    symlink(&link, &link).unwrap();
    gravel(&["freeze", "column", "--time-step", "1000000000", "-o", text(&link)])
        .refused(&["loop", "circle"]);
    assert!(link.is_symlink());
}
