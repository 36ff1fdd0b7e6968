//! Constraints over attributes and modes, simplified and written in the prefix notation.

use std::collections::BTreeSet;
use std::fmt;

use super::syntax::Enum;

/// What a constraint speaks of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Symbol {
    /// Names of parts and of the attribute, joined by points; empty for the mode of the component itself.
    pub(super) path: String,
    /// Whether it is the mode of the component at this path.
    pub(super) is_mode: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Formula<'file> {
    Constant(bool),
    Is { symbol: Symbol, value: String, domain: Domain<'file> },
    Same { left: Symbol, right: Symbol, domain: Domain<'file> },
    Not(Box<Self>),
    All(Vec<Self>),
    Any(Vec<Self>),
}

/// The type of an attribute, which is compared by its values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Domain<'file>(pub(super) &'file Enum);

impl PartialEq for Domain<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0) || {
            let values = |domain: &Self| domain.0.values.iter().cloned().collect::<BTreeSet<String>>();
            values(self) == values(other)
        }
    }
}

impl<'file> Formula<'file> {
    pub(super) fn implies(self, then: Self) -> Self {
        Self::Any(vec![Self::Not(Box::new(self)), then])
    }

    /// With the component itself in a mode.
    pub(super) fn in_mode(&self, mode: &str) -> Self {
        let is_own = |symbol: &Symbol| symbol.is_mode && symbol.path.is_empty();
        let is = |symbol: &Symbol, domain: Domain<'file>| Self::Is {
            symbol: symbol.clone(),
            value: mode.to_owned(),
            domain,
        };
        match self {
            Self::Is { symbol, value, .. } if is_own(symbol) => Self::Constant(value == mode),
            Self::Same { left, right, domain } if is_own(left) => is(right, *domain),
            Self::Same { left, right, domain } if is_own(right) => is(left, *domain),
            Self::Constant(_) | Self::Is { .. } | Self::Same { .. } => self.clone(),
            Self::Not(inner) => Self::Not(Box::new(inner.in_mode(mode))),
            Self::All(parts) => Self::All(parts.iter().map(|part| part.in_mode(mode)).collect()),
            Self::Any(parts) => Self::Any(parts.iter().map(|part| part.in_mode(mode)).collect()),
        }
    }

    /// Without constants inside, and without what is said twice.
    pub(super) fn simplified(self) -> Self {
        match self {
            Self::Same { left, right, .. } if left == right => Self::Constant(true),
            Self::Constant(_) | Self::Is { .. } | Self::Same { .. } => self,
            Self::Not(inner) => inner.simplified().negated(),
            Self::All(parts) => Self::joined(parts, true),
            Self::Any(parts) => Self::joined(parts, false),
        }
    }

    fn joined(parts: Vec<Self>, is_all: bool) -> Self {
        let mut kept: Vec<Self> = Vec::new();
        for part in parts {
            let inner = match part.simplified() {
                Self::Constant(constant) if constant == is_all => continue,
                Self::Constant(_) => return Self::Constant(!is_all),
                Self::All(inner) if is_all => inner,
                Self::Any(inner) if !is_all => inner,
                other => vec![other],
            };
            for part in inner {
                if !kept.contains(&part) {
                    kept.push(part);
                }
            }
        }
        match (kept.len(), is_all) {
            (0, _) => Self::Constant(is_all),
            (1, _) => kept.swap_remove(0),
            (_, true) => Self::All(kept),
            (_, false) => Self::Any(kept),
        }
    }

    /// The opposite of a simplified constraint.
    fn negated(self) -> Self {
        match self {
            Self::Constant(constant) => Self::Constant(!constant),
            Self::Not(inner) => *inner,
            Self::Is { symbol, value, domain } => match &*domain.0.values {
                [one, other] | [other, one] if *one == value => {
                    Self::Is { symbol, value: other.clone(), domain }
                }
                _ => Self::Not(Box::new(Self::Is { symbol, value, domain })),
            },
            other => Self::Not(Box::new(other)),
        }
    }

    /// Calls `visit` with each symbol.
    pub(super) fn symbols(&self, visit: &mut dyn FnMut(&Symbol)) {
        match self {
            Self::Constant(_) => {}
            Self::Is { symbol, .. } => visit(symbol),
            Self::Same { left, right, .. } => {
                visit(left);
                visit(right);
            }
            Self::Not(inner) => inner.symbols(visit),
            Self::All(parts) | Self::Any(parts) => parts.iter().for_each(|part| part.symbols(visit)),
        }
    }

    pub(super) fn speaks_of_own_mode(&self) -> bool {
        let mut found = false;
        self.symbols(&mut |symbol| found |= symbol.is_mode && symbol.path.is_empty());
        found
    }
}

impl fmt::Display for Formula<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |f: &mut fmt::Formatter<'_>, parts: &[Self], word: &str| {
            f.write_str("(")?;
            for (at, part) in parts.iter().enumerate() {
                let between = if at > 0 { format!(" {word} ") } else { String::new() };
                write!(f, "{between}{part}")?;
            }
            f.write_str(")")
        };
        match self {
            Self::Constant(constant) => write!(f, "{constant}"),
            Self::Is { symbol, value, .. } => write!(f, "({} = {})", names(&symbol.path), name(value)),
            Self::Same { left, right, .. } => write!(f, "({} = {})", names(&left.path), names(&right.path)),
            Self::Not(inner) => write!(f, "(NOT {inner})"),
            Self::All(parts) => joined(f, parts, "AND"),
            Self::Any(parts) => joined(f, parts, "OR"),
        }
    }
}

/// A name as the prefix notation can have it.
pub(super) fn name(text: &str) -> String {
    let text = text.replace('$', "_");
    let is_word = ["true", "false", "and", "or", "not", "self"].contains(&text.to_ascii_lowercase().as_str());
    if is_word { format!("{text}_") } else { text }
}

fn names(path: &str) -> String {
    path.split('.').map(name).collect::<Vec<_>>().join(".")
}
