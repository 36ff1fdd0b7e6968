//! `--time-limit` with a mission that is too hard for it: every command that plans ends, and says what is not decided.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How long a command may take that has to end after half a second, on a machine that does much else.
const FOREVER: Duration = Duration::from_mins(2);

/// The exit status of what was not decided.
const LIMIT: i32 = 3;

/// All that comes from `from`, read beside what else is done.
fn reader(mut from: impl Read + Send + 'static) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = String::new();
        from.read_to_string(&mut text).expect("UTF-8");
        text
    })
}

/// Runs the command with a limit of half a second: its exit status and all that it printed.
fn limited(arguments: &[&str]) -> (ExitStatus, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_enroute"))
        .args(arguments)
        .args(["--time-limit", "0.5"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    let printed = [reader(child.stdout.take().expect("piped")), reader(child.stderr.take().expect("piped"))];
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("a status") {
            break status;
        }
        if begun.elapsed() > FOREVER {
            child.kill().expect("killed");
            panic!("{arguments:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    (status, printed.map(|reader| reader.join().expect("read")).concat())
}

fn written(name: &str, text: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("time-limit");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path: PathBuf = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("UTF-8").to_owned()
}

#[test]
fn what_is_too_hard_for_the_time_limit_is_said_to_be_undecided() {
    // Fifty choices between twenty alternatives that are alike, of which one does not fit: far from decided in seconds. The
    // traverse has no ground, so that every command plans, `check` and `verify` too.
    let hard = tpn::families::symmetric(50, 20, 1);
    let branches = hard.split_once("= {\n").expect("a scenario").1;
    let text = format!(
        "option threat_gap = 0;\nlocation A (2, 2);\nlocation B (18, 18);\nvehicle R : ATRV at A;\n\
         primitive Go(to)[1,200] moves R;\nscenario Hard[0,249] = {{\n  {{ Go(B); delay[0,inf] }},\n{branches}"
    );
    let mission = &written("hard.rmpl", &text);
    let easy = &written("easy.rmpl", "scenario Easy[0,10] = { delay[0,5] }\n");
    let observed = &written("observed.json", "{}");
    let plan = &written("plan.json", r#"{ "choices": {}, "windows": {} }"#);
    let record = &written("record.json", &review::record::Record::new("hard").to_json());
    let page = &written("report.html", "as it was");
    for arguments in [
        &["check", mission][..],
        &["plan", mission],
        &["plan", mission, "--no-paths"],
        &["plan", mission, "--all"],
        &["plan", mission, "--best", "3"],
        &["plan", mission, "--search", "chronological"],
        &["plan", mission, "--search", "best-first"],
        &["verify", mission, plan],
        &["execute", mission, "--observe", observed],
        &["simulate", mission],
        &["robustness", mission, "--runs", "3"],
        &["report", mission, "-o", page],
        &["export", mission, "--as", "csv"],
        &["compare", easy, mission],
        &["compare", mission, easy],
        &["review", "verify", record, "--mission", mission],
    ] {
        let (status, printed) = limited(arguments);
        assert_eq!(status.code(), Some(LIMIT), "{arguments:?}: {printed}");
        assert!(printed.contains("time limit reached: undecided"), "{arguments:?}: {printed}");
    }
    assert_eq!(std::fs::read_to_string(page).expect("the page"), "as it was");
}
