//! JSON and the texts that files hold, read so that errors name the key, the index and the value.

use crate::error::CaseError;
use crate::file::gzip::opened;
use crate::file::keys::{LACKS, all_missing_of, schema};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// Reads the text of a file, in UTF-8, compressed by gzip or not, without the mark that some editors write before it.
///
/// # Errors
/// Names the file, and the byte that belongs to no text.
pub fn read_text(path: &Path) -> Result<String, CaseError> {
    let bytes = std::fs::read(path).map_err(|source| CaseError::File { path: path.to_owned(), source })?;
    let bytes = opened(bytes).map_err(|message| CaseError::content(path, message))?;
    if bytes.starts_with(HDF5) {
        let is = "it is an HDF5 file, and its name must end in .hdf5 or .h5, as those of FCLIB do";
        return Err(CaseError::content(path, is));
    }
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let (bytes, at) = (error.as_bytes(), error.utf8_error().valid_up_to());
        let line = bytes[..at].split(|byte| *byte == b'\n').count();
        let is = if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            "it is text in UTF-16"
        } else {
            "it is no text in UTF-8"
        };
        let byte = bytes[at];
        CaseError::content(path, format!("{is}, by the byte 0x{byte:02x} on line {line}: save it in UTF-8"))
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len_utf8());
    }
    Ok(text)
}

/// First bytes of every HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

const BYTE_ORDER_MARK: char = '\u{feff}';

/// Reads a `T` from JSON.
///
/// # Errors
/// Names what is no JSON, else the keys that are missing, else the key and the index of the first wrong value.
pub fn of_json<T: DeserializeOwned + JsonSchema>(text: &str) -> Result<T, String> {
    of_json_with_keys(text, schema::<T>, |_| true)
}

/// Reads a `T` from JSON, whose keys are those of a schema, as its value says whether it `has_keys`.
///
/// # Errors
/// Those of [`of_json`].
pub(crate) fn of_json_with_keys<T: DeserializeOwned>(
    text: &str,
    schema: impl Fn() -> Value,
    has_keys: impl Fn(&T) -> bool,
) -> Result<T, String> {
    let read = with_key(text).and_then(|read| if has_keys(&read) { Ok(read) } else { Err(LACKS.to_owned()) });
    read.map_err(|error| match with_key::<Value>(text) {
        // A text that is no JSON lacks more than keys.
        Err(broken) => broken,
        Ok(content) => all_missing_of(&schema(), &content, error),
    })
}

/// Returns what is wrong with a text that is no JSON.
pub(crate) fn broken(text: &str) -> Option<String> {
    with_key::<Value>(text).err()
}

fn with_key<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    let mut json = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let (path, error) = (error.path().to_string(), error.inner());
        // "?" is a key that was not read.
        let key = path.strip_suffix('?').unwrap_or(&path).trim_end_matches('.');
        let key = if key.is_empty() { String::new() } else { format!("`{key}`") };
        if let Some(word) = infinite_or_undefined(text, error) {
            let (line, column) = (error.line(), error.column());
            return format!("{key} is {word}, line {line} column {column}: a finite number is expected")
                .trim_start()
                .to_owned();
        }
        let colon = if key.is_empty() { "" } else { ": " };
        let ends =
            if error.is_eof() { ", where the file ends: write or copy the whole of it again" } else { "" };
        format!("{key}{colon}{error}{ends}")
    })?;
    json.end().map_err(|error| error.to_string())?;
    Ok(value)
}

/// Returns the word at which reading failed, where it is one that Python and others write for what JSON has no number for.
fn infinite_or_undefined<'t>(text: &'t str, error: &serde_json::Error) -> Option<&'t str> {
    let line = text.split('\n').nth(error.line().checked_sub(1)?)?;
    let (before, after) = line.split_at_checked(error.column().checked_sub(1)?)?;
    let is_outside = |c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '+');
    let start = before.rfind(is_outside).map_or(0, |at| at + 1);
    let end = before.len() + after.find(is_outside).unwrap_or(after.len());
    let word = line.get(start..end)?;
    let size = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    matches!(size.as_str(), "nan" | "inf" | "infinity").then_some(word)
}
