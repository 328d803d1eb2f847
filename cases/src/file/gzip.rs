//! Compressed files: bytes of gzip, told by their first two, whatever the name of the file.

use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use std::io::{self, Read, Write};

/// First bytes of every gzip file.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Greatest length of a text that a compressed file may hold (B): a thousand times the problem of a thousand spheres.
const MOST: u64 = 1 << 30;

/// Compresses a text. The bytes hold neither a name nor a time.
///
/// # Errors
/// None: it is written to memory.
pub fn compressed(text: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(text)?;
    encoder.finish()
}

/// Returns the content of a file that is compressed, or the bytes as they are.
///
/// # Errors
/// Says that they are damaged, or hold more than [`MOST`].
pub(crate) fn opened(bytes: Vec<u8>) -> Result<Vec<u8>, String> {
    if !bytes.starts_with(GZIP) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    GzDecoder::new(&bytes[..])
        .take(MOST + 1)
        .read_to_end(&mut text)
        .map_err(|error| format!("it is compressed by gzip, and damaged: {error}"))?;
    if text.len() as u64 > MOST {
        return Err(format!("it is compressed, and holds more than {MOST} bytes"));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::{compressed, opened};

    #[test]
    fn text_comes_back_and_damage_is_told() {
        let text = b"{\"impulse\": [0.15, 0.1]}".to_vec();
        let packed = compressed(&text).unwrap();
        assert_eq!(opened(packed.clone()).unwrap(), text);
        assert_eq!(opened(text.clone()).unwrap(), text, "what is not compressed is left as it is");
        for end in [3, packed.len() / 2, packed.len() - 1] {
            assert!(opened(packed[..end].to_vec()).unwrap_err().contains("damaged"), "cut at {end}");
        }
        // Behind the header every changed byte is seen, by the checksum at the latest.
        for at in 10..packed.len() {
            let mut changed = packed.clone();
            changed[at] ^= 1;
            assert_ne!(opened(changed).as_ref(), Ok(&text), "byte {at}");
        }
    }
}
