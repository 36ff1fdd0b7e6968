//! Map files: small ones written by other programs (Pillow, tifffile), the real ones beside the repository, and broken
//! ones.

use std::path::Path;

use terrain::Cell;
use terrain::format::{
    FileFormat, FormatError, ImportOptions, MAX_CELL_COUNT, Meaning, Raster, RawLayout, SampleType,
    attach_label, image_of_label, read_raster, read_terrain,
};

fn fixture(name: &str) -> Raster {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name);
    let bytes = std::fs::read(path).expect("the fixture is in the repository");
    read_raster(&bytes, &ImportOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A file of the data that stands beside the repository, or `None` with a message.
#[expect(clippy::print_stderr, reason = "a test that could not look at its data says so")]
fn shared(name: &str) -> Option<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        eprintln!("NOT TESTED: there is no {}", path.display());
    }
    bytes
}

fn read(bytes: &[u8]) -> Result<Raster, FormatError> {
    read_raster(bytes, &ImportOptions::default())
}

const LEVELS: [f32; 20] = [
    0.0, 100.0, 200.0, 300.0, 400.0, 1000.0, 1100.0, 1200.0, 1300.0, 1400.0, 60000.0, 60100.0, 60200.0,
    60300.0, 60400.0, 5.0, 4.0, 3.0, 2.0, 1.0,
];

#[test]
fn sixteen_bit_pictures_keep_their_levels() {
    for name in ["pillow-gray16.png", "pillow-gray16.pgm"] {
        let raster = fixture(name);
        assert_eq!((raster.width, raster.height), (5, 4), "{name}");
        assert_eq!(raster.samples, LEVELS, "{name}");
    }
    assert_eq!(fixture("pillow-gray16.png").meaning, Meaning::Levels { greatest: Some(65_535) });
}

#[test]
fn eight_bit_pictures_keep_their_levels() {
    let expected = LEVELS.map(|level| level % 251.0);
    for name in ["pillow-gray8.pgm", "pillow-gray8-lzw.tiff"] {
        let raster = fixture(name);
        assert_eq!(raster.samples, expected, "{name}");
        assert_eq!(raster.meaning, Meaning::Levels { greatest: Some(255) }, "{name}");
    }
}

#[test]
fn a_color_counts_as_its_mean_and_a_transparent_pixel_has_no_data() {
    let raster = fixture("pillow-rgba8.png");
    assert_eq!(raster.samples[..5], [0.0, 60.0, 0.0, 0.0, 0.0]);
    assert!(raster.samples[5].is_nan());
}

#[test]
fn geotiff_tags_give_cell_size_and_holes() {
    let raster = fixture("tifffile-float32-deflate-geo.tiff");
    assert_eq!((raster.width, raster.height, raster.cell_size_m), (4, 3, Some(2.5)));
    assert!(raster.samples[2].is_nan());
    assert_eq!(raster.samples[..2], [1.5, -2.25]);
    let terrain = raster.into_terrain();
    // The first row of the file is the northernmost.
    assert_eq!(terrain.height_of(Cell { column: 0, row: 2 }), Some(1.5));
    assert_eq!(terrain.height_of(Cell { column: 3, row: 0 }), Some(-4.0));
    assert_eq!(terrain.height_of(Cell { column: 2, row: 2 }), None);
    assert_eq!(terrain.no_data_count(), 1);
}

#[test]
fn geotiff_in_degrees_is_brought_to_meters_by_the_bodys_radius() {
    let raster = fixture("tifffile-int32-tiled-degrees.tiff");
    assert_eq!((raster.width, raster.height), (40, 37));
    // Half a degree of a circle of 1000 m radius.
    assert!((raster.cell_size_m.unwrap() - 8.726_646_259_971_648).abs() < 1e-9);
    let expected: Vec<f32> = (0..40 * 37).map(|index| (index - 700) as f32).collect();
    assert_eq!(raster.samples, expected);
}

