//! Missions in RMPL: every query on their texts, planning, and rules on them.

use std::sync::{Arc, LazyLock};

use mission::review::flight_rule;
use mission::{Core, CoreHost, Goal, Request, Response, SearchKind, Update};
use rmpl::editor::{self, Evaluation};
use rmpl::program::Program;
use rmpl::syntax::SyntaxNode;
use rmpl::{Edit, Span, format, parse};
use tpn::Network;

use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};
use crate::mutation::Random;

const WORDS: &[&str] = &[
    "{",
    "}",
    "||",
    ";",
    "[0,inf]",
    "choose",
    "choose {",
    " contingent ",
    " optional ",
    "scenario S[0,10] = ",
    "primitive ",
    "activity ",
    "location ",
    "vehicle ",
    "obstacle ",
    "terrain ",
    "state ",
    "resource ",
    "const ",
    "constrain ",
    " as A",
    "minimize end;",
    "sets X=on",
    "requires ",
    "maintain ",
    "import \"a\";",
    "\n--- b.rmpl\n",
    "–",
    "∞",
    "per metre",
    "do-watching",
    "unless",
    "repeat",
    "moves V",
    "speed (",
    "uses ",
    "aborts [0,1]",
];

/// The text: parsed, queried, edited and formatted. Nothing is lost and nothing changes its meaning.
pub(super) const TEXTS: Reader = Reader {
    name: "missions",
    seeds: &["assets/missions/*.rmpl", "tests/conformance/*.rmpl", "tests/suite/*.md"],
    words: WORDS,
    mend: nothing,
    exercise: texts,
    tested: 2500,
};

fn texts(input: &[u8]) -> Outcome {
    let text = &*text_of(input);
    let mut random =
        Random::new(input.iter().fold(1, |sum: u64, &byte| sum.wrapping_mul(31) + u64::from(byte)));
    let mut place = |text: &str| text.floor_char_boundary(random.below(text.len() + 1)) as u32;
    let mut parsed = parse(text);
    let held: String = parsed.declarations().flat_map(SyntaxNode::tokens).map(|token| token.text).collect();
    assert_eq!(held, text, "the tree holds the text");
    let found = parsed.diagnostics();
    for found in &found {
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
    let offset = place(text);
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
    let ends = [place(parsed.text()), place(parsed.text())];
    parsed.edit(&Edit { span: Span::new(ends[0].min(ends[1]), ends[0].max(ends[1])), text: "x".to_owned() });
    assert_eq!(parsed.diagnostics(), parse(parsed.text()).diagnostics(), "after edits");
    let mut codes: Vec<String> = found.iter().map(|found| found.code.to_string()).collect();
    codes.sort_unstable();
    codes.dedup();
    read(&format!("{} {}", magnitude(before.activities.len()), codes.concat()))
}

/// The same texts with all that the page does with one: compiled, planned, paths found, checked, within bounds.
pub(super) const PLANNED: Reader = Reader {
    name: "missions-planned",
    seeds: &["assets/missions/*.rmpl", "tests/conformance/t*.rmpl", "tests/conformance/*.rmpl"],
    words: WORDS,
    mend: nothing,
    exercise: planned,
    tested: 200,
};

/// Asks the core to stop after it has looked so often whether it should.
struct Bounded {
    looks_left: u32,
    answered: Vec<Response>,
}

impl CoreHost for Bounded {
    fn now_millis(&self) -> f64 {
        0.0
    }

    fn is_superseded(&mut self) -> bool {
        self.looks_left = self.looks_left.saturating_sub(1);
        self.looks_left == 0
    }

    fn answer(&mut self, response: Response) {
        self.answered.push(response);
    }
}

fn planned(input: &[u8]) -> Outcome {
    let mut host = Bounded { looks_left: 300, answered: Vec::new() };
    let update = Update {
        revision: 1,
        source: text_of(input).into(),
        goal: Goal::Default,
        search: SearchKind::default(),
        seed: 1,
        trace: false,
    };
    Core::default().handle(Request::Update(update), &mut host);
    let last = host.answered.iter().rev().find_map(|answer| match answer {
        Response::Snapshot(snapshot) => Some(snapshot),
        _ => None,
    });
    let Some(last) = last else { return NOTHING };
    let mut codes: Vec<String> = last.problems.iter().map(|problem| problem.code.to_string()).collect();
    codes.sort_unstable();
    codes.dedup();
    let verdict = last.planning.as_ref().and_then(|planning| planning.verdict.as_ref());
    let kind =
        format!("{:?} {} {:?}", last.stage, last.plan().is_some(), verdict.map(|it| it.violations.len()));
    let what = kind + &codes.concat();
    if last.plan().is_some() { read(&what) } else { refused(&what) }
}

/// Rules of reviews in the mission's own language.
pub(super) const RULES: Reader = Reader {
    name: "rules",
    seeds: &[],
    words: &[
        "never ",
        " while ",
        " and ",
        " or ",
        "not ",
        " at end",
        " at start",
        "Rover1.at=",
        ">= 20",
        "before ",
        "[0,5]",
        "Drive(",
    ],
    mend: nothing,
    exercise: rules,
    tested: 1200,
};

static MISSION: LazyLock<(Program, Network)> = LazyLock::new(|| {
    let program = parse(include_str!("../../../../assets/missions/enroute.rmpl")).program();
    let network = mission::compile(&program, &Goal::Default, &mut Vec::new()).expect("the example");
    (program, network)
});

fn rules(input: &[u8]) -> Outcome {
    let (program, network) = &*MISSION;
    let problem = flight_rule::problem(program, network, &text_of(input));
    problem.map_or(read(""), |problem| refused(&format!("{problem:?}")))
}

/// The example mission, for what is said about one.
pub(super) fn example() -> (&'static Program, &'static Network) {
    (&MISSION.0, &MISSION.1)
}

/// The same, shared.
pub(super) fn shared_network() -> Arc<Network> {
    Arc::new(MISSION.1.clone())
}
