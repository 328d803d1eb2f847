//! A problem as one file per subdomain: the first line says what it is a part of, the second is a frozen problem of its own. Both
//! have checksums.

use crate::identity::content_hash;
use crate::problems::Studied;
#[cfg(any(feature = "mpi", test))]
use crate::terminal::read_text;
use crate::terminal::{read_sealed, write_whole};
use anyhow::{Context, Result, bail};
use cases::Frozen;
use contact::{Packing, Vector};
use partition::{Decomposition, Grid, Partition, Scheme, Share, Whole};
#[cfg(any(feature = "mpi", test))]
use seal::opened;
use seal::sealed;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
#[cfg(any(feature = "mpi", test))]
use {cases::AnyFrozen, contact::Touch};

#[cfg(any(feature = "mpi", test))]
mod made;

#[cfg(any(feature = "mpi", test))]
pub(crate) use made::{MadeOf, make};

const FORMAT: &str = "gravel/subdomain/2";

/// Format of parts written before there were checksums.
#[cfg(any(feature = "mpi", test))]
const UNSEALED: &str = "gravel/subdomain/1";

/// The first line of the file of a subdomain.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Part {
    format: String,
    /// Hash of the whole problem.
    pub(crate) problem_hash: String,
    pub(crate) whole: Whole,
    /// The number of this subdomain among all.
    subdomain: u32,
    /// The whole problem's numbers of its grains, in the order of the second line.
    grains: Vec<u32>,
    /// And of its contacts.
    pub(crate) contacts: Vec<u32>,
    /// Its copies of boundary grains, in their order: the grain, by its place in the second line, and all copies, each by its
    /// subdomain and its number there.
    boundary: Vec<(u32, Vec<(u32, u32)>)>,
}

/// The impulses of a subdomain, by the whole problem's numbers of its contacts.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Impulses {
    pub(crate) problem_hash: String,
    /// How many contacts the whole problem has.
    pub(crate) contacts: u64,
    pub(crate) contact: Vec<u32>,
    /// N·s; with friction the normal and the tangential one of each contact.
    pub(crate) impulse: Vec<f64>,
}

/// A problem cut by the rule of a method, and what only the whole of it tells.
pub(crate) fn cut<M: Studied>(
    problem: &Packing<M>,
    grid: Grid,
    scheme: Scheme,
) -> Result<(Decomposition, Whole)> {
    let partition = Partition::of_contacts(problem, scheme, grid)?;
    Ok((Decomposition::new(problem, &partition), ranks::whole(problem, grid, scheme)))
}

impl Part {
    /// The file of a subdomain in a folder.
    pub(crate) fn path(folder: &Path, subdomain: usize) -> PathBuf {
        folder.join(format!("{subdomain}.jsonl"))
    }

    /// Writes a problem to a folder, a file per subdomain; and its `solutions` (N·s) to folders inside.
    pub(crate) fn write_all<M: Studied>(
        folder: &Path,
        frozen: &Frozen<M>,
        solutions: &[Vec<f64>],
        (grid, scheme): (Grid, Scheme),
    ) -> Result<()> {
        let (decomposition, whole) = cut(&frozen.problem, grid, scheme)?;
        for k in 0..solutions.len() {
            let folder = solution_folder(folder, k);
            std::fs::create_dir(&folder).with_context(|| folder.display().to_string())?;
        }
        let problem_hash = content_hash(frozen);
        let begins = frozen.start.iter().any(|r| *r != 0.0);
        for e in 0..decomposition.subdomains.len() {
            let share = Share::of_subdomain(&frozen.problem, &decomposition, e, whole)?;
            for (k, solution) in solutions.iter().enumerate() {
                Impulses::write_all(
                    &solution_folder(folder, k),
                    &share,
                    &problem_hash,
                    &own(&share, solution),
                )?;
            }
            let cut = &share.decomposition;
            let place = |copies: &Vec<(u32, u32)>| {
                let (_, k) = *copies.iter().find(|(f, _)| *f as usize == e)?;
                let subdomain = &cut.subdomains[0];
                Some((subdomain.grains[subdomain.boundary[k as usize] as usize], copies.clone()))
            };
            let of = |all: &[f64], some: &[u32]| some.iter().map(|k| all[*k as usize]).collect();
            let part = Self {
                format: FORMAT.to_owned(),
                problem_hash: problem_hash.clone(),
                whole,
                subdomain: e as u32,
                boundary: cut.boundary.iter().filter_map(place).collect(),
                grains: share.grains.clone(),
                contacts: share.contacts.clone(),
            };
            part.write(
                folder,
                &Frozen {
                    name: frozen.name.clone(),
                    source: frozen.source.clone(),
                    time_step: frozen.time_step,
                    radius: of(&frozen.radius, &share.grains),
                    gap: of(&frozen.gap, &share.contacts),
                    start: if begins { own(&share, &frozen.start) } else { Vec::new() },
                    problem: share.problem,
                    missed_before: frozen.missed_before,
                },
            )?;
        }
        Ok(())
    }

