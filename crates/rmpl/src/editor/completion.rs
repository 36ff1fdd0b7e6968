//! Completion that knows the place: what can stand at the cursor, and nothing else.

use rustc_hash::FxHashSet;

use crate::analysis::Symbol;
use crate::analysis::local::VEHICLE_MODELS;
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

use super::cursor::declaration_at_cursor;
use super::name::{NameKind, names_in};
use super::outline::{OutlineItem, OutlineKind, outline};

/// What can be written at the cursor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// What an item replaces: the word that is being typed.
    pub replaces: Span,
    /// The items that begin with what is typed (or contain it), best first.
    pub items: Vec<CompletionItem>,
}

/// One thing that can be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompletionItem {
    /// What the list shows.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// More about it, in a few words.
    pub detail: String,
    /// What is written; `$0` marks where the cursor goes, if not behind it.
    pub insert: String,
}

/// What an item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CompletionKind {
    /// A word of the language, or a piece of its grammar.
    Keyword,
    /// An activity with a definition.
    Activity,
    /// A primitive.
    Primitive,
    /// A state variable or an atom.
    Variable,
    /// A value of a variable.
    Value,
    /// A parameter.
    Parameter,
    /// A name of the header's bounds.
    BoundName,
    /// A constant.
    Constant,
    /// A location.
    Location,
    /// A vehicle or a model.
    Vehicle,
    /// An option or its value.
    Option,
}

/// The place of the cursor, as far as it decides what can follow.
enum Place {
    /// Between declarations.
    File,
    Statement,
    Condition,
    Value(String),
    Bound,
    Argument,
    Vehicle,
    Location,
    Model,
    Option,
    OptionValue(String),
    Shape,
    /// One of these words.
    Words(&'static [&'static str]),
    /// A new name, or nothing that is known.
    Nothing,
}

/// What can be written at `offset`.
pub fn complete(parse: &Parse, offset: u32) -> Completion {
    let around = parse.declaration_at(offset.saturating_sub(1));
    let written =
        declaration_at_cursor(parse, offset).filter(|root| Some(root.span()) != around.map(SyntaxNode::span));
    let before: Vec<SyntaxToken<'_>> = written
        .into_iter()
        .chain(around)
        .flat_map(SyntaxNode::tokens)
        .filter(|token| token.span.start < offset)
        .collect();
    if before.last().is_some_and(|token| is_opaque(*token, offset)) {
        return Completion { replaces: Span::new(offset, offset), items: Vec::new() };
    }
    let typed = before.last().filter(|token| token.span.end >= offset && is_word(token.kind));
    let replaces = typed.map_or(Span::new(offset, offset), |token| token.span);
    let prefix =
        typed.map_or("", |token| token.text.get(..(offset - token.span.start) as usize).unwrap_or(""));
    let context: Vec<SyntaxToken<'_>> = before
        .iter()
        .filter(|token| !token.kind.is_trivia() && token.span.start < replaces.start)
        .copied()
        .collect();
    let mut items = items(parse, offset, &place(&context));
    let rank = |item: &CompletionItem| rank(&item.label, prefix);
    items.retain(|item| rank(item).is_some());
    items.sort_by(|one, other| {
        (rank(one), one.kind as u8 == CompletionKind::Keyword as u8, &one.label).cmp(&(
            rank(other),
            other.kind as u8 == CompletionKind::Keyword as u8,
            &other.label,
        ))
    });
    items.dedup_by(|one, other| one.label == other.label);
    Completion { replaces, items }
}

/// Whether the cursor is in a comment, a text in quotes or a number, where nothing is completed.
fn is_opaque(token: SyntaxToken<'_>, offset: u32) -> bool {
    match token.kind {
        SyntaxKind::LineComment | SyntaxKind::String | SyntaxKind::Number => token.span.end >= offset,
        SyntaxKind::BlockComment => token.span.end > offset || !token.text.ends_with("*/"),
        _ => false,
    }
}

const fn is_word(kind: SyntaxKind) -> bool {
    matches!(kind, SyntaxKind::Name | SyntaxKind::Infinity) || kind.is_keyword()
}

