use results::schema::Run;

use super::*;
use crate::tests::fixture::{run, stored, tables};

fn filled(template: &str) -> Result<String, String> {
    let runs = [
        Run { iterations: 1234, ..run(0, "nsgs", "", "converged") },
        Run { iterations: 2468, ..run(1, "nsgs-dd", "4x2", "converged") },
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
fn what_is_not_there_is_an_error_that_names_it() {
    assert!(filled(r#"{{ run(method="cg").iterations }}"#).unwrap_err().contains("0 runs have method=cg"));
    assert!(filled(r#"{{ run(methode="cg") }}"#).unwrap_err().contains("`methode`"));
    assert!(filled(r#"{{ run(method="nsgs").iteration }}"#).is_err());
}
