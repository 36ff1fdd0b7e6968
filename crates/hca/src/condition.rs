//! Constraints compiled for asking many times whether partial knowledge entails them (SPEC 8.3).

use serde::{Deserialize, Serialize};

use crate::knowledge::UNKNOWN;
use crate::vocabulary::Variable;

/// A constraint in negation normal form over value sets, stored flat; its root is the last node.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Condition {
    nodes: Vec<Node>,
    /// Sets of values too large for one word.
    wide: Vec<u64>,
    /// Whether each variable occurs once; then three-valued evaluation is exact.
    read_once: bool,
    variables: Vec<u32>,
}

/// A part of a condition; children come before their parent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Node {
    Constant(bool),
    /// The variable's value is one of the set's.
    Member {
        variable: u32,
        set: u64,
    },
    /// The same with a set of more than 64 values, at this place in `wide`.
    WideMember {
        variable: u32,
        at: u32,
    },
    And(Vec<u32>),
    Or(Vec<u32>),
}

/// A constraint as trees, before it is laid out flat.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Formula {
    Constant(bool),
    /// A variable and, for each of its value numbers, whether it satisfies.
    Member(u32, Vec<bool>),
    And(Vec<Formula>),
    Or(Vec<Formula>),
}

impl Formula {
    pub(crate) fn negated(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(!value),
            Self::Member(variable, set) => {
                Self::Member(variable, set.into_iter().map(|value| !value).collect())
            }
            Self::And(parts) => Self::Or(parts.into_iter().map(Self::negated).collect()),
            Self::Or(parts) => Self::And(parts.into_iter().map(Self::negated).collect()),
        }
    }

    /// The same with memberships of one variable beside each other merged, and constants worked in.
    fn simplified(self) -> Self {
        let (parts, all) = match self {
            Self::Member(_, set) if set.iter().all(|&value| value) => return Self::Constant(true),
            Self::Member(_, set) if !set.contains(&true) => return Self::Constant(false),
            Self::Constant(_) | Self::Member(..) => return self,
            Self::And(parts) => (parts, true),
            Self::Or(parts) => (parts, false),
        };
        let mut merged: Vec<Self> = Vec::new();
        let mut waiting: Vec<Self> = parts.into_iter().rev().map(Self::simplified).collect();
        while let Some(part) = waiting.pop() {
            match part {
                Self::Constant(value) if value == all => {}
                Self::Constant(_) => return Self::Constant(!all),
                Self::And(inner) if all => waiting.extend(inner.into_iter().rev()),
                Self::Or(inner) if !all => waiting.extend(inner.into_iter().rev()),
                Self::Member(variable, set) => {
                    let same = merged.iter_mut().find_map(|known| match known {
                        Self::Member(other, known) if *other == variable => Some(known),
                        _ => None,
                    });
                    match same {
                        Some(known) => {
                            for (known, new) in known.iter_mut().zip(&set) {
                                *known = if all { *known && *new } else { *known || *new };
                            }
                        }
                        None => merged.push(Self::Member(variable, set)),
                    }
                }
                other => merged.push(other),
            }
        }
        let decided = |part: &Self| match part {
            Self::Member(_, set) => {
                let (some, every) = (set.contains(&true), set.iter().all(|&value| value));
                if some { every.then_some(true) } else { Some(false) }
            }
            _ => None,
        };
        if merged.iter().any(|part| decided(part) == Some(!all)) {
            return Self::Constant(!all);
        }
        merged.retain(|part| decided(part).is_none());
        if merged.len() == 1 {
            return merged.remove(0);
        }
        match (merged.is_empty(), all) {
            (true, _) => Self::Constant(all),
            (false, true) => Self::And(merged),
            (false, false) => Self::Or(merged),
        }
    }
}

/// Three-valued truth under partial knowledge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Truth {
    True,
    False,
    Unknown,
}