/// 0 for a beginning, 1 for a beginning in other case, 2 for a part; none if `label` does not fit what is typed.
fn rank(label: &str, prefix: &str) -> Option<u8> {
    let (lower_label, lower_prefix) = (label.to_ascii_lowercase(), prefix.to_ascii_lowercase());
    if label.starts_with(prefix) {
        Some(0)
    } else if lower_label.starts_with(&lower_prefix) {
        Some(1)
    } else {
        lower_label.contains(&lower_prefix).then_some(2)
    }
}

/// What the tokens before the cursor say about the place. Reads backwards to what decides; needs no sound tree.
fn place(context: &[SyntaxToken<'_>]) -> Place {
    use SyntaxKind as Kind;
    let Some(last) = context.last() else { return Place::File };
    let before = |back: usize| context.len().checked_sub(back + 1).and_then(|at| context.get(at));
    if let Some(place) = in_declaration(context, *last) {
        return place;
    }
    match innermost(context) {
        Some((Kind::LeftBracket, _)) => return Place::Bound,
        Some((Kind::LeftParen, at)) => {
            let owner = at.checked_sub(1).and_then(|at| context.get(at)).map(|token| token.kind);
            if owner == Some(Kind::Name) {
                return Place::Argument;
            }
        }
        Some((Kind::LeftBrace, at)) => {
            if let Some(variable) = variable_of_set(context, at) {
                return Place::Value(variable.to_owned());
            }
        }
        _ if !matches!(last.kind, Kind::Semicolon | Kind::RightBrace) => return Place::Nothing,
        _ => return Place::File,
    }
    if let Some(place) = behind_word(context, *last) {
        return place;
    }
    match last.kind {
        Kind::Equals | Kind::NotEquals => {
            Place::Value(before(1).map_or(String::new(), |name| name.text.to_owned()))
        }
        Kind::MaintainingKeyword
        | Kind::WatchingKeyword
        | Kind::IfKeyword
        | Kind::TellKeyword
        | Kind::AskKeyword
        | Kind::NotKeyword
        | Kind::Bang
        | Kind::LeftParen => Place::Condition,
        Kind::LeftBrace | Kind::Semicolon | Kind::Comma | Kind::DoKeyword | Kind::ThennextKeyword => {
            Place::Statement
        }
        Kind::ChooseKeyword => Place::Nothing,
        _ => after_statement(context),
    }
}

/// X of `X in {`, where the brace stands at `at`.
fn variable_of_set<'a>(context: &[SyntaxToken<'a>], at: usize) -> Option<&'a str> {
    let [variable, word] = context.get(at.checked_sub(2)?..at)? else { return None };
    let is_set = variable.kind == SyntaxKind::Name && word.kind == SyntaxKind::Name && word.text == "in";
    is_set.then_some(variable.text)
}

