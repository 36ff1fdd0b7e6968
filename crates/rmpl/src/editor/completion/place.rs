//! What the tokens before the cursor say about the place.

use super::declaration::in_declaration;
use crate::parser::CONTINGENT;
use crate::syntax::{SyntaxKind, SyntaxToken};

/// The place of the cursor, as far as it decides what can follow.
pub(super) enum Place {
    /// Between declarations.
    File,
    Statement,
    Condition,
    /// Behind `requires`.
    Requirement,
    /// What an activity may set.
    Effect,
    /// The value of this variable.
    Value(String),
    /// One of these values.
    Values(Vec<String>),
    /// What `as` names.
    Occurrence,
    Resource,
    /// How much of something.
    Amount,
    /// The same, or one of these words.
    AmountOr(Vec<&'static str>),
    Bound,
    Argument,
    Vehicle,
    Location,
    /// Behind `V.at in`.
    SetOfLocations,
    Model,
    /// Behind the dot of this vehicle.
    BehindDot(String),
    /// Behind `any x in`.
    Group,
    /// Behind `group G =`.
    Member,
    /// Behind the colon of a parameter.
    Kind,
    Option,
    OptionValue(String),
    Shape,
    /// Whom a keep-out area is closed to.
    ClosedTo,
    /// One of these words.
    Words(Vec<&'static str>),
    /// A new name, or nothing that is known.
    Nothing,
}

/// Returns what the tokens before the cursor say about the place. Reads backwards to what decides; needs no sound tree.
pub(super) fn place(context: &[SyntaxToken<'_>]) -> Place {
    use SyntaxKind as Kind;
    let Some(last) = context.last() else { return Place::File };
    if last.kind == Kind::Dot {
        let is_event = context.first().is_some_and(|first| first.text == "constrain");
        let is_state = context.first().is_some_and(|first| first.text == "state") && context.len() == 3;
        let owner = context.len().checked_sub(2).and_then(|at| context.get(at));
        return match (is_event, is_state) {
            (true, _) => Place::Words(vec!["start", "end"]),
            (_, true) => Place::Words(vec!["mode"]),
            _ => Place::BehindDot(owner.map_or(String::new(), |owner| owner.text.to_owned())),
        };
    }
    if let Some(place) = behind_place_in(context) {
        return place;
    }
    if last.kind == Kind::Colon && innermost(context).is_some_and(|(kind, _)| kind == Kind::LeftParen) {
        return Place::Kind;
    }
    if is_behind_members(context) {
        return Place::Group;
    }
    if let Some(place) = in_declaration(context, *last) {
        return place;
    }
    match innermost(context) {
        Some((Kind::LeftBracket, _)) => return Place::Bound,
        Some((Kind::LeftParen, at)) => {
            let owner = at.checked_sub(1).and_then(|at| context.get(at));
            if is_sight(context, at) {
                return Place::Location;
            }
            if owner.is_some_and(|owner| owner.kind == Kind::Name) {
                return Place::Argument;
            }
        }
        Some((Kind::LeftBrace, at)) => {
            if let Some(place) = in_set(context, at) {
                return place;
            }
        }
        _ if !matches!(last.kind, Kind::Semicolon | Kind::RightBrace) => return Place::Nothing,
        _ => return Place::File,
    }
    if let Some(place) = behind_word(context, *last) {
        return place;
    }
    match last.kind {
        Kind::Equals | Kind::NotEquals => value_of(context, context.len() - 1),
        Kind::Order => Place::Amount,
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

/// The values of the X of `X in {`, where the brace is at `at`.
pub(super) fn in_set(context: &[SyntaxToken<'_>], at: usize) -> Option<Place> {
    let word = context.get(at.checked_sub(1)?)?;
    let is_set = word.kind == SyntaxKind::Name && word.text == "in";
    is_set.then(|| value_of(context, at - 1))
}

/// Returns whether `(` at this index follows `in visible`.
pub(super) fn is_sight(context: &[SyntaxToken<'_>], at: usize) -> bool {
    let is_word = |back: usize, word: &str| {
        at.checked_sub(back).and_then(|at| context.get(at)).is_some_and(|token| token.text == word)
    };
    is_word(1, "visible") && is_word(2, "in")
}

/// The set of which the place of a vehicle is one, if the tokens end with `V.at in`.
pub(super) fn behind_place_in(context: &[SyntaxToken<'_>]) -> Option<Place> {
    let from_end = |back: usize| context.len().checked_sub(back).and_then(|at| context.get(at));
    let is_in = from_end(1)?.text == "in" && from_end(2)?.text == "at";
    (is_in && from_end(3)?.kind == SyntaxKind::Dot).then_some(Place::SetOfLocations)
}

/// Returns whether the tokens end with `any x in` or `each x in`.
fn is_behind_members(context: &[SyntaxToken<'_>]) -> bool {
    let from_end = |back: usize| context.len().checked_sub(back).and_then(|at| context.get(at));
    let is_in = from_end(1).is_some_and(|last| last.text == "in" && last.kind == SyntaxKind::Name);
    is_in && from_end(3).is_some_and(|word| matches!(word.text, "any" | "each"))
}

/// The values of the variable before `at`; those of `V.at` are the locations, those of `C.mode` the component's modes.
pub(super) fn value_of(context: &[SyntaxToken<'_>], at: usize) -> Place {
    let before = |back: usize| at.checked_sub(back).and_then(|at| context.get(at));
    if before(2).is_some_and(|token| token.kind == SyntaxKind::Dot) {
        return match (before(3), before(1)) {
            (Some(owner), Some(part)) if part.text != "at" => {
                Place::Value(format!("{}.{}", owner.text, part.text))
            }
            _ => Place::Location,
        };
    }
    Place::Value(before(1).map_or(String::new(), |name| name.text.to_owned()))
}

/// Behind a word that is one of the language only in its place, and is there.
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
        "free" | "optional" if begins_statement => Some(Place::Statement),
        "using" if ends => Some(Place::Resource),
        "as" if ends => Some(Place::Nothing),
        "else" if ends => Some(Place::Statement),
        "and" | "or" if ends => Some(Place::Condition),
        _ => None,
    }
}

/// Behind a whole statement or condition: the words that may continue.
fn after_statement(context: &[SyntaxToken<'_>]) -> Place {
    // Bounds follow a call, a condition or a delay that has none yet.
    let may_be_natures = context.last().is_some_and(|last| match last.kind {
        SyntaxKind::RightParen | SyntaxKind::Number | SyntaxKind::DelayKeyword => true,
        SyntaxKind::Name => last.text != CONTINGENT,
        _ => false,
    });
    let with_bounds = |words: &[&'static str]| {
        let bounds = may_be_natures.then_some(CONTINGENT);
        words.iter().copied().chain(bounds).collect::<Vec<_>>()
    };
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
            SyntaxKind::DoKeyword if depth == 0 => {
                return Place::Words(with_bounds(&["maintaining", "watching", "using"]));
            }
            SyntaxKind::IfKeyword if depth == 0 => return Place::Words(vec!["thennext", "and", "or", "in"]),
            SyntaxKind::MaintainingKeyword | SyntaxKind::WatchingKeyword if depth == 0 => {
                return Place::Words(vec!["and", "or", "in"]);
            }
            SyntaxKind::ThennextKeyword if depth == 0 => return Place::Words(with_bounds(&["else"])),
            _ => {}
        }
    }
    if may_be_natures { Place::Words(with_bounds(&["as"])) } else { Place::Words(vec!["as"]) }
}

/// Returns whether `token` is in parentheses or square brackets.
fn in_round(context: &[SyntaxToken<'_>], token: SyntaxToken<'_>) -> bool {
    let until: Vec<SyntaxToken<'_>> =
        context.iter().take_while(|other| other.span.start < token.span.start).copied().collect();
    innermost(&until).is_some_and(|(kind, _)| kind != SyntaxKind::LeftBrace)
}

/// The innermost bracket that is open at the end, and its index.
pub(super) fn innermost(context: &[SyntaxToken<'_>]) -> Option<(SyntaxKind, usize)> {
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
