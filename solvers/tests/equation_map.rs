//! The map of equations in `solvers/README.md`: its files exist and hold its items.

use std::fs;
use std::path::Path;

#[test]
fn every_row_of_the_map_of_equations_names_files_and_items_in_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = fs::read_to_string(folder.join("README.md")).unwrap();
    let rows: Vec<&str> =
        readme.lines().filter(|line| line.starts_with('|') && line.contains(".rs`")).collect();
    assert!(rows.len() > 20, "{} rows", rows.len());
    for row in rows {
        let [_, files, items] = row.trim_matches('|').split('|').collect::<Vec<_>>()[..] else {
            panic!("three columns: {row}")
        };
        let text =
            |file: &str| fs::read_to_string(folder.join(file)).unwrap_or_else(|_| panic!("{file}: {row}"));
        let code: String = quoted(files).map(text).collect();
        for item in quoted(items) {
            for name in item.split([':', '{', '}', ',', ' ']).filter(|name| !name.is_empty()) {
                let is_module = files.contains(&format!("/{name}.rs`"));
                assert!(is_module || declares(&code, name), "`{name}` is not in {files}");
            }
        }
    }
}

/// What stands between backquotes.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// Whether `code` has a function, a type or methods of a type of this name.
fn declares(code: &str, name: &str) -> bool {
    let has = |code: &str, word: &str| {
        let start = format!("{word} {name}");
        code.split(&start).skip(1).any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    // `impl` with parameters of its own stands apart from the name.
    let methods = code.lines().any(|line| line.starts_with("impl<") && has(line, ">"));
    ["fn", "struct", "enum", "trait", "impl"].into_iter().any(|word| has(code, word)) || methods
}
