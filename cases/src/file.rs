//! Texts, JSON and names of files, whose errors name the key, the index and the value.

pub(crate) mod gzip;
pub(crate) mod json;
pub(crate) mod keys;
pub(crate) mod values;

/// Refuses a `name` that would lead elsewhere where files are named after it.
///
/// # Errors
/// Names it, and says what would be accepted.
pub fn check_name(name: &str) -> Result<(), String> {
    let leads_elsewhere = |c: char| "/\\:".contains(c) || c.is_control();
    if name.is_empty() || name.starts_with('.') || name.contains(leads_elsewhere) {
        return Err(format!(
            "`name` is {name:?}: files are named after it, so it must not be empty, start with a dot, or have /, \\ or : in it"
        ));
    }
    Ok(())
}
