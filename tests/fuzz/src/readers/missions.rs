//! Missions in RMPL: every query on their texts, planning, and rules on them.

use std::sync::{Arc, LazyLock};

use executive::Script;
use kirk::Search as SearchKind;
use link::{Request, Response, Update};
use mission::{Core, CoreHost};
use review::flight_rule;
use rmpl::editor::{self, Evaluation};
use rmpl::program::Program;
use rmpl::syntax::SyntaxNode;
use rmpl::{Edit, Span, format, parse};
use snapshot::Stage;
use snapshot::{Goal, RobustnessSettings, Snapshot, Uncertainty};
use tpn::Network;
use verify::{Rule, Violation};

use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};
use crate::mutation::Random;

pub(super) const WORDS: &[&str] = &[
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
    keeps_form: 3,
    cost: 1,
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

/// The same texts with all that the page does with one: compiled, planned, paths found, checked, executed with what
/// disturbs them and many times by chance, within bounds. Plans that are given hold against the checker.
pub(super) const PLANNED: Reader = Reader {
    name: "missions-planned",
    seeds: &["assets/missions/*.rmpl", "tests/conformance/*.rmpl"],
    words: WORDS,
    mend: nothing,
    exercise: planned,
    tested: 200,
    keeps_form: 8,
    cost: 100,
};

/// Asks the core to stop after it has looked so often whether it should.
pub(super) struct Bounded {
    looks_left: u32,
    answered: Vec<Response>,
}

impl Bounded {
    pub(super) fn new(looks_left: u32) -> Self {
        Self { looks_left, answered: Vec::new() }
    }
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

/// The text as the page asks for it.
pub(super) fn update_of(text: &str) -> Update {
    Update { seed: 1, ..Update::new(1, text) }
}

/// Returns what was answered last of a text.
pub(super) fn last_snapshot(host: &Bounded) -> Option<Arc<Snapshot>> {
    host.answered.iter().rev().find_map(|answer| match answer {
        Response::Snapshot(snapshot) => Some(Arc::clone(snapshot)),
        _ => None,
    })
}

fn planned(input: &[u8]) -> Outcome {
    let text = &*text_of(input);
    let mut random =
        Random::new(input.iter().fold(1, |sum: u64, &byte| sum.wrapping_mul(31) + u64::from(byte)));
    let search = SearchKind::ALL[random.below(SearchKind::ALL.len())];
    let update = Update { search, trace: (random.below(4) == 0).then_some(search), ..update_of(text) };
    let mut core = Core::default();
    let mut host = Bounded::new(300);
    core.handle(Request::Update(update.clone()), &mut host);
    let Some(last) = last_snapshot(&host) else { return NOTHING };
    let mut codes: Vec<String> = last.problems.iter().map(|problem| problem.code.to_string()).collect();
    codes.sort_unstable();
    codes.dedup();
    let verdict = last.planning.as_ref().and_then(|planning| planning.verdict.as_ref());
    let kind =
        format!("{:?} {} {:?}", last.stage, last.plan().is_some(), verdict.map(|it| it.violations.len()));
    let mut what = kind + &codes.concat();
    if last.plan().is_none() {
        return refused(&what);
    }
    if last.stage == Stage::Complete {
        assert!(verdict.is_some_and(|it| it.valid || it.violations.iter().all(is_beyond)), "{verdict:?}");
        what += &executed(&mut core, update, &mut random);
    }
    read(&what)
}

/// Returns whether the checker could not check, which is said.
fn is_beyond(violation: &Violation) -> bool {
    violation.rule == Rule::Form
}

/// Executes the plan that the core keeps, once as a script says and a few times by chance.
fn executed(core: &mut Core, update: Update, random: &mut Random) -> String {
    let mut led = String::new();
    let script = Script { adversary: random.below(2) == 0, ..Script::default() };
    let settings =
        RobustnessSettings { runs: 3, seed: random.below(1000) as u64, uncertainty: Uncertainty::default() };
    for request in
        [Request::Execute { update: update.clone(), script }, Request::Sample { update, settings, from: 0 }]
    {
        let mut host = Bounded::new(600);
        core.handle(request, &mut host);
        for answer in &host.answered {
            match answer {
                Response::Execution(execution) => {
                    led += &format!("{:?} {} ", execution.ending, magnitude(execution.log.len()));
                }
                Response::Sampled { tally, .. } => led += &format!("{} ", tally.succeeded),
                _ => {}
            }
        }
    }
    led
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
    keeps_form: 3,
    cost: 1,
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
