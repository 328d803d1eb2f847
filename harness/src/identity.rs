//! The identity of a run: a hash of all that decides its counts.

use crate::methods::Method;
use contact::{Measure, Stop};
use reference::InteriorPoint;
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Versions of the solver crates' code, from the build script.
const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Version of the code of the crate that a type comes from; `None` if it is no solver crate.
pub(crate) fn code_version<T>() -> Option<&'static str> {
    // Crates have dashes where their modules have underscores.
    let of_type = std::any::type_name::<T>().split("::").next()?.replace('_', "-");
    CODE_VERSIONS.iter().find(|(name, _)| *name == of_type).map(|(_, version)| *version)
}

/// The same id means the same counts: on any machine, with any number of threads.
pub(crate) fn run_id(problem_hash: &str, method: &Method, stop: &Stop, warm_start: bool) -> String {
    // Sorted, whatever the map of the JSON crate does with its keys.
    let settings: BTreeMap<_, _> = method.settings.iter().collect();
    // What stops on the error needs the solution, and whether ζ lied is judged by it.
    let truth = matches!(stop.on, Measure::VelocityError | Measure::Zeta).then(code_version::<InteriorPoint>);
    let stop = (stop.on, stop.tolerance, stop.max_iterations);
    let all = json!([problem_hash, method.name, method.code, settings, stop, warm_start, truth]);
    first_hex(Sha256::digest(all.to_string()).as_slice())
}

/// The first eight bytes of a hash.
pub(crate) fn first_hex(hash: &[u8]) -> String {
    let first = hash.iter().take(8).fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    format!("{first:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::METHODS;

    fn id(settings: &[(&str, &str)]) -> String {
        let settings: Vec<(String, String)> =
            settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        run_id("c0ffee", &Method::parse("nsgs", &settings).unwrap(), &Stop::default(), false)
    }

    #[test]
    fn defaults_spelled_out_do_not_change_the_id_and_every_part_does() {
        let defaults = id(&[]);
        assert_eq!(defaults, id(&[("relaxation", "1.0")]));
        let nsgs = Method::parse("nsgs", &[]).unwrap();
        let stop = Stop::default();
        let others = [
            id(&[("relaxation", "1.5")]),
            run_id("decaf", &nsgs, &stop, false),
            run_id("c0ffee", &nsgs, &stop, true),
            run_id("c0ffee", &nsgs, &Stop { tolerance: 1e-7, ..stop }, false),
            run_id("c0ffee", &nsgs, &Stop { max_iterations: 7, ..stop }, false),
            run_id(
                "c0ffee",
                &Method { code: "changed", ..Method::parse("nsgs", &[]).unwrap() },
                &stop,
                false,
            ),
            run_id("c0ffee", &Method::parse("jacobi", &[]).unwrap(), &stop, false),
        ];
        assert!(others.iter().all(|other| *other != defaults), "{others:?}");
    }

    #[test]
    fn every_method_has_the_version_of_its_own_crate() {
        let code = |name: &str| Method::parse(name, &[]).unwrap().code;
        for method in METHODS {
            assert_eq!(code(method.name).len(), 16);
        }
        assert_eq!(code("nsgs"), code("jacobi"));
        assert_ne!(code("nsgs"), code("nsgs-dd"));
    }
}
