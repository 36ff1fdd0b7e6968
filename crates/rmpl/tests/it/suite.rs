//! Runs the literate conformance suite in `tests/suite`, which is also the language's manual by example.
//!
//! Every `rmpl` block of the Markdown files is a mission. A comment line with `^^^ CODE` marks a diagnostic of the line
//! before: its exact place, its code, and, after a colon, a part of its message. There are no other diagnostics. A
//! block that is followed by a `formatted` block must be formatted to it.

use crate::fixture;
use std::fmt::Write as _;
use std::path::PathBuf;

use rmpl::{LineIndex, Span, format, parse};

struct Block {
    place: String,
    kind: String,
    text: String,
}

fn blocks() -> Vec<Block> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/suite");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().flat_map(blocks_of).collect()
}

fn blocks_of(file: &PathBuf) -> Vec<Block> {
    let name = file.file_name().unwrap().to_string_lossy().into_owned();
    let markdown = std::fs::read_to_string(file).unwrap();
    let mut found = Vec::new();
    let mut open: Option<Block> = None;
    for (number, line) in markdown.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(kind)) => {
                let place = format!("{name}:{}", number + 2);
                open = Some(Block { place, kind: kind.trim().to_owned(), text: String::new() });
            }
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some(block), None) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{name}: a block is not closed");
    found
}

/// The marks of a block whose mark lines stay in the text as comments.
fn marks(text: &str) -> Vec<(Span, String)> {
    let mut found = Vec::new();
    let mut previous = 0;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let is_mark = line.strip_prefix("//").is_some_and(|rest| rest.trim_start().starts_with('^'));
        if is_mark {
            let one = fixture::fixture(&format!(
                "{}{line}",
                &text[previous..start].lines().next().map_or(String::new(), |it| format!("{it}\n"))
            ));
            found.extend(one.marks.into_iter().map(|(span, label)| {
                (Span::new(span.start + previous as u32, span.end + previous as u32), label)
            }));
        } else {
            previous = start;
        }
        start += line.len();
    }
    found.sort_by_key(|(span, _)| *span);
    found
}

#[test]
fn every_mission_of_the_manual_has_exactly_its_marked_diagnostics() {
    let mut failures = String::new();
    let mut missions = 0;
    for block in blocks().iter().filter(|block| block.kind == "rmpl") {
        missions += 1;
        let wanted = marks(&block.text);
        let found = parse(&block.text).diagnostics();
        let agrees = wanted.len() == found.len()
            && wanted.iter().zip(&found).all(|((span, label), found)| {
                let (code, message) = label.split_once(':').unwrap_or((label, ""));
                *span == found.span && code.trim() == found.code.0 && found.message.contains(message.trim())
            });
        if !agrees {
            let lines = LineIndex::new(&block.text);
            let _ = writeln!(failures, "\n{}:\n{}  has", block.place, block.text);
            for it in found {
                let at = lines.line_column(&block.text, it.span.start);
                let width = it.span.end - it.span.start;
                let _ = writeln!(
                    failures,
                    "  line {} column {} width {width} {}: {}",
                    at.line, at.column, it.code, it.message
                );
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
    assert!(missions >= 40, "the suite has shrunk to {missions} missions");
}

#[test]
fn a_formatted_block_is_what_formatting_the_block_before_it_gives() {
    let blocks = blocks();
    let mut pairs = 0;
    for pair in blocks.windows(2).filter(|pair| pair[1].kind == "formatted") {
        pairs += 1;
        assert_eq!(format(&pair[0].text), pair[1].text, "{}", pair[1].place);
        assert_eq!(format(&pair[1].text), pair[1].text, "{}", pair[1].place);
    }
    assert!(pairs >= 2);
}

#[test]
fn every_kind_of_diagnostic_occurs_in_the_manual() {
    let manual: String = blocks().into_iter().map(|block| block.text).collect();
    // Reported by compilation or by planning, or about control programs.
    let elsewhere = [
        "E-NOSCENARIO",
        "E-LIMIT",
        "E-RESOURCE",
        "E-KIND",
        "E-MODEL",
        "E-FORM",
        "E-CONSTRAINT",
        "E-PROBABILITY",
        "E-AMBIGUOUS",
        "E-SIZE",
        "W-ENCOUNTER",
        "W-MAP",
        "W-EXOGENOUS",
        "W-PLANT",
        "W-LIVENESS",
        "W-UNREACHABLE",
        "W-NETWORK",
        "E-NETWORK",
    ];
    for page in rmpl::diagnostics::EXPLANATIONS {
        assert!(
            elsewhere.contains(&page.code.0) || manual.contains(page.code.0),
            "{} does not occur",
            page.code
        );
    }
}

/// The missions in the reference are sound and laid out as the formatter does.
#[test]
fn the_missions_in_the_reference_have_no_errors() {
    let reference = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/language.md");
    let blocks = blocks_of(&reference);
    let missions: Vec<&Block> = blocks.iter().filter(|block| block.kind == "rmpl").collect();
    assert!(!missions.is_empty());
    for mission in missions {
        assert_eq!(parse(&mission.text).diagnostics(), [], "{}", mission.place);
        assert_eq!(format(&mission.text), mission.text, "{}", mission.place);
    }
}

/// The reference's table of diagnostics and the manual pages agree.
#[test]
fn the_reference_lists_every_kind_of_diagnostic() {
    let reference = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/language.md");
    let text = std::fs::read_to_string(reference).unwrap();
    for page in rmpl::diagnostics::EXPLANATIONS {
        assert!(text.contains(&format!("`{}`", page.code)), "{} is not in the reference", page.code);
    }
}
