//! What a study found, in sentences that its rows alone make.

use std::collections::{BTreeMap, BTreeSet};

use crate::ending::Ending;
use crate::legend::Looks;
use crate::number::{count, counted, number};
use crate::rows::{RunRow, Verdicts, problems};

/// Of more problems than this, methods are counted over all of them.
const FEW_PROBLEMS: usize = 6;

/// An iteration of it is a whole solve, with a factorisation in each of its steps: it has no rank by iterations.
const WHOLE_SOLVES: &str = "interior-point";

/// How the runs ended, who was first on each problem, and whose runs failed.
pub(crate) fn sentences(runs: &[RunRow]) -> Vec<String> {
    if runs.is_empty() {
        return vec!["No run of this study is stored.".to_owned()];
    }
    let problems = problems(runs);
    let (looks, verdicts) = (Looks::new(runs), Verdicts::of(runs));
    let mut sentences = vec![overview(runs, &verdicts, problems.len())];
    if problems.len() <= FEW_PROBLEMS {
        sentences.extend(problems.iter().map(|problem| first_and_last(runs, &verdicts, problem)));
    } else {
        sentences.extend(wins(runs, &looks, &problems));
    }
    sentences.extend(failures(runs, &verdicts));
    sentences
}

fn overview(runs: &[RunRow], verdicts: &Verdicts, problems: usize) -> String {
    let methods: BTreeSet<&str> = runs.iter().map(|run| run.method.as_str()).collect();
    let mut ended: BTreeMap<_, usize> = BTreeMap::new();
    for run in runs {
        *ended.entry((run.ending, how(run, verdicts))).or_default() += 1;
    }
    let ended: Vec<String> = ended.iter().map(|((_, how), n)| format!("{} {how}", count(*n))).collect();
    format!(
        "{} of {} on {}: {}.",
        counted(runs.len(), "run"),
        counted(methods.len(), "method"),
        counted(problems, "problem"),
        ended.join(", ")
    )
}

/// How a run ended; a proof that there is no solution is told from a claim that a run or the reference refutes.
fn how(run: &RunRow, verdicts: &Verdicts) -> &'static str {
    match run.ending {
        Ending::Infeasible if verdicts.is_proof(run) => "proved that there is no solution",
        Ending::Infeasible => "claimed wrongly that there is no solution",
        ending => ending.text(),
    }
}

/// Runs that may be compared: converged, and stopped by the rule that most of them had.
fn comparable<'r>(runs: &'r [RunRow], problem: &str) -> Vec<&'r RunRow> {
    let converged = |run: &&RunRow| run.problem == problem && run.ending == Ending::Converged;
    let converged: Vec<&RunRow> = runs.iter().filter(converged).collect();
    let rule = |run: &RunRow| (run.stop_on.clone(), run.tolerance.map(f64::to_bits));
    let mut rules: BTreeMap<_, usize> = BTreeMap::new();
    for run in &converged {
        *rules.entry(rule(run)).or_default() += 1;
    }
    let most = rules.into_iter().max_by_key(|(_, runs)| *runs).map(|(rule, _)| rule);
    converged.into_iter().filter(|run| Some(rule(run)) == most).collect()
}

fn seconds(run: &RunRow) -> Option<f64> {
    Some(run.setup_s? + run.iterating_s?)
}

