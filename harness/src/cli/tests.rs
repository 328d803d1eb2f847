//! Defaults: what `gravel view` shows, and what help says of the stop rule.

use crate::cli::args::StopArgs;
use crate::cli::view::{runs_of, variant};
use crate::plan::Plan;
use clap::{Args, Command};
use runner::Stop;
use std::path::Path;

#[test]
fn what_is_shown_without_a_wish_is_what_the_page_of_the_paper_shows() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/plans/paper.toml"));
    let plan = Plan::read(path, false).unwrap();
    let view = plan.view.as_ref().unwrap();
    let variants = plan.variants(&[]).unwrap();
    let shown = variants.iter().filter(|variant| view.runs.contains(&variant.label()));
    let of_page: Vec<_> = shown.map(|v| (v.method.name, v.method.settings.clone())).collect();
    let own = runs_of(1000).map(|text| variant(&text).unwrap().method);
    assert_eq!(own.map(|method| (method.name, method.settings)).to_vec(), of_page);
}

#[test]
fn few_contacts_have_few_subdomains() {
    let grid = |contacts| runs_of(contacts)[1].rsplit_once('=').unwrap().1.to_owned();
    assert_eq!([8, 7, 3, 1, 0].map(grid), ["4x2", "2x2", "2x1", "1x1", "1x1"]);
}

#[test]
fn help_names_the_default_stop_rule() {
    let help = StopArgs::augment_args(Command::new("gravel")).render_long_help().to_string();
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    let Stop { on, tolerance, max_iterations } = Stop::default();
    for default in [on.to_string(), format!("{tolerance:e}"), max_iterations.to_string()] {
        assert!(help.contains(&format!("else {default}]")), "no default {default} in: {help}");
    }
}
