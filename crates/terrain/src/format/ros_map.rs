//! Maps of ROS (`map_server` and `nav2_map_server`): a YAML file that names an image of how likely each cell is
//! occupied, with its scale and place. The file that is read here is the YAML, a line `...`, which ends a YAML document,
//! and the image.

use super::{FormatError, ImportOptions, Meaning, Raster};

const FORMAT: &str = "ROS map";

/// What ends the YAML before its image.
const END: &str = "...";
/// The level of 8 bits that programs write for a cell that they know nothing of.
const UNKNOWN_LEVEL: f64 = 205.0;

/// The YAML of a map is a few lines.
const MAX_YAML_BYTES: usize = 16 << 10;

/// Which cells of an image are free (`mode`).
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    /// Gray levels against both thresholds: occupied, free, and unknown between them.
    Trinary,
    /// Gray levels between the thresholds represent a degree. Only what is surely free is free here.
    Scale,
    /// Samples are the degree itself in percent; above 100 it is unknown.
    Raw,
}

struct Description {
    image: String,
    resolution_m: f64,
    origin_m: [f64; 2],
    is_negated: bool,
    occupied_threshold: f64,
    free_threshold: f64,
    mode: Mode,
}

/// The name of the image that the description of a map names; `None` for all other files.
pub(super) fn image_name(bytes: &[u8]) -> Option<String> {
    if !is_description(bytes) {
        return None;
    }
    let (yaml, image) = parts(bytes);
    if !image.is_empty() {
        return None;
    }
    keys(yaml).ok()?.into_iter().find(|(key, _)| key == "image").map(|(_, name)| name)
}

/// Returns whether a file begins with the description of a map: each of its first lines is a key, a comment or empty,
/// and `image` and `resolution` are among the keys.
pub(super) fn is_description(bytes: &[u8]) -> bool {
    let (yaml, _) = parts(bytes);
    keys(yaml).is_ok_and(|keys| {
        ["image", "resolution"].iter().all(|wanted| keys.iter().any(|(key, _)| key == wanted))
    })
}

/// The description and its image as one file.
pub(super) fn join(yaml: &[u8], image: &[u8]) -> Result<Vec<u8>, FormatError> {
    describe(parts(yaml).0)?;
    Ok([parts(yaml).0, b"\n", END.as_bytes(), b"\n", image].concat())
}

pub(super) fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    let (yaml, image) = parts(bytes);
    let about = describe(yaml)?;
    if image.is_empty() {
        return Err(unsupported(format!("its image {} is also needed", about.image)));
    }
    if is_description(image) {
        return Err(malformed(format!("{} is not an image", about.image)));
    }
    let image = super::read_raster(image, &ImportOptions::default())?;
    let (Meaning::Levels { greatest: Some(greatest) } | Meaning::InvertedLevels { greatest }) = image.meaning
    else {
        return Err(unsupported(format!("its image {} needs gray levels; use PGM or PNG", about.image)));
    };
    let samples: Vec<f32> =
        image.samples.iter().map(|&level| about.cell(f64::from(level), greatest)).collect();
    let is_unclear = |(&level, cell): (&f32, &f32)| {
        cell.is_nan() && about.mode == Mode::Trinary && level_of_8_bits(level, greatest) != UNKNOWN_LEVEL
    };
    let num_unclear = image.samples.iter().zip(&samples).filter(|&cell| is_unclear(cell)).count();
    Ok(Raster {
        samples,
        num_unclear,
        cell_size_m: Some(about.resolution_m),
        origin_m: Some(about.origin_m),
        meaning: Meaning::Obstacles,
        ..image
    })
}

impl Description {
    /// 0 for a free cell, 1 for an obstacle, NaN where it is unknown.
    fn cell(&self, level: f64, greatest: u32) -> f32 {
        let share = level / f64::from(greatest);
        let occupied = match self.mode {
            // Levels are those of 8 bits, whatever the image has.
            Mode::Raw => (share * 255.0).round() / 100.0,
            _ if self.is_negated => share,
            _ => 1.0 - share,
        };
        let is_known = level.is_finite() && (self.mode != Mode::Raw || occupied <= 1.0);
        // A level at a threshold is beyond it, as in nav2: maps say `free_thresh: 0.0` and mean white.
        if is_known && occupied >= self.occupied_threshold {
            1.0
        } else if is_known && occupied <= self.free_threshold {
            0.0
        } else if is_known && self.mode == Mode::Scale {
            1.0
        } else {
            f32::NAN
        }
    }
}

fn level_of_8_bits(level: f32, greatest: u32) -> f64 {
    (f64::from(level) / f64::from(greatest) * 255.0).round()
}

/// The YAML, and what follows the line that ends it.
fn parts(bytes: &[u8]) -> (&[u8], &[u8]) {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut start = 0;
    while start < bytes.len().min(MAX_YAML_BYTES) {
        let end = bytes[start..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |at| start + at);
        if bytes[start..end].trim_ascii_end() == END.as_bytes() {
            return (bytes[..start].trim_ascii_end(), bytes.get(end + 1..).unwrap_or_default());
        }
        start = end + 1;
    }
    (bytes, &[])
}

