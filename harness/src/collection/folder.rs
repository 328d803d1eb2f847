//! The collection on disk: of each problem an entry, its file and its known answers, all named after the hash of its content.

use super::answers::Answers;
use super::entry::{Entry, of_file};
use crate::plan::Settings;
use crate::problems::{Known, Problem};
use crate::root::{Root, is_id, stem};
use crate::terminal::{read_sealed, write_kept, write_sealed};
use anyhow::{Context, Result, bail, ensure};
use cases::AnyFrozen;
use lineup::Posed;
use std::fs::File;
use std::path::{Path, PathBuf};
use wildmatch::WildMatch;

/// A collection of problems, as a folder.
pub(crate) struct Collection<'r> {
    root: &'r Root,
    folder: PathBuf,
}

impl<'r> Collection<'r> {
    /// The collection of the checkout, or the one in a `folder`, which need not be there where it may be `new`.
    pub(crate) fn of(root: &'r Root, folder: Option<&Path>, new: bool) -> Result<Self> {
        if let Some(folder) = folder {
            let (name, is_there) = (folder.display(), folder.exists());
            ensure!(!is_there || folder.is_dir(), "--in {name}: it is a file; a collection is a folder");
            ensure!(
                is_there || new,
                "--in {name}: there is no such folder; `gravel collection make` makes one"
            );
        }
        let here = || root.needed().map(|root| root.join("cases/collection"));
        Ok(Self { root, folder: folder.map_or_else(here, |folder| Ok(folder.to_owned()))? })
    }

    /// A file of it, of a `kind`: `entries`, `problems`, `answers` or `submissions`.
    pub(crate) fn file(&self, kind: &str, name: &str) -> PathBuf {
        self.folder.join(kind).join(name)
    }

    /// Returns the names of the files of a `kind`, without their endings, in order.
    pub(crate) fn names(&self, kind: &str) -> Result<Vec<String>> {
        let folder = self.folder.join(kind);
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let mut names = Vec::new();
        for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let path = entry.with_context(|| folder.display().to_string())?.path();
            let name = stem(&path);
            if !name.starts_with('.') {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }

    /// Reads all entries, in the order of their ids.
    pub(crate) fn entries(&self) -> Result<Vec<Entry>> {
        self.names("entries")?.iter().map(|id| self.entry(id)).collect()
    }

    /// Returns the ids of the stored problems with a name that one of the `patterns` matches, in the order of their names, each with what
    /// made it.
    ///
    /// # Errors
    /// Names a pattern that matches none.
    pub(crate) fn matching(&self, patterns: &[String]) -> Result<Vec<(String, Settings)>> {
        let wanted: Vec<WildMatch> = patterns.iter().map(|pattern| WildMatch::new(pattern)).collect();
        let mut entries = self.entries()?;
        entries.retain(|entry| wanted.iter().any(|pattern| pattern.matches(&entry.name)));
        entries.retain(|entry| self.place(entry).is_some());
        for (text, pattern) in patterns.iter().zip(&wanted) {
            ensure!(
                entries.iter().any(|entry| pattern.matches(&entry.name)),
                "`collected`: no stored problem of the collection matches `{text}`: `gravel collection list` shows their names"
            );
        }
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(entries.into_iter().map(|entry| (entry.id.clone(), entry.settings())).collect())
    }

    /// Reads an entry.
    pub(crate) fn entry(&self, id: &str) -> Result<Entry> {
        let file = self.file("entries", &format!("{id}.toml"));
        if !is_id(id) {
            bail!("{id:?} is no id of a problem: it must be 16 digits 0-9 or a-f");
        }
        if !file.is_file() {
            bail!(
                "no problem {id} in the collection {}: `gravel collection list` shows those that there are",
                self.folder.display()
            );
        }
        let entry: Entry = of_file(&file)?;
        ensure!(
            entry.id == id,
            "{}: `id` is {:?}, and the file is named after another",
            file.display(),
            entry.id
        );
        Ok(entry)
    }

    /// Returns the place of the problem of an entry, if it is stored or was made.
    pub(crate) fn place(&self, entry: &Entry) -> Option<PathBuf> {
        self.root.collected(&self.folder, &entry.id)
    }

    /// Reads the problem of an entry, and checks that it is the one; none if it is not stored and was not made.
    pub(crate) fn problem(&self, entry: &Entry) -> Result<Option<Problem>> {
        let Some(place) = self.place(entry) else { return Ok(None) };
        let problem = match &entry.foreign {
            Some(_) => Problem::foreign(&place)?,
            None => Problem::alone(AnyFrozen::read(&place)?, false),
        };
        ensure!(
            problem.hash == entry.id,
            "{}: the content has the hash {}, not that of the entry: it was changed",
            place.display(),
            problem.hash
        );
        Ok(Some(problem))
    }

    /// Reads the problem of an entry, which must be here: see [`Self::problem`].
    pub(crate) fn needed(&self, entry: &Entry) -> Result<Problem> {
        let id = &entry.id;
        let not_here = || format!("the problem {id} is not here: `gravel collection make {id}` makes it");
        self.problem(entry)?.with_context(not_here)
    }

    /// Reads the stored answers to the problem of an entry.
    pub(crate) fn answers(&self, id: &str) -> Result<Answers> {
        let file = self.file("answers", &format!("{id}.json.gz"));
        let (text, sealed) = read_sealed(&file)?;
        ensure!(sealed, "{}: it has no checksum", file.display());
        serde_json::from_str(&text).with_context(|| file.display().to_string())
    }

    /// Returns the stored solutions of a problem, certified again, or the proof that there is none; nothing of one that is open or is not in
    /// the collection.
    pub(crate) fn known(&self, problem: &Problem) -> Result<Option<Known>> {
        let is_collected = self.file("entries", &format!("{}.toml", problem.hash)).is_file();
        if !is_collected || !matches!(problem.posed, Posed::Grains(_)) {
            return Ok(None);
        }
        let answers = self.answers(&problem.hash)?;
        let file = || self.file("answers", &format!("{}.json.gz", problem.hash)).display().to_string();
        answers.standing(&problem.posed).with_context(file)?;
        Ok(match answers {
            Answers::Solutions(all) => Some(Known::stored(all, false)),
            Answers::Ray(_) => Some(Known::stored(Vec::new(), true)),
            Answers::Best(_) => None,
        })
    }

    /// Waits until no other process changes the collection, and keeps others out until what it returns is dropped. Where the system locks
    /// no folders, none is kept out.
    pub(crate) fn alone(&self) -> Option<File> {
        let folder = File::open(&self.folder).ok()?;
        folder.lock().ok()?;
        Some(folder)
    }

    /// Writes an entry and the answers to its problem.
    pub(crate) fn write(&self, entry: &Entry, answers: &Answers) -> Result<()> {
        let text = toml::to_string(entry)?;
        write_sealed(
            &self.file("answers", &format!("{}.json.gz", entry.id)),
            &serde_json::to_string(answers)?,
        )?;
        write_kept(&self.file("entries", &format!("{}.toml", entry.id)), &text)
    }

    /// Writes the file of a problem: here where it is `stored`, else where it need not be made again.
    pub(crate) fn write_problem(&self, id: &str, frozen: &AnyFrozen, stored: bool) -> Result<()> {
        let name = format!("{id}.json.gz");
        let place =
            if stored { self.file("problems", &name) } else { self.root.join("results/problems").join(name) };
        write_kept(&place, &frozen.to_json()?)
    }
}
