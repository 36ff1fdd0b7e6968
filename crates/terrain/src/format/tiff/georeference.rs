//! Where the cells of a `GeoTIFF` lie: their size in meters, and on which side north is (OGC 19-008r4).

use ::tiff::tags::Tag;

use super::calibration::text;
use super::{Decoder, FormatError, malformed, problem, unsupported};

/// Widths and heights of cells that differ by less than this part are equal: rounded numbers of a square cell.
const SQUARE_TOLERANCE: f64 = 1e-4;
/// `GTModelTypeGeoKey`: 2 says that coordinates are in degrees.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
/// `GTRasterTypeGeoKey`: 2 says that coordinates are those of the middle of a cell.
const RASTER_TYPE: u16 = 1025;
const PIXEL_IS_POINT: u16 = 2;
/// `GeodeticCRSGeoKey`: a code of the EPSG registry, which is about the Earth.
const GEODETIC_CRS: u16 = 2048;
/// `ProjectedCRSGeoKey`: another code of the EPSG registry.
const PROJECTED_CRS: u16 = 3072;
/// `PCSCitationGeoKey` and `GTCitationGeoKey`, whose text may name the unit.
const CITATIONS: [u16; 2] = [3073, 1026];
/// `EllipsoidSemiMajorAxisGeoKey`, in meters.
const SEMI_MAJOR_AXIS: u16 = 2057;
/// `ProjLinearUnitsGeoKey` and `ProjLinearUnitSizeGeoKey`.
const HORIZONTAL_UNIT: u16 = 3076;
const HORIZONTAL_UNIT_SIZE: u16 = 3077;
/// `VerticalUnitsGeoKey`.
const VERTICAL_UNIT: u16 = 4099;
/// The value of keys whose meaning other keys give.
const USER_DEFINED: u16 = 32_767;
/// The places of `GeoDoubleParams` and `GeoAsciiParams` among tags.
const DOUBLE_PARAMETERS: u16 = 34_736;
const TEXT_PARAMETERS: u16 = 34_737;
/// Mars' equatorial radius, for maps in degrees that don't name their body's.
const MARS_RADIUS_M: f64 = 3_396_190.0;
const EARTH_RADIUS_M: f64 = 6_378_137.0;
/// Codes of projected systems from the first to the last, of which the EPSG registry (v12.029) has only systems in meters.
const METRIC_SYSTEMS: [(u16, u16); 49] = [
    (2000, 2065),
    (2067, 2135),
    (2137, 2154),
    (2161, 2193),
    (2205, 2221),
    (2290, 2313),
    (2315, 2866),
    (2931, 2963),
    (2969, 2991),
    (2995, 3079),
    (3103, 3138),
    (3141, 3166),
    (3168, 3358),
    (3366, 3403),
    (3408, 3416),
    (3460, 3478),
    (3571, 3581),
    (3701, 3727),
    (3740, 3752),
    (3761, 3989),
    (3993, 4096),
    (4462, 5469),
    (5479, 5583),
    (5627, 5644),
    (5659, 6125),
    (6204, 6387),
    (6393, 6404),
    (6634, 6784),
    (7074, 7118),
    (7374, 7586),
    (7692, 8032),
    (8677, 9741),
    (9761, 10_480),
    (10_626, 10_899),
    (10_917, 10_979),
    (11_012, 20_049),
    (20_064, 22_293),
    (22_307, 23_240),
    (23_433, 24_048),
    (24_200, 24_347),
    (24_600, 26_722),
    (26_814, 26_846),
    (26_891, 27_260),
    (27_391, 29_333),
    (29_873, 30_179),
    (30_339, 32_000),
    (32_100, 32_161),
    (32_180, 32_663),
    (32_700, 32_766),
];

/// How the rows and columns of an image lie on the ground.
pub(super) struct Georeference {
    /// Meters per cell, if the file says.
    pub cell_size_m: Option<f64>,
    /// The south-west corner in meters, if the file says and its coordinates are not degrees.
    pub origin_m: Option<[f64; 2]>,
    /// Meters for each unit of heights, if the file says.
    pub vertical_unit_m: Option<f64>,
    rows_from_south: bool,
    columns_from_east: bool,
}

