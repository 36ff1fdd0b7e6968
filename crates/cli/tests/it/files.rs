//! Missions of several files on the command line.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// A folder with these files, for one test.
fn folder(test: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("files").join(test);
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("it is in a folder")).expect("the folder can be made");
        std::fs::write(path, text).expect("the file can be written");
    }
    folder
}

fn run(arguments: &[&str]) -> (i32, Value) {
    let output = Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("it runs");
    let told = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output.status.code().unwrap_or(-1), told)
}

#[test]
fn a_mission_finds_the_files_beside_it() {
    let folder = folder(
        "beside",
        &[
            ("day.rmpl", "import \"lib/acts.rmpl\";\nscenario Day[0,SHIFT] = { Drive() }\n"),
            ("lib/acts.rmpl", "import \"../numbers.rmpl\";\nprimitive Drive()[20,30];\n"),
            ("numbers.rmpl", "const SHIFT = 1h;\n"),
        ],
    );
    let day = folder.join("day.rmpl");
    let day = day.to_str().expect("a plain path");
    let (status, planned) = run(&["plan", day, "--format", "json"]);
    assert_eq!(status, 0, "{planned}");
    assert_eq!(planned["plans"][0]["windows"]["Drive#1.end"].to_string(), "[20,30]");
    for command in ["check", "simulate", "report"] {
        let (status, told) = run(&[command, day, "--format", "json"]);
        assert_eq!(status, 0, "{command}: {told}");
    }
}

#[test]
fn diagnostics_say_which_file_they_are_about() {
    let folder = folder(
        "wrong",
        &[
            ("day.rmpl", "import \"acts.rmpl\";\nscenario Day[0,60] = { Drive() }\n"),
            ("acts.rmpl", "// acts\nprimitive Drive()[30,20];\n"),
        ],
    );
    let (status, told) =
        run(&["check", folder.join("day.rmpl").to_str().expect("a plain path"), "--format", "json"]);
    let found = &told["diagnostics"][0];
    assert_eq!(
        (status, found["code"].as_str(), found["file"].as_str()),
        (2, Some("E-BOUNDS"), Some("acts.rmpl"))
    );
    let span = &found["span"];
    assert_eq!(
        [&span["start"], &span["line"], &span["column"]].map(Value::as_u64),
        [Some(25), Some(2), Some(18)]
    );
}

#[test]
fn nothing_outside_of_the_folder_is_read() {
    let outer = folder("outside", &[("acts.rmpl", "primitive Drive()[20,30];\n")]);
    let absolute = outer.join("acts.rmpl");
    for file in ["../acts.rmpl", absolute.to_str().expect("a plain path")] {
        let text = format!("import \"{file}\";\nscenario Day[0,60] = {{ Drive() }}\n");
        let inner = folder("outside/inner", &[("day.rmpl", &text)]);
        let day = inner.join("day.rmpl");
        let (status, told) = run(&["check", day.to_str().expect("a plain path"), "--format", "json"]);
        assert_eq!((status, told["diagnostics"][0]["code"].as_str()), (2, Some("E-UNDEF")), "{told}");
    }
}
