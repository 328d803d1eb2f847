//! Inputs of ids: versions of code and hashes of problems; and the provenance of rows.

use crate::problems::Studied;
use anyhow::Result;
use cases::Frozen;
use contact::Vector;
use local::LocalProblem;
use results::schema::Provenance;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::sync::OnceLock;

/// Commit of the build, which the program says as it starts.
static COMMIT: OnceLock<&str> = OnceLock::new();

/// Versions of the code of the solver crates and of `cases`, from the build script.
const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Version of the code of the crate that a type comes from; `None` if it is none of those.
pub(crate) fn code_version<T>() -> Option<&'static str> {
    // Crates have dashes where their modules have underscores.
    let of_type = std::any::type_name::<T>().split("::").next()?.replace('_', "-");
    CODE_VERSIONS.iter().find(|(name, _)| *name == of_type).map(|(_, version)| *version)
}

/// Takes the commit of the build.
pub(crate) fn built_from(commit: &'static str) {
    COMMIT.get_or_init(|| commit);
}

/// This build, on this machine.
pub(crate) fn provenance() -> Result<Provenance> {
    let rustc = rustc_version_runtime::version().to_string();
    let commit = COMMIT.get().copied().unwrap_or("not built as a program");
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    Ok(Provenance::gather(commit, &rustc, profile, rayon::current_num_threads() as u32)?)
}

/// Hash of all that something depends on.
pub(crate) fn hash_of(all: &Value) -> String {
    first_hex(&Sha256::digest(all.to_string()))
}

/// The first eight bytes of a hash.
fn first_hex(hash: &[u8]) -> String {
    let first = hash.iter().take(8).fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    format!("{first:016x}")
}

/// Hash of a problem that is W alone, and of the code of the methods for such: that of methods for grains is another.
pub(crate) fn hash_of_w(problem: &LocalProblem) -> String {
    let mut hash = Sha256::new();
    let mut number = |x: f64| hash.update(x.to_bits().to_le_bytes());
    number(problem.dimension() as f64);
    number(problem.contact_count() as f64);
    problem.q().iter().chain(problem.friction()).for_each(|x| number(*x));
    for (row, column, value) in problem.entries() {
        [row as f64, column as f64, value].into_iter().for_each(&mut number);
    }
    hash.update(code_version::<LocalProblem>().unwrap_or_default());
    first_hex(hash.finalize().as_slice())
}

/// Hash of everything that a method sees: two problems with the same hash are the same problem.
pub(crate) fn content_hash<M: Studied>(frozen: &Frozen<M>) -> String {
    let mut hash = Sha256::new();
    let mut number = |x: f64| hash.update(x.to_bits().to_le_bytes());
    let problem = &frozen.problem;
    // The lengths first: no two problems are the same numbers otherwise cut.
    number(problem.grain_count() as f64);
    number(problem.contact_count() as f64);
    problem.mass().iter().for_each(|m| number(M::weight(*m)));
    problem.position().iter().for_each(|x| x.each(&mut number));
    problem.free_velocity().iter().for_each(|v| v.each(&mut number));
    M::numbers(problem, &mut number);
    frozen.start.iter().for_each(|r| number(*r));
    first_hex(hash.finalize().as_slice())
}
