//! "Did you mean …?", for every unknown name.

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

/// An error about the unknown name `given`, which `what` tells: the one that was meant, if any, then all the `known` ones.
pub(crate) fn among<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let list: Vec<&str> = known.clone().into_iter().collect();
    format!("{what}{} (there are {})", of(given, known), list.join(", "))
}

/// An error, with the name that was meant where it is one of serde about a name: unknown field `relax`, expected one of
/// `order`, `relaxation`.
pub(crate) fn in_error(text: &str) -> String {
    let unknown = |start: &str| text.rfind(start).map(|at| at + start.len());
    let named = ["unknown field `", "unknown variant `"].into_iter().find_map(unknown);
    let Some((given, known)) = named.and_then(|at| text[at..].split_once("`, expected ")) else {
        return text.to_owned();
    };
    // Between backticks is every second part.
    let nearest = match of(given, known.split('`').skip(1).step_by(2)) {
        nothing if nothing.is_empty() && NOT_MODELLED.contains(&given) => {
            "; contacts here are without friction, restitution and cohesion, grains do not turn".to_owned()
        }
        nearest => nearest,
    };
    let before = &text[..text.len() - known.len() - "`, expected ".len()];
    if nearest.is_empty() { text.to_owned() } else { format!("{before}`{nearest} Expected {known}") }
}

/// An error without the types of the program: what serde expects of a value, in the words of a file.
pub(crate) fn without_types(text: &str) -> String {
    const WORDS: [(&str, &str); 10] = [
        ("f64", "a number"),
        ("u8", "a whole number"),
        ("u32", "a whole number, not negative"),
        ("u64", "a whole number, not negative"),
        ("usize", "a whole number, not negative"),
        ("i64", "a whole number"),
        ("a nonzero u32", "a whole number above 0"),
        ("struct", "keys with values"),
        ("internally tagged enum", "keys with values"),
        ("tuple struct", "a list"),
    ];
    let (known, last) = ("expected ", text.split("expected ").count());
    let parts = text.split(known).enumerate().map(|(n, part)| {
        let starts = |word: &str| {
            part.strip_prefix(word)
                .filter(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        let word =
            WORDS.iter().filter(|_| n > 0).find_map(|(word, plain)| Some((starts(word)?, *word, plain)));
        let part = word.map_or(part.to_owned(), |(rest, word, plain)| {
            // The name of the type, as in: struct Stop with 3 elements.
            let names = word.ends_with("struct") || word.ends_with("enum");
            let rest = if names { rest.trim_start().trim_start_matches(char::is_alphanumeric) } else { rest };
            format!("{plain}{rest}")
        });
        if n + 1 < last { part + known } else { part }
    });
    parts.collect()
}