fn first_and_last(runs: &[RunRow], verdicts: &Verdicts, problem: &str) -> String {
    let proofs = runs.iter().filter(|run| run.problem == problem && verdicts.is_proof(run)).count();
    let runs = comparable(runs, problem);
    let ranked = || runs.iter().filter(|run| run.method != WHOLE_SOLVES);
    let Some(fewest) = ranked().min_by_key(|run| run.iterations) else {
        return match (runs.first(), proofs) {
            (Some(run), _) => format!("{problem}: {} alone converged.", run.method),
            (None, 0) => format!("{problem}: no run converged."),
            (None, proofs) => format!("{problem}: no solution, as {} proved.", counted(proofs, "run")),
        };
    };
    let told = |run: &RunRow| format!("{} ({})", run.label(), count(run.iterations as usize));
    let rule = fewest.tolerance.map_or(String::new(), |tolerance| {
        format!(" to {} ≤ {}", fewest.stop_on.replace('_', " "), number(tolerance, 2))
    });
    let mut sentence = format!("{problem}: {} has the fewest iterations{rule}", told(fewest));
    if let Some(most) = ranked().max_by_key(|run| run.iterations).filter(|most| most.run != fewest.run) {
        sentence.extend([", ", &told(most), " the most"]);
    }
    let timed = runs.iter().filter_map(|run| Some((seconds(run)?, run)));
    if let Some((least, first)) = timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
        sentence.extend(["; ", &first.label(), " is first in time (", &number(least, 2), " s)"]);
    }
    sentence + "."
}

/// On how many problems each kind of run converged and had the fewest iterations, the most successful first.
fn wins(runs: &[RunRow], looks: &Looks, problems: &[&str]) -> Vec<String> {
    let mut kinds: BTreeMap<(usize, usize), (String, usize, usize)> = BTreeMap::new();
    for run in runs {
        let kind = kinds.entry(looks.rank(run)).or_insert_with(|| (run.label(), 0, 0));
        kind.1 += usize::from(run.ending == Ending::Converged);
    }
    for problem in problems {
        let ranked = comparable(runs, problem).into_iter().filter(|run| run.method != WHOLE_SOLVES);
        let least = ranked.min_by_key(|run| run.iterations);
        if let Some(kind) = least.and_then(|run| kinds.get_mut(&looks.rank(run))) {
            kind.2 += 1;
        }
    }
    let mut kinds: Vec<_> = kinds.into_values().collect();
    kinds.sort_by_key(|(_, _, first)| std::cmp::Reverse(*first));
    let told = kinds.into_iter().filter(|(_, _, first)| *first > 0).take(FEW_PROBLEMS);
    told.map(|(label, converged, first)| {
        let of = problems.len();
        format!(
            "{label}: fewest iterations on {first} of {of} problems; {} converged.",
            counted(converged, "run")
        )
    })
    .collect()
}

