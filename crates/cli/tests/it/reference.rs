//! The documents that show the command: the reference, which is what `--help` says, and the answers that guides quote.

use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{enroute, enroute_in, folder};

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

fn help(arguments: &[&str]) -> String {
    let output = enroute(&[arguments, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The names of the commands that a help text lists.
fn commands(help: &str) -> Vec<String> {
    let Some((_, listed)) = help.split_once("Commands:\n") else { return Vec::new() };
    let listed = listed.split("\n\n").next().unwrap_or_default().lines();
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

/// A section of the reference, and those of the commands below it.
fn section(path: &[&str], text: &mut String) {
    let help = help(path);
    let marks = "#".repeat(path.len() + 1);
    // The hint at the short form is the same for every command.
    let help = help.replace(" (see a summary with '-h')", "");
    text.push_str(&format!("\n{marks} enroute {}\n\n```text\n{}\n```\n", path.join(" "), help.trim_end()));
    for command in commands(&help) {
        section(&[path, &[command.as_str()]].concat(), text);
    }
}

/// `UPDATE_SNAPSHOTS=1` writes the reference again.
#[test]
fn the_command_line_reference_is_what_the_help_says() {
    let mut text = "# Command line reference\n\n\
        `enroute` does on the command line what the page does, except drawing. This page lists the help text of each command; \
        a test compares it\nwith the program. Exit statuses and JSON documents are in \
        [Contracts](contracts.md#42-command-line), and `enroute schema` prints the JSON Schema.\n"
        .to_owned();
    for command in commands(&help(&[])) {
        section(&[command.as_str()], &mut text);
    }
    let path = docs().join("command-line.md");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &text).expect("the reference can be written");
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == text,
        "docs/command-line.md is not what the program says: run this test with UPDATE_SNAPSHOTS=1"
    );
    for command in commands(&help(&[])) {
        assert!(text.contains(&format!("\n## enroute {command}\n")), "{command}");
    }
}

/// The blocks of code of a document, with the word behind their fence.
fn blocks(document: &str) -> Vec<(String, String)> {
    let text = fs::read_to_string(docs().join(document)).expect("a document");
    let mut found = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(_), Some(block)) => found.push(block),
            (Some(kind), None) => open = Some((kind.to_owned(), String::new())),
            (None, Some((kind, text))) => open = Some((kind, format!("{text}{line}\n"))),
            (None, None) => {}
        }
    }
    found
}

/// Holds the answers that a guide shows against those of the program. Each call names the block of the mission, counted
/// from 0 in the guide, what is replaced in it, and the arguments. Every line of every plain block must be in an answer.
fn hold(document: &str, calls: &[(usize, (&str, &str), &[&str])]) {
    let blocks = blocks(document);
    let folder = folder(&document.replace(['/', '.'], "-"));
    let mut answers = String::new();
    for (mission, (from, to), arguments) in calls {
        let text = &blocks[*mission].1;
        assert!(text.contains(from), "{document}: {from:?} is not in {text}");
        fs::write(folder.join("mission.rmpl"), text.replacen(from, to, 1)).expect("a mission");
        let output = enroute_in(&folder, arguments);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{document}: {output:?}");
        for stream in [&output.stdout, &output.stderr] {
            answers.push_str(&String::from_utf8_lossy(stream));
        }
    }
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let answers: Vec<String> = answers.lines().map(words).collect();
    let quoted = blocks.iter().filter(|(kind, _)| kind.is_empty()).flat_map(|(_, text)| text.lines());
    let mut count = 0;
    for line in quoted.filter(|line| !line.trim().is_empty()) {
        count += 1;
        let line = words(line);
        assert!(answers.iter().any(|answer| answer.contains(&line)), "{document}: {line:?} in\n{answers:#?}");
    }
    assert!(count > 0, "{document} quotes nothing");
}

#[test]
fn guides_quote_what_the_program_answers() {
    let observed = folder("observed").join("observed.json");
    let events = r#"{"executed": {"scenario#1.start": 0, "delay#1.start": 0, "delay#2.start": 0,
        "Drive#1.start": 20, "delay#1.end": 20}, "now": 25}"#;
    fs::write(&observed, events).expect("a file");
    let observed = observed.to_str().expect("UTF-8");
    let plan: &[&str] = &["plan", "mission.rmpl"];
    hold(
        "flexible-times.md",
        &[(0, ("", ""), plan), (0, ("", ""), &["execute", "mission.rmpl", "--observe", observed])],
    );
    hold("fix-no-plan.md", &[(0, ("", ""), plan)]);
    hold(
        "resources-and-objectives.md",
        &[(0, ("", ""), plan), (0, (" delay; Charge();", ""), plan), (3, ("", ""), plan)],
    );
    hold("first-control-program.md", &[(0, ("", ""), &["run", "mission.rmpl"])]);
    let (fails, edit) = ("`[0,50]` to `[0,20]`", ("[0,50]", "[0,20]"));
    assert!(fs::read_to_string(docs().join("../README.md")).expect("the README").contains(fails));
    hold("../README.md", &[(0, ("", ""), plan), (0, edit, plan)]);
}

