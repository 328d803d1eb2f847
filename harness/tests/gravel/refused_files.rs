//! Frozen problems that make no sense: the error names the file, the key, the index and the value.

use crate::common::{gravel, pair, pair_with, text, write};
use serde_json::{Value, json};
use tempfile::TempDir;

/// `gravel solve` on a file with this content is refused, with the file and all of `words`.
#[track_caller]
fn refused(content: &str, words: &[&str]) {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "bad.json", content);
    gravel(&["solve", text(&file)]).refused(&[&["bad.json"], words].concat());
}

/// The pair with one value changed is refused.
#[track_caller]
fn refused_with(pointer: &str, value: Value, words: &[&str]) {
    refused(&pair_with(pointer, value).to_string(), words);
}

#[test]
fn unchanged_pair_is_accepted() {
    let folder = TempDir::new().unwrap();
    gravel(&["solve", text(&write(&folder, "pair.json", &pair().to_string()))]).succeeded();
}

#[test]
fn nan_and_infinity_are_refused_at_their_place() {
    let text = pair_with("/grains/mass", json!([1.0, 12345.0])).to_string();
    let with = |token: &str| text.replace("12345.0", token);
    refused(&with("NaN"), &["`grains.mass[1]`", "line 1 column"]);
    refused(&with("Infinity"), &["`grains.mass[1]`", "line 1 column"]);
    refused(&with("1e999"), &["`grains.mass[1]`", "number out of range", "line 1 column"]);
}

#[test]
fn null_in_a_list_of_numbers_is_refused() {
    refused_with("/grains/mass", json!([1.0, null]), &["`grains.mass[1]`", "null"]);
    refused_with("/contacts/gap", json!([null, 0.0]), &["`contacts.gap[0]`", "null"]);
    refused_with("/contacts/candidate", json!([0, null]), &["`contacts.candidate[1]`", "null"]);
}

#[test]
fn mass_and_radius_that_are_not_positive_are_refused() {
    refused_with("/grains/mass", json!([1.0, -2.0]), &["`grains.mass[1]` is -2", "positive"]);
    refused_with("/grains/mass", json!([0.0, 2.0]), &["`grains.mass[0]` is 0", "positive"]);
    refused_with("/grains/radius", json!([0.5, -0.5]), &["`grains.radius[1]` is -0.5", "positive"]);
}

#[test]
fn time_step_that_is_not_positive_is_refused() {
    refused_with("/time_step", json!(0.0), &["`time_step` is 0", "positive"]);
    refused_with("/time_step", json!(-0.005), &["`time_step` is -0.005", "positive"]);
}

#[test]
fn negative_impulse_of_the_time_step_before_is_refused() {
    refused_with("/contacts/start", json!([0.0, -1.0]), &["`contacts.start[1]` is -1", "not negative"]);
}

#[test]
fn index_beyond_the_grains_is_refused() {
    refused_with("/contacts/candidate", json!([0, 2]), &["`contacts.candidate[1]` is 2", "2 grains"]);
    refused_with("/contacts/antagonist", json!([null, 7]), &["`contacts.antagonist[1]` is 7", "2 grains"]);
    refused_with("/contacts/candidate", json!([-1, 1]), &["`contacts.candidate[0]`", "-1"]);
    refused_with("/contacts/antagonist", json!([null, 0.5]), &["`contacts.antagonist[1]`", "0.5"]);
}

#[test]
fn contact_of_a_grain_with_itself_is_refused() {
    refused_with("/contacts/antagonist", json!([null, 1]), &["`contacts.antagonist[1]` is 1", "candidate"]);
}

#[test]
fn normal_that_is_not_a_unit_vector_of_the_plane_is_refused() {
    let refused_with = |normal: Value, words| {
        refused_with("/contacts/normal", json!([[0.0, 1.0], normal]), words);
    };
    refused_with(json!([0.0, 2.0]), &["`contacts.normal[1]` is [0, 2] of length 2", "length 1"]);
    refused_with(json!([0.0, 0.0]), &["`contacts.normal[1]` is [0, 0] of length 0", "length 1"]);
    // 1e-9 is allowed, since files keep 16 digits.
    refused_with(json!([0.0, 1.000_000_002]), &["`contacts.normal[1]` is [0, 1.000000002]", "length 1"]);
    refused_with(json!([1.0]), &["`contacts.normal[1]`", "length 1"]);
    let words =
        ["`contacts.normal[1]` is [0, -1]", "from the antagonist, grain 0, to the candidate, grain 1"];
    refused_with(json!([0.0, -1.0]), &words);
    refused_with(json!([0.0, 1.0, 0.0]), &["`contacts.normal[1]`"]);
}

