//! Portable gray maps (Netpbm): P2 text and P5 binary, one or two bytes a sample.

use super::{FormatError, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "PGM";

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let mut tokens = Tokens { bytes, at: 0 };
    let magic = tokens.next()?;
    let (width, height) = (tokens.number("the width")?, tokens.number("the height")?);
    let greatest = tokens.number("the maximum gray level")?;
    if !(1..=65_535).contains(&greatest) {
        return Err(malformed(format!("the maximum gray level must be from 1 to 65535, not {greatest}")));
    }
    let count = checked_cell_count(u64::from(width), u64::from(height))?;
    let samples = if magic == b"P5" {
        // One white space character ends the header.
        let data = bytes.get(tokens.at + 1..).unwrap_or_default();
        let sample_bytes = if greatest < 256 { 1 } else { 2 };
        let Some(data) = data.get(..count * sample_bytes) else {
            return Err(malformed(format!(
                "{width} × {height} samples take {} bytes, and {} follow the header",
                count * sample_bytes,
                data.len()
            )));
        };
        if sample_bytes == 1 {
            data.iter().map(|&sample| f32::from(sample)).collect()
        } else {
            data.chunks_exact(2).map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]]))).collect()
        }
    } else {
        // A sample takes at least a digit and a space.
        if bytes.len() - tokens.at < 2 * count - 1 {
            return Err(malformed(format!("the file ends before its {count} samples")));
        }
        (0..count).map(|_| tokens.number("a sample").map(|sample| sample as f32)).collect::<Result<_, _>>()?
    };
    Ok(Raster::new((width, height), samples, Meaning::Levels { greatest: Some(greatest) }))
}

fn malformed(problem: String) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem }
}

/// Words between white space, with comments from `#` to the end of the line left out.
struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    fn next(&mut self) -> Result<&'a [u8], FormatError> {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'#' {
                while self.bytes.get(self.at).is_some_and(|&byte| byte != b'\n') {
                    self.at += 1;
                }
            } else if byte.is_ascii_whitespace() {
                self.at += 1;
            } else {
                break;
            }
        }
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|byte| !byte.is_ascii_whitespace()) {
            self.at += 1;
        }
        if start == self.at {
            Err(malformed("the file ends too early".into()))
        } else {
            Ok(&self.bytes[start..self.at])
        }
    }

    fn number(&mut self, what: &str) -> Result<u32, FormatError> {
        let word = self.next()?;
        std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()).ok_or_else(|| {
            malformed(format!("{what} should be a number but is `{}`", String::from_utf8_lossy(word)))
        })
    }
}
