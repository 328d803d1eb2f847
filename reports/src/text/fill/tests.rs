use results::schema::Ending;
use results::schema::Run;
use serde_json::json;

use super::*;
use crate::tests::fixture::{object, run, stored, tables};

fn filled(template: &str) -> Result<String, String> {
    let runs = [
        Run { iterations: 1234, ..run(0, "nsgs", "", Ending::Converged) },
        Run { iterations: 2468, ..run(1, "nsgs-dd", "4x2", Ending::Converged) },
    ];
    fill(&stored(&tables(&runs, &[])), &[], template, &[]).map_err(|error| error.to_string())
}

#[test]
fn numbers_and_verdicts_come_from_the_rows() {
    let text = r#"{% set a = run(method="nsgs") %}{% set b = run(method="nsgs-dd", variant="4x2") %}
{{ a.iterations|count }}, {{ (b.iterations / a.iterations)|number(2) }}: {{ "holds" if b.iterations < 1.1 * a.iterations else "fails" }}
"#;
    assert_eq!(filled(text).unwrap(), "1\u{202f}234, 2.0: fails\n");
    assert_eq!(filled(r#"{{ runs(status="converged")|length }}"#).unwrap(), "2");
}

#[test]
fn what_a_column_holds_as_json_is_an_object() {
    let settings = object(&json!({ "relaxation": 0.5 }));
    let derived = object(&json!({ "rungs": [{ "tolerance": 1e-2 }, { "tolerance": 1e-4 }] }));
    let runs = [Run { settings, derived, ..run(0, "osqp", "", Ending::Converged) }];
    let text = r#"{{ run(method="osqp").settings.relaxation }}, {{ run(method="osqp").derived.rungs[1].tolerance|number(1) }}"#;
    assert_eq!(fill(&stored(&tables(&runs, &[])), &[], text, &[]).unwrap(), "0.5, 10⁻⁴");
}

#[test]
fn what_is_not_there_is_an_error_that_names_it() {
    assert!(filled(r#"{{ run(method="cg").iterations }}"#).unwrap_err().contains("0 runs have method=cg"));
    assert!(filled(r#"{{ run(methode="cg") }}"#).unwrap_err().contains("`methode`"));
    assert!(filled(r#"{{ run(method="nsgs").iteration }}"#).is_err());
}

#[test]
fn tables_are_rows_by_their_columns() {
    let table =
        polars::df!("method" => ["nsgs", "cg"], "worst" => [Some(1.5), None], "reached" => [2_u64, 0])
            .unwrap();
    let text = r#"{% for row in table("counts") %}{{ row.method }} {{ row.reached }} {{ row.worst|number(2) if row.reached > 0 else "–" }}; {% endfor %}"#;
    let runs = tables(&[run(0, "nsgs", "", Ending::Converged)], &[]);
    let filled = |text| fill(&stored(&runs), &[("counts".to_owned(), table.clone())], text, &[]);
    assert_eq!(filled(text).unwrap(), "nsgs 2 1.5; cg 0 –; ");
    assert!(
        filled(r#"{{ table("count")|length }}"#)
            .unwrap_err()
            .to_string()
            .contains("no table `count`: there are counts")
    );
}

#[test]
fn part_that_is_included_sees_what_the_text_set() {
    let runs = [run(0, "nsgs", "", Ending::Converged)];
    let filled = |parts: &[(String, String)]| {
        let text = "{% set word = \"so\" %}{% include \"one.part.in\" %}";
        fill(&stored(&tables(&runs, &[])), &[], text, parts).map_err(|error| error.to_string())
    };
    let part = "{{ word }} {{ runs()|length }}".to_owned();
    assert_eq!(filled(&[("one.part.in".to_owned(), part)]).unwrap(), "so 1");
    assert!(filled(&[]).unwrap_err().contains("one.part.in"));
}
