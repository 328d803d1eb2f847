//! Text files of Siconos: a contact problem as W, q and μ, or as M, H, f, w and μ.
//!
//! Numbers between blanks: unknowns of a contact, contacts, the matrices, the lists. A matrix is how it is stored, its rows and columns,
//! then its entries: dense, column by column; or in blocks, each column by column; or as CSparse prints it, with six digits.

use super::global::local;
use super::symmetry::mirror;
use anyhow::{Context, Result, anyhow, bail};
use lineup::{Global, Triplets};
use local::LocalProblem;
use std::str::{FromStr, SplitAsciiWhitespace};

/// The problem of this text, and what is to be said of it.
///
/// # Errors
/// Says which part of the file has no meaning, or which other problem it seems to hold.
pub(crate) fn problem(text: &str, notes: &mut Vec<String>) -> Result<LocalProblem> {
    let head: Vec<&str> = text.split_ascii_whitespace().take(6).collect();
    let mut words = Words(text.split_ascii_whitespace());
    if let Some(size) = complementarity(text) {
        bail!("{}", seems_complementarity(size));
    }
    let dimension: usize = words.next("the number of unknowns of a contact")?;
    let contacts: usize = words.next("the number of contacts")?;
    let rows = dimension.saturating_mul(contacts);
    let of_contacts = rows.to_string();
    // Its size, then one matrix.
    if let [size, "0" | "1" | "2", down, across, ..] = head[..]
        && size == down
        && size == across
        && (!(2..=3).contains(&dimension) || head.get(4) != Some(&&*of_contacts))
    {
        bail!("{}", seems_complementarity(size));
    }
    if !(2..=3).contains(&dimension) {
        let is = if dimension == 5 { ", as one with rolling friction has" } else { "" };
        bail!(
            "a contact has {dimension} unknowns{is}: 2 or 3 are expected, as Coulomb's law has without rolling"
        );
    }
    // Its law by a number, then one matrix.
    if let [_, _, "0" | "1" | "2", "0" | "1" | "2", down, across] = head[..]
        && [down, across] == [&*of_contacts; 2]
        && head[3] != down
    {
        bail!(
            "a number stands before the matrix, as in files of Siconos' plasticity: contacts by Coulomb's law are read"
        );
    }
    let first = matrix(&mut words, "W")?;
    let next: Vec<&str> = words.0.clone().take(3).collect();
    let is_matrix = matches!(next[..], ["0" | "1" | "2", _, across] if across == of_contacts);
    let is_w = [first.rows, first.columns] == [rows; 2];
    if !is_w || is_matrix && words.0.clone().count() > 2 * rows + rows + contacts + 1 {
        return global((dimension, contacts), first, &mut words, notes);
    }
    let q = words.list("q", rows)?;
    let friction = words.list("mu", contacts)?;
    nothing_more(&mut words, rows, contacts)?;
    Ok(LocalProblem::new(dimension, first.entries, q, friction)?)
}

/// The unknowns of a linear complementarity problem in its oldest form: their number, M and q, and guesses or none. No file of contacts
/// has as few words, or a decimal in second place.
fn complementarity(text: &str) -> Option<&str> {
    let mut words = text.split_ascii_whitespace();
    let word = words.next()?;
    let size: usize = word.parse().ok()?;
    let least = size.checked_mul(size)?.checked_add(size)?;
    let second = words.clone().next()?;
    let (contacts, count) = (second.parse::<usize>(), words.clone().count());
    let is_complementarity = match contacts {
        Err(_) => second.parse::<f64>().is_ok() && count >= least,
        // Contacts whose file was cut off may be as many words: how W is stored and its size, before W.
        Ok(contacts) => {
            let rows = size.saturating_mul(contacts).to_string();
            let head: Vec<&str> = words.skip(1).take(3).collect();
            let is_cut_off =
                matches!(head[..], ["0" | "1" | "2", down, across] if [down, across] == [&*rows; 2]);
            count == least && !is_cut_off
        }
    };
    (size > 0 && is_complementarity).then_some(word)
}

fn seems_complementarity(size: &str) -> String {
    format!(
        "it seems to be a linear complementarity problem of {size} unknowns: contacts of 2 or 3 unknowns are read, with their μ"
    )
}

/// Checks that μ is followed by nothing of another law: by 1 and guesses of r and v, by 0, or by a 1 alone, whose guesses
/// are not there, as in twenty of the dumps of Siconos' own tests. Also of one contact such an integer is no parameter: these are decimals.
fn nothing_more(words: &mut Words, rows: usize, contacts: usize) -> Result<()> {
    let rest: Vec<&str> = words.0.clone().collect();
    match (rest.len(), rest.first()) {
        (0, _) | (1, Some(&("0" | "1"))) => Ok(()),
        (count, Some(&("0" | "1"))) if count == 1 + 2 * rows => Ok(()),
        (count, first) => {
            let first = first.unwrap_or(&"");
            let is = if count == contacts {
                ", one for each contact, as in files of rolling friction or of Mohr and Coulomb's law"
            } else {
                ""
            };
            bail!(
                "{count} words follow mu, \"{first}\" first{is}: Coulomb's law has μ alone, so the file is of another problem"
            )
        }
    }
}

/// A global problem, from its M on.
fn global(
    (dimension, contacts): (usize, usize),
    mut mass: Triplets,
    words: &mut Words,
    notes: &mut Vec<String>,
) -> Result<LocalProblem> {
    let rows = dimension.saturating_mul(contacts);
    let size = [mass.rows, mass.columns];
    let h = matrix(words, "H").with_context(|| {
        format!(
            "the first matrix has {} x {} entries and {contacts} contacts of {dimension} unknowns have {rows}, so that it would be \
             the M of a global problem",
            size[0], size[1]
        )
    })?;
    let f = words.list("f", size[0])?;
    let w = words.list("w", rows)?;
    let friction = words.list("mu", contacts)?;
    nothing_more(words, rows, contacts)?;
    notes.extend(mirror(&mut mass));
    local(Global { mass, h, f, w, friction }, dimension)
}

