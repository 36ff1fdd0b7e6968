//! TIFF and `GeoTIFF` elevation maps: 8 to 64 bits, integer or float, with what `GeoTIFF` and GDAL say about them.
//!
//! What would put heights in wrong places or give them wrong values when it is passed over is read, or refused by name.
//! Files beside the map (`.tfw`, `.msk`, `.aux.xml`) are not looked at.

mod blocks;
mod calibration;
mod directories;
mod georeference;

use std::io::Cursor;

use ::tiff::TiffUnsupportedError;
use ::tiff::decoder::{DecodingResult, Limits};
use ::tiff::tags::{CompressionMethod, PhotometricInterpretation, Tag};

use super::{FormatError, MAX_CELL_COUNT, Meaning, Raster, checked_cell_count};
use calibration::Calibration;
use georeference::Georeference;

const FORMAT: &str = "TIFF";

type Decoder<'a> = ::tiff::decoder::Decoder<Cursor<&'a [u8]>>;

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let mut decoder = open(bytes)?;
    let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
    let count = checked_cell_count(u64::from(width), u64::from(height))?;
    refuse_what_holds_no_heights(bytes, &mut decoder)?;
    let georeference = Georeference::read(&mut decoder)?;
    let mut calibration = Calibration::read(&mut decoder, georeference.vertical_unit_m)?;
    let alpha_band = alpha_band(&mut decoder)?;
    let zero_is_white = number(&mut decoder, Tag::PhotometricInterpretation)?
        == Some(PhotometricInterpretation::WhiteIsZero.to_u16().into());
    // As GDAL does, the values of a picture in which 0 is white are taken as they are stored.
    let plain = if zero_is_white { Some(directories::without_inversion(bytes, &mut decoder)?) } else { None };
    let mask = directories::read_mask(bytes, &mut decoder)?;
    let mut decoder = open(plain.as_deref().unwrap_or(bytes))?;
    let (image, missing) = blocks::read(&mut decoder)?;
    if matches!(image, DecodingResult::F32(_)) {
        calibration.round_no_data_to_single();
    }
    let (mut values, greatest) = to_doubles(image)?;
    if values.len() < count {
        return Err(malformed(format!("{} samples for {width} × {height} pixels", values.len())));
    }
    // The first band of several is the elevation.
    let bands = values.len() / count;
    for block in missing {
        for row in block.row..block.row + block.height {
            let start = row * width as usize + block.column;
            values[bands * start..bands * (start + block.width)].fill(calibration.stored_nothing());
        }
    }
    if alpha_band.is_some_and(|band| band >= bands) {
        return Err(unsupported("its transparency is stored separately from its heights (INTERLEAVE=BAND)"));
    }
    let mut samples: Vec<f32> = values
        .chunks_exact(bands)
        .take(count)
        .map(|pixel| match alpha_band {
            Some(band) if pixel[band] == 0.0 => f32::NAN,
            _ => calibration.height_m(pixel[0]),
        })
        .collect();
    if let Some(valid) = mask {
        for (sample, _) in samples.iter_mut().zip(valid).filter(|(_, valid)| !valid) {
            *sample = f32::NAN;
        }
    }
    georeference.turn_north_up(&mut samples, width as usize);
    let meaning = match greatest.filter(|_| calibration.is_identity()) {
        Some(greatest) if zero_is_white => Meaning::InvertedLevels { greatest },
        greatest => Meaning::Levels { greatest },
    };
    let Georeference { cell_size_m, origin_m, .. } = georeference;
    Ok(Raster { cell_size_m, origin_m, ..Raster::new((width, height), samples, meaning) })
}

fn open(bytes: &[u8]) -> Result<Decoder<'_>, FormatError> {
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(|error| problem(&error))?;
    Ok(decoder.with_limits(limits()))
}

/// As much memory as the largest map takes with 64 bits.
fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 8 * MAX_CELL_COUNT as usize;
    limits.intermediate_buffer_size = 8 * MAX_CELL_COUNT as usize;
    limits
}

