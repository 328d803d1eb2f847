//! Checksums of what is written to be read back: the last key of an object of JSON, CRC-32 of the text before the comma in front of it.

use thiserror::Error;

/// A file, or a line of one, that was changed after it was written.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum Damaged {
    /// The checksum is of another content.
    #[error("damaged: its checksum is {found}, and `{CHECKSUM}` says {written}")]
    Changed {
        /// Checksum of what stands there.
        found: String,
        /// Checksum of what was written.
        written: String,
    },
    /// A part of the checksum is gone.
    #[error("damaged: its checksum is not whole")]
    Checksum,
}

/// Key of the checksum of an object.
const CHECKSUM: &str = "crc32";

/// Returns the end of an object, in place of the bracket that closes it.
fn end_of(text: &[u8]) -> String {
    format!(",\"{CHECKSUM}\":\"{}\"}}", checksum(text))
}

/// Returns the checksum of some bytes: CRC-32, as eight digits.
pub fn checksum(bytes: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(bytes))
}

/// Returns an object of JSON with its checksum as the last key.
pub fn sealed(object: &str) -> String {
    object
        .rsplit_once('}')
        .map_or_else(String::new, |(text, rest)| format!("{text}{}{rest}", end_of(text.as_bytes())))
}

/// Returns an object without its checksum, or nothing if it has none.
///
/// # Errors
///
/// If it was changed after it was written.
pub fn opened(object: &[u8]) -> Result<Option<Vec<u8>>, Damaged> {
    let object = object.trim_ascii_end();
    let key = format!(",\"{CHECKSUM}\":\"");
    let split = object.len().checked_sub(end_of(b"").len()).map(|length| object.split_at(length));
    let Some((text, end)) = split.filter(|(_, end)| end.starts_with(key.as_bytes())) else {
        return Ok(None);
    };
    if end_of(text).as_bytes() == end {
        return Ok(Some([text, b"}"].concat()));
    }
    let written = String::from_utf8_lossy(&end[key.len()..]).replace(['"', '}'], "");
    Err(Damaged::Changed { found: checksum(text), written })
}

#[cfg(test)]
mod tests {
    use super::{Damaged, checksum, opened, sealed};

    #[test]
    fn object_is_opened_as_it_was_sealed_and_one_without_a_checksum_as_none() {
        // The check value of CRC-32, as its catalogue gives it.
        assert_eq!(checksum(b"123456789"), "cbf43926");
        let object = "{\"a\":[1.5,{}]}\n";
        let text = sealed(object);
        assert!(text.starts_with("{\"a\":[1.5,{}],\"crc32\":\"") && text.ends_with("\"}\n"), "{text}");
        for text in [text.clone(), text.trim_end().to_owned(), text.replace('\n', "\r\n")] {
            assert_eq!(opened(text.as_bytes()).unwrap().unwrap(), object.trim_end().as_bytes(), "{text}");
        }
        for none in [object, "", "{}", "{\"crc32\":1}"] {
            assert_eq!(opened(none.as_bytes()).unwrap(), None, "{none}");
        }
    }

    #[test]
    fn no_flipped_bit_is_taken_for_what_was_sealed() {
        let text = sealed("{\"impulses\":[0.15,0.1]}");
        for bit in 0..8 * text.len() {
            let mut flipped = text.clone().into_bytes();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let key = text.len() - "\"crc32\":\"01234567\"}".len() - 1;
            match opened(&flipped) {
                Err(Damaged::Changed { found, written }) => assert_ne!(found, written),
                // The key itself is damaged: the object has another one, which its reader does not know, or is none.
                Ok(None) => assert!(
                    (key..key + ",\"crc32\":\"".len()).contains(&(bit / 8)) || bit / 8 == text.len() - 1,
                    "bit {bit}"
                ),
                other => panic!("bit {bit}: {other:?}"),
            }
        }
    }
}
