//! Whether a blank is between two tokens of a line.

use crate::syntax::{SyntaxKind, SyntaxToken};

/// What a token belongs to, as far as blanks depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Place {
    #[default]
    Plain,
    /// Inside `[ … ]`, which are written tightly.
    Bounds,
    /// An expression outside brackets, where a hyphen between letters belongs to a name.
    Expression,
    /// The `[` of bounds that stand apart from what they bound: `PATH1=OK [450,450]`.
    SpacedBounds,
    Condition,
    /// `visible(BASE)`, whose parentheses are those of a call.
    Sight,
    /// `(x, y)` of the world, which stands apart from the name before it.
    Coordinates,
    Domain,
    Argument,
}

/// Returns whether a blank is between `previous` and `token`, which is in `place`.
pub(super) fn has_space_between(previous: SyntaxToken<'_>, token: SyntaxToken<'_>, place: Place) -> bool {
    use SyntaxKind as Kind;
    match (previous.kind, token.kind) {
        (
            _,
            Kind::Comma
            | Kind::Semicolon
            | Kind::RightParen
            | Kind::RightBracket
            | Kind::Percent
            | Kind::Dot
            | Kind::DotDot,
        )
        | (Kind::LeftParen | Kind::LeftBracket | Kind::Bang | Kind::Dot | Kind::DotDot, _)
        | (Kind::LeftBrace, Kind::RightBrace)
        | (Kind::NotKeyword, Kind::LeftParen) => false,
        (_, Kind::LeftBracket) => place == Place::SpacedBounds,
        (_, Kind::LeftParen) => match place {
            Place::Coordinates | Place::Condition | Place::Expression => true,
            Place::Bounds => false,
            _ => previous.kind != Kind::Name,
        },
        // A unit of speed.
        (Kind::Slash, _) | (_, Kind::Slash) if place == Place::Coordinates => false,
        (Kind::RightBracket, _) => true,
        _ if place == Place::Bounds => false,
        // A unit of time.
        (Kind::Number, Kind::Name) if place == Place::Expression => false,
        (Kind::LeftBrace, _) | (_, Kind::RightBrace) => place != Place::Domain,
        (_, Kind::Equals | Kind::NotEquals) | (Kind::Equals | Kind::NotEquals, _) => {
            place != Place::Condition
        }
        (Kind::Minus, Kind::Number) => place == Place::Expression,
        _ => true,
    }
}
