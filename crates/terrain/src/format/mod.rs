//! Map files that other programs write: elevation maps and obstacle maps, from bytes in memory.
//!
//! A file is decoded to a [`Raster`] in the order of its image rows, the first at the top. [`Raster::into_terrain`]
//! turns it so that row 0 is in the south. Sizes are checked before anything is allocated for them.

mod ascii_grid;
mod detached;
mod foreign;
mod moving_ai;
mod pds;
mod pds_label;
mod png;
mod pnm;
mod ros_map;
mod tiff;

use serde::{Deserialize, Serialize};

use crate::frame::GridFrame;
use crate::heightfield::Terrain;

pub use detached::{attach_label, image_of_label};
pub use foreign::refusal;
pub use pds::{RawLayout, SampleType};

/// The most cells that a map may have: 33 million, or 5800 × 5800.
pub const MAX_CELL_COUNT: u64 = 1 << 25;

/// Meters per cell where neither the file nor the caller says (SPEC 1.8).
pub const DEFAULT_CELL_SIZE_M: f64 = 0.6;

/// The kinds of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum FileFormat {
    /// Portable Network Graphics, 8 or 16 bits.
    Png,
    /// Portable gray map, text (P2) or binary (P5).
    Pgm,
    /// TIFF or `GeoTIFF`.
    Tiff,
    /// NASA PDS3 image, with its label before it, beside it, or without.
    Pds,
    /// ESRI ASCII grid.
    AsciiGrid,
    /// `MovingAI` benchmark map: obstacles only.
    MovingAi,
    /// Map of ROS, a YAML file and its image: obstacles only.
    RosMap,
}

/// Why a file can't be read as a map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
pub enum FormatError {
    /// No known format begins like this.
    #[error(
        "unrecognized map format (expected PNG (.png), PGM (.pgm), TIFF or GeoTIFF (.tif), PDS3 image with its label (.img), \
         ESRI ASCII grid (.asc), MovingAI map (.map) or ROS map with its image (.yaml))"
    )]
    Unknown,
    /// The file contradicts its format.
    #[error("malformed {format}: {problem}")]
    Malformed {
        /// The format's name.
        format: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// The file uses a part of its format that is not read.
    #[error("this {format} can't be read: {problem}")]
    Unsupported {
        /// The format's name.
        format: &'static str,
        problem: String,
    },
    /// More cells than [`MAX_CELL_COUNT`].
    #[error("the map has {width} × {height} cells, but the maximum is {MAX_CELL_COUNT}")]
    TooLarge {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// No cells at all.
    #[error("the map has no cells")]
    Empty,
}

/// What the caller knows about a file, or wants otherwise than the file says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImportOptions {
    /// Meters per cell, instead of the file's own.
    pub cell_size_m: Option<f64>,
    /// Meters for each unit of the samples, besides the file's own scale; 1 by default.
    pub vertical_scale: Option<f64>,
    /// A sample value that means "no data", besides what the file says.
    pub no_data: Option<f64>,
    /// The detached label of a PDS3 image.
    pub label: Option<Vec<u8>>,
    /// The layout of a raw image that has no label.
    pub raw: Option<RawLayout>,
}

/// A decoded file, in the order of its image rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Columns from west to east.
    pub width: u32,
    /// Rows from top to bottom.
    pub height: u32,
    /// Values row by row from the top, in meters for elevations; NaN where there is no data.
    pub samples: Vec<f32>,
    /// Meters per cell, if the file says.
    pub cell_size_m: Option<f64>,
    /// Where the south-west corner is in meters east and north, if the file says so in a plane of its own.
    pub origin_m: Option<[f64; 2]>,
    /// What the samples are.
    pub meaning: Meaning,
    /// Cells of a gray level that the file does not explain, so that they are unknown.
    pub num_unclear: usize,
}

/// What the samples of a raster are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Meaning {
    /// Heights, or gray levels that represent them; the greatest value that the format can hold, if it has one.
    Levels {
        /// The greatest gray level.
        greatest: Option<u32>,
    },
    /// Gray levels of which 0 is white and the greatest black: heights as they are, and obstacles where they are high.
    InvertedLevels {
        /// The greatest gray level.
        greatest: u32,
    },
    /// 1 in obstacles, 0 where it is free, and NaN where neither is known.
    Obstacles,
}

impl FileFormat {
    /// The format of a file by its first bytes. A raw PDS3 image has none: name it by [`ImportOptions::raw`].
    pub fn detect(bytes: &[u8]) -> Option<Self> {
        let text = bytes.get(..bytes.len().min(512))?;
        let starts = |prefix: &str| {
            let trimmed = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text).trim_ascii_start();
            trimmed.get(..prefix.len()).is_some_and(|start| start.eq_ignore_ascii_case(prefix.as_bytes()))
        };
        if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
            Some(Self::Png)
        } else if starts("P2") || starts("P5") {
            Some(Self::Pgm)
        } else if [&b"II*\0"[..], b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| bytes.starts_with(magic)) {
            Some(Self::Tiff)
        } else if starts("ncols") || starts("nrows") {
            Some(Self::AsciiGrid)
        } else if starts("type") || moving_ai::has_header(bytes) {
            Some(Self::MovingAi)
        } else if starts("PDS_VERSION_ID") {
            Some(Self::Pds)
        } else if ros_map::is_description(bytes) {
            Some(Self::RosMap)
        } else {
            None
        }
    }
}

