//! NASA PDS3 images: raw samples described by a label of `KEYWORD = VALUE` lines, which stands before them, in a file
//! of its own, or got lost.

use serde::{Deserialize, Serialize};

use super::pds_label::{Label, is_absent};
use super::{FormatError, ImportOptions, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "PDS3 image";
/// Mars' equatorial radius, for labels that give pixels per degree without their body's.
const MARS_RADIUS_M: f64 = 3_396_190.0;

/// How a sample is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SampleType {
    /// Unsigned byte.
    U8,
    /// Signed 16 bits, most significant byte first.
    I16BigEndian,
    /// Signed 16 bits, least significant byte first.
    I16LittleEndian,
    /// Unsigned 16 bits, most significant byte first.
    U16BigEndian,
    /// Unsigned 16 bits, least significant byte first.
    U16LittleEndian,
    /// Signed 32 bits, most significant byte first.
    I32BigEndian,
    /// Signed 32 bits, least significant byte first.
    I32LittleEndian,
    /// IEEE single precision, most significant byte first.
    F32BigEndian,
    /// IEEE single precision, least significant byte first.
    F32LittleEndian,
}

impl SampleType {
    /// Bytes of a sample.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::I16BigEndian | Self::I16LittleEndian | Self::U16BigEndian | Self::U16LittleEndian => 2,
            Self::I32BigEndian | Self::I32LittleEndian | Self::F32BigEndian | Self::F32LittleEndian => 4,
        }
    }

    fn value(self, sample: &[u8]) -> f64 {
        match (self, sample) {
            (Self::U8, &[byte]) => f64::from(byte),
            (Self::I16BigEndian, &[a, b]) => f64::from(i16::from_be_bytes([a, b])),
            (Self::I16LittleEndian, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (Self::U16BigEndian, &[a, b]) => f64::from(u16::from_be_bytes([a, b])),
            (Self::U16LittleEndian, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (Self::I32BigEndian, &[a, b, c, d]) => f64::from(i32::from_be_bytes([a, b, c, d])),
            (Self::I32LittleEndian, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
            (Self::F32BigEndian, &[a, b, c, d]) => f64::from(f32::from_be_bytes([a, b, c, d])),
            (Self::F32LittleEndian, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        }
    }

    /// The value of a sample whose bits are written as in `16#FF7FFFFB#`, most significant first.
    fn of_bits(self, written: &str) -> Option<f64> {
        let digits = written.trim().trim_matches('"').strip_prefix("16#")?.split('#').next()?;
        let bits = u32::from_str_radix(digits, 16).ok()?;
        let bytes = bits.to_be_bytes();
        let (unused, sample) = bytes.split_at(bytes.len() - self.bytes());
        if unused.iter().any(|&byte| byte != 0) {
            return None;
        }
        let mut sample = sample.to_vec();
        if matches!(
            self,
            Self::I16LittleEndian | Self::U16LittleEndian | Self::I32LittleEndian | Self::F32LittleEndian
        ) {
            sample.reverse();
        }
        Some(self.value(&sample))
    }

    fn of_label(name: &str, bits: u32) -> Option<Self> {
        let name = name.trim_matches('"').to_ascii_uppercase();
        let little = ["LSB_", "PC_", "VAX_"].iter().any(|prefix| name.starts_with(prefix));
        let unsigned = name.contains("UNSIGNED");
        Some(match (bits, name.contains("REAL"), unsigned, little) {
            (8, false, true, _) => Self::U8,
            (16, false, false, false) => Self::I16BigEndian,
            (16, false, false, true) => Self::I16LittleEndian,
            (16, false, true, false) => Self::U16BigEndian,
            (16, false, true, true) => Self::U16LittleEndian,
            (32, false, false, false) => Self::I32BigEndian,
            (32, false, false, true) => Self::I32LittleEndian,
            (32, true, false, false) => Self::F32BigEndian,
            // VAX reals are not IEEE numbers.
            (32, true, false, true) if name.starts_with("PC_") => Self::F32LittleEndian,
            _ => return None,
        })
    }
}

/// Where the samples of a raw image are and what they mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RawLayout {
    /// Samples of a row.
    pub width: u32,
    /// Rows, the first in the north.
    pub height: u32,
    /// How a sample is stored.
    pub sample_type: SampleType,
    /// Bytes before the first sample.
    pub start_byte: u64,
    /// Meters for each unit.
    pub scaling_factor: f64,
    /// Meters of value 0.
    pub offset_m: f64,
    /// The value that means "no data".
    pub no_data: Option<f64>,
    /// Meters per cell, if known.
    pub cell_size_m: Option<f64>,
}

impl RawLayout {
    /// Samples in meters from the first byte on.
    pub const fn new(width: u32, height: u32, sample_type: SampleType) -> Self {
        Self {
            width,
            height,
            sample_type,
            start_byte: 0,
            scaling_factor: 1.0,
            offset_m: 0.0,
            no_data: None,
            cell_size_m: None,
        }
    }
}

/// Reads an image by the caller's layout, the caller's label, or the label at its beginning.
pub(super) fn read(bytes: &[u8], options: &ImportOptions) -> Result<Raster, FormatError> {
    let (layout, holes) = match (&options.raw, &options.label) {
        (Some(layout), _) => (*layout, Vec::new()),
        (None, Some(label)) => read_label(label, false)?,
        (None, None) => read_label(bytes, true)?,
    };
    read_samples(bytes, &layout, &holes)
}

/// Reads an image without a label as what such files of elevations mostly are: a whole planet, twice as wide as high,
/// in 16-bit big-endian meters, like the MOLA maps of Mars.
pub(super) fn read_without_label(bytes: &[u8]) -> Result<Raster, FormatError> {
    let height = ((bytes.len() / 4) as f64).sqrt() as u64;
    let looks_global = height >= 90 && height.is_multiple_of(90) && 4 * height * height == bytes.len() as u64;
    if !looks_global {
        return Err(FormatError::Unknown);
    }
    checked_cell_count(2 * height, height)?;
    let mut layout = RawLayout::new(2 * height as u32, height as u32, SampleType::I16BigEndian);
    layout.cell_size_m = Some(std::f64::consts::PI * MARS_RADIUS_M / height as f64);
    read_samples(bytes, &layout, &[])
}

/// `holes` are values that mean "no data", beside that of the layout.
fn read_samples(bytes: &[u8], layout: &RawLayout, holes: &[f64]) -> Result<Raster, FormatError> {
    let count = checked_cell_count(u64::from(layout.width), u64::from(layout.height))?;
    let size = layout.sample_type.bytes();
    let data = usize::try_from(layout.start_byte).ok().and_then(|start| bytes.get(start..));
    let Some(data) = data.and_then(|data| data.get(..count * size)) else {
        return Err(malformed(format!(
            "{} × {} samples of {size} bytes from byte {} on don't fit into {} bytes",
            layout.width,
            layout.height,
            layout.start_byte,
            bytes.len()
        )));
    };
    // What represents no data in single precision is often written with other digits than it has.
    let is_single = matches!(layout.sample_type, SampleType::F32BigEndian | SampleType::F32LittleEndian);
    let stored = |hole: f64| if is_single { f64::from(hole as f32) } else { hole };
    let holes: Vec<f64> = layout.no_data.iter().chain(holes).map(|&hole| stored(hole)).collect();
    let samples = data
        .chunks_exact(size)
        .map(|sample| {
            let value = layout.sample_type.value(sample);
            if holes.contains(&value) {
                f32::NAN
            } else {
                (value * layout.scaling_factor + layout.offset_m) as f32
            }
        })
        .collect();
    let (width, height, cell_size_m) = (layout.width, layout.height, layout.cell_size_m);
    let meaning = Meaning::Levels { greatest: None };
    Ok(Raster { cell_size_m, ..Raster::new((width, height), samples, meaning) })
}

/// Reads a label; `attached` says whether the samples are in the same file.
fn read_label(bytes: &[u8], attached: bool) -> Result<(RawLayout, Vec<f64>), FormatError> {
    let label = Label::parse(bytes);
    let size = |keyword: &str| match label.number(keyword) {
        Some(number) if number >= 0.0 && number.fract() == 0.0 && number < 4e9 => Ok(number as u32),
        _ => Err(malformed(format!("its label needs {keyword}"))),
    };
    let (width, height) = (size("LINE_SAMPLES")?, size("LINES")?);
    let (name, bits) = (label.value("SAMPLE_TYPE").unwrap_or_default(), size("SAMPLE_BITS")?);
    let sample_type = SampleType::of_label(name, bits)
        .ok_or_else(|| unsupported(format!("samples of type {name} with {bits} bits")))?;
    let constant = |keyword: &str| match label.value(keyword) {
        None => Ok(None),
        Some(written) if is_absent(written) => Ok(None),
        Some(written) => (label.number(keyword).or_else(|| sample_type.of_bits(written)))
            .map(Some)
            .ok_or_else(|| malformed(format!("its {keyword} must be a number, not {written}"))),
    };
    let factor = |keyword: &str| match label.value(keyword) {
        Some(written) if !is_absent(written) => match label.number(keyword).filter(|it| it.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => Err(malformed(format!("its {keyword} must be a number, not {written}"))),
        },
        _ => Ok(None),
    };
    label.refuse_what_is_not_rows_from_the_top()?;
    let unit_m = label.unit_m()?;
    let mut holes = Vec::new();
    for keyword in HOLES {
        holes.extend(constant(keyword)?);
    }
    let layout = RawLayout {
        width,
        height,
        sample_type,
        start_byte: label.image_start(attached)?,
        scaling_factor: unit_m * factor("SCALING_FACTOR")?.unwrap_or(1.0),
        offset_m: unit_m * factor("OFFSET")?.unwrap_or(0.0),
        no_data: constant("MISSING_CONSTANT")?,
        cell_size_m: label.cell_size_m()?,
    };
    Ok((layout, holes))
}

/// Further values that are not heights: those of the data dictionary, and the special pixels of ISIS, which stand far
/// below (or above) all ground.
const HOLES: [&str; 12] = [
    "CORE_NULL",
    "INVALID_CONSTANT",
    "UNKNOWN_CONSTANT",
    "NOT_APPLICABLE_CONSTANT",
    "CORE_LOW_REPR_SATURATION",
    "CORE_LOW_INSTR_SATURATION",
    "CORE_HIGH_REPR_SATURATION",
    "CORE_HIGH_INSTR_SATURATION",
    "LOW_REPR_SATURATION",
    "LOW_INSTR_SATURATION",
    "HIGH_REPR_SATURATION",
    "HIGH_INSTR_SATURATION",
];

fn malformed(problem: String) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem }
}

