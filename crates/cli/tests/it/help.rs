//! What `--help` says: short lines, plain text, and commands that start with a verb.

use crate::command::{enroute, file};

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
    all.push(("review verify".to_owned(), help(&["review", "verify"])));
    assert!(all.len() > 40, "{}", all.len());
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
        assert!(verbs.contains(&verb), "{command}: {about}");
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
    // The former option has the same meaning.
    let [program, plant] = ["insertion", "plant"].map(|name| format!("assets/programs/orbit-{name}.rmpl"));
    let run = |option: &str| {
        let output = enroute(&["run", &program, "--model", &plant, "--format", "json", option, "7"]);
        assert_ne!(output.status.code(), Some(2), "{output:?}");
        output.stdout
    };
    assert_eq!(run("--seed"), run("--fault-seed"));
}
