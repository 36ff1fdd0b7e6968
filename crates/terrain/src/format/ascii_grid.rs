//! ESRI ASCII grids (`.asc`): a header of keywords, then rows of numbers from the north.

use super::{FormatError, Meaning, Raster, checked_cell_count};

const FORMAT: &str = "ESRI ASCII grid";

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let text = std::str::from_utf8(bytes).map_err(|_| malformed("the file is not text".into()))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut words = text.split_ascii_whitespace().peekable();
    let (mut width, mut height, mut cell_size_m, mut cell_height_m, mut no_data) =
        (None, None, None, None, None);
    let (mut corner, mut center) = ([None; 2], [None; 2]);
    while let Some(keyword) =
        words.next_if(|word| word.starts_with(|first: char| first.is_ascii_alphabetic()) && !is_absent(word))
    {
        let value = words.next().unwrap_or_default();
        if keyword.eq_ignore_ascii_case("nodata_value") && is_absent(value) {
            continue;
        }
        let number: f64 =
            value.parse().map_err(|_| malformed(format!("`{keyword}` must be a number, not `{value}`")))?;
        match keyword.to_ascii_lowercase().as_str() {
            "ncols" => width = Some(number),
            "nrows" => height = Some(number),
            "cellsize" | "dx" => cell_size_m = Some(number),
            "dy" => cell_height_m = Some(number),
            "nodata_value" => no_data = Some(number),
            "xllcorner" => corner[0] = Some(number),
            "yllcorner" => corner[1] = Some(number),
            "xllcenter" => center[0] = Some(number),
            "yllcenter" => center[1] = Some(number),
            _ => return Err(malformed(format!("unknown keyword `{keyword}` in the header"))),
        }
    }
    for (keyword, size) in [("cellsize", cell_size_m), ("dy", cell_height_m)] {
        if let Some(size) = size.filter(|size| !(size.is_finite() && *size > 0.0)) {
            return Err(malformed(format!("`{keyword}` must be positive, not {size}")));
        }
    }
    if let (Some(width), Some(height)) = (cell_size_m, cell_height_m)
        && (width - height).abs() > 1e-4 * width.abs()
    {
        let problem = format!("cells must be square, not {width} × {height}");
        return Err(FormatError::Unsupported { format: FORMAT, problem });
    }
    let size = |number: Option<f64>, keyword: &str| match number {
        Some(number) if number >= 0.0 && number.fract() == 0.0 && number < 1e15 => Ok(number as u64),
        Some(number) => Err(malformed(format!("`{keyword}` is {number}"))),
        None => Err(malformed(format!("expected `{keyword}`"))),
    };
    let (width, height) = (size(width, "ncols")?, size(height, "nrows")?);
    let count = checked_cell_count(width, height)?;
    let (width, height) = (width as u32, height as u32);
    if text.len() < 2 * count {
        return Err(malformed(format!("the file is too short for {width} × {height} values")));
    }
    let mut samples = Vec::with_capacity(count);
    for word in words {
        let value = if is_absent(word) { Ok(f64::NAN) } else { word.parse() };
        let value = value.map_err(|_| malformed(format!("value {} is `{word}`", samples.len() + 1)))?;
        let is_absent = no_data.is_some_and(|no_data| value as f32 == no_data as f32);
        samples.push(if is_absent { f32::NAN } else { value as f32 });
        if samples.len() > count {
            return Err(malformed(format!("the file has more than {width} × {height} values")));
        }
    }
    if samples.len() < count {
        return Err(malformed(format!("the file has {} values for {width} × {height} cells", samples.len())));
    }
    let half_cell_m = 0.5 * cell_size_m.unwrap_or(super::DEFAULT_CELL_SIZE_M);
    let of_axis = |axis: usize| corner[axis].or_else(|| Some(center[axis]? - half_cell_m));
    let origin_m = of_axis(0).zip(of_axis(1)).map(|(east, north)| [east, north]);
    let origin_m = origin_m.filter(|origin| origin.iter().all(|meters| meters.is_finite()));
    let meaning = Meaning::Levels { greatest: None };
    Ok(Raster { cell_size_m, origin_m, ..Raster::new((width, height), samples, meaning) })
}

/// Returns whether a word represents a height that is not there, as programs write it: in place of a value, and as
/// `NODATA_value`.
fn is_absent(word: &str) -> bool {
    ["nan", "-nan", "null", "none", "na", "inf", "-inf", "infinity", "-infinity"]
        .iter()
        .any(|absent| word.eq_ignore_ascii_case(absent))
}

fn malformed(problem: String) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem }
}
