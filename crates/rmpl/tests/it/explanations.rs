//! The manual page of each kind of diagnostic shows what it says.

use rmpl::diagnostics::EXPLANATIONS;
use rmpl::{Diagnostic, Severity, control, explain, parse};

fn diagnostics(text: &str) -> Vec<Diagnostic> {
    if control::is_control_text(text) { control::parse(text).diagnostics } else { parse(text).diagnostics() }
}

fn codes(text: &str) -> Vec<&'static str> {
    diagnostics(text).iter().map(|found| found.code.0).collect()
}

/// Kinds that only compiling or planning can report.
const LATER: [&str; 15] = [
    "E-AMBIGUOUS",
    "E-SIZE",
    "E-KIND",
    "E-MODEL",
    "E-NOSCENARIO",
    "E-LIMIT",
    "E-RESOURCE",
    "W-ENCOUNTER",
    "W-MAP",
    "W-EXOGENOUS",
    "W-PLANT",
    "W-LIVENESS",
    "W-UNREACHABLE",
    "W-NETWORK",
    "E-NETWORK",
];

#[test]
fn the_example_of_a_page_has_its_one_problem_and_the_mended_text_has_none() {
    for page in EXPLANATIONS.iter().filter(|page| !LATER.contains(&page.code.0)) {
        assert_eq!(codes(page.example), [page.code.0], "{}", page.code);
        assert_eq!(codes(page.mended), [""; 0], "{}", page.code);
    }
}

#[test]
fn a_page_is_found_by_its_code_in_any_case() {
    assert_eq!(explain("e-bounds").map(|page| page.code.0), Some("E-BOUNDS"));
    assert_eq!(explain("E-NOTHING"), None);
}

#[test]
fn the_letter_of_a_code_says_how_grave_it_is() {
    for page in EXPLANATIONS {
        assert_eq!(page.code.0.starts_with("E-"), page.severity == Severity::Error, "{}", page.code);
    }
}

/// Every fix that a page's example offers leads to a text without that problem.
#[test]
fn a_quick_fix_mends_the_problem_that_offers_it() {
    for page in EXPLANATIONS {
        let diagnostics = diagnostics(page.example);
        for (diagnostic, fix) in diagnostics.iter().flat_map(|it| it.fixes.iter().map(move |fix| (it, fix))) {
            let mut mended = page.example.to_owned();
            for edit in fix.edits.iter().rev() {
                mended.replace_range(edit.span.range(), &edit.text);
            }
            let left = codes(&mended);
            let before = codes(page.example).iter().filter(|code| **code == diagnostic.code.0).count();
            let after = left.iter().filter(|code| **code == diagnostic.code.0).count();
            assert!(after < before, "{}: {} gives {mended:?} with {left:?}", page.code, fix.label);
        }
    }
}
