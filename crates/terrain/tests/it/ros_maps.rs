//! Maps of ROS, as `map_server` describes them: which cells are free, where the map lies, and what is refused.

use nalgebra::Point2;
use terrain::format::{FileFormat, FormatError, ImportOptions, attach_label, image_of_label, read_raster};
use terrain::{Cell, CellState, Occupancy, Terrain, Traversability};

/// Two rows of four cells: black, dark, gray (205, as `map_saver` writes unknown cells), white; and all white.
const IMAGE: &[u8] = b"P5 4 2 255\n\x00\x40\xcd\xfe\xff\xff\xff\xff";

const YAML: &str = "image: site.pgm\nresolution: 0.050000\norigin: [-51.2, -12.5, 0.000000]\nnegate: 0\n\
    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn raster(yaml: &str, image: &[u8]) -> Result<terrain::format::Raster, FormatError> {
    read_raster(&attach_label(yaml.as_bytes(), image)?, &ImportOptions::default())
}

/// The first row of the image: `#` is an obstacle, `?` unknown and `.` free.
fn first_row(yaml: &str, image: &[u8]) -> String {
    let raster = raster(yaml, image).expect("it is a map");
    let sign = |sample: &f32| match sample {
        sample if sample.is_nan() => '?',
        0.0 => '.',
        _ => '#',
    };
    raster.samples[..raster.width as usize].iter().map(sign).collect()
}

#[test]
fn cells_are_free_occupied_or_unknown_by_the_thresholds() {
    // 0x40 is 0.749 occupied, and 0xcd is 0.196.
    assert_eq!(first_row(YAML, IMAGE), "##?.");
    assert_eq!(first_row(&YAML.replace("0.65", "0.8"), IMAGE), "#??.");
    assert_eq!(first_row(&YAML.replace("0.196", "0.25"), IMAGE), "##..");
    // Negated, white is occupied.
    assert_eq!(first_row(&YAML.replace("negate: 0", "negate: 1"), IMAGE), ".?##");
    assert_eq!(first_row(&YAML.replace("negate: 0", "negate: true"), IMAGE), ".?##");
}

#[test]
fn a_scaled_map_is_free_where_it_surely_is_and_a_raw_one_has_percents() {
    let scaled = format!("{YAML}mode: scale\n");
    assert_eq!(first_row(&scaled.replace("0.65", "0.8"), IMAGE), "###.");
    let raw = format!("{YAML}mode: raw\n");
    let percents = b"P5 4 1 255\n\x00\x32\x64\xff";
    assert_eq!(first_row(&raw, percents), ".?#?");
}

#[test]
fn a_level_at_a_threshold_is_beyond_it() {
    // White is 0 occupied, and black 1.
    for mode in ["trinary", "scale"] {
        let yaml = format!("{YAML}mode: {mode}\n").replace("0.196", "0.0").replace("0.65", "1.0");
        let image = b"P5 4 1 255\n\x00\x40\xfe\xff";
        assert_eq!(first_row(&yaml, image), if mode == "scale" { "###." } else { "#??." }, "{mode}");
    }
}

/// 205 is what programs write for a cell that they know nothing of; any other level between the thresholds may be a mistake.
#[test]
fn levels_that_the_thresholds_do_not_explain_are_counted() {
    let unclear = |yaml: &str, image: &[u8]| raster(yaml, image).expect("it is a map").num_unclear;
    assert_eq!(unclear(YAML, IMAGE), 0);
    assert_eq!(unclear(YAML, b"P5 4 1 255\n\x00\x80\xcd\xfe"), 1);
    assert_eq!(unclear(&YAML.replace("0.65", "0.8"), IMAGE), 1);
    assert_eq!(unclear(&format!("{YAML}mode: scale\n"), b"P5 4 1 255\n\x00\x80\xcd\xfe"), 0);
}

#[test]
fn levels_count_by_the_greatest_of_their_image() {
    let deep = b"P2 3 1 1000 0 500 1000";
    assert_eq!(first_row(YAML, deep), "#?.");
}

#[test]
fn the_map_has_its_own_scale_and_place() {
    let raster = raster(YAML, IMAGE).expect("it is a map");
    assert_eq!((raster.cell_size_m, raster.origin_m), (Some(0.05), Some([-51.2, -12.5])));
    let frame = *raster.into_terrain().frame();
    assert_eq!((frame.cell_size_m, frame.origin_m), (0.05, Point2::new(-51.2, -12.5)));
    let list =
        YAML.replace("origin: [-51.2, -12.5, 0.000000]", "origin:\n  - -51.2\n  - -12.5  # meters\n  - 0.0");
    assert_eq!(self::raster(&list, IMAGE).expect("a list in lines").origin_m, Some([-51.2, -12.5]));
}

