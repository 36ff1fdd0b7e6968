//! Traverses from the command line: paths in plans, alternatives that can't be driven, and vehicles under way.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::command::{answer, enroute, file};

const DETOUR: &str = "assets/missions/detour.rmpl";

fn detour() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/missions/detour.rmpl"))
        .expect("the mission is there")
}

#[test]
fn a_plan_lists_the_vertices_and_figures_of_its_paths() {
    let output = enroute(&["plan", DETOUR, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let plan = answer(&output);
    let traverse = &plan["traverses"][0];
    assert_eq!((&traverse["activity"], &traverse["vehicles"]), (&json!("Carry#1"), &json!(["Scout"])));
    assert_eq!(traverse["legs"][0]["path"][0], json!([116.0, 72.0]));
    assert_eq!(traverse["legs"][0]["to"], "GAP");
    assert!(traverse["legs"][1]["length_m"].as_f64().is_some_and(|length| length > 88.0));
    assert!(traverse["legs"][1]["min_clearance_m"].as_f64().is_some_and(|clearance| clearance > 0.0));
}

#[test]
fn an_alternative_that_no_path_fits_is_left_for_another_and_the_reason_told() {
    let tight =
        file("tight.rmpl", &detour().replace("Carry(GAP, LANDER)[10,60]", "Carry(GAP, LANDER)[10,12]"));
    let output = enroute(&["plan", &tight, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let plan = answer(&output);
    assert_eq!(plan["plans"][0]["choices"]["D1"], 1);
    let reason = plan["undrivable"][0]["reason"].as_str().unwrap_or_default();
    assert!(reason.contains("takes at least 14.4, but at most 12.0 is allowed"), "{reason}");
}

#[test]
fn vehicles_drive_in_simulation_and_scripts_get_in_their_way() {
    let script = r#"{"disturbances": [{"kind": "obstacle", "at": 1, "x": 150, "y": 70.4, "radius": 0.8}]}"#;
    let script = file("rock.json", script);
    let output = enroute(&["simulate", DETOUR, "--seed", "1", "--disturb", &script, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let run = answer(&output);
    let drive = &run["drives"][0];
    assert_eq!((&run["status"], &drive["activity"]), (&json!("finished"), &json!("Carry#1")));
    assert!(drive["least_clearance_m"].as_f64().is_some_and(|clearance| clearance >= 0.0));
    let track = drive["vehicles"][0]["track"].as_array().expect("a track");
    let last = track.last().expect("it drives");
    assert!((last[1].as_f64().unwrap_or(0.0) - 288.0).abs() <= 0.2, "{last}");
    let nobody = r#"{"disturbances": [{"kind": "vehicle-slow", "vehicle": "Nobody", "factor": 0, "from": 1, "until": 2}]}"#;
    let nobody = file("nobody.json", nobody);
    let refused = enroute(&["simulate", DETOUR, "--disturb", &nobody]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("Nobody"));
}

#[test]
fn a_mission_drives_over_a_map_file_that_lies_beside_it() {
    // A valley between two ridges: 40 × 40 cells of 5 m, heights in whole meters.
    let rows = (0..40).flat_map(|row: i32| std::iter::repeat_n((row - 20).unsigned_abs() as u8, 40));
    let mut map = b"P5 40 40 255\n".to_vec();
    map.extend(rows);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("valley.pgm"), map).expect("the folder can be written to");
    let text = "terrain \"valley.pgm\" cell 5;\nlocation A (20, 100);\nlocation B (180, 100);\n\
        vehicle R : ATRV at A;\nprimitive Go(to) moves R;\nscenario S[0,60] = { Go(B)[0,60] }\n";
    let mission = file("valley.rmpl", text);
    let output = enroute(&["plan", &mission, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let length = answer(&output)["traverses"][0]["legs"][0]["length_m"].as_f64();
    assert!(length.is_some_and(|length| (length - 160.0).abs() < 1.0), "{length:?}");
    let output = enroute(&["simulate", &mission, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(answer(&output)["drives"][0]["vehicles"][0]["vehicle"], "R");
    let missing = file("nowhere.rmpl", &text.replace("valley.pgm", "nowhere.pgm"));
    let output = enroute(&["plan", &missing]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("unknown terrain \"nowhere.pgm\""));
    std::fs::write(folder.join("broken.pgm"), b"P5 40 40 255\n..").expect("the folder can be written to");
    let broken = file("broken.rmpl", &text.replace("valley.pgm", "broken.pgm"));
    let output = enroute(&["simulate", &broken]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("couldn't use the terrain \"broken.pgm\""));
}

/// A rover with a choice of places on flat ground.
const PLACES: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location BASE (10, 10); location A (30, 12); location B (50, 40); location C (15, 45);
    obstacle ROCK circle (30, 25, 8);
    vehicle R1 : ATRV-Jr at BASE;
    primitive Drive(to) moves R1 speed (0.02, 0.5);
    ";

#[test]
fn every_plan_that_is_listed_is_accepted_by_the_checker_with_its_own_paths() {
    let mission = file(
        "places.rmpl",
        &format!("{PLACES} scenario S[0,60] = {{ choose {{ Drive(A), Drive(B) }}; Drive(C) }}"),
    );
    let output = enroute(&["plan", &mission, "--all", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let mut document = answer(&output);
    assert_eq!(document["plans"].as_array().map(Vec::len), Some(2));
    assert_eq!(document["left_out"], json!([]));
    let plans = file("places.json", &document.to_string());
    let output = enroute(&["verify", &mission, &plans]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    // The second plan takes longer than the first one: with other times it is none.
    document["plans"][1]["windows"] = document["plans"][0]["windows"].clone();
    let plans = file("other-places.json", &document.to_string());
    let output = enroute(&["verify", &mission, &plans]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
}

#[test]
fn a_disturbed_level_is_in_the_log_and_one_out_of_range_is_refused() {
    let text = format!(
        "{PLACES} resource Battery 0..100 = 50; primitive Nap()[5,5] consumes Battery 1;
        scenario S[0,60] = {{ Drive(A); Nap() }}"
    );
    let mission = file("battery.rmpl", &text);
    let disturbed = |level: &str| {
        let script = format!(
            "{{\"disturbances\": [{{\"kind\": \"level\", \"resource\": \"Battery\", \"level\": {level}, \"at\": 0.1}}]}}"
        );
        enroute(&["simulate", &mission, "--disturb", &file("level.json", &script), "--format", "json"])
    };
    let output = disturbed("20");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let run = answer(&output);
    let log = run["log"].as_array().expect("a log");
    assert!(
        log.contains(
            &json!({ "time": 0.1, "event": "level", "resource": "Battery", "level": 20, "by": null })
        )
    );
    let places: Vec<&Value> =
        log.iter().filter(|entry| entry["variable"] == "R1.at").map(|entry| &entry["value"]).collect();
    assert_eq!(places, [&Value::Null, &json!("A")]);
    let refused = disturbed("101");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stdout).contains("the level of Battery must be from 0 to 100"));
}

#[test]
fn a_map_of_ros_is_read_with_its_image_from_the_folder_of_the_mission() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("ros");
    std::fs::create_dir_all(folder.join("maps")).expect("the folder can be made");
    // A wall from the north with a gap in the south; unknown beyond the east.
    let level = |at: usize| match (at % 60, at / 60) {
        (28..32, 0..50) => 0,
        (56.., _) => 205,
        _ => 254,
    };
    let image: Vec<u8> = (0..60 * 60).map(level).collect();
    std::fs::write(folder.join("maps/yard.pgm"), [b"P5 60 60 255\n", image.as_slice()].concat())
        .expect("written");
    let yaml = "image: yard.pgm\nresolution: 0.5\norigin: [-10.0, -10.0, 0.0]\nnegate: 0\n\
        occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    std::fs::write(folder.join("maps/yard.yaml"), yaml).expect("written");
    let mission = folder.join("yard.rmpl");
    let mission = mission.to_str().expect("a name");
    let plan = |to: &str| {
        let text = format!(
            "terrain \"maps/yard.yaml\";\nlocation A (-7, 16);\nlocation B ({to});\nvehicle R : ATRV at A;\n\
             primitive Go(to) moves R;\nscenario S[0,200] = {{ Go(B)[0,200] }}\n"
        );
        std::fs::write(mission, text).expect("written");
        enroute(&["plan", mission, "--format", "json"])
    };
    let around = plan("14, 16");
    assert_eq!(around.status.code(), Some(0), "{around:?}");
    let length = answer(&around)["traverses"][0]["legs"][0]["length_m"].as_f64().expect("a length");
    // Straight it is 21 m; the gap is south of -5.
    assert!((45.0..65.0).contains(&length), "{length}");
    for (place, reason) in [("5, 16", "in an obstacle"), ("19, 16", "where the map has no data")] {
        let refused = plan(place);
        let said = [refused.stdout, refused.stderr].concat();
        let said = String::from_utf8_lossy(&said);
        assert!(refused.status.code() == Some(1) && said.contains(reason), "{said}");
    }
    let path = folder.join("maps/yard.yaml");
    let path = enroute(&[
        "path",
        path.to_str().expect("a name"),
        "--from",
        "6,8",
        "--to",
        "48,8",
        "--format",
        "json",
    ]);
    assert_eq!(path.status.code(), Some(0), "{path:?}");

    // A gray value that is neither free nor occupied may be a mistake; 205 is not.
    assert!(!answer(&around)["diagnostics"].to_string().contains("W-MAP"), "{around:?}");
    let gray: Vec<u8> = image.iter().map(|&level| if level == 205 { 128 } else { level }).collect();
    std::fs::write(folder.join("maps/yard.pgm"), [b"P5 60 60 255\n", gray.as_slice()].concat())
        .expect("written");
    let told = answer(&plan("14, 16"))["diagnostics"].to_string();
    assert!(told.contains("W-MAP") && told.contains("240 of 3600 cells"), "{told}");

    // An image that is elsewhere is not an image of the mission.
    std::fs::write(folder.join("maps/yard.yaml"), yaml.replace("yard.pgm", "../../../etc/passwd"))
        .expect("written");
    let outside = plan("14, 16");
    assert_eq!(outside.status.code(), Some(2), "{outside:?}");
    assert!(String::from_utf8_lossy(&outside.stdout).contains("is not in the folder"), "{outside:?}");
}

#[test]
fn a_raw_image_is_read_with_the_label_that_lies_beside_it() {
    let heights: Vec<u8> = (0..40_i16 * 40).flat_map(|at| ((at / 40 - 20).abs() * 2).to_be_bytes()).collect();
    let label = "PDS_VERSION_ID = PDS3\r\n^IMAGE = \"RAVINE.IMG\"\r\nLINES = 40\r\nLINE_SAMPLES = 40\r\n\
        SAMPLE_TYPE = MSB_INTEGER\r\nSAMPLE_BITS = 16\r\nSCALING_FACTOR = 0.5\r\nMAP_SCALE = 5 <M/PIXEL>\r\nEND\r\n";
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("ravine.img"), heights).expect("the folder can be written to");
    let text = "terrain \"ravine.img\";\nlocation A (20, 100);\nlocation B (180, 100);\n\
        vehicle R : ATRV at A;\nprimitive Go(to) moves R;\nscenario S[0,60] = { Go(B)[0,60] }\n";
    let mission = file("ravine.rmpl", text);
    let beside = folder.join("ravine.lbl");
    std::fs::write(&beside, label.replace("RAVINE", "OTHER")).expect("the folder can be written to");
    let refused = enroute(&["plan", &mission]);
    assert_eq!(refused.status.code(), Some(2), "the label is of another image: {refused:?}");
    std::fs::write(&beside, label).expect("the folder can be written to");
    let output = enroute(&["plan", &mission, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let length = answer(&output)["traverses"][0]["legs"][0]["length_m"].as_f64();
    assert!(length.is_some_and(|length| (length - 160.0).abs() < 1.0), "{length:?}");
}
