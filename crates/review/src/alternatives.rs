//! Why the alternatives of a choice were not taken: each is planned again with that alternative, and the answer is
//! the reason.

use exact::{Bound, Time};
use kirk::{Options, Stats, Status};
use rmpl::Span;
use rmpl::program::Measure;
use serde::{Deserialize, Serialize};
use snapshot::Undrivable;
use snapshot::blocked::name_blocked_in;
use tpn::worth;
use tpn::{Arc, ArcKind, Choice, Network, Plan};

/// An alternative of a choice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Its number, from 0.
    pub number: u32,
    /// What it does, by name: see [`Network::alternative_name`].
    pub name: String,
    /// How its text begins.
    pub text: String,
    /// Where it is written.
    pub span: Option<Span>,
    /// What became of it.
    pub fate: Fate,
}

/// What became of an alternative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fate {
    /// The plan takes it.
    Taken,
    /// No plan can take it, given the choices before it.
    Impossible {
        reason: String,
        /// Places in the text that have to do with it, the most telling first.
        spans: Vec<Span>,
    },
    /// There is a plan with it, before its own paths are looked for; another one was found first.
    AlsoPossible,
    /// There is a plan with it, but none is better by the mission's objective.
    NoBetter {
        /// What the best one comes to, given the choices before it; `None` where that depends on paths.
        at_best: Option<String>,
    },
    /// It was not worked out: too many alternatives, or too long a search.
    NotExamined,
}

impl Alternative {
    /// Writes what people read for calls.
    pub(crate) fn name_calls(&mut self, network: &Network) {
        if let Fate::Impossible { reason, .. } = &mut self.fate {
            *reason = network.readable(reason);
        }
    }
}

impl Fate {
    /// In one sentence, for people.
    pub fn sentence(&self) -> String {
        match self {
            Self::Taken => "selected".to_owned(),
            Self::Impossible { reason, .. } => format!("impossible: {reason}"),
            Self::AlsoPossible => {
                "not needed: a plan with it also exists, but this one was found first".to_owned()
            }
            Self::NoBetter { at_best: Some(worth) } => {
                format!("not chosen: with it and the previous choices, {worth} at best")
            }
            Self::NoBetter { at_best: None } => "not chosen: no better plan uses it".to_owned(),
            Self::NotExamined => "not checked: search too large".to_owned(),
        }
    }
}

/// Alternatives that are planned again at most, and how long each search may be.
const MAX_EXAMINED: usize = 64;
const MAX_EXPANDED: u64 = 20_000;
/// Explaining takes many searches; a larger network is asked only whether there is a plan.
const MAX_EXPLAINED_NODES: usize = 4_000;
/// Reasons that are told of one alternative.
const MAX_REASONS: usize = 3;
/// Characters of an alternative that are shown.
const LONGEST_BEGINNING: usize = 60;

/// Plans again with each alternative that `plan` does not take.
pub(super) struct Examiner<'input> {
    pub(super) network: &'input Network,
    pub(super) plan: &'input Plan,
    pub(super) undrivable: &'input [Undrivable],
    pub(super) source: &'input str,
    examined: usize,
}

impl<'input> Examiner<'input> {
    pub(super) fn new(
        network: &'input Network,
        plan: &'input Plan,
        undrivable: &'input [Undrivable],
        source: &'input str,
    ) -> Self {
        Self { network, plan, undrivable, source, examined: 0 }
    }

    /// The alternatives of a choice, in textual order.
    pub(super) fn alternatives(
        &mut self,
        choice: Choice,
        stop: &mut dyn FnMut() -> bool,
    ) -> Vec<Alternative> {
        let decision = &self.network.decisions[choice.decision.index()];
        (0..decision.alternatives.len())
            .map(|index| {
                let number = index as u32;
                let span = decision.alternative_spans.get(index).copied();
                let fate = if number == choice.alternative {
                    Fate::Taken
                } else {
                    self.fate(Choice { alternative: number, ..choice }, stop)
                };
                let name = self.network.alternative_name(choice.decision, number);
                Alternative { number, name, text: self.beginning(span), span, fate }
            })
            .collect()
    }

    fn beginning(&self, span: Option<Span>) -> String {
        let text = span.and_then(|span| self.source.get(span.range())).unwrap_or("");
        let words: Vec<&str> = text.split_whitespace().collect();
        let whole = words.join(" ");
        if whole.chars().count() <= LONGEST_BEGINNING {
            return whole;
        }
        let cut: String = whole.chars().take(LONGEST_BEGINNING - 1).collect();
        format!("{cut}…")
    }