/// A sentence for each method with runs that failed: that neither converged nor proved that there is no solution.
fn failures(runs: &[RunRow], verdicts: &Verdicts) -> Vec<String> {
    let mut methods: Vec<(&str, usize, BTreeMap<_, usize>)> = Vec::new();
    for run in runs {
        let index = methods.iter().position(|(name, ..)| *name == run.method).unwrap_or_else(|| {
            methods.push((&run.method, 0, BTreeMap::new()));
            methods.len() - 1
        });
        methods[index].1 += 1;
        if !verdicts.is_right(run) {
            *methods[index].2.entry((run.ending, how(run, verdicts))).or_default() += 1;
        }
    }
    let sentence = |(method, all, failed): (&str, usize, BTreeMap<_, usize>)| {
        let kinds: Vec<String> =
            failed.iter().map(|((_, how), n): (&(Ending, &str), _)| format!("{} {how}", count(*n))).collect();
        let number: usize = failed.values().sum();
        format!("{method}: {} of {} failed ({}).", count(number), counted(all, "run"), kinds.join(", "))
    };
    methods.into_iter().filter(|(_, _, failed)| !failed.is_empty()).map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use results::schema::Run;

    use super::*;
    use crate::fixture::{run, sample, tables};

    fn told(runs: &[Run]) -> Vec<String> {
        sentences(&crate::rows::runs(&tables(runs, &[]).runs).unwrap())
    }

    fn study() -> Vec<Run> {
        vec![
            Run { iterations: 40, iterating_s: 0.5, ..run(0, "cg", "", "converged") },
            Run { iterations: 900, iterating_s: 0.2, ..run(1, "nsgs", "", "converged") },
            Run { iterations: 7, ..run(2, "jacobi", "", "diverged") },
        ]
    }

    #[test]
    fn sentences_say_what_the_rows_say() {
        let expected = [
            "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 2 converged, 1 diverged.",
            "column: cg (40) has the fewest iterations to natural map ≤ 10⁻⁴, nsgs (900) the most; nsgs is first in time (0.20 s).",
            "jacobi: 1 of 1\u{a0}run failed (1 diverged).",
        ];
        assert_eq!(told(&study()), expected);
    }

    #[test]
    fn other_rows_make_other_sentences() {
        let mut other = study();
        other[0].iterations = 1000;
        other[1].iterating_s = 0.9;
        other[2].status = "converged".into();
        let expected = [
            "3\u{a0}runs of 3\u{a0}methods on 1\u{a0}problem: 3 converged.",
            "column: jacobi (7) has the fewest iterations to natural map ≤ 10⁻⁴, cg (1\u{202f}000) the most; jacobi is first in time (0.012 s).",
        ];
        assert_eq!(told(&other), expected);
    }

    #[test]
    fn proof_that_there_is_no_solution_is_no_failure_unless_a_run_finds_one() {
        let on = |i, method: &str, status: &str| {
            let unknown = sample(9, 1.0, f64::NAN);
            Run { problem: "wedge".into(), end: unknown, ..run(i, method, "", status) }
        };
        let mut runs = vec![on(0, "cg", "infeasible"), on(1, "nsgs", "iteration-limit")];
        let expected = [
            "2\u{a0}runs of 2\u{a0}methods on 1\u{a0}problem: 1 iteration limit, 1 proved that there is no solution.",
            "wedge: no solution, as 1\u{a0}run proved.",
            "nsgs: 1 of 1\u{a0}run failed (1 iteration limit).",
        ];
        assert_eq!(told(&runs), expected);
        runs[1].status = "converged".into();
        assert_eq!(
            told(&runs)[2],
            "cg: 1 of 1\u{a0}run failed (1 claimed wrongly that there is no solution)."
        );
        // The reference is certified: the velocity error is known.
        runs[1].status = "iteration-limit".into();
        runs[0].end = sample(9, 1.0, 0.5);
        assert!(told(&runs)[2].starts_with("cg: 1 of 1\u{a0}run failed"), "{:?}", told(&runs));
    }

    #[test]
    fn interior_point_has_no_rank_by_iterations_and_one_in_time() {
        let mut runs = study();
        runs.push(Run { iterations: 2, iterating_s: 0.1, ..run(3, "interior-point", "", "converged") });
        let sentence = &told(&runs)[1];
        assert!(sentence.starts_with("column: cg (40) has the fewest iterations"), "{sentence}");
        assert!(sentence.ends_with("interior-point is first in time (0.10 s)."), "{sentence}");
        assert_eq!(told(&runs[3..])[1], "column: interior-point alone converged.");
    }

    #[test]
    fn runs_with_another_stop_rule_are_not_compared() {
        let mut runs = study();
        runs.push(Run { iterations: 600, ..run(3, "apgd", "", "converged") });
        runs[0].tolerance = 1e-1;
        assert!(told(&runs)[1].starts_with("column: apgd (600) has the fewest"), "{:?}", told(&runs));
    }

    #[test]
    fn many_problems_are_counted_and_no_run_is_said() {
        let on = |i: u32, method: &str, iterations| Run {
            problem: format!("problem {}", i / 2),
            iterations,
            ..run(i, method, "", "converged")
        };
        let runs: Vec<Run> = (0..20)
            .map(|i| if i % 2 == 0 { on(i, "cg", 10) } else { on(i, "nsgs", 5 + u64::from(i)) })
            .collect();
        assert_eq!(told(&runs)[1], "cg: fewest iterations on 8 of 10 problems; 10\u{a0}runs converged.");
        assert_eq!(told(&[]), ["No run of this study is stored."]);
    }
}