    /// Writes the file of a subdomain, `alone` the problem of its second line.
    fn write<M: Studied>(&self, folder: &Path, alone: &Frozen<M>) -> Result<()> {
        let text = format!("{}\n{}", sealed(&serde_json::to_string(self)?), sealed(&M::to_json(alone)?));
        write_whole(&Self::path(folder, self.subdomain as usize), &text)
    }

    /// The first line of the file of a subdomain.
    #[cfg(any(feature = "mpi", test))]
    pub(crate) fn first_line(folder: &Path, subdomain: usize) -> Result<Self> {
        let path = Self::path(folder, subdomain);
        let in_file = || path.display().to_string();
        let mut line = String::new();
        let file = std::fs::File::open(&path).with_context(in_file)?;
        std::io::BufRead::read_line(&mut std::io::BufReader::new(file), &mut line).with_context(in_file)?;
        Self::of_line(&line, subdomain).with_context(in_file)
    }

    #[cfg(any(feature = "mpi", test))]
    fn of_line(line: &str, subdomain: usize) -> Result<Self> {
        let opened = opened(line.as_bytes())?;
        let part: Self = serde_json::from_slice(opened.as_deref().unwrap_or(line.as_bytes()))?;
        match (&*part.format, opened) {
            (FORMAT, Some(_)) | (UNSEALED, None) => {}
            (FORMAT, None) => bail!("{NO_CHECKSUM}"),
            (format, _) => bail!("`format` is \"{format}\": it must be \"{FORMAT}\""),
        }
        if part.subdomain as usize != subdomain {
            bail!("`subdomain` is {}: it must be {subdomain}", part.subdomain);
        }
        Ok(part)
    }

    /// The first line of the file of a subdomain, and the problem of its second.
    #[cfg(any(feature = "mpi", test))]
    pub(crate) fn read(folder: &Path, subdomain: usize) -> Result<(Self, AnyFrozen)> {
        let path = Self::path(folder, subdomain);
        let text = read_text(&path)?;
        let in_file = || path.display().to_string();
        let (first, second) = text.split_once('\n').unwrap_or((&text, ""));
        let part = Self::of_line(first, subdomain).with_context(in_file)?;
        if part.format == UNSEALED {
            note_unsealed(&path, subdomain);
        } else if opened(second.as_bytes()).with_context(in_file)?.is_none() {
            bail!("{}: line 2 is {NO_CHECKSUM}", in_file());
        }
        Ok((part, AnyFrozen::of_text(&path, second)?))
    }

    /// The share of a rank that has this subdomain alone, of whose second line `problem` is.
    #[cfg(any(feature = "mpi", test))]
    pub(crate) fn share<M: Studied>(self, problem: Packing<M>) -> Result<Share<M>> {
        let (grains, contacts) = (problem.grain_count(), problem.contact_count());
        if (self.grains.len(), self.contacts.len()) != (grains, contacts) {
            bail!(
                "`grains` and `contacts` have not one number for each of {grains} grains and {contacts} contacts"
            );
        }
        let all_here = Partition { subdomain: vec![0; contacts], count: 1 };
        let mut decomposition = Decomposition::new(&problem, &all_here);
        let mut local = vec![0; grains];
        for (k, grain) in (0..).zip(&decomposition.subdomains[0].grains) {
            local[*grain as usize] = k;
        }
        decomposition.first = self.subdomain;
        for (k, (grain, copies)) in (0..).zip(self.boundary) {
            let known = local.get(grain as usize).filter(|_| copies.contains(&(self.subdomain, k)));
            let Some(place) = known else { bail!("`boundary[{k}]` is not a copy of this subdomain") };
            decomposition.subdomains[0].boundary.push(*place);
            decomposition.multiplicity[grain as usize] = copies.len() as u32;
            decomposition.boundary.push(copies);
        }
        Ok(Share { problem, decomposition, contacts: self.contacts, grains: self.grains, whole: self.whole })
    }
}

