//! PNG height maps and obstacle pictures: gray, palette or color, 8 or 16 bits; transparent pixels have no data.

use std::io::Cursor;

use super::{FormatError, MAX_CELL_COUNT, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "PNG";

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let limits = ::png::Limits { bytes: 8 * MAX_CELL_COUNT as usize };
    let mut decoder = ::png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(::png::Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(|error| malformed(&error))?;
    let (width, height) = (header.width, header.height);
    let count = checked_cell_count(u64::from(width), u64::from(height))?;
    let mut reader = decoder.read_info().map_err(|error| malformed(&error))?;
    let (color, depth) = reader.output_color_type();
    let (channels, sample_bytes) = (color.samples(), if depth == ::png::BitDepth::Sixteen { 2 } else { 1 });
    let size = reader.output_buffer_size().unwrap_or(usize::MAX);
    if size < count * channels * sample_bytes || size > 8 * count + 64 {
        return Err(FormatError::Unsupported { format: FORMAT, problem: format!("{color:?} at {depth:?}") });
    }
    let mut buffer = vec![0; size];
    reader.next_frame(&mut buffer).map_err(|error| malformed(&error))?;
    let has_alpha = matches!(color, ::png::ColorType::GrayscaleAlpha | ::png::ColorType::Rgba);
    let level = |sample: &[u8]| sample.iter().fold(0, |level: u32, &byte| level << 8 | u32::from(byte));
    let colors = channels - usize::from(has_alpha);
    let samples = buffer
        .chunks_exact(channels * sample_bytes)
        .take(count)
        .map(|pixel| {
            let (color, alpha) = pixel.split_at(colors * sample_bytes);
            if has_alpha && level(alpha) == 0 {
                return f32::NAN;
            }
            // Gray is its own mean; a color counts as its mean.
            let sum: u32 = color.chunks_exact(sample_bytes).map(level).sum();
            (f64::from(sum) / colors as f64) as f32
        })
        .collect();
    let greatest = if sample_bytes == 2 { 65_535 } else { 255 };
    Ok(Raster::new((width, height), samples, Meaning::Levels { greatest: Some(greatest) }))
}

fn malformed(error: &::png::DecodingError) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem: error.to_string() }
}
