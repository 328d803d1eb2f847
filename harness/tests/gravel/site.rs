//! The site: the same bytes again, no dead link, and in a browser an answer to the question of its first page.

use crate::bench::Study;
use crate::common::{entries, text, write};
use crate::page::{browser, seen};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

/// A checkout with a study that ranks methods, the pair in its collection, and a page.
fn study() -> Study {
    let study = Study::new();
    let plan = "name = \"ranked\"\nwhy = \"A test of <the site>.\"\nproblems = [\"pair\"]\ncharts = [\"winners\", \"profiles\"]\nrepeats = 5\n\
                [stop]\non = \"natural_map\"\ntolerance = 1e-4\nmax_iterations = 500\n\
                [[methods]]\nmethod = \"nsgs\"\n[[methods]]\nmethod = \"cg\"\n[[methods]]\nmethod = \"gradient\"\n";
    write(study.folder(), "harness/plans/ranked.toml", plan);
    study.bench("ranked");
    let pair = study.folder().path().join("cases/frozen/pair.json");
    study.gravel(&["collection", "add", text(&pair)]).succeeded();
    fs::create_dir_all(study.folder().path().join("reports")).unwrap();
    let page = "# A page\n\nOne <b>bold</b> text, [itself](mine.md#a-part) and [code](../src/x.rs).\n\n## A part\n\n| a | b |\n|---|---|\n| 1 | 2 |\n";
    write(study.folder(), "reports/mine.md", page);
    study
}

fn made(study: &Study, name: &str) -> PathBuf {
    let site = study.folder().path().join(name);
    study
        .gravel(&["site", "-o", text(&site), "--archive", text(&study.folder().path().join("results/runs"))])
        .succeeded();
    site
}

/// All files below a folder, with what they hold.
fn all(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for name in entries(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            files.extend(all(&path).into_iter().map(|(inner, held)| (format!("{name}/{inner}"), held)));
        } else {
            files.push((name, fs::read(path).unwrap()));
        }
    }
    files
}

#[test]
fn site_has_the_same_bytes_again_and_no_dead_link() {
    let study = study();
    let (site, again) = (made(&study, "site"), made(&study, "again"));
    let files = all(&site);
    assert!(files == all(&again), "two sites of one tree differ");
    let mut links = 0;
    for (name, held) in
        files.iter().filter(|(name, _)| Path::new(name).extension().is_some_and(|ending| ending == "html"))
    {
        let page = String::from_utf8(held.clone()).unwrap();
        // Scripts make addresses as they run.
        let parts =
            page.split("<script").map(|part| part.split_once("</script>").map_or(part, |(_, after)| after));
        for link in
            parts.flat_map(|part| part.split(" href=\"").skip(1)).map(|rest| rest.split('"').next().unwrap())
        {
            if link.starts_with("data:") {
                continue;
            }
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let file =
                if file.is_empty() { site.join(name) } else { site.join(name).parent().unwrap().join(file) };
            assert!(file.is_file(), "{name} leads to {link}");
            let is_there = place.is_empty()
                || place.contains('=')
                || fs::read_to_string(&file).unwrap().contains(&format!("id=\"{place}\""));
            assert!(is_there, "{name} leads to {link}");
            links += 1;
        }
    }
    assert!(links > 50, "{links}");
    let page = fs::read_to_string(site.join("page-mine.html")).unwrap();
    assert!(page.contains("<h2 id=\"a-part\">A part</h2>") && page.contains("<td>1</td>"), "{page}");
    assert!(page.contains("and code.") && page.contains("href=\"page-mine.html#a-part\""), "{page}");
    let problem = files.iter().find(|(name, _)| name.starts_with("problem-")).unwrap();
    let problem = String::from_utf8(problem.1.clone()).unwrap();
    assert!(
        problem.contains("Status: certified") && problem.contains("impulses of a certified"),
        "{problem}"
    );
    // Its three runs, which the archive has.
    assert_eq!(problem.matches("<td><a href=\"problem-").count(), 3);
}

#[test]
fn site_keeps_what_is_of_others_and_names_what_is_wrong() {
    let study = study();
    let site = study.folder().path().join("site");
    fs::create_dir(&site).unwrap();
    let archive = text(&study.folder().path().join("results/runs")).to_owned();
    let mine = site.join("index.html");
    fs::write(&mine, "mine").unwrap();
    study
        .gravel(&["site", "-o", text(&site), "--archive", &archive])
        .refused(&["index.html", "no report made this file"]);
    assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
    study.gravel(&["site", "-o", text(&mine), "--archive", &archive]).refused(&["--output", "it is a file"]);
    let empty = text(&study.folder().path().join("harness")).to_owned() + "/absent";
    study.gravel(&["site", "-o", "new", "--archive", &empty]).refused(&["absent"]);
}

/// The answer for 5,000 grains, and the way to its rows.
const ASK: &str = r##"<script>
seen.answer = document.querySelector("#answer").textContent;
seen.rows = document.querySelector("#answer a").getAttribute("href");
const grains = document.querySelector("[name=grains]");
grains.value = 2; grains.dispatchEvent(new Event("input", { bubbles: true }));
seen.there = document.querySelector("#answer").textContent;
</script>"##;

/// The rows that are left, by the address and by a choice.
const CHOOSE: &str = r#"<script>
const box = document.querySelector("[data-table=runs]");
const left = () => box.querySelectorAll("tbody tr:not([hidden])").length;
seen.asked = left();
const pick = box.querySelector("[name=method]");
seen.methods = [...pick.options].map(option => option.value);
pick.value = "cg"; pick.dispatchEvent(new Event("input"));
seen.chosen = left();
</script>"#;

#[test]
fn first_page_answers_in_a_browser_and_leads_to_the_rows() {
    let Some(browser) = browser() else { return };
    let study = study();
    let site = made(&study, "site");
    for (width, dark) in [(1200, false), (500, true)] {
        let found = seen(browser, (&site.join("index.html"), ""), width, dark, ASK);
        assert_eq!((&found["errors"], &found["requests"]), (&json!([]), &json!([])));
        assert_eq!(found["wide"], 0, "the page itself does not scroll sideways");
        assert!(found["contrast"].as_f64() >= Some(4.5), "{}", found["contrast"]);
        let (answer, there) = (found["answer"].as_str().unwrap(), found["there"].as_str().unwrap());
        assert!(
            answer.contains("No such problem of 5000 grains was run; the nearest size is 2 grains."),
            "{answer}"
        );
        assert!(
            answer.contains("One packing is an example") && there.contains("Problems of 2 grains were run."),
            "{there}"
        );
        let rows = found["rows"].as_str().unwrap();
        let (page, place) = rows.split_once('#').unwrap();
        let found = seen(browser, (&site.join(page), &format!("#{place}")), width, dark, CHOOSE);
        assert_eq!((&found["errors"], &found["wide"]), (&json!([]), &json!(0)));
        assert_eq!(found["methods"], json!(["", "cg", "gradient", "nsgs"]));
        let (asked, chosen) = (found["asked"].as_u64(), found["chosen"].as_u64());
        assert!(asked <= Some(3) && asked >= Some(1) && chosen <= Some(1), "{asked:?} {chosen:?}");
    }
}
