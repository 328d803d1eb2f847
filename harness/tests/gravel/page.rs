//! The pages in a real browser, Chromium without a window; skipped where there is none. A script joined to a copy of the
//! page uses it as a reader would, and leaves what it found in the document.

use crate::bench::Study;
use crate::common::{gravel, text, write};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

const PLAN: &str = r#"
name = "seen"
why = "A test of <the page>."
problems = ["pair"]
charts = ["convergence", "sample", "subdomains"]

[stop]
on = "natural_map"
tolerance = 1e-3
max_iterations = 100

[view]
problem = "pair"
runs = ["nsgs", "nsgs-dd 1x2"]

[[methods]]
method = "nsgs"

[[methods]]
method = "nsgs-dd"
axes = { subdomains = ["1x1", "1x2", "3x3"] }
"#;

/// Refuses what is not in the file, and says so; keeps errors.
const WATCH: &str = r#"<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"><script>
const seen = { errors: [], requests: [] };
addEventListener("error", event => seen.errors.push(String(event.message)));
addEventListener("unhandledrejection", event => seen.errors.push(String(event.reason)));
addEventListener("securitypolicyviolation", event => seen.requests.push(event.blockedURI));
console.error = console.warn = (...words) => seen.errors.push(words.join(" "));
</script>"#;

/// Sizes, and the contrast of every text with what is behind it.
const LOOK: &str = r#"<script>
const rgb = color => (color.match(/[\d.]+/g) ?? [0, 0, 0, 0]).map(Number);
const light = color => rgb(color).slice(0, 3).map(c => c / 255)
  .map(c => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4).reduce((sum, c, i) => sum + c * [.2126, .7152, .0722][i], 0);
const behind = node => {
  for (; node; node = node.parentElement) {
    const color = getComputedStyle(node).backgroundColor, [, , , alpha] = rgb(color);
    if (alpha === undefined || alpha > .99) return color;
  }
  return "rgb(255, 255, 255)";
};
const contrast = node => {
  const [a, b] = [light(getComputedStyle(node).color), light(behind(node))];
  return (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
};
const texts = [...document.querySelectorAll("h1, h2, p, li, a, th button, td, code, label, figcaption, output, input, select")]
  .filter(node => node.getClientRects().length && !node.closest("svg"));
seen.contrast = Math.min(...texts.map(contrast));
seen.ground = light(getComputedStyle(document.body).backgroundColor);
seen.figures = [...document.querySelectorAll("figure svg, canvas")].map(node => {
  const box = node.getBoundingClientRect();
  return [Math.round(box.width), Math.round(box.height)];
});
seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
</script>"#;

/// Sorting, filter, slider, enlargement.
const USE: &str = r#"<script>
const column = (box, i) => [...box.querySelectorAll("tbody tr:not([hidden])")].map(row => row.cells[i].textContent.trim());
const box = document.querySelector("[data-table=iterations]");
if (box) {
  const heads = [...box.querySelectorAll("th")], i = heads.findIndex(head => head.textContent === "iterations");
  heads[i].firstChild.click();
  seen.up = column(box, i);
  heads[i].firstChild.click();
  seen.down = column(box, i);
  const filter = box.querySelector("input");
  filter.value = "nsgs-dd 1x2"; filter.dispatchEvent(new Event("input"));
  seen.left = column(box, i).length;
  document.querySelector(".enlarge").click();
  seen.enlarged = document.querySelector("dialog[open] svg").getBoundingClientRect().width;
  document.querySelector("dialog .close").click();
  seen.closed = !document.querySelector("dialog[open]");
}
const slider = document.querySelector("input[type=range]"), canvas = document.querySelector("canvas");
const picture = value => {
  slider.value = value; slider.dispatchEvent(new Event("input"));
  return [canvas.toDataURL(), canvas.nextElementSibling.textContent];
};
const [begin, end] = [picture(0), picture(slider.max)];
seen.moved = begin[0] !== end[0] && begin[1] !== end[1];
seen.same = picture(0)[0] === begin[0];
</script>"#;

/// Leaves in the document what was seen.
const END: &str = r#"<script>
document.body.insertAdjacentHTML("beforeend", "<pre id=seen></pre>");
document.getElementById("seen").textContent = JSON.stringify(seen);
</script>"#;

pub(crate) fn browser() -> Option<&'static str> {
    let known = ["chromium", "chromium-browser", "google-chrome"];
    let runs = |name: &&str| {
        Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
    };
    let found = known.into_iter().find(runs);
    if found.is_none() {
        eprintln!("skipped: none of {} is installed", known.join(", "));
    }
    found
}

