//! "Did you mean …?", for every unknown name. Errors of serde are read as texts, since serde hands on nothing else of them.

use regex::{Captures, Regex};

/// Names that are less alike than this are not meant for each other (Jaro and Winkler's similarity, 1 for equal names).
const ALIKE: f64 = 0.8;

/// Greatest length of a list of names that an error gives in full, half a screen in characters, and how many of the most similar names it
/// gives of a longer one.
const FITS: usize = 1200;
const SHOWN: usize = 8;

/// Names that other codes and papers have for the methods and keys of this one.
const ALIASES: [(&str, &[&str]); 19] = [
    ("nsgs", &["nlgs", "pgs", "pgs3", "gs", "gauss-seidel", "psor", "sor"]),
    ("nsgs-dd", &["nlgs-dd", "nlgs-ddm", "ddm", "schwarz"]),
    ("cg", &["cpg", "pcpg", "pcg", "conjugate-gradient"]),
    ("jacobi", &["pj", "pjor", "jor"]),
    ("gradient", &["pg", "pgd", "projected-gradient"]),
    ("apgd", &["apg", "fista", "nesterov"]),
    ("active-set", &["newton", "nsn", "pdas", "lemke", "pivot", "interior-point", "ipm"]),
    ("latin-dd", &["latin", "large-time-increment"]),
    ("friction", &["mu", "μ", "friction_coefficient"]),
    ("restitution", &["e", "e_n", "cor"]),
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

/// Features without a key, and the alternative to each.
const NOT_MODELLED: [(&str, &str); 2] = [
    ("cohesion", "contacts are without cohesion"),
    ("rotation", "grains turn where they have friction, `scene.friction`"),
];

/// The end of an error about the unknown name `given`: the one of the `known` ones that means the same or is most similar, if
/// any is.
pub(crate) fn of<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let lower = given.to_lowercase();
    let alike = known
        .into_iter()
        .map(|known| (if means(&lower, known) { 1.0 } else { strsim::jaro_winkler(&lower, known) }, known));
    let nearest = alike.filter(|(alike, _)| *alike >= ALIKE).max_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map_or_else(String::new, |(_, nearest)| format!("; did you mean `{nearest}`?"))
}

/// Returns whether a name in small letters is that of another code for what is `known` here.
fn means(given: &str, known: &str) -> bool {
    ALIASES.iter().any(|(key, others)| *key == known && others.contains(&given))
}

/// An error about the unknown name `given`, which `what` describes: the one that was meant, if any, then all the `known` ones, or the
/// most similar where these would fill a screen.
pub(crate) fn among<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let mut list: Vec<&str> = known.clone().into_iter().collect();
    let mut how_many = String::new();
    if list.iter().map(|name| name.len() + ", ".len()).sum::<usize>() > FITS {
        how_many = format!("{}, such as ", list.len());
        list.sort_by(|a, b| strsim::jaro_winkler(given, b).total_cmp(&strsim::jaro_winkler(given, a)));
        list.truncate(SHOWN);
    }
    format!("{what}{} (there are {how_many}{})", of(given, known), list.join(", "))
}

/// An error, with the name that was meant where it is one of serde about a name: unknown field `relax`, expected one of
/// `order`, `relaxation`. Where none of these is, it may be the last part of one of the `keys` of a case.
pub(crate) fn in_error(text: &str, keys: impl Fn() -> Vec<String>) -> String {
    let unknown = Regex::new("(?s)^(.*unknown (?:field|variant) `([^`]*)`), expected (.*)$").ok();
    let Some((_, [before, given, known])) =
        unknown.and_then(|unknown| Some(unknown.captures(text)?.extract()))
    else {
        return text.to_owned();
    };
    // Between backticks is every second part.
    let nearest = of(given, known.split('`').skip(1).step_by(2));
    if !nearest.is_empty() {
        return format!("{before}{nearest} Expected {known}");
    }
    let lower = given.to_lowercase();
    let is_last =
        |key: &String| key.rsplit_once('.').is_some_and(|(_, last)| last == lower || means(&lower, last));
    let what = NOT_MODELLED.iter().find(|(name, _)| *name == lower).map(|(_, what)| (*what).to_owned());
    // That of the whole scene, where a wall has its own.
    let key = || keys().into_iter().filter(is_last).min_by_key(|key| key.matches('.').count());
    let of_case = || key().map(|key| format!("in a case it is `{key}`"));
    what.or_else(of_case)
        .map_or_else(|| text.to_owned(), |what| format!("{before}; {what}. Expected {known}"))
}

/// An error without the types of the program: what serde expects of a value, in the words of a file.
pub(crate) fn without_types(text: &str) -> String {
    // The name of a type follows its kind, as in: struct Stop with 3 elements.
    let types = "\\bexpected (a nonzero u32|f64|u8|u32|u64|usize|i64|\
                 (?:struct|tuple struct|internally tagged enum)(?: [[:alnum:]]+)?)\\b";
    let plain = |found: &Captures| match &found[1] {
        "a nonzero u32" => "expected a whole number from 1 to 4294967295",
        "f64" => "expected a number",
        "u8" => "expected a whole number from 0 to 255",
        "u32" => "expected a whole number from 0 to 4294967295",
        "i64" => "expected a whole number",
        word if word.starts_with("tuple") => "expected a list",
        word if word.starts_with("struct") || word.starts_with("internally") => "expected keys with values",
        _ => "expected a whole number, not negative",
    };
    Regex::new(types).map_or(text.to_owned(), |types| types.replace_all(text, plain).into_owned())
}
