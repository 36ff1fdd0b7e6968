//! Looking at screenshots: is anything drawn, and did it change?

use std::collections::BTreeSet;

use anyhow::{Context as _, Result, bail};

/// A screenshot, decoded.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green and blue of every pixel, row by row.
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Reads a PNG of eight bits a channel, as browsers write them.
    pub fn decode(png: &[u8]) -> Result<Self> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info()?;
        let size = reader.output_buffer_size().context("a picture too large for this machine")?;
        let mut bytes = vec![0; size];
        let frame = reader.next_frame(&mut bytes)?;
        let channels = match frame.color_type {
            png::ColorType::Rgb => 3,
            png::ColorType::Rgba => 4,
            other => bail!("screenshots are in color, not {other:?}"),
        };
        let pixels = bytes[..frame.buffer_size()]
            .chunks_exact(channels)
            .map(|pixel| [pixel[0], pixel[1], pixel[2]])
            .collect();
        Ok(Self { width: frame.width, height: frame.height, pixels })
    }

    /// Returns how many different colors there are; a blank picture has one.
    pub fn colors(&self) -> usize {
        self.pixels.iter().collect::<BTreeSet<_>>().len()
    }

    /// The part of the pixels, from 0 to 1, whose color differs visibly from the other picture's. Pictures of
    /// different sizes differ altogether.
    pub fn difference(&self, other: &Self) -> f64 {
        /// Differences below this come from rounding in the renderer.
        const VISIBLE: u8 = 8;
        if (self.width, self.height) != (other.width, other.height) {
            return 1.0;
        }
        let differing = self
            .pixels
            .iter()
            .zip(&other.pixels)
            .filter(|(mine, theirs)| {
                mine.iter().zip(theirs.iter()).any(|(mine, theirs)| mine.abs_diff(*theirs) > VISIBLE)
            })
            .count();
        differing as f64 / self.pixels.len().max(1) as f64
    }

    /// The part of the pixels, from 0 to 1, that differ visibly from the most common color.
    pub fn drawn(&self) -> f64 {
        let mut counts = std::collections::BTreeMap::new();
        for pixel in &self.pixels {
            *counts.entry(pixel).or_insert(0_usize) += 1;
        }
        let ground = counts.values().max().copied().unwrap_or(0);
        1.0 - ground as f64 / self.pixels.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: Vec<[u8; 3]>) -> Picture {
        Picture { width: pixels.len() as u32, height: 1, pixels }
    }

    #[test]
    fn a_blank_picture_has_one_color_and_nothing_drawn() {
        let blank = picture(vec![[7, 7, 7]; 4]);
        assert_eq!(blank.colors(), 1);
        assert_eq!(blank.drawn(), 0.0);
    }

    #[test]
    fn only_visible_differences_count() {
        let before = picture(vec![[10, 10, 10]; 4]);
        let after = picture(vec![[10, 10, 10], [12, 10, 10], [90, 10, 10], [10, 10, 10]]);
        assert_eq!(before.difference(&after), 0.25);
    }
}
