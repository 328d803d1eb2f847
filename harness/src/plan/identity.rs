//! Versions of code, and hashes.

/// Versions of the code of the solver crates and of `cases`, from the build script.
const CODE_VERSIONS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/code_versions.rs"));

/// Version of the code of the crate that a type comes from; `None` if it is none of those.
pub(crate) fn code_version<T>() -> Option<&'static str> {
    // Crates have dashes where their modules have underscores.
    let of_type = std::any::type_name::<T>().split("::").next()?.replace('_', "-");
    CODE_VERSIONS.iter().find(|(name, _)| *name == of_type).map(|(_, version)| *version)
}

/// The first eight bytes of a hash.
pub(crate) fn first_hex(hash: &[u8]) -> String {
    let first = hash.iter().take(8).fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    format!("{first:016x}")
}
