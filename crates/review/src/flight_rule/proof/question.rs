//! A rule negated, as a requirement on an instant of a plan that is not known yet: which activities the plan selects, and
//! which of their events have come.
//!
//! [`super::super::meaning`] says the same of one plan, where it is known what is selected and what comes first. Here each
//! event that the mission has counts where the plan selects it, and of changes of one state the plan still has to put one
//! first.

use exact::Scale;
use rmpl::program::{LabelMode, Program};
use rmpl::rule::{Activity, Formula, Moment, Rule};
use smol_str::SmolStr;
use tpn::{ArcId, Extent, LabelId, Network, NodeId, Occurrence};

use super::super::cut::Edge;
use super::super::level::Wanted;
use super::super::meaning::{Asked, Place, Reading, meant, places, tells, untouched};

/// What a plan and an instant of it have to be like.
#[derive(Clone, Debug)]
pub(super) enum Requirement {
    /// If the plan has the event, it has come, or is to come.
    Edge(Edge),
    /// The plan selects the arc.
    Selected(ArcId),
    /// If the plan has both events, they come in this order.
    Order { earlier: NodeId, later: NodeId },
    /// A level is like this.
    Level(Wanted),
    /// All of them; without any, it is always met.
    All(Vec<Requirement>),
    /// One of them; without any, it is never met.
    Any(Vec<Requirement>),
}

/// What is looked for in the plans of a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sought {
    /// An instant that breaks the rule.
    Broken,
    /// An instant at which it is not known to hold.
    Unsure,
    /// An instant that it speaks of.
    Applying,
}

/// A mission of which something is asked.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub(super) program: &'a Program,
    pub(super) network: &'a Network,
    /// The ticks of all times.
    pub(super) scale: Scale,
    /// Whether paths are not known yet, so that levels may be anything that change with the meters driven.
    pub(super) awaits_paths: bool,
}

impl Requirement {
    const NEVER: Self = Self::Any(Vec::new());

    fn all(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Vec::new();
        for part in parts {
            match part {
                Self::All(parts) => all.extend(parts),
                Self::Any(parts) if parts.is_empty() => return Self::NEVER,
                part => all.push(part),
            }
        }
        if all.len() == 1 { all.remove(0) } else { Self::All(all) }
    }

    fn any(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut any = Vec::new();
        for part in parts {
            match part {
                Self::Any(parts) => any.extend(parts),
                Self::All(parts) if parts.is_empty() => return Self::All(Vec::new()),
                part => any.push(part),
            }
        }
        if any.len() == 1 { any.remove(0) } else { Self::Any(any) }
    }

    /// Returns whether nothing meets it.
    pub(super) const fn is_impossible(&self) -> bool {
        matches!(self, Self::Any(parts) if parts.is_empty())
    }
}