#[cfg(any(feature = "mpi", test))]
const NO_CHECKSUM: &str = "damaged: it has no checksum; `gravel split` writes the files again";

/// Says that damage may go unnoticed to a file, and to others like it: once, of subdomain 0.
fn note_unsealed(path: &Path, subdomain: usize) {
    if subdomain == 0 {
        eprintln!("{}: from before there were checksums; damage to it would go unnoticed", path.display());
    }
}

/// Where a solution of a problem lies, beside the files of its subdomains: one of several, where there is friction.
pub(crate) fn solution_folder(folder: &Path, k: usize) -> PathBuf {
    folder.join(format!("solution-{k}"))
}

/// Of the impulses `r` of the whole problem, those of a share, in its order (N·s).
pub(crate) fn own<M: Studied>(share: &Share<M>, r: &[f64]) -> Vec<f64> {
    let mut own = Vec::new();
    for contact in &share.contacts {
        M::Impulse::at(r, *contact as usize).each(&mut |r| own.push(r));
    }
    own
}

impl Impulses {
    /// Those of a share, in its order (N·s), from the files of its own subdomains in a folder.
    #[cfg(any(feature = "mpi", test))]
    pub(crate) fn read_own<M: Studied>(
        folder: &Path,
        share: &Share<M>,
        problem_hash: &str,
    ) -> Result<Vec<f64>> {
        let mut r = vec![f64::NAN; share.problem.impulse_count()];
        for (e, subdomain) in (share.decomposition.first..).zip(&share.decomposition.subdomains) {
            let path = Self::path(folder, e as usize);
            let in_file = || path.display().to_string();
            let read = Self::read(&path, e as usize)?;
            if read.problem_hash != problem_hash {
                bail!("{}: `problem_hash` is {}: it must be {problem_hash}", in_file(), read.problem_hash);
            }
            let contacts = subdomain.contacts.iter().map(|k| share.contacts[*k as usize]);
            if !read.contact.iter().copied().eq(contacts) {
                bail!(
                    "{}: `contact` has not the contacts of subdomain {e}: other subdomains, or another rule",
                    in_file()
                );
            }
            let (found, expected) = (read.impulse.len(), M::Impulse::LEN * read.contact.len());
            if found != expected {
                bail!("{}: `impulse` has {found} values where {expected} are expected", in_file());
            }
            for (k, contact) in subdomain.contacts.iter().enumerate() {
                let own = M::Impulse::at(&read.impulse, k);
                let touch = &share.problem.contacts()[*contact as usize];
                if !(own.is_finite() && touch.is_admissible(own)) {
                    let (number, expected) = (read.contact[k], M::Contact::ADMISSIBLE);
                    let text = own.text();
                    bail!("{}: `impulse` of contact {number} is {text}: it must be {expected}", in_file());
                }
                own.put(&mut r, *contact as usize);
            }
        }
        Ok(r)
    }

    /// Those of each subdomain of a share, of its impulses `r`, written to a folder.
    pub(crate) fn write_all<M: Studied>(
        folder: &Path,
        share: &Share<M>,
        problem_hash: &str,
        r: &[f64],
    ) -> Result<()> {
        let first = share.decomposition.first;
        for (e, subdomain) in (first..).zip(&share.decomposition.subdomains) {
            let mut impulse = Vec::new();
            for contact in &subdomain.contacts {
                M::Impulse::at(r, *contact as usize).each(&mut |r| impulse.push(r));
            }
            let impulses = Self {
                problem_hash: problem_hash.to_owned(),
                contacts: share.whole.contacts,
                contact: subdomain.contacts.iter().map(|k| share.contacts[*k as usize]).collect(),
                impulse,
            };
            write_whole(&Self::path(folder, e as usize), sealed(&serde_json::to_string(&impulses)?))?;
        }
        Ok(())
    }

    /// Reads the file of a subdomain.
    fn read(path: &Path, subdomain: usize) -> Result<Self> {
        let (text, sealed) = read_sealed(path)?;
        let read = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        if !sealed {
            note_unsealed(path, subdomain);
        }
        Ok(read)
    }

    /// The file of a subdomain in a folder.
    fn path(folder: &Path, subdomain: usize) -> PathBuf {
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
