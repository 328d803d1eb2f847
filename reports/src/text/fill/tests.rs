use results::schema::Ending;
use results::schema::Run;
use serde_json::json;

use super::*;
use crate::tests::fixture::{object, run, sample, stored, tables};

fn filled(template: &str) -> Result<String, String> {
    let runs = [
        Run { iterations: 1234, ..run(0, "nsgs", "", Ending::Converged) },
        Run { iterations: 2468, ..run(1, "nsgs-dd", "4x2", Ending::Converged) },
    ];
    fill(&stored(&tables(&runs, &[])), template).map_err(|error| error.to_string())
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
    assert_eq!(fill(&stored(&tables(&runs, &[])), text).unwrap(), "0.5, 10⁻⁴");
}

#[test]
fn what_is_not_there_is_an_error_that_names_it() {
    assert!(filled(r#"{{ run(method="cg").iterations }}"#).unwrap_err().contains("0 runs have method=cg"));
    assert!(filled(r#"{{ run(methode="cg") }}"#).unwrap_err().contains("`methode`"));
    assert!(filled(r#"{{ run(method="nsgs").iteration }}"#).is_err());
}

/// `slow` reaches the accuracy on both problems, `fast` on one alone.
#[test]
fn kinds_rank_their_methods() {
    let on = |seed: u32, id, method, seconds| Run {
        problem: format!("box seed={seed}"),
        problem_settings: object(&json!({ "case": "box", "sample.grains": 60, "sample.seed": seed })),
        setup_s: seconds,
        iterating_s: 0.0,
        ..run(id, method, "", Ending::Converged)
    };
    let runs = [on(1, 0, "slow", 3.0), on(1, 1, "fast", 1.0), on(2, 2, "slow", 2.0), on(2, 3, "fast", 1.0)];
    let ends = [(0, 1e-5), (1, 1e-5), (2, 1e-5), (3, 1e-2)];
    let curves = ends.map(|(run, map)| (run, vec![sample(0, 0.1, map)]));
    let text = r#"{% for kind in kinds %}{{ kind.case }} {{ kind.grains }} {{ kind.problems }}:{% for at in kind.ranked if at.accuracy == 1e-4 %}{% for m in at.methods %} {{ m.label }} {{ m.reached }} {{ m.worst|number(2) }};{% endfor %}{% endfor %}{% endfor %}"#;
    let filled = fill(&stored(&tables(&runs, &curves)), text).unwrap();
    assert_eq!(filled, "box 60 2: slow 2 3.0; fast 1 1.0;");
}
