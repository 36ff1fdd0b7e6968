//! Bounds between events of different threads (SPEC 14): which occurrences a name represents, and which pairs of them a
//! bound relates.
//!
//! A name may represent several occurrences: in alternatives, in the instances of an activity, in the copies of a
//! `repeat`. A bound relates each of them to those of the other name that are nearest to it: in the same instance or
//! copy, where there are any, so that an activity and a bound between its own events mean the same wherever it is called.

use std::collections::BTreeMap;

use rmpl::Span;
use rmpl::diagnostics::limit;
use rmpl::program::{EventName, Name};

use super::bounds::{self, Interval};
use super::expander::Expander;
use super::scope::Scope;
use crate::network::{ArcKind, NodeId};

/// More pairs of occurrences than this are not related by one bound.
const MAX_PAIRS: usize = 200_000;

/// The occurrences that have names, while a program is expanded.
#[derive(Default)]
pub(super) struct Named<'program> {
    by_name: BTreeMap<&'program str, Vec<Occurrence>>,
    /// The instances and copies around the present place, outermost first.
    path: Vec<u32>,
    entered: u32,
}

/// A named occurrence.
#[derive(Clone)]
struct Occurrence {
    /// The instances and copies that it is in, outermost first.
    path: Vec<u32>,
    start: NodeId,
    end: NodeId,
}

impl<'program> Named<'program> {
    /// Begins an instance of an activity, or a copy.
    pub(super) fn enter(&mut self) {
        self.entered += 1;
        self.path.push(self.entered);
    }

    pub(super) fn leave(&mut self) {
        self.path.pop();
    }

    /// Names what lies between two events.
    pub(super) fn add(&mut self, name: &'program Name, start: NodeId, end: NodeId) {
        let occurrence = Occurrence { path: self.path.clone(), start, end };
        self.by_name.entry(name.text.as_str()).or_default().push(occurrence);
    }

    fn of(&self, name: &str) -> &[Occurrence] {
        self.by_name.get(name).map_or(&[], Vec::as_slice)
    }
}

impl Occurrence {
    fn event(&self, name: &EventName) -> NodeId {
        if name.is_end { self.end } else { self.start }
    }

    /// Returns how many instances and copies hold both.
    fn nearness(&self, other: &Self) -> usize {
        self.path.iter().zip(&other.path).take_while(|(one, other)| one == other).count()
    }
}

impl Expander<'_> {
    /// Adds all bounds between events.
    pub(super) fn constrain(&mut self) {
        for declared in &self.program.constraints {
            let scope = Scope::default();
            let evaluated = bounds::interval_between_events(&declared.bounds, &scope.values(&self.constants));
            let interval = match evaluated {
                Ok(interval) => interval,
                Err(error) => {
                    self.diagnostics.push(error);
                    continue;
                }
            };
            let (from, to) = (self.named.of(&declared.from.name.text), self.named.of(&declared.to.name.text));
            if from.len().saturating_mul(to.len()) > MAX_PAIRS {
                let what = format!("`{}` and `{}` make", declared.from.name.text, declared.to.name.text);
                self.diagnostics.push(limit::pairs(&what, MAX_PAIRS, declared.span));
                continue;
            }
            let pairs: Vec<(NodeId, NodeId)> = nearest_pairs(from, to)
                .into_iter()
                .map(|(one, other)| (one.event(&declared.from), other.event(&declared.to)))
                .collect();
            for pair in pairs {
                self.relate(pair, interval, declared.bounds.span);
            }
        }
    }

    /// Adds a bound. If the second event never comes after the first, the arc leads from the second to the first.
    fn relate(&mut self, (from, to): (NodeId, NodeId), interval: Interval, span: Span) {
        if from == to && interval.allows_zero() {
            return;
        }
        match interval.reversed() {
            Some(reversed) => self.builder.arc(to, from, ArcKind::Constraint, reversed, span),
            None => self.builder.arc(from, to, ArcKind::Constraint, interval, span),
        };
    }
}

/// Each pair of which neither has another one nearer to it.
fn nearest_pairs<'a>(from: &'a [Occurrence], to: &'a [Occurrence]) -> Vec<(&'a Occurrence, &'a Occurrence)> {
    let most = |one: &Occurrence, others: &[Occurrence]| {
        others.iter().map(|other| one.nearness(other)).max().unwrap_or(0)
    };
    let to_most: Vec<usize> = to.iter().map(|other| most(other, from)).collect();
    let mut pairs = Vec::new();
    for one in from {
        let nearest = most(one, to);
        for (other, &its_nearest) in to.iter().zip(&to_most) {
            let nearness = one.nearness(other);
            if nearness == nearest && nearness == its_nearest {
                pairs.push((one, other));
            }
        }
    }
    pairs
}
