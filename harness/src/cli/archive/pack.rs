//! A study in one file, with all that makes it again.

use super::{Args, Row, counted, each};
use crate::collection::sha256;
use crate::exchange::is_foreign;
use crate::plan::Plan;
use crate::root::{Kind as Held, Root, stem};
use crate::store::{stored, tables_of};
use crate::terminal::{prepare_new, read_text, say, write_whole};
use anyhow::{Context, Result, bail, ensure};
use results::schema::Provenance;
use results::settings::CASE;
use results::study::{Study as Rows, TABLES};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path};

/// Name of the description of a pack, as RO-Crate has it; folder of its rows.
const METADATA: &str = "ro-crate-metadata.json";
pub(super) const ROWS: &str = "rows";

pub(super) fn pack(root: &Root, args: &Args, output: &Path) -> Result<()> {
    let name = output.display();
    ensure!(
        output.extension().is_some_and(|ending| ending == "tar"),
        "--output {name}: its name must end in .tar"
    );
    prepare_new(output)?;
    let path = args.study.path(root)?;
    let plan = Plan::read(&path, args.study.quick)?;
    let folder = args.rows.clone().map_or_else(|| stored(root, &plan), Ok)?;
    // Refuses what is damaged.
    let rows = tables_of(&folder)?;
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut add = |inside: String, file: &Path| -> Result<()> {
        files.insert(inside, fs::read(file).with_context(|| file.display().to_string())?);
        Ok(())
    };
    for table in TABLES.map(|table| format!("{table}.parquet")) {
        if folder.join(&table).is_file() {
            add(format!("{ROWS}/{table}"), &folder.join(&table))?;
        }
    }
    add(format!("harness/plans/{}.toml", stem(&path)), &path)?;
    for (held, name) in sources(&Row::all(&rows)) {
        let file = if held == Held::Case { root.case(&name)? } else { root.any_problem(&name)? };
        let base = match held {
            Held::Case => "cases",
            _ if is_foreign(&file) => "cases/foreign",
            _ => "cases/frozen",
        };
        let file_name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        add(format!("{base}/{file_name}"), &file)?;
        if held == Held::Case
            && let Some(beside) = of_sample(&file)?
        {
            add(format!("cases/{beside}"), &file.with_file_name(&beside))?;
        }
    }
    let lock = root.join("Cargo.lock");
    if lock.is_file() {
        add("Cargo.lock".to_owned(), &lock)?;
    }
    let described = serde_json::to_vec_pretty(&described(&plan, &rows, &files)?)?;
    let count = files.len();
    files.insert(METADATA.to_owned(), described);
    let mut tar = tar::Builder::new(Vec::new());
    for (inside, bytes) in &files {
        // Neither times nor owners, so that the same study has the same bytes.
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        tar.append_data(&mut header, inside, &**bytes)?;
    }
    write_whole(output, tar.into_inner()?)?;
    say(format_args!("{name}: {count} files, {}", counted(&rows)))
}

/// Returns the cases and the frozen problems of rows, each once.
fn sources(rows: &[Row]) -> BTreeSet<(Held, String)> {
    let source = |row: &Row| match row.settings.get(CASE) {
        Some(Value::String(case)) => (Held::Case, case.clone()),
        _ => (Held::Frozen, row.name.to_owned()),
    };
    rows.iter().map(source).collect()
}

/// Returns the name of the file beside a case that holds its sample, if there is one.
fn of_sample(case: &Path) -> Result<Option<String>> {
    let table: toml::Table = read_text(case)?.parse().with_context(|| case.display().to_string())?;
    let sample = table.get("sample").and_then(|sample| sample.get("file"));
    Ok(sample.and_then(|file| file.as_str()).map(str::to_owned))
}

