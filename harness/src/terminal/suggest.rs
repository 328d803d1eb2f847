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

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[test]
    fn most_similar_name_is_meant_if_any_is_similar() {
        let known = ["order", "relaxation", "seed", "symmetric"];
        assert_eq!(of("relax", known), "; did you mean `relaxation`?");
        assert_eq!(of("sede", known), "; did you mean `seed`?");
        assert_eq!(of("kappa", known), "");
        assert_eq!(of("", known), "");
        assert_eq!(of("seed", []), "");
    }

    #[test]
    fn name_of_another_code_means_the_key_that_is_known_here() {
        assert_eq!(of("omega", ["order", "relaxation"]), "; did you mean `relaxation`?");
        assert_eq!(of("ω", ["order", "relaxation"]), "; did you mean `relaxation`?");
        assert_eq!(of("tol", ["on", "tolerance"]), "; did you mean `tolerance`?");
        assert_eq!(of("dt", ["law", "time_step_s"]), "; did you mean `time_step_s`?");
        assert_eq!(of("omega", ["order", "seed"]), "", "it is no key here");
    }

    #[test]
    fn name_that_was_meant_stands_before_the_list() {
        let known = ["order", "relaxation"];
        let told = "no key `relax`; did you mean `relaxation`? (there are order, relaxation)";
        assert_eq!(among("no key `relax`", "relax", known), told);
        assert_eq!(among("no key `x`", "x", known), "no key `x` (there are order, relaxation)");
    }

    #[test]
    fn error_of_serde_names_no_type_of_the_program() {
        let plain = |error: serde_json::Error| without_types(&error.to_string());
        let text = plain(serde_json::from_str::<f64>("[]").unwrap_err());
        assert!(text.starts_with("invalid type: sequence, expected a number at line 1"), "{text}");
        let text = plain(serde_json::from_str::<One>("3").unwrap_err());
        assert!(text.starts_with("invalid type: integer `3`, expected keys with values at line 1"), "{text}");
        let text = plain(serde_json::from_str::<One>("[]").unwrap_err());
        assert!(text.starts_with("invalid length 0, expected keys with values with 1 element"), "{text}");
        assert_eq!(without_types("expected f64s, or expected"), "expected f64s, or expected");
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct One {
        #[allow(dead_code)]
        preconditioner: Law,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Law {
        PredictedGap,
        Iqs,
    }

    #[test]
    fn errors_of_serde_tell_what_was_given_and_what_is_known() {
        let error = |text: &str| toml::from_str::<One>(text).unwrap_err().to_string().trim_end().to_owned();
        let meant = |error: &str, expected: &str| {
            let told = in_error(error);
            assert!(
                told.contains(expected) && told.starts_with(error.split("`, ").next().unwrap()),
                "{told}"
            );
        };
        meant(
            &error("precondition = 1"),
            "`precondition`; did you mean `preconditioner`? Expected `preconditioner`",
        );
        let variant = error("preconditioner = \"predicted-gp\"");
        meant(&variant, "`predicted-gp`; did you mean `predicted-gap`? Expected `predicted-gap` or `iqs`");
        meant(&error("mu = 0.3"), "`mu`; contacts here are without friction");
        for none in ["preconditioner = \"hertz\"", "preconditioner = 1"] {
            assert_eq!(in_error(&error(none)), error(none));
        }
        let json = serde_json::from_str::<One>("{\"preconditionr\": \"iqs\"}").unwrap_err().to_string();
        meant(&json, "; did you mean `preconditioner`? Expected `preconditioner`");
    }
}
