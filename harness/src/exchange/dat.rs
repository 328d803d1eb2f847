//! Text files of Siconos: a contact problem as W, q and μ.
//!
//! Numbers between blanks: unknowns of a contact, contacts, how W is stored, its rows and columns, W, q, μ. W is dense,
//! column by column; or in blocks, each column by column; or as CSparse prints it, with six digits.

use anyhow::{Context, Result, anyhow, bail};
use local::LocalProblem;
use std::str::{FromStr, SplitAsciiWhitespace};

/// The problem of this text.
///
/// # Errors
/// Says which part of the file has no meaning.
pub(crate) fn problem(text: &str) -> Result<LocalProblem> {
    let mut words = Words(text.split_ascii_whitespace());
    let dimension: usize = words.next("the number of unknowns of a contact")?;
    if !(2..=3).contains(&dimension) {
        bail!(
            "a contact has {dimension} unknowns: 2 or 3 are expected, as Coulomb's law has without rolling"
        );
    }
    let contacts: usize = words.next("the number of contacts")?;
    let storage: u32 = words.next("how W is stored")?;
    let size = [words.next::<usize>("the rows of W")?, words.next("the columns of W")?];
    let rows = dimension.saturating_mul(contacts);
    if size != [rows; 2] {
        bail!(
            "W has {} x {} entries: {contacts} contacts of {dimension} unknowns have {rows} x {rows}; a global problem of M and H is \
             read from FCLIB alone",
            size[0],
            size[1]
        );
    }
    let entries = match storage {
        0 => dense(&mut words, rows)?,
        1 => in_blocks(&mut words, rows)?,
        2 => printed(&mut words)?,
        other => {
            bail!("W is stored in the way {other}: 0 (dense), 1 (in blocks) or 2 (by CSparse) is expected")
        }
    };
    let q = words.list("q", rows)?;
    let friction = words.list("mu", contacts)?;
    // Whether guesses follow, and these.
    let more = words.0.count();
    if more > 1 + 2 * rows {
        bail!("{more} words follow mu: a global problem of M and H is read from FCLIB alone");
    }
    Ok(LocalProblem::new(dimension, entries, q, friction)?)
}

/// Row, column, value.
type Entry = (usize, usize, f64);

/// What is left of a file.
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

fn dense(words: &mut Words, rows: usize) -> Result<Vec<Entry>> {
    // Its size once more.
    let size: Vec<usize> = words.list("the size of W", 2)?;
    if size != [rows; 2] {
        bail!("the size of W is {size:?}, and [{rows}, {rows}] above");
    }
    let mut entries = Vec::new();
    for column in 0..rows {
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
fn in_blocks(words: &mut Words, rows: usize) -> Result<Vec<Entry>> {
    let blocks: usize = words.next("the number of blocks of W")?;
    let [down, across] =
        [words.next::<usize>("the rows of blocks of W")?, words.next("its columns of blocks")?];
    // Where each row and each column of blocks ends.
    let row_ends: Vec<usize> = words.list("the sizes of the blocks of W", down)?;
    let column_ends: Vec<usize> = words.list("the sizes of the blocks of W", across)?;
    let [filled_rows, filled] =
        [words.next::<usize>("the filled rows of W")?, words.next("its filled blocks")?];
    let starts: Vec<usize> = words.list("the rows of the blocks of W", filled_rows)?;
    let columns: Vec<usize> = words.list("the columns of the blocks of W", filled)?;
    let span = |ends: &[usize], at: usize| {
        let from = at.checked_sub(1).map_or(Some(&0), |before| ends.get(before))?;
        ends.get(at).filter(|end| (*from..=rows).contains(*end)).map(|end| *from..*end)
    };
    let mut entries = Vec::new();
    for block in 0..blocks {
        let number: usize = words.next("the number of a block of W")?;
        let there = starts.partition_point(|start| *start <= block).checked_sub(1).zip(columns.get(block));
        let place = there.and_then(|(row, column)| span(&row_ends, row).zip(span(&column_ends, *column)));
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

/// As CSparse prints a matrix, column by column or as triplets.
fn printed(words: &mut Words) -> Result<Vec<Entry>> {
    let _origin: u32 = words.next("how W is stored")?;
    // A title, then "m-by-n, nzmax: … nnz: …, 1-norm: …".
    while words.word("the number of entries of W")? != "nnz:" {}
    let count = words.word("the number of entries of W")?;
    let count: usize = count.trim_end_matches(',').parse().with_context(|| format!("W: nnz is {count:?}"))?;
    words.word("the norm of W")?;
    words.word("the norm of W")?;
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
