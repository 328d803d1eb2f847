//! Findings of a study, in sentences from its rows alone.

use std::collections::{BTreeMap, BTreeSet};

use results::simulation::Energy;

use crate::draw::Looks;
use crate::read::{
    Ending, RunRow, Simulation, Study, Verdicts, count, counted, find_or_push, number, problems,
};

/// Number of problems above which methods are counted over all of them.
const FEW_PROBLEMS: usize = 6;

/// Their iterations are whole solves, or factorisations: they have no rank by iterations.
const FACTORISE: [&str; 4] = ["active-set", "convex", "newton-schur", "interior-point"];

/// States how the runs ended, who was first on each problem, and whose runs failed.
pub(crate) fn found(study: &Study) -> Vec<String> {
    match study {
        Study::Problems(study) => of_runs(&study.runs),
        Study::Simulations(all) => of_simulations(all),
    }
}

fn of_runs(runs: &[RunRow]) -> Vec<String> {
    if runs.is_empty() {
        return vec!["No run of this study is stored.".to_owned()];
    }
    let problems = problems(runs);
    let (looks, verdicts) = (Looks::new(runs), Verdicts::of(runs));
    let mut sentences = vec![overview(runs, &verdicts, problems.len())];
    sentences.extend(problems.iter().filter_map(|problem| solutions(runs, problem)));
    if problems.len() <= FEW_PROBLEMS {
        sentences.extend(problems.iter().map(|problem| first_and_last(runs, &verdicts, problem)));
    } else {
        sentences.extend(wins(runs, &looks, &problems));
    }
    sentences.extend(failures(runs, &verdicts));
    sentences.extend(floors(runs));
    sentences.extend(cycles(runs));
    sentences
}

/// Share of a change of impulses that moves grains, below which they only drift (–): with friction on packings of 250 and 991
/// discs it is 1e-5 at most where impulses drift along the kernel of W, and 5e-4 at least where they do not.
const DRIFTS: f64 = 1e-4;

/// Counts runs that ended without convergence while impulses only drift, or creep where a mode of W is as slow: the share tells no
/// difference.
fn floors(runs: &[RunRow]) -> Option<String> {
    let drifts = |run: &&RunRow| {
        matches!(run.ending, Ending::IterationLimit | Ending::Stalled)
            && run.iterations > 0
            && run.last_change_moves < DRIFTS
    };
    let on_floor = runs.iter().filter(drifts).count();
    (on_floor > 0).then(|| {
        format!(
            "Next to nothing moves: at the end of {} impulses drift along the kernel of W, or creep along a slow mode.",
            counted(on_floor, "run")
        )
    })
}

/// Counts the runs that went round in cycles.
fn cycles(runs: &[RunRow]) -> Option<String> {
    let lengths: Vec<u64> = runs.iter().filter_map(|run| run.cycle_iterations).collect();
    let (least, most) = (lengths.iter().min()?, lengths.iter().max()?);
    let range = if least == most { least.to_string() } else { format!("{least} to {most}") };
    let many = lengths.len();
    let rounds = if many == 1 { "goes round in a cycle" } else { "go round in cycles" };
    Some(format!("{} {rounds} of {range} iterations at the end.", counted(many, "run")))
}

/// Counts the simulations by their endings.
fn of_simulations(all: &[Simulation]) -> Vec<String> {
    let mut ended: BTreeMap<&str, usize> = BTreeMap::new();
    for simulation in all {
        *ended.entry(&simulation.status).or_default() += 1;
    }
    if ended.is_empty() {
        return vec!["No simulation of this study is stored.".to_owned()];
    }
    let ended: Vec<String> = ended.iter().map(|(status, n)| format!("{} {status}", count(*n))).collect();
    let mut sentences = vec![format!("{}: {}.", counted(all.len(), "simulation"), ended.join(", "))];
    sentences.extend(energy(all));
    sentences
}

/// Accounts for the energy in the simulation in which most was moved, and states how well the balances of all close.
fn energy(all: &[Simulation]) -> Option<String> {
    let moved = |simulation: &&Simulation| simulation.totals.energy.energy_moved_j;
    let moving = || all.iter().filter(|simulation| moved(simulation) > 0.0 && moved(simulation).is_finite());
    let most = moving().max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
    let Energy { walls_work_j, gap_work_j, shock_work_j, sliding_work_j, .. } = most.totals.energy;
    let left = moving().map(|one| one.totals.energy.energy_left_over_j / moved(&one)).fold(0.0, f64::max);
    let joule = |work: f64| number(work, 3);
    Some(format!(
        "Energy: with {} on {} walls gave {} J, gaps that closed {} J, shocks {} J and sliding {} J. Balances leave over at most {} \
         of what changed hands.",
        most.label(),
        most.scene,
        joule(walls_work_j),
        joule(gap_work_j),
        joule(shock_work_j),
        joule(sliding_work_j),
        number(left, 1),
    ))
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

/// The solutions of a problem that are known, where there are several or runs led to some: how far apart they are, and to what runs
/// were polished.
fn solutions(runs: &[RunRow], problem: &str) -> Option<String> {
    let on = || runs.iter().filter(|run| run.problem == problem).map(|run| &run.known);
    let first = on().find(|known| known.solutions.is_some())?;
    let polished_to = |word: &str| on().filter(|known| known.polished_to == word).count();
    let (of_known, new) = (polished_to("known"), polished_to("new"));
    let solutions = first.solutions.unwrap_or_default() as usize;
    if solutions < 2 && of_known + new == 0 {
        return None;
    }
    let apart = if solutions > 1 {
        format!(", up to {} apart in velocity", number(first.spread, 2))
    } else {
        String::new()
    };
    let led: Vec<String> = [(of_known, "one of them"), (new, "another")]
        .into_iter()
        .filter(|(runs, _)| *runs > 0)
        .map(|(runs, to)| format!("from where {} ended to {to}", counted(runs, "run")))
        .collect();
    let led = if led.is_empty() { "nowhere from where runs ended".to_owned() } else { led.join(", ") };
    let known = counted(solutions, "certified solution");
    Some(format!("{problem}: {known} known{apart}; Newton's method leads {led}."))
}

/// Describes the ending of a run; a claim that there is no solution is a proof unless a run or the reference refutes it.
fn how(run: &RunRow, verdicts: &Verdicts) -> &'static str {
    match run.ending {
        Ending::Infeasible if verdicts.is_proof(run) => "proved that there is no solution",
        Ending::Infeasible => "claimed wrongly that there is no solution",
        ending => ending.text(),
    }
}

