//! `gravel report` and `gravel figure`: a stored study is drawn again, without running it.

use crate::bench::{Study, rows};
use crate::common::{entries, text, write};
use std::fs;
use std::process::Command;

const PLAN: &str = r#"
name = "drawn"
why = "A test."
problems = ["pair"]
charts = ["subdomains"]

[stop]
on = "natural_map"
tolerance = 1e-3
max_iterations = 100

[[methods]]
method = "nsgs"
"#;

#[test]
fn report_draws_the_charts_of_the_plan_from_its_stored_rows() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.gravel(&["report", "drawn"]).refused(&["no study of plan `drawn`", "gravel bench"]);
    study.bench("drawn");
    let out = study.folder().path().join("reports/out/drawn");
    let made = [
        ".report",
        "index.html",
        "iterations.csv",
        "iterations.md",
        "iterations.tex",
        "subdomains-pair.svg",
        "subdomains.csv",
        "subdomains.md",
        "subdomains.tex",
    ];
    assert_eq!(entries(&out), made);
    let read = || made.map(|name| fs::read(out.join(name)).unwrap());
    let first = read();
    fs::write(out.join("iterations.md"), "spoilt").unwrap();
    fs::write(out.join("mine.txt"), "mine").unwrap();
    study.gravel(&["report", "drawn"]).succeeded();
    assert_eq!(read(), first);
    assert_eq!(fs::read_to_string(out.join("mine.txt")).unwrap(), "mine");
}

/// A copy of the tables gives the same files, without the study.
#[test]
fn report_draws_from_the_tables_of_a_folder() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.bench("drawn");
    let out = study.folder().path().join("reports/out/drawn");
    let drawn = fs::read(out.join("subdomains.csv")).unwrap();
    let archive = study.folder().path().join("archive");
    fs::rename(study.runs("drawn"), &archive).unwrap();
    fs::remove_dir_all(&out).unwrap();
    study.gravel(&["report", "drawn", "--rows", text(&archive)]).succeeded();
    assert_eq!(fs::read(out.join("subdomains.csv")).unwrap(), drawn);
    study.gravel(&["report", "drawn", "--rows", "nowhere"]).refused(&["nowhere"]);
}

#[test]
fn figure_draws_one_chart_beside_the_report() {
    let study = Study::new();
    write(
        study.folder(),
        "harness/plans/drawn.toml",
        &(PLAN.to_owned() + "\n[[methods]]\nmethod = \"cg\"\n"),
    );
    study.bench("drawn");
    study.gravel(&["figure", "size", "drawn"]).succeeded();
    let out = study.folder().path().join("reports/out");
    assert_eq!(entries(&out), ["drawn", "drawn-size"]);
    assert!(entries(&out.join("drawn-size")).contains(&"size.csv".to_owned()));
    let methods = || -> Vec<String> {
        let rows = rows(out.join("drawn-size/size.csv"));
        let mut methods: Vec<String> = rows.into_iter().map(|row| row["method"].clone()).collect();
        methods.dedup();
        methods
    };
    let all = methods();
    assert!(all.len() > 1, "{all:?}");
    study.gravel(&["figure", "size", "drawn", "--only", &format!("method={}", all[0])]).succeeded();
    assert_eq!(methods(), all[..1]);
    let only = |only: &str, words: &[&str]| {
        study.gravel(&["figure", "size", "drawn", "--only", only]).refused(words);
    };
    only("method=nsgz", &["--only method=nsgz", "nsgs"]);
    only("methods=nsgs", &["--only methods=nsgs", "problem, method, variant", "method"]);
    study.gravel(&["figure", "sizes", "drawn"]).refused(&["`sizes`", "convergence", "size"]);
}

#[test]
fn figures_become_png_and_pdf_with_their_font_where_asked() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.bench("drawn");
    study.gravel(&["report", "drawn", "--png", "--pdf"]).succeeded();
    let read = |name: &str| fs::read(study.folder().path().join("reports/out/drawn").join(name)).unwrap();
    let png = read("subdomains-pair.png");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    // A page of a journal, 175 mm, at 300 to the inch.
    assert_eq!(side(16), 2067);
    let pdf = read("subdomains-pair.pdf");
    assert!(pdf.starts_with(b"%PDF-") && pdf.windows(8).any(|word| word == b"FontFile".as_slice()));
    // What was asked for once is drawn again, by whatever draws, until someone deletes it.
    let out = study.folder().path().join("reports/out/drawn");
    for again in [["bench", "drawn"], ["report", "drawn"]] {
        fs::write(out.join("subdomains-pair.pdf"), "old").unwrap();
        study.gravel(&again).succeeded();
        assert!(read("subdomains-pair.png") == png && read("subdomains-pair.pdf") == pdf, "{again:?}");
    }
    fs::remove_file(out.join("subdomains-pair.png")).unwrap();
    study.gravel(&["bench", "drawn"]).succeeded();
    assert!(!out.join("subdomains-pair.png").exists() && out.join("subdomains-pair.pdf").exists());
}

