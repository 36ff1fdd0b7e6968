//! Outline, folding, comments, brackets, selections and new lines.

use crate::fixture::{apply, fixture};
use rmpl::editor::{self, FoldKind, OutlineKind};
use rmpl::{Span, parse};

#[test]
fn the_outline_lists_what_is_declared_even_where_it_is_broken() {
    let text = "var P : {OK};\nM(x)[l,u] = { A( }\nlocation BASE (1, 2);\nscenario S[0,9] = { M(";
    let found = editor::outline(&parse(text));
    let shown: Vec<_> =
        found.iter().map(|item| (item.kind, item.name.as_str(), item.detail.as_str())).collect();
    assert_eq!(
        shown,
        [
            (OutlineKind::Variable, "P", ": {OK}"),
            (OutlineKind::Activity, "M", "(x)[l,u]"),
            (OutlineKind::Location, "BASE", "(1, 2)"),
            (OutlineKind::Scenario, "S", "[0,9]"),
        ]
    );
}

#[test]
fn blocks_comments_and_rows_of_locations_fold() {
    let text = "// a\n// b\nlocation X (0, 0);\nlocation Y (0, 0);\nM() = {\n  choose {\n    A(),\n    B()\n  }\n}\nN() = { A() }\n";
    let found = editor::folds(&parse(text));
    let lines = |span: Span| text[span.range()].matches('\n').count();
    let shown: Vec<_> = found.iter().map(|fold| (fold.kind, lines(fold.span))).collect();
    assert_eq!(
        shown,
        [(FoldKind::Comment, 1), (FoldKind::Declarations, 1), (FoldKind::Braces, 5), (FoldKind::Braces, 3)]
    );
}

#[track_caller]
fn check_toggle(before: &str, after: &str) {
    let range = Span::new(0, before.len() as u32);
    assert_eq!(apply(before, &editor::toggle_comment(before, range)), after);
    let back = editor::toggle_comment(after, Span::new(0, after.len() as u32));
    assert_eq!(apply(after, &back), before);
}

#[test]
fn comments_are_toggled_in_one_column() {
    check_toggle("  A();\n\n    B();\n", "  // A();\n\n  //   B();\n");
}

#[test]
fn only_the_lines_of_the_selection_become_comments() {
    let text = "A();\nB();\nC();\n";
    assert_eq!(apply(text, &editor::toggle_comment(text, Span::new(6, 10))), "A();\n// B();\nC();\n");
}

/// The bracket at the cursor belongs to the marked one.
#[track_caller]
fn check_bracket(written: &str) {
    let fixture = fixture(written);
    let partner = editor::matching_bracket(&parse(&fixture.text), fixture.cursor).map(|(_, partner)| partner);
    assert_eq!(partner, fixture.marks.first().map(|(span, _)| *span));
}

#[test]
fn brackets_find_their_partner_in_both_directions() {
    check_bracket("M() = $0{ { A() }; B() }\n//                   ^\n");
    check_bracket("M() = { { A() }; B() }$0\n//    ^\n");
    check_bracket("M() = { A$0(x) }\n//         ^\n");
    check_bracket("M() = { A$0(x }\n");
}

/// Enter at the first `$0` leads to the second text, with the cursor at its `$0`.
#[track_caller]
fn check_new_line(before: &str, after: &str) {
    let (before, after) = (fixture(before), fixture(after));
    let (edit, cursor) = editor::new_line(&parse(&before.text), Span::new(before.cursor, before.cursor));
    assert_eq!((apply(&before.text, &[edit]), cursor), (after.text, after.cursor));
}

#[test]
fn a_new_line_is_as_deep_as_its_block() {
    check_new_line("M() = {$0}", "M() = {\n  $0\n}");
    check_new_line("M() = {\n  A();$0\n}", "M() = {\n  A();\n  $0\n}");
    check_new_line("M() = {\n  choose {$0\n  }\n}", "M() = {\n  choose {\n    $0\n  }\n}");
    check_new_line("M() = {\n  A();$0 B()\n}", "M() = {\n  A();\n  $0B()\n}");
    check_new_line("M() = { A() }$0", "M() = { A() }\n$0");
    check_new_line("// one $0two", "// one\n// $0two");
}

#[test]
fn a_selection_grows_by_the_structure() {
    let text = "M() = { do { A(x) } maintaining c; B() }";
    let parse = parse(text);
    let mut selection = Span::new(15, 15);
    let mut seen = Vec::new();
    while let Some(wider) = editor::wider_selection(&parse, selection) {
        seen.push(&text[wider.range()]);
        selection = wider;
    }
    assert_eq!(
        seen,
        [
            "x",
            "(x)",
            "A(x)",
            "{ A(x) }",
            "do { A(x) } maintaining c",
            "{ do { A(x) } maintaining c; B() }",
            text
        ]
    );
}
