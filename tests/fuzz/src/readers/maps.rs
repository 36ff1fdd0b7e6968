//! Maps, by format.

use terrain::format::{FileFormat, ImportOptions, attach_label, image_of_label, read_raster};

use super::{Outcome, Reader, nothing, read, refused};

/// Returns what holds of every map: as many samples as cells, and ground of it.
fn exercise(bytes: &[u8], options: &ImportOptions) -> Outcome {
    let format = FileFormat::detect(bytes);
    match read_raster(bytes, options) {
        Ok(raster) => {
            assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
            assert!(
                raster.cell_size_m.is_none_or(|size| size.is_finite() && size > 0.0),
                "cells have a size"
            );
            assert_eq!(raster.obstacles().len(), raster.samples.len());
            let meaning = format!("{format:?} {:?}", raster.meaning);
            let terrain = raster.into_terrain();
            let _ = terrain.no_data_count();
            read(&meaning)
        }
        Err(reason) => refused(&format!("{format:?} {reason}")),
    }
}

fn by_its_beginning(input: &[u8]) -> Outcome {
    exercise(input, &ImportOptions::default())
}

const fn format(
    name: &'static str,
    seeds: &'static [&'static str],
    words: &'static [&'static str],
) -> Reader {
    Reader {
        name,
        seeds,
        words,
        mend: nothing,
        exercise: by_its_beginning,
        tested: 2000,
        keeps_form: 1,
        cost: 1,
    }
}

/// Portable Network Graphics.
pub(super) const PNG: Reader = Reader {
    mend: with_checksums,
    ..format("png", &["crates/terrain/tests/fixtures/*.png"], &["IHDR", "IDAT", "PLTE", "tRNS", "IEND"])
};

/// Makes the checksums of a PNG's chunks right.
fn with_checksums(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(end) = at.checked_add(8).and_then(|start| start.checked_add(length)) else { return };
        let Some(checked) = bytes.get(at + 4..end) else { return };
        let checksum = crc(checked);
        let Some(place) = bytes.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&checksum.to_be_bytes());
        at = end + 4;
    }
}

/// The cyclic redundancy check of PNG (ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, &byte| {
        (0..8).fold(
            sum ^ u32::from(byte),
            |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 },
        )
    })
}

/// TIFF and `GeoTIFF`.
pub(super) const TIFF: Reader = format(
    "tiff",
    &["crates/terrain/tests/fixtures/*.tiff"],
    &[
        "II*\0",
        "MM\0*",
        "II+\0",
        "<GDALMetadata>",
        "<Item name=\"SCALE\" sample=\"0\" role=\"scale\">2</Item>",
    ],
);

/// Portable gray maps.
pub(super) const PNM: Reader = format(
    "pgm",
    &["crates/terrain/tests/fixtures/*.pgm"],
    &["P2", "P5", "65535", "255", "65536", "\n#", "\n"],
);

/// ESRI ASCII grids.
pub(super) const ASCII_GRID: Reader = format(
    "ascii-grid",
    &[],
    &[
        "ncols ",
        "nrows ",
        "xllcorner ",
        "xllcenter ",
        "cellsize ",
        "dx ",
        "NODATA_value ",
        "-9999",
        "nan",
        "1e39",
    ],
);

/// Maps of `MovingAI` benchmarks.
pub(super) const MOVING_AI: Reader =
    format("moving-ai", &[], &["type octile\n", "height ", "width ", "map\n", ".", "@", "T", "G", "W", "S"]);

const LABEL_WORDS: &[&str] = &[
    "PDS_VERSION_ID = PDS3\r\n",
    "^IMAGE = ",
    "RECORD_BYTES = ",
    "LINES = ",
    "LINE_SAMPLES = ",
    "SAMPLE_TYPE = PC_REAL\r\n",
    "SAMPLE_BITS = 32\r\n",
    "SAMPLE_BITS = 8\r\n",
    "SCALING_FACTOR = ",
    "OFFSET = ",
    "UNIT = KILOMETER\r\n",
    "MAP_SCALE = ",
    "MAP_RESOLUTION = ",
    "MISSING_CONSTANT = 16#",
    "<BYTES>",
    "END\r\n",
    "LINE_PREFIX_BYTES = ",
    "BANDS = ",
    "OBJECT = IMAGE\r\n",
    "END_OBJECT\r\n",
];

/// PDS3 images with their label.
pub(super) const PDS: Reader = format("pds", &[], LABEL_WORDS);

/// PDS3 labels in files of their own: up to the first zero byte the label, and then its image.
pub(super) const DETACHED: Reader = Reader {
    name: "pds-detached",
    seeds: &[],
    words: LABEL_WORDS,
    mend: nothing,
    exercise: detached,
    tested: 2000,
    keeps_form: 1,
    cost: 1,
};

fn detached(input: &[u8]) -> Outcome {
    let end = input.iter().position(|&byte| byte == 0).unwrap_or(input.len());
    let (label, image) = (&input[..end], input.get(end + 1..).unwrap_or_default());
    let _ = image_of_label(label);
    let beside = ImportOptions { label: Some(label.to_vec()), ..ImportOptions::default() };
    exercise(image, &beside);
    match attach_label(label, image) {
        Ok(whole) => exercise(&whole, &ImportOptions::default()),
        Err(reason) => refused(&reason.to_string()),
    }
}

/// Maps of ROS, their description before their image.
pub(super) const ROS: Reader = format(
    "ros-maps",
    &[],
    &[
        "image: ",
        "resolution: ",
        "origin: [0, 0, 0]\n",
        "negate: 1\n",
        "mode: raw\n",
        "mode: scale\n",
        "free_thresh: ",
        "occupied_thresh: ",
        "- 0\n",
        "...\n",
        "P5 2 2 255\n",
        "P2 2 2 9\n",
        "1e308",
        ".nan",
    ],
);

/// Files of any kind, also those that are refused by name.
pub(super) const ANY: Reader = format(
    "maps",
    &[
        "crates/terrain/tests/fixtures/*",
        "tests/fuzz/corpus/pds/*",
        "tests/fuzz/corpus/moving-ai/*",
        "tests/fuzz/corpus/ascii-grid/*",
    ],
    &[
        "CDF\x01",
        "\u{89}HDF",
        "Object = IsisCube",
        "<?xml version=\"1.0\"?>",
        "image: a.pgm\nresolution: 0.05\n",
    ],
);
