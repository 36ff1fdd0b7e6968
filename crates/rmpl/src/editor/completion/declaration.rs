//! Places in the declarations that have no body, and in the clauses of primitives.

use super::place::{Place, in_set, innermost, is_sight, value_of};
use crate::parser::{CLAUSE_WORDS, CONTINGENT, PROPERTY_WORDS};
use crate::program::{Measure, Per};
use crate::syntax::{KEEPOUT, SyntaxKind, SyntaxToken};

/// Places in the declarations that have no body.
pub(super) fn in_declaration(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Option<Place> {
    let first = context.first()?;
    if first.text == "model"
        && first.kind == SyntaxKind::Name
        && context.get(1).is_none_or(|name| name.kind == SyntaxKind::Name)
    {
        return in_model(context, last);
    }
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
        (SyntaxKind::Name, "state") if is_constant => in_state(context, last),
        (SyntaxKind::Name, "resource") if is_constant => in_resource(context, last),
        (SyntaxKind::Name, "objective") if is_constant => in_objective(last),
        (SyntaxKind::Name, "vehicle") => match (last.kind, last.text) {
            (SyntaxKind::Colon, _) => Place::Model,
            (SyntaxKind::Name, "at") if names > 2 => Place::Location,
            (SyntaxKind::Name, _) if is_behind_colon(context) => Place::Words(vec!["at"]),
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "group") if is_constant => match last.kind {
            SyntaxKind::Equals | SyntaxKind::Comma => Place::Member,
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "const")
            if is_constant && context.iter().any(|token| token.kind == SyntaxKind::Equals) =>
        {
            Place::Bound
        }
        (SyntaxKind::Name, "constrain") if is_constant => in_constrain(context, last),
        (SyntaxKind::Name, "obstacle" | KEEPOUT) if names == 2 => Place::Shape,
        (SyntaxKind::Name, KEEPOUT) => match (last.kind, last.text) {
            (SyntaxKind::RightParen, _) => Place::Words(vec!["for"]),
            (SyntaxKind::Name, "for") | (SyntaxKind::Comma, _) if innermost(context).is_none() => {
                Place::ClosedTo
            }
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "terrain") => match last.kind {
            SyntaxKind::String => Place::Words(vec!["cell", "origin"]),
            SyntaxKind::Number => Place::Words(vec!["origin"]),
            _ => Place::Nothing,
        },
        (SyntaxKind::Name, "const") if is_constant => Place::Nothing,
        (SyntaxKind::Name, "obstacle" | "location") | (SyntaxKind::VarKeyword, _) => Place::Nothing,
        _ => return None,
    })
}

