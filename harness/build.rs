//! The versions of the code of every solver crate, and of the crate that makes problems: a hash of all that decides what
//! comes out. Cargo runs this again whenever one of these files changes, so the versions cannot go stale; and a commit that
//! touches none of them changes no version.

use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const SOLVERS: &str = "../solvers";
/// What problems are made by, and what simulations depend on.
const CASES: &str = "../cases";
/// What runs every method, and decides when it ends.
const LOOP: &str = "runner";
const LOCK: &str = "../Cargo.lock";
/// What decides at which iterations a curve is read.
const CURVE: &str = "src/run/curve.rs";

fn main() -> Result<()> {
    for path in ["build.rs", LOCK, SOLVERS, "../cases/src", "../cases/Cargo.toml", CURVE] {
        println!("cargo::rerun-if-changed={path}");
    }
    // Half of the time of a start went into relocating a hundred thousand addresses of a position-independent program.
    let target = |key: &str| std::env::var(format!("CARGO_CFG_TARGET_{key}")).unwrap_or_default();
    if target("OS") == "linux" && target("ENV") == "gnu" {
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
    let crates = our_crates()?;
    let locked = locked_packages()?;
    let mut list = String::from("&[");
    for name in crates.keys() {
        write!(list, "({name:?}, {:?}), ", version(name, &crates, &locked)?)?;
    }
    list.push(']');
    Ok(fs::write(PathBuf::from(std::env::var("OUT_DIR")?).join("code_versions.rs"), list)?)
}

/// A crate below `solvers/`, or `cases`: its folder, and what it uses outside its tests.
struct OurCrate {
    folder: PathBuf,
    uses: BTreeSet<String>,
}

fn our_crates() -> Result<BTreeMap<String, OurCrate>> {
    let mut crates = BTreeMap::new();
    let mut folders = vec![PathBuf::from(CASES)];
    for entry in fs::read_dir(SOLVERS)? {
        folders.push(entry?.path());
    }
    for folder in folders {
        let manifest = folder.join("Cargo.toml");
        // The folder of the tests holds no method.
        if folder.join("src").is_dir() {
            let manifest: Table = fs::read_to_string(manifest)?.parse()?;
            let name = text(manifest.get("package").and_then(|package| package.get("name")))?;
            let uses = manifest.get("dependencies").and_then(Value::as_table);
            let uses = uses.map(|uses| uses.keys().cloned().collect()).unwrap_or_default();
            crates.insert(name, OurCrate { folder, uses });
        }
    }
    Ok(crates)
}

/// The packages of the lock file: by name, and by name and version, as other packages refer to them.
fn locked_packages() -> Result<BTreeMap<String, Table>> {
    let lock: Table = fs::read_to_string(LOCK)?.parse()?;
    let mut packages = BTreeMap::new();
    for package in lock.get("package").and_then(Value::as_array).into_iter().flatten() {
        let package = package.as_table().ok_or("a package of the lock file is no table")?;
        let (name, version) = (text(package.get("name"))?, text(package.get("version"))?);
        packages.insert(format!("{name} {version}"), package.clone());
        packages.insert(name, package.clone());
    }
    Ok(packages)
}

/// Hash of the sources of a crate and of the solver crates it uses, and of the locked versions of all else that they use.
fn version(
    name: &str,
    crates: &BTreeMap<String, OurCrate>,
    locked: &BTreeMap<String, Table>,
) -> Result<String> {
    let mut parts = BTreeMap::from([("curve".to_owned(), fs::read(CURVE)?)]);
    let mut seen = BTreeSet::new();
    let mut ahead = vec![name.to_owned(), LOOP.to_owned()];
    while let Some(reference) = ahead.pop() {
        if !seen.insert(reference.clone()) {
            continue;
        }
        let package = locked.get(&reference).ok_or_else(|| format!("{reference} is not in {LOCK}"))?;
        let uses = package.get("dependencies").and_then(Value::as_array).into_iter().flatten();
        let uses = uses.map(|used| text(Some(used))).collect::<Result<Vec<_>>>()?;
        let name = reference.split(' ').next().unwrap_or_default();
        if let Some(ours) = crates.get(name) {
            // The lock file does not separate tests from the rest; the manifest does.
            ahead.extend(
                uses.into_iter()
                    .filter(|used| ours.uses.contains(used.split(' ').next().unwrap_or_default())),
            );
            for file in sources(&ours.folder)? {
                parts.insert(file.display().to_string(), fs::read(file)?);
            }
        } else {
            ahead.extend(uses);
            parts.insert(reference, package.to_string().into_bytes());
        }
    }
    let mut hash = Sha256::new();
    for (part, content) in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
        hash.update((content.len() as u64).to_le_bytes());
        hash.update(content);
    }
    let first = hash.finalize()[..8].iter().fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    Ok(format!("{first:016x}"))
}

/// The manifest and all files below `src`.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = vec![folder.join("Cargo.toml")];
    let mut folders = vec![folder.join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    Ok(files)
}

fn text(value: Option<&Value>) -> Result<String> {
    Ok(value.and_then(Value::as_str).ok_or("a text is missing in a manifest or in the lock file")?.to_owned())
}