    fn fate(&mut self, other: Choice, stop: &mut dyn FnMut() -> bool) -> Fate {
        self.examined += 1;
        if self.examined > MAX_EXAMINED || stop() {
            return Fate::NotExamined;
        }
        let network = self.network.with_choices(self.earlier(other).chain([other]));
        let options = Options { relax: false, explain: false, ..Options::default() };
        let mut enough = |stats: &Stats| stats.expanded >= MAX_EXPANDED || stop();
        let outcome = kirk::plan(&network, &options, &mut enough);
        let is_optimal = self.plan.quality.is_optimal == Some(true);
        match outcome.status {
            Status::Plan if is_optimal => {
                Fate::NoBetter { at_best: outcome.plans.first().and_then(|plan| at_best(&network, plan)) }
            }
            Status::Plan => Fate::AlsoPossible,
            Status::NoPlan => match without_paths(&network) {
                // With it, movements may start elsewhere and take other paths than those of the plan.
                Some(open) => match kirk::plan(&open, &options, &mut enough).status {
                    Status::Plan if is_optimal => Fate::NoBetter { at_best: None },
                    Status::Plan => Fate::AlsoPossible,
                    Status::NoPlan => self.impossible(other, &mut enough),
                    Status::Limit | Status::Error => Fate::NotExamined,
                },
                None => self.impossible(other, &mut enough),
            },
            Status::Limit | Status::Error => Fate::NotExamined,
        }
    }

    /// Returns why no plan makes a choice together with the earlier ones of the plan. Where that depends on later
    /// choices, each way to make these has its reason.
    fn impossible(&self, other: Choice, enough: &mut dyn FnMut(&Stats) -> bool) -> Fate {
        let choices: Vec<Choice> = self.earlier(other).chain([other]).collect();
        let open = without_paths(self.network);
        let network = open.as_ref().unwrap_or(self.network);
        let mut reasons = if network.nodes.len() <= MAX_EXPLAINED_NODES {
            kirk::explain_choices(network, &choices, &mut &mut *enough)
        } else {
            Vec::new()
        };
        if let Some(whole) = reasons.iter().position(|it| it.choices.iter().all(|it| choices.contains(it))) {
            reasons = vec![reasons.swap_remove(whole)];
        }
        let after = |choices: &[Choice]| network.readable(&kirk::after_choices(network, choices));
        let more = reasons.len().saturating_sub(MAX_REASONS);
        reasons.truncate(MAX_REASONS);
        let (mut told, mut spans) = (Vec::new(), Vec::new());
        for mut reason in reasons {
            name_blocked_in(&mut reason, self.network, self.undrivable);
            // That it is about this alternative is clear from its place.
            let others: Vec<Choice> = reason.choices.iter().copied().filter(|it| *it != other).collect();
            let what = reason.message.strip_prefix(&after(&reason.choices));
            told.push(
                what.map_or_else(|| reason.message.clone(), |what| format!("{}{what}", after(&others))),
            );
            spans.extend(reason.spans);
        }
        match more {
            0 if told.is_empty() => told.push("no plan with it exists".to_owned()),
            0 => {}
            1 => told.push("and 1 other".to_owned()),
            _ => told.push(format!("and {more} others")),
        }
        Fate::Impossible { reason: told.join("; "), spans }
    }

    /// Returns what the plan chose before another choice, in textual order.
    fn earlier(&self, other: Choice) -> impl Iterator<Item = Choice> {
        self.plan.choices.iter().copied().filter(move |choice| choice.decision < other.decision)
    }
}

/// Returns what a plan comes to that is the best, as far as no path has to be known for it.
fn at_best(network: &Network, plan: &Plan) -> Option<String> {
    let needs_paths = worth::measures(network).contains(&Measure::Length);
    worth::words(network, plan).filter(|_| plan.quality.is_optimal == Some(true) && !needs_paths)
}

/// The network as it is before the paths of movements are planned. `None` if none are.
fn without_paths(network: &Network) -> Option<Network> {
    let is_path = |arc: &Arc| arc.kind == ArcKind::Path;
    if !network.arcs.iter().any(is_path) {
        return None;
    }
    let mut network = network.clone();
    for arc in network.arcs.iter_mut().filter(|arc| is_path(arc)) {
        (arc.lower, arc.upper) = (Time::ZERO, Bound::Infinite);
    }
    Some(network)
}
