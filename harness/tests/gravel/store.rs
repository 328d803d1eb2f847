//! Studies that are stopped, go on, grow, begin again and are joined: nothing that ended is lost or made twice.

use crate::bench::{Study, counts, plan, rows, study_of_the_pair_and_a_column};
use crate::common::{checkout, command, entries, text, without_checksums, write};
use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

fn lines(folder: &Path) -> Vec<String> {
    let journal = fs::read_to_string(folder.join("journal.jsonl")).unwrap();
    journal.lines().map(str::to_owned).collect()
}

/// NSGS in several orders, some 10 ms each.
fn study_of_a_shear_box() -> Study {
    let study = Study::new();
    let name = "cases/frozen/shear-box-991-rest.json";
    fs::copy(checkout().join(name), study.folder().path().join(name)).unwrap();
    let nsgs = "[[methods]]\nmethod = \"nsgs\"\nset = { order = \"shuffled\" }\naxes = { seed = SEEDS }\n";
    let seeds: Vec<usize> = (1..=RUNS).collect();
    let nsgs = nsgs.replace("SEEDS", &format!("{seeds:?}"));
    let text = plan("box", &["shear-box-991-rest"], &nsgs).replace("10_000", "150");
    write(study.folder(), "harness/plans/box.toml", &text);
    study
}

const RUNS: usize = 16;

#[test]
fn study_killed_at_any_instant_goes_on_and_ends_with_the_same_counts() {
    let (killed, undisturbed) = (study_of_a_shear_box(), study_of_a_shear_box());
    let journal = |study: &Study| study.runs("box").join("journal.jsonl");
    let length = |study: &Study| fs::metadata(journal(study)).map_or(0, |file| file.len());
    undisturbed.bench("box");
    let whole = length(&undisturbed);
    let args = ["--root", text(killed.folder().path()), "bench", "box"];
    let mut stopped_at = BTreeSet::new();
    // Instants are counted in what is written, since nobody knows how fast the machine is; then some milliseconds more,
    // in no order. The last two are among the tables and figures.
    for (kill, milliseconds) in [3, 11, 0, 7, 5, 1, 9, 2, 0, 6].into_iter().enumerate() {
        let written = whole * (kill as u64).min(8) / 8;
        let mut child = command(&args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while length(&killed) < written && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        stopped_at.insert(length(&killed));
    }
    assert!(stopped_at.len() > 4, "stopped where the journal had {stopped_at:?} of {whole} bytes");
    killed.bench("box");
    for table in ["runs.csv", "curves.csv"] {
        assert_eq!(counts(&killed, "box", table), counts(&undisturbed, "box", table));
    }
    assert_eq!(lines(&killed.runs("box")).len(), RUNS, "a run that had ended is not made again");
}

#[test]
fn run_cut_short_in_the_journal_is_reported_and_repeated() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let (before, counted) = (lines(&folder), counts(&study, "small", "runs.csv"));
    let whole = fs::read(folder.join("journal.jsonl")).unwrap();
    fs::write(folder.join("journal.jsonl"), &whole[..whole.len() - 10]).unwrap();
    let again = study.gravel(&["bench", "small"]).succeeded();
    assert!(again.stderr.contains("small: the last run was not written to its end"), "{}", again.stderr);
    assert!(again.stdout.contains("1 of 8 to run"), "{}", again.stdout);
    assert_eq!(lines(&folder)[..7], before[..7]);
    assert_eq!(counts(&study, "small", "runs.csv"), counted);
}

