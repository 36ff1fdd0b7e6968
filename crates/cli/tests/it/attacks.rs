//! What once broke the command line: each input is answered, shortly, and without harm.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command runs")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("attacks").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn written(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("UTF-8").to_owned()
}

#[test]
fn a_name_of_tens_of_thousands_of_letters_is_planned_and_shown_in_short() {
    let folder = folder("names");
    for letters in [65_530, 70_000] {
        let name = "a".repeat(letters);
        let text = format!("primitive {name}()[1,2];\nscenario M[0,inf] = {{ {name}(); {name}() }}\n");
        let file = written(&folder, "long.rmpl", &text);
        let plan = enroute(&["plan", &file]);
        assert_eq!(plan.status.code(), Some(0), "{:?}", String::from_utf8_lossy(&plan.stderr));
        assert!(plan.stdout.len() < 2_000, "{} bytes", plan.stdout.len());
        let observed = written(&folder, "observed.json", "{\"executed\":{},\"now\":0}");
        let execute = enroute(&["execute", &file, "--observe", &observed]);
        assert_eq!(execute.status.code(), Some(0), "{:?}", String::from_utf8_lossy(&execute.stderr));
        assert!(execute.stdout.len() < 2_000, "{} bytes", execute.stdout.len());
    }
}

#[test]
fn of_thousands_of_mistakes_some_are_printed_and_all_are_counted() {
    let folder = folder("mistakes");
    let mut text = "scenario M[0,inf] = { ".to_owned();
    for number in 0..10_000 {
        let _ = write!(text, "Q{number}(); ");
    }
    let file = written(&folder, "many.rmpl", &(text + "}"));
    let check = enroute(&["check", &file]);
    let printed = String::from_utf8_lossy(&check.stderr);
    assert_eq!(printed.matches("W-UNDEF").count(), 50);
    assert!(printed.ends_with("and 9950 more warnings\n"), "{}", &printed[printed.len() - 200..]);
    let check = enroute(&["check", &file, "--format", "json"]);
    let document: Value = serde_json::from_slice(&check.stdout).expect("JSON");
    assert_eq!(document["diagnostics"].as_array().map(Vec::len), Some(500));
    assert_eq!(document["diagnostics_not_listed"], json!(9_500));
}

#[test]
fn each_of_many_scenarios_is_compiled() {
    let mut text = "primitive P()[1,2];\n".to_owned();
    for number in 0..3_000 {
        let _ = writeln!(text, "scenario S{number}[0,10] = {{ P() }}");
    }
    text += "scenario Last[0,10] = { P()[0,C] }\nconst C = 1/0;\n";
    let file = written(&folder("scenarios"), "many.rmpl", &text);
    assert_eq!(enroute(&["check", &file]).status.code(), Some(2));
    let file =
        written(&folder("scenarios-sound"), "many.rmpl", text.split("scenario Last").next().unwrap_or(""));
    assert_eq!(enroute(&["check", &file]).status.code(), Some(0));
}

#[test]
fn thousands_of_vehicles_and_locations_are_checked_and_planned_and_a_time_limit_holds() {
    let folder = folder("fleet");
    let mut text = String::new();
    for number in 0..10_000 {
        let (east, north) = (number % 100 * 50, number / 100 * 50);
        let _ =
            writeln!(text, "location L{number} ({east}, {north});\nvehicle V{number} : ATRV at L{number};");
    }
    text += "primitive Go(v : vehicle, to)[1,100000] moves v speed (1, 2);\n";
    let drives = |count: usize| {
        let calls: Vec<String> = (0..count).map(|at| format!("Go(V{at}, L{})", at + 1)).collect();
        format!("{text}scenario S[0,inf] = {{ {} }}\n", calls.join(", "))
    };
    let check = enroute(&["check", &written(&folder, "few.rmpl", &drives(3))]);
    assert_eq!(check.status.code(), Some(0), "{:?}", String::from_utf8_lossy(&check.stderr));
    // Each of them may meet the next one.
    let all = written(&folder, "all.rmpl", &drives(9_999));
    let check = enroute(&["check", &all, "--time-limit", "0.1", "--format", "json"]);
    assert_eq!(check.status.code(), Some(3), "{:?}", String::from_utf8_lossy(&check.stderr));
    let document: Value = serde_json::from_slice(&check.stdout).expect("a document");
    assert_eq!(document["format"], "enroute-check/1");
}

#[test]
fn what_a_file_says_commands_no_terminal() {
    let folder = folder("commands");
    let name = "Dr\u{1b}]0;x\u{7}ive\u{202e}\u{9b}2J";
    let network = json!({
        "network-id": "net",
        "net": { "tpn-type": "network", "begin-node": "n1", "end-node": "n2" },
        "n1": { "tpn-type": "state", "activities": ["a1"] },
        "n2": { "tpn-type": "state", "activities": [] },
        "a1": { "tpn-type": "activity", "name": name, "end-node": "n2", "cost": 1 },
    });
    let file = written(&folder, "evil.tpn.json", &network.to_string());
    let page = written(&folder, "report.html", "");
    for command in [
        &["plan"][..],
        &["plan", "--format", "json"],
        &["tpn"],
        &["import"],
        &["check"],
        &["simulate"],
        &["simulate", "--format", "json"],
        &["robustness", "--runs", "5"],
        &["robustness", "--runs", "5", "--format", "json"],
        &["report", "-o", &page],
    ] {
        let output = enroute(&[command, &[&file]].concat());
        assert_eq!(output.status.code(), Some(0), "{command:?}: {output:?}");
        for text in [&output.stdout, &output.stderr] {
            let text = String::from_utf8(text.clone()).expect("UTF-8");
            let harmful = text.find(['\u{1b}', '\u{7}', '\u{202e}', '\u{9b}']);
            assert_eq!(harmful, None, "{command:?}: {text:?}");
        }
    }
    let plan = enroute(&["plan", "--format", "json", &file]);
    let document: Value = serde_json::from_slice(&plan.stdout).expect("JSON");
    assert!(document["plans"][0]["windows"].get(format!("{name}#1.end")).is_some(), "{document}");
}

