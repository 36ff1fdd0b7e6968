//! Constraints over modes, variables and commands, compiled to value sets in negation normal form.

use crate::value_set::ValueSet;
use rmpl::control::{Constraint, ConstraintKind};
use serde::{Deserialize, Serialize};

/// A constraint over symbols: the modes of components, then plant variables, then command variables.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Formula {
    /// Always or never true.
    Constant(bool),
    /// The symbol's value is in the set.
    Member {
        /// Index of the symbol in the model.
        symbol: u32,
        set: ValueSet,
    },
    All(Vec<Formula>),
    /// At least one holds.
    Any(Vec<Formula>),
}

/// Truth under sets of values that the symbols may still have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Truth {
    True,
    False,
    Open,
}

impl Formula {
    /// The formula of a constraint, or of its opposite; `equality` gives that of a name and a value, or of its opposite.
    pub(crate) fn of(
        constraint: &Constraint,
        wanted: bool,
        equality: &dyn Fn(&str, &str, bool) -> Self,
    ) -> Self {
        let joined = |parts: &[Constraint], is_all: bool| {
            let parts = parts.iter().map(|part| Self::of(part, wanted, equality)).collect();
            if is_all == wanted { Self::All(parts) } else { Self::Any(parts) }
        };
        match &constraint.kind {
            ConstraintKind::True => Self::Constant(wanted),
            ConstraintKind::False | ConstraintKind::Parameter(_) | ConstraintKind::Unreadable => {
                Self::Constant(!wanted)
            }
            ConstraintKind::Not(inner) => Self::of(inner, !wanted, equality),
            ConstraintKind::And(parts) => joined(parts, true),
            ConstraintKind::Or(parts) => joined(parts, false),
            ConstraintKind::Equals { variable, value } => equality(&variable.text, &value.text, wanted),
        }
    }

    /// The opposite, where `full` gives all values of a symbol.
    pub(crate) fn negated(self, full: &impl Fn(u32) -> ValueSet) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(!value),
            Self::Member { symbol, set } => Self::Member { symbol, set: full(symbol) & !set },
            Self::All(parts) => Self::Any(parts.into_iter().map(|part| part.negated(full)).collect()),
            Self::Any(parts) => Self::All(parts.into_iter().map(|part| part.negated(full)).collect()),
        }
    }

    /// Returns what is left to hold when some symbols have these values, without parts that are decided or repeated.
    pub(crate) fn given(&self, value_of: &impl Fn(u32) -> Option<u8>) -> Self {
        let joined = |parts: &[Self], is_all: bool| {
            let mut left: Vec<Self> = Vec::with_capacity(parts.len());
            for part in parts {
                match part.given(value_of) {
                    Self::Constant(value) if value == is_all => {}
                    Self::Constant(value) => return Self::Constant(value),
                    Self::All(inner) if is_all => left.extend(inner),
                    Self::Any(inner) if !is_all => left.extend(inner),
                    other => left.push(other),
                }
            }
            left.sort_unstable();
            left.dedup();
            match (left.len(), is_all) {
                (0, value) => Self::Constant(value),
                (1, _) => left.swap_remove(0),
                (_, true) => Self::All(left),
                (_, false) => Self::Any(left),
            }
        };
        match self {
            Self::Constant(value) => Self::Constant(*value),
            Self::Member { symbol, set } => match value_of(*symbol) {
                Some(value) => Self::Constant(set.contains(value)),
                None => self.clone(),
            },
            Self::All(parts) => joined(parts, true),
            Self::Any(parts) => joined(parts, false),
        }
    }

    /// Truth when each symbol may have the values in `domains`; open also where only search could tell.
    pub(crate) fn truth(&self, domains: &[ValueSet]) -> Truth {
        let joined = |parts: &[Self], deciding: Truth, neutral: Truth| {
            let mut result = neutral;
            for part in parts {
                let truth = part.truth(domains);
                if truth == deciding {
                    return deciding;
                }
                if truth == Truth::Open {
                    result = Truth::Open;
                }
            }
            result
        };
        match self {
            Self::Constant(value) => {
                if *value {
                    Truth::True
                } else {
                    Truth::False
                }
            }
            Self::Member { symbol, set } => {
                let domain = domains.get(*symbol as usize).copied().unwrap_or_default();
                if (domain & *set).is_empty() {
                    Truth::False
                } else if (domain & !*set).is_empty() {
                    Truth::True
                } else {
                    Truth::Open
                }
            }
            Self::All(parts) => joined(parts, Truth::False, Truth::True),
            Self::Any(parts) => joined(parts, Truth::True, Truth::False),
        }
    }

    /// Calls `visit` with every symbol, as often as it occurs.
    pub(crate) fn symbols(&self, visit: &mut impl FnMut(u32)) {
        match self {
            Self::Constant(_) => {}
            Self::Member { symbol, .. } => visit(*symbol),
            Self::All(parts) | Self::Any(parts) => parts.iter().for_each(|part| part.symbols(visit)),
        }
    }

    /// All ways to satisfy it as conjunctions of memberships; `None` when there are more than `most`.
    pub(crate) fn alternatives(&self, most: usize) -> Option<Vec<Vec<(u32, ValueSet)>>> {
        match self {
            Self::Constant(true) => Some(vec![Vec::new()]),
            Self::Constant(false) => Some(Vec::new()),
            Self::Member { symbol, set } => Some(vec![vec![(*symbol, *set)]]),
            Self::Any(parts) => {
                let mut all = Vec::new();
                for part in parts {
                    all.extend(part.alternatives(most)?);
                }
                (all.len() <= most).then_some(all)
            }
            Self::All(parts) => {
                let mut all = vec![Vec::new()];
                for part in parts {
                    let inner = part.alternatives(most)?;
                    all = all
                        .iter()
                        .flat_map(|left| inner.iter().filter_map(|right| conjunction(left, right)))
                        .collect();
                    if all.len() > most {
                        return None;
                    }
                }
                Some(all)
            }
        }
    }
}

/// Both memberships at once; `None` when no value is left to a symbol.
pub(crate) fn conjunction(
    left: &[(u32, ValueSet)],
    right: &[(u32, ValueSet)],
) -> Option<Vec<(u32, ValueSet)>> {
    let mut both = left.to_vec();
    for &(symbol, set) in right {
        match both.iter_mut().find(|(known, _)| *known == symbol) {
            Some((_, known)) => {
                *known &= set;
                if known.is_empty() {
                    return None;
                }
            }
            None => both.push((symbol, set)),
        }
    }
    both.sort_unstable();
    Some(both)
}