#[test]
fn unknown_key_is_refused_with_the_known_ones() {
    refused_with("/friction", json!(0.3), &["`friction`", "`time_step`"]);
    refused_with("/grains/inertia", json!([1.0, 1.0]), &["`grains.inertia`", "`free_velocity`"]);
    refused_with("/contacts/friction", json!([0.3, 0.3]), &["`contacts.friction`", "`antagonist`"]);
}

#[test]
fn missing_and_repeated_keys_are_refused() {
    let mut without = pair();
    without["contacts"].as_object_mut().unwrap().remove("gap");
    refused(&without.to_string(), &["missing key `contacts.gap`"]);
    let twice = pair().to_string().replacen('{', "{\"name\":\"one more\",", 1);
    refused(&twice, &["duplicate", "`name`"]);
}

#[test]
fn all_keys_that_a_file_lacks_are_named_at_once() {
    let mut without = pair();
    for key in ["name", "time_step"] {
        without.as_object_mut().unwrap().remove(key);
    }
    without["contacts"].as_object_mut().unwrap().remove("gap");
    refused(&without.to_string(), &["missing keys: `name`, `time_step`, `contacts.gap`"]);
    without["dt"] = json!(0.005);
    refused(&without.to_string(), &["`dt`", "did you mean `time_step`", "missing keys: `name`, `time_step`"]);
    let records = json!({ "format": "f", "grains": [{ "mass": 1.0 }], "contacts": [] });
    let tables =
        ["`grains` holds a list", "`contacts` holds a list", "missing keys: `name`, `source`, `time_step`"];
    refused(&records.to_string(), &tables);
    refused("{}", &["missing keys: `format`, `name`, `source`, `time_step`, `grains`, `contacts`"]);
    let folder = TempDir::new().unwrap();
    let case =
        write(&folder, "bad.toml", "name = \"bad\"\n[sample]\nkind = \"column\"\ngrains = 3\n[scene.box]\n");
    let keys =
        "missing keys: `why`, `source`, `known`, `solve_at`, `sample.radius_m`, `sample.density_kg_per_m2`, ";
    let scene = "`scene.law`, `scene.time_step_s`, `scene.gravity_m_per_s2`";
    gravel(&["solve", text(&case)]).refused(&["bad.toml: ", keys, scene]);
    let of_kind =
        ["column.toml: with sample.kind = triangular: ", "missing keys: `sample.columns`, `sample.rows`"];
    gravel(&["solve", "column", "--scene", "sample.kind=triangular"]).refused(&of_kind[..1]);
    let case = write(&folder, "bad.toml", "sample = {}\n");
    gravel(&["solve", text(&case)]).refused(&["`sample.kind`", "`scene`"]);
    let plan = write(&folder, "plan.toml", "name = \"p\"\n[simulate]\n[[methods]]\n[[cases]]\n");
    let keys = "missing keys: `why`, `stop`, `methods[0].method`";
    gravel(&["bench", text(&plan)]).refused(&["plan.toml: ", "`cases[0].case`", "`simulate.sample_every_s`"]);
    gravel(&["bench", text(&plan)]).refused(&["`methods[0].method`", &keys[..20]]);
}

#[test]
fn list_in_place_of_keys_is_refused_in_the_words_of_the_file() {
    let words = ["bad.json: the file holds a list: it must hold the keys `format`"];
    refused("[]", &words);
    refused("[1, 2]", &words);
    let records = json!([{ "mass": 1.0, "radius": 0.5 }]);
    refused_with("/grains", records, &["`grains` holds a list: it must hold the keys `mass`, `radius`"]);
    refused_with(
        "/grains/mass",
        json!([[]]),
        &["`grains.mass[0]`: invalid type: sequence, expected a number"],
    );
    let folder = TempDir::new().unwrap();
    let problem = write(&folder, "pair.json", &pair().to_string());
    let impulses = write(&folder, "r.json", "[]");
    let certify = ["certify", text(&problem), "--impulses", text(&impulses)];
    gravel(&certify).refused(&["r.json: the file holds a list: it must hold the keys `impulse`"]);
}