/// Runs that may be compared: converged, and stopped by the rule that most of them had.
pub(crate) fn comparable<'r>(runs: &'r [RunRow], problem: &str) -> Vec<&'r RunRow> {
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

fn first_and_last(runs: &[RunRow], verdicts: &Verdicts, problem: &str) -> String {
    let proofs = runs.iter().filter(|run| run.problem == problem && verdicts.is_proof(run)).count();
    let runs = comparable(runs, problem);
    let ranked = || runs.iter().filter(|run| !FACTORISE.contains(&run.method.as_str()));
    let Some(fewest) = ranked().min_by_key(|run| run.iterations) else {
        return match (runs.first(), proofs) {
            (Some(run), _) => format!("{problem}: {} alone converged.", run.method),
            (None, 0) => format!("{problem}: no run converged."),
            (None, proofs) => format!("{problem}: no solution, as {} proved.", counted(proofs, "run")),
        };
    };
    let named = |run: &RunRow| format!("{} ({})", run.label(), count(run.iterations as usize));
    let rule = fewest.rule().map_or(String::new(), |rule| format!(" to {rule}"));
    let mut sentence = format!("{problem}: {} has the fewest iterations{rule}", named(fewest));
    if let Some(most) = ranked().max_by_key(|run| run.iterations).filter(|most| most.run != fewest.run) {
        sentence.extend([", ", &named(most), " the most"]);
    }
    let timed = runs.iter().filter_map(|run| Some((run.seconds()?, run)));
    if let Some((least, first)) = timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
        sentence.extend(["; ", &first.label(), " is the fastest (", &number(least, 2), " s)"]);
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
        let ranked =
            comparable(runs, problem).into_iter().filter(|run| !FACTORISE.contains(&run.method.as_str()));
        let least = ranked.min_by_key(|run| run.iterations);
        if let Some(kind) = least.and_then(|run| kinds.get_mut(&looks.rank(run))) {
            kind.2 += 1;
        }
    }
    let mut kinds: Vec<_> = kinds.into_values().collect();
    kinds.sort_by_key(|(_, _, first)| std::cmp::Reverse(*first));
    let winners = kinds.into_iter().filter(|(_, _, first)| *first > 0).take(FEW_PROBLEMS);
    winners
        .map(|(label, converged, first)| {
            let of = problems.len();
            format!(
                "{label}: fewest iterations on {first} of {of} problems; {} converged.",
                counted(converged, "run")
            )
        })
        .collect()
}

/// A sentence for each method with runs that failed: that neither converged nor proved that there is no solution. Those that
/// were skipped are counted apart.
fn failures(runs: &[RunRow], verdicts: &Verdicts) -> Vec<String> {
    let mut methods: Vec<(&str, usize, BTreeMap<_, usize>)> = Vec::new();
    for run in runs {
        let new = || (run.method.as_str(), 0, BTreeMap::new());
        let (_, all, failed) = find_or_push(&mut methods, |(name, ..)| *name == run.method, new);
        *all += 1;
        if !verdicts.is_right(run) {
            *failed.entry((run.ending, how(run, verdicts))).or_default() += 1;
        }
    }
    let sentence = |(method, all, mut failed): (&str, usize, BTreeMap<(Ending, &str), usize>)| {
        let mut skipped = 0;
        failed.retain(|(ending, _), n| {
            skipped += if *ending == Ending::Skipped { *n } else { 0 };
            *ending != Ending::Skipped
        });
        let kinds: Vec<String> = failed.iter().map(|((_, how), n)| format!("{} {how}", count(*n))).collect();
        let (number, all) = (count(failed.values().sum()), counted(all, "run"));
        match (kinds.join(", "), skipped) {
            (kinds, _) if kinds.is_empty() => format!("{method}: {} of {all} skipped.", count(skipped)),
            (kinds, 0) => format!("{method}: {number} of {all} failed ({kinds})."),
            (kinds, _) => {
                format!("{method}: {number} of {all} failed ({kinds}), {} skipped.", count(skipped))
            }
        }
    };
    methods.into_iter().filter(|(_, _, failed)| !failed.is_empty()).map(sentence).collect()
}

#[cfg(test)]
mod tests;
