//! The keys of a file as a table, from its schema: what each takes and means.

use serde_json::Value;

/// A row for each key of a schema, those of tables inside it below theirs: the key, what it takes, what it means.
pub(super) fn rows(schema: &Value) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    add(&mut rows, schema, "");
    rows
}

/// Returns every key of a case, such as `scene.friction`.
pub(crate) fn of_cases() -> Vec<String> {
    let rows = rows(&cases::schema::<cases::Case>()).into_iter();
    rows.filter_map(|row| row.into_iter().next()).map(|key| key.trim_matches('`').to_owned()).collect()
}

fn add(rows: &mut Vec<Vec<String>>, schema: &Value, path: &str) {
    let list = |schema: &Value, key: &str| schema[key].as_array().cloned().unwrap_or_default();
    let required = list(schema, "required");
    for (key, of) in schema["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let description = of["description"].clone();
        let mut of = present(of).clone();
        of["description"] = description;
        let left_out = match (required.iter().any(|name| name == key), &of["default"]) {
            (true, _) => String::new(),
            (false, Value::Null) => "; may be left out".to_owned(),
            (false, default) => format!("; {default} if left out"),
        };
        rows.push(vec![format!("`{path}`"), value(&of) + &left_out, meaning(&of)]);
        add(rows, &of, &path);
        // Of each table of a list.
        add(rows, &of["items"], &format!("{path}[]"));
        let kinds: Vec<Value> =
            list(&of, "oneOf").into_iter().filter(|one| one["properties"].is_object()).collect();
        for kind in &kinds {
            add_kind(rows, kind, &path);
        }
    }
}

/// One of the tables that a key may hold, told by the constant in it.
fn add_kind(rows: &mut Vec<Vec<String>>, schema: &Value, path: &str) {
    let mut schema = schema.clone();
    let Some(keys) = schema["properties"].as_object_mut() else { return };
    let Some((tag, name)) = keys.iter().find_map(|(key, of)| Some((key.clone(), of.get("const")?.clone())))
    else {
        return;
    };
    keys.remove(&tag);
    rows.push(vec![format!("`{path}.{tag} = {name}`"), "a table".to_owned(), meaning(&schema)]);
    add(rows, &schema, path);
}

/// Returns, in words, the values that a schema allows.
fn value(schema: &Value) -> String {
    let kinds = schema["oneOf"].as_array().into_iter().flatten();
    let [tables, names]: [usize; 2] =
        ["properties", "const"].map(|key| kinds.clone().filter(|kind| kind.get(key).is_some()).count());
    let items = &schema["items"];
    if schema["properties"].is_object() || tables > 0 {
        return "a table".to_owned();
    }
    if items.is_object() {
        let one = if items["items"].is_object() {
            match ["minItems", "maxItems"].map(|key| items[key].as_u64()) {
                [Some(2), Some(2)] => "pairs of numbers".to_owned(),
                [Some(n), Some(most)] if n < most => format!("{n} or {most} numbers each"),
                [Some(n), _] => format!("{n} numbers each"),
                [None, _] => "lists".to_owned(),
            }
        } else {
            // One of two types may be none.
            let or_null = if items["type"].is_array() { " or `null`" } else { "" };
            let one = value(items).trim_start_matches("a ").replacen("number", "numbers", 1);
            one.replacen("table", "tables", 1) + or_null
        };
        return format!("a list: {one}");
    }
    if let Some(only) = schema.get("const") {
        return format!("`{only}`");
    }
    // One that may be left out has two types, and the other is none.
    match schema["type"].as_str().or_else(|| schema["type"][0].as_str()) {
        Some("string") if names == 0 && schema.get("enum").is_none() => "a text".to_owned(),
        Some("object") => "a table".to_owned(),
        _ => takes(schema),
    }
}

/// The description; of a value that has a name, with what each name means.
fn meaning(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    let names = schema["oneOf"].as_array().into_iter().flatten().filter_map(|one| {
        Some(format!(" `{}`: {}", one.get("const")?.as_str()?, one["description"].as_str()?))
    });
    (text.to_owned() + &names.collect::<String>()).replace('\n', " ").replace('|', "\\|")
}

/// Returns the schema of a value that may be null, for where it is not; other schemas as they are.
fn present(schema: &Value) -> &Value {
    let mut several = schema["anyOf"].as_array().into_iter().flatten();
    several.find(|some| some["type"] != "null").unwrap_or(schema)
}

/// Returns, in words, the kind of value that the schema of a setting allows.
pub(crate) fn takes(setting: &Value) -> String {
    let setting = present(setting);
    if let Some(words) = setting["title"].as_str() {
        return words.to_owned();
    }
    let consts = setting["oneOf"].as_array().into_iter().flatten().map(|one| &one["const"]);
    let names = consts.chain(setting["enum"].as_array().into_iter().flatten());
    let names: Vec<&str> = names.filter_map(Value::as_str).collect();
    // One that may be left open has two types, and the other is none.
    match setting["type"].as_str().or_else(|| setting["type"][0].as_str()) {
        Some("number") => "a number".to_owned(),
        Some("integer") => "a whole number, not negative".to_owned(),
        Some("boolean") => "true or false".to_owned(),
        _ => names.join(", "),
    }
}