#[test]
fn name_that_leads_elsewhere_is_refused() {
    for name in ["../pair", "a/b", "", ".pair", "c:pair", "a\nb"] {
        refused_with("/name", json!(name), &["`name` is \"", "files are named after it"]);
    }
    let folder = TempDir::new().unwrap();
    let case = std::fs::read_to_string(crate::common::checkout().join("cases/column.toml")).unwrap();
    let case = case.replacen("name = \"column\"", "name = \"../../column\"", 1);
    let case = write(&folder, "column.toml", &case);
    let vtk = folder.path().join("inner/vtk");
    let simulate = ["simulate", text(&case), "--time-steps", "1", "--vtk", text(&vtk)];
    gravel(&simulate).refused(&["column.toml: `name` is \"../../column\"", "files are named after it"]);
    assert_eq!(crate::common::entries(folder.path()), ["column.toml"]);
    let odd = folder.path().join("a:b.json");
    gravel(&["freeze", "column", "--time-step", "1", "-o", text(&odd)])
        .refused(&["a:b.json", "`name` is \"a:b\""]);
}

#[test]
fn numbers_are_printed_in_few_characters() {
    refused_with("/contacts/start", json!([0.0, -1e200]), &["`contacts.start[1]` is -1e200:"]);
    refused_with("/time_step", json!(-1e-200), &["`time_step` is -1e-200:"]);
    refused_with(
        "/contacts/normal",
        json!([[0.0, 1.0], [0.0, 1e200]]),
        &["`contacts.normal[1]` is [0, 1e200] of"],
    );
    let solve = |args: &[&str]| gravel(&[&["solve", "column"], args].concat());
    solve(&["--scene", "scene.theta=1e200"]).refused(&["`scene.theta` is 1e200:"]);
    solve(&["--method", "nsgs", "--set", "relaxation=-1e200"]).refused(&["`relaxation` is -1e200:"]);
    solve(&["--tolerance", "-1e200"]).refused(&["`tolerance` is -1e200:"]);
}

#[test]
fn mass_whose_inverse_overflows_is_refused_for_that() {
    let words = ["`grains.mass[0]` is 5e-324: it must be at least 5.6e-309, or its inverse overflows"];
    refused_with("/grains/mass", json!([5e-324, 1.0]), &words);
    let folder = TempDir::new().unwrap();
    let light = pair_with("/grains/mass", json!([5.6e-309, 1.0]));
    let file = write(&folder, "light.json", &light.to_string());
    gravel(&["solve", text(&file), "--max-iterations", "1"]).ended(3);
}

#[cfg(unix)]
#[test]
fn link_that_leads_to_itself_is_named() {
    let folder = TempDir::new().unwrap();
    let link = folder.path().join("loop.json");
    std::os::unix::fs::symlink(&link, &link).unwrap();
    gravel(&["solve", text(&link)]).refused(&["loop.json: it cannot be read: ", "links"]);
    std::fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(folder.path().join("absent.json"), &link).unwrap();
    gravel(&["solve", text(&link)]).refused(&["loop.json: it cannot be read: ", "No such file"]);
}

#[test]
fn lists_of_unequal_length_are_refused() {
    for key in ["radius", "position", "free_velocity"] {
        let mut one = pair()["grains"][key].clone();
        one.as_array_mut().unwrap().pop();
        let name = format!("`grains.{key}` has 1 values where 2 are expected");
        refused_with(&format!("/grains/{key}"), one, &[&name]);
    }
    for key in ["antagonist", "normal", "offset", "gap"] {
        let mut one = pair()["contacts"][key].clone();
        one.as_array_mut().unwrap().pop();
        let name = format!("`contacts.{key}` has 1 values where 2 are expected");
        refused_with(&format!("/contacts/{key}"), one, &[&name]);
    }
    let words = ["`contacts.start` has 3 values where 2 are expected"];
    refused_with("/contacts/start", json!([0.0, 0.0, 0.0]), &words);
}

#[test]
fn value_of_another_type_is_refused() {
    refused_with("/time_step", json!("0.005"), &["`time_step`", "\"0.005\""]);
    refused_with("/grains/mass", json!([1.0, "2 kg"]), &["`grains.mass[1]`", "\"2 kg\""]);
    refused_with("/contacts/candidate", json!({}), &["`contacts.candidate`", "map"]);
}

#[test]
fn another_format_is_refused() {
    let words = ["`format` is \"gravel/contact-problem/3\"", "\"gravel/contact-problem/1\""];
    refused_with("/format", json!("gravel/contact-problem/3"), &words);
    // A file with friction has pairs.
    refused_with("/format", json!("gravel/contact-problem/2"), &["`contacts.offset[0]`"]);
}

