//! What a plan lets one know of conditions: which events must have come, and which must not have, for something to hold,
//! not to hold, or to be open.

use rmpl::program::Program;
use rmpl::rule::Formula;
use smol_str::SmolStr;
use tpn::{Extent, LabelId, NodeId, ValueId, ValueSet, Variable, VariableId};

use super::super::cases::Condition;
use super::super::cut::Edge;
use super::super::level::Wanted;
use super::Meaning;

/// What is asked of a condition: what holds is known, or not known, or the contrary is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::flight_rule) enum Asked {
    Known,
    NotKnown,
    Denied,
    NotDenied,
}

impl Asked {
    /// Returns what is asked of a condition when this is asked of its negation.
    pub(in crate::flight_rule) const fn of_negation(self) -> Self {
        match self {
            Self::Known => Self::Denied,
            Self::NotKnown => Self::NotDenied,
            Self::Denied => Self::Known,
            Self::NotDenied => Self::NotKnown,
        }
    }

    /// Returns what is asked of the contrary where more than one touching side must not do.
    pub(in crate::flight_rule) const fn of_contrary(self) -> Self {
        match self {
            Self::Known => Self::NotDenied,
            Self::NotKnown => Self::Denied,
            Self::Denied => Self::NotKnown,
            Self::NotDenied => Self::Known,
        }
    }
}

/// When conditions are asked for, and how what touches a moment is taken.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::flight_rule) enum Reading {
    /// At any instant: what starts counts, what ends does not.
    Between,
    /// At a moment: what touches it counts.
    Touching,
    /// At a moment, where more than one touching side must not do: what its contrary touches as well is neither.
    Strict,
}

impl Reading {
    /// Returns how the inside of a `not` is read: a condition and its negation never are both known.
    pub(in crate::flight_rule) const fn of_negation(self) -> Self {
        match self {
            Self::Between => Self::Between,
            Self::Touching | Self::Strict => Self::Strict,
        }
    }

    pub(in crate::flight_rule) const fn touches(self) -> bool {
        !matches!(self, Self::Between)
    }
}

impl Meaning<'_> {
    pub(super) fn condition(&self, formula: &Formula, asked: Asked, reading: Reading) -> Condition {
        let all = |parts: &[Formula]| parts.iter().map(|it| self.condition(it, asked, reading)).collect();
        match formula {
            Formula::Not(inner) => self.condition(inner, asked.of_negation(), reading.of_negation()),
            Formula::All(parts) => match asked {
                Asked::Known | Asked::NotDenied => Condition::All(all(parts)),
                Asked::NotKnown | Asked::Denied => Condition::Any(all(parts)),
            },
            Formula::Any(parts) => match asked {
                Asked::Known | Asked::NotDenied => Condition::Any(all(parts)),
                Asked::NotKnown | Asked::Denied => Condition::All(all(parts)),
            },
            Formula::Is { .. } | Formula::Underway(_) if reading == Reading::Strict => {
                let parts =
                    [asked, asked.of_contrary()].map(|it| self.condition(formula, it, Reading::Touching));
                match asked {
                    Asked::Known | Asked::Denied => Condition::All(parts.into()),
                    Asked::NotKnown | Asked::NotDenied => Condition::Any(parts.into()),
                }
            }
            Formula::Is { variable, values } => {
                let known = |is_among: bool| self.is_one_of(variable, values, is_among, reading.touches());
                match asked {
                    Asked::Known => known(true),
                    Asked::NotKnown => known(true).negated(),
                    Asked::Denied => known(false),
                    Asked::NotDenied => known(false).negated(),
                }
            }
            Formula::Underway(activity) => {
                let touches = reading.touches();
                let inside = |(start, end)| between(start, end, touches);
                let outside = |(start, end)| {
                    Condition::Any(vec![
                        Condition::Edge(Edge::future(start, touches)),
                        Condition::Edge(Edge::past(end, true)),
                    ])
                };
                match asked {
                    Asked::Known => Condition::Any(self.occurrences(activity).map(inside).collect()),
                    Asked::NotDenied => {
                        Condition::All(self.occurrences(activity).map(outside).collect()).negated()
                    }
                    Asked::NotKnown => {
                        Condition::Any(self.occurrences(activity).map(inside).collect()).negated()
                    }
                    Asked::Denied => Condition::All(self.occurrences(activity).map(outside).collect()),
                }
            }
            Formula::Amount { resource, order, amount } => {
                let Some(resource) = self.network.resources.iter().position(|it| it.name == *resource) else {
                    // Nothing is known of it.
                    return match asked {
                        Asked::Known | Asked::Denied => Condition::Any(Vec::new()),
                        Asked::NotKnown | Asked::NotDenied => Condition::All(Vec::new()),
                    };
                };
                let wanted = Wanted::new(resource, *order, *amount, reading.touches());
                Condition::Level(match asked {
                    Asked::Known | Asked::NotDenied => wanted,
                    Asked::NotKnown | Asked::Denied => wanted.negated(),
                })
            }
        }
    }

    /// It is known that a variable has one of these values, or that it has another.
    fn is_one_of(&self, variable: &str, values: &[SmolStr], is_among: bool, is_instant: bool) -> Condition {
        let Some(index) = self.network.variables.iter().position(|it| it.name == variable) else {
            return match untouched(self.program, variable) {
                // It is so from the start of the mission to its end.
                Some(value) if values.contains(value) == is_among => Condition::All(Vec::new()),
                _ => Condition::Any(Vec::new()),
            };
        };
        let declared = &self.network.variables[index];
        let told = self.plan.told(self.network, VariableId::from_index(index));
        let is_meant = |label: &LabelId| {
            tells(declared, &self.network.labels[label.index()].literal.values, values, is_among)
        };
        if !declared.is_lasting {
            let parts = told.into_iter().filter(is_meant).map(|label| {
                let (start, end) = self.network.interval(label);
                between(start, end, is_instant)
            });
            return Condition::Any(parts.collect());
        }
        let parts = (0..told.len()).filter(|&at| is_meant(&told[at])).map(|at| {
            let mut edges = vec![Condition::Edge(Edge::past(self.network.ready(told[at]), true))];
            let next = self.next_changes(&told, at);
            edges.extend(
                next.into_iter()
                    .map(|next| Condition::Edge(Edge::future(self.network.interval(next).0, is_instant))),
            );
            Condition::All(edges)
        });
        Condition::Any(parts.collect())
    }

    /// Those of the ordered changes of a variable that may be the first to end what the one at `at` has made.
    fn next_changes(&self, told: &[LabelId], at: usize) -> Vec<LabelId> {
        let own = &self.network.labels[told[at].index()];
        let mut next: Vec<LabelId> = Vec::new();
        for &label in &told[at + 1..] {
            let other = &self.network.labels[label.index()];
            // What gives the same value at once ends nothing.
            let is_change = other.is_changing() || own.is_changing() || other.literal != own.literal;
            let is_after = own.extent == Extent::Initial || self.is_ordered(told[at], label);
            if !is_change || !is_after {
                continue;
            }
            if next.iter().any(|&earlier| self.is_ordered(earlier, label)) {
                break;
            }
            next.push(label);
        }
        next
    }

    fn is_ordered(&self, first: LabelId, then: LabelId) -> bool {
        self.order.is_before(first, then)
    }
}