#[test]
fn store_that_is_damaged_is_refused_by_its_line_and_kept_by_a_fresh_one() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let whole = lines(&folder).join("\n") + "\n";
    let carved = |text: &str| text.replacen("\"curve\"", "\"carve\"", 1);
    fs::write(folder.join("journal.jsonl"), carved(&whole)).unwrap();
    study.gravel(&["bench", "small"]).refused(&["journal.jsonl, line 1: damaged", "checksum", "--fresh"]);
    let damaged = carved(&without_checksums(&whole));
    fs::write(folder.join("journal.jsonl"), &damaged).unwrap();
    // Refused after the plan was read, before anything ran.
    study.gravel(&["bench", "small"]).refused(&["journal.jsonl, line 1", "`curve`", "--fresh"]);
    assert_eq!(lines(&folder).join("\n") + "\n", damaged);
    let fresh = study.gravel(&["bench", "small", "--fresh"]).succeeded().stdout;
    assert!(fresh.contains("what was there is now in ") && fresh.contains("8 of 8 to run"), "{fresh}");
    let kept = entries(&folder).into_iter().find(|name| name.starts_with("20")).unwrap();
    assert_eq!(lines(&folder.join(kept)).join("\n") + "\n", damaged);
    assert_eq!(lines(&folder).len(), 8);
}

#[test]
fn plan_that_grows_makes_its_new_runs_only_and_one_that_shrinks_keeps_the_old() {
    let study = study_of_the_pair_and_a_column();
    let bench = |relaxation: &str| {
        let nsgs = format!("[[methods]]\nmethod = \"nsgs\"\naxes = {{ relaxation = [{relaxation}] }}\n");
        study.plan("grown", &["pair"], &nsgs);
        let printed = study.gravel(&["bench", "grown"]).succeeded().stdout;
        let rows = rows(study.runs("grown").join("runs.csv"));
        (printed, rows.iter().map(|row| row["variant"].clone()).collect::<Vec<_>>())
    };
    let (printed, variants) = bench("1.0");
    // Its name says nothing while it is alone; the table follows the plan as it is.
    assert!(printed.contains("1 of 1 to run") && variants == [""], "{printed}");
    let (printed, variants) = bench("0.5, 1.0");
    assert!(printed.contains("1 of 2 to run") && variants == ["0.5", "1"], "{printed} {variants:?}");
    let (printed, variants) = bench("0.5, 1.0");
    assert!(printed.contains("0 of 2 to run") && variants == ["0.5", "1"], "{printed}");
    let (printed, variants) = bench("0.5");
    assert!(printed.contains("0 of 1 to run") && variants == [""], "{printed}");
    assert!(printed.contains("Of earlier code, or no longer in the plan: 1 runs;"), "{printed}");
    assert_eq!(lines(&study.runs("grown")).len(), 2);
}

#[test]
fn rows_of_another_machine_or_build_are_reported() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    assert!(!study.gravel(&["bench", "small"]).succeeded().stdout.contains("builds, machines"));
    let processor = rows(folder.join("runs.csv"))[0]["processor"].clone();
    let mut moved = lines(&folder);
    moved[0] = without_checksums(&moved[0]).trim_end().to_owned();
    moved[0] = moved[0].replacen(&processor, "another processor", 1);
    fs::write(folder.join("journal.jsonl"), moved.join("\n") + "\n").unwrap();
    let printed = study.gravel(&["bench", "small"]).succeeded().stdout;
    assert!(printed.contains("0 of 8") && printed.contains("rows come from 2 builds, machines"), "{printed}");
}

#[test]
fn stores_of_two_machines_join() {
    let (here, there) = (study_of_the_pair_and_a_column(), study_of_the_pair_and_a_column());
    let (small, both) = (here.runs("small"), counts_after_bench(&here));
    // The other machine made the second problem only, and one run of the first.
    let theirs = there.bench("small");
    let (ours, all) = (lines(&small), lines(&theirs));
    fs::write(small.join("journal.jsonl"), ours[..4].join("\n") + "\n").unwrap();
    fs::write(theirs.join("journal.jsonl"), all[3..].join("\n") + "\n").unwrap();
    let printed = here.gravel(&["merge", "small", text(&theirs)]).succeeded().stdout;
    assert!(printed.contains("4 of 5 runs are new here"), "{printed}");
    assert_eq!(counts(&here, "small", "runs.csv"), both);
    assert_eq!(lines(&small)[..4], ours[..4]);
    here.gravel(&["merge", "small", text(here.folder().path())]).refused(&["journal.jsonl"]);
}

