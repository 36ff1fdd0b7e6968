//! What the language crate knows about the text, kept up to date with every edit.

use std::sync::Arc;

use interchange::is_network_text;
use rmpl::control::{ParsedControl, is_control_text};
use rmpl::editor::{self, Evaluation, EventWindow, Invocation};
use rmpl::{Parse, Shift, Span};
use text_editing::Document;
use tpn::{OccurrenceKind, Plan};

mod data_notation;

/// The text as the language sees it.
#[derive(Debug)]
pub struct Language {
    revision: u64,
    notation: Notation,
}

/// The notations of a text.
#[derive(Debug)]
enum Notation {
    /// Missions (SPEC 1).
    Mission(Box<Parse>),
    /// Control programs (SPEC 2), with their text.
    Control(Box<ParsedControl>, Arc<str>),
    /// Networks of other tools, in JSON or EDN.
    Network(Arc<str>),
}

/// What a piece of source text is, in either notation: each has a color of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyntaxRole {
    Keyword,
    /// An activity or a primitive.
    Activity,
    /// A state variable.
    Variable,
    /// A value of a state variable.
    Value,
    /// A formal or a bound parameter.
    Parameter,
    /// A location, an obstacle or a vehicle.
    Place,
    /// A number or infinity.
    Number,
    /// A text in quotes.
    String,
    Comment,
    /// A bracket, a separator or an operator.
    Punctuation,
    /// Nothing that the language knows.
    Unknown,
}

/// An edit longer than this may turn a text into one of the other notation.
const LARGE_EDIT_BYTES: u32 = 64;

impl Language {
    /// Reads a document.
    pub fn new(document: &Document) -> Self {
        Self { revision: document.revision(), notation: read(document.shared_text()) }
    }

    /// Reads what has changed in the document since.
    pub fn follow(&mut self, document: &Document) {
        if self.revision == document.revision() {
            return;
        }
        let shift = document.edits_since(self.revision).map(Shift::of);
        self.revision = document.revision();
        let text = document.shared_text();
        match (&mut self.notation, shift) {
            (_, Some(shift)) if shift.is_nothing() => {}
            (Notation::Mission(parse), Some(shift)) if !may_change_notation(shift, &text) => {
                parse.follow(text, shift);
            }
            _ => self.notation = read(text),
        }
    }

    /// The tree, if the text is a mission.
    pub fn parse(&self) -> Option<&Parse> {
        match &self.notation {
            Notation::Mission(parse) => Some(parse),
            Notation::Control(..) | Notation::Network(_) => None,
        }
    }

    /// Returns whether the text is a network of another tool.
    pub const fn is_network(&self) -> bool {
        matches!(self.notation, Notation::Network(_))
    }

    /// Returns whether the text is a control program.
    pub const fn is_control(&self) -> bool {
        matches!(self.notation, Notation::Control(..))
    }

    /// Returns what the pieces of the text in `range` are, in textual order.
    pub fn roles(&self, range: Span) -> Vec<(Span, SyntaxRole)> {
        match &self.notation {
            Notation::Mission(parse) => editor::highlight(parse, range)
                .into_iter()
                .map(|found| (found.span, mission_role(found.kind)))
                .collect(),
            Notation::Control(parsed, text) => rmpl::control::highlight(text, parsed)
                .into_iter()
                .map(|found| (found.span, control_role(found.kind)))
                .collect(),
            Notation::Network(text) => data_notation::roles(text, range),
        }
    }

    /// The text in its canonical layout, file by file; nothing if it has that already.
    pub fn formatted(&self) -> Option<String> {
        let (text, formatted) = match &self.notation {
            Notation::Mission(parse) => {
                let files = rmpl::files::split(parse.text());
                let formatted: Vec<(&str, String)> =
                    files.into_iter().map(|(name, text)| (name, rmpl::format(text))).collect();
                let files = formatted.iter().map(|(name, text)| (*name, text.as_str()));
                (parse.text(), rmpl::files::joined(files))
            }
            Notation::Control(_, text) => (&**text, rmpl::control::format(text)),
            // Its layout is its tool's.
            Notation::Network(_) => return None,
        };
        (formatted != text).then_some(formatted)
    }
}