/// What the first tutorial lets its reader do, and what it says that follows.
#[test]
fn the_first_tutorial_breaks_the_plan_as_it_says() {
    let tutorial = fs::read_to_string(docs().join("tutorial.md")).expect("the tutorial");
    let mut text = fs::read_to_string(docs().join("../assets/missions/both-paths.rmpl")).expect("a mission");
    let folder = folder("tutorial");
    for (from, to, said) in [
        ("PATH1=OK [450,450]", "PATH1=OK [404,404]", "D1 = 1"),
        (
            "PATH2=OK [500,500]",
            "PATH2=OK [404,404]",
            "Group-Traverse-Path(PATH1_1, …, TAI_POS) needs at least 405, but PATH1=OK holds for only 404",
        ),
    ] {
        assert!(tutorial.contains(&format!("`{from}` to `{to}`")) && text.contains(from), "{from}");
        text = text.replace(from, to);
        fs::write(folder.join("both.rmpl"), &text).expect("a mission");
        let answer = enroute_in(&folder, &["plan", "both.rmpl"]);
        assert!(String::from_utf8_lossy(&answer.stdout).contains(said), "{answer:?}");
    }
    let answer = enroute_in(&folder, &["plan", "both.rmpl"]);
    let fix = "raise the maximum of PATH1=OK from 404 to 405";
    assert!(tutorial.contains(fix) && String::from_utf8_lossy(&answer.stdout).contains(fix), "{answer:?}");
}

#[test]
fn the_manual_of_control_programs_quotes_runs_as_they_are() {
    let mut answers = String::new();
    let program = "assets/programs/orbit-insertion.rmpl";
    for arguments in [
        &["--inject", "3:EngineA=Failed"][..],
        &["--monte-carlo", "2000", "--fault-seed", "1", "--inject", "3:EngineA=Failed"],
    ] {
        let output = enroute(&[&["run", program], arguments].concat());
        answers.push_str(&String::from_utf8_lossy(&output.stdout));
    }
    let blocks = blocks("control-programs.md");
    let quotes = |what: &str| {
        let block = blocks.iter().find(|(kind, text)| kind == "text" && text.contains(what));
        block.unwrap_or_else(|| panic!("no block has {what:?}")).1.clone()
    };
    for block in [quotes("The program ended after 6 steps."), quotes("1921 of 2000 runs")] {
        for line in block.lines().filter(|line| line.trim() != "…") {
            assert!(answers.contains(line), "{line:?} in\n{answers}");
        }
    }
}

#[test]
fn the_lamp_of_the_tutorial_waits_forever_until_its_fault_is_handled() {
    let blocks = blocks("first-control-program.md");
    let folder = folder("lamp");
    let (first, better) = (&blocks[0].1, &blocks[2].1);
    let plant = &first[first.find("(DEFCLASS").expect("a plant")..];
    for (text, status) in [(first.clone(), Some(3)), (format!("{better}\n{plant}"), Some(0))] {
        fs::write(folder.join("lamp.rmpl"), &text).expect("a program");
        let broken = enroute_in(&folder, &["run", "lamp.rmpl", "--inject", "3:Lamp=Broken"]);
        assert_eq!(broken.status.code(), status, "{broken:?}");
        let checked = enroute_in(&folder, &["check", "lamp.rmpl"]);
        let warned = String::from_utf8_lossy(&checked.stderr).into_owned();
        let says = "after Lamp=Broken the program waits forever";
        assert_eq!(warned.contains(says), status == Some(3), "{warned}");
    }
}

#[test]
fn the_best_plan_of_the_guide_is_the_more_rewarding_one() {
    let blocks = blocks("resources-and-objectives.md");
    let folder = folder("goals");
    let text = blocks[3].1.replace("[0,40] = {", "[0,36] = {");
    assert_ne!(text, blocks[3].1);
    fs::write(folder.join("goals.rmpl"), text).expect("a mission");
    let plan = enroute_in(&folder, &["plan", "goals.rmpl"]);
    assert!(String::from_utf8_lossy(&plan.stdout).contains("reward 8"), "{plan:?}");
}