/// What the scripts found on a page in a window of this width.
fn used(browser: &str, page: &Path, width: u32, dark: bool) -> Value {
    seen(browser, (page, ""), width, dark, USE)
}

/// Findings of a script on a page, opened at a place in it.
pub(crate) fn seen(
    browser: &str,
    (page, place): (&Path, &str),
    width: u32,
    dark: bool,
    script: &str,
) -> Value {
    let folder = TempDir::new().unwrap();
    let html = fs::read_to_string(page).unwrap();
    let (head, body) = html.split_once("<meta charset=\"utf-8\">").unwrap();
    let scripts = format!("{LOOK}{script}{END}</html>");
    let copy = format!("{head}<meta charset=\"utf-8\">{WATCH}{}", body.replace("</html>", &scripts));
    let copy = write(&folder, "page.html", &copy);
    let profile = format!("--user-data-dir={}", folder.path().join("profile").display());
    let window = format!("--window-size={width},900");
    let scheme = format!("--blink-settings=preferredColorScheme={}", u8::from(!dark));
    let flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                 --disable-component-update --disable-sync --virtual-time-budget=5000 --dump-dom";
    let output = Command::new(browser)
        .args(flags.split_whitespace())
        .args([&profile, &window, &scheme, &format!("file://{}{place}", copy.display())])
        .output()
        .unwrap();
    let dom = String::from_utf8(output.stdout).unwrap();
    let found = dom
        .split_once("<pre id=\"seen\">")
        .unwrap_or_else(|| panic!("a script of the page ends early: {dom}"))
        .1;
    let found = found.split_once("</pre>").unwrap().0;
    serde_json::from_str(&found.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")).unwrap()
}

fn numbers(list: &Value) -> Vec<u64> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().parse().unwrap()).collect()
}

fn assert_sound(found: &Value, dark: bool) {
    assert_eq!(found["errors"], Value::Array(Vec::new()));
    assert_eq!(found["requests"], Value::Array(Vec::new()), "nothing comes from a network");
    let sizes = found["figures"].as_array().unwrap();
    assert!(
        !sizes.is_empty()
            && sizes.iter().flat_map(|size| size.as_array().unwrap()).all(|side| side.as_u64() > Some(40))
    );
    assert_eq!(found["wide"], 0, "the page itself does not scroll sideways");
    // What the guidelines for accessible pages ask of small text.
    assert!(found["contrast"].as_f64() >= Some(4.5), "{}", found["contrast"]);
    assert_eq!(found["ground"].as_f64() < Some(0.1), dark);
    assert_eq!(
        (&found["moved"], &found["same"]),
        (&Value::Bool(true), &Value::Bool(true)),
        "the slider moves the sample"
    );
}

#[test]
fn page_of_a_study_works_in_a_browser_light_dark_and_narrow() {
    let Some(browser) = browser() else { return };
    let study = Study::new();
    write(study.folder(), "harness/plans/seen.toml", PLAN);
    study.bench("seen");
    let page: PathBuf = study.folder().path().join("reports/out/seen/index.html");
    for (width, dark) in [(1200, false), (1200, true), (500, false)] {
        let found = used(browser, &page, width, dark);
        assert_sound(&found, dark);
        let (up, down) = (numbers(&found["up"]), numbers(&found["down"]));
        assert_eq!(up.len(), 4);
        assert!(up.is_sorted() && up[0] < up[3], "{up:?}");
        assert!(down.is_sorted_by(|a, b| a >= b), "{down:?}");
        assert_eq!((&found["left"], &found["closed"]), (&Value::from(1), &Value::Bool(true)));
        assert!(found["enlarged"].as_f64() > Some(300.0));
    }
}

#[test]
fn viewer_of_a_problem_works_in_a_browser() {
    let Some(browser) = browser() else { return };
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("column.html");
    gravel(&["view", "column", "--run", "nsgs", "--run", "cg", "-o", text(&page)]).succeeded();
    assert_sound(&used(browser, &page, 1000, false), false);
}

#[test]
fn viewer_refuses_what_it_cannot_show_before_it_runs() {
    gravel(&["view", "column", "--run", "nsgss"]).refused(&["--run 'nsgss'", "nsgs"]);
    gravel(&["view", "column", "--run", "nsgs order"]).refused(&["--run 'nsgs order'", "KEY=VALUE"]);
    gravel(&["view", "column", "-o", "/absent/page.html"]).refused(&["/absent"]);
    let study = Study::new();
    let unknown = PLAN.replace("nsgs-dd 1x2\"]", "nsgs-dd 1x3\"]");
    write(study.folder(), "harness/plans/seen.toml", &unknown);
    study.gravel(&["plan", "seen"]).refused(&["`view`", "nsgs-dd 1x3", "nsgs-dd 1x2"]);
}
