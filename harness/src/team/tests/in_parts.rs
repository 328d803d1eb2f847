//! A case that ranks make in parts.

use super::{Split, checkout};
use crate::cli::split;
use crate::root::Root;
use crate::team::share::Posted;
use crate::team::split as on_ranks;
use anyhow::Result;
use cases::Case;
use clap::Parser;
use lineup::make;
use partition::{Grid, Team};
use ranks::simulated;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use tempfile::TempDir;

/// Runs `gravel-mpi split` on so many ranks and returns the end of each.
fn split_in_parts(size: usize, arguments: &[&str], to: &Path) -> Vec<Result<ExitCode>> {
    let to = to.to_str().unwrap();
    let Split { args } = Split::parse_from([&["split", "deposited-box", "-o", to], arguments].concat());
    simulated(size, |post| on_ranks::run(&Posted(post), &Root::find(Some(checkout())).unwrap(), &args))
}

/// The files of a folder in their order, without the hash of the whole and the checksum of its line.
fn files(folder: &Path, count: usize) -> Vec<String> {
    let without_hash = |e: usize| {
        let text = fs::read_to_string(folder.join(format!("{e}.jsonl"))).unwrap();
        let (before, after) = text.split_once("\"problem_hash\":\"").unwrap();
        let (line, sealed) = after[16..].split_once(",\"crc32\":\"").unwrap();
        format!("{before}{line}{}", &sealed[8..])
    };
    assert_eq!(fs::read_dir(folder).unwrap().count(), count);
    (0..count).map(without_hash).collect()
}

#[test]
fn ranks_make_the_files_that_one_machine_splits_the_whole_into() {
    let sample = ["--scene", "sample.strips=4", "--scene", "sample.grains=1800"];
    let sample = [&sample[..], &["--scene", "scene.box.width_m=11", "--subdomains"]].concat();
    for (more, count) in [
        (&["4x1"][..], 4),
        (&["4x3", "--scene", "sample.seed=7"], 12),
        (&["4x2", "--scene", "scene.friction=0.3", "--scene", "scene.box.belt_speed_m_per_s=1.5"], 8),
        // Walls that push, and many gaps that may close.
        (&["4x2", "--scene", "scene.box.closing_speed_m_per_s=2", "--scene", "scene.law=predicted-gap"], 8),
        (&["4x2", "--scene", "scene.box.tilt_rate_rad_per_s=0.9", "--scene", "sample.lift_m=0.3"], 8),
    ] {
        let arguments = [&sample, more].concat();
        let folder = TempDir::new().unwrap();
        let whole = folder.path().join("whole");
        let to = whole.to_str().unwrap();
        let Split { args } =
            Split::parse_from([&["split", "deposited-box", "-o", to], &arguments[..]].concat());
        split::run(&Root::find(Some(checkout())).unwrap(), &args).unwrap();
        let whole = files(&whole, count);
        let mut hashes = Vec::new();
        for size in [1, 2, 3, 4] {
            let to = folder.path().join(size.to_string());
            for end in split_in_parts(size, &arguments, &to) {
                end.unwrap();
            }
            assert!(files(&to, count) == whole, "{more:?}: {size} ranks make other files");
            hashes.push(fs::read_to_string(to.join("0.jsonl")).unwrap()[..100].to_owned());
        }
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{more:?}: the hash is of the ranks");
    }
}

#[test]
fn a_rank_that_makes_parts_holds_its_own_and_little_more() {
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let changes = [set("sample.strips", "8"), set("sample.grains", "6000"), set("scene.box.width_m", "48")];
    let case = Case::read(&checkout().join("cases/deposited-box.toml"), &changes).unwrap();
    let made = simulated(8, |post| {
        let team = Team::new(post, 8).unwrap();
        let parts = case.in_parts().unwrap();
        let made = make(&parts, false, &team, Grid::of(8, 1), "", &mut |_, _| Ok(())).unwrap();
        (made.whole.grains, made.whole.contacts, made.most)
    });
    for (grains, contacts, [most_grains, most_contacts]) in made {
        assert_eq!(grains, 6000);
        // Its eighth, and what lies within 12 greatest radii at either side: 2.4 m of 6 m.
        assert!(most_grains * 5 < grains && most_contacts * 5 < contacts, "{most_grains}, {most_contacts}");
    }
}

#[test]
fn what_ranks_cannot_make_is_refused_alike() {
    let folder = TempDir::new().unwrap();
    let strips = ["--scene", "sample.strips=4", "--scene", "scene.box.width_m=12"];
    for (more, expected) in [
        (&["--subdomains", "3x2"][..], "--subdomains 3x2: it must have a column for each of the 4"),
        (&["--subdomains", "4x1", "--partition", "balanced"], "--partition: it must be boxes"),
        (&["--subdomains", "4x1", "--time-step", "2"], "--time-step 2: it must be 1"),
        (&["--subdomains", "4x1", "--scene", "scene.impact_speed_m_per_s=1"], "`scene.impact_speed_m_per_s`"),
        (
            &["--subdomains", "4x1", "--scene", "sample.intruder_radius_m=0.3"],
            "`sample.intruder_radius_m` is 0.3",
        ),
        (&["--subdomains", "4x1", "--scene", "scene.time_step_s=0.2"], "within a time step bodies come"),
    ] {
        let ends = split_in_parts(3, &[&strips, more].concat(), &folder.path().join("parts"));
        for end in ends {
            let reason = format!("{:#}", end.unwrap_err());
            assert!(reason.contains(expected), "{reason}");
        }
    }
    let ends = split_in_parts(2, &["--subdomains", "4x1"], &folder.path().join("parts"));
    assert!(
        ends.into_iter().all(|end| format!("{:#}", end.unwrap_err()).contains("`sample.strips` is left out"))
    );
}
