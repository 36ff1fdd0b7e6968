//! A bounded fuzz run: real programs, cut, doubled, swapped and sprinkled, through every query. Nothing may panic, lose
//! text or change meaning. The seed of a failure is printed with it.

use rmpl::editor::{self, Evaluation};
use rmpl::syntax::SyntaxNode;
use rmpl::{Edit, Span, format, parse};

const ROUNDS: u64 = 2500;

const PROGRAMS: [&str; 9] = [
    include_str!("../../../assets/missions/enroute.rmpl"),
    include_str!("../../../assets/missions/causal-links.rmpl"),
    include_str!("../../../tests/conformance/c01_enroute_verbatim.rmpl"),
    include_str!("../../../tests/conformance/t28_fig_threat_windows.rmpl"),
    include_str!("../../../tests/conformance/h01_orbit_nominal.rmpl"),
    include_str!("../../../tests/suite/07-mistakes.md"),
    include_str!("../../../tests/suite/09-larger-missions.md"),
    include_str!("../../../tests/suite/10-state-and-resources.md"),
    include_str!("../../../tests/suite/11-what-nature-chooses.md"),
];

const PIECES: [&str; 21] = [
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    ";",
    ",",
    "=",
    "-",
    "%",
    "\"",
    "/*",
    "//",
    "\n",
    "∞",
    "–",
    "choose",
    " contingent ",
    "99999999999999999999",
    "\u{feff}",
];

struct Source(u64);

impl Source {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % limit.max(1)
    }

    fn place(&mut self, text: &str) -> usize {
        let mut at = self.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    fn range(&mut self, text: &str) -> std::ops::Range<usize> {
        let start = self.place(text);
        let mut end = (start + self.below(60)).min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        start..end.max(start)
    }

    fn mutate(&mut self, text: &mut String) {
        match self.below(4) {
            0 => {
                let range = self.range(text);
                text.replace_range(range, "");
            }
            1 => {
                let piece = text[self.range(text)].to_owned();
                let at = self.place(text);
                text.insert_str(at, &piece);
            }
            2 => {
                let at = self.place(text);
                text.insert_str(at, PIECES[self.below(PIECES.len())]);
            }
            _ => {
                let other = PROGRAMS[self.below(PROGRAMS.len())];
                let piece = other[self.range(other)].to_owned();
                let range = self.range(text);
                text.replace_range(range, &piece);
            }
        }
    }
}

#[test]
fn no_mutation_of_a_program_panics_loses_text_or_changes_meaning() {
    for seed in 1..=ROUNDS {
        let mut source = Source(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut text = PROGRAMS[source.below(PROGRAMS.len())].to_owned();
        for _ in 0..=source.below(6) {
            source.mutate(&mut text);
        }
        let outcome = std::panic::catch_unwind(|| exercise(&text, seed));
        assert!(outcome.is_ok(), "seed {seed}: {text:?}");
    }
}

fn exercise(text: &str, seed: u64) {
    let mut source = Source(seed | 1);
    let mut parsed = parse(text);
    let held: String = parsed.declarations().flat_map(SyntaxNode::tokens).map(|token| token.text).collect();
    assert_eq!(held, text, "the tree holds the text");
    for found in parsed.diagnostics() {
        let spans = found.fixes.iter().flat_map(|fix| &fix.edits).map(|edit| edit.span).chain([found.span]);
        for span in spans {
            assert!(text.get(span.range()).is_some(), "{found:?} has a place outside the text");
        }
    }
    let formatted = format(text);
    assert_eq!(format(&formatted), formatted, "formatting twice");
    let before = parsed.program();
    let after = parse(&formatted).program();
    assert_eq!(before.activities.len(), after.activities.len());
    assert_eq!(before.scenarios.len(), after.scenarios.len());
    let offset = source.place(text) as u32;
    let range = Span::new(offset, offset);
    let _ = editor::complete(&parsed, offset);
    let _ = editor::hover(&parsed, offset, &Evaluation::default());
    let _ = editor::signature_at(&parsed, offset);
    let _ = editor::references(&parsed, offset);
    let _ = editor::rename(&parsed, offset, "Other");
    let _ = editor::matching_bracket(&parsed, offset);
    let _ = editor::wider_selection(&parsed, range);
    let _ = editor::fixes_at(&parsed, range);
    let _ = editor::toggle_comment(text, range);
    let _ = editor::outline(&parsed);
    let _ = editor::folds(&parsed);
    for piece in editor::highlight(&parsed, Span::new(0, text.len() as u32)) {
        assert!(text.get(piece.span.range()).is_some());
    }
    let (edit, cursor) = editor::new_line(&parsed, range);
    assert!(text.get(edit.span.range()).is_some());
    parsed.edit(&edit);
    assert!(parsed.text().is_char_boundary(cursor as usize));
    parsed.edit(&Edit { span: source.range(parsed.text()).into_span(), text: "x".to_owned() });
    let fresh = parse(parsed.text());
    assert_eq!(parsed.diagnostics(), fresh.diagnostics(), "after edits");
}

trait IntoSpan {
    fn into_span(self) -> Span;
}

impl IntoSpan for std::ops::Range<usize> {
    fn into_span(self) -> Span {
        Span::new(self.start as u32, self.end as u32)
    }
}