#[test]
fn empty_truncated_and_continued_files_are_refused() {
    let whole = pair().to_string();
    refused("", &["line 1 column 0"]);
    for quarters in [1, 2, 3] {
        refused(&whole[..whole.len() * quarters / 4], &["EOF", "line 1 column"]);
    }
    refused(&whole[..whole.len() - 1], &["EOF", "line 1 column"]);
    let (to_a_key, _) = whole.split_once("\"gap\"").unwrap();
    refused(
        to_a_key,
        &["`contacts`: EOF while parsing", "where the file ends: write or copy the whole of it again"],
    );
    refused(&format!("{whole}\n{whole}"), &["trailing characters", "line 2 column 1"]);
    refused("gravel", &["line 1 column 1"]);
}

/// One sphere on the floor, with friction.
const ROUGH: &str = r#"{"format": "gravel/contact-problem/2", "mechanics": "rough-spheres", "name": "one", "source": "t",
"time_step": 0.01, "grains": {"mass": [5.0], "radius": [1.0], "inertia": [2.0], "position": [[0, 1, 0]],
"free_velocity": [[0, -0.1, 0, 0, 0, 0]]}, "contacts": {"candidate": [0], "antagonist": [null], "normal": [[0, 1, 0]],
"offset": [[0, 0, 0]], "gap": [0], "friction": [0.8]}}"#;

#[test]
fn what_json_has_no_number_for_is_named_with_its_key() {
    for word in ["NaN", "nan", "Infinity", "-Infinity", "inf", "-inf"] {
        let is = format!("`grains.free_velocity[0][1]` is {word}, line 3 column ");
        refused(&ROUGH.replace("-0.1", word), &[&is, "a finite number is expected"]);
        let whole = pair().to_string().replace("[1.0,2.0]", &format!("[1.0,{word}]"));
        refused(&whole, &[&format!("`grains.mass[1]` is {word}, line 1 column ")]);
    }
    refused(&ROUGH.replace("0.8", "1e999"), &["`contacts.friction[0]`: number out of range at line 4"]);
}

#[test]
fn file_with_friction_that_is_cut_off_is_refused_where_it_ends() {
    let end = ROUGH.find("-0.1").unwrap();
    refused(
        &ROUGH[..end],
        &["`grains.free_velocity[0]", "EOF while parsing", "line 3 column", "where the file ends"],
    );
    refused(&ROUGH[..ROUGH.len() - 1], &["EOF while parsing an object", "line 4"]);
    refused(&ROUGH[..9], &["EOF", "line 1"]);
}

#[test]
fn file_that_is_not_text_is_refused() {
    let folder = TempDir::new().unwrap();
    let refused = |name: &str, bytes: &[u8], words: &[&str]| {
        let file = folder.path().join(name);
        std::fs::write(&file, bytes).unwrap();
        gravel(&["solve", text(&file)]).refused(words);
    };
    refused("bad.json", &[0xff, 0xfe, 0x00], &["bad.json: it is text in UTF-16", "save it in UTF-8"]);
    let latin = b"{\"format\":\n\"\xe9\"}";
    refused(
        "bad.json",
        latin,
        &["bad.json: it is no text in UTF-8, by the byte 0xe9 on line 2", "save it in UTF-8"],
    );
    for name in ["bad.dat", "bad.json"] {
        let is = format!("{name}: it is an HDF5 file, and its name must end in .hdf5 or .h5");
        refused(name, b"\x89HDF\r\n\x1a\n\0\0", &[&is]);
    }
    refused("bad.dat", &[b'2', 0xfe], &["bad.dat: it is no text in UTF-8"]);
    refused("bad.toml", &[b'2', 0xfe], &["bad.toml: it is no text in UTF-8"]);
    let problem = write(&folder, "pair.json", &pair().to_string());
    let impulses = folder.path().join("r.npy");
    std::fs::write(&impulses, b"\x93NUMPY").unwrap();
    gravel(&["certify", text(&problem), "--impulses", text(&impulses)])
        .refused(&["r.npy: it is no text in UTF-8, by the byte 0x93 on line 1"]);
}

#[test]
fn byte_order_mark_is_no_part_of_a_file() {
    let folder = TempDir::new().unwrap();
    let case = std::fs::read_to_string(crate::common::checkout().join("cases/column.toml")).unwrap();
    for (name, content) in [("p.json", &*pair().to_string()), ("rough.json", ROUGH), ("case.toml", &*case)] {
        let file = write(&folder, name, &format!("\u{feff}{content}"));
        gravel(&["solve", text(&file)]).succeeded();
    }
}

