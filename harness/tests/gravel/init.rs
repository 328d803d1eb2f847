//! Studies outside the checkout: a folder that `gravel init` made.

use crate::bench::rows;
use crate::common::{Ran, command, entries, gravel, text};
use std::path::Path;
use tempfile::TempDir;

/// Runs `gravel` in a folder.
fn here(folder: &Path, args: &[&str]) -> Ran {
    Ran::of(command(args).current_dir(folder))
}

#[test]
fn folder_of_ones_own_has_a_case_a_plan_and_a_code_that_commands_use() {
    let place = TempDir::new().unwrap();
    let folder = place.path().join("studies");
    gravel(&["init", text(&folder)]).succeeded();
    let cases = here(&folder, &["list", "cases"]).succeeded().stdout;
    assert!(cases.contains("my-box") && !cases.contains("settled-box"), "{cases}");
    here(&folder.join("cases"), &["simulate", "my-box", "--time-steps", "2"]).succeeded();
    here(&folder, &["bench", "mine"]).succeeded();
    let runs = rows(folder.join("results/runs/mine/runs.csv"));
    assert_eq!(runs.len(), 10, "five variants on two problems");
    for run in &runs {
        assert!(
            run["status"] == "converged" || run["method"] == "mine" && run["status"] == "skipped",
            "{run:?}"
        );
    }
    assert!(folder.join("reports/out/mine/index.html").is_file());
    // Nothing of it is taken for a name of the checkout.
    gravel(&["bench", "mine"]).refused(&["no plan `mine`"]);
}

#[test]
fn folder_that_holds_something_is_left_as_it_is() {
    let place = TempDir::new().unwrap();
    std::fs::write(place.path().join("thesis.tex"), "").unwrap();
    gravel(&["init", text(place.path())]).refused(&["thesis.tex", "empty"]);
    assert_eq!(entries(place.path()), ["thesis.tex"]);
    gravel(&["init", text(&place.path().join("thesis.tex"))]).refused(&["thesis.tex"]);
}
