//! What `--help` says: short lines, plain text, and commands that start with a verb.

use crate::command::enroute;

fn help(arguments: &[&str]) -> String {
    let output = enroute(&[arguments, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The commands with their descriptions, as the list of all of them has them.
fn commands() -> Vec<(String, String)> {
    let help = help(&[]);
    let (_, listed) = help.split_once("Commands:\n").expect("a list of commands");
    let listed = listed.split("\n\n").next().expect("a list");
    let lines = listed.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let described = lines.map(|line| line.trim().split_once(' ').expect("a command and what it does"));
    described.map(|(name, about)| (name.to_owned(), about.trim().to_owned())).collect()
}

#[test]
fn help_fits_a_terminal_and_has_no_markup() {
    let mut all = vec![(String::new(), help(&[]))];
    for (command, _) in commands().iter().filter(|(command, _)| command != "help") {
        all.push((command.clone(), help(&[command])));
        let short = enroute(&[command, "-h"]);
        all.push((format!("{command} -h"), String::from_utf8(short.stdout).expect("UTF-8")));
    }
    assert!(all.len() > 40, "{}", all.len());
    for (command, text) in &all {
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{command}: {line}");
            assert!(!line.contains('`'), "{command}: {line}");
        }
    }
}

#[test]
fn every_command_says_what_it_does_by_a_verb() {
    let verbs = [
        "Check", "Compare", "Compile", "Convert", "Estimate", "Explain", "Export", "Find", "Format", "Plan",
        "Print", "Prove", "Review", "Run", "Search", "Show", "Simulate", "Update", "Verify",
    ];
    let commands = commands();
    assert!(commands.len() > 20, "{commands:?}");
    for (command, about) in &commands {
        let verb = about.split(' ').next().expect("a word");
        assert!(verbs.contains(&verb), "{command}: {about}");
    }
}

#[test]
fn time_limits_are_seconds_and_a_seed_is_that_of_paths() {
    for (command, _) in commands().iter().filter(|(command, _)| command != "help") {
        let text = help(&[command]);
        let option = |name: &str| text.lines().position(|line| line.trim_start().starts_with(name));
        if let Some(at) = option("--time-limit") {
            assert!(text.lines().nth(at).is_some_and(|line| line.contains("<SECONDS>")), "{command}: {text}");
        }
        if let Some(at) = option("--seed") {
            let about: Vec<&str> = text.lines().skip(at).take(2).collect();
            assert!(about.concat().contains("Seed for path planning"), "{command}: {about:?}");
        }
    }
    // What scripts say goes on to mean what it did.
    let [program, plant] = ["insertion", "plant"].map(|name| format!("assets/programs/orbit-{name}.rmpl"));
    let run = |option: &str| {
        let output = enroute(&["run", &program, "--model", &plant, "--format", "json", option, "7"]);
        assert_ne!(output.status.code(), Some(2), "{output:?}");
        output.stdout
    };
    assert_eq!(run("--seed"), run("--fault-seed"));
}