impl Georeference {
    /// Reads pixel scale, transformation and keys. Cells that are rotated or not square are refused.
    pub fn read(decoder: &mut Decoder<'_>) -> Result<Self, FormatError> {
        let keys = Keys::read(decoder)?;
        let vertical_unit_m = keys.unit_m(VERTICAL_UNIT, None)?;
        let Some([x, y]) = steps(decoder)? else {
            let (rows_from_south, columns_from_east) = (false, false);
            let (cell_size_m, origin_m) = (None, None);
            return Ok(Self { cell_size_m, origin_m, vertical_unit_m, rows_from_south, columns_from_east });
        };
        let (width, height) = (x.abs(), y.abs());
        if (width - height).abs() > SQUARE_TOLERANCE * width.max(height) {
            return Err(unsupported(format!(
                "its cells must be square, not {width} × {height}; resample it, as with \
                 `gdalwarp -tr {size} {size} IN.tif OUT.tif`",
                size = width.max(height)
            )));
        }
        let is_in_degrees = keys.value(MODEL_TYPE) == Some(GEOGRAPHIC);
        let unit_m = if is_in_degrees { keys.radius_m().to_radians() } else { keys.horizontal_unit_m()? };
        let is_point = keys.value(RASTER_TYPE) == Some(PIXEL_IS_POINT);
        let corner = if is_in_degrees { None } else { south_west(decoder, [x, y], is_point)? };
        Ok(Self {
            cell_size_m: Some(width * unit_m),
            origin_m: corner.map(|corner| corner.map(|coordinate| coordinate * unit_m)),
            vertical_unit_m,
            rows_from_south: y > 0.0,
            columns_from_east: x < 0.0,
        })
    }

    /// Puts the northernmost row first and the westernmost column left.
    pub fn turn_north_up(&self, samples: &mut [f32], width: usize) {
        // Half a turn is a mirror image in both directions.
        if self.rows_from_south {
            samples.reverse();
        }
        if self.rows_from_south != self.columns_from_east {
            samples.chunks_exact_mut(width).for_each(<[f32]>::reverse);
        }
    }
}

/// Returns how far east a column and how far north a row leads; `None` if the file does not say.
fn steps(decoder: &mut Decoder<'_>) -> Result<Option<[f64; 2]>, FormatError> {
    let scale = doubles(decoder, Tag::ModelPixelScaleTag)?;
    if let &[x, y, ..] = scale.as_slice() {
        if !(x.is_finite() && y.is_finite()) {
            return Err(malformed(format!("its ModelPixelScale is {x} × {y}")));
        }
        if x < 0.0 || y < 0.0 {
            return Err(unsupported(format!(
                "its ModelPixelScale {x} × {y} is ambiguous (north up or south up); save it again with the original program \
                 or with `gdal_translate`"
            )));
        }
        // The scale counts rows downwards.
        return Ok(finite([x, -y]));
    }
    let matrix = doubles(decoder, Tag::ModelTransformationTag)?;
    if let &[x, x_of_row, _, _, y_of_column, y, ..] = matrix.as_slice() {
        if matrix.len() != 16 {
            return Err(malformed(format!("its ModelTransformation has {} numbers, not 16", matrix.len())));
        }
        // Programs without a georeference write the identity; GDAL passes it over, too.
        if [0, 1, 3, 4, 5, 7].iter().all(|&place| matrix[place] == if place % 5 == 0 { 1.0 } else { 0.0 }) {
            return Ok(None);
        }
        if x_of_row.abs().max(y_of_column.abs()) > SQUARE_TOLERANCE * x.abs().max(y.abs()) {
            return Err(unsupported(
                "its rows must run from west to east; convert it, as with `gdalwarp IN.tif OUT.tif`",
            ));
        }
        return Ok(finite([x, y]));
    }
    // A tie point has six numbers; one alone says only where the map is.
    if doubles(decoder, Tag::ModelTiepointTag)?.len() > 6 {
        return Err(unsupported(
            "it is georeferenced by control points; apply them, as with `gdalwarp IN.tif OUT.tif`",
        ));
    }
    Ok(None)
}

/// The least coordinates that the cells have, whose steps are known; `None` if the file does not say.
fn south_west(
    decoder: &mut Decoder<'_>,
    steps: [f64; 2],
    is_point: bool,
) -> Result<Option<[f64; 2]>, FormatError> {
    let (width, height) = decoder.dimensions().map_err(|error| problem(&error))?;
    let (tie, matrix) =
        (doubles(decoder, Tag::ModelTiepointTag)?, doubles(decoder, Tag::ModelTransformationTag)?);
    // A place in the image, in columns and rows, and its coordinates.
    let (image, ground) = match (tie.as_slice(), matrix.as_slice()) {
        (&[column, row, _, x, y, ..], _) => ([column, row], [x, y]),
        (_, &[_, _, _, x, _, _, _, y, ..]) => ([0.0, 0.0], [x, y]),
        _ => return Ok(None),
    };
    let half = if is_point { 0.5 } else { 0.0 };
    let least = |axis: usize, count: u32| {
        let at = |cells: f64| ground[axis] + (cells - half - image[axis]) * steps[axis];
        at(0.0).min(at(f64::from(count)))
    };
    let corner = [least(0, width), least(1, height)];
    Ok(corner.iter().all(|coordinate| coordinate.is_finite()).then_some(corner))
}

fn finite(steps: [f64; 2]) -> Option<[f64; 2]> {
    steps.iter().all(|step| step.is_finite() && *step != 0.0).then_some(steps)
}

