//! "Did you mean …?", and errors without types.

use crate::terminal::suggest::{among, in_error, of, without_types};
use crate::terminal::write_kept;
use serde::Deserialize;

#[test]
fn most_similar_name_is_meant_if_any_is_similar() {
    let known = ["order", "relaxation", "seed", "symmetric"];
    assert_eq!(of("relax", known), "; did you mean `relaxation`?");
    assert_eq!(of("sede", known), "; did you mean `seed`?");
    assert_eq!(of("kappa", known), "");
    assert_eq!(of("", known), "");
    assert_eq!(of("seed", []), "");
}

#[test]
fn name_of_another_code_means_the_key_that_is_known_here() {
    assert_eq!(of("omega", ["order", "relaxation"]), "; did you mean `relaxation`?");
    assert_eq!(of("ω", ["order", "relaxation"]), "; did you mean `relaxation`?");
    assert_eq!(of("tol", ["on", "tolerance"]), "; did you mean `tolerance`?");
    assert_eq!(of("dt", ["law", "time_step_s"]), "; did you mean `time_step_s`?");
    assert_eq!(of("omega", ["order", "seed"]), "", "it is no key here");
    let methods = ["cg", "jacobi", "nsgs", "nsgs-dd"];
    for (given, meant) in
        [("NLGS", "nsgs"), ("CPG", "cg"), ("PGS", "nsgs"), ("NSGS", "nsgs"), ("Jacobi", "jacobi")]
    {
        assert_eq!(of(given, methods), format!("; did you mean `{meant}`?"));
    }
}

#[test]
fn name_that_was_meant_stands_before_the_list() {
    let known = ["order", "relaxation"];
    let printed = "no key `relax`; did you mean `relaxation`? (there are order, relaxation)";
    assert_eq!(among("no key `relax`", "relax", known), printed);
    assert_eq!(among("no key `x`", "x", known), "no key `x` (there are order, relaxation)");
    let many: Vec<String> = (0..300).map(|k| format!("grains={k}")).collect();
    let text = among("none", "grains=29 *", many.iter().map(String::as_str));
    assert!(
        text.starts_with("none; did you mean `grains=29")
            && text.contains("(there are 300, such as grains=29")
    );
    assert!(text.matches("grains=").count() == 9, "{text}");
}

#[test]
fn error_of_serde_names_no_type_of_the_program() {
    let plain = |error: serde_json::Error| without_types(&error.to_string());
    let text = plain(serde_json::from_str::<f64>("[]").unwrap_err());
    assert!(text.starts_with("invalid type: sequence, expected a number at line 1"), "{text}");
    let text = plain(serde_json::from_str::<One>("3").unwrap_err());
    assert!(text.starts_with("invalid type: integer `3`, expected keys with values at line 1"), "{text}");
    let text = plain(serde_json::from_str::<One>("[]").unwrap_err());
    assert!(text.starts_with("invalid length 0, expected keys with values with 1 element"), "{text}");
    assert_eq!(without_types("expected f64s, or expected"), "expected f64s, or expected");
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct One {
    #[allow(dead_code)]
    preconditioner: Law,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Law {
    PredictedGap,
    Iqs,
}

fn keys() -> Vec<String> {
    ["name", "scene.box.friction", "scene.friction", "scene.restitution"].map(str::to_owned).to_vec()
}

#[test]
fn errors_of_serde_tell_what_was_given_and_what_is_known() {
    let error = |text: &str| toml::from_str::<One>(text).unwrap_err().to_string().trim_end().to_owned();
    let meant = |error: &str, expected: &str| {
        let printed = in_error(error, keys);
        assert!(
            printed.contains(expected) && printed.starts_with(error.split("`, ").next().unwrap()),
            "{printed}"
        );
    };
    meant(
        &error("precondition = 1"),
        "`precondition`; did you mean `preconditioner`? Expected `preconditioner`",
    );
    let variant = error("preconditioner = \"predicted-gp\"");
    meant(&variant, "`predicted-gp`; did you mean `predicted-gap`? Expected `predicted-gap` or `iqs`");
    meant(&error("mu = 0.3"), "`mu`; in a case it is `scene.friction`. Expected `preconditioner`");
    meant(&error("Restitution = 0.3"), "`Restitution`; in a case it is `scene.restitution`");
    meant(&error("cohesion = 0.3"), "`cohesion`; contacts are without cohesion");
    for none in ["preconditioner = \"hertz\"", "preconditioner = 1"] {
        assert_eq!(in_error(&error(none), keys), error(none));
    }
    let json = serde_json::from_str::<One>("{\"preconditionr\": \"iqs\"}").unwrap_err().to_string();
    meant(&json, "; did you mean `preconditioner`? Expected `preconditioner`");
}

#[test]
fn files_are_written_while_others_remove_abandoned_ones() {
    let folder = tempfile::tempdir().unwrap();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let path = folder.path().join(format!("{thread}.json"));
            scope.spawn(move || (0..200).for_each(|_| write_kept(&path, "{}").unwrap()));
        }
    });
    let left = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 4);
}