/// Keys with their values as they are written; those of a list in lines of their own are joined as `[a, b]`.
fn keys(yaml: &[u8]) -> Result<Vec<(String, String)>, FormatError> {
    let text = yaml.get(..yaml.len().min(MAX_YAML_BYTES)).unwrap_or_default();
    if yaml.len() > MAX_YAML_BYTES {
        return Err(malformed(format!("its description is longer than {MAX_YAML_BYTES} bytes")));
    }
    let text = std::str::from_utf8(text).map_err(|_| malformed("its description is not text".into()))?;
    let mut found: Vec<(String, String)> = Vec::new();
    for line in text.lines() {
        let line = without_comment(line).trim_end();
        let words = line.trim_start();
        if words.is_empty() || line == "---" || words.starts_with('%') {
            continue;
        }
        if let Some(item) = words.strip_prefix("- ") {
            let (_, list) =
                found.last_mut().ok_or_else(|| malformed(format!("`{line}` does not belong to a key")))?;
            let before = list.trim_end_matches(']').trim_start_matches('[').to_owned();
            let comma = if before.is_empty() { "" } else { ", " };
            *list = format!("[{before}{comma}{}]", item.trim());
            continue;
        }
        let (key, value) = words
            .split_once(':')
            .filter(|(key, value)| {
                is_word(key.trim()) && (value.is_empty() || value.starts_with(char::is_whitespace))
            })
            .ok_or_else(|| malformed(format!("`{}` is not a key with a value", shortened(line))))?;
        found.push((key.trim().to_owned(), unquoted(value.trim()).to_owned()));
    }
    Ok(found)
}

fn describe(yaml: &[u8]) -> Result<Description, FormatError> {
    let mut about = Description {
        image: String::new(),
        resolution_m: f64::NAN,
        origin_m: [f64::NAN; 2],
        is_negated: false,
        occupied_threshold: 0.65,
        free_threshold: 0.196,
        mode: Mode::Trinary,
    };
    for (key, value) in keys(yaml)? {
        match key.as_str() {
            "image" => about.image = value,
            "resolution" => about.resolution_m = number(&key, &value)?,
            "origin" => about.origin_m = origin(&value)?,
            "negate" => about.is_negated = flag(&value)?,
            "occupied_thresh" => about.occupied_threshold = threshold(&key, &value)?,
            "free_thresh" => about.free_threshold = threshold(&key, &value)?,
            "mode" => about.mode = mode(&value)?,
            // Anything else is for other programs.
            _ => {}
        }
    }
    if about.image.is_empty() {
        return Err(malformed("it needs `image`".into()));
    }
    if !(about.resolution_m.is_finite() && about.resolution_m > 0.0) {
        return Err(malformed("its `resolution` must be a number of meters greater than 0".into()));
    }
    if about.origin_m[0].is_nan() {
        return Err(malformed("it needs `origin`".into()));
    }
    if about.free_threshold > about.occupied_threshold {
        let problem = format!(
            "`free_thresh` {} is above `occupied_thresh` {}",
            about.free_threshold, about.occupied_threshold
        );
        return Err(malformed(problem));
    }
    Ok(about)
}

fn origin(value: &str) -> Result<[f64; 2], FormatError> {
    let list = value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    let numbers: Vec<f64> = list
        .unwrap_or(value)
        .split(',')
        .map(|word| number("origin", word.trim()))
        .collect::<Result<_, _>>()?;
    let &[east, north, yaw] = numbers.as_slice() else {
        return Err(malformed(format!("`origin` is {}, not [x, y, yaw]", shortened(value))));
    };
    if yaw.abs() > 1e-9 {
        return Err(unsupported(format!(
            "it is rotated by {yaw} rad (`origin`); rotate its image so that the yaw is 0"
        )));
    }
    Ok([east, north])
}

fn mode(value: &str) -> Result<Mode, FormatError> {
    match value.to_ascii_lowercase().as_str() {
        "trinary" => Ok(Mode::Trinary),
        "scale" => Ok(Mode::Scale),
        "raw" => Ok(Mode::Raw),
        _ => Err(malformed(format!("`mode` is {}, not trinary, scale or raw", shortened(value)))),
    }
}

fn flag(value: &str) -> Result<bool, FormatError> {
    match value.to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "off" => Ok(false),
        "1" | "true" | "yes" | "on" => Ok(true),
        _ => Err(malformed(format!("`negate` is {}, not 0 or 1", shortened(value)))),
    }
}

fn threshold(key: &str, value: &str) -> Result<f64, FormatError> {
    let share = number(key, value)?;
    if (0.0..=1.0).contains(&share) {
        Ok(share)
    } else {
        Err(malformed(format!("`{key}` is {share}, not within 0 to 1")))
    }
}

fn number(key: &str, value: &str) -> Result<f64, FormatError> {
    let number: Option<f64> = unquoted(value).parse().ok();
    number
        .filter(|number| number.is_finite())
        .ok_or_else(|| malformed(format!("`{key}` is {}, not a number", shortened(value))))
}

/// A line up to a `#` at its beginning or after white space, outside of quotes.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (at, character) in line.char_indices() {
        match (quote, character) {
            (None, '#') if before.is_whitespace() => return &line[..at],
            (None, '"' | '\'') if before.is_whitespace() => quote = Some(character),
            (Some(open), _) if open == character => quote = None,
            _ => {}
        }
        before = character;
    }
    line
}

fn unquoted(value: &str) -> &str {
    ['"', '\'']
        .into_iter()
        .find_map(|quote| value.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote)))
        .unwrap_or(value)
}

fn is_word(key: &str) -> bool {
    !key.is_empty() && key.chars().all(|it| it.is_ascii_alphanumeric() || it == '_')
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

fn malformed(problem: String) -> FormatError {
    FormatError::Malformed { format: FORMAT, problem }
}

fn unsupported(problem: String) -> FormatError {
    FormatError::Unsupported { format: FORMAT, problem }
}
