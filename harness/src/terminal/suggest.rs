//! "Did you mean …?", for every unknown name.

use regex::{Captures, Regex};

/// Names that are less alike than this are not meant for each other (Jaro and Winkler's similarity, 1 for equal names).
const ALIKE: f64 = 0.8;

/// What other codes and papers call the keys of this one.
const ALIASES: [(&str, &[&str]); 9] = [
    ("relaxation", &["omega", "ω", "w", "sor"]),
    ("kappa_l", &["kappa", "κ", "k", "direction"]),
    ("tolerance", &["tol", "eps", "epsilon", "precision"]),
    ("max_iterations", &["maxiter", "max_iter", "itermax", "iterations"]),
    ("subdomains", &["domains", "parts", "blocks", "ndom"]),
    ("inner_sweeps", &["sweeps", "inner"]),
    ("time_step", &["dt", "h", "timestep"]),
    ("time_step_s", &["dt", "h", "timestep"]),
    ("gravity_m_per_s2", &["g"]),
];

/// What no key stands for.
const NOT_MODELLED: [&str; 5] = ["mu", "friction", "restitution", "cohesion", "rotation"];

/// The end of an error about the unknown name `given`: the one of the `known` ones that means the same or is most similar, if
/// any is.
pub(crate) fn of<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let lower = given.to_lowercase();
    let means = |known: &str| ALIASES.iter().any(|(key, others)| *key == known && others.contains(&&*lower));
    let alike = known
        .into_iter()
        .map(|known| (if means(known) { 1.0 } else { strsim::jaro_winkler(given, known) }, known));
    let nearest = alike.filter(|(alike, _)| *alike >= ALIKE).max_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map_or_else(String::new, |(_, nearest)| format!("; did you mean `{nearest}`?"))
}

/// An error about the unknown name `given`, which `what` describes: the one that was meant, if any, then all the `known` ones.
pub(crate) fn among<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let list: Vec<&str> = known.clone().into_iter().collect();
    format!("{what}{} (there are {})", of(given, known), list.join(", "))
}

/// An error, with the name that was meant where it is one of serde about a name: unknown field `relax`, expected one of
/// `order`, `relaxation`.
pub(crate) fn in_error(text: &str) -> String {
    let unknown = Regex::new("(?s)^(.*unknown (?:field|variant) `([^`]*)`), expected (.*)$").ok();
    let Some((_, [before, given, known])) =
        unknown.and_then(|unknown| Some(unknown.captures(text)?.extract()))
    else {
        return text.to_owned();
    };
    // Between backticks is every second part.
    match of(given, known.split('`').skip(1).step_by(2)) {
        nearest if !nearest.is_empty() => format!("{before}{nearest} Expected {known}"),
        _ if NOT_MODELLED.contains(&given) => format!(
            "{before}; friction is a number of the scene, `scene.friction`, or of each contact; contacts are without restitution and cohesion. Expected {known}"
        ),
        _ => text.to_owned(),
    }
}

/// An error without the types of the program: what serde expects of a value, in the words of a file.
pub(crate) fn without_types(text: &str) -> String {
    // The name of a type follows its kind, as in: struct Stop with 3 elements.
    let types = "\\bexpected (a nonzero u32|f64|u8|u32|u64|usize|i64|\
                 (?:struct|tuple struct|internally tagged enum)(?: [[:alnum:]]+)?)\\b";
    let plain = |found: &Captures| match &found[1] {
        "a nonzero u32" => "expected a whole number above 0",
        "f64" => "expected a number",
        "u8" | "i64" => "expected a whole number",
        word if word.starts_with("tuple") => "expected a list",
        word if word.starts_with("struct") || word.starts_with("internally") => "expected keys with values",
        _ => "expected a whole number, not negative",
    };
    Regex::new(types).map_or(text.to_owned(), |types| types.replace_all(text, plain).into_owned())
}