/// Returns what planning found out, for hovering over the text.
pub fn evaluation(snapshot: &snapshot::Snapshot) -> Evaluation {
    let Some(network) = snapshot.network.as_deref() else { return Evaluation::default() };
    let invocations = network
        .occurrences
        .iter()
        .filter(|occurrence| occurrence.kind == OccurrenceKind::Activity)
        .filter_map(|occurrence| {
            let arc = network.arcs.get(occurrence.arc?.index())?;
            Some(Invocation {
                activity: occurrence.activity.clone(),
                occurrence: occurrence.name.clone(),
                lower: arc.lower,
                upper: arc.upper,
            })
        })
        .collect();
    let windows = snapshot.plan().map(|plan| windows(network, plan)).unwrap_or_default();
    Evaluation { invocations, windows }
}

fn windows(network: &tpn::Network, plan: &Plan) -> Vec<EventWindow> {
    let of_node = |(node, window): (&tpn::Node, &Option<tpn::Window>)| {
        let window = (*window)?;
        let events = node.events.iter().filter_map(|&event| {
            let span = network.occurrences.get(event.occurrence.index())?.span?;
            Some(EventWindow {
                span,
                event: network.event_name(event).into(),
                earliest: window.earliest,
                latest: window.latest,
            })
        });
        Some(events.collect::<Vec<_>>())
    };
    network.nodes.iter().zip(&plan.windows).filter_map(of_node).flatten().collect()
}

fn read(text: Arc<str>) -> Notation {
    if is_control_text(&text) {
        Notation::Control(Box::new(rmpl::control::parse(&text)), text)
    } else if is_network_text(&text) {
        Notation::Network(text)
    } else {
        Notation::Mission(Box::new(Parse::new(text)))
    }
}

/// Returns whether a mission's text may be in another notation since: only a large edit, or one of a short text, does
/// that.
fn may_change_notation(shift: Shift, text: &str) -> bool {
    let is_large = shift.inserted > LARGE_EDIT_BYTES
        || shift.removed > LARGE_EDIT_BYTES
        || text.len() < 4 * LARGE_EDIT_BYTES as usize;
    is_large && (is_control_text(text) || is_network_text(text))
}

const fn mission_role(kind: editor::HighlightKind) -> SyntaxRole {
    use editor::HighlightKind as Kind;
    match kind {
        Kind::Comment => SyntaxRole::Comment,
        Kind::Keyword | Kind::Option => SyntaxRole::Keyword,
        Kind::Activity | Kind::Scenario => SyntaxRole::Activity,
        Kind::Variable => SyntaxRole::Variable,
        Kind::Value => SyntaxRole::Value,
        Kind::Parameter | Kind::BoundName | Kind::Symbol => SyntaxRole::Parameter,
        Kind::Location | Kind::Vehicle => SyntaxRole::Place,
        Kind::Number => SyntaxRole::Number,
        Kind::String => SyntaxRole::String,
        Kind::Operator | Kind::Punctuation => SyntaxRole::Punctuation,
        Kind::Unknown => SyntaxRole::Unknown,
    }
}

const fn control_role(kind: rmpl::control::HighlightKind) -> SyntaxRole {
    use rmpl::control::HighlightKind as Kind;
    match kind {
        Kind::Keyword | Kind::Bar => SyntaxRole::Keyword,
        Kind::Definition => SyntaxRole::Activity,
        Kind::Variable => SyntaxRole::Variable,
        Kind::Value => SyntaxRole::Value,
        Kind::Punctuation => SyntaxRole::Punctuation,
        Kind::Comment => SyntaxRole::Comment,
    }
}