fn unsupported(problem: String) -> FormatError {
    FormatError::Unsupported { format: FORMAT, problem }
}

impl Label {
    /// The byte at which the samples begin: `^IMAGE` counts records, or bytes when it says so, from 1.
    pub(super) fn image_start(&self, attached: bool) -> Result<u64, FormatError> {
        let Some(pointer) = self.value("^IMAGE") else {
            if attached {
                return Err(malformed("its label needs ^IMAGE".into()));
            }
            return Ok(0);
        };
        if attached && pointer.contains('"') {
            return Err(malformed(format!("this file is only the label; the image is in {pointer}")));
        }
        // Of a file and a place in it, as in ("FILE.IMG", 3), the place counts.
        let place = pointer.trim_matches(['(', ')']).split(',').next_back().unwrap_or_default().trim();
        let in_bytes = place.contains("<BYTES>");
        let digits: String = place.chars().take_while(char::is_ascii_digit).collect();
        let Ok(place) = digits.parse::<u64>() else {
            if attached {
                return Err(malformed(format!("^IMAGE is {pointer}, in another file")));
            }
            return Ok(0);
        };
        let records = place.saturating_sub(1);
        if in_bytes || records == 0 {
            return Ok(records);
        }
        let record_bytes = self.number("RECORD_BYTES").filter(|bytes| *bytes >= 1.0 && bytes.fract() == 0.0);
        let record_bytes = record_bytes.ok_or_else(|| {
            malformed(format!(
                "^IMAGE is {pointer}, in records, and RECORD_BYTES does not say how long they are"
            ))
        })?;
        Ok(records.saturating_mul(record_bytes as u64))
    }

