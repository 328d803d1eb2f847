//! `gravel which`.

use crate::common::gravel;
use serde_json::Value;

/// Returns the answer to `which`, and the methods tried that converged, in its order.
fn which(arguments: &[&str]) -> (Value, Vec<Value>) {
    let answer = gravel(&[&["which", "--json"], arguments].concat()).succeeded().json();
    let tried = answer["tried"].as_array().unwrap();
    let converged = tried.iter().filter(|one| one["status"] == "converged").cloned().collect();
    (answer, converged)
}

/// The first of those that converge is taken, and each that ties has an interval that meets its own.
#[test]
fn the_fastest_method_that_converges_is_taken() {
    let (answer, converged) = which(&["settled-60"]);
    let number = |one: &Value, key: &str| one[key].as_f64().unwrap();
    assert_eq!(answer["take"], converged[0]["method"]);
    assert!(converged.iter().all(|one| number(one, "natural_map") <= 1e-6));
    assert!(converged.windows(2).all(|pair| number(&pair[0], "seconds") <= number(&pair[1], "seconds")));
    for one in &converged[1..] {
        let overlap = number(one, "seconds_low") <= number(&converged[0], "seconds_high");
        let ties = overlap && number(one, "seconds") <= 1.5 * number(&converged[0], "seconds");
        assert_eq!(answer["ties"].as_array().unwrap().contains(&one["method"]), ties, "{one}");
    }
}

/// Methods that need a minimum, or grains, say why they are not tried.
#[test]
fn what_cannot_solve_the_problem_says_why() {
    let (answer, converged) = which(&["rough-250", "--tolerance", "1e-3"]);
    assert!(!converged.is_empty());
    let skipped = answer["skipped"].as_array().unwrap();
    assert!(skipped.iter().any(|why| why.as_str().unwrap().contains("nncg")), "{answer}");
    let (answer, _) = which(&["Box_Stacks-i0122-82-5", "--tolerance", "1e-3"]);
    assert!(answer["skipped"].to_string().contains("needs grains"), "{answer}");
}

/// Where no method converges, a proof that there is no solution is the answer.
#[test]
fn where_none_converges_it_says_so() {
    let proof = gravel(&["which", "closing-walls"]).ended(4);
    assert!(proof.stdout.contains("proves that the problem has no solution"), "{}", proof.stdout);
    // A tolerance that is met far from any solution is no answer.
    let far = gravel(&["which", "closing-walls", "--on", "zeta", "--tolerance", "0.1"]).ended(3);
    assert!(far.stdout.contains("false-convergence") && !far.stdout.contains("take"), "{}", far.stdout);
    gravel(&["which", "Box_Stacks-i0122-82-5", "--start", "warm"]).refused(&["--start", "W alone"]);
    let none = gravel(&["which", "rough-250", "--max-iterations", "1"]).ended(3);
    assert!(none.stdout.contains("none of them converges"), "{}", none.stdout);
    gravel(&["which", "rough-250", "--seconds", "-1"]).refused(&["--seconds -1: it must be positive"]);
}
