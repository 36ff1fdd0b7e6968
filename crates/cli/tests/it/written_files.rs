//! Files that commands write: whole or not at all, with their permissions, and never in place of an input.

use std::process::{Command, Stdio};

use crate::command::{enroute_in, folder, said};

const MISSION: &str = "primitive Drive()[20,30];\nscenario Day[0,60] = { Drive() }\n";

#[test]
fn an_input_is_not_written_over_by_whatever_name() {
    let folder = folder("inputs");
    std::fs::write(folder.join("world.rmpl"), "location BASE (0, 0);\n").expect("written");
    let text = format!("import \"world.rmpl\";\n{MISSION}");
    std::fs::write(folder.join("day.rmpl"), &text).expect("written");
    std::fs::hard_link(folder.join("day.rmpl"), folder.join("hard.rmpl")).expect("a link");
    let mut names = vec!["day.rmpl", "./day.rmpl", "hard.rmpl", "world.rmpl"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("day.rmpl", folder.join("soft.rmpl")).expect("a link");
        names.push("soft.rmpl");
    }
    for name in names {
        for arguments in [
            &["report", "day.rmpl", "-o", name][..],
            &["export", "day.rmpl", "--as", "csv", "-o", name],
            &["plan", "day.rmpl", "--trace", name],
        ] {
            let output = enroute_in(&folder, arguments);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
            assert!(said(&output).contains("is an input of this call"), "{arguments:?}: {output:?}");
        }
    }
    let rules = "{\"format\":\"enroute-rules/1\"}";
    std::fs::write(folder.join("rules.json"), rules).expect("written");
    let output = enroute_in(&folder, &["plan", "day.rmpl", "--rules", "rules.json", "--trace", "rules.json"]);
    assert!(said(&output).contains("is an input of this call"), "{output:?}");
    assert_eq!(std::fs::read_to_string(folder.join("rules.json")).expect("the rules"), rules);
    assert_eq!(std::fs::read_to_string(folder.join("day.rmpl")).expect("the mission"), text);
    assert_eq!(
        std::fs::read_to_string(folder.join("world.rmpl")).expect("the world"),
        "location BASE (0, 0);\n"
    );
}

#[test]
fn standard_input_is_an_input_too() {
    let folder = folder("stdin");
    std::fs::write(folder.join("day.rmpl"), MISSION).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_enroute"));
    command.current_dir(&folder).args(["export", "-", "--as", "csv", "-o", "day.rmpl"]);
    let input = std::fs::File::open(folder.join("day.rmpl")).expect("the mission");
    let output = command.stdin(Stdio::from(input)).output().expect("the command runs");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert_eq!(std::fs::read_to_string(folder.join("day.rmpl")).expect("the mission"), MISSION);
}

/// Under a limit of one block for each file, no output is written whole.
#[cfg(unix)]
#[test]
fn without_room_on_the_disk_the_old_files_stay() {
    let folder = folder("full");
    let long: String = (0..200).map(|number| format!("primitive   P{number}()[1,2];\n")).collect();
    let mission = format!("{long}{MISSION}");
    for name in ["day.rmpl", "report.html", "table.csv", "trace.jsonl"] {
        std::fs::write(folder.join(name), &mission).expect("written");
    }
    for arguments in [
        "fmt day.rmpl",
        "report day.rmpl -o report.html",
        "export day.rmpl --as json -o table.csv",
        "plan day.rmpl --trace trace.jsonl",
    ] {
        // Without the trap, the limit ends the program by a signal.
        let script = format!("trap '' XFSZ; ulimit -f 0; \"$0\" {arguments}");
        let mut command = Command::new("bash");
        command.current_dir(&folder).args(["-c", &script, env!("CARGO_BIN_EXE_enroute")]);
        let output = command.output().expect("bash runs");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {output:?}");
        assert!(said(&output).contains("cannot write"), "{arguments}: {output:?}");
    }
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .collect();
    names.sort();
    assert_eq!(names, ["day.rmpl", "report.html", "table.csv", "trace.jsonl"]);
    for name in names {
        assert_eq!(std::fs::read_to_string(folder.join(&name)).expect("the file"), mission, "{name}");
    }
    let output = enroute_in(&folder, &["report", "day.rmpl", "-o", "/dev/full"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(said(&output).contains("cannot write /dev/full"), "{output:?}");
    let full = std::fs::File::options().write(true).open("/dev/full").expect("the device");
    let mut command = Command::new(env!("CARGO_BIN_EXE_enroute"));
    command.current_dir(&folder).args(["export", "day.rmpl", "--as", "csv"]).stdout(Stdio::from(full));
    let output = command.output().expect("the command runs");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}

#[cfg(unix)]
#[test]
fn permissions_and_links_stay() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder("permissions");
    let file = folder.join("day.rmpl");
    std::fs::write(&file, MISSION.replace("scenario", "   scenario")).expect("written");
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).expect("set");
    std::os::unix::fs::symlink("day.rmpl", folder.join("link.rmpl")).expect("a link");
    let output = enroute_in(&folder, &["fmt", "link.rmpl"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(enroute_in(&folder, &["fmt", "--check", "day.rmpl"]).status.code(), Some(0));
    assert_eq!(file.metadata().expect("it is there").permissions().mode() & 0o777, 0o640);
    assert!(folder.join("link.rmpl").symlink_metadata().expect("it is there").is_symlink());
    // A new file is as any other new file.
    std::fs::write(folder.join("plain"), "").expect("written");
    assert_eq!(
        enroute_in(&folder, &["export", "day.rmpl", "--as", "csv", "-o", "table.csv"]).status.code(),
        Some(0)
    );
    let mode = |name: &str| folder.join(name).metadata().expect("it is there").permissions().mode();
    assert_eq!(mode("table.csv"), mode("plain"));
}
