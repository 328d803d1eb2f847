//! The spectral reason of a failure, where one is known, with the computed number that it rests on.

use serde_json::Value;

use super::Judged;
use super::class::Class;
use crate::read::RunRow;

/// A reason, as words with a number in the midst of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cause {
    pub(crate) before: &'static str,
    pub(crate) value: f64,
    pub(crate) after: &'static str,
}

/// A direction this many times its best value, or a part of it, is called far (–).
const FAR: f64 = 3.0;

/// Why a run failed; nothing where no reason is known.
pub(crate) fn causes(judged: &Judged) -> Vec<Cause> {
    let run = judged.run;
    let own = match run.method.as_str() {
        "jacobi" => jacobi(run),
        "nsgs" => at_least("relaxation", "ω = ", 2.0, ", and from ω = 2 on q(r) need not fall", run),
        "gradient" => at_least("step", "s = ", 2.0, ", and from s = 2 on q(r) need not fall", run),
        // Where it still falls, it is not this that keeps it from converging.
        "nsgs-dd" if judged.class != Class::Slow => whole_masses(run),
        "latin-dd" => directions(run),
        _ => Vec::new(),
    };
    if own.is_empty() && judged.class != Class::Diverged { condition(judged) } else { own }
}

fn spectral(run: &RunRow, key: &str) -> Option<f64> {
    run.spectrum.get(key)?.as_f64()
}

/// The value that a run worked with: derived, else set.
fn used(run: &RunRow, key: &str) -> Option<f64> {
    run.derived.get(key).or_else(|| run.settings.get(key)).and_then(Value::as_f64)
}

/// ω λmax(W_D⁻¹W) > 2.
fn jacobi(run: &RunRow) -> Vec<Cause> {
    let product =
        used(run, "relaxation").zip(spectral(run, "lambda_max")).map(|(omega, lambda)| omega * lambda);
    let cause = |value| Cause { before: "ω λmax(W_D⁻¹W) = ", value, after: ", above 2" };
    product.filter(|product| *product > 2.0).map(cause).into_iter().collect()
}

fn at_least(key: &str, before: &'static str, limit: f64, after: &'static str, run: &RunRow) -> Vec<Cause> {
    let value = used(run, key).filter(|value| *value >= limit);
    value.map(|value| Cause { before, value, after }).into_iter().collect()
}

/// Whole masses of copies that work at once; with one sweep between gluings and ω = 1, λmax(W_D⁻¹W_off) ≥ 1.
fn whole_masses(run: &RunRow) -> Vec<Cause> {
    let whole = run.settings.get("mass_splitting") == Some(&Value::Bool(false));
    let at_once = run.settings.get("exchange").is_none_or(|exchange| exchange == "jacobi");
    let copies = spectral(run, "multiplicity").filter(|copies| whole && at_once && *copies >= 2.0);
    let exact = used(run, "relaxation").is_none_or(|omega| omega == 1.0);
    let one_sweep = exact && used(run, "inner_sweeps") == Some(1.0);
    let coupling = spectral(run, "coupling").filter(|coupling| one_sweep && *coupling >= 1.0);
    let whole_in = |copies| Cause { before: "masses are whole in up to ", value: copies, after: " copies" };
    let bound = |value| Cause { before: "λmax(W_D⁻¹W_off) = ", value, after: ", not below 1" };
    match (copies, coupling) {
        // Below 1 it is no reason.
        (None, _) => Vec::new(),
        (Some(_), None) if one_sweep && spectral(run, "coupling").is_some() => Vec::new(),
        (Some(copies), coupling) => std::iter::once(whole_in(copies)).chain(coupling.map(bound)).collect(),
    }
}

/// κ_l far from κ_opt, and κ_d far from κ_l.
fn directions(run: &RunRow) -> Vec<Cause> {
    let kappa = |key: &str| used(run, &format!("{key}_minus")).or_else(|| used(run, key));
    let (l, d) = (kappa("kappa_l"), kappa("kappa_d"));
    let far = |ratio: &f64| !(1.0 / FAR..=FAR).contains(ratio);
    let at_contacts = l.zip(spectral(run, "kappa_opt")).map(|(l, best)| l / best).filter(far);
    let at_interface = l.zip(d).map(|(l, d)| d / l).filter(far).filter(|_| run.subdomains > 1);
    let cause = |before, value, after| Cause { before, value, after };
    let own = at_contacts.map(|ratio| cause("κ_l/κ_opt = ", ratio, ""));
    own.into_iter().chain(at_interface.map(|ratio| cause("κ_d/κ_l = ", ratio, ""))).collect()
}

/// A least eigenvalue λ̃min that asks for more iterations than the limit, by the rate of the method at the contacts that stay
/// closed: 1 − ω λ̃min for Jacobi, the square of 1 − λ̃min for Gauss-Seidel, with the condition number C = λ̃max/λ̃min
/// 1 − 1/C for a gradient, 1 − 2/√C for what conjugates, extrapolates or has its best direction. Where convergence is false,
/// C lies between the measure and the error, whatever its size.
fn condition(judged: &Judged) -> Vec<Cause> {
    let run = judged.run;
    let (greatest, least) = (spectral(run, "closed_lambda_max"), spectral(run, "closed_lambda_min"));
    let (Some(greatest), Some(least), Some(tolerance)) = (greatest, least, run.tolerance) else {
        return Vec::new();
    };
    let condition = greatest / least;
    let decay = match run.method.as_str() {
        "jacobi" => used(run, "relaxation").unwrap_or(1.0) * least,
        "nsgs" | "nsgs-dd" => 2.0 * least,
        "gradient" => 1.0 / condition,
        _ => 2.0 / condition.sqrt(),
    };
    let explains =
        judged.class == Class::FalseConvergence || (1.0 / tolerance).ln() / decay > run.max_iterations as f64;
    let cause = Cause { before: "the condition number λ̃max/λ̃min is ", value: condition, after: "" };
    explains.then_some(cause).into_iter().collect()
}