impl Condition {
    pub(crate) fn new(formula: Formula) -> Self {
        let mut condition =
            Self { nodes: Vec::new(), wide: Vec::new(), read_once: true, variables: Vec::new() };
        condition.push(&formula.simplified());
        let mut variables = condition.variables.clone();
        variables.sort_unstable();
        variables.dedup();
        condition.read_once = variables.len() == condition.variables.len();
        condition.variables = variables;
        condition
    }

    fn push(&mut self, formula: &Formula) -> u32 {
        let node = match formula {
            Formula::Constant(value) => Node::Constant(*value),
            Formula::Member(variable, set) => {
                self.variables.push(*variable);
                let words: Vec<u64> = set
                    .chunks(64)
                    .map(|chunk| {
                        chunk.iter().enumerate().fold(0, |word, (at, &value)| word | u64::from(value) << at)
                    })
                    .collect();
                if let [set] = words.as_slice() {
                    Node::Member { variable: *variable, set: *set }
                } else {
                    let at = self.wide.len() as u32;
                    self.wide.extend(words);
                    Node::WideMember { variable: *variable, at }
                }
            }
            Formula::And(parts) => Node::And(parts.iter().map(|part| self.push(part)).collect()),
            Formula::Or(parts) => Node::Or(parts.iter().map(|part| self.push(part)).collect()),
        };
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// Returns whether the constraint is true in every completion of `values`.
    ///
    /// Linear in the size of the constraint when no variable occurs twice; otherwise exponential in the number of
    /// unknown variables at worst.
    #[inline]
    pub(crate) fn is_entailed(&self, values: &[u32], variables: &[Variable]) -> bool {
        let Some(root) = self.nodes.last() else { return true };
        match self.truth(root, values) {
            Truth::True => true,
            Truth::False => false,
            Truth::Unknown => !self.read_once && self.holds_in_all_completions(values, variables),
        }
    }

    #[cold]
    fn holds_in_all_completions(&self, values: &[u32], variables: &[Variable]) -> bool {
        let Some(root) = self.nodes.last() else { return true };
        match self.truth(root, values) {
            Truth::True => return true,
            Truth::False => return false,
            Truth::Unknown => {}
        }
        let unknown = |variable: &&u32| values.get(**variable as usize).is_none_or(|&value| value == UNKNOWN);
        let Some(&variable) = self.variables.iter().find(unknown) else { return false };
        let count = variables.get(variable as usize).map_or(0, Variable::value_count);
        let mut completed = values.to_vec();
        completed.resize(completed.len().max(variable as usize + 1), UNKNOWN);
        (0..count).all(|value| {
            completed[variable as usize] = value;
            self.holds_in_all_completions(&completed, variables)
        })
    }

    #[inline]
    fn truth(&self, node: &Node, values: &[u32]) -> Truth {
        match node {
            Node::Constant(value) => decided(*value),
            Node::Member { variable, set } => match values.get(*variable as usize) {
                Some(&value) if value < 64 => decided(set >> value & 1 == 1),
                _ => Truth::Unknown,
            },
            Node::WideMember { variable, at } => match values.get(*variable as usize) {
                Some(&value) if value != UNKNOWN => {
                    let word = self.wide.get((*at + value / 64) as usize).copied().unwrap_or(0);
                    decided(word >> (value % 64) & 1 == 1)
                }
                _ => Truth::Unknown,
            },
            Node::And(parts) => self.joined(parts, values, Truth::False, Truth::True),
            Node::Or(parts) => self.joined(parts, values, Truth::True, Truth::False),
        }
    }

    fn joined(&self, parts: &[u32], values: &[u32], deciding: Truth, neutral: Truth) -> Truth {
        let mut result = neutral;
        for &part in parts {
            let Some(node) = self.nodes.get(part as usize) else { continue };
            let truth = self.truth(node, values);
            if truth == deciding {
                return deciding;
            }
            if truth == Truth::Unknown {
                result = Truth::Unknown;
            }
        }
        result
    }
}

const fn decided(value: bool) -> Truth {
    if value { Truth::True } else { Truth::False }
}
