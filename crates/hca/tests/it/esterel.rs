//! The lesson `docs/esterel.md`: every row of the correspondence table with Esterel (SPEC 8.2) does what it says.

use std::collections::BTreeSet;

use hca::{Vocabulary, compile_text, trace};
use smol_str::SmolStr;

const LESSON: &str = include_str!("../../../../docs/esterel.md");

/// A program of the lesson, and its table: what is marked at the start of each step and known at its end.
struct Example {
    heading: String,
    program: String,
    steps: Vec<[String; 2]>,
}

fn examples() -> Vec<Example> {
    let mut examples: Vec<Example> = Vec::new();
    let (mut heading, mut is_program) = (String::new(), false);
    for line in LESSON.lines() {
        if let Some(text) = line.strip_prefix("## ") {
            text.clone_into(&mut heading);
        } else if line == "```rmpl" {
            examples.push(Example { heading: heading.clone(), program: String::new(), steps: Vec::new() });
            is_program = true;
        } else if line == "```" {
            is_program = false;
        } else if let Some(example) = examples.last_mut() {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            match cells[..] {
                _ if is_program => example.program.extend([line, "\n"]),
                [step, marked, known] if step.parse::<u32>().is_ok() => {
                    example.steps.push([marked.to_owned(), known.to_owned()]);
                }
                _ => {}
            }
        }
    }
    examples
}

/// The labels of the marked locations per step.
fn run(example: &Example) -> Vec<String> {
    let vocabulary =
        Vocabulary { program_variables: BTreeSet::from([SmolStr::new("exit")]), ..Vocabulary::default() };
    let compilation = compile_text(&example.program, &vocabulary);
    assert_eq!(compilation.diagnostics, [], "{}", example.heading);
    let automaton = compilation.automaton.expect("a program without diagnostics compiles");
    // What is known after the last row has no part in the table.
    let known = example.steps.iter().take(example.steps.len() - 1);
    let estimates: Vec<_> = known
        .map(|[_, known]| {
            automaton.estimate(known.split_whitespace().filter_map(|pair| pair.split_once('=')))
        })
        .collect();
    trace(&automaton, &estimates).steps.iter().map(|step| step.labels.join(", ")).collect()
}

#[test]
fn every_program_of_the_lesson_marks_what_its_table_says() {
    for example in examples() {
        let stated: Vec<&str> = example.steps.iter().map(|[marked, _]| marked.as_str()).collect();
        assert_eq!(run(&example), stated, "{}: {}", example.heading, example.program);
    }
}

#[test]
fn the_lesson_has_every_row_of_the_table() {
    let headings: BTreeSet<String> = examples().into_iter().map(|example| example.heading).collect();
    for row in [
        "pause",
        "halt",
        "await S",
        "await S do",
        "trap",
        "weak abort",
        "abort",
        "every S",
        "do … maintaining",
    ] {
        assert!(headings.iter().any(|heading| heading.starts_with(row)), "{row} is missing in {headings:?}");
    }
}
