//! "Did you mean …?", for every unknown name.

/// Names that are less alike than this are not meant for each other (Jaro and Winkler's similarity, 1 for equal names).
const ALIKE: f64 = 0.8;

/// The end of an error about the unknown name `given`: the most similar of the `known` ones, if any is.
pub(crate) fn of<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let alike = known.into_iter().map(|known| (strsim::jaro_winkler(given, known), known));
    let nearest = alike.filter(|(alike, _)| *alike >= ALIKE).max_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map_or_else(String::new, |(_, nearest)| format!("; did you mean `{nearest}`?"))
}

/// The same for an error of serde, which ends in: unknown field `relax`, expected one of `order`, `relaxation`.
pub(crate) fn in_error(text: &str) -> String {
    let unknown = ["unknown field `", "unknown variant `"].iter().find_map(|start| text.rsplit_once(start));
    let named = unknown.and_then(|(_, rest)| rest.split_once("`, expected "));
    // Between backticks is every second part.
    named.map_or_else(String::new, |(given, known)| of(given, known.split('`').skip(1).step_by(2)))
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
        let error = |text: &str| toml::from_str::<One>(text).unwrap_err().to_string();
        assert_eq!(in_error(error("precondition = 1").trim_end()), "; did you mean `preconditioner`?");
        let variant = error("preconditioner = \"predicted-gp\"");
        assert_eq!(in_error(variant.trim_end()), "; did you mean `predicted-gap`?");
        assert_eq!(in_error(error("preconditioner = \"hertz\"").trim_end()), "");
        assert_eq!(in_error(error("preconditioner = 1").trim_end()), "");
        let json = serde_json::from_str::<One>("{\"preconditionr\": \"iqs\"}").unwrap_err().to_string();
        assert_eq!(in_error(&json), "; did you mean `preconditioner`?");
    }
}
