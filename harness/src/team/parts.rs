//! Files of subdomains as ranks read them, each its own.

use crate::problems::parts::{Impulses, note_unsealed, part_path};
use crate::terminal::read_text;
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use lineup::{FORMAT, OneShare, Part};
use seal::opened;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Format of parts written before there were checksums.
const UNSEALED: &str = "gravel/subdomain/1";

const NO_CHECKSUM: &str = "damaged: it has no checksum; `gravel split` writes the files again";

/// The first line of the file of a subdomain.
pub(super) fn first_line(folder: &Path, subdomain: usize) -> Result<Part> {
    let path = part_path(folder, subdomain);
    let in_file = || path.display().to_string();
    let mut line = String::new();
    let file = File::open(&path).with_context(in_file)?;
    BufReader::new(file).read_line(&mut line).with_context(in_file)?;
    of_line(&line, subdomain).with_context(in_file)
}

fn of_line(line: &str, subdomain: usize) -> Result<Part> {
    let opened = opened(line.as_bytes())?;
    let part: Part = serde_json::from_slice(opened.as_deref().unwrap_or(line.as_bytes()))?;
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
pub(super) fn read_part(folder: &Path, subdomain: usize) -> Result<(PathBuf, Part, AnyFrozen)> {
    let path = part_path(folder, subdomain);
    let text = read_text(&path)?;
    let in_file = || path.display().to_string();
    let (first, second) = text.split_once('\n').unwrap_or((&text, ""));
    let part = of_line(first, subdomain).with_context(in_file)?;
    if part.format == UNSEALED {
        note_unsealed(&path, subdomain);
    } else if opened(second.as_bytes()).with_context(in_file)?.is_none() {
        bail!("{}: line 2 is {NO_CHECKSUM}", in_file());
    }
    let frozen = AnyFrozen::of_text(&path, second)?;
    Ok((path, part, frozen))
}

/// Reads the impulses of a share, in its order (N·s), from the files of its own subdomains in a folder.
pub(super) fn read_impulses(folder: &Path, share: &dyn OneShare, problem_hash: &str) -> Result<Vec<f64>> {
    let (facts, cut) = (share.facts(), share.decomposition());
    let mut r = vec![f64::NAN; facts.of_contact * facts.contacts];
    for (e, subdomain) in (cut.first..).zip(&cut.subdomains) {
        let path = Impulses::path(folder, e as usize);
        let in_file = || path.display().to_string();
        let read = Impulses::read(&path, e as usize)?;
        if read.problem_hash != problem_hash {
            bail!("{}: `problem_hash` is {}: it must be {problem_hash}", in_file(), read.problem_hash);
        }
        let contacts = subdomain.contacts.iter().map(|k| share.contacts()[*k as usize]);
        if !read.contact.iter().copied().eq(contacts) {
            bail!(
                "{}: `contact` has not the contacts of subdomain {e}: other subdomains, or another rule",
                in_file()
            );
        }
        let (found, expected) = (read.impulse.len(), facts.of_contact * read.contact.len());
        if found != expected {
            bail!("{}: `impulse` has {found} values where {expected} are expected", in_file());
        }
        let impulses = read.impulse.chunks_exact(facts.of_contact);
        for ((k, number), own) in subdomain.contacts.iter().zip(&read.contact).zip(impulses) {
            if let Err(why) = share.unless_admissible(*k as usize, own) {
                bail!("{}: `impulse` of contact {number} {why}", in_file());
            }
            r[facts.of_contact * *k as usize..][..facts.of_contact].copy_from_slice(own);
        }
    }
    Ok(r)
}
