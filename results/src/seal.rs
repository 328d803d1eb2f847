//! Checksums of Parquet tables: a value of their metadata, since polars writes none of pages.

use seal::{Damaged, checksum};

/// Key of the checksum among the metadata of a table, and first word of its value. Which of the two is damaged, the other is left.
pub(crate) const OF_TABLE: &str = "gravel.crc32";

/// Returns its value before the checksums are known. It holds two: of the file, in which this one is zeros, and of all tables that
/// are written with it.
pub(crate) fn of_no_table() -> String {
    format!("{OF_TABLE} {0} {0}", "0".repeat(DIGITS))
}

/// Digits of a checksum.
const DIGITS: usize = 8;

/// Returns the place of the checksum of a table, and that of all tables behind it; nothing if there is none.
fn places(table: &[u8]) -> Result<Option<(usize, usize)>, Damaged> {
    let last = |bytes: &[u8]| bytes.windows(OF_TABLE.len()).rposition(|part| part == OF_TABLE.as_bytes());
    let Some(value) = last(table) else { return Ok(None) };
    let of_table = value + OF_TABLE.len() + 1;
    let of_all = of_table + DIGITS + 1;
    if last(&table[..value]).is_none() || table.len() < of_all + DIGITS {
        return Err(Damaged::Checksum);
    }
    Ok(Some((of_table, of_all)))
}

fn put(table: &mut [u8], place: usize, digits: &str) {
    table[place..place + DIGITS].copy_from_slice(digits.as_bytes());
}

/// Puts their checksums into tables that are written together.
pub(crate) fn seal_tables(tables: &mut [Vec<u8>]) -> Result<(), Damaged> {
    let each: Vec<String> = tables.iter().map(|table| checksum(table)).collect();
    let all = checksum(each.concat().as_bytes());
    for table in tables {
        let (of_table, of_all) = places(table)?.ok_or(Damaged::Checksum)?;
        put(table, of_all, &all);
        let own = checksum(table);
        put(table, of_table, &own);
    }
    Ok(())
}

/// Returns the checksum of all tables that were written with this one, or nothing if it is from before there were any.
pub(crate) fn open_table(mut table: Vec<u8>) -> Result<(Vec<u8>, Option<String>), Damaged> {
    let Some((of_table, of_all)) = places(&table)? else { return Ok((table, None)) };
    let text = |place: usize| String::from_utf8_lossy(&table[place..place + DIGITS]).into_owned();
    let (written, all) = (text(of_table), text(of_all));
    put(&mut table, of_table, &"0".repeat(DIGITS));
    let found = checksum(&table);
    if found == written { Ok((table, Some(all))) } else { Err(Damaged::Changed { found, written }) }
}