#[test]
fn a_map_is_read_from_the_missions_own_folder_only() {
    let folder = folder("maps");
    std::fs::create_dir_all(folder.join("mission/maps")).expect("a folder");
    let map = "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 5\n".to_owned() + &"0 0 0 0\n".repeat(4);
    written(&folder, "secret.asc", &map);
    written(&folder, "mission/maps/own.asc", &map);
    let plan = |terrain: &str| {
        let text = format!(
            "terrain \"{terrain}\" cell 5;\nlocation A (2, 2);\nlocation B (18, 18);\nvehicle R : ATRV at A;\n\
             primitive Go(to)[1,100] moves R;\nscenario M[0,100] = {{ Go(B) }}\n"
        );
        let file = written(&folder, "mission/day.rmpl", &text);
        enroute(&["plan", &file, "--no-paths"]);
        enroute(&["plan", &file])
    };
    let own = plan("maps/own.asc");
    assert_eq!(own.status.code(), Some(0), "{own:?}");
    let root = folder.join("secret.asc");
    for outside in ["../secret.asc", root.to_str().expect("UTF-8"), "maps/../../secret.asc"] {
        let refused = plan(outside);
        assert_eq!(refused.status.code(), Some(2), "{outside}: {refused:?}");
        let told = String::from_utf8_lossy(&refused.stderr);
        assert!(told.contains("into the mission's folder"), "{told}");
    }
}

#[test]
fn a_terrain_that_cannot_be_read_is_told_whatever_the_mission_does() {
    let folder = folder("terrain");
    let vehicle =
        "location A (2, 2);\nlocation B (5, 5);\nvehicle R : ATRV at A;\nprimitive Go(to)[1,9] moves R;\n";
    let moves = format!("{vehicle}scenario M[0,100] = {{ Go(B) }}\n");
    written(&folder, "no-map.png", "no map");
    for (asset, told) in [
        ("/etc/passwd", "unknown terrain \"/etc/passwd\""),
        ("../secret.asc", "unknown terrain \"../secret.asc\""),
        ("no-map.png", "couldn't use the terrain \"no-map.png\""),
    ] {
        for rest in
            ["scenario M[0,10] = { P() }\nprimitive P()[1,2];\n", moves.as_str(), "location A (2, 2);\n"]
        {
            let file = written(&folder, "day.rmpl", &format!("terrain \"{asset}\";\n{rest}"));
            let check = enroute(&["check", &file]);
            let printed = String::from_utf8_lossy(&check.stderr);
            assert_eq!(check.status.code(), Some(2), "{asset}, {rest}: {printed}");
            assert!(printed.contains(told), "{asset}, {rest}: {printed}");
        }
    }
}

#[test]
fn a_report_of_hundreds_of_intervals_that_exclude_each_other_can_be_read() {
    let folder = folder("conflicts");
    let values: Vec<String> = (0..400).map(|value| format!("V{value}")).collect();
    let branches: Vec<String> =
        values.iter().map(|value| format!("{{ delay[0,inf]; tell X={value} [1,1] }}")).collect();
    let text = format!("var X : {{ {} }};\nscenario S = {{ {} }}\n", values.join(", "), branches.join(", "));
    let file = written(&folder, "conflicts.rmpl", &text);
    let report = folder.join("conflicts.html");
    let output = enroute(&["report", &file, "-o", report.to_str().expect("UTF-8")]);
    let page = std::fs::read_to_string(&report).unwrap_or_else(|_| panic!("{output:?}"));
    assert!(page.contains("Threats and orderings") && page.contains("V399"));
    // 79,800 pairs are in order: the drawing has a curve for each step, and the table what one reads.
    assert!(page.len() < 2_500_000, "{}", page.len());
}

#[test]
fn numbers_without_a_sense_are_refused() {
    let folder = folder("numbers");
    let text = "location A (2, 2);\nlocation B (18, 18);\nvehicle R : ATRV at A;\n\
                primitive Go(to)[1,100] moves R speed (-1, 2);\nscenario M[0,100] = { Go(B) }\n";
    let file = written(&folder, "speed.rmpl", text);
    assert_eq!(enroute(&["check", &file]).status.code(), Some(2));
    let map = written(
        &folder,
        "map.pgm",
        "P2\n4 4\n255\n255 255 255 255\n255 255 255 255\n255 255 255 255\n255 255 255 255\n",
    );
    let path =
        |more: &[&str]| enroute(&[&["path", &map, "--from", "0.5,0.5", "--to", "3.5,3.5"], more].concat());
    assert_eq!(path(&["--step", "0.5"]).status.code(), Some(0));
    for wrong in [["--step", "1e-9"], ["--step", "NaN"], ["--goal-bias", "NaN"], ["--radius", "inf"]] {
        assert_eq!(path(&wrong).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn without_timings_the_same_call_gives_the_same_document() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/missions/enroute.rmpl");
    let document = || enroute(&["plan", file, "--format", "json", "--no-timings"]).stdout;
    assert_eq!(document(), document());
    let timed = enroute(&["plan", file, "--format", "json"]).stdout;
    let timed: Value = serde_json::from_slice(&timed).expect("JSON");
    assert!(timed["stats"]["plan_millis"].is_number());
}