/// Behind a word that is one of the language only in its place, and stands there.
fn behind_word(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Option<Place> {
    use SyntaxKind as Kind;
    if last.kind != Kind::Name {
        return None;
    }
    let before = context.get(context.len().checked_sub(2)?)?.kind;
    let begins_statement = matches!(
        before,
        Kind::LeftBrace | Kind::Semicolon | Kind::Comma | Kind::DoKeyword | Kind::ThennextKeyword
    );
    let ends = matches!(
        before,
        Kind::Name
            | Kind::Number
            | Kind::RightParen
            | Kind::RightBracket
            | Kind::RightBrace
            | Kind::DelayKeyword
    );
    match last.text {
        "repeat" if begins_statement => Some(Place::Bound),
        "free" if begins_statement => Some(Place::Statement),
        "else" if ends => Some(Place::Statement),
        "and" | "or" if ends => Some(Place::Condition),
        _ => None,
    }
}

/// Behind a whole statement or condition: the words that may go on.
fn after_statement(context: &[SyntaxToken<'_>]) -> Place {
    let mut depth = 0_i32;
    for token in context.iter().rev() {
        match token.kind {
            SyntaxKind::RightBrace => depth += 1,
            SyntaxKind::LeftBrace => {
                depth -= 1;
                if depth < 0 {
                    break;
                }
            }
            SyntaxKind::Semicolon | SyntaxKind::Comma if depth == 0 && !in_round(context, *token) => break,
            SyntaxKind::DoKeyword if depth == 0 => return Place::Words(&["maintaining", "watching"]),
            SyntaxKind::IfKeyword if depth == 0 => return Place::Words(&["thennext", "and", "or", "in"]),
            SyntaxKind::MaintainingKeyword | SyntaxKind::WatchingKeyword if depth == 0 => {
                return Place::Words(&["and", "or", "in"]);
            }
            SyntaxKind::ThennextKeyword if depth == 0 => return Place::Words(&["else"]),
            _ => {}
        }
    }
    Place::Nothing
}

/// Whether `token` stands in parentheses or square brackets.
fn in_round(context: &[SyntaxToken<'_>], token: SyntaxToken<'_>) -> bool {
    let until: Vec<SyntaxToken<'_>> =
        context.iter().take_while(|other| other.span.start < token.span.start).copied().collect();
    innermost(&until).is_some_and(|(kind, _)| kind != SyntaxKind::LeftBrace)
}

/// The innermost bracket that is open at the end, and its index.
fn innermost(context: &[SyntaxToken<'_>]) -> Option<(SyntaxKind, usize)> {
    let mut open: Vec<(SyntaxKind, usize)> = Vec::new();
    for (at, token) in context.iter().enumerate() {
        match token.kind {
            SyntaxKind::LeftBrace | SyntaxKind::LeftBracket | SyntaxKind::LeftParen => {
                open.push((token.kind, at));
            }
            SyntaxKind::RightBrace | SyntaxKind::RightBracket | SyntaxKind::RightParen => {
                open.pop();
            }
            SyntaxKind::Semicolon => open.retain(|(kind, _)| *kind == SyntaxKind::LeftBrace),
            _ => {}
        }
    }
    open.last().copied()
}

/// Places in the declarations that have no body.
fn in_declaration(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Option<Place> {
    let first = context.first()?;
    let is_open = !context.iter().any(|token| matches!(token.kind, SyntaxKind::Semicolon));
    if !is_open {
        return None;
    }
    let names = context.iter().filter(|token| token.kind == SyntaxKind::Name).count();
    let is_constant = context.get(1).is_none_or(|second| second.kind == SyntaxKind::Name);
    Some(match (first.kind, first.text) {
        (SyntaxKind::OptionKeyword, _) => match last.kind {
            SyntaxKind::OptionKeyword => Place::Option,
            SyntaxKind::Equals => {
                Place::OptionValue(context.get(1).map_or(String::new(), |name| name.text.to_owned()))
            }
            _ => Place::Nothing,
        },
        (SyntaxKind::PrimitiveKeyword, _) => in_primitive(context, last),
        (SyntaxKind::Name, "vehicle") => match (last.kind, last.text) {
            (SyntaxKind::Colon, _) => Place::Model,
            (SyntaxKind::Name, "at") if names > 2 => Place::Location,
            (SyntaxKind::Name, _) if names == 3 => Place::Words(&["at"]),
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "const")
            if is_constant && context.iter().any(|token| token.kind == SyntaxKind::Equals) =>
        {
            Place::Bound
        }
        (SyntaxKind::Name, "obstacle") if names == 2 => Place::Shape,
        (SyntaxKind::Name, "terrain") => match last.kind {
            SyntaxKind::String => Place::Words(&["cell", "origin"]),
            SyntaxKind::Number => Place::Words(&["origin"]),
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "const") if is_constant => Place::Nothing,
        (SyntaxKind::Name, "obstacle" | "location") | (SyntaxKind::VarKeyword, _) => Place::Nothing,
        _ => return None,
    })
}

fn in_primitive(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    if let Some((kind, _)) = innermost(context) {
        return if kind == SyntaxKind::LeftBracket { Place::Bound } else { Place::Nothing };
    }
    let moves = context.iter().any(|token| token.text == "moves");
    match (last.kind, last.text) {
        (SyntaxKind::Name, "moves") => Place::Vehicle,
        (SyntaxKind::Comma, _) if moves => Place::Vehicle,
        (SyntaxKind::Name, "runs") => Place::Nothing,
        (SyntaxKind::Name, _) if moves => Place::Words(&["speed", "runs"]),
        (SyntaxKind::RightParen | SyntaxKind::RightBracket, _) => {
            if moves {
                Place::Words(&["runs"])
            } else {
                Place::Words(&["moves", "runs"])
            }
        }
        _ => Place::Nothing,
    }
}

fn items(parse: &Parse, offset: u32, place: &Place) -> Vec<CompletionItem> {
    let mut items = Vec::new();
    match place {
        Place::File => items.extend(DECLARATIONS.iter().map(|(label, insert)| keyword(label, insert))),
        Place::Statement => {
            items.extend(STATEMENTS.iter().map(|(label, insert)| keyword(label, insert)));
            calls(parse, &mut items);
            conditions(parse, offset, &mut items);
        }
        Place::Condition => {
            items.push(keyword("not", "not($0)"));
            conditions(parse, offset, &mut items);
        }
        Place::Value(variable) => values(parse, variable, &mut items),
        Place::Bound => {
            items.push(keyword("inf", "inf"));
            local_names(parse, offset, &NameKind::BoundName, CompletionKind::BoundName, &mut items);
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Constant, CompletionKind::Constant, &mut items);
        }
        Place::Argument => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Location, CompletionKind::Location, &mut items);
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
            declared(parse, OutlineKind::Constant, CompletionKind::Constant, &mut items);
            declared(parse, OutlineKind::Variable, CompletionKind::Variable, &mut items);
        }
        Place::Vehicle => {
            local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, &mut items);
            declared(parse, OutlineKind::Vehicle, CompletionKind::Vehicle, &mut items);
        }
        Place::Location => declared(parse, OutlineKind::Location, CompletionKind::Location, &mut items),
        Place::Model => {
            items.extend(VEHICLE_MODELS.iter().map(|model| plain(model, CompletionKind::Vehicle)));
        }
        Place::Option => {
            let options = [
                ("threat_gap", "threat_gap = 1;"),
                ("strict", "strict = 1;"),
                ("time_unit", "time_unit = second;"),
                ("control_step", "control_step = 1;"),
            ];
            items.extend(options.map(|(label, insert)| CompletionItem {
                kind: CompletionKind::Option,
                ..keyword(label, insert)
            }));
        }
        Place::OptionValue(option) => {
            let values: &[&str] = match option.as_str() {
                "time_unit" => &["minute", "second"],
                "strict" => &["0", "1"],
                _ => &["1"],
            };
            items.extend(values.iter().map(|value| plain(value, CompletionKind::Option)));
        }
        Place::Shape => {
            items.push(keyword("circle", "circle ($0);"));
            items.push(keyword("polygon", "polygon ($0);"));
        }
        Place::Words(words) => items.extend(words.iter().map(|word| keyword(word, word))),
        Place::Nothing => {}
    }
    items
}

const DECLARATIONS: [(&str, &str); 9] = [
    ("const", "const $0 = ;"),
    ("var", "var $0 : {};"),
    ("primitive", "primitive $0();"),
    ("scenario", "scenario $0 = {\n}"),
    ("option", "option $0;"),
    ("terrain", "terrain \"$0\";"),
    ("location", "location $0 (0, 0);"),
    ("obstacle", "obstacle $0 circle (0, 0, 1);"),
    ("vehicle", "vehicle $0 : ATRV at BASE;"),
];

const STATEMENTS: [(&str, &str); 11] = [
    ("repeat", "repeat $0 { }"),
    ("free", "free "),
    ("if … thennext … else", "if $0 thennext  else "),
    ("choose", "choose { $0 }"),
    ("do … maintaining", "do { $0 } maintaining "),
    ("do … watching", "do { $0 } watching "),
    ("if … thennext", "if $0 thennext "),
    ("delay", "delay[$0,inf]"),
    ("tell", "tell "),
    ("ask", "ask "),
    ("not", "not($0)"),
];

fn keyword(label: &str, insert: &str) -> CompletionItem {
    CompletionItem {
        label: label.to_owned(),
        kind: CompletionKind::Keyword,
        detail: String::new(),
        insert: insert.to_owned(),
    }
}

fn plain(label: &str, kind: CompletionKind) -> CompletionItem {
    CompletionItem { kind, ..keyword(label, label) }
}

/// Activities and primitives, with parentheses and the cursor at their first argument.
fn calls(parse: &Parse, items: &mut Vec<CompletionItem>) {
    for OutlineItem { kind, name, detail, .. } in outline(parse) {
        let kind = match kind {
            OutlineKind::Primitive => CompletionKind::Primitive,
            OutlineKind::Activity => CompletionKind::Activity,
            _ => continue,
        };
        let insert = if detail.starts_with("()") || !detail.starts_with('(') {
            format!("{name}()")
        } else {
            format!("{name}($0)")
        };
        items.push(CompletionItem { label: name, kind, detail, insert });
    }
}

/// Declared variables, parameters, and the conditions that the file speaks of.
fn conditions(parse: &Parse, offset: u32, items: &mut Vec<CompletionItem>) {
    local_names(parse, offset, &NameKind::Parameter, CompletionKind::Parameter, items);
    for OutlineItem { kind, name, detail, .. } in outline(parse) {
        if kind == OutlineKind::Variable {
            let insert = format!("{name}=");
            let detail = detail.trim_start_matches([':', ' ']).to_owned();
            items.push(CompletionItem { label: name, kind: CompletionKind::Variable, detail, insert });
        }
    }
    let mut known: FxHashSet<String> = items.iter().map(|item| item.label.clone()).collect();
    for (_, summary) in parse.summaries() {
        // A name alone may be the very word that is being typed.
        for literal in
            summary.literals.iter().filter(|literal| !literal.variable_is_formal && !literal.is_bare)
        {
            let name = parse.meaning().names.text(literal.variable);
            if known.insert(name.to_string()) {
                let insert = if literal.values.is_empty() { name.to_string() } else { format!("{name}=") };
                items.push(CompletionItem {
                    label: name.to_string(),
                    kind: CompletionKind::Variable,
                    detail: String::new(),
                    insert,
                });
            }
        }
    }
}

/// The domain of a variable; for an undeclared one, the values that the file compares it with.
fn values(parse: &Parse, variable: &str, items: &mut Vec<CompletionItem>) {
    let meaning = parse.meaning();
    let Some(symbol) = meaning.names.find(variable) else { return };
    if let Some(domain) = meaning.domain(symbol) {
        items.extend(domain.iter().map(|value| plain(meaning.names.text(*value), CompletionKind::Value)));
        return;
    }
    let mut known: FxHashSet<Symbol> = FxHashSet::default();
    for (_, summary) in parse.summaries() {
        let own = summary.literals.iter().filter(|literal| literal.variable == symbol);
        for (value, _) in own.flat_map(|literal| &literal.values) {
            let text = meaning.names.text(*value);
            if known.insert(*value) {
                items.push(plain(text, CompletionKind::Value));
            }
        }
    }
}

fn local_names(
    parse: &Parse,
    offset: u32,
    wanted: &NameKind,
    kind: CompletionKind,
    items: &mut Vec<CompletionItem>,
) {
    let root = declaration_at_cursor(parse, offset);
    let names = root.map(|root| names_in(parse, root)).unwrap_or_default();
    let defined = names.into_iter().filter(|name| name.is_definition && name.kind == *wanted);
    items.extend(defined.map(|name| plain(&name.text, kind)));
}

fn declared(parse: &Parse, wanted: OutlineKind, kind: CompletionKind, items: &mut Vec<CompletionItem>) {
    let found = outline(parse).into_iter().filter(|item| item.kind == wanted);
    items.extend(found.map(|item| CompletionItem { detail: item.detail, ..plain(&item.name, kind) }));
}
