//! What `GeoTIFF` and GDAL tags say about heights, in files built here tag by tag: it is read, or refused by name.

use terrain::format::{FormatError, ImportOptions, Meaning, Raster, read_raster};

/// A tag's value and type.
enum Value {
    Shorts(Vec<u16>),
    Doubles(Vec<f64>),
    Text(&'static str),
    Longs(Vec<u32>),
}

/// One image: its tags, without those that say where its samples are, the bytes of its samples, and how many of them are in
/// each strip or tile; 0 in one that is not stored.
struct Image {
    tags: Vec<(u16, Value)>,
    samples: Vec<u8>,
    blocks: Vec<u32>,
}

const SUBFILE: u16 = 254;
const BITS: u16 = 258;
const COMPRESSION: u16 = 259;
const INTERPRETATION: u16 = 262;
const ORIENTATION: u16 = 274;
const BANDS: u16 = 277;
const ROWS_PER_STRIP: u16 = 278;
const TILE_WIDTH: u16 = 322;
const TILE_LENGTH: u16 = 323;
const EXTRA: u16 = 338;
const SAMPLE_FORMAT: u16 = 339;
const SCALE: u16 = 33_550;
const TIE_POINTS: u16 = 33_922;
const MATRIX: u16 = 34_264;
const KEYS: u16 = 34_735;
const TEXTS: u16 = 34_737;
const METADATA: u16 = 42_112;
const NO_DATA: u16 = 42_113;

impl Image {
    /// Bytes of `width` columns in two rows.
    fn bytes(width: u16, samples: &[u8]) -> Self {
        let tags = [(256, width), (257, 2), (BITS, 8), (COMPRESSION, 1), (INTERPRETATION, 1), (BANDS, 1)];
        let tags = tags.into_iter().map(|(tag, value)| (tag, Value::Shorts(vec![value]))).collect();
        Self { tags, samples: samples.to_vec(), blocks: vec![samples.len() as u32] }
    }

    /// 1 2 3 over 4 5 6.
    fn plain() -> Self {
        Self::bytes(3, &[1, 2, 3, 4, 5, 6])
    }

    fn with(mut self, tag: u16, value: Value) -> Self {
        self.tags.retain(|(other, _)| *other != tag);
        self.tags.push((tag, value));
        self
    }

    /// As many bytes in each block; 0 in one that is not stored.
    fn blocks(mut self, blocks: &[u32]) -> Self {
        self.blocks = blocks.to_vec();
        self
    }

