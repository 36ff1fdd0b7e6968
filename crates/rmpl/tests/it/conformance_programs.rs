//! Every infix program of the conformance cases parses as the cases say.

use std::path::PathBuf;

use rmpl::syntax::SyntaxNode;
use rmpl::{Severity, parse};

fn programs() -> Vec<(String, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance");
    let mut found: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    found.sort();
    found
        .into_iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "rmpl"))
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        // Control programs have a reader of their own; state, resources, objectives and contingent durations are not
        // built yet, as `tests/src/cases.rs` lists them.
        .filter(|(name, _)| !name.starts_with(['h', 'o', 'r', 's', 'u', 'w']))
        .collect()
}

#[test]
fn programs_of_plans_have_no_errors() {
    for (name, text) in programs().iter().filter(|(name, _)| !name.starts_with('e')) {
        let errors: Vec<_> =
            parse(text).diagnostics().into_iter().filter(|it| it.severity == Severity::Error).collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");
    }
}

#[test]
fn a_wrong_program_has_exactly_the_error_of_its_case() {
    let expected = [
        ("e01_recursion", "E-RECURSION"),
        ("e02_bad_bounds", "E-BOUNDS"),
        ("e05_missing_thennext", "E-SYNTAX"),
        ("e06_unbalanced", "E-SYNTAX"),
        ("e09_value_not_in_domain", "E-VALUE"),
    ];
    for (name, text) in programs() {
        let Some((_, code)) = expected.iter().find(|(case, _)| *case == name) else { continue };
        let errors: Vec<_> = parse(&text)
            .diagnostics()
            .into_iter()
            .filter(|it| it.severity == Severity::Error)
            .map(|it| it.code.0)
            .collect();
        assert_eq!(errors, [*code], "{name}");
    }
}

#[test]
fn the_trees_of_every_program_hold_its_text() {
    for (name, text) in programs() {
        let parse = parse(&text);
        let held: String =
            parse.declarations().flat_map(SyntaxNode::tokens).map(|token| token.text).collect();
        assert_eq!(held, text, "{name}");
    }
}