/// Returns whether a set of values tells that a variable has one of `values`, or, unless `is_among`, that it has
/// another.
pub(in crate::flight_rule) fn tells(
    variable: &Variable,
    set: &ValueSet,
    values: &[SmolStr],
    is_among: bool,
) -> bool {
    let is_meant = |value: ValueId| {
        variable.values.get(value.index()).is_some_and(|name| values.contains(name)) == is_among
    };
    match set {
        ValueSet::In(ids) => ids.iter().all(|&id| is_meant(id)),
        ValueSet::NotIn(ids) if variable.closed => {
            let left = (0..variable.values.len()).map(ValueId::from_index);
            left.filter(|id| !ids.contains(id)).all(is_meant)
        }
        // Of all that it may be besides, only that it is none of these is known.
        ValueSet::NotIn(ids) => {
            let named = |value: &SmolStr| variable.values.iter().position(|it| it == value);
            let is_excluded = |value| named(value).is_some_and(|at| ids.contains(&ValueId::from_index(at)));
            !is_among && values.iter().all(is_excluded)
        }
    }
}

/// The value that a state keeps which nothing in the mission asks for or changes. What is read from the plant is not
/// known that way: components fail.
pub(in crate::flight_rule) fn untouched<'program>(
    program: &'program Program,
    variable: &str,
) -> Option<&'program SmolStr> {
    let mut declared = program.variables.iter().filter(|it| it.name.text == variable);
    if let Some(declared) = declared.next() {
        return declared.initial.as_ref().filter(|_| !declared.is_from_plant).map(|value| &value.text);
    }
    let vehicle = variable.strip_suffix(".at")?;
    let mut vehicles = program.world.vehicles.iter();
    vehicles.find(|it| it.name.text == vehicle).map(|it| &it.start.text)
}

/// Between two events; at an instant, what touches it counts.
pub(super) fn between(start: NodeId, end: NodeId, is_instant: bool) -> Condition {
    Condition::All(vec![
        Condition::Edge(Edge::past(start, true)),
        Condition::Edge(Edge::future(end, is_instant)),
    ])
}