    fn short(self, tag: u16, value: u16) -> Self {
        self.with(tag, Value::Shorts(vec![value]))
    }
}

/// A file of images one after another, in either byte order.
fn file(images: Vec<Image>, big_endian: bool) -> Vec<u8> {
    let short = |value: u16| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let long = |value: u32| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let double = |value: f64| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let mut bytes = if big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
    bytes.extend(long(0));
    let mut link = 4;
    for mut image in images {
        let mut next = bytes.len() as u32;
        bytes.extend(&image.samples);
        let offset = |&length: &u32| {
            next += length;
            if length == 0 { 0 } else { next - length }
        };
        let offsets = image.blocks.iter().map(offset).collect();
        let is_tiled = image.tags.iter().any(|(tag, _)| *tag == TILE_WIDTH);
        let (offsets_tag, lengths_tag) = if is_tiled { (324, 325) } else { (273, 279) };
        image.tags.push((offsets_tag, Value::Longs(offsets)));
        image.tags.push((lengths_tag, Value::Longs(image.blocks)));
        image.tags.sort_by_key(|(tag, _)| *tag);
        let mut entries = Vec::new();
        for (tag, value) in &image.tags {
            let (kind, count, mut content) = match value {
                Value::Shorts(values) => (3, values.len(), values.iter().flat_map(|&it| short(it)).collect()),
                Value::Doubles(values) => {
                    (12, values.len(), values.iter().flat_map(|&it| double(it)).collect())
                }
                Value::Text(text) => (2, text.len() + 1, [text.as_bytes(), b"\0"].concat()),
                Value::Longs(values) => (4, values.len(), values.iter().flat_map(|&it| long(it)).collect()),
            };
            if content.len() > 4 {
                let place = bytes.len() as u32;
                bytes.append(&mut content);
                content = long(place).to_vec();
            }
            content.resize(4, 0);
            entries.extend([&short(*tag)[..], &short(kind), &long(count as u32), &content].concat());
        }
        let directory = bytes.len();
        bytes[link..link + 4].copy_from_slice(&long(directory as u32));
        bytes.extend(short(image.tags.len() as u16));
        bytes.extend(entries);
        link = bytes.len();
        bytes.extend(long(0));
    }
    bytes
}

fn read_all(images: Vec<Image>) -> Result<Raster, FormatError> {
    read_raster(&file(images, false), &ImportOptions::default())
}

fn read(image: Image) -> Raster {
    read_all(vec![image]).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(image: Image) -> String {
    let error = read_all(vec![image]).unwrap_err();
    assert!(matches!(error, FormatError::Unsupported { .. }), "{error}");
    error.to_string()
}

const ROWS: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
const TURNED_ROWS: [f32; 6] = [4.0, 5.0, 6.0, 1.0, 2.0, 3.0];

fn scale(x: f64, y: f64) -> Value {
    Value::Doubles(vec![x, y, 0.0])
}

fn matrix(x: f64, x_of_row: f64, y_of_column: f64, y: f64) -> Value {
    let rows = [[x, x_of_row, 0.0, 70.0], [y_of_column, y, 0.0, 80.0], [0.0; 4], [0.0, 0.0, 0.0, 1.0]];
    Value::Doubles(rows.concat())
}

#[test]
fn a_map_in_meters_lies_where_its_tie_point_says() {
    let scale = || Value::Doubles(vec![10.0, 10.0, 0.0]);
    let tie = |column: f64, row: f64| Value::Doubles(vec![column, row, 0.0, 500.0, 900.0, 0.0]);
    let keys =
        |model: u16, raster: u16| Value::Shorts(vec![1, 1, 0, 2, 1024, 0, 1, model, 1025, 0, 1, raster]);
    let origin = |image: Image| read(image).origin_m;
    let plain = || Image::plain().with(SCALE, scale());
    // Two rows of 10 m lie below the north-west corner.
    assert_eq!(origin(plain().with(TIE_POINTS, tie(0.0, 0.0)).with(KEYS, keys(1, 1))), Some([500.0, 880.0]));
    assert_eq!(origin(plain().with(TIE_POINTS, tie(1.0, 2.0)).with(KEYS, keys(1, 1))), Some([490.0, 900.0]));
    // The middle of the north-western cell.
    assert_eq!(origin(plain().with(TIE_POINTS, tie(0.0, 0.0)).with(KEYS, keys(1, 2))), Some([495.0, 885.0]));
    // Degrees are not places on a plane.
    assert_eq!(origin(plain().with(TIE_POINTS, tie(0.0, 0.0)).with(KEYS, keys(2, 1))), None);
    assert_eq!(origin(plain()), None);
    let mut matrix = vec![0.0; 16];
    (matrix[0], matrix[3], matrix[5], matrix[7]) = (10.0, 500.0, 10.0, 900.0);
    assert_eq!(origin(Image::plain().with(MATRIX, Value::Doubles(matrix))), Some([500.0, 900.0]));
}

#[test]
fn a_plain_file_is_read_in_both_byte_orders() {
    for big_endian in [false, true] {
        let bytes = file(vec![Image::plain()], big_endian);
        let raster = read_raster(&bytes, &ImportOptions::default()).unwrap();
        assert_eq!((raster.samples.as_slice(), raster.cell_size_m), (&ROWS[..], None));
    }
}

#[test]
fn scale_and_offset_of_gdal_make_heights_of_stored_values() {
    let metadata = "<GDALMetadata>\n  <Item name=\"STATISTICS_MAXIMUM\" sample=\"0\">9</Item>\n  \
        <Item name=\"SCALE\" sample=\"1\" role=\"scale\">70</Item>\n  \
        <Item name=\"OFFSET\" sample=\"0\" role=\"offset\">-100</Item>\n  \
        <Item role='scale' sample='0' name='SCALE'> 0.5 </Item>\n</GDALMetadata>\n";
    let raster = read(Image::plain().with(METADATA, Value::Text(metadata)).with(NO_DATA, Value::Text("4")));
    assert_eq!(raster.samples[..3], [-99.5, -99.0, -98.5]);
    // What represents no data is a stored value.
    assert!(raster.samples[3].is_nan());
    assert_eq!(raster.samples[4], -97.5);
    let without_band = "<GDALMetadata><Item name=\"SCALE\" role=\"scale\">3</Item></GDALMetadata>";
    assert_eq!(read(Image::plain().with(METADATA, Value::Text(without_band))).samples[1], 6.0);
    for wrong in ["much", "inf", "", "0"] {
        let text = format!("<Item role=\"scale\">{wrong}</Item>");
        let image = Image::plain().with(METADATA, Value::Text(text.leak()));
        let error = read_all(vec![image]).unwrap_err().to_string();
        assert!(error.contains("its scale"), "{error}");
    }
}

#[test]
fn heights_in_other_units_are_brought_to_meters_or_refused() {
    let unit = |unit: &str| {
        let text = format!("<Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{unit}</Item>");
        Image::plain().with(METADATA, Value::Text(text.leak()))
    };
    assert_eq!(read(unit("m")).samples, ROWS);
    assert_eq!(read(unit("km")).samples[1], 2000.0);
    assert!((read(unit("ft")).samples[1] - 0.6096).abs() < 1e-6);
    assert!(refusal(unit("degree")).contains("`degree`"));
    let keys = |id: u16, code: u16| {
        let keys = vec![1, 1, 0, 2, 1024, 0, 1, 1, id, 0, 1, code];
        Image::plain().with(SCALE, scale(10.0, 10.0)).with(KEYS, Value::Shorts(keys))
    };
    let vertical = read(keys(4099, 9002));
    assert!((vertical.samples[0] - 0.3048).abs() < 1e-6 && vertical.cell_size_m == Some(10.0));
    let horizontal = read(keys(3076, 9002));
    assert!((horizontal.cell_size_m.unwrap() - 3.048).abs() < 1e-9 && horizontal.samples == ROWS);
    assert!(refusal(keys(3076, 9014)).contains("9014"));
}

#[test]
fn degrees_of_a_registered_system_are_degrees_of_the_earth() {
    let keys = Value::Shorts(vec![1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326]);
    let cell = read(Image::plain().with(SCALE, scale(1.0, 1.0)).with(KEYS, keys)).cell_size_m.unwrap();
    // A degree of the Earth's equator.
    assert!((cell - 111_319.49).abs() < 0.01, "{cell}");
}

#[test]
fn what_stands_for_no_data_matches_single_precision() {
    let lowest = f32::MIN.to_le_bytes();
    let samples = [lowest, 1.5_f32.to_le_bytes()].concat();
    let mut image = Image::bytes(1, &samples).short(BITS, 32).short(SAMPLE_FORMAT, 3);
    // Fewer digits than the number has as a double.
    image = image.with(NO_DATA, Value::Text("-3.40282346638529e+38"));
    let raster = read(image);
    assert!(raster.samples[0].is_nan());
    assert_eq!(raster.samples[1], 1.5);
    let error = read_all(vec![Image::plain().with(NO_DATA, Value::Text("none"))]).unwrap_err().to_string();
    assert!(error.contains("GDAL_NODATA") && error.contains("`none`"), "{error}");
}

#[test]
fn north_is_put_on_top_and_west_to_the_left() {
    let north = read(Image::plain().with(MATRIX, matrix(2.5, 0.0, 0.0, -2.5)));
    assert_eq!((north.samples.as_slice(), north.cell_size_m), (&ROWS[..], Some(2.5)));
    let south = read(Image::plain().with(MATRIX, matrix(2.5, 0.0, 0.0, 2.5)));
    assert_eq!((south.samples.as_slice(), south.cell_size_m), (&TURNED_ROWS[..], Some(2.5)));
    let west = read(Image::plain().with(MATRIX, matrix(-2.5, 0.0, 0.0, -2.5)));
    assert_eq!(west.samples, [3.0, 2.0, 1.0, 6.0, 5.0, 4.0]);
    let both = read(Image::plain().with(MATRIX, matrix(-2.5, 0.0, 0.0, 2.5)));
    assert_eq!(both.samples, [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]);
    // The specification and GDAL differ about these.
    assert!(refusal(Image::plain().with(SCALE, scale(2.5, -2.5))).contains("-2.5"));
    let rotated = Image::plain().with(MATRIX, matrix(2.0, 1.0, 1.0, -2.0));
    assert!(refusal(rotated).contains("rows must run from west to east"));
    let points = Image::plain().with(TIE_POINTS, Value::Doubles(vec![0.0; 18]));
    assert!(refusal(points).contains("control points"));
    assert!(refusal(Image::plain().short(ORIENTATION, 4)).contains("Orientation is 4"));
}

#[test]
fn cells_that_are_not_square_are_refused() {
    assert!(refusal(Image::plain().with(SCALE, scale(10.0, 20.0))).contains("must be square, not 10 × 20"));
    assert!(refusal(Image::plain().with(MATRIX, matrix(3.0, 0.0, 0.0, -2.0))).contains("must be square"));
    // Rounded numbers of a square are one.
    let rounded = read(Image::plain().with(SCALE, scale(463.093_5, 463.093_6)));
    assert_eq!(rounded.cell_size_m, Some(463.093_5));
}

fn mask(width: u16, bits: u16, samples: &[u8]) -> Image {
    Image::bytes(width, samples).short(SUBFILE, 4).short(BITS, bits).short(INTERPRETATION, 4)
}

#[test]
fn an_internal_mask_makes_holes() {
    let overview = || Image::bytes(1, &[1, 4]).short(SUBFILE, 1);
    let overview_mask = || mask(1, 1, &[0, 0]).short(SUBFILE, 5);
    for big_endian in [false, true] {
        for (bits, samples) in [(1, &[0b1010_0000, 0b0110_0000][..]), (8, &[255, 0, 1, 0, 255, 255])] {
            let images = vec![Image::plain(), overview(), mask(3, bits, samples), overview_mask()];
            let raster = read_raster(&file(images, big_endian), &ImportOptions::default()).unwrap();
            let holes: Vec<bool> = raster.samples.iter().map(|sample| sample.is_nan()).collect();
            assert_eq!(holes, [false, true, false, true, false, false], "{bits} bits");
            assert_eq!(raster.samples[4], 5.0);
        }
    }
    assert_eq!(read_all(vec![Image::plain(), overview(), overview_mask()]).unwrap().samples, ROWS);
    let error = read_all(vec![Image::plain(), mask(2, 1, &[0, 0])]).unwrap_err().to_string();
    assert!(error.contains("must have the same size"), "{error}");
    // A mask is turned with its heights.
    let south = Image::plain().with(MATRIX, matrix(1.0, 0.0, 0.0, 1.0));
    let turned = read_all(vec![south, mask(3, 1, &[0xff, 0])]).unwrap();
    assert!(turned.samples[..3].iter().all(|sample| sample.is_nan()));
    assert_eq!(turned.samples[3..], [1.0, 2.0, 3.0]);
}

#[test]
fn directories_in_a_ring_are_refused() {
    let mut bytes = file(vec![Image::plain(), Image::plain()], false);
    let first: [u8; 4] = bytes[4..8].try_into().unwrap();
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&first);
    let error = read_raster(&bytes, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("in a cycle"), "{error}");
}

#[test]
fn a_transparent_pixel_has_no_height() {
    let image = |kind: u16| {
        Image::bytes(1, &[7, 0, 9, 255])
            .short(BANDS, 2)
            .short(EXTRA, kind)
            .with(BITS, Value::Shorts(vec![8, 8]))
    };
    let raster = read(image(2));
    assert!(raster.samples[0].is_nan());
    assert_eq!(raster.samples[1], 9.0);
    // A second band of any other kind is left alone.
    assert_eq!(read(image(0)).samples, [7.0, 9.0]);
}

#[test]
fn heights_in_which_zero_is_white_are_what_is_stored() {
    for big_endian in [false, true] {
        let image = Image::bytes(3, &[0, 100, 255, 127, 128, 6]).short(INTERPRETATION, 0);
        let raster = read_raster(&file(vec![image], big_endian), &ImportOptions::default()).unwrap();
        assert_eq!(raster.samples, [0.0, 100.0, 255.0, 127.0, 128.0, 6.0]);
        assert_eq!(raster.meaning, Meaning::InvertedLevels { greatest: 255 });
        // As a picture it is dark where it is high.
        assert_eq!(raster.obstacles(), [false, false, true, false, true, false]);
    }
    let samples: Vec<u8> = [-3_i16, 40].iter().flat_map(|it| it.to_le_bytes()).collect();
    let signed = Image::bytes(1, &samples).short(BITS, 16).short(SAMPLE_FORMAT, 2).short(INTERPRETATION, 0);
    assert_eq!(read(signed).samples, [-3.0, 40.0]);
}

#[test]
fn other_compressions_and_pictures_are_refused_by_name() {
    for (compression, name) in [
        (50_000, "ZSTD"),
        (50_001, "WebP"),
        (34_887, "LERC"),
        (34_925, "LZMA"),
        (7, "JPEG"),
        (12_345, "number 12345"),
    ] {
        let message = refusal(Image::plain().short(COMPRESSION, compression));
        assert!(message.contains(name) && message.contains("gdal_translate -co COMPRESS"), "{message}");
    }
    assert!(refusal(Image::plain().short(INTERPRETATION, 3)).contains("palette"));
    assert!(refusal(Image::bytes(8, &[0, 0]).short(BITS, 1)).contains("samples of 1 bits"));
}

/// Samples of which NaN is equal to itself.
fn bits(samples: &[f32]) -> Vec<u32> {
    samples.iter().map(|sample| sample.to_bits()).collect()
}

#[test]
fn blocks_that_a_sparse_file_does_not_store_have_no_data() {
    const HOLE: f32 = f32::NAN;
    let strips =
        |blocks: &[u32], samples: &[u8]| Image::bytes(3, samples).short(ROWS_PER_STRIP, 1).blocks(blocks);
    for compression in [1, 32_773] {
        // Three literal bytes of PackBits.
        let samples = if compression == 1 { &[1, 2, 3][..] } else { &[2, 1, 2, 3] };
        let length = samples.len() as u32;
        let image = |blocks: &[u32]| strips(blocks, samples).short(COMPRESSION, compression);
        let below = read(image(&[length, 0]).with(NO_DATA, Value::Text("9")));
        assert_eq!(bits(&below.samples), bits(&[1.0, 2.0, 3.0, HOLE, HOLE, HOLE]));
        let above = read(image(&[0, length]).with(NO_DATA, Value::Text("9")));
        assert_eq!(bits(&above.samples), bits(&[HOLE, HOLE, HOLE, 1.0, 2.0, 3.0]));
        // As in GDAL, without a value that stands for no data.
        assert_eq!(read(image(&[length, 0])).samples, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
        assert_eq!(read(image(&[0, 0])).samples, [0.0; 6]);
    }
    let tile: Vec<u8> = (0..=255).collect();
    let tiles = |blocks: &[u32]| {
        let image = Image::bytes(20, &tile).short(TILE_WIDTH, 16).short(TILE_LENGTH, 16).blocks(blocks);
        read(image.with(NO_DATA, Value::Text("255")))
    };
    for (row, samples) in tiles(&[256, 0]).samples.chunks_exact(20).enumerate() {
        let stored: Vec<f32> = (0..16_u8).map(|column| f32::from(16 * row as u8 + column)).collect();
        assert_eq!(bits(samples), bits(&[&stored[..], &[HOLE; 4]].concat()));
    }
    for (row, samples) in tiles(&[0, 256]).samples.chunks_exact(20).enumerate() {
        let stored: Vec<f32> = (0..4_u8).map(|column| f32::from(16 * row as u8 + column)).collect();
        assert_eq!(bits(samples), bits(&[&[HOLE; 16], &stored[..]].concat()));
    }
    // Where a mask has no block, nothing is valid.
    let mask = mask(3, 1, &[0b1010_0000]).short(ROWS_PER_STRIP, 1).blocks(&[1, 0]);
    let masked = read_all(vec![Image::plain(), mask]).unwrap();
    assert_eq!(bits(&masked.samples), bits(&[1.0, HOLE, 3.0, HOLE, HOLE, HOLE]));
}

#[test]
fn compressed_blocks_that_cannot_be_decoded_are_refused_with_the_reason() {
    let old = Image::bytes(3, &[0, 1, 2, 3]).short(COMPRESSION, 5);
    assert!(refusal(old).contains("the order of before TIFF 6"));
    let mut bytes = file(vec![Image::plain().short(COMPRESSION, 32_773)], false);
    let entry = bytes.windows(4).position(|it| it == [0x17, 1, 4, 0]).unwrap();
    bytes[entry + 8..entry + 12].fill(0);
    let error = read_raster(&bytes, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("how long its compressed blocks are"), "{error}");
}

#[test]
fn what_a_picture_lacks_is_named() {
    let mut image = Image::plain();
    image.tags.retain(|(tag, _)| *tag != INTERPRETATION);
    assert!(refusal(image).contains("PhotometricInterpretation is missing"));
    let colors = Image::bytes(1, &[0; 6]).short(BANDS, 3).with(BITS, Value::Shorts(vec![8; 3]));
    let mask = colors.short(SUBFILE, 4).short(INTERPRETATION, 2);
    let error = read_all(vec![Image::bytes(1, &[1, 4]), mask]).unwrap_err().to_string();
    assert!(error.contains("its mask has 3 bands"), "{error}");
    // Bands of which each would fit, but not all.
    let large = Image::bytes(5000, &[1]).short(257, 5000).short(BANDS, 20);
    let large = large.with(BITS, Value::Shorts(vec![8; 20])).short(EXTRA, 0);
    assert!(refusal(large.with(EXTRA, Value::Shorts(vec![0; 19]))).contains("more memory"));
}

#[test]
fn the_unit_of_coordinates_is_never_guessed() {
    let image = |code: u16, key: u16, text: &'static str| {
        let length = text.len() as u16;
        let keys = vec![1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, code, key, 34_737, length, 0];
        let image = Image::plain().with(SCALE, scale(10.0, 10.0)).with(KEYS, Value::Shorts(keys));
        image.with(TEXTS, Value::Text(text))
    };
    let cell_m = |code: u16, key: u16, text: &'static str| read(image(code, key, text)).cell_size_m.unwrap();
    for meters in [32_601, 32_760, 26_711, 26_911, 25_832, 31_467, 3857, 2154, 3031, 3413, 0, 32_767] {
        assert_eq!(cell_m(meters, 3073, "a system|"), 10.0, "{meters}");
    }
    // Long Island, Oregon and New York: US survey feet and feet.
    for feet in [2263, 2994, 32_018] {
        let message = refusal(image(feet, 3073, "a system|"));
        assert!(message.contains(&format!("EPSG code {feet}")) && message.contains("unit"), "{message}");
    }
    assert_eq!(cell_m(2994, 3073, "NAD83(HARN) / Oregon GIC Lambert (m)\nUnits = meters|"), 10.0);
    let feet = cell_m(2838, 1026, "Projection = Oregon\nUnits = international_FeeT|");
    assert!((feet - 3.048).abs() < 1e-9, "{feet}");
    let survey = cell_m(2263, 3073, "GCS Units = degrees|PCS Units = us_survey_feet|");
    assert!((survey - 12_000.0 / 3937.0).abs() < 1e-9, "{survey}");
}

#[test]
fn an_identity_is_no_georeference() {
    let mut identity = vec![0.0; 16];
    (0..4).for_each(|axis| identity[5 * axis] = 1.0);
    // What it says about the third axis does not matter.
    for height in [1.0, 0.0] {
        identity[10] = height;
        let raster = read(Image::plain().with(MATRIX, Value::Doubles(identity.clone())));
        assert_eq!((raster.samples.as_slice(), raster.cell_size_m, raster.origin_m), (&ROWS[..], None, None));
    }
}

#[test]
fn infinity_stands_for_no_data_in_the_notation_of_windows() {
    for (text, number) in [("-1.#INF", f32::NEG_INFINITY), ("1.#INF", f32::INFINITY), ("1.#QNAN", f32::NAN)] {
        let samples = [number.to_le_bytes(), 1.5_f32.to_le_bytes()].concat();
        let image = Image::bytes(1, &samples).short(BITS, 32).short(SAMPLE_FORMAT, 3);
        let raster = read(image.with(NO_DATA, Value::Text(text)));
        assert!(raster.samples[0].is_nan() && raster.samples[1] == 1.5, "{text}");
    }
}

#[test]
fn no_changed_byte_makes_reading_panic() {
    let image = || {
        Image::plain()
            .short(INTERPRETATION, 0)
            .with(MATRIX, matrix(2.5, 0.0, 0.0, 2.5))
            .with(KEYS, Value::Shorts(vec![1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9002]))
            .with(METADATA, Value::Text("<Item role=\"scale\" sample=\"0\">2</Item>"))
            .with(NO_DATA, Value::Text("6"))
            .short(ROWS_PER_STRIP, 1)
            .blocks(&[0, 3])
    };
    for big_endian in [false, true] {
        let bytes = file(vec![image(), mask(3, 1, &[0xff, 0xff])], big_endian);
        assert!(read_raster(&bytes, &ImportOptions::default()).is_ok());
        for index in 0..bytes.len() {
            let _ = read_raster(&bytes[..index], &ImportOptions::default());
            for change in [0x01, 0x10, 0x80, 0xff] {
                let mut broken = bytes.clone();
                broken[index] ^= change;
                let _ = read_raster(&broken, &ImportOptions::default());
            }
        }
    }
}
