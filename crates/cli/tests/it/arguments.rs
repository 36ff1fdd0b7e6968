//! Arguments and inputs that make no sense, or that once did harm: each is refused with its reason, or answered.

use std::process::Command;

use serde_json::Value;

use crate::command::{answer, enroute, enroute_in, file, folder, said};

const MISSION: &str = "assets/missions/enroute.rmpl";
const PROGRAM: &str = "assets/programs/orbit-insertion.rmpl";

#[test]
fn values_without_a_meaning_are_refused() {
    let map = &file("free.map", "type octile\nheight 2\nwidth 2\nmap\n..\n..\n");
    for arguments in [
        &["plan", MISSION, "--time-limit", "nan"][..],
        &["plan", MISSION, "--time-limit", "0"],
        &["plan", MISSION, "--time-limit", "-1"],
        &["plan", MISSION, "--limit", "0"],
        &["plan", MISSION, "--best", "0"],
        &["robustness", MISSION, "--runs", "0"],
        &["contradict", MISSION, "--budget", "nan"],
        &["run", PROGRAM, "--k", "0"],
        &["run", PROGRAM, "--steps", "0"],
        &["run", PROGRAM, "--monte-carlo", "0"],
        &["path", map, "--from", "0,0", "--to", "1,1", "--samples", "0"],
        &["path", map, "--from", "0,0", "--to", "1,1", "--time-limit", "NaN"],
        &["export", MISSION, "--as", "icalendar", "--epoch", "2016-12-31T23:59:60Z"],
    ] {
        let output = enroute(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        assert!(!said(&output).is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_file_of_the_other_kind_is_called_what_it_is() {
    let estimates = &file("estimates.json", "{}");
    for (arguments, told) in [
        (&["run", MISSION][..], "is a mission; use `enroute simulate`"),
        (&["hca", MISSION], "is a mission; use `enroute tpn`"),
        (&["step", MISSION, "--estimates", estimates], "is a mission; use `enroute simulate`"),
        (&["run", PROGRAM, "--model", MISSION], "is a mission; --model expects a plant model"),
        (&["plan", PROGRAM], "is a control program; use `enroute run`"),
        (&["import", MISSION], "is a mission; use `enroute plan` or `enroute tpn`"),
        (&["import", PROGRAM], "is a control program; use `enroute run`"),
    ] {
        let output = enroute(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        assert!(said(&output).contains(told), "{arguments:?}: {output:?}");
        assert_eq!(said(&output).lines().count(), 1, "{arguments:?}: {output:?}");
    }
}

#[test]
fn what_stays_where_it_is_has_a_path_of_length_0() {
    let grid = &file(
        "hole.asc",
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value null\nnull 9 9\n9 9 0\n",
    );
    let standing = |at: &str, more: &[&str]| {
        enroute(&[&["path", grid, "--from", at, "--to", at, "--format", "json"], more].concat())
    };
    for planner in ["rrt", "rrt-connect", "rrt-star", "kinodynamic"] {
        // In a cell without a height, and in one with a height.
        for at in ["0.5,0.5", "1.5,0.5"] {
            let output = standing(at, &["--planner", planner]);
            assert_eq!(output.status.code(), Some(0), "{planner}, {at}: {output:?}");
            let path = answer(&output);
            assert_eq!((&path["length"], &path["samples"]), (&0.0.into(), &0.into()), "{path}");
            assert_eq!(path["path"].as_array().map(Vec::len), Some(1), "{path}");
        }
        // In an obstacle, and beside the map.
        for at in ["2.5,1.5", "9,9"] {
            assert_eq!(standing(at, &["--planner", planner]).status.code(), Some(1), "{planner}, {at}");
        }
    }
}

#[test]
fn the_image_of_a_ros_map_is_found_from_any_folder() {
    let folder = folder("arguments-ros");
    std::fs::create_dir_all(folder.join("maps")).expect("a folder");
    std::fs::write(folder.join("maps/yard.pgm"), "P2\n4 1\n255\n255 255 255 255\n").expect("written");
    let yaml = "image: yard.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.0\n";
    std::fs::write(folder.join("maps/yard.yaml"), yaml).expect("written");
    let ends = ["--from", "0.5,0.5", "--to", "3.5,0.5", "--no-timings"];
    for (place, map) in [(&*folder, "maps/yard.yaml"), (&folder.join("maps"), "yard.yaml")] {
        let output = enroute_in(place, &[&["path", map], &ends[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{map}: {output:?}");
        // Two calls print the same.
        assert_eq!(output.stdout, enroute_in(place, &[&["path", map], &ends[..]].concat()).stdout);
    }
}

#[test]
fn a_thousand_files_are_imported_and_no_more() {
    let folder = folder("imports");
    let mission = |count: u32| {
        let imports: String = (0..count).map(|number| format!("import \"a{number}.rmpl\";\n")).collect();
        for number in 0..count {
            std::fs::write(folder.join(format!("a{number}.rmpl")), "").expect("written");
        }
        std::fs::write(folder.join("day.rmpl"), imports + "scenario Day[0,9] = { delay }\n")
            .expect("written");
        enroute_in(&folder, &["check", "day.rmpl"])
    };
    let all = mission(1_000);
    assert_eq!(all.status.code(), Some(0), "{all:?}");
    let many = mission(1_001);
    assert_eq!(many.status.code(), Some(2), "{many:?}");
    assert!(said(&many).contains("imports 1001 files; a mission has at most 1000"), "{many:?}");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_not_imported() {
    let folder = folder("pipe");
    let made = Command::new("mkfifo").arg(folder.join("pipe.rmpl")).status().expect("mkfifo runs");
    assert!(made.success());
    let text = "import \"pipe.rmpl\";\nscenario Day[0,9] = { delay }\n";
    std::fs::write(folder.join("day.rmpl"), text).expect("written");
    let output = enroute_in(&folder, &["check", "day.rmpl"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(said(&output).contains("is not a regular file"), "{output:?}");
}

#[test]
fn a_recorded_search_counts_what_an_unrecorded_one_counts() {
    let trace = &file("trace.jsonl", "");
    for options in [&["--all", "--limit", "5"][..], &["--best", "2"], &["--search", "chronological"], &[]] {
        let plan = |more: &[&str]| -> Value {
            let call = ["plan", "assets/missions/sol.rmpl", "--no-paths", "--no-timings", "--format", "json"];
            answer(&enroute(&[&call, options, more].concat()))["stats"].clone()
        };
        assert_eq!(plan(&[]), plan(&["--trace", trace]), "{options:?}");
    }
}
