//! TIFF and `GeoTIFF` elevation maps: 8 to 64 bits, integer or float, with pixel scale and no-data tags.

use std::io::Cursor;

use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;

use super::{FormatError, MAX_CELL_COUNT, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "TIFF";
/// `GTModelTypeGeoKey`: 2 says that the pixel scale is in degrees.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
/// `GeogSemiMajorAxisGeoKey`, in metres.
const SEMI_MAJOR_AXIS: u16 = 2057;
/// The place of `GeoDoubleParams` among tags.
const DOUBLE_PARAMETERS: u16 = 34_736;
/// Mars' equatorial radius, for maps in degrees that don't name their body's.
const MARS_RADIUS_M: f64 = 3_396_190.0;

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 8 * MAX_CELL_COUNT as usize;
    limits.intermediate_buffer_size = 8 * MAX_CELL_COUNT as usize;
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(|error| problem(&error))?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
    let count = checked_cell_count(u64::from(width), u64::from(height))?;
    let cell_size_m = pixel_scale_m(&mut decoder);
    let no_data = decoder
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    let image = decoder.read_image().map_err(|error| problem(&error))?;
    let (values, greatest) = to_doubles(image)?;
    if values.len() < count {
        return Err(FormatError::Malformed {
            format: FORMAT,
            problem: format!("{} samples for {width} × {height} pixels", values.len()),
        });
    }
    // The first band of several is the elevation.
    let bands = values.len() / count;
    let samples = values
        .chunks_exact(bands)
        .take(count)
        .map(|pixel| if Some(pixel[0]) == no_data { f32::NAN } else { pixel[0] as f32 })
        .collect();
    Ok(Raster { width, height, samples, cell_size_m, meaning: Meaning::Levels { greatest } })
}

/// Samples as doubles, and the greatest grey level of unsigned ones of up to 16 bits.
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
        DecodingResult::F16(_) => {
            return Err(FormatError::Unsupported { format: FORMAT, problem: "16-bit float samples".into() });
        }
    })
}

/// The width of a pixel in metres, by the `GeoTIFF` tags.
fn pixel_scale_m(decoder: &mut Decoder<Cursor<&[u8]>>) -> Option<f64> {
    let scale = *decoder.get_tag_f64_vec(Tag::ModelPixelScaleTag).ok()?.first()?;
    let keys = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
    // After a header of four numbers, each key has four: its id, where its value is, how many, and the value or place.
    let key = |id: u16| keys.chunks_exact(4).skip(1).find(|entry| entry[0] == id);
    if key(MODEL_TYPE).is_none_or(|entry| entry[3] != GEOGRAPHIC) {
        return Some(scale);
    }
    let doubles = decoder.get_tag_f64_vec(Tag::GeoDoubleParamsTag).unwrap_or_default();
    let radius = key(SEMI_MAJOR_AXIS)
        .filter(|entry| entry[1] == DOUBLE_PARAMETERS)
        .and_then(|entry| doubles.get(usize::from(entry[3])).copied())
        .unwrap_or(MARS_RADIUS_M);
    Some(scale.to_radians() * radius)
}

fn problem(error: &::tiff::TiffError) -> FormatError {
    match error {
        ::tiff::TiffError::UnsupportedError(error) => {
            FormatError::Unsupported { format: FORMAT, problem: error.to_string() }
        }
        error => FormatError::Malformed { format: FORMAT, problem: error.to_string() },
    }
}
