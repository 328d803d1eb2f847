//! Folders of cases, frozen problems and plans, and the search in them for a name or a path.

use crate::exchange::is_foreign;
use crate::terminal::{read_text, suggest};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// The checkout, if there is one: a problem, a case or a schema needs none.
pub(crate) struct Root(Option<PathBuf>);

/// Names of plans that others have taken in, and of these.
const MERGED: [(&str, &str); 7] = [
    ("derived-direction", "search-directions"),
    ("search-directions-3d", "search-directions"),
    ("scaling-3d", "scaling"),
    ("paper-3d", "beyond-paper"),
    ("friction", "beyond-paper"),
    ("dimensions", "beyond-paper"),
    ("newton-schur", "interface"),
];
const NO_CHECKOUT: &str = "no folder from here up holds cases/frozen and harness/plans: run gravel in its checkout or in a folder that `gravel init` made, or give --root DIR or GRAVEL_ROOT";

/// Kind of a file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Case,
    Plan,
    Frozen,
    /// Problem of another code.
    Foreign,
    /// Description of another code.
    External,
}

impl Root {
    /// Returns the folder of `--root`, or of `GRAVEL_ROOT`, or the nearest one from the current folder up that holds cases and plans.
    pub(crate) fn find(given: Option<PathBuf>) -> Result<Self> {
        let of_environment =
            || std::env::var_os("GRAVEL_ROOT").filter(|root| !root.is_empty()).map(PathBuf::from);
        let given = given.or_else(of_environment);
        let is_root =
            |folder: &Path| folder.join("cases/frozen").is_dir() && folder.join("harness/plans").is_dir();
        if let Some(folder) = given {
            if !is_root(&folder) {
                bail!(
                    "{}: this folder, of --root or GRAVEL_ROOT, has no cases/frozen and harness/plans",
                    folder.display()
                );
            }
            return Ok(Self(Some(folder)));
        }
        // A relative path keeps what is printed short.
        let mut folder = PathBuf::from(".");
        for _ in std::env::current_dir()?.ancestors() {
            if is_root(&folder) {
                return Ok(Self(Some(folder.strip_prefix(".").map_or(folder.clone(), Path::to_owned))));
            }
            folder.push("..");
        }
        Ok(Self(None))
    }

    /// Itself, for what only a checkout has.
    pub(crate) fn needed(&self) -> Result<&Self> {
        if self.0.is_none() {
            bail!("{NO_CHECKOUT}");
        }
        Ok(self)
    }

    /// A path inside the checkout, or else from the current folder.
    pub(crate) fn join(&self, path: &str) -> PathBuf {
        self.0.as_deref().unwrap_or(Path::new("")).join(path)
    }

    /// The file for what is kept in a folder of the checkout to save time; nothing is kept elsewhere.
    pub(crate) fn kept(&self, folder: &str, file: &str) -> Option<PathBuf> {
        self.0.as_ref().map(|root| root.join(folder).join(file))
    }