/// A matrix: how it is stored, its rows and columns, its entries.
fn matrix(words: &mut Words, name: &str) -> Result<Triplets> {
    let storage: u32 = words.next(&format!("how {name} is stored"))?;
    let (rows, columns) =
        (words.next(&format!("the rows of {name}"))?, words.next(&format!("the columns of {name}"))?);
    let entries = match storage {
        0 => dense(words, rows, columns)?,
        1 => in_blocks(words, rows, columns)?,
        2 => printed(words)?,
        other => {
            bail!(
                "{name} is stored in the way {other}: 0 (dense), 1 (in blocks) or 2 (by CSparse) is expected"
            )
        }
    };
    Ok(Triplets { rows, columns, entries })
}

/// Row, column, value.
type Entry = (usize, usize, f64);

/// Words of a file that are still to be read.
struct Words<'t>(SplitAsciiWhitespace<'t>);

impl<'t> Words<'t> {
    fn word(&mut self, what: &str) -> Result<&'t str> {
        self.0.next().ok_or_else(|| anyhow!("the file ends before {what}"))
    }

    fn next<T: FromStr<Err: std::error::Error + Send + Sync + 'static>>(&mut self, what: &str) -> Result<T> {
        let word = self.word(what)?;
        word.parse().with_context(|| format!("{what}: \"{word}\" is no such number"))
    }

    fn list<T: FromStr<Err: std::error::Error + Send + Sync + 'static>>(
        &mut self,
        what: &str,
        count: usize,
    ) -> Result<Vec<T>> {
        (0..count).map(|_| self.next(what)).collect()
    }
}

fn dense(words: &mut Words, rows: usize, columns: usize) -> Result<Vec<Entry>> {
    // Its size once more.
    let size: Vec<usize> = words.list("the size of W", 2)?;
    if size != [rows, columns] {
        bail!("the size of W is {size:?}, and [{rows}, {columns}] above");
    }
    let mut entries = Vec::new();
    for column in 0..columns {
        for row in 0..rows {
            let value: f64 = words.next("W")?;
            if row == column || value != 0.0 {
                entries.push((row, column, value));
            }
        }
    }
    Ok(entries)
}

/// The blocks of each row of blocks one after the other.
fn in_blocks(words: &mut Words, rows: usize, columns: usize) -> Result<Vec<Entry>> {
    let blocks: usize = words.next("the number of blocks of W")?;
    let [down, across] =
        [words.next::<usize>("the rows of blocks of W")?, words.next("its columns of blocks")?];
    // Where each row and each column of blocks ends.
    let row_ends: Vec<usize> = words.list("the sizes of the blocks of W", down)?;
    let column_ends: Vec<usize> = words.list("the sizes of the blocks of W", across)?;
    let [filled_rows, filled] =
        [words.next::<usize>("the filled rows of W")?, words.next("its filled blocks")?];
    let starts: Vec<usize> = words.list("the rows of the blocks of W", filled_rows)?;
    let places: Vec<usize> = words.list("the columns of the blocks of W", filled)?;
    let span = |ends: &[usize], at: usize, all: usize| {
        let from = at.checked_sub(1).map_or(Some(&0), |before| ends.get(before))?;
        ends.get(at).filter(|end| (*from..=all).contains(*end)).map(|end| *from..*end)
    };
    let mut entries = Vec::new();
    for block in 0..blocks {
        let number: usize = words.next("the number of a block of W")?;
        let there = starts.partition_point(|start| *start <= block).checked_sub(1).zip(places.get(block));
        let place = there
            .and_then(|(row, column)| span(&row_ends, row, rows).zip(span(&column_ends, *column, columns)));
        let Some((rows, columns)) = place.filter(|_| number == block) else {
            bail!("W: block {number} is the one after {block} others, which has no place");
        };
        for column in columns {
            for row in rows.clone() {
                entries.push((row, column, words.next("W")?));
            }
        }
    }
    Ok(entries)
}

/// Reads a matrix as CSparse prints it, column by column or as triplets.
fn printed(words: &mut Words) -> Result<Vec<Entry>> {
    let _origin: u32 = words.next("how W is stored")?;
    // A title, then "m-by-n, nzmax: … nnz: …", and of columns ", 1-norm: …".
    while words.word("the number of entries of W")? != "nnz:" {}
    let count = words.word("the number of entries of W")?;
    let has_norm = count.ends_with(',');
    let count: usize = count.trim_end_matches(',').parse().with_context(|| format!("W: nnz is {count:?}"))?;
    if has_norm {
        words.word("the norm of W")?;
        words.word("the norm of W")?;
    }
    let (mut entries, mut column) = (Vec::new(), 0);
    while entries.len() < count {
        let word = words.word("an entry of W")?;
        if word == "col" {
            column = words.next("a column of W")?;
            // ": locations … to …"
            for _ in 0..5 {
                words.word("a column of W")?;
            }
            continue;
        }
        let row = word.parse().with_context(|| format!("W: {word:?} is no row"))?;
        match words.word("an entry of W")? {
            ":" => {}
            word => {
                column = word.parse().with_context(|| format!("W: {word:?} is no column"))?;
                words.word("an entry of W")?;
            }
        }
        entries.push((row, column, words.next("an entry of W")?));
    }
    Ok(entries)
}