/// Describes a pack as [RO-Crate 1.2](https://w3id.org/ro/crate/1.2) does: each file with its length and SHA-256, the program and the
/// machines that made the rows, and when.
fn described(plan: &Plan, rows: &Rows, files: &BTreeMap<String, Vec<u8>>) -> Result<Value> {
    let (counted, rows) = (counted(rows), Row::all(rows));
    let all = |of: fn(&Provenance) -> String| each(&rows, of);
    let times = all(|o| o.started_utc.clone());
    let hashes: BTreeSet<&str> = rows.iter().map(|row| row.hash).collect();
    let (first, last) = (times.first().context("the study has no rows")?, times.last());
    let licence = "https://spdx.org/licenses/CC-BY-4.0";
    let mut graph = vec![
        json!({
            "@id": METADATA, "@type": "CreativeWork", "about": { "@id": "./" },
            "conformsTo": { "@id": "https://w3id.org/ro/crate/1.2" },
        }),
        json!({
            "@id": "./", "@type": "Dataset", "name": format!("gravel study {}", plan.name), "description": plan.why,
            "datePublished": last.unwrap_or(first).get(..10), "license": { "@id": licence },
            "hasPart": files.keys().map(|file| json!({ "@id": file })).collect::<Vec<_>>(),
            "mentions": { "@id": "#runs" }, "variableMeasured": counted,
            "identifier": hashes,
        }),
        json!({ "@id": licence, "@type": "CreativeWork", "name": "Creative Commons Attribution 4.0 International" }),
        json!({
            "@id": "#gravel", "@type": "SoftwareApplication", "name": "gravel", "softwareVersion": all(|o| o.commit.clone()),
            "softwareRequirements": all(|o| format!("rustc {}, profile {}", o.rustc, o.profile)),
        }),
        json!({
            "@id": "#runs", "@type": "CreateAction", "name": format!("gravel bench {}", plan.name),
            "instrument": { "@id": "#gravel" }, "result": { "@id": "./" }, "startTime": first, "endTime": last,
            "description": all(|o| format!("{}, {} threads", o.processor, o.threads)),
        }),
    ];
    graph.extend(files.iter().map(|(file, bytes)| {
        json!({ "@id": file, "@type": "File", "contentSize": bytes.len().to_string(), "sha256": sha256(bytes) })
    }));
    Ok(json!({ "@context": "https://w3id.org/ro/crate/1.2/context", "@graph": graph }))
}

/// Unpacks a file into a folder, once all its files are what its description says.
pub(super) fn unpacked(file: &Path, folder: &Path) -> Result<()> {
    let read = || -> Result<BTreeMap<String, Vec<u8>>> {
        let mut files = BTreeMap::new();
        let mut archive = tar::Archive::new(fs::File::open(file)?);
        for entry in archive.entries()? {
            let mut entry = entry?;
            let name = entry.path()?.to_string_lossy().into_owned();
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut entry, &mut bytes)?;
            files.insert(name, bytes);
        }
        Ok(files)
    };
    let mut files = read().context("it is no tar archive that `gravel archive` wrote")?;
    let metadata = files.remove(METADATA).with_context(|| format!("it has no {METADATA}"))?;
    let metadata: Value = serde_json::from_slice(&metadata).context(METADATA)?;
    let graph =
        metadata["@graph"].as_array().with_context(|| format!("{METADATA}: it has no list `@graph`"))?;
    let described: BTreeMap<&str, &Value> = graph
        .iter()
        .filter(|entity| entity["@type"] == "File")
        .filter_map(|entity| Some((entity["@id"].as_str()?, &entity["sha256"])))
        .collect();
    if let Some(missing) = described.keys().find(|name| !files.contains_key(**name)) {
        bail!("{missing}: the description names it, and it is not there");
    }
    for (name, bytes) in &files {
        let wanted = described
            .get(name.as_str())
            .with_context(|| format!("{name}: the description does not name it"))?;
        let found = sha256(bytes);
        ensure!(**wanted == found, "{name}: `sha256` is {wanted}, and the file has {found}: it was changed");
        let path = Path::new(name);
        ensure!(
            path.components().all(|part| matches!(part, Component::Normal(_))),
            "{name}: it is no path inside a folder"
        );
        let target = folder.join(path);
        fs::create_dir_all(target.parent().unwrap_or(folder))?;
        fs::write(&target, bytes)?;
    }
    for inner in ["cases/frozen", "harness/plans"] {
        fs::create_dir_all(folder.join(inner))?;
    }
    Ok(())
}
