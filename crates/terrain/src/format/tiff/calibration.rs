//! What GDAL writes into TIFF files about their values: no data, scale, offset and unit.

use ::tiff::tags::{Tag, Type, ValueBuffer};

use super::{Decoder, FormatError, malformed, problem, unsupported};

/// The tag of GDAL's metadata: a list of `<Item name="…" sample="…" role="…">…</Item>`.
const GDAL_METADATA: Tag = Tag::Unknown(42_112);

/// How heights are got from stored values.
pub(super) struct Calibration {
    scale: f64,
    offset: f64,
    unit_m: f64,
    no_data: Option<f64>,
}

impl Calibration {
    /// Reads GDAL's tags; `unit_m` is the unit of heights that `GeoTIFF` keys tell.
    pub fn read(decoder: &mut Decoder<'_>, unit_m: Option<f64>) -> Result<Self, FormatError> {
        let no_data = match text(decoder, Tag::GdalNodata)?.as_deref().map(str::trim) {
            None | Some("") => None,
            Some(written) => Some(no_data(written).ok_or_else(|| {
                malformed(format!("its GDAL_NODATA must be a number, not `{}`", start(written)))
            })?),
        };
        let metadata = text(decoder, GDAL_METADATA)?.unwrap_or_default();
        let number = |role: &str| match item_of_first_band(&metadata, role) {
            None => Ok(None),
            Some(written) => match written.trim().parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(number)),
                _ => Err(malformed(format!("its {role} must be a number, not `{}`", start(written)))),
            },
        };
        let (scale, offset) = (number("scale")?.unwrap_or(1.0), number("offset")?.unwrap_or(0.0));
        if scale == 0.0 {
            return Err(malformed("its scale is 0"));
        }
        let unit_m = match item_of_first_band(&metadata, "unittype").map(str::trim) {
            None | Some("") => unit_m.unwrap_or(1.0),
            Some(unit) => meters(unit)
                .ok_or_else(|| unsupported(format!("`{}` is not a known unit of length", start(unit))))?,
        };
        Ok(Self { scale, offset, unit_m, no_data })
    }

    /// Returns whether heights are the stored values.
    pub fn is_identity(&self) -> bool {
        self.scale == 1.0 && self.offset == 0.0 && self.unit_m == 1.0
    }

    /// Rounds what represents no data as the samples are: it is often written with other digits than they have.
    pub fn round_no_data_to_single(&mut self) {
        self.no_data = self.no_data.map(|hole| f64::from(hole as f32));
    }

    /// What is stored where a file stores nothing.
    pub fn stored_nothing(&self) -> f64 {
        self.no_data.unwrap_or(0.0)
    }

    /// The height of a stored value; NaN where it means that there is none.
    pub fn height_m(&self, stored: f64) -> f32 {
        if self.no_data == Some(stored) {
            f32::NAN
        } else {
            ((stored * self.scale + self.offset) * self.unit_m) as f32
        }
    }
}

/// The number that stands for no data; some programs on Windows write infinity and NaN in their own way.
fn no_data(written: &str) -> Option<f64> {
    match written.to_ascii_lowercase().as_str() {
        "1.#inf" => Some(f64::INFINITY),
        "-1.#inf" => Some(f64::NEG_INFINITY),
        "1.#qnan" | "-1.#qnan" | "1.#ind" | "-1.#ind" => Some(f64::NAN),
        number => number.parse().ok(),
    }
}

/// A unit of length by GDAL's names.
fn meters(unit: &str) -> Option<f64> {
    Some(match unit.to_ascii_lowercase().as_str() {
        "m" | "metre" | "meter" | "metres" | "meters" => 1.0,
        "km" | "kilometre" | "kilometer" | "kilometres" | "kilometers" => 1000.0,
        "cm" | "centimetre" | "centimeter" => 0.01,
        "ft" | "foot" | "feet" => 0.3048,
        "us-ft" | "us survey foot" | "us_survey_foot" => 1200.0 / 3937.0,
        _ => return None,
    })
}

/// The text of an item with a role that is about the first band, or about no band in particular.
fn item_of_first_band<'a>(metadata: &'a str, role: &str) -> Option<&'a str> {
    metadata.split("<Item").skip(1).find_map(|item| {
        let (attributes, rest) = item.split_once('>')?;
        let is_first = attribute(attributes, "sample").is_none_or(|band| band.trim() == "0");
        let has_role = attribute(attributes, "role").is_some_and(|it| it.eq_ignore_ascii_case(role));
        (is_first && has_role).then(|| rest.split("</Item").next().unwrap_or_default())
    })
}

/// The value of an XML attribute.
fn attribute<'a>(attributes: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = attributes;
    while let Some((word, after)) = rest.split_once('=') {
        let after = after.trim_start();
        let quote = after.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        let (value, next) = after[1..].split_once(quote)?;
        if word.trim() == name {
            return Some(value);
        }
        rest = next;
    }
    None
}

/// The text of a tag, to its first NUL.
pub(super) fn text(decoder: &mut Decoder<'_>, tag: Tag) -> Result<Option<String>, FormatError> {
    let mut value = ValueBuffer::empty(Type::ASCII);
    let entry = decoder.image_ifd().find_tag_buf(tag, &mut value).map_err(|error| problem(&error))?;
    let bytes = value.as_bytes();
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    Ok(entry.map(|_| String::from_utf8_lossy(&bytes[..end]).into_owned()))
}

/// As much of a text as a message should quote.
fn start(text: &str) -> String {
    text.trim().chars().take(40).collect()
}