#[test]
fn impulses_in_another_form_are_refused() {
    let folder = TempDir::new().unwrap();
    let (smooth, rough) =
        (write(&folder, "pair.json", &pair().to_string()), write(&folder, "rough.json", ROUGH));
    let refused = |problem: &std::path::Path, content: &str, words: &[&str]| {
        let file = write(&folder, "r.json", content);
        gravel(&["certify", text(problem), "--impulses", text(&file)])
            .refused(&[&["r.json: "], words].concat());
        gravel(&["solve", text(problem), "--start", text(&file)]).refused(&[&["r.json: "], words].concat());
    };
    let form = "impulses are read from a file with {\"impulse\": […]}";
    refused(&smooth, "# r\n0.15\n0.1\n", &["expected value at line 1 column 1", form]);
    refused(&smooth, "none", &["expected ident at line 1 column 2", form]);
    refused(&smooth, r#"{"impulse": [0.15, NaN]}"#, &["`impulse[1]` is NaN, line 1 column 20", form]);
    refused(
        &smooth,
        r#"{"impulse": [0.15, null]}"#,
        &["`impulse[1]`: invalid type: null, expected a number"],
    );
    refused(&smooth, r#"{"impulse": [0.15]}"#, &["`impulse` has 1 values where the problem has 2 contacts"]);
    refused(
        &smooth,
        r#"{"impulses": [0.15, 0.1]}"#,
        &["missing key `impulse`", "`impulses` is no key; did you mean"],
    );
    // Of one contact with three numbers, a list for each; not a list for each direction.
    refused(
        &rough,
        r#"{"impulse": [[0.5], [0.1], [0.1]]}"#,
        &["`impulse[0]` has 1 values where each of 1 contacts has 3"],
    );
    refused(&rough, r#"{"impulse": [[0.5, 0.1, "x"]]}"#, &["`impulse[0][2]`: invalid type: string \"x\""]);
}

#[test]
fn overlaps_of_a_frozen_sample_are_refused_as_those_of_any_other() {
    let folder = TempDir::new().unwrap();
    let simulate = |high: f64| {
        let problem = pair_with("/grains/position", json!([[1.2, 0.5], [1.2, high]]));
        let file = format!("sample.file={}", text(&write(&folder, "pair.json", &problem.to_string())));
        gravel(&["simulate", "shaken-box", "--time-steps", "1", "--scene", &file])
    };
    // A twentieth of a radius is what another code may leave.
    simulate(1.475).succeeded();
    simulate(1.0).refused(&[
        "`sample`: grain 0, of radius 0.5 m",
        "overlaps grain 1",
        "by 0.5 m",
        "0.1 of the smaller radius",
    ]);
}

#[test]
fn folder_given_as_a_file_is_refused() {
    let folder = TempDir::new().unwrap();
    gravel(&["solve", text(folder.path())]).refused(&[text(folder.path()), "is a folder"]);
    gravel(&["simulate", text(folder.path()), "--time-steps", "1"]).refused(&["is a folder"]);
    gravel(&["bench", text(folder.path())]).refused(&["is a folder"]);
}

#[test]
fn missing_file_is_refused_with_the_known_names() {
    gravel(&["solve", "absent.json"]).refused(&["`absent.json`", "settled-991", "column"]);
    gravel(&["simulate", "absent.toml", "--time-steps", "1"]).refused(&["`absent.toml`", "column"]);
    gravel(&["bench", "absent"]).refused(&["`absent`", "paper"]);
}

#[test]
fn file_of_another_kind_is_named_as_what_it_is() {
    let (frozen, case) = ("cases/frozen/settled-991.json", "cases/column.toml");
    let simulate = |file| gravel(&["simulate", file, "--time-steps", "1"]);
    simulate(frozen).refused(&["settled-991.json is a frozen problem: a case is asked", ".toml"]);
    simulate("harness/plans/paper.toml").refused(&["paper.toml is a plan: a case is asked"]);
    gravel(&["bench", frozen]).refused(&["settled-991.json is a frozen problem: a plan is asked"]);
    gravel(&["bench", case]).refused(&["column.toml is a case: a plan is asked"]);
    let solve = |file| gravel(&["solve", file]);
    solve("harness/plans/paper.toml")
        .refused(&["paper.toml is a plan: a case or a frozen problem or a file of another code is asked"]);
    solve("README.md").refused(&[
        "README.md: a case or a frozen problem or a file of another code is asked",
        ".toml",
        ".json",
    ]);
    gravel(&["bench", "README.md"]).refused(&["README.md: a plan is asked, a file that ends in .toml"]);
}