#[test]
fn tiff_samples_of_other_types_are_read() {
    let signed = fixture("tifffile-int16-bigendian.tiff");
    assert_eq!(signed.samples, [1.0, -2.0, -9999.0, 4.0, 5.0, 6.0, 7.0, 8.0, -1.0, -2.0, -3.0, -4.0]);
    let double = fixture("tifffile-float64.tiff");
    assert_eq!(double.samples[..4], [1.5, -2.25, -9999.0, 4.0]);
    let wide = fixture("tifffile-uint32.tiff");
    assert_eq!(wide.samples[1], 7_000_000.0);
    assert_eq!(wide.samples[10], 60_000.0 * 70_000.0);
}

#[test]
fn phobos_reads_as_tifffile_reads_it() {
    let Some(bytes) = shared("terrain/Phobos_ME_HRSC_DEM_Global_2ppd.tiff") else { return };
    let raster = read(&bytes).unwrap();
    assert_eq!((raster.width, raster.height), (699, 349));
    assert!((raster.cell_size_m.unwrap() - 100.0).abs() < 1e-4);
    // Read with tifffile 2026.3.3.
    assert_eq!(raster.samples[..2], [-1266.0, -1266.0]);
    assert_eq!(raster.samples[100 * 699 + 200], -664.0);
    assert_eq!(raster.samples[348 * 699 + 698], -2889.0);
    let terrain = raster.into_terrain();
    assert_eq!(terrain.height_range_m(), Some([-2940.0, 2917.0]));
    assert_eq!(terrain.no_data_count(), 0);
}

#[test]
fn mars_has_its_highest_and_lowest_places_where_they_are() {
    let Some(bytes) = shared("terrain/megt90n000cb.img") else { return };
    for options in [
        ImportOptions::default(),
        ImportOptions {
            raw: Some(RawLayout::new(1440, 720, SampleType::I16BigEndian)),
            ..ImportOptions::default()
        },
    ] {
        let terrain = read_terrain(&bytes, &options).unwrap();
        let frame = *terrain.frame();
        assert_eq!((frame.width, frame.height), (1440, 720));
        // Four cells a degree, row 0 at the south pole, longitude from 0° east.
        let highest = (0..frame.cell_count())
            .max_by(|&a, &b| terrain.heights_m()[a].total_cmp(&terrain.heights_m()[b]))
            .unwrap();
        let cell = frame.cell(highest);
        let (longitude, latitude) =
            ((f64::from(cell.column) + 0.5) / 4.0, (f64::from(cell.row) + 0.5) / 4.0 - 90.0);
        // Olympus Mons: 18.65° N, 226.2° E, 21.2 km; its highest rim is on the south-east of its caldera.
        assert!((latitude - 18.65).abs() < 1.5 && (longitude - 226.2).abs() < 1.5, "{latitude} {longitude}");
        let [low, high] = terrain.height_range_m().unwrap();
        assert!((20_500.0..21_500.0).contains(&high), "{high}");
        // The floor of Hellas.
        assert!((-8_300.0..-7_500.0).contains(&low), "{low}");
    }
    let cell = read(&bytes).unwrap().cell_size_m.unwrap();
    // A quarter of a degree on Mars is 14.8 km.
    assert!((cell - 14_818.7).abs() < 1.0, "{cell}");
}

#[test]
fn obstacle_maps_are_a_fifth_obstacles_and_free_at_their_corners() {
    for name in ["maps/map_1.pgm", "maps/map_2.pgm"] {
        let Some(bytes) = shared(name) else { return };
        let obstacles = read(&bytes).unwrap().obstacles();
        let share = obstacles.iter().filter(|&&obstacle| obstacle).count() as f64 / obstacles.len() as f64;
        assert!((share - 0.2).abs() < 0.02, "{name}: {share}");
        assert!(!obstacles[8 * 512 + 8] && !obstacles[503 * 512 + 503]);
    }
}

