//! What `--help` says: short lines, plain text, and commands that start with a verb.

use crate::command::{enroute, file};

fn help(arguments: &[&str]) -> String {
    let output = enroute(&[arguments, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The commands with their descriptions, as the lists of commands have them; `review verify` is one of `review`.
fn commands() -> Vec<(Vec<String>, String)> {
    let mut found = Vec::new();
    collect(&[], &mut found);
    found
}

/// The commands below `path`.
fn collect(path: &[String], found: &mut Vec<(Vec<String>, String)>) {
    let help = help_of(path);
    let Some((_, listed)) = help.split_once("Commands:\n") else { return };
    let listed = listed.split("\n\n").next().expect("a list");
    for line in listed.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   ")) {
        let (name, about) = line.trim().split_once(' ').expect("a command and what it does");
        // The library words its own command, which lists the others again.
        if name != "help" {
            let command = [path, &[name.to_owned()]].concat();
            found.push((command.clone(), about.trim().to_owned()));
            collect(&command, found);
        }
    }
}

fn help_of(command: &[String]) -> String {
    help(&command.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn help_fits_a_terminal_and_has_no_markup() {
    let mut all = vec![(String::new(), help(&[]))];
    for (command, _) in commands() {
        let name = command.join(" ");
        all.push((name.clone(), help_of(&command)));
        let words: Vec<&str> = command.iter().map(String::as_str).chain(["-h"]).collect();
        let short = enroute(&words);
        all.push((format!("{name} -h"), String::from_utf8(short.stdout).expect("UTF-8")));
    }
    assert!(all.len() > 48, "{}", all.len());
    assert!(all.iter().any(|(command, _)| command == "review verify"));
    for (command, text) in &all {
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{command}: {line}");
            // The library words the line of its own command.
            let is_own = !line.trim_start().starts_with("help ");
            assert!(!(line.contains('`') || is_own && line.contains("(s)")), "{command}: {line}");
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
        assert!(verbs.contains(&verb), "{command:?}: {about}");
    }
}

/// Nouns that answers count.
const COUNTED: [&str; 24] = [
    "activities",
    "alternatives",
    "arcs",
    "choices",
    "comments",
    "conflicts",
    "counterexamples",
    "days",
    "decisions",
    "entries",
    "errors",
    "events",
    "failures",
    "items",
    "lines",
    "nodes",
    "orderings",
    "plans",
    "runs",
    "schedules",
    "states",
    "steps",
    "threats",
    "warnings",
];

/// A number and a noun that do not agree; “1 of 1 runs” does.
fn wrong_plural(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_wrong = |at: &usize| {
        let noun = words.get(at + 1).map_or("", |word| word.trim_end_matches([',', '.', ';', ':', ')']));
        let is_share = at.checked_sub(1).is_some_and(|before| words[before] == "of");
        words[*at].trim_start_matches('(') == "1" && COUNTED.contains(&noun) && !is_share
    };
    (0..words.len()).find(is_wrong).map(|at| words[at..at + 2].join(" "))
}

#[test]
fn one_thing_is_told_in_the_singular() {
    assert_eq!(wrong_plural("found (1 errors), 21 errors"), Some("(1 errors),".to_owned()));
    assert_eq!(wrong_plural("1 error, 2 errors, 0 errors, 1.1 lines, 1 of 1 runs, 1"), None);
    let choice = "primitive Drive()[20,30]; scenario S[0,60] = { choose { Drive() } }";
    let short = "primitive Drive()[20,30]; scenario S[0,10] = { Drive() }";
    let unknown = "scenario S[0,10] = { Drive() }";
    for (index, mission) in [choice, short, unknown].into_iter().enumerate() {
        let mission = file(&format!("singular-{index}.rmpl"), mission);
        for command in [
            &["check"][..],
            &["plan"],
            &["plan", "--all"],
            &["simulate"],
            &["robustness", "--runs", "1"],
            &["contradict", "--runs", "1", "--schedules", "1"],
        ] {
            let output = enroute(&[command, &[mission.as_str()]].concat());
            let said =
                [output.stdout, output.stderr].map(|part| String::from_utf8(part).expect("UTF-8")).concat();
            assert!(!said.trim().is_empty(), "{command:?}");
            assert_eq!(wrong_plural(&said), None, "{command:?}: {said}");
        }
    }
}

#[test]
fn time_limits_are_seconds_and_a_seed_is_that_of_paths() {
    for (command, _) in commands() {
        let text = help_of(&command);
        let option = |name: &str| text.lines().position(|line| line.trim_start().starts_with(name));
        if let Some(at) = option("--time-limit") {
            assert!(
                text.lines().nth(at).is_some_and(|line| line.contains("<SECONDS>")),
                "{command:?}: {text}"
            );
        }
        if let Some(at) = option("--seed") {
            let about: Vec<&str> = text.lines().skip(at).take(2).collect();
            assert!(about.concat().contains("Seed for path planning"), "{command:?}: {about:?}");
        }
    }
    // The former option has the same meaning.
    let [program, plant] = ["insertion", "plant"].map(|name| format!("assets/programs/orbit-{name}.rmpl"));
    let run = |option: &str| {
        let output = enroute(&["run", &program, "--model", &plant, "--format", "json", option, "7"]);
        assert_ne!(output.status.code(), Some(2), "{output:?}");
        output.stdout
    };
    assert_eq!(run("--seed"), run("--fault-seed"));
}

#[test]
fn each_option_that_counts_says_which_numbers_it_accepts() {
    let mut count = 0;
    for (command, _) in commands() {
        let text = help_of(&command);
        let options = text.lines().filter_map(|line| line.trim().strip_prefix("--")?.split_once(" <"));
        for (option, value) in options {
            let words = command.iter().map(String::as_str);
            let flag = format!("--{option}");
            let output = enroute(&words.chain([flag.as_str(), "1x"]).collect::<Vec<_>>());
            let said = String::from_utf8(output.stderr).expect("UTF-8");
            // What the standard library says of a number says nothing of the option.
            for vague in ["invalid digit", "invalid float", "number too", "is not in", "cannot parse"] {
                assert!(!said.contains(vague), "{command:?} {flag} <{value}: {said}");
            }
            if value.starts_with("SEED>") || value.starts_with("N>") {
                count += 1;
                assert!(said.contains("expected a whole number from "), "{command:?} {flag}: {said}");
            }
        }
    }
    assert!(count > 20, "only {count} options that count");
}
