//! The identity of a run: a hash of all that decides its counts.

use crate::plan::Variant;
use contact::{Measure, Stop};
use reference::InteriorPoint;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Versions of the code of the solver crates and of `cases`, from the build script.
const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Version of the code of the crate that a type comes from; `None` if it is none of those.
pub(crate) fn code_version<T>() -> Option<&'static str> {
    // Crates have dashes where their modules have underscores.
    let of_type = std::any::type_name::<T>().split("::").next()?.replace('_', "-");
    CODE_VERSIONS.iter().find(|(name, _)| *name == of_type).map(|(_, version)| *version)
}

/// The same id means the same counts: on any machine, with any number of threads.
pub(crate) fn run_id(problem_hash: &str, variant: &Variant, stop: &Stop) -> String {
    let Variant { method, warm_start, .. } = variant;
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    // What stops on the error needs the solution, and whether ζ lied is judged by it.
    let truth = matches!(stop.on, Measure::VelocityError | Measure::Zeta).then(code_version::<InteriorPoint>);
    let stop = (stop.on, stop.tolerance, stop.max_iterations);
    let all = json!([problem_hash, method.name, method.code, settings, stop, warm_start, truth]);
    first_hex(Sha256::digest(all.to_string()).as_slice())
}

/// Whether a text can be an id, or as much of its begin as is worth looking for.
pub(crate) fn is_id(text: &str) -> bool {
    (4..=16).contains(&text.len()) && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'))
}

/// The first eight bytes of a hash.
pub(crate) fn first_hex(hash: &[u8]) -> String {
    let first = hash.iter().take(8).fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    format!("{first:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::{METHODS, Method};

    fn nsgs(settings: &[(&str, &str)]) -> Variant {
        let settings: Vec<(String, String)> =
            settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        variant(Method::parse("nsgs", &settings).unwrap())
    }

    fn variant(method: Method) -> Variant {
        Variant { method, warm_start: false, name: String::new() }
    }

    #[test]
    fn defaults_spelled_out_do_not_change_the_id_and_every_part_does() {
        let stop = Stop::default();
        let id = |settings: &[(&str, &str)]| run_id("c0ffee", &nsgs(settings), &stop);
        let defaults = id(&[]);
        assert_eq!(defaults, id(&[("relaxation", "1.0")]));
        let changed = Method { code: "changed", ..nsgs(&[]).method };
        let others = [
            id(&[("relaxation", "1.5")]),
            run_id("decaf", &nsgs(&[]), &stop),
            run_id("c0ffee", &Variant { warm_start: true, ..nsgs(&[]) }, &stop),
            run_id("c0ffee", &nsgs(&[]), &Stop { tolerance: 1e-7, ..stop }),
            run_id("c0ffee", &nsgs(&[]), &Stop { max_iterations: 7, ..stop }),
            run_id("c0ffee", &variant(changed), &stop),
            run_id("c0ffee", &variant(Method::parse("jacobi", &[]).unwrap()), &stop),
        ];
        assert!(others.iter().all(|other| *other != defaults), "{others:?}");
    }

    #[test]
    fn every_method_has_the_version_of_its_own_crate() {
        let code = |name: &str| Method::parse(name, &[]).unwrap().code;
        for method in METHODS {
            assert_eq!(code(method.name).len(), 16);
        }
        assert_ne!(code("nsgs"), code("jacobi"));
        assert_ne!(code("nsgs"), code("nsgs-dd"));
    }
}