fn counts_after_bench(study: &Study) -> Vec<std::collections::BTreeMap<String, String>> {
    study.bench("small");
    counts(study, "small", "runs.csv")
}

/// A line of a journal that counts more contacts updated at the end of the run.
fn with_other_counts(line: &str) -> String {
    let line = without_checksums(line);
    let (before, end) = line.split_once("\"end\":").unwrap();
    seal::sealed(&format!(
        "{before}\"end\":{}",
        end.replacen("\"contact_updates\":", "\"contact_updates\":1", 1)
    ))
}

#[test]
fn what_is_from_before_there_were_checksums_is_read_with_a_word() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let report = || study.gravel(&["report", "small"]).succeeded().stderr;
    assert_eq!(report(), "");
    let journal = folder.join("journal.jsonl");
    fs::write(&journal, without_checksums(&fs::read_to_string(&journal).unwrap())).unwrap();
    let said = study.gravel(&["plan", "small"]).succeeded().stderr;
    assert!(said.contains("journal from before there were checksums: 8;"), "{said}");
}

#[test]
fn damaged_table_is_refused_and_bench_makes_it_again() {
    let study = study_of_the_pair_and_a_column();
    let file = study.bench("small").join("curves.parquet");
    let mut bytes = fs::read(&file).unwrap();
    bytes[100] ^= 1;
    fs::write(&file, bytes).unwrap();
    study
        .gravel(&["report", "small"])
        .refused(&["curves.parquet: damaged", "`gravel bench` makes the tables again"]);
    assert!(study.gravel(&["bench", "small"]).succeeded().stdout.contains("0 of 8 to run"));
    study.gravel(&["report", "small"]).succeeded();
}

#[test]
fn merge_refuses_a_store_whose_counts_differ_and_adds_nothing() {
    let (here, there) = (study_of_the_pair_and_a_column(), study_of_the_pair_and_a_column());
    let (ours, theirs) = (here.bench("small"), there.bench("small"));
    let all = lines(&theirs);
    fs::write(ours.join("journal.jsonl"), all[..7].join("\n") + "\n").unwrap();
    let before = lines(&ours);
    let updates = rows(ours.join("runs.csv"))[0]["contact_updates"].clone();
    let odd = with_other_counts(&all[0]) + &all[1..].join("\n") + "\n";
    fs::write(theirs.join("journal.jsonl"), &odd).unwrap();
    let id = &rows(ours.join("runs.csv"))[0]["id"];
    let differs = format!("run {id} (nsgs on pair) has contact_updates {updates} here and 1{updates} in ");
    let merge = |from: &Path| here.gravel(&["merge", "small", text(from)]);
    merge(&theirs).refused(&[&differs, text(&theirs), "Nothing was merged", "--rerun"]);
    assert_eq!(lines(&ours), before);
    // Run again there, with our counts: of two runs of one id the later counts.
    fs::write(theirs.join("journal.jsonl"), odd + &all[0] + "\n").unwrap();
    assert!(merge(&theirs).succeeded().stdout.contains("1 of 9 runs are new here"));
}

#[test]
fn status_and_method_that_are_none_are_refused_by_their_line() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let whole = without_checksums(&(lines(&folder).join("\n") + "\n"));
    let with = |name: &str, wrong: &str| {
        fs::write(folder.join("journal.jsonl"), whole.replacen(name, wrong, 1)).unwrap();
    };
    with("\"converged\"", "\"convurged\"");
    study.gravel(&["bench", "small"]).refused(&[
        "journal.jsonl, line ",
        "`status` is \"convurged\"",
        "skipped",
    ]);
    with("\"method\":\"nsgs\"", "\"method\":\"nsgr\"");
    study.gravel(&["bench", "small"]).refused(&["journal.jsonl, line ", "`method` is \"nsgr\"", "nsgs-dd"]);
    with("none", "none");
    assert!(study.gravel(&["bench", "small"]).succeeded().stdout.contains("0 of 8 to run"));
}

