//! Texts that are large or senseless: what is told of them is what one reads, and it is counted.

use std::fmt::Write as _;

use rmpl::{Diagnostic, Edit, MAX_LISTED, Severity, Span, parse};

fn codes(found: &[Diagnostic]) -> Vec<&str> {
    found.iter().map(|found| found.code.0).collect()
}

fn told(found: &[Diagnostic], severity: Severity) -> usize {
    found.iter().filter(|found| found.severity == severity).map(|found| 1 + found.more as usize).sum()
}

fn calls(count: usize, name: impl Fn(usize) -> String) -> String {
    let mut text = "scenario M[0,inf] = { ".to_owned();
    for number in 0..count {
        let _ = write!(text, "{}(); ", name(number));
    }
    text + "}\n"
}

#[test]
fn nesting_that_is_too_deep_is_one_mistake() {
    for (open, count) in [("choose { ", 5_000), ("{ ", 5_000), ("if A thennext ", 5_000)] {
        let text = format!("scenario M[0,inf] = {{ {}", open.repeat(count));
        assert_eq!(codes(&parse(&text).diagnostics()), ["E-SYNTAX"], "{open}");
    }
    // What comes after is read.
    let text = format!("scenario M[0,inf] = {{ {}\nscenario Other[0,5] = {{ delay }}", "{ ".repeat(500));
    assert_eq!(parse(&text).program().scenarios.len(), 2);
}

#[test]
fn a_run_of_characters_without_meaning_is_one_mistake_that_one_fix_removes() {
    let text = format!("scenario M[0,inf] = {{ delay {}}}", "@ ".repeat(20_000));
    let found = parse(&text).diagnostics();
    assert_eq!(codes(&found), ["E-LEX"]);
    let mut mended = parse(&text);
    let remove = found[0].fixes.iter().find(|fix| fix.label == "Remove").expect("a fix");
    mended.edit(&remove.edits[0]);
    assert_eq!(codes(&mended.diagnostics()), Vec::<&str>::new());
    // On both sides of something that has a meaning there are two.
    assert_eq!(codes(&parse("scenario M[0,1] = { @ # delay ? }").diagnostics()), ["E-LEX", "E-LEX"]);
}

#[test]
fn of_many_mistakes_the_first_are_listed_and_the_others_counted() {
    let text = calls(3_000, |number| format!("Q{number}"));
    let found = parse(&text).diagnostics();
    assert_eq!((found.len(), told(&found, Severity::Warning)), (MAX_LISTED, 3_000));
    let last = found.last().expect("some");
    assert!(last.full_message().ends_with("; and 2500 more warnings"), "{}", last.full_message());
    // Errors are listed beside warnings, however many of those come first.
    let found = parse(&format!("{text}primitive P()[5,4];")).diagnostics();
    assert_eq!(told(&found, Severity::Error), 1);
    let mut edited = parse(&text);
    edited.edit(&Edit { span: Span::new(0, text.len() as u32), text: "scenario M = { delay }".into() });
    assert!(edited.diagnostics().is_empty());
}

#[test]
fn a_misspelled_name_is_known_among_thousands() {
    let mut text =
        "scenario M[0,inf] = { Activty1234(); Actvity77(); Activity2999x(); Activiyt0() }\n".to_owned();
    for number in 0..3_000 {
        let _ = writeln!(text, "primitive Activity{number}()[1,2];");
    }
    let found = parse(&text).diagnostics();
    let hints: Vec<&str> = found
        .iter()
        .filter(|found| found.code.0 == "W-UNDEF")
        .filter_map(|found| found.hint.as_deref())
        .collect();
    let expected = ["Activity1234", "Activity77", "Activity2999", "Activity0"];
    assert_eq!(hints, expected.map(|name| format!("did you mean `{name}`?")));
}

#[test]
fn of_declarations_that_share_a_name_the_first_in_the_text_counts_through_edits() {
    let text =
        "primitive A()[1,2];\nprimitive A()[3,4];\nprimitive A()[5,6];\nscenario M[0,9] = { A()[1,2] }\n";
    let mut parsed = parse(text);
    let first = codes(&parsed.diagnostics()).join(" ");
    assert_eq!(first, "E-DUP E-DUP");
    parsed.edit(&Edit { span: Span::new(0, 20), text: String::new() });
    assert_eq!(parsed.diagnostics(), parse(parsed.text()).diagnostics());
    parsed.edit(&Edit { span: Span::new(0, 0), text: "primitive A()[1,1];\n".into() });
    assert_eq!(parsed.diagnostics(), parse(parsed.text()).diagnostics());
}

#[test]
fn names_of_thousands_of_letters_are_cut_in_messages_and_whole_in_fixes() {
    let name = "a".repeat(70_000);
    let found = parse(&format!("scenario M[0,9] = {{ {name}() }}")).diagnostics();
    assert!(found.iter().all(|found| found.message.len() < 300), "{found:?}");
    let found = parse(&format!("scenario M[0,9] = {{ P{name}–b() }}")).diagnostics();
    let fix = found.iter().flat_map(|found| &found.fixes).next().expect("a fix");
    assert!(fix.label.len() < 300);
    assert_eq!(fix.edits[0].text, format!("P{name}-b"));
}

#[test]
fn negative_speeds_are_no_speeds() {
    for (speeds, expected) in [("-1, 2", "E-VALUE"), ("-2, -1", "E-VALUE"), ("0, 2", ""), ("2, 1", "E-VALUE")]
    {
        let text = format!(
            "location A (0, 0);\nlocation B (9, 9);\nvehicle R : ATRV at A;\nprimitive Go(to)[1,100] moves R speed ({speeds});\n\
             scenario M[0,100] = {{ Go(B) }}\n"
        );
        assert_eq!(codes(&parse(&text).diagnostics()).join(" "), expected, "{speeds}");
    }
}