    /// Paths of all files of a kind, by name.
    pub(crate) fn all(&self, kind: Kind) -> Result<Vec<PathBuf>> {
        if self.0.is_none() {
            return Ok(Vec::new());
        }
        let (_, folder, ending) = kind.words();
        let folder = self.join(folder);
        if matches!(kind, Kind::Foreign | Kind::External) && !folder.is_dir() {
            return Ok(Vec::new());
        }
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let path = entry.with_context(|| folder.display().to_string())?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // The folder of the cases is a crate too; an answer that another code gave lies beside its problem.
            if name.ends_with(ending) && name != "Cargo.toml" && !name.ends_with(".solution.json") {
                paths.push(path);
            }
        }
        paths.sort();
        Ok(paths)
    }

    /// The file of a case, given by name or path.
    pub(crate) fn case(&self, name: &str) -> Result<PathBuf> {
        self.file(name, "case", &[Kind::Case])
    }

    /// The file of a plan, given by name or path.
    pub(crate) fn plan(&self, name: &str) -> Result<PathBuf> {
        let file = self.file(name, "plan", &[Kind::Plan]);
        match MERGED.iter().find(|(old, _)| *old == name) {
            Some((_, plan)) => file.with_context(|| format!("`{name}` is part of the plan `{plan}` now")),
            None => file,
        }
    }

    /// The file of a frozen problem, given by name or path.
    pub(crate) fn problem(&self, name: &str) -> Result<PathBuf> {
        self.file(name, "frozen problem", &[Kind::Frozen])
    }

    /// The file of a frozen problem, or of a problem of another code, given by name or path.
    pub(crate) fn any_problem(&self, name: &str) -> Result<PathBuf> {
        self.file(name, "problem", &[Kind::Frozen, Kind::Foreign])
    }

    /// The file of a frozen problem or a case, given by name or path.
    pub(crate) fn problem_or_case(&self, name: &str) -> Result<PathBuf> {
        self.file(name, "problem or case", &[Kind::Case, Kind::Frozen])
    }

    /// Finds the file of a frozen problem, a case or a problem of another code, given by name or path.
    pub(crate) fn any_problem_or_case(&self, name: &str) -> Result<PathBuf> {
        self.file(name, "problem or case", &[Kind::Case, Kind::Frozen, Kind::Foreign])
    }

    /// Returns the file of a problem of a collection by its id: one that is stored there or was made, a frozen problem, or a file of
    /// another code.
    pub(crate) fn collected(&self, collection: &Path, id: &str) -> Option<PathBuf> {
        if !is_id(id) {
            return None;
        }
        let name = format!("{id}.json.gz");
        let mut files =
            vec![collection.join("problems").join(&name), self.join("results/problems").join(name)];
        let entry = read_text(&collection.join("entries").join(format!("{id}.toml"))).ok()?;
        let entry: toml::Table = entry.parse().ok()?;
        let text = |value: Option<&toml::Value>| Some(value?.as_str()?.to_owned());
        let frozen = text(entry.get("name")).map(|name| format!("cases/frozen/{name}.json"));
        let foreign = entry.get("foreign").and_then(|foreign| text(foreign.get("file")));
        let foreign = foreign.map(|file| format!("cases/foreign/{file}"));
        files.extend(frozen.into_iter().chain(foreign).map(|file| self.join(&file)));
        files.into_iter().find(|file| file.is_file())
    }

    /// Finds a file of this name that is of none of the `wanted` kinds; a path is no name.
    fn of_another_kind(&self, name: &str, wanted: &[Kind]) -> Result<Option<(Kind, PathBuf)>> {
        for kind in [Kind::Case, Kind::Plan, Kind::Frozen, Kind::Foreign] {
            if wanted.contains(&kind) || Path::new(name).exists() {
                continue;
            }
            if let Some(path) = self.all(kind)?.into_iter().find(|path| stem(path) == name) {
                return Ok(Some((kind, path)));
            }
        }
        Ok(None)
    }

    /// The file with this name or path, which holds one of the `wanted` kinds: `what`, in words.
    fn file(&self, name: &str, what: &str, wanted: &[Kind]) -> Result<PathBuf> {
        let mut known = Vec::new();
        for kind in wanted.iter().rev() {
            known.extend(self.all(*kind)?);
        }
        let named = known.iter().find(|path| stem(path) == name);
        if let (None, Some((other, _))) = (named, self.of_another_kind(name, wanted)?) {
            let freeze = if other == Kind::Case && wanted.contains(&Kind::Frozen) {
                format!(
                    ": `gravel freeze {name} --time-step K -o FILE.json` writes the problem of one time step"
                )
            } else {
                String::new()
            };
            bail!("`{name}` is {}, not a {what}{freeze}", other.words().0);
        }
        let collection = self.join("cases/collection");
        let collected =
            || wanted.contains(&Kind::Frozen).then(|| self.collected(&collection, name)).flatten();
        // Of a case in a folder, such as `literature/to-2001`.
        let below = || {
            let path = self.join("cases").join(name).with_extension("toml");
            let is_name = name.contains('/') && !Path::new(name).exists() && wanted.contains(&Kind::Case);
            (is_name && path.is_file()).then_some(path)
        };
        let named = named.cloned().or_else(collected).or_else(below);
        if named.is_none() && is_id(name) && !Path::new(name).exists() {
            bail!(
                "no problem `{name}` here: `gravel collection show {name}` says whether it is known, and what makes it"
            );
        }
        let path = named.map_or_else(|| typed(name, what, &known), Ok)?;
        let found = Kind::of(&path);
        // Whoever reads a file says what is wrong inside it.
        let unclear = found.is_none() && is_toml(&path) && wanted != [Kind::Frozen];
        if unclear || found.is_some_and(|found| wanted.contains(&found)) {
            return Ok(path);
        }
        let is = found.map_or_else(String::new, |found| format!(" is {}", found.words().0));
        let (names, endings): (Vec<_>, Vec<_>) =
            wanted.iter().map(|kind| kind.words()).map(|(name, _, ending)| (name, ending)).unzip();
        let (names, endings) = (names.join(" or "), endings.join(" or "));
        bail!("{}{is}: {names} is asked, a file that ends in {endings}", path.display())
    }
}

