//! `MovingAI` benchmark maps (Sturtevant 2012): a character for each cell, rows from the top.
//!
//! A map of the type `octile-corner` counts corners of cells: after the rows of its corners' heights, which are not read, come
//! rows of cells whose last column and last row are none.

use super::{FormatError, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "MovingAI map";

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let text = std::str::from_utf8(bytes).map_err(|_| malformed("the file is not text".into()))?;
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines();
    let (mut width, mut height, mut has_corners) = (None, None, false);
    for line in lines.by_ref() {
        let mut words = line.split_ascii_whitespace();
        match (words.next(), words.next()) {
            (Some("type"), Some(kind)) => has_corners = kind == "octile-corner",
            (None, None) => {}
            (Some("width"), Some(value)) => width = Some(size(value)?),
            (Some("height"), Some(value)) => height = Some(size(value)?),
            (Some("map"), None) => break,
            _ => return Err(malformed(format!("unexpected line in the header: `{line}`"))),
        }
    }
    let (Some(width), Some(height)) = (width, height) else {
        return Err(malformed("the header needs `width` and `height`".into()));
    };
    let count = checked_cell_count(u64::from(width), u64::from(height))?;
    if text.len() < count {
        return Err(malformed(format!("the file is too short for {width} × {height} cells")));
    }
    let mut samples = Vec::with_capacity(count);
    let cut = u32::from(has_corners);
    if has_corners {
        lines.by_ref().take(height as usize).for_each(drop);
        checked_cell_count(u64::from(width.saturating_sub(1)), u64::from(height.saturating_sub(1)))?;
    }
    for row in 0..height - cut {
        let line = lines.next().unwrap_or_default().trim_end_matches('\r');
        if line.chars().count() != width as usize {
            return Err(malformed(format!("row {} must have {width} cells: `{line}`", row + 1)));
        }
        for character in line.chars().take((width - cut) as usize) {
            // A cell with a small letter is split between two heights.
            samples.push(match character.to_ascii_uppercase() {
                '.' | 'G' | 'S' => 0.0,
                '@' | 'O' | 'T' | 'W' => 1.0,
                _ => return Err(malformed(format!("row {} has a cell `{character}`", row + 1))),
            });
        }
    }
    let (width, height) = (width - cut, height - cut);
    Ok(Raster::new((width, height), samples, Meaning::Obstacles))
}

/// Returns whether a text begins with the sizes of a map; some programs leave the line with its type out.
pub(super) fn has_header(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(512)]);
    let lines = start.strip_prefix('\u{feff}').unwrap_or(&start).lines();
    let mut words = lines.filter_map(|line| line.split_ascii_whitespace().next());
    [words.next(), words.next(), words.next()] == ["height", "width", "map"].map(Some)
}

fn size(word: &str) -> Result<u32, FormatError> {
    word.parse().map_err(|_| malformed(format!("`{word}` is not a size")))
}

fn malformed(problem: String) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem }
}
