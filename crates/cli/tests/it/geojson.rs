//! Places and obstacles in `GeoJSON`, read and written.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command runs")
}

fn written(name: &str, file: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("geojson");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    std::fs::write(&path, file).expect("written");
    path
}

fn text(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// A wall with a gate in it, north of Jezero's landing site, and a place on either side.
fn site() -> Value {
    let (lon, lat) = (77.4508, 18.4447);
    let at = |east: f64, north: f64| json!([lon + east, lat + north]);
    let feature = |name: &str, kind: &str, coordinates: Value| json!({ "type": "Feature", "properties": { "name": name }, "geometry": { "type": kind, "coordinates": coordinates } });
    let wall = |from: f64, to: f64| {
        json!([[at(from, 0.0010), at(to, 0.0010), at(to, 0.0012), at(from, 0.0012), at(from, 0.0010)]])
    };
    json!({ "type": "FeatureCollection", "features": [
        feature("Base", "Point", at(0.0, 0.0)),
        feature("Target", "Point", at(0.0, 0.0025)),
        feature("Wall", "MultiPolygon", json!([wall(-0.0015, 0.0006), wall(0.0010, 0.0020)])),
    ]})
}

#[test]
fn places_and_obstacles_are_planned_with_and_written_again_with_the_paths() {
    let file = written("site.geojson", &site().to_string());
    let file = file.to_str().expect("a path");
    let mars = ["--origin", "77.4508,18.4447", "--radius", "3396190"];
    let lines = text(&enroute(&[&["import", file][..], &mars[..]].concat()));
    assert!(lines.contains("location Base (0, 0);") && lines.contains("obstacle Wall_2 polygon"), "{lines}");
    written("site.rmpl", &lines);
    let mission = written(
        "drive.rmpl",
        "import \"site.rmpl\";\nvehicle R : ATRV at Base;\nprimitive Go(to) moves R;\n\
        scenario S[0,60] = { Go(Target)[0,60] }\n",
    );
    let mission = mission.to_str().expect("a path");
    let out = text(&enroute(&[&["export", mission, "--as", "geojson"][..], &mars[..]].concat()));
    let out: Value = serde_json::from_str(&out).expect("it is JSON");
    let features = out["features"].as_array().expect("features");
    let of_kind =
        |kind: &str| features.iter().filter(|it| it["properties"]["kind"] == kind).collect::<Vec<_>>();
    assert_eq!((of_kind("location").len(), of_kind("obstacle").len()), (2, 2));
    let target = &of_kind("location")[1]["geometry"]["coordinates"];
    assert!((target[1].as_f64().expect("a latitude") - 18.4472).abs() < 1e-7, "{target}");
    let path = of_kind("path")[0];
    assert_eq!(path["properties"]["vehicles"], json!(["R"]));
    // Through the gate: some place of it lies between the walls.
    let line = path["geometry"]["coordinates"][0].as_array().expect("a line");
    let east = |position: &Value| position[0].as_f64().expect("a longitude") - 77.4508;
    assert!(line.iter().any(|position| (0.0006..0.0010).contains(&east(position))), "{line:?}");

    // What is written is read again, to the same places.
    let again = written("again.geojson", &out.to_string());
    let again = text(&enroute(&["import", again.to_str().expect("a path")]));
    let declarations = |lines: &str| {
        lines.lines().filter(|it| it.starts_with("location")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(declarations(&again), declarations(&lines));
    assert!(again.contains("// Not read: a line."), "{again}");
}

#[test]
fn an_origin_is_asked_for_and_only_of_geojson() {
    let mission = written("flat.rmpl", "primitive A();\nscenario S[0,9] = { A()[1,2] }\n");
    let mission = mission.to_str().expect("a path");
    let refused = enroute(&["export", mission, "--as", "geojson"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--origin"), "{refused:?}");
    let network = enroute(&["tpn", mission, "--format", "json"]);
    let network = written("flat.tpn.json", &text(&network));
    let wrong = enroute(&["import", network.to_str().expect("a path"), "--meters"]);
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("is not GeoJSON or CSV"), "{wrong:?}");
}

#[test]
fn places_vehicles_and_groups_come_from_a_table_or_from_properties() {
    let table = written(
        "fleet.csv",
        "name,east,north,model,group\nRIDGE,30,0,,Sites\nBASIN,0,40,,Sites\nR1,1,2,ATRV-Jr,Scouts\nR2,3,2,ATRV-Jr,Scouts\n",
    );
    let lines = text(&enroute(&["import", table.to_str().expect("a path")]));
    let own: Vec<&str> = lines.lines().filter(|line| !line.starts_with("//")).collect();
    assert_eq!(
        own,
        [
            "location RIDGE (30, 0);",
            "location BASIN (0, 40);",
            "location R1_START (1, 2);",
            "location R2_START (3, 2);",
            "vehicle R1 : ATRV-Jr at R1_START;",
            "vehicle R2 : ATRV-Jr at R2_START;",
            "group Sites = RIDGE, BASIN;",
            "group Scouts = R1, R2;",
        ]
    );
    written("fleet.rmpl", &lines);
    let mission = written(
        "survey.rmpl",
        "import \"fleet.rmpl\";\nprimitive Go(r, to)[1,60] moves r;\n\
         scenario S[0,99] = { each site in Sites { any r in Scouts Go(r, site) } }\n",
    );
    let planned = text(&enroute(&["plan", mission.to_str().expect("a path"), "--no-paths"]));
    assert!(planned.contains("Go(R1, RIDGE)"), "{planned}");
    let refused = |file: &str, table: &str, problem: &str| {
        let output = enroute(&["import", written(file, table).to_str().expect("a path")]);
        assert!(String::from_utf8_lossy(&output.stderr).contains(problem), "{output:?}");
    };
    refused("one.csv", "name,east\nA,1\n", "needs the columns `east` and `north`, or `lon` and `lat`");
    refused("two.csv", "name,east,north,color\nA,1,2,red\n", "unknown column `color`");
    refused("three.csv", "name,east,north\nA,1,here\n", "line 2: `here` is not a number");
    refused(
        "four.csv",
        "name,east,north,radius_m,group\nA,1,2,3,Sites\n",
        "an obstacle cannot have a model or a group",
    );
    refused("five.csv", "name,east,north,model\nA,1,2,A B\n", "`A B` is not the name of a model");
}