fn states(terrain: &Terrain, traversability: &Traversability) -> Vec<CellState> {
    Occupancy::of_terrain(terrain, &[], traversability).states().to_vec()
}

#[test]
fn obstacles_and_unknown_cells_are_in_the_way_whatever_the_scale_and_the_cells_beside_them_are_not() {
    use CellState::{Free, NoData, Obstacle};
    let ground = Traversability::Ground { max_grade: 0.2, rock_diameter_m: 0.3 };
    for resolution in ["0.05", "50.0"] {
        let yaml = YAML.replace("0.050000", resolution);
        let terrain = raster(&yaml, IMAGE).expect("it is a map").into_terrain();
        let north = [Obstacle, Obstacle, NoData, Free];
        assert_eq!(states(&terrain, &ground), [[Free; 4], north].concat(), "{resolution} m");
        assert!(terrain.is_obstacle(Cell { column: 1, row: 1 }));
    }
    // What flies passes over obstacles, and not over what is unknown.
    let terrain = raster(YAML, IMAGE).expect("it is a map").into_terrain();
    let air = states(&terrain, &Traversability::Air { max_ground_m: 20.0 });
    assert_eq!(air[4..], [Free, Free, NoData, Free]);
}

#[test]
fn obstacles_of_other_maps_are_obstacles_too() {
    let map = b"type octile\nheight 1\nwidth 4\nmap\n.@T.\n";
    let terrain = read_raster(map, &ImportOptions::default()).expect("it is a map").into_terrain();
    let ground = Traversability::Ground { max_grade: 0.2, rock_diameter_m: 0.3 };
    let (free, obstacle) = (CellState::Free, CellState::Obstacle);
    assert_eq!(states(&terrain.placed(30.0, Point2::origin()), &ground), [free, obstacle, obstacle, free]);
}

#[test]
fn a_description_names_its_image() {
    assert_eq!(FileFormat::detect(YAML.as_bytes()), Some(FileFormat::RosMap));
    assert_eq!(image_of_label(YAML.as_bytes()).as_deref(), Some("site.pgm"));
    let quoted = format!("\u{feff}---\n# saved\nimage: \"my site#1.pgm\" # here\n{}", &YAML[16..]);
    assert_eq!(image_of_label(quoted.as_bytes()).as_deref(), Some("my site#1.pgm"));
    assert!(raster(&quoted, IMAGE).is_ok());
    // With its image it is whole, and other YAML is none.
    assert_eq!(image_of_label(&attach_label(YAML.as_bytes(), IMAGE).unwrap()), None);
    assert_eq!(FileFormat::detect(b"image: a.png\nname: a ship\n"), None);
}

#[test]
fn what_is_not_read_is_refused_with_its_reason() {
    let refusals = [
        (YAML.replace("0.000000]", "1.5708]"), "rotated by 1.5708 rad"),
        (YAML.replace("0.050000", "-1"), "`resolution` must be a number of meters greater than 0"),
        (YAML.replace("0.65", "0.1"), "`free_thresh` 0.196 is above `occupied_thresh` 0.1"),
        (YAML.replace("0.65", "65"), "not within 0 to 1"),
        (YAML.replace("negate: 0", "negate: maybe"), "`negate` is maybe"),
        (YAML.replace("origin", "orogin"), "it needs `origin`"),
        (YAML.replace("-12.5, ", ""), "not [x, y, yaw]"),
        (format!("{YAML}mode: best"), "`mode` is best"),
    ];
    for (yaml, reason) in refusals {
        let error = raster(&yaml, IMAGE).expect_err(&yaml).to_string();
        assert!(error.contains("ROS map") && error.contains(reason), "{error}");
    }
    let alone = read_raster(YAML.as_bytes(), &ImportOptions::default()).expect_err("no image").to_string();
    assert!(alone.contains("its image site.pgm is also needed"), "{alone}");
    let heights = raster(YAML, b"ncols 1\nnrows 1\ncellsize 1\n5\n").expect_err("no gray levels").to_string();
    assert!(heights.contains("needs gray levels"), "{heights}");
}