    /// A word of the label in capitals, without quotes; `None` if it has no value.
    fn word(&self, keyword: &str) -> Option<String> {
        let value = self.value(keyword).filter(|value| !is_absent(value))?;
        Some(value.trim_matches('"').trim().to_ascii_uppercase())
    }

    /// Names what would be decoded to something else than one image from the top left.
    fn refuse_what_is_not_rows_from_the_top(&self) -> Result<(), FormatError> {
        let is_other = |keyword: &str, usual: f64| self.number(keyword).is_some_and(|it| it != usual);
        if is_other("BANDS", 1.0) || is_other("LINE_PREFIX_BYTES", 0.0) || is_other("LINE_SUFFIX_BYTES", 0.0)
        {
            return Err(unsupported("more than one band, or bytes between the lines".into()));
        }
        for (keyword, usual) in [("LINE_DISPLAY_DIRECTION", "DOWN"), ("SAMPLE_DISPLAY_DIRECTION", "RIGHT")] {
            if let Some(direction) = self.word(keyword).filter(|direction| direction != usual) {
                return Err(unsupported(format!("its {keyword} is {direction}, not {usual}")));
            }
        }
        match self.word("ENCODING_TYPE") {
            Some(encoding) => Err(unsupported(format!(
                "it is compressed ({encoding}); write it as GeoTIFF, as with `gdal_translate IN.IMG OUT.tif`"
            ))),
            None => Ok(()),
        }
    }