/// The numbers of a tag; none if the file has not got it.
fn doubles(decoder: &mut Decoder<'_>, tag: Tag) -> Result<Vec<f64>, FormatError> {
    let value = decoder.find_tag(tag).map_err(|error| problem(&error))?;
    let numbers = value.map(::tiff::decoder::ifd::Value::into_f64_vec).transpose();
    Ok(numbers.map_err(|error| problem(&error))?.unwrap_or_default())
}

/// The `GeoKey` directory: after a header of four numbers, four for each key, which are its id, the tag of its value or 0,
/// how many values, and the value or its place.
struct Keys {
    entries: Vec<u16>,
    doubles: Vec<f64>,
    texts: String,
}

impl Keys {
    fn read(decoder: &mut Decoder<'_>) -> Result<Self, FormatError> {
        let entries =
            decoder.find_tag_unsigned_vec(Tag::GeoKeyDirectoryTag).map_err(|error| problem(&error))?;
        let doubles = doubles(decoder, Tag::GeoDoubleParamsTag)?;
        let texts = text(decoder, Tag::GeoAsciiParamsTag)?.unwrap_or_default();
        Ok(Self { entries: entries.unwrap_or_default(), doubles, texts })
    }

    fn entry(&self, id: u16) -> Option<&[u16]> {
        self.entries.chunks_exact(4).skip(1).find(|entry| entry[0] == id)
    }

    fn value(&self, id: u16) -> Option<u16> {
        self.entry(id).filter(|entry| entry[1] == 0).map(|entry| entry[3])
    }

    fn double(&self, id: u16) -> Option<f64> {
        let entry = self.entry(id).filter(|entry| entry[1] == DOUBLE_PARAMETERS)?;
        self.doubles.get(usize::from(entry[3])).copied()
    }

    fn text(&self, id: u16) -> Option<&str> {
        let entry = self.entry(id).filter(|entry| entry[1] == TEXT_PARAMETERS)?;
        let start = usize::from(entry[3]);
        self.texts.get(start..(start + usize::from(entry[2])).min(self.texts.len()))
    }

    /// The meters of the unit of coordinates: by its key, a text, or the system's code. Without all three, it is the meter.
    fn horizontal_unit_m(&self) -> Result<f64, FormatError> {
        if let Some(meters) = self.unit_m(HORIZONTAL_UNIT, Some(HORIZONTAL_UNIT_SIZE))? {
            return Ok(meters);
        }
        if let Some(meters) = CITATIONS.iter().find_map(|&id| cited_unit_m(self.text(id)?)) {
            return Ok(meters);
        }
        match self.value(PROJECTED_CRS) {
            None | Some(0 | USER_DEFINED) => Ok(1.0),
            Some(code) if METRIC_SYSTEMS.iter().any(|&(first, last)| (first..=last).contains(&code)) => {
                Ok(1.0)
            }
            Some(code) => Err(unsupported(format!(
                "it does not say its unit of length, which may not be the meter (EPSG code {code}); write it again, as with \
                 `gdal_translate IN.tif OUT.tif`"
            ))),
        }
    }

    fn radius_m(&self) -> f64 {
        let of_body = match self.value(GEODETIC_CRS) {
            None | Some(0 | USER_DEFINED) => MARS_RADIUS_M,
            Some(_) => EARTH_RADIUS_M,
        };
        self.double(SEMI_MAJOR_AXIS).unwrap_or(of_body)
    }

    /// The meters of a unit of length by its EPSG code; `None` if the file has no such key.
    fn unit_m(&self, unit: u16, size: Option<u16>) -> Result<Option<f64>, FormatError> {
        let meters = match self.value(unit) {
            None | Some(0) => return Ok(None),
            Some(9001) => Some(1.0),
            Some(9002) => Some(0.3048),
            Some(9003) => Some(1200.0 / 3937.0),
            Some(9036) => Some(1000.0),
            Some(USER_DEFINED) => size.and_then(|size| self.double(size)),
            Some(_) => None,
        };
        let code = self.value(unit).unwrap_or_default();
        meters.filter(|meters| meters.is_finite() && *meters > 0.0).map(Some).ok_or_else(|| {
            unsupported(format!("its unit of length (EPSG code {code}) must be meters, kilometers or feet"))
        })
    }
}

/// The meters of the unit that a text names, as in `Units = us_survey_feet`.
fn cited_unit_m(text: &str) -> Option<f64> {
    text.to_ascii_lowercase().split("units").skip(1).find_map(|rest| {
        let name = rest.trim_start().strip_prefix('=')?.trim_start();
        let name = name.split(['|', '\n', ',', ';']).next()?;
        if name.contains("feet") || name.contains("foot") {
            let is_american = name.contains("survey") || name.split(['_', ' ']).any(|word| word == "us");
            Some(if is_american { 1200.0 / 3937.0 } else { 0.3048 })
        } else {
            (name.starts_with("meter") || name.starts_with("metre")).then_some(1.0)
        }
    })
}
