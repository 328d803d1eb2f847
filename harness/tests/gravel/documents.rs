//! The pages for people: what is generated in them is what the program prints now, and their examples work.

use crate::common::{checkout, command, gravel, text, write};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Writes the generated blocks anew: `UPDATE_DOCUMENTS=1 cargo test --package harness documents`.
const UPDATE: &str = "UPDATE_DOCUMENTS";

const PAGES: [&str; 9] = [
    "README.md",
    "cases/README.md",
    "cases/case-file.md",
    "cases/collection/README.md",
    "cases/problem-file.md",
    "harness/README.md",
    "reports/README.md",
    "results/README.md",
    "results/archive/README.md",
];

fn page(name: &str) -> String {
    fs::read_to_string(checkout().join(name)).unwrap()
}

/// The page with what each command in `<!-- gravel … -->` prints between it and `<!-- end -->`; and how many there are.
fn generated(page: &str) -> (String, usize) {
    let (mut made, mut blocks, mut lines) = (String::new(), 0, page.lines());
    while let Some(line) = lines.next() {
        made.extend([line, "\n"]);
        let inner = line.strip_prefix("<!-- gravel ").and_then(|rest| rest.strip_suffix(" -->"));
        if let Some(args) = inner {
            let args: Vec<&str> = args.split_whitespace().collect();
            made += &gravel(&args).succeeded().stdout;
            made += "<!-- end -->\n";
            assert!(lines.any(|line| line == "<!-- end -->"), "{line} has no end");
            blocks += 1;
        }
    }
    (made, blocks)
}

#[test]
fn generated_blocks_are_what_the_program_prints() {
    let mut all = 0;
    for name in PAGES {
        let (made, blocks) = generated(&page(name));
        all += blocks;
        if std::env::var_os(UPDATE).is_some() {
            fs::write(checkout().join(name), &made).unwrap();
        }
        assert!(made == page(name), "{name} is not as it is generated: `just documents` writes it");
    }
    assert!(all >= 4, "{all} generated blocks");
}

#[test]
fn readme_has_as_many_problems_as_the_page_that_it_names() {
    let after = |page: &str, words: &str| -> u32 {
        let (_, rest) = page.split_once(words).unwrap();
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    let on_page = after(&page("reports/which-method.md"), "The rows are of ");
    assert_eq!(
        after(&page("README.md"), "[Which method for which problem](reports/which-method.md) has "),
        on_page
    );
}

/// The first block of this language on a page.
fn block(page: &str, language: &str) -> String {
    let (_, rest) = page.split_once(&format!("```{language}\n")).unwrap();
    rest.split_once("```").unwrap().0.to_owned()
}

#[test]
fn ten_lines_of_python_write_a_problem_that_is_solved_anywhere() {
    let program = block(&page("cases/problem-file.md"), "python");
    assert!(program.lines().count() <= 10, "ten lines");
    let folder = TempDir::new().unwrap();
    let program = write(&folder, "write.py", &program);
    let Ok(ran) = Command::new("python3").arg(&program).current_dir(&folder).output() else {
        eprintln!("skipped: python3 is not installed");
        return;
    };
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    // Outside the checkout, which this needs nothing of.
    let solve = ["solve", "mine.json", "--json", "--truth", "--impulses", "r.json"];
    let ran = command(&solve).current_dir(&folder).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let answer: Value = serde_json::from_slice(&ran.stdout).unwrap();
    assert_eq!((&answer["status"], &answer["iterations"]), (&"converged".into(), &9.into()), "{answer}");
    let r: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("r.json")).unwrap()).unwrap();
    for (k, weight) in [(0, 5.0), (4, 1.0)] {
        // m g h of those above, to the tolerance.
        let expected = weight * 2.0 * 9.81 * 0.005;
        assert!((r["impulse"][k].as_f64().unwrap() / expected - 1.0).abs() < 1e-5, "{r}");
    }
    assert!(!folder.path().join("results").exists(), "nothing is kept outside a checkout");
}

#[test]
fn commands_of_the_appendix_print_what_it_expects() {
    let page = page("reports/artefacts.md");
    let (table, _) = page.split_once("These keep").unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.contains("| `gravel ")).collect();
    assert!(rows.len() >= 8, "{} rows", rows.len());
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let args: Vec<&str> = cells[2].split_whitespace().skip(1).collect();
        let output = command(&args).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(cells[3]), "{}: no {} in {said}", cells[2], cells[3]);
    }
}

