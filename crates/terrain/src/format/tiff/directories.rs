//! The image directories of a TIFF file: the mask among them, and how the decoder is kept from inverting values.

use ::tiff::decoder::ifd::Value;
use ::tiff::tags::{ByteOrder, IfdPointer, PhotometricInterpretation, Tag, Type};

use super::{Decoder, FormatError, blocks, malformed, number, open, problem, unsupported};

/// A pyramid halves an image some 25 times at most; each has a mask.
const MAX_DIRECTORY_COUNT: usize = 128;
/// Bits of `NewSubfileType`.
const REDUCED: u32 = 1;
const MASK: u32 = 4;

/// Returns which cells are valid by the internal mask of the first image, row by row; `None` if there is no mask.
pub(super) fn read_mask(bytes: &[u8], decoder: &mut Decoder<'_>) -> Result<Option<Vec<bool>>, FormatError> {
    let Some(index) = mask_index(decoder)? else { return Ok(None) };
    let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
    decoder.seek_to_image(index).map_err(|error| problem(&error))?;
    if decoder.dimensions().map_err(|error| problem(&error))? != (width, height) {
        return Err(unsupported("its mask and its heights must have the same size"));
    }
    let bits = number(decoder, Tag::BitsPerSample)?.unwrap_or(1);
    let bands = number(decoder, Tag::SamplesPerPixel)?.unwrap_or(1);
    if bands != 1 {
        return Err(unsupported(format!("its mask has {bands} bands")));
    }
    if !matches!(bits, 1 | 8) {
        return Err(unsupported(format!("its mask has samples of {bits} bits")));
    }
    let gray = without_inversion(bytes, decoder)?;
    let mut decoder = open(&gray)?;
    decoder.seek_to_image(index).map_err(|error| problem(&error))?;
    // Where no block of the mask is stored, nothing is valid.
    let (image, _) = blocks::read(&mut decoder)?;
    let ::tiff::decoder::DecodingResult::U8(packed) = image else {
        return Err(unsupported("its mask does not have bytes"));
    };
    let (width, height) = (width as usize, height as usize);
    let row_bytes = if bits == 1 { width.div_ceil(8) } else { width };
    if packed.len() != row_bytes * height {
        return Err(malformed("its mask is incomplete"));
    }
    let is_valid = |row: &[u8], column: usize| match bits {
        1 => row[column / 8] & (0x80 >> (column % 8)) != 0,
        _ => row[column] != 0,
    };
    let rows = packed.chunks_exact(row_bytes);
    Ok(Some(rows.flat_map(|row| (0..width).map(move |column| is_valid(row, column))).collect()))
}

/// The place of the mask of the whole image in the list of directories.
fn mask_index(decoder: &mut Decoder<'_>) -> Result<Option<usize>, FormatError> {
    let mut next = decoder.image_ifd().directory().next();
    let mut index = 0;
    while let Some(pointer) = next {
        index += 1;
        if index == MAX_DIRECTORY_COUNT {
            return Err(unsupported(format!("more than {MAX_DIRECTORY_COUNT} images, or images in a cycle")));
        }
        let directory = decoder.read_directory(pointer).map_err(|error| problem(&error))?;
        let kind = decoder.read_directory_tags(&directory).find_tag(Tag::NewSubfileType);
        let kind = kind.and_then(|value| value.map(Value::into_u32).transpose());
        let kind = kind.map_err(|error| problem(&error))?.unwrap_or(0);
        if kind & MASK != 0 && kind & REDUCED == 0 {
            return Ok(Some(index));
        }
        next = directory.next();
    }
    Ok(None)
}

/// A copy of the file in which the decoder's current image has `BlackIsZero`: of other interpretations, the decoder
/// inverts `WhiteIsZero` and refuses `TransparencyMask`, while their samples are stored alike.
pub(super) fn without_inversion(bytes: &[u8], decoder: &mut Decoder<'_>) -> Result<Vec<u8>, FormatError> {
    let order = decoder.byte_order();
    let place = (decoder.ifd_pointer())
        .and_then(|directory| interpretation_place(bytes, order, directory))
        .ok_or_else(|| malformed("its PhotometricInterpretation must be one number"))?;
    let value = PhotometricInterpretation::BlackIsZero.to_u16();
    let mut copy = bytes.to_vec();
    copy[place..place + 2].copy_from_slice(&match order {
        ByteOrder::BigEndian => value.to_be_bytes(),
        ByteOrder::LittleEndian => value.to_le_bytes(),
    });
    Ok(copy)
}

/// The byte at which the value of `PhotometricInterpretation` begins in a directory.
fn interpretation_place(bytes: &[u8], order: ByteOrder, directory: IfdPointer) -> Option<usize> {
    let short = |at: usize| {
        let pair = bytes.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(match order {
            ByteOrder::BigEndian => u16::from_be_bytes(pair),
            ByteOrder::LittleEndian => u16::from_le_bytes(pair),
        })
    };
    // BigTIFF counts entries with 8 bytes, in entries of 20 with the value at 12.
    let (count_bytes, entry_bytes, value_at) = if short(2)? == 43 { (8, 20, 12) } else { (2, 12, 8) };
    let start = usize::try_from(directory.0).ok()?;
    let entries = (start.checked_add(count_bytes)?..bytes.len()).step_by(entry_bytes);
    // The decoder has found the tag in this directory, so that the search ends in it.
    let entry =
        entries.into_iter().find(|&entry| short(entry) == Some(Tag::PhotometricInterpretation.to_u16()))?;
    let place = entry + value_at;
    (short(entry + 2)? == Type::SHORT.to_u16() && short(place).is_some()).then_some(place)
}
