//! Impulses that another code, or another run, gave.

use crate::terminal::{read_text, suggest};
use anyhow::{Result, anyhow, bail};
use cases::of_json;
use lineup::Facts;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Impulses that another code, or another run, gave.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// Impulses in the problem's contact order, a flat list (N·s).
    pub(crate) impulse: Vec<f64>,
    /// Source of the impulses.
    pub(crate) from: String,
}

/// The file, with a number or a list of them for each contact.
#[derive(JsonSchema, Deserialize)]
struct Read<T> {
    impulse: Vec<T>,
    #[serde(default)]
    from: String,
}

impl Given {
    /// Reads a file with `{"impulse": […]}`; whatever else it holds is left aside. Where a contact has several numbers, they stand one
    /// after the other, or each contact has a list of its own.
    pub(crate) fn read(file: &Path, facts: &Facts) -> Result<Self> {
        let name = || file.display().to_string();
        let text = read_text(file)?;
        let (each, contacts) = (facts.of_contact, facts.contacts);
        let in_lists = || {
            let Read { impulse, from } = of_json::<Read<Vec<f64>>>(&text)?;
            let wrong = impulse.iter().enumerate().find(|(_, list)| list.len() != each);
            if let Some((index, list)) = wrong {
                let found = list.len();
                return Err(format!(
                    "`impulse[{index}]` has {found} values where each of {contacts} contacts has {each}"
                ));
            }
            Ok(Read { impulse: impulse.concat(), from })
        };
        let flat = of_json::<Read<f64>>(&text).or_else(|error| {
            let is_in_lists = each > 1 && error.contains("invalid type: sequence");
            if is_in_lists { in_lists() } else { Err(error) }
        });
        let Read { impulse, from } = flat.map_err(|error| anyhow!("{}: {}", name(), meant(&text, error)))?;
        let (found, expected) = (impulse.len(), each * contacts);
        if found != expected {
            let each =
                if expected == contacts { String::new() } else { format!(", {expected} values in all") };
            bail!("{}: `impulse` has {found} values where the problem has {contacts} contacts{each}", name());
        }
        Ok(Self { impulse, from })
    }
}

/// The `error` about a file of impulses with this text, with the key that stands in the place of `impulse`, or with the form of the file
/// where it is no JSON.
fn meant(text: &str, error: String) -> String {
    let Ok(content) = serde_json::from_str::<Value>(text) else {
        return format!(
            "{error}; impulses are read from a file with {{\"impulse\": […]}}, as `gravel solve --impulses` writes it"
        );
    };
    let meant = |key: &&String| *key != "impulse" && !suggest::of(key, ["impulse"]).is_empty();
    let meant = content.as_object().and_then(|content| content.keys().find(meant));
    let meant = meant.map(|key| format!(": `{key}` is no key{}", suggest::of(key, ["impulse"])));
    error + &meant.unwrap_or_default()
}