    /// The meters of the unit of heights.
    fn unit_m(&self) -> Result<f64, FormatError> {
        match self.word("UNIT").as_deref() {
            None | Some("M" | "METER" | "METERS" | "METRE" | "METRES") => Ok(1.0),
            Some("KM" | "KILOMETER" | "KILOMETERS" | "KILOMETRE" | "KILOMETRES") => Ok(1000.0),
            Some(unit) => Err(unsupported(format!("{unit} is not a unit of height"))),
        }
    }

    /// Meters per cell by scale or resolution; `None` if the label gives neither.
    fn cell_size_m(&self) -> Result<Option<f64>, FormatError> {
        if let Some(scale) = self.number("MAP_SCALE") {
            return Ok(Some(scale * self.length_unit_m("MAP_SCALE")?));
        }
        let Some(pixels_per_degree) = self.number("MAP_RESOLUTION") else { return Ok(None) };
        let radius_m = match (self.number("A_AXIS_RADIUS"), self.word("TARGET_NAME").as_deref()) {
            (Some(radius), _) => radius * self.length_unit_m("A_AXIS_RADIUS")?,
            (None, None | Some("MARS")) => MARS_RADIUS_M,
            (None, Some(body)) => {
                let problem = format!("it gives pixels per degree without the A_AXIS_RADIUS of {body}");
                return Err(unsupported(problem));
            }
        };
        Ok(Some(1.0_f64.to_radians() * radius_m / pixels_per_degree))
    }

    /// The meters of the unit that follows a length in angle brackets. Without one it is the kilometer, which the
    /// PDS data dictionary gives these lengths.
    fn length_unit_m(&self, keyword: &str) -> Result<f64, FormatError> {
        let value = self.value(keyword).unwrap_or_default();
        let unit = value.split_once('<').map_or("KM", |(_, unit)| unit.trim_end_matches('>'));
        match unit.split('/').next().unwrap_or_default().trim().to_ascii_uppercase().as_str() {
            "KM" | "KILOMETER" | "KILOMETERS" => Ok(1000.0),
            "M" | "METER" | "METERS" => Ok(1.0),
            "CM" | "CENTIMETER" | "CENTIMETERS" => Ok(0.01),
            _ => Err(unsupported(format!("the unit of its {keyword} is unknown: {value}"))),
        }
    }
}