#[test]
fn an_ascii_grid_is_read_with_its_cell_size_and_holes() {
    let text = "ncols 3\nnrows 2\nxllcorner 100.0\nyllcorner 200.0\ncellsize 2.5\nNODATA_value -99\n1 2 -99\n4 5.5 -6e1\n";
    let raster = read(text.as_bytes()).unwrap();
    assert_eq!((raster.width, raster.height, raster.cell_size_m), (3, 2, Some(2.5)));
    assert_eq!(raster.samples[..2], [1.0, 2.0]);
    assert!(raster.samples[2].is_nan());
    assert_eq!(raster.samples[3..], [4.0, 5.5, -60.0]);
    // It lies where it says, by its corner or by the middle of its south-western cell.
    assert_eq!(raster.origin_m, Some([100.0, 200.0]));
    assert_eq!(raster.into_terrain().height_at(nalgebra::Point2::new(101.0, 201.0)), Some(4.0));
    let by_center = read(text.replace("corner", "center").as_bytes()).unwrap();
    assert_eq!(by_center.origin_m, Some([98.75, 198.75]));
    let half = read(text.replace("yllcorner 200.0\n", "").as_bytes()).unwrap();
    assert_eq!(half.origin_m, None);
}

#[test]
fn a_map_of_corners_has_one_row_and_one_column_less() {
    let text = "type octile-corner\nheight 3\nwidth 4\nmap\nabcd\nabcd\nabcd\n.T.x\ng@sx\nxxxx\n";
    let raster = read(text.as_bytes()).unwrap();
    assert_eq!((raster.width, raster.height), (3, 2));
    assert_eq!(raster.samples, [0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    assert!(read(text.replace("octile-corner", "octile").as_bytes()).is_err());
    assert!(read(b"type octile-corner\nheight 1\nwidth 1\nmap\na\n.\n").is_err());
}

#[test]
fn an_ascii_grid_has_square_cells() {
    let grid = |dy: &str| format!("ncols 2\nnrows 1\ndx 2.5\ndy {dy}\n1 2\n");
    assert_eq!(read(grid("2.5").as_bytes()).unwrap().cell_size_m, Some(2.5));
    let message = read(grid("5").as_bytes()).unwrap_err().to_string();
    assert!(message.contains("must be square, not 2.5 × 5"), "{message}");
}

#[test]
fn a_text_gray_map_may_have_comments() {
    let raster = read(b"P2 # made by hand\n# size\n2 2\n9\n0 9 # row\n4 5").unwrap();
    assert_eq!(raster.samples, [0.0, 9.0, 4.0, 5.0]);
    assert_eq!(raster.obstacles(), [true, false, true, false]);
}

#[test]
fn a_moving_ai_map_gives_obstacles() {
    let raster = read(b"type octile\nheight 3\nwidth 4\nmap\n.G@T\r\nS.OW\n....\n").unwrap();
    assert_eq!((raster.width, raster.height, raster.meaning), (4, 3, Meaning::Obstacles));
    let expected: Vec<bool> = "..@@..@@....".chars().map(|character| character == '@').collect();
    assert_eq!(raster.obstacles(), expected);
    let without_type = read(b"\n height 3\nwidth 4\nmap\n.G@T\nS.OW\n....\n").unwrap();
    assert_eq!(without_type, raster);
    // Anything else about a height is no map.
    assert_eq!(read(b"height 3\ndepth 4\nmap\n"), Err(FormatError::Unknown));
    let small = read("\u{feff}type octile\nheight 3\nwidth 4\nmap\n.g@t\ns.ow\n....\n".as_bytes()).unwrap();
    assert_eq!(small.obstacles(), expected);
}

fn pds_image() -> Vec<u8> {
    let label = "PDS_VERSION_ID = PDS3\r\nRECORD_TYPE = FIXED_LENGTH\r\nRECORD_BYTES = 512\r\n^IMAGE = 2\r\n\
        OBJECT = IMAGE\r\nLINES = 2\r\nLINE_SAMPLES = 3\r\nSAMPLE_TYPE = LSB_INTEGER\r\nSAMPLE_BITS = 16\r\n\
        SCALING_FACTOR = 0.5\r\nOFFSET = 100.0\r\nMISSING_CONSTANT = -32768\r\nEND_OBJECT = IMAGE\r\n\
        MAP_SCALE = 0.25 <KM/PIXEL>\r\nEND\r\n";
    let mut bytes = label.as_bytes().to_vec();
    bytes.resize(512, b' ');
    for value in [0_i16, 2, -4, -32768, 10, 12] {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

#[test]
fn a_pds_label_says_where_the_samples_are_and_what_they_mean() {
    let raster = read(&pds_image()).unwrap();
    assert_eq!((raster.width, raster.height, raster.cell_size_m), (3, 2, Some(250.0)));
    assert_eq!(raster.samples[..3], [100.0, 101.0, 98.0]);
    assert!(raster.samples[3].is_nan());
    // The same label in a file of its own points to another file.
    let bytes = pds_image();
    let label = String::from_utf8_lossy(&bytes[..512]).replace("^IMAGE = 2", "^IMAGE = \"DATA.IMG\"");
    let options = ImportOptions { label: Some(label.into_bytes()), ..ImportOptions::default() };
    let detached = read_raster(&bytes[512..], &options).unwrap();
    assert_eq!(detached.samples[..3], raster.samples[..3]);
}

#[test]
fn a_label_of_its_own_and_its_image_become_one_file() {
    let bytes = pds_image();
    let whole = read(&bytes).unwrap();
    let label = |pointer: &str| {
        let label =
            String::from_utf8_lossy(&bytes[..512]).replace("^IMAGE = 2", &format!("^IMAGE = {pointer}"));
        label.into_bytes()
    };
    assert_eq!(image_of_label(&bytes), None, "the image follows the label");
    assert_eq!(image_of_label(&bytes[512..]), None);
    for (pointer, skipped) in
        [("\"DATA.IMG\"", 0), ("(\"DATA.IMG\", 2)", 512), ("(\"DATA.IMG\", 11 <BYTES>)", 10)]
    {
        assert_eq!(image_of_label(&label(pointer)).as_deref(), Some("DATA.IMG"), "{pointer}");
        let mut image = vec![7; skipped];
        image.extend_from_slice(&bytes[512..]);
        let joined = read(&attach_label(&label(pointer), &image).unwrap()).unwrap();
        assert_eq!((joined.width, joined.cell_size_m), (whole.width, whole.cell_size_m), "{pointer}");
        assert_eq!(joined.samples[..3], whole.samples[..3], "{pointer}");
    }
}

#[test]
fn the_missing_constant_of_a_label_may_be_written_as_bits() {
    let label = |kind: &str, bits: u32, missing: &str| {
        let text = format!(
            "PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 256\r\n^IMAGE = 2\r\nLINES = 1\r\nLINE_SAMPLES = 2\r\n\
             SAMPLE_TYPE = {kind}\r\nSAMPLE_BITS = {bits}\r\nMISSING_CONSTANT = {missing}\r\nEND\r\n"
        );
        let mut bytes = text.into_bytes();
        bytes.resize(256, b' ');
        bytes
    };
    let mut real = label("PC_REAL", 32, "16#FF7FFFFB#");
    real.extend(f32::from_bits(0xff7f_fffb).to_le_bytes());
    real.extend(7.5_f32.to_le_bytes());
    let raster = read(&real).unwrap();
    assert!(raster.samples[0].is_nan());
    assert_eq!(raster.samples[1], 7.5);
    let mut integer = label("MSB_INTEGER", 16, "16#8000#");
    integer.extend(i16::MIN.to_be_bytes());
    integer.extend(3_i16.to_be_bytes());
    let raster = read(&integer).unwrap();
    assert!(raster.samples[0].is_nan());
    assert_eq!(raster.samples[1], 3.0);
    // What cannot be read is refused rather than taken for a height.
    for wrong in ["16#XY#", "16#FF7FFFFB#", "NULL"] {
        let mut bytes = label("MSB_INTEGER", 16, wrong);
        bytes.extend([0; 4]);
        assert!(read(&bytes).is_err(), "{wrong}");
    }
}

/// A label with its image of two samples, 3 and 40, and further lines in the label.
fn pds_with(lines: &str) -> Vec<u8> {
    let mut bytes = format!(
        "PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 512\r\n^IMAGE = 2\r\nLINES = 1\r\nLINE_SAMPLES = 2\r\n\
         SAMPLE_TYPE = MSB_INTEGER\r\nSAMPLE_BITS = 16\r\n{lines}\r\nEND\r\n"
    )
    .into_bytes();
    bytes.resize(512, b' ');
    bytes.extend([0, 3, 0, 40]);
    bytes
}

#[test]
fn scaling_factor_offset_and_unit_of_a_label_make_meters() {
    for (lines, expected) in [
        ("SCALING_FACTOR = N/A", [3.0, 40.0]),
        ("SCALING_FACTOR = 0.5<METER>\r\nOFFSET = -1.0", [0.5, 19.0]),
        ("SCALING_FACTOR = 0.5\r\nOFFSET = 1\r\nUNIT = KILOMETER", [2500.0, 21_000.0]),
        ("UNIT = \"METERS\"", [3.0, 40.0]),
    ] {
        assert_eq!(read(&pds_with(lines)).unwrap().samples, expected, "{lines}");
    }
    for wrong in ["SCALING_FACTOR = HALF", "OFFSET = 1E999", "UNIT = KELVIN", "LINE_DISPLAY_DIRECTION = UP"] {
        let message = read(&pds_with(wrong)).unwrap_err().to_string();
        let (keyword, value) = wrong.split_once(" = ").unwrap();
        assert!(message.contains(value) && (keyword == "UNIT" || message.contains(keyword)), "{message}");
    }
    let compressed = read(&pds_with("ENCODING_TYPE = \"HUFFMAN_FIRST_DIFFERENCE\"")).unwrap_err().to_string();
    assert!(compressed.contains("HUFFMAN") && compressed.contains("gdal_translate"), "{compressed}");
}

#[test]
fn what_other_objects_and_texts_of_a_label_say_is_not_of_the_image() {
    let table = "OBJECT = TABLE\r\nOBJECT = COLUMN\r\nOFFSET = 1000\r\nSCALING_FACTOR = 7\r\nMISSING_CONSTANT = 3\r\n\
        END_OBJECT = COLUMN\r\nEND_OBJECT\r\n";
    let text = "DESCRIPTION = \"Heights. In older editions\r\n  OFFSET = 1000\r\n  MISSING_CONSTANT = 3\r\nheld.\"\r\n";
    let comment = "/* OFFSET = 1000 */\r\nNOTE = 5 /* and\r\n";
    let list = "SOURCE_PRODUCT_ID = {\"A\",\r\n \"OFFSET = 1000\"}\r\nSCALING_FACTOR =\r\n  1.0\r\n";
    for lines in [table, text, comment, list, "OBJECT = IMAGE\r\nOFFSET = 0\r\nEND_OBJECT\r\nOFFSET = 1000"] {
        assert_eq!(read(&pds_with(lines)).unwrap().samples, [3.0, 40.0], "{lines}");
    }
    // A text that is never closed hides nothing.
    assert_eq!(read(&pds_with("NOTE = \"not closed\r\nOFFSET = 1")).unwrap().samples, [4.0, 41.0]);
    // Groups, and files around the image, speak of it.
    let group = "GROUP = BAND\r\nOFFSET = 1\r\nEND_GROUP = BAND\r\n";
    assert_eq!(read(&pds_with(group)).unwrap().samples, [4.0, 41.0]);
    // A label of its own with such objects has its image, too.
    let whole = pds_with(table);
    let label = String::from_utf8_lossy(&whole[..512]).replace("^IMAGE = 2", "^IMAGE =\r\n  \"A.IMG\"");
    assert_eq!(image_of_label(label.as_bytes()).as_deref(), Some("A.IMG"));
    let joined = attach_label(label.as_bytes(), &whole[512..]).unwrap();
    assert_eq!(read(&joined).unwrap().samples, [3.0, 40.0]);
}

#[test]
fn special_values_are_no_heights_and_records_have_a_length() {
    for keyword in ["CORE_NULL", "INVALID_CONSTANT", "CORE_LOW_REPR_SATURATION", "HIGH_INSTR_SATURATION"] {
        let lines = format!("MISSING_CONSTANT = -32768\r\n{keyword} = 16#0028#");
        let samples = read(&pds_with(&lines)).unwrap().samples;
        assert!(samples[0] == 3.0 && samples[1].is_nan(), "{keyword}: {samples:?}");
    }
    let unknown = String::from_utf8(pds_with("").clone()).unwrap().replace("RECORD_BYTES", "RECORD_COUNT");
    let message = read(unknown.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("RECORD_BYTES does not say"), "{message}");
}

#[test]
fn the_cells_of_a_label_have_the_size_that_its_units_say() {
    for (lines, expected) in [
        ("MAP_SCALE = 0.25", 250.0),
        ("MAP_SCALE = 0.25<KM/PIXEL>", 250.0),
        ("MAP_SCALE = 250 <METERS/PIXEL>", 250.0),
        // A degree of a circle of 180 km around.
        ("MAP_RESOLUTION = 2.0 <PIXEL/DEGREE>\r\nA_AXIS_RADIUS = 28.64788975654116 <KM>", 250.0),
    ] {
        let cell = read(&pds_with(lines)).unwrap().cell_size_m.unwrap();
        assert!((cell - expected).abs() < 1e-9, "{lines}: {cell}");
    }
    for (lines, expected) in [
        ("MAP_SCALE = 2 <DEGREE>", "the unit of its MAP_SCALE"),
        ("TARGET_NAME = MOON\r\nMAP_RESOLUTION = 4", "A_AXIS_RADIUS of MOON"),
    ] {
        let message = read(&pds_with(lines)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_label_without_its_image_says_where_the_image_is() {
    let label = String::from_utf8(pds_with("")[..512].to_vec()).unwrap();
    let message =
        read(label.replace("^IMAGE = 2", "^IMAGE = (\"A.IMG\", 1)").as_bytes()).unwrap_err().to_string();
    assert!(message.contains("only the label") && message.contains("\"A.IMG\""), "{message}");
}

#[test]
fn the_missing_constant_of_single_precision_may_have_fewer_digits() {
    let lines = "MISSING_CONSTANT = -3.40282346638529e+38";
    let text = String::from_utf8(pds_with(lines)[..512].to_vec()).unwrap();
    let text = text.replace("MSB_INTEGER", "IEEE_REAL  ").replace("BITS = 16", "BITS = 32");
    let bytes = [&text.as_bytes()[..512], &f32::MIN.to_be_bytes(), &2.5_f32.to_be_bytes()].concat();
    let raster = read(&bytes).unwrap();
    assert!(raster.samples[0].is_nan());
    assert_eq!(raster.samples[1], 2.5);
}

#[test]
fn files_of_other_formats_are_refused_by_name_with_what_to_do() {
    let pds4 = "<?xml version=\"1.0\"?>\n<Product_Observational xmlns=\"http://pds.nasa.gov/pds4/pds/v1\">";
    let cases: [(&[u8], &str, &str); 9] = [
        (b"Object = IsisCube\n  Object = Core\n", "ISIS cube", "gdal_translate"),
        (b"CCSD3ZF0000100000001NJPL3IF0PDS200000001 = SFDU_LABEL\r\n", "ISIS 2", "gdal_translate"),
        (pds4.as_bytes(), "PDS4 label", "gdal_translate LABEL.xml"),
        (b"LBLSIZE=2048  FORMAT='HALF'", "VICAR", "gdal_translate"),
        (b"\x89HDF\r\n\x1a\n\0\0", "HDF5", "gdal_translate"),
        (b"\0\0\0\x0cjP  \r\n", "JPEG 2000", "gdal_translate"),
        (b"\xff\xd8\xff\xe0", "JPEG", "PNG or GeoTIFF"),
        (b"PK\x03\x04\x14", "ZIP", "unpack"),
        (b"<VRTDataset rasterXSize=\"20\">", "GDAL VRT", "gdal_translate"),
    ];
    for (bytes, name, advice) in cases {
        let error = read(bytes).unwrap_err();
        assert!(matches!(error, FormatError::Unsupported { .. }), "{error}");
        let message = error.to_string();
        assert!(message.contains(name) && message.contains(advice), "{message}");
    }
    // A raw map of a whole planet may begin with the bytes of a JPEG image: -40 m and -32 m.
    let mut raw = vec![0; 4 * 90 * 90];
    raw[..4].copy_from_slice(b"\xff\xd8\xff\xe0");
    assert_eq!(read(&raw).unwrap().samples[..3], [-40.0, -32.0, 0.0]);
    // As the label of an image, too.
    let options = ImportOptions { label: Some(pds4.into()), ..ImportOptions::default() };
    assert!(read_raster(&[0; 64], &options).unwrap_err().to_string().contains("PDS4"));
    // Any other XML is unknown, and what is read is listed.
    let message = read(b"<?xml version=\"1.0\"?><kml/>").unwrap_err().to_string();
    for ending in [".png", ".pgm", ".tif", ".img", ".asc", ".map"] {
        assert!(message.contains(ending), "{message}");
    }
}

#[test]
fn the_callers_scale_hole_and_cell_size_apply() {
    let options = ImportOptions {
        cell_size_m: Some(3.0),
        vertical_scale: Some(0.5),
        no_data: Some(9.0),
        ..ImportOptions::default()
    };
    let terrain = read_terrain(b"P2 2 1 9 9 4", &options).unwrap();
    assert_eq!(terrain.frame().cell_size_m, 3.0);
    assert_eq!(terrain.height_of(Cell { column: 1, row: 0 }), Some(2.0));
    assert_eq!(terrain.height_of(Cell { column: 0, row: 0 }), None);
}

#[test]
fn an_enormous_map_is_refused_before_it_is_allocated() {
    let ascii = "ncols 4000000000\nnrows 4000000000\ncellsize 1\n0";
    let moving = "type octile\nheight 999999\nwidth 999999\nmap\n.";
    let mut png =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/pillow-gray16.png"))
            .unwrap();
    // The width in the header, with the checksum that goes with it.
    png[16..20].copy_from_slice(&0x7fff_ffff_u32.to_be_bytes());
    let checksum = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    for bytes in [b"P5 70000 70000 255 ".as_slice(), ascii.as_bytes(), moving.as_bytes(), &png] {
        let error = read(bytes).unwrap_err();
        assert!(matches!(error, FormatError::TooLarge { .. }), "{error}");
        assert!(error.to_string().contains(&MAX_CELL_COUNT.to_string()));
    }
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
    })
}

#[test]
fn a_broken_file_is_an_error_that_says_what_is_wrong() {
    let cases: [(&[u8], &str); 13] = [
        (b"", "unrecognized map format"),
        (b"hello, world", "unrecognized map format"),
        (b"P5 3 3 255\n12345", "9 bytes, and 5 follow"),
        (b"P5 3 x 255\n", "the height should be a number but is `x`"),
        (b"P5 0 3 255\n", "no cells"),
        (b"P2 3 3 70000\n", "70000"),
        (b"P2 2 2 9\n1 2 3", "ends"),
        (b"ncols 2\nnrows 2\ncellsize 1\n1 2 3", "3 values for 2 × 2"),
        (b"ncols 2\ncellsize 1\n1 2 3", "expected `nrows`"),
        (b"ncols 2\nnrows 1\ncellsize 1\n1 b", "value 2 is `b`"),
        (b"type octile\nheight 1\nwidth 3\nmap\n.?.\n", "a cell `?`"),
        (b"type octile\nheight 2\nwidth 3\nmap\n...\n..\n", "row 2"),
        (b"PDS_VERSION_ID = PDS3\nLINES = 3\nEND\n", "LINE_SAMPLES"),
    ];
    for (bytes, expected) in cases {
        let message = read(bytes).unwrap_err().to_string();
        assert!(message.contains(expected), "`{message}` should contain `{expected}`");
    }
}

#[test]
fn no_cut_or_flipped_byte_of_a_file_makes_reading_panic() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    let mut files: Vec<Vec<u8>> = names.iter().map(|path| std::fs::read(path).unwrap()).collect();
    files.push(pds_image());
    for bytes in files {
        assert!(read(&bytes).is_ok());
        for end in 0..bytes.len().min(400) {
            let _ = read(&bytes[..end]);
        }
        for index in 0..bytes.len().min(400) {
            for change in [0xff, 0x01, 0x80] {
                let mut broken = bytes.clone();
                broken[index] ^= change;
                let _ = read(&broken);
            }
        }
    }
}

#[test]
fn formats_are_recognized_by_their_first_bytes() {
    assert_eq!(FileFormat::detect(b"MM\0*\0\0\0\x08"), Some(FileFormat::Tiff));
    assert_eq!(FileFormat::detect(b"\nNCOLS 3"), Some(FileFormat::AsciiGrid));
    assert_eq!(FileFormat::detect(b"nothing known"), None);
}

/// Other programs write absent heights as words, also first of all, name such a word in the header, and begin with a byte-order
/// mark.
#[test]
fn absent_heights_of_an_ascii_grid_may_be_words() {
    for absent in ["nan", "NaN", "null", "NA", "none"] {
        let grid =
            format!("\u{feff}ncols 2\nnrows 2\ncellsize 1\nNODATA_value {absent}\n{absent} 1\n2 {absent}\n");
        let raster = read(grid.as_bytes()).unwrap_or_else(|error| panic!("{absent}: {error}"));
        let [a, b, c, d] = raster.samples[..] else { panic!("{absent}: {:?}", raster.samples) };
        assert!(a.is_nan() && b == 1.0 && c == 2.0 && d.is_nan(), "{absent}: {:?}", raster.samples);
    }
    let infinite = read(b"ncols 2\nnrows 1\ncellsize 1\ninf 1\n").unwrap();
    assert!(infinite.samples[0].is_nan() && infinite.samples[1] == 1.0, "{:?}", infinite.samples);
    for size in ["0", "-1", "nan", "inf"] {
        let error = read(format!("ncols 2\nnrows 1\ncellsize {size}\n1 2\n").as_bytes());
        let error = error.expect_err("no map has such cells").to_string();
        assert!(error.contains("`cellsize` must be positive"), "{size}: {error}");
    }
    let error = read(b"ncols 2\nnrows 2\ncellsize 1\nnan 1 2 nothing\n");
    let error = error.expect_err("`nothing` is not a number").to_string();
    assert!(error.contains("value 4 is `nothing`"), "{error}");
}