/// Returns whether the model of a vehicle has just been written.
fn is_behind_colon(context: &[SyntaxToken<'_>]) -> bool {
    context.len().checked_sub(2).and_then(|at| context.get(at)).is_some_and(|it| it.kind == SyntaxKind::Colon)
}

/// `model NAME extends PARENT { … }`; nothing after it.
fn in_model(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Option<Place> {
    let brace = context.iter().position(|token| token.kind == SyntaxKind::LeftBrace);
    let Some(brace) = brace else {
        return Some(match (context.len(), last.text) {
            (2, _) => Place::Words(vec!["extends"]),
            (3, "extends") => Place::Model,
            _ => Place::Nothing,
        });
    };
    innermost(context)?;
    let body = context.get(brace + 1..).unwrap_or_default();
    let begin = body.iter().rposition(|token| token.kind == SyntaxKind::Semicolon).map_or(0, |at| at + 1);
    let part = body.get(begin..).unwrap_or_default();
    Some(match part.first() {
        None => Place::Words([PROPERTY_WORDS.as_slice(), &["resource", "state"]].concat()),
        Some(first) if first.text == "state" => in_state(part, last),
        Some(first) if first.text == "resource" => in_resource(part, last),
        Some(first) if first.text == "slope" && last.kind == SyntaxKind::Number => {
            Place::Words(vec!["degrees", "rad"])
        }
        Some(first) if first.text == "body" && last.kind == SyntaxKind::Number && part.len() == 2 => {
            Place::Words(vec!["x"])
        }
        Some(_) => Place::Nothing,
    })
}

/// `constrain X.start to Y.end [l,u]`
fn in_constrain(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    match (innermost(context), last.kind, last.text) {
        (Some((SyntaxKind::LeftBracket, _)), ..) => Place::Bound,
        (_, SyntaxKind::Name, "constrain" | "to") => Place::Occurrence,
        (_, SyntaxKind::Name, "start" | "end") if !context.iter().any(|token| token.text == "to") => {
            Place::Words(vec!["to"])
        }
        _ => Place::Nothing,
    }
}

/// `state X : {A, B} = …`
fn in_state(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    match (last.kind, last.text) {
        (SyntaxKind::Name, "mode") if context.iter().any(|token| token.kind == SyntaxKind::Dot) => {
            return Place::Words(vec!["from plant"]);
        }
        (SyntaxKind::Equals, _) => {}
        _ => return Place::Nothing,
    }
    let domain = context.iter().skip_while(|token| token.kind != SyntaxKind::LeftBrace);
    let values = domain.filter(|token| token.kind == SyntaxKind::Name);
    Place::Values(values.map(|token| token.text.to_owned()).collect())
}

fn in_resource(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    match context.len() {
        1 => Place::Nothing,
        2 => Place::AmountOr(vec!["capacity"]),
        _ if is_operator(last.kind)
            || matches!(last.kind, SyntaxKind::DotDot | SyntaxKind::Equals | SyntaxKind::LeftParen)
            || last.text == "capacity" =>
        {
            Place::Amount
        }
        _ => Place::Nothing,
    }
}

fn in_objective(last: SyntaxToken<'_>) -> Place {
    match (last.kind, last.text) {
        (SyntaxKind::Comma, _) | (SyntaxKind::Name, "objective") => {
            Place::Words(vec!["minimize", "maximize"])
        }
        (SyntaxKind::Plus | SyntaxKind::Minus | SyntaxKind::Star, _)
        | (SyntaxKind::Name, "minimize" | "maximize") => {
            Place::Words(Measure::ALL.iter().map(|(word, _)| *word).collect())
        }
        _ => Place::Nothing,
    }
}

const fn is_operator(kind: SyntaxKind) -> bool {
    matches!(kind, SyntaxKind::Plus | SyntaxKind::Minus | SyntaxKind::Star | SyntaxKind::Slash)
}

fn in_primitive(context: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    let is_clause =
        |token: &SyntaxToken<'_>| token.kind == SyntaxKind::Name && CLAUSE_WORDS.contains(&token.text);
    let header = context.iter().take_while(|token| !is_clause(token)).count();
    let word = context.iter().enumerate().rfind(|(_, token)| is_clause(token)).map(|(at, _)| at);
    let Some(word) = word.filter(|_| header > 2) else {
        return match (innermost(context), last.kind) {
            (Some((SyntaxKind::LeftBracket, _)), _) => Place::Bound,
            (None, SyntaxKind::RightParen) => Place::Words([&[CONTINGENT], CLAUSE_WORDS.as_slice()].concat()),
            (None, SyntaxKind::RightBracket) => Place::Words(CLAUSE_WORDS.to_vec()),
            _ => Place::Nothing,
        };
    };
    let clause = context.get(word..).unwrap_or_default();
    match context.get(word).map_or("", |token| token.text) {
        "requires" => in_requires(clause, last),
        "sets" => match last.kind {
            SyntaxKind::Equals => value_of(clause, clause.len() - 1),
            SyntaxKind::Comma => Place::Effect,
            _ if clause.len() == 1 => Place::Effect,
            _ if clause.iter().any(|token| token.kind == SyntaxKind::Equals) => {
                Place::Words(CLAUSE_WORDS.to_vec())
            }
            _ => Place::Nothing,
        },
        "moves" => in_moves(clause, last),
        "aborts" | "runs" if clause.len() == 1 => Place::Nothing,
        "costs" | "rewards" => in_amount(clause, last),
        "aborts" | "runs" => Place::Words(CLAUSE_WORDS.to_vec()),
        _ if clause.len() == 1 || (last.kind == SyntaxKind::Comma && innermost(clause).is_none()) => {
            Place::Resource
        }
        _ => in_amount(clause.get(1..).unwrap_or_default(), last),
    }
}

/// Behind `requires`.
fn in_requires(clause: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    let words = |more: &[&'static str]| Place::Words([more, &CLAUSE_WORDS].concat());
    match (innermost(clause), last.kind, last.text) {
        (Some((SyntaxKind::LeftBrace, at)), ..) => in_set(clause, at).unwrap_or(Place::Nothing),
        (Some((SyntaxKind::LeftParen, at)), ..) if is_sight(clause, at) => Place::Location,
        (_, SyntaxKind::Equals | SyntaxKind::NotEquals, _) => value_of(clause, clause.len() - 1),
        (_, SyntaxKind::Order, _) => Place::Amount,
        (_, SyntaxKind::Name, "at") if compares_level(clause) => Place::Words(vec!["start"]),
        (_, SyntaxKind::Name | SyntaxKind::Number, _) if compares_level(clause) => {
            words(&["at start", "and"])
        }
        (_, SyntaxKind::Comma | SyntaxKind::NotKeyword | SyntaxKind::Bang | SyntaxKind::LeftParen, _) => {
            Place::Condition
        }
        _ if clause.len() == 1 => Place::Requirement,
        (_, SyntaxKind::Name, "start") if clause.len() == 3 => Place::Condition,
        (_, SyntaxKind::Name, "at") if clause.len() == 2 => words(&["start", "and", "in"]),
        (_, SyntaxKind::Name, "and") => Place::Condition,
        _ => words(&["and", "in"]),
    }
}

/// Returns whether the last condition of a clause compares a level, and its bound has started.
fn compares_level(clause: &[SyntaxToken<'_>]) -> bool {
    let condition =
        clause.iter().rev().take_while(|token| token.kind != SyntaxKind::Comma && token.text != "and");
    condition.skip(1).any(|token| token.kind == SyntaxKind::Order)
}

fn in_moves(clause: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    match last.kind {
        _ if innermost(clause).is_some() => Place::Nothing,
        SyntaxKind::Comma => Place::Vehicle,
        _ if clause.len() == 1 => Place::Vehicle,
        SyntaxKind::Name if last.text == "speed" => Place::Nothing,
        SyntaxKind::Name if last.text == "kinodynamic" => Place::Words(CLAUSE_WORDS.to_vec()),
        SyntaxKind::Name => Place::Words([&["speed", "kinodynamic"], CLAUSE_WORDS.as_slice()].concat()),
        _ => Place::Words([&["kinodynamic"], CLAUSE_WORDS.as_slice()].concat()),
    }
}

/// Returns where an amount stands or ends; `before` begins with what is before it.
fn in_amount(before: &[SyntaxToken<'_>], last: SyntaxToken<'_>) -> Place {
    let units: Vec<&'static str> = Per::ALL.iter().map(|(word, _)| *word).collect();
    if last.kind == SyntaxKind::Name && last.text == "per" && before.len() > 1 {
        return Place::Words(units);
    }
    let is_unit = units.contains(&last.text)
        && before.len().checked_sub(2).and_then(|at| before.get(at)).is_some_and(|it| it.text == "per");
    if is_unit {
        return Place::Words(CLAUSE_WORDS.to_vec());
    }
    let begins = before.len() == 1
        || before
            .len()
            .checked_sub(2)
            .and_then(|at| before.get(at))
            .is_some_and(|it| it.kind == SyntaxKind::Comma);
    if begins {
        return Place::AmountOr(CLAUSE_WORDS.to_vec());
    }
    if is_operator(last.kind) || last.kind == SyntaxKind::LeftParen {
        return Place::Amount;
    }
    Place::Words([&["per"], CLAUSE_WORDS.as_slice()].concat())
}