/// Decodes a map file of any known format.
pub fn read_raster(bytes: &[u8], options: &ImportOptions) -> Result<Raster, FormatError> {
    if let Some(error) = options.label.as_deref().and_then(foreign::refusal) {
        return Err(error);
    }
    let raster = match FileFormat::detect(bytes) {
        _ if options.raw.is_some() || options.label.is_some() => pds::read(bytes, options),
        Some(FileFormat::Png) => png::read(bytes),
        Some(FileFormat::Pgm) => pnm::read(bytes),
        Some(FileFormat::Tiff) => tiff::read(bytes),
        Some(FileFormat::Pds) => pds::read(bytes, options),
        Some(FileFormat::AsciiGrid) => ascii_grid::read(bytes),
        Some(FileFormat::MovingAi) => moving_ai::read(bytes),
        Some(FileFormat::RosMap) => ros_map::read(bytes),
        // Two heights of a raw image may look like the beginning of anything, so that its size counts first.
        None => pds::read_without_label(bytes).map_err(|error| match error {
            FormatError::Unknown => foreign::refusal(bytes).unwrap_or(error),
            _ => error,
        }),
    }?;
    Ok(raster.with_options(options))
}

/// Reads a map: heights, or obstacles on level ground.
pub fn read_terrain(bytes: &[u8], options: &ImportOptions) -> Result<Terrain, FormatError> {
    Ok(read_raster(bytes, options)?.into_terrain())
}

impl Raster {
    /// A raster of a file that says neither how large its cells are nor where it lies.
    fn new((width, height): (u32, u32), samples: Vec<f32>, meaning: Meaning) -> Self {
        Self { width, height, samples, cell_size_m: None, origin_m: None, meaning, num_unclear: 0 }
    }

    /// The map with its south-west corner where the file says, or else at the origin. Obstacles stand a meter above
    /// the ground.
    pub fn into_terrain(self) -> Terrain {
        let frame = self.frame();
        let width = self.width as usize;
        let heights: Vec<f32> = self.samples.chunks_exact(width).rev().flatten().copied().collect();
        if self.meaning != Meaning::Obstacles {
            return Terrain::new(frame, heights);
        }
        let obstacles = heights.iter().map(|&sample| sample > 0.0).collect();
        Terrain::new(frame, heights).with_obstacles(obstacles)
    }

    /// The grid that the rows fill, with the caller's or the file's own or the default cell size.
    pub fn frame(&self) -> GridFrame {
        let cell_size_m = self.cell_size_m.unwrap_or(DEFAULT_CELL_SIZE_M);
        let origin_m = self.origin_m.unwrap_or_default().into();
        GridFrame { origin_m, ..GridFrame::new(self.width, self.height, cell_size_m) }
    }

    /// Returns which cells are obstacles, row by row from the top: those that the file calls so, gray levels in the
    /// darker half of their range, and cells without data.
    pub fn obstacles(&self) -> Vec<bool> {
        let limit = match self.meaning {
            Meaning::Obstacles => return self.samples.iter().map(|&sample| sample != 0.0).collect(),
            Meaning::InvertedLevels { greatest } => {
                let limit = 0.5 * f64::from(greatest);
                return self.samples.iter().map(|&it| it.is_nan() || f64::from(it) > limit).collect();
            }
            Meaning::Levels { greatest } => greatest.map_or(0.5, |greatest| 0.5 * f64::from(greatest)),
        };
        self.samples.iter().map(|&sample| sample.is_nan() || f64::from(sample) < limit).collect()
    }

    fn with_options(mut self, options: &ImportOptions) -> Self {
        if let Some(no_data) = options.no_data {
            let hole = no_data as f32;
            self.samples.iter_mut().filter(|sample| **sample == hole).for_each(|sample| *sample = f32::NAN);
        }
        if let Some(scale) = options.vertical_scale.filter(|_| self.meaning != Meaning::Obstacles) {
            self.samples.iter_mut().for_each(|sample| *sample = (f64::from(*sample) * scale) as f32);
        }
        let usable = |size: &f64| size.is_finite() && *size > 0.0;
        self.cell_size_m = options.cell_size_m.or(self.cell_size_m).filter(usable);
        self
    }
}

/// The number of cells, if there are some and not too many.
fn checked_cell_count(width: u64, height: u64) -> Result<usize, FormatError> {
    if width == 0 || height == 0 {
        return Err(FormatError::Empty);
    }
    match width.checked_mul(height) {
        Some(count) if count <= MAX_CELL_COUNT => Ok(count as usize),
        _ => Err(FormatError::TooLarge { width, height }),
    }
}