impl Question<'_> {
    /// Returns what an instant has to be like for each place at which a rule looks; `None` if times are too large.
    pub(super) fn requirements(self, rule: &Rule, sought: Sought) -> Option<Vec<Requirement>> {
        let of = match &rule.moment {
            Moment::Start(of) | Moment::End(of) => of.as_ref(),
            Moment::Throughout | Moment::Within { .. } => None,
        };
        let occurrences = of.into_iter().flat_map(|of| meant(self.network, of));
        let places = places(self.network, &rule.moment, occurrences, |time| self.scale.ticks(time).ok());
        Some(places?.iter().map(|place| self.at_place(rule, place, sought)).collect())
    }

    fn at_place(self, rule: &Rule, place: &Place<'_>, sought: Sought) -> Requirement {
        let reading = if place.is_instant { Reading::Touching } else { Reading::Between };
        let mut parts: Vec<Requirement> = place.edges.iter().copied().map(Requirement::Edge).collect();
        parts.extend(place.of.map(|of| Requirement::Selected(self.arc(of))));
        if let Some(during) = &rule.during {
            let asked = if sought == Sought::Broken { Asked::Known } else { Asked::NotDenied };
            parts.push(self.condition(during, asked, reading.of_negation()));
        }
        let holds: &[Asked] = match sought {
            // At an instant, a condition that it touches as well as its contrary is known.
            Sought::Broken if place.is_instant => &[Asked::Denied, Asked::NotKnown],
            Sought::Broken => &[Asked::Denied],
            Sought::Unsure => &[Asked::NotKnown],
            Sought::Applying => &[],
        };
        for &asked in holds {
            parts.push(self.condition(&rule.holds, asked, reading));
        }
        Requirement::all(parts)
    }

    fn condition(self, formula: &Formula, asked: Asked, reading: Reading) -> Requirement {
        let parts = |parts: &[Formula]| -> Vec<Requirement> {
            parts.iter().map(|it| self.condition(it, asked, reading)).collect()
        };
        let is_conjunction = match formula {
            Formula::All(_) => matches!(asked, Asked::Known | Asked::NotDenied),
            _ => matches!(asked, Asked::NotKnown | Asked::Denied),
        };
        match formula {
            Formula::Not(inner) => self.condition(inner, asked.of_negation(), reading.of_negation()),
            Formula::All(inner) | Formula::Any(inner) if is_conjunction => Requirement::all(parts(inner)),
            Formula::All(inner) | Formula::Any(inner) => Requirement::any(parts(inner)),
            Formula::Is { .. } | Formula::Underway(_) if reading == Reading::Strict => {
                let own = self.condition(formula, asked, Reading::Touching);
                let other = self.condition(formula, asked.of_contrary(), Reading::Touching);
                match asked {
                    Asked::Known | Asked::Denied => Requirement::all([own, other]),
                    Asked::NotKnown | Asked::NotDenied => Requirement::any([own, other]),
                }
            }
            Formula::Is { variable, values } => match asked {
                Asked::Known => self.is_one_of(variable, values, true, reading.touches()),
                Asked::Denied => self.is_one_of(variable, values, false, reading.touches()),
                Asked::NotKnown => self.is_none_of(variable, values, true, reading.touches()),
                Asked::NotDenied => self.is_none_of(variable, values, false, reading.touches()),
            },
            Formula::Underway(activity) => self.underway(activity, asked, reading.touches()),
            Formula::Amount { resource, order, amount } => {
                let Some(resource) = self.network.resources.iter().position(|it| it.name == *resource) else {
                    // Nothing is known of it.
                    return match asked {
                        Asked::Known | Asked::Denied => Requirement::NEVER,
                        Asked::NotKnown | Asked::NotDenied => Requirement::All(Vec::new()),
                    };
                };
                let wanted = Wanted::new(resource, *order, *amount, reading.touches());
                self.level(match asked {
                    Asked::Known | Asked::NotDenied => wanted,
                    Asked::NotKnown | Asked::Denied => wanted.negated(),
                })
            }
        }
    }

    fn level(self, wanted: Wanted) -> Requirement {
        let counts_meters =
            |used: &tpn::Use| used.resource.index() == wanted.resource && !used.per_meter.is_zero();
        if self.awaits_paths && self.network.uses.iter().any(counts_meters) {
            return Requirement::All(Vec::new());
        }
        Requirement::Level(wanted)
    }

    fn underway(self, activity: &Activity, asked: Asked, touches: bool) -> Requirement {
        let all = meant(self.network, activity);
        let inside = |it: &Occurrence, [after, before]: [bool; 2]| {
            Requirement::all([
                Requirement::Selected(self.arc(it)),
                Requirement::Edge(Edge::past(it.start, after)),
                Requirement::Edge(Edge::future(it.end, before)),
            ])
        };
        let outside = |it: &Occurrence, [before, after]: [bool; 2]| {
            Requirement::any([
                Requirement::Edge(Edge::future(it.start, before)),
                Requirement::Edge(Edge::past(it.end, after)),
            ])
        };
        match asked {
            Asked::Known => Requirement::any(all.map(|it| inside(it, [true, touches]))),
            Asked::NotDenied => Requirement::any(all.map(|it| inside(it, [!touches, false]))),
            Asked::NotKnown => Requirement::all(all.map(|it| outside(it, [false, !touches]))),
            Asked::Denied => Requirement::all(all.map(|it| outside(it, [touches, true]))),
        }
    }

    /// The assertions that tell that a variable has one of these values, or unless `is_among` another one, and all others;
    /// of a variable that nothing asks for or changes whether that is told all the time.
    fn told(
        self,
        variable: &str,
        values: &[SmolStr],
        is_among: bool,
    ) -> Result<(Vec<LabelId>, Vec<LabelId>), bool> {
        let Some(index) = self.network.variables.iter().position(|it| it.name == variable) else {
            let value = untouched(self.program, variable);
            return Err(value.is_some_and(|value| values.contains(value) == is_among));
        };
        let declared = &self.network.variables[index];
        let labels =
            self.network.labels.iter().enumerate().filter(|(_, label)| {
                label.literal.variable.index() == index && label.mode == LabelMode::Tell
            });
        let all = labels.map(|(at, label)| {
            (LabelId::from_index(at), tells(declared, &label.literal.values, values, is_among))
        });
        let (meant, others): (Vec<_>, Vec<_>) = all.partition(|&(_, is_meant)| is_meant);
        let ids = |all: Vec<(LabelId, bool)>| all.into_iter().map(|(id, _)| id).collect();
        Ok((ids(meant), ids(others)))
    }

    /// It is known that a variable has one of these values, or that it has another.
    fn is_one_of(self, variable: &str, values: &[SmolStr], is_among: bool, touches: bool) -> Requirement {
        let (meant, others) = match self.told(variable, values, is_among) {
            Ok(told) => told,
            Err(true) => return Requirement::All(Vec::new()),
            Err(false) => return Requirement::NEVER,
        };
        let known = |&own: &LabelId| {
            let edges = |begin, end: Option<NodeId>| {
                let begin = Requirement::Edge(Edge::past(begin, true));
                let end = end.map(|end| Requirement::Edge(Edge::future(end, touches)));
                [Some(begin), end].into_iter().flatten()
            };
            let selected = Requirement::Selected(self.network.labels[own.index()].arc);
            let (start, end) = self.network.interval(own);
            if !self.network.is_lasting(own) {
                return Requirement::all(edges(start, Some(end)).chain([selected]));
            }
            // What comes before it has ended when it begins, and nothing has changed it yet.
            let kept = meant.iter().chain(&others).filter(|&&other| self.ends(own, other)).map(|&other| {
                let (first, last) = self.network.interval(other);
                let is_first = self.network.labels[own.index()].extent == Extent::Initial;
                // Nothing comes before the first value, not even at the same instant.
                let before = (!is_first).then_some(Requirement::Order { earlier: last, later: start });
                Requirement::any([Requirement::Edge(Edge::future(first, touches))].into_iter().chain(before))
            });
            Requirement::all(edges(self.network.ready(own), None).chain([selected]).chain(kept))
        };
        Requirement::any(meant.iter().map(known))
    }

    /// It is not known that a variable has one of these values, or that it has another.
    fn is_none_of(self, variable: &str, values: &[SmolStr], is_among: bool, touches: bool) -> Requirement {
        let (meant, others) = match self.told(variable, values, is_among) {
            Ok(told) => told,
            Err(true) => return Requirement::NEVER,
            Err(false) => return Requirement::All(Vec::new()),
        };
        let unknown = |&own: &LabelId| {
            let (_, end) = self.network.interval(own);
            let begin = Requirement::Edge(Edge::future(self.network.ready(own), false));
            if !self.network.is_lasting(own) {
                return Requirement::any([begin, Requirement::Edge(Edge::past(end, !touches))]);
            }
            let changed = meant.iter().chain(&others).filter(|&&other| self.ends(own, other)).map(|&other| {
                Requirement::all([
                    Requirement::Selected(self.network.labels[other.index()].arc),
                    Requirement::Edge(Edge::past(self.network.interval(other).0, !touches)),
                    Requirement::Order { earlier: end, later: self.network.interval(other).0 },
                ])
            });
            Requirement::any([begin].into_iter().chain(changed))
        };
        Requirement::all(meant.iter().map(unknown))
    }

    /// Returns whether a change of a state ends what another one has made, if it comes after it.
    fn ends(self, own: LabelId, other: LabelId) -> bool {
        own != other
            && self.network.labels[other.index()].extent != Extent::Initial
            && self.network.conflict(own, other)
    }

    /// An arc that is selected where an activity is.
    fn arc(self, of: &Occurrence) -> ArcId {
        // The first arc is that of the whole mission.
        let out = || self.network.nodes[of.start.index()].out_arcs.first().copied();
        of.arc.or_else(out).unwrap_or(ArcId::from_index(0))
    }
}