#[test]
fn file_of_the_report_before_that_is_no_longer_made_is_named() {
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    let runs = study.bench("drawn");
    let against = study.gravel(&["report", "drawn", "--against", text(&runs)]).succeeded().stdout;
    assert!(against.contains("against.csv") && !against.contains("removed"), "{against}");
    let printed = study.gravel(&["bench", "drawn"]).succeeded().stdout;
    let removed = printed.lines().find(|line| line.starts_with("removed")).unwrap();
    assert!(removed.contains("does not write them: against") && removed.contains("against.csv"), "{removed}");
    assert!(!study.gravel(&["bench", "drawn"]).succeeded().stdout.contains("removed"));
}

#[test]
fn latex_takes_a_table_and_a_figure() {
    let Ok(version) = Command::new("pdflatex").arg("--version").output() else {
        eprintln!("skipped: pdflatex is not installed");
        return;
    };
    assert!(version.status.success());
    let packages = Command::new("kpsewhich").args(["siunitx.sty", "booktabs.sty", "longtable.sty"]).output();
    if !packages.is_ok_and(|found| found.status.success()) {
        eprintln!("skipped: siunitx, booktabs or longtable is not installed");
        return;
    }
    let study = Study::new();
    write(study.folder(), "harness/plans/drawn.toml", PLAN);
    study.bench("drawn");
    study.gravel(&["report", "drawn", "--pdf"]).succeeded();
    let out = study.folder().path().join("reports/out/drawn");
    let paper = "\\documentclass{article}\\usepackage{booktabs,longtable,siunitx,graphicx}\\begin{document}\n\
                 \\input{iterations}\\input{subdomains}\\includegraphics{subdomains-pair}\n\\end{document}\n";
    fs::write(out.join("paper.tex"), paper).unwrap();
    let ran =
        Command::new("pdflatex").args(["-halt-on-error", "paper.tex"]).current_dir(&out).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stdout));
    assert!(out.join("paper.pdf").is_file());
}

#[test]
fn table_is_written_in_part_and_in_the_format_of_its_file() {
    let study = Study::new();
    write(
        study.folder(),
        "harness/plans/drawn.toml",
        &PLAN.replace("[[methods]]", "[[methods]]\nmethod = \"cg\"\n[[methods]]"),
    );
    study.bench("drawn");
    let table = |more: &[&str]| study.gravel(&[&["table", "iterations", "drawn"], more].concat());
    let whole = table(&[]).succeeded().stdout;
    assert!(
        whole.contains("| cg ") && whole.contains("| nsgs ") && whole.contains("error at the end"),
        "{whole}"
    );
    let part = table(&["--rows", "method=ns*", "--columns", "method,iterations"]).succeeded().stdout;
    let lines: Vec<&str> = part.lines().collect();
    assert_eq!((lines.len(), lines[0]), (3, "| method | iterations |"), "{part}");
    assert!(lines[2].starts_with("| nsgs "), "{part}");
    let file = |name: &str| study.folder().path().join(name);
    for (name, first) in
        [("t.tex", "% \\usepackage{booktabs"), ("t.csv", "method,iterations\n"), ("t.md", "| method")]
    {
        table(&["--columns", "method,iterations", "-o", text(&file(name))]).succeeded();
        assert!(fs::read_to_string(file(name)).unwrap().starts_with(first), "{name}");
    }
    table(&["--columns", "itertions"])
        .refused(&["no column of table `iterations` `itertions`", "iterations"]);
    table(&["-o", text(&file("t.xls"))]).refused(&["t.xls", ".tex, .csv or .md"]);
    table(&["--rows", "method=nsgx*"])
        .refused(&["no row of table `iterations` that matches `method=nsgx*`", "nsgs"]);
    table(&["--rows", "method=nsgs", "--rows", "iterations=0?x"]).refused(&["matches `iterations=0?x`"]);
    study.gravel(&["table", "sizes", "drawn"]).refused(&["no table of this study `sizes`", "iterations"]);
}
