//! Arguments that make no sense: the error names the argument or setting and its value.

use crate::common::{checkout, gravel, pair, text, write};
use std::fs;
use tempfile::TempDir;

/// `gravel solve` on the pair with these arguments is refused.
#[track_caller]
fn refused(args: &[&str], words: &[&str]) {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "pair.json", &pair().to_string());
    gravel(&[&["solve", text(&file)], args].concat()).refused(words);
}

#[track_caller]
fn refused_setting(method: &str, setting: &str, words: &[&str]) {
    let key = format!("`{}`", setting.split_once('=').unwrap().0);
    refused(&["--method", method, "--set", setting], &[&[method, &key], words].concat());
}

#[test]
fn unknown_method_is_refused_with_the_known_ones() {
    refused(&["--method", "newton"], &["`newton`", "nsgs", "jacobi", "cg", "nsgs-dd"]);
    refused(&["--method", "latindd"], &["`latindd`", "did you mean `latin-dd`?"]);
    refused(&["--method", "NLGS"], &["`NLGS`", "did you mean `nsgs`?"]);
}

#[test]
fn unknown_setting_is_refused_with_the_known_ones() {
    refused_setting("nsgs", "relax=1", &["`order`", "did you mean `relaxation`?"]);
    refused_setting("cg", "relaxation=1", &["`preconditioner`"]);
    refused_setting("nsgs-dd", "sweeps=1", &["`inner_sweeps`"]);
    let most = "`4294967296`, expected a whole number from 0 to 4294967295";
    refused_setting("nsgs-dd", "inner_sweeps=4294967296", &[most]);
}

#[test]
fn setting_by_the_name_of_another_code_is_refused_with_its_own() {
    refused_setting(
        "nsgs",
        "omega=1.5",
        &["unknown field `omega`; did you mean `relaxation`? Expected one of"],
    );
    refused_setting("latin-dd", "kappa=1", &["did you mean `kappa_l"]);
    refused_setting("nsgs", "mu=0.3", &["in a case it is `scene.friction`"]);
}

#[test]
fn name_that_was_meant_is_named_before_the_list() {
    let printed = [
        "no problem or case `colum`, and no file of that path seen from the current folder; did you mean `column`? (there are ",
    ];
    gravel(&["solve", "colum"]).refused(&printed);
    refused(
        &["--method", "latindd"],
        &["unknown method `latindd`; did you mean `latin-dd`? (there are nsgs, "],
    );
}

#[test]
fn more_than_a_machine_has_is_refused_by_the_key_that_asks() {
    let solve = |case: &str, key: &str, words: &[&str]| {
        gravel(&["solve", case, "--scene", key])
            .refused(&[&[".toml: ", " GB of memory, and "], words].concat());
    };
    solve("column", "sample.grains=4294967295", &["column.toml", "`sample.grains` is 4294967295: "]);
    solve("deposited-box", "sample.grains=4294967295", &["`sample.grains` is 4294967295: "]);
    solve("rollers", "sample.rollers=4294967295", &["`sample.rollers` is 4294967295: "]);
    solve("column", "scene.contact_copies=4294967295", &["`scene.contact_copies` is 4294967295: "]);
    let simulate = ["simulate", "column", "--time-steps", "1", "--scene", "sample.grains=4294967295"];
    gravel(&simulate).refused(&["`sample.grains`", "memory"]);
    refused(&["--threads", "10000"], &["--threads", "'10000'", "it must be at most "]);
    gravel(&["bench", "--jobs", "10000"]).refused(&["--jobs", "'10000'", "it must be at most "]);
    gravel(&["bench", "--repeats", "4294967295"]).refused(&["--repeats 4294967295: it must be at most 1000"]);
    for method in ["nsgs-dd", "latin-dd"] {
        refused_setting(method, "subdomains=100000x100000", &["is 100000x100000:", "at most 2"]);
    }
}

