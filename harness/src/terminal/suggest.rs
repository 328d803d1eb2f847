//! "Did you mean …?", for every unknown name. Errors of serde are read as texts, since serde hands on nothing else of them.

/// Names that are less alike than this are not meant for each other (Jaro and Winkler's similarity, 1 for equal names).
const ALIKE: f64 = 0.8;

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

/// An error about the unknown name `given`, which `what` describes: the one that was meant, if any, then all the `known` ones.
pub(crate) fn among<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let list: Vec<&str> = known.clone().into_iter().collect();
    format!("{what}{} (there are {})", of(given, known), list.join(", "))
}

/// An error, with the name that was meant where it is one of serde about a name: unknown field `relax`, expected one of
/// `order`, `relaxation`. Where none of these is, it may be the last part of one of the `keys` of a case.
pub(crate) fn in_error(text: &str, keys: impl Fn() -> Vec<String>) -> String {
    let Some((before, given, known)) = unknown(text) else { return text.to_owned() };
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

/// Returns an error up to the unknown name, that name, and the known ones.
fn unknown(text: &str) -> Option<(&str, &str, &str)> {
    let ends = ["unknown field `", "unknown variant `"].map(|kind| Some(text.rfind(kind)? + kind.len()));
    let from = ends.into_iter().flatten().max()?;
    let given = text[from..].split('`').next()?;
    let (before, known) = text.split_at_checked(from + given.len() + 1)?;
    Some((before, given, known.strip_prefix(", expected ")?))
}

/// Types in errors of serde, in the words of a file; the name of a type follows its kind, as in: struct Stop with 3 elements.
const TYPES: [(&str, &str); 10] = [
    ("a nonzero u32", "a whole number from 1 to 4294967295"),
    ("f64", "a number"),
    ("u8", "a whole number from 0 to 255"),
    ("u32", "a whole number from 0 to 4294967295"),
    ("i64", "a whole number"),
    ("u64", "a whole number, not negative"),
    ("usize", "a whole number, not negative"),
    ("struct", "keys with values"),
    ("tuple struct", "a list"),
    ("internally tagged enum", "keys with values"),
];

/// An error without the types of the program: what serde expects of a value, in the words of a file.
pub(crate) fn without_types(text: &str) -> String {
    let plain = |piece: &str| {
        TYPES.iter().find_map(|(of, words)| {
            let rest = piece.strip_prefix(of)?;
            let named = rest.strip_prefix(' ').filter(|_| of.ends_with("struct") || of.ends_with("enum"));
            let rest = named.map_or(rest, |named| named.trim_start_matches(char::is_alphanumeric));
            (!rest.starts_with(char::is_alphanumeric)).then(|| format!("{words}{rest}"))
        })
    };
    let pieces = text.split("expected ").enumerate();
    let pieces = pieces.map(|(n, piece)| plain(piece).filter(|_| n > 0).unwrap_or_else(|| piece.to_owned()));
    pieces.collect::<Vec<_>>().join("expected ")
}
