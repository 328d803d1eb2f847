//! Inputs of ids: versions of code; and the provenance of rows.

use anyhow::Result;
use results::schema::Provenance;
use std::sync::OnceLock;

/// Commit of the build, which the program says as it starts.
static COMMIT: OnceLock<&str> = OnceLock::new();

/// Versions of the code of the solver crates and of `cases`, from the build script.
const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Returns the version of the code of a crate; `None` if it is none of those.
pub(crate) fn code_version(of: &str) -> Option<&'static str> {
    CODE_VERSIONS.iter().find(|(name, _)| *name == of).map(|(_, version)| *version)
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
