//! All missing keys of a file at once: readers of JSON and TOML stop at the first.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde::Serialize;
use serde_json::Value;

/// The schema of a type, with every type where it is used.
pub fn schema<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    SchemaGenerator::new(settings).into_root_schema_for::<T>().to_value()
}

/// The `error` of whoever tried to read a `T` from `content`. If what is wrong are its keys: all that it lacks, all that in it
/// should be a table, and the first that has no meaning, so that nobody has to try once for each.
pub fn all_missing<T: JsonSchema>(content: &impl Serialize, error: String) -> String {
    match serde_json::to_value(content) {
        Ok(content) => all_missing_of(&schema::<T>(), &content, error),
        Err(_) => error,
    }
}

/// The words of serde about a missing key.
pub(crate) const LACKS: &str = "missing field";

/// The `error` about a `content` that a schema describes, as [`all_missing`] has it.
pub(crate) fn all_missing_of(schema: &Value, content: &Value, error: String) -> String {
    let mut lacks = Lacks::default();
    lacks.look(schema, content, "");
    let missing = match lacks.keys.as_slice() {
        [] => None,
        [key] => Some(format!("missing key `{key}`")),
        keys => Some(format!("missing keys: `{}`", keys.join("`, `"))),
    };
    let mut wrong = lacks.tables;
    let is_unknown = error.contains("unknown field");
    if is_unknown {
        wrong.insert(0, error.trim_end().to_owned());
    } else if wrong.is_empty() && !error.contains(LACKS) {
        return error;
    }
    wrong.extend(missing);
    wrong.extend(lacks.unknown.filter(|_| !is_unknown));
    if wrong.is_empty() { error } else { wrong.join("; ") }
}

#[derive(Default)]
struct Lacks {
    keys: Vec<String>,
    /// Messages about values that should have been tables.
    tables: Vec<String>,
    /// The first key that is none, in the words of serde.
    unknown: Option<String>,
}

impl Lacks {
    /// Checks `value`, which stands at `path`.
    fn look(&mut self, schema: &Value, value: &Value, path: &str) {
        let list = |key: &str| schema[key].as_array().map_or(&[] as &[Value], Vec::as_slice);
        // What may be left out is there or null.
        if let Some(some) = list("anyOf").iter().find(|schema| schema["properties"].is_object()) {
            if !value.is_null() {
                self.look(some, value, path);
            }
            return;
        }
        if let Some(first) = list("oneOf").first().filter(|schema| schema["properties"].is_object()) {
            let tag = |schema: &Value| {
                let properties = schema["properties"].as_object()?;
                properties.iter().find_map(|(key, of)| Some((key.clone(), of.get("const")?.clone())))
            };
            let chosen = |schema: &&Value| tag(schema).is_some_and(|(key, name)| value[&key] == name);
            let without_tag = serde_json::json!({
                "properties": {},
                "required": tag(first).map(|(key, _)| vec![key]).unwrap_or_default()
            });
            return self.look(list("oneOf").iter().find(chosen).unwrap_or(&without_tag), value, path);
        }
        if let (true, Some(items)) = (schema["items"].is_object(), value.as_array()) {
            for (index, item) in items.iter().enumerate() {
                self.look(&schema["items"], item, &format!("{path}[{index}]"));
            }
        }
        let Some(properties) = schema["properties"].as_object() else { return };
        if value.is_null() && list("type").iter().any(|kind| kind == "null") {
            return;
        }
        let Some(table) = value.as_object() else {
            let place = if path.is_empty() { "the file".to_owned() } else { format!("`{path}`") };
            let mut keys: Vec<&str> = list("required").iter().filter_map(Value::as_str).collect();
            if keys.is_empty() {
                keys = properties.keys().map(String::as_str).collect();
            }
            let keys = keys.join("`, `");
            self.tables.push(format!("{place} holds {}: it must hold the keys `{keys}`", kind(value)));
            return;
        };
        let at = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        let required = list("required").iter().filter_map(Value::as_str);
        self.keys.extend(required.filter(|key| !table.contains_key(*key)).map(at));
        for (key, value) in table {
            match properties.get(key) {
                Some(schema) => self.look(schema, value, &at(key)),
                None if schema["additionalProperties"] == false && self.unknown.is_none() => {
                    let known = properties.keys().map(String::as_str).collect::<Vec<_>>().join("`, `");
                    let key = at(key);
                    self.unknown = Some(format!("unknown field `{key}`, expected one of `{known}`"));
                }
                None => {}
            }
        }
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Array(_) => "a list",
        Value::String(_) => "a text",
        Value::Number(_) => "a number",
        Value::Bool(_) => "true or false",
        Value::Null => "nothing",
        Value::Object(_) => "a table",
    }
}