#[test]
fn runs_of_one_id_that_count_other_work_are_reported() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let text = lines(&folder).join("\n") + "\n" + &with_other_counts(&lines(&folder)[0]);
    fs::write(folder.join("journal.jsonl"), text).unwrap();
    let printed = study.gravel(&["bench", "small"]).succeeded().stdout;
    assert!(printed.contains("WARNING") && printed.contains("nsgs on pair"), "{printed}");
}

#[test]
fn rerun_appends_and_its_rows_count() {
    let study = study_of_the_pair_and_a_column();
    let folder = study.bench("small");
    let before = lines(&folder);
    study.gravel(&["bench", "small", "--rerun"]).succeeded();
    let after = lines(&folder);
    assert_eq!((after.len(), &after[..8]), (16, &before[..]));
    let table = rows(folder.join("runs.csv"));
    let last: serde_json::Value = serde_json::from_str(&after[8]).unwrap();
    assert_eq!(table.len(), 8);
    assert_eq!(table[0]["wall_s"].parse::<f64>().unwrap(), last["run"]["timing"]["wall_s"]);
    let ids: BTreeSet<&String> = table.iter().map(|row| &row["id"]).collect();
    assert_eq!(ids.len(), 8);
}

#[test]
fn study_that_another_process_makes_is_refused() {
    let study = study_of_the_pair_and_a_column();
    let holder: results::store::Store =
        results::store::Store::open(study.runs("small").parent().unwrap(), "small").unwrap();
    let process = format!("process {} since", std::process::id());
    study.gravel(&["bench", "small"]).refused(&["results/runs/small", &process, "wait"]);
    study.gravel(&["bench", "small", "--fresh"]).refused(&[&process]);
    drop(holder);
    study.bench("small");
}

#[cfg(unix)]
#[test]
fn full_disk_is_reported_and_loses_no_run_that_ended() {
    let study = study_of_a_shear_box();
    // The system refuses to let a file grow beyond so many blocks, as a full disk does.
    let limited = "trap '' XFSZ; ulimit -f 256; exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_gravel"), "bench", "box"])
        .args(["--root", text(study.folder().path())])
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success());
    assert!(
        printed.contains("journal.jsonl: ") && printed.contains("`gravel bench box` goes on"),
        "{printed}"
    );
    let kept = lines(&study.runs("box"));
    assert!(!kept.is_empty() && kept.len() < RUNS, "{} runs fit", kept.len());
    study.bench("box");
    assert_eq!(lines(&study.runs("box"))[..kept.len()], kept);
    assert_eq!(rows(study.runs("box").join("runs.csv")).len(), RUNS);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_after_the_iteration_and_keeps_what_had_ended() {
    let study = study_of_a_shear_box();
    // The first run ends, the second never does.
    let methods = "[[methods]]\nmethod = \"cg\"\n\n[[methods]]\nmethod = \"jacobi\"\n";
    let endless = plan("endless", &["shear-box-991-rest"], methods);
    let endless = endless.replace("10_000", "1_000_000_000").replace("1e-3", "1e-9");
    write(study.folder(), "harness/plans/endless.toml", &endless);
    let args = ["--root", text(study.folder().path()), "bench", "endless"];
    let mut child = command(&args).stdout(Stdio::piped()).spawn().unwrap();
    let mut printed = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(printed.next().unwrap().unwrap().contains("2 of 2 to run"));
    while lines(&study.runs("endless")).is_empty() {
        sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let rest: Vec<String> = printed.map(Result::unwrap).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(
        rest[0].starts_with("stopped; runs missing: 1, the others are kept; `gravel bench endless`"),
        "{rest:?}"
    );
    assert_eq!(rows(study.runs("endless").join("runs.csv")).len(), 1);
}