#[test]
fn setting_of_another_type_is_refused_with_its_value() {
    refused_setting("nsgs", "relaxation=abc", &["\"abc\""]);
    refused_setting("nsgs", "relaxation=NaN", &["\"NaN\""]);
    refused_setting("nsgs", "order=diagonal", &["`diagonal`", "`natural`"]);
    refused_setting("nsgs", "symmetric=1", &["`1`", "boolean"]);
    refused_setting("nsgs-dd", "inner_sweeps=-1", &["`-1`"]);
    refused_setting("nsgs-dd", "inner_sweeps=1.5", &["`1.5`"]);
    refused_setting("nsgs-dd", "subdomains=4y2", &["\"4y2\"", "\"4x2\""]);
    refused_setting("nsgs-dd", "subdomains=-3", &["`-3`", "at least 1"]);
    refused_setting("nsgs-dd", "subdomains=99999999999", &["`99999999999`"]);
}

#[test]
fn text_that_is_no_setting_is_refused() {
    refused(&["--set", "relaxation"], &["--set", "'relaxation'", "KEY=VALUE"]);
    refused(&["--set", "=1"], &["--set", "'=1'", "KEY=VALUE"]);
    refused(
        &["--set", "preconditioner=none", "--set", "preconditioner=none"],
        &["--set preconditioner", "twice"],
    );
}

#[test]
fn relaxation_that_is_not_positive_is_refused() {
    for method in ["nsgs", "jacobi"] {
        refused_setting(method, "relaxation=0", &["pair.json", "is 0:", "positive"]);
        refused_setting(method, "relaxation=-1", &["pair.json", "is -1:", "positive"]);
    }
}

#[test]
fn no_subdomain_is_refused() {
    refused_setting("nsgs-dd", "subdomains=0", &["`0`", "at least 1"]);
    refused_setting("nsgs-dd", "subdomains=0x2", &["\"0x2\"", "at least 1"]);
}

#[test]
fn more_subdomains_than_contacts_are_refused() {
    refused_setting("nsgs-dd", "subdomains=3", &["pair.json", "is 3x1:", "at most 2"]);
    refused_setting("nsgs-dd", "subdomains=65536x65536", &["is 65536x65536:", "at most 2"]);
}

#[test]
fn no_inner_sweep_is_refused() {
    refused_setting("nsgs-dd", "inner_sweeps=0", &["pair.json", "is 0:", "at least 1"]);
}

#[test]
fn tolerance_that_is_not_a_positive_number_is_refused() {
    refused(&["--tolerance", "-1"], &["`tolerance` is -1:", "not negative"]);
    refused(&["--tolerance", "nan"], &["`tolerance` is NaN:", "finite"]);
    refused(&["--tolerance", "inf"], &["`tolerance` is inf:", "finite"]);
    refused(&["--tolerance", "tight"], &["--tolerance", "'tight'"]);
}

#[test]
fn unknown_measure_is_refused_with_the_known_ones() {
    refused(&["--on", "energy"], &["--on", "'energy'", "zeta, natural_map, penetration_rate"]);
}

#[test]
fn counts_that_are_not_counts_are_refused() {
    refused(&["--max-iterations", "-1"], &["--max-iterations", "'-1'"]);
    refused(&["--max-iterations", "1.5"], &["--max-iterations", "'1.5'"]);
    refused(&["--threads", "0"], &["--threads", "'0'"]);
    gravel(&["simulate", "column", "--time-steps", "-1"]).refused(&["--time-steps", "'-1'"]);
}

#[test]
fn typo_in_a_case_is_refused_at_its_line() {
    let folder = TempDir::new().unwrap();
    let case = fs::read_to_string(checkout().join("cases/column.toml")).unwrap();
    let line = 1 + case.lines().position(|line| line.starts_with("gravity_m_per_s2")).unwrap();
    let typo = write(&folder, "typo.toml", &case.replace("gravity_m_per_s2", "gravity"));
    let place = format!("line {line}, column 1");
    gravel(&["solve", text(&typo)]).refused(&["typo.toml", &place, "`gravity`", "`gravity_m_per_s2`"]);
}

