//! The blocks (strips or tiles) of an image. Sparse files, as GDAL writes them, store only some.

use ::tiff::decoder::DecodingResult;
use ::tiff::tags::Tag;

use super::{Decoder, FormatError, limits, malformed, problem, unsupported};

/// A block without stored samples: its place in the image, in pixels.
pub(super) struct Missing {
    pub column: usize,
    pub row: usize,
    pub width: usize,
    pub height: usize,
}

/// Decodes the current image (of several planes, the first), and returns which blocks are missing; their samples are 0.
pub(super) fn read(decoder: &mut Decoder<'_>) -> Result<(DecodingResult, Vec<Missing>), FormatError> {
    let (offsets, lengths) = (offsets(decoder)?, lengths(decoder)?);
    let has_lengths = lengths.iter().any(|&length| length != 0);
    // The header of the file is at 0, so that no block begins there.
    let is_missing = |index: usize| {
        offsets.get(index).is_none_or(|&offset| offset == 0)
            || (has_lengths && lengths.get(index).is_none_or(|&length| length == 0))
    };
    if !(0..offsets.len()).any(is_missing) {
        return Ok((decoder.read_image().map_err(|error| problem(&error))?, Vec::new()));
    }
    let mut layout = decoder.image_buffer_layout().map_err(|error| problem(&error))?;
    layout.complete_len = layout.len;
    let mut image = DecodingResult::U8(Vec::new());
    image.resize_to(&layout, &limits()).map_err(|error| problem(&error))?;
    let row_bytes = layout.row_stride.map_or(0, usize::from);
    let first = decoder.image_chunk_buffer_layout(0).map_err(|error| problem(&error))?;
    // If there are several blocks across, the first one is not cut off.
    let across_bytes = first.row_stride.map_or(0, usize::from);
    let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
    let (block_width, block_height) = decoder.chunk_dimensions();
    let (across, down) = (width.div_ceil(block_width), height.div_ceil(block_height));
    let mut missing = Vec::new();
    for (row, column) in (0..down).flat_map(|row| (0..across).map(move |column| (row, column))) {
        let index = row * across + column;
        let (width, height) = decoder.chunk_data_dimensions(index);
        let (top, left) = ((row * block_height) as usize, (column * block_width) as usize);
        if is_missing(index as usize) {
            let (width, height) = (width as usize, height as usize);
            missing.push(Missing { column: left, row: top, width, height });
            continue;
        }
        let layout = decoder.image_chunk_buffer_layout(index).map_err(|error| problem(&error))?;
        let mut block = vec![0; layout.len];
        decoder.read_chunk_bytes(index, &mut block).map_err(|error| problem(&error))?;
        let stride = layout.row_stride.map_or(1, usize::from);
        let mut buffer = image.as_buffer(0);
        for (line, samples) in block.chunks_exact(stride).take(height as usize).enumerate() {
            let start = (top + line) * row_bytes + column as usize * across_bytes;
            let place = buffer.as_bytes_mut().get_mut(start..start + stride);
            place.ok_or_else(|| malformed("its blocks are larger than its image"))?.copy_from_slice(samples);
        }
    }
    Ok((image, missing))
}

/// Refuses compressed blocks that can't be told apart or decoded: without lengths, or in the LZW of before 1990.
pub(super) fn refuse_undecodable(
    bytes: &[u8],
    decoder: &mut Decoder<'_>,
    is_lzw: bool,
) -> Result<(), FormatError> {
    let (offsets, lengths) = (offsets(decoder)?, lengths(decoder)?);
    let is_stored = |&&offset: &&u64| offset != 0;
    let Some(&first) = offsets.iter().find(is_stored) else { return Ok(()) };
    if lengths.iter().all(|&length| length == 0) {
        return Err(unsupported(
            "it does not say how long its compressed blocks are; write it again, as with `gdal_translate IN.tif OUT.tif`",
        ));
    }
    // A stream begins with the code 256, of nine bits: 80 in today's order of bits, and 00 and an odd byte in the former.
    let start = usize::try_from(first).ok().and_then(|at| bytes.get(at..at.checked_add(2)?));
    if is_lzw && start.is_some_and(|start| start[0] == 0 && start[1] % 2 == 1) {
        return Err(unsupported(
            "its LZW has the bits in the order of before TIFF 6; write it again, as with `gdal_translate IN.tif OUT.tif`",
        ));
    }
    Ok(())
}

/// Where each block begins in the file.
fn offsets(decoder: &mut Decoder<'_>) -> Result<Vec<u64>, FormatError> {
    table(decoder, Tag::TileOffsets, Tag::StripOffsets)
}

/// How many bytes each block has in the file.
fn lengths(decoder: &mut Decoder<'_>) -> Result<Vec<u64>, FormatError> {
    table(decoder, Tag::TileByteCounts, Tag::StripByteCounts)
}

fn table(decoder: &mut Decoder<'_>, of_tiles: Tag, of_strips: Tag) -> Result<Vec<u64>, FormatError> {
    let of_tiles = decoder.find_tag_unsigned_vec(of_tiles).map_err(|error| problem(&error))?;
    if let Some(of_tiles) = of_tiles {
        return Ok(of_tiles);
    }
    let of_strips = decoder.find_tag_unsigned_vec(of_strips).map_err(|error| problem(&error))?;
    Ok(of_strips.unwrap_or_default())
}