#[test]
fn case_of_its_page_is_solved_anywhere() {
    let folder = TempDir::new().unwrap();
    write(&folder, "mine.toml", &block(&page("cases/case-file.md"), "toml"));
    for args in [&["solve", "mine.toml"][..], &["simulate", "mine.toml", "--time-steps", "3"]] {
        let ran = command(args).current_dir(&folder).output().unwrap();
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    }
}

#[test]
fn what_needs_no_checkout_works_outside_one_and_the_rest_says_so() {
    let folder = TempDir::new().unwrap();
    let outside = |args: &[&str]| command(args).current_dir(&folder).output().unwrap();
    for args in [
        &["list", "methods"][..],
        &["list", "charts"],
        &["schema", "problem"],
        &["schema", "plan"],
        &["schema", "case", "--markdown"],
    ] {
        assert!(outside(args).status.success(), "{args:?}");
    }
    let case: PathBuf = checkout().join("cases/column.toml");
    let view = outside(&["view", text(&case), "--run", "cg"]);
    assert!(view.status.success() && folder.path().join("view-column-t1.html").is_file());
    for args in [&["bench"][..], &["list", "cases"], &["report"], &["regress"], &["solve", "column"]] {
        let ran = outside(args);
        let error = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(1), "{args:?}");
        assert!(error.contains("give --root DIR"), "{args:?}: {error}");
    }
    let root =
        |args: &[&str]| command(args).current_dir(&folder).env("GRAVEL_ROOT", checkout()).output().unwrap();
    assert!(root(&["solve", "column", "--tolerance", "1e-2"]).status.success());
    assert!(root(&["list", "cases"]).status.success());
}

#[test]
fn schema_of_a_problem_accepts_what_is_read_and_says_what_each_key_means() {
    let schema: Value = serde_json::from_str(&gravel(&["schema", "problem"]).succeeded().stdout).unwrap();
    let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
    compiler.add_resource("problem.json", schema.clone()).unwrap();
    let compiled = compiler.compile("problem.json", &mut schemas).unwrap();
    let pair = crate::common::pair();
    schemas.validate(&pair, compiled).unwrap();
    let other = crate::common::pair_with("/format", "another".into());
    assert!(schemas.validate(&other, compiled).is_err());
    for table in ["/properties", "/properties/grains/properties", "/properties/contacts/properties"] {
        for (key, of) in schema.pointer(table).unwrap().as_object().unwrap() {
            assert!(of["description"].as_str().is_some_and(|what| what.len() > 15), "{table}/{key}");
        }
    }
}

#[test]
fn every_column_of_a_simulation_is_on_its_page() {
    let folder = TempDir::new().unwrap();
    let (rows, contacts) = (folder.path().join("rows.csv"), folder.path().join("contacts.csv"));
    let run = ["simulate", "column", "--time-steps", "1", "-o", text(&rows), "--contacts", text(&contacts)];
    gravel(&run).succeeded();
    let page = page("cases/simulation-file.md");
    for file in [rows, contacts] {
        let written = fs::read_to_string(&file).unwrap();
        let header = written.lines().next().unwrap();
        let missing: Vec<&str> =
            header.split(',').filter(|name| !page.contains(&format!("`{name}`"))).collect();
        assert!(missing.is_empty() && header.contains(','), "{}: {missing:?}", file.display());
    }
}

/// The Markdown files below a folder of the tree, but not those that a run writes.
fn markdown(folder: &Path) -> Vec<PathBuf> {
    let is_written = |path: &Path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with('.') || ["target", "runs", "out"].contains(&&*name)
    };
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.filter(|path| !is_written(path)).fold(Vec::new(), |mut all, path| {
        if path.is_dir() {
            all.extend(markdown(&path));
        } else if path.extension().is_some_and(|ending| ending == "md") {
            all.push(path);
        }
        all
    })
}

#[test]
fn links_lead_to_files() {
    let mut links = 0;
    for page in markdown(&checkout()) {
        let text = fs::read_to_string(&page).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ', '#']).next()) {
            if link.is_empty() || link.contains(':') {
                continue;
            }
            links += 1;
            assert!(page.parent().unwrap().join(link).exists(), "{}: {link} is not there", page.display());
        }
    }
    assert!(links > 100, "{links} links");
}
