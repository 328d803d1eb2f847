//! A problem as one file per subdomain: the first line says what it is a part of, the second is a frozen problem of its own. Both
//! have checksums.

use crate::terminal::{read_sealed, write_whole};
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use lineup::{OneProblem, OneShare, Part, content_hash};
use partition::{Grid, Scheme};
use seal::sealed;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The impulses of a subdomain, by the whole problem's numbers of its contacts.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Impulses {
    pub(crate) problem_hash: String,
    /// Number of contacts of the whole problem.
    pub(crate) contacts: u64,
    pub(crate) contact: Vec<u32>,
    /// N·s; with friction the normal and the tangential one of each contact.
    pub(crate) impulse: Vec<f64>,
}

/// Returns the file of a subdomain in a folder.
pub(crate) fn part_path(folder: &Path, subdomain: usize) -> PathBuf {
    folder.join(format!("{subdomain}.jsonl"))
}

/// Writes a problem to a folder, a file per subdomain; and its `solutions` (N·s) to folders inside.
pub(crate) fn write_parts(
    folder: &Path,
    problem: &dyn OneProblem,
    solutions: &[Vec<f64>],
    (grid, scheme): (Grid, Scheme),
) -> Result<()> {
    let (whole, (_, decomposition)) = (problem.whole(grid, scheme), problem.cut(grid, scheme)?);
    for k in 0..solutions.len() {
        let folder = solution_folder(folder, k);
        std::fs::create_dir(&folder).with_context(|| folder.display().to_string())?;
    }
    let problem_hash = content_hash(problem);
    for e in 0..decomposition.subdomains.len() {
        let (share, part, alone) = problem.part(&decomposition, e, whole, &problem_hash)?;
        for (k, solution) in solutions.iter().enumerate() {
            let own = share.own(solution);
            Impulses::write_all(&solution_folder(folder, k), &*share, &problem_hash, &own)?;
        }
        write_part(folder, &part, &alone)?;
    }
    Ok(())
}

/// Writes the file of a subdomain, `alone` the problem of its second line.
pub(crate) fn write_part(folder: &Path, part: &Part, alone: &AnyFrozen) -> Result<()> {
    let text = format!("{}\n{}", sealed(&serde_json::to_string(part)?), sealed(&alone.to_json()?));
    write_whole(&part_path(folder, part.subdomain as usize), &text)
}

/// Says that damage may go unnoticed to a file, and to others like it: once, of subdomain 0.
pub(crate) fn note_unsealed(path: &Path, subdomain: usize) {
    if subdomain == 0 {
        eprintln!("{}: from before there were checksums; damage to it would go unnoticed", path.display());
    }
}

/// Returns the folder of a solution of a problem, beside the files of its subdomains: one of several, where there is
/// friction.
pub(crate) fn solution_folder(folder: &Path, k: usize) -> PathBuf {
    folder.join(format!("solution-{k}"))
}

impl Impulses {
    /// Writes the impulses `r` of a share to a folder, one file for each of its subdomains.
    pub(crate) fn write_all(
        folder: &Path,
        share: &dyn OneShare,
        problem_hash: &str,
        r: &[f64],
    ) -> Result<()> {
        let (of_contact, cut) = (share.facts().of_contact, share.decomposition());
        for (e, subdomain) in (cut.first..).zip(&cut.subdomains) {
            let of = |k: &u32| &r[of_contact * *k as usize..][..of_contact];
            let impulses = Self {
                problem_hash: problem_hash.to_owned(),
                contacts: share.whole().contacts,
                contact: subdomain.contacts.iter().map(|k| share.contacts()[*k as usize]).collect(),
                impulse: subdomain.contacts.iter().flat_map(of).copied().collect(),
            };
            write_whole(&Self::path(folder, e as usize), sealed(&serde_json::to_string(&impulses)?))?;
        }
        Ok(())
    }

    /// Reads the file of a subdomain.
    pub(crate) fn read(path: &Path, subdomain: usize) -> Result<Self> {
        let (text, sealed) = read_sealed(path)?;
        let read = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        if !sealed {
            note_unsealed(path, subdomain);
        }
        Ok(read)
    }

    /// The file of a subdomain in a folder.
    pub(crate) fn path(folder: &Path, subdomain: usize) -> PathBuf {
        folder.join(format!("{subdomain}.impulses.json"))
    }

    /// All impulses of a folder, in the order of the whole problem's contacts (N·s).
    pub(crate) fn join_all(folder: &Path) -> Result<Vec<f64>> {
        let mut parts = Vec::new();
        while Self::path(folder, parts.len()).is_file() {
            parts.push(Self::read(&Self::path(folder, parts.len()), parts.len())?);
        }
        let Some(first) = parts.first() else {
            bail!("{}: there is no such file", Self::path(folder, 0).display());
        };
        let of_contacts: usize = parts.iter().map(|part| part.contact.len()).sum();
        if of_contacts as u64 != first.contacts
            || parts.iter().any(|part| part.problem_hash != first.problem_hash)
        {
            let all = first.contacts;
            bail!(
                "{}: the files have impulses of {of_contacts} contacts, of {all} of one problem",
                folder.display()
            );
        }
        let numbers = parts.iter().map(|part| part.impulse.len()).sum::<usize>() / of_contacts.max(1);
        let mut all = vec![f64::NAN; numbers * of_contacts];
        for (contact, r) in
            parts.iter().flat_map(|part| part.contact.iter().zip(part.impulse.chunks_exact(numbers.max(1))))
        {
            let place = *contact as usize * numbers;
            let Some(place) = all.get_mut(place..place + numbers) else {
                bail!("{}: there is no contact {contact} of {of_contacts}", folder.display());
            };
            place.copy_from_slice(r);
        }
        Ok(all)
    }
}