/// Names what can't be decoded, or would be decoded to something else than heights from the top left.
fn refuse_what_holds_no_heights(bytes: &[u8], decoder: &mut Decoder<'_>) -> Result<(), FormatError> {
    let compression = number(decoder, Tag::Compression)?.unwrap_or(1);
    let name = match u16::try_from(compression).map(CompressionMethod::from_u16_exhaustive) {
        Ok(
            CompressionMethod::None
            | CompressionMethod::LZW
            | CompressionMethod::Deflate
            | CompressionMethod::OldDeflate
            | CompressionMethod::PackBits,
        ) => None,
        Ok(CompressionMethod::ZSTD) => Some("ZSTD".to_owned()),
        Ok(CompressionMethod::WebP) => Some("WebP".to_owned()),
        Ok(CompressionMethod::JPEG | CompressionMethod::ModernJPEG) => Some("JPEG".to_owned()),
        Ok(CompressionMethod::Unknown(34_887)) => Some("LERC".to_owned()),
        Ok(CompressionMethod::Unknown(34_925)) => Some("LZMA".to_owned()),
        Ok(CompressionMethod::Huffman | CompressionMethod::Fax3 | CompressionMethod::Fax4) => {
            Some("CCITT, as for documents".to_owned())
        }
        _ => Some(format!("number {compression}")),
    };
    if let Some(name) = name {
        return Err(unsupported(format!(
            "compression {name} is not supported; convert it, as with `gdal_translate -co COMPRESS=DEFLATE IN.tif OUT.tif`"
        )));
    }
    if compression != 1 {
        let is_lzw = compression == u32::from(CompressionMethod::LZW.to_u16());
        blocks::refuse_undecodable(bytes, decoder, is_lzw)?;
    }
    if number(decoder, Tag::PhotometricInterpretation)?
        == Some(PhotometricInterpretation::RGBPalette.to_u16().into())
    {
        return Err(unsupported("it has palette colors instead of heights"));
    }
    match number(decoder, Tag::BitsPerSample)? {
        Some(8 | 16 | 32 | 64) => {}
        bits => return Err(unsupported(format!("samples of {} bits", bits.unwrap_or(1)))),
    }
    match number(decoder, Tag::Orientation)? {
        None | Some(1) => Ok(()),
        Some(orientation) => Err(unsupported(format!(
            "its Orientation is {orientation}, but only images from the top left (1) are supported"
        ))),
    }
}

/// The band that says where pixels are transparent, if there is one.
fn alpha_band(decoder: &mut Decoder<'_>) -> Result<Option<usize>, FormatError> {
    let bands = number(decoder, Tag::SamplesPerPixel)?.unwrap_or(1) as usize;
    let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).map_err(|error| problem(&error))?;
    let extra = extra.unwrap_or_default();
    // Associated alpha is 1, unassociated alpha 2.
    let place = extra.iter().position(|&kind| kind == 1 || kind == 2);
    Ok(place.and_then(|place| (bands + place).checked_sub(extra.len())).filter(|&band| band > 0))
}

/// Samples as doubles, and the greatest gray level of unsigned ones of up to 16 bits.
fn to_doubles(image: DecodingResult) -> Result<(Vec<f64>, Option<u32>), FormatError> {
    fn convert<T: Into<f64>>(samples: Vec<T>) -> Vec<f64> {
        samples.into_iter().map(Into::into).collect()
    }
    Ok(match image {
        DecodingResult::U8(samples) => (convert(samples), Some(255)),
        DecodingResult::U16(samples) => (convert(samples), Some(65_535)),
        DecodingResult::U32(samples) => (convert(samples), None),
        DecodingResult::U64(samples) => (samples.into_iter().map(|sample| sample as f64).collect(), None),
        DecodingResult::I8(samples) => (convert(samples), None),
        DecodingResult::I16(samples) => (convert(samples), None),
        DecodingResult::I32(samples) => (convert(samples), None),
        DecodingResult::I64(samples) => (samples.into_iter().map(|sample| sample as f64).collect(), None),
        DecodingResult::F32(samples) => (convert(samples), None),
        DecodingResult::F64(samples) => (samples, None),
        DecodingResult::F16(_) => return Err(unsupported("16-bit float samples")),
    })
}

/// The first number of a tag of the current directory.
fn number(decoder: &mut Decoder<'_>, tag: Tag) -> Result<Option<u32>, FormatError> {
    let values = decoder.find_tag_unsigned_vec::<u32>(tag).map_err(|error| problem(&error))?;
    Ok(values.and_then(|values| values.first().copied()))
}

fn malformed(problem: impl Into<String>) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem: problem.into() }
}

fn unsupported(problem: impl Into<String>) -> FormatError {
    FormatError::Unsupported { format: FORMAT, problem: problem.into() }
}

fn problem(error: &::tiff::TiffError) -> FormatError {
    match error {
        ::tiff::TiffError::UnsupportedError(TiffUnsupportedError::UnknownInterpretation) => {
            unsupported("its PhotometricInterpretation is missing, or not a known one")
        }
        ::tiff::TiffError::UnsupportedError(error) => unsupported(error.to_string()),
        ::tiff::TiffError::LimitsExceeded => unsupported("it would take more memory than a map may"),
        error => malformed(error.to_string()),
    }
}