/// The file of that path; or else an error that lists the `known` ones.
fn typed(name: &str, what: &str, known: &[PathBuf]) -> Result<PathBuf> {
    let path = PathBuf::from(name);
    if path.is_file() {
        return Ok(path);
    }
    if path.is_dir() {
        bail!("{name} is a folder: give a {what}, by name or by the path of its file");
    }
    // What is there and cannot be reached, such as a link to itself, is not a wrong name.
    if let (Ok(_), Err(error)) = (path.symlink_metadata(), path.metadata()) {
        bail!("{name}: it cannot be read: {error}");
    }
    if known.is_empty() {
        bail!("no {what} `{name}`: it is no file, and {NO_CHECKOUT}");
    }
    let names: Vec<String> = known.iter().map(|path| stem(path)).collect();
    let what = format!("no {what} `{name}`, and no file of that path seen from the current folder");
    bail!("{}", suggest::among(&what, name, names.iter().map(String::as_str)))
}

impl Kind {
    /// Its name, the folder of those of the checkout, and how its files end.
    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Case => ("a case", "cases", ".toml"),
            Self::Plan => ("a plan", "harness/plans", ".toml"),
            Self::Frozen => ("a frozen problem", "cases/frozen", ".json"),
            Self::Foreign => ("a file of another code", "cases/foreign", ".hdf5"),
            Self::External => ("a description of another code", "harness/external", ".toml"),
        }
    }

    /// Returns the kind of a file, where it cannot be taken for another; the file may still be wrong in itself.
    fn of(path: &Path) -> Option<Self> {
        if is_foreign(path) {
            return Some(Self::Foreign);
        }
        if !is_toml(path) {
            return is_json(path).then_some(Self::Frozen);
        }
        let table: toml::Table = read_text(path).ok()?.parse().ok()?;
        let has = |key| table.contains_key(key);
        match (has("scene") || has("sample"), has("methods") || has("problems")) {
            (true, false) => Some(Self::Case),
            (false, true) => Some(Self::Plan),
            _ => None,
        }
    }
}

/// Reports whether a text has the form of an id of the collection.
pub(crate) fn is_id(text: &str) -> bool {
    text.len() == 16 && text.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
}

/// Name of a file without its ending, and without that of its compression.
pub(crate) fn stem(path: &Path) -> String {
    uncompressed(path).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// Name of a file without the ending of its compression.
fn uncompressed(path: &Path) -> PathBuf {
    let is_compressed = path.extension().is_some_and(|ending| ending == "gz");
    if is_compressed { path.with_extension("") } else { path.to_owned() }
}

/// Reports whether a file has the extension of JSON, compressed or not.
pub(crate) fn is_json(path: &Path) -> bool {
    uncompressed(path).extension().is_some_and(|ending| ending == "json")
}

/// Reports whether a file has the extension of a case or a plan.
pub(crate) fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml")
}