#[test]
fn change_of_a_case_that_its_file_could_not_hold_is_refused() {
    let refused = |change, words: &[&str]| {
        gravel(&["solve", "column", "--scene", change]).refused(&[&["column.toml"], words].concat());
    };
    refused("sample.grain=3", &["sample.grain = 3", "`grain`", "`grains`"]);
    refused("scene.boxx.width_m=3", &["scene.boxx.width_m = 3", "`scene.boxx`", "`box`"]);
    refused("sample.grains=many", &["sample.grains = many", "\"many\", expected a whole number"]);
    refused("scene.law=hertz", &["`scene.law`", "`hertz`", "`iqs`"]);
    refused("scene.law.name=iqs", &["`scene.law.name`", "`law` is a value"]);
    refused("restitution=0.5", &["`restitution`; in a case it is `scene.restitution`"]);
    refused("mu=0.5", &["`mu`; in a case it is `scene.friction`"]);
    refused("sample.grains=0", &["`sample` has no grain"]);
    refused("scene.time_step_s=0", &["`scene.time_step_s` is 0:", "positive"]);
    refused("scene.theta=2", &["`scene.theta` is 2:", "between 0 and 1"]);
    refused("solve_at=0", &["`solve_at` is 0:", "from 1"]);
}

#[test]
fn change_of_the_scene_of_a_frozen_problem_is_refused() {
    refused(&["--scene", "sample.grains=3"], &["--scene sample.grains", "pair.json", "no scene"]);
    refused(&["--time-step", "3"], &["--time-step", "pair.json", "no other time step"]);
}

#[test]
fn time_step_that_the_case_does_not_have_is_refused() {
    let refused = |case, time_step, words: &[&str]| {
        gravel(&["solve", case, "--time-step", time_step]).refused(words);
    };
    refused("column", "0", &["--time-step 0", "from 1"]);
    refused("column", "-1", &["--time-step -1", "from 1"]);
    refused("column", "onset", &["--time-step onset", "a number from 1"]);
    refused("shear-box-991", "onst", &["--time-step onst", "onset"]);
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("column.json");
    gravel(&["freeze", "column", "--time-step", "0", "-o", text(&file)]).refused(&["--time-step 0"]);
    assert!(!file.exists());
}

#[test]
fn place_where_no_file_can_be_is_refused_before_the_work() {
    let folder = TempDir::new().unwrap();
    let nowhere = folder.path().join("absent/file");
    // 10¹² time steps would not end within any test.
    let long = ["--time-steps", "1000000000000"];
    for (file, words) in
        [(nowhere.as_path(), ["absent/file", "no folder"]), (folder.path(), ["", "is a folder"])]
    {
        refused(&["--impulses", text(file)], &words);
        let freeze = ["freeze", "column", "--time-step", long[1], "--force", "-o", text(file)];
        gravel(&freeze).refused(&words);
    }
    gravel(&[&["simulate", "column", "-o", text(&nowhere)], &long[..]].concat()).refused(&["no folder"]);
}

#[test]
fn folder_that_is_no_checkout_is_refused() {
    let folder = TempDir::new().unwrap();
    gravel(&["--root", text(folder.path()), "list", "cases"]).refused(&["--root", "cases/frozen"]);
    let absent = folder.path().join("absent");
    gravel(&["--root", text(&absent), "list", "cases"]).refused(&["--root", "absent"]);
}

#[test]
fn name_of_another_kind_is_told_what_it_is() {
    let certified = gravel(&["certify", "settled-box"]);
    certified.refused(&[
        "`settled-box` is a case, not a frozen problem: `gravel freeze settled-box --time-step K",
    ]);
    gravel(&["bench", "hopper"]).refused(&["`hopper` is a case, not a plan"]);
    gravel(&["simulate", "paper", "--time-steps", "1"]).refused(&["`paper` is a plan, not a case"]);
}

#[test]
fn unknown_chart_is_refused_with_the_one_that_was_meant() {
    gravel(&["figure", "convergance"]).refused(&["no chart `convergance`; did you mean `convergence`?"]);
}
