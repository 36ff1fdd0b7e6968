//! From a plan with an instant to a plan of the mission that breaks the rule, with a schedule that shows it.
//!
//! What the solver found is never believed: the plan is planned again in the mission's own network, where the environment
//! has its say, the checker checks it, and the rule is held against it as against any plan.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use executive::{PlanNetwork, Script};
use kirk::{Options, Status};
use rmpl::program::Program;
use rmpl::rule::Rule;
use stn::INFINITE;
use tpn::plan_json::plan_to_json;
use tpn::{
    Arc, ArcKind, Choice, Network, NodeId, Ordering, Plan, Precedence, ResourceId, Supply, UseId, UseOrdering,
};
use verify::Rule as Checked;

use super::super::Outcome;
use super::super::cut::Times;
use super::super::meaning::{Meaning, times_of};
use super::question::Sought;
use super::{Counterexample, Meter, OPTIONS};
use crate::contradict::{Scheduled, named_times};

/// What became of the choices of a plan with an instant.
pub(super) enum Tried {
    Shown(Box<Counterexample>),
    /// No plan that makes these choices breaks the rule.
    Refuted,
    /// Those that were looked at do not, for this reason.
    Open(String),
}

/// How a plan stands to what is sought.
pub(super) enum Held {
    Shown(Box<Counterexample>),
    /// It is not as sought.
    Kept,
    /// It may be as sought, and nothing shows it.
    Unknown,
}

/// The most plans that are listed to refute some choices.
const MAX_LISTED: usize = 200;

/// Beyond so many uses their order is not taken over from the instant's plan.
const MAX_USES: usize = 300;

/// A rule that is held against plans.
#[derive(Clone, Copy)]
pub(super) struct Judge<'a> {
    pub(super) program: &'a Program,
    pub(super) text: &'a str,
    pub(super) rule: &'a Rule,
    pub(super) sought: Sought,
}

impl Judge<'_> {
    /// Holds a plan against the rule: it is as sought if the checker accepts it, with a schedule that shows it.
    pub(super) fn hold(
        self,
        network: &Network,
        plan: &Plan,
        is_own: bool,
        stop: &mut dyn FnMut() -> bool,
    ) -> Held {
        let Some(times) = Times::new(network, plan, &times_of(self.rule)) else { return Held::Unknown };
        let mut meaning = Meaning::new(self.program, network, plan, times);
        let Some((finding, breach)) = meaning.examine(self.text, self.rule, stop) else {
            return Held::Unknown;
        };
        let text = match finding.outcome {
            Outcome::NeverApplies => return Held::Kept,
            // That a rule applies needs no schedule.
            _ if self.sought == Sought::Applying => return Held::Unknown,
            Outcome::Broken(text) => text,
            Outcome::Unsure(text) if self.sought == Sought::Unsure => text,
            _ => return Held::Kept,
        };
        let times = breach.and_then(|breach| meaning.execution(&breach));
        match times.filter(|times| self.is_shown_by(network, plan, times)) {
            Some(times) => Held::Shown(Box::new(Counterexample {
                text,
                plan: plan_to_json(network, plan),
                choices: plan.choices.clone(),
                is_own,
                script: Script { schedule: named_times(network, plan, &times), ..Script::default() },
            })),
            None => Held::Unknown,
        }
    }

    /// Returns whether the checker accepts a plan and its schedule, and the rule is not known to hold at an instant of
    /// it.
    fn is_shown_by(self, network: &Network, plan: &Plan, times: &[Option<Time>]) -> bool {
        let has_path = network
            .arcs
            .iter()
            .zip(&plan.selected_arcs)
            .any(|(arc, is_selected)| *is_selected && arc.kind == ArcKind::Path);
        // That the checker cannot decide the order within an instant is nothing against a schedule, and vertices of a path
        // are no deadlines (SPEC 6.2).
        let is_allowed = |rule: Checked| rule == Checked::Form || (has_path && rule == Checked::Duration);
        let scheduled =
            Scheduled { program: self.program, network, plan, times, is_extreme: false, log: None };
        verify::check_plan(network, plan).valid
            && verify::check_schedule(network, plan, times).violations.iter().all(|it| is_allowed(it.rule))
            && scheduled.first_breach(self.rule).is_some()
    }

    /// Looks for a plan of the mission that makes the choices of a plan with an instant, and is as sought.
    pub(super) fn tried(
        self,
        network: &Network,
        (extended, found): (&Network, &Plan),
        meter: &mut Meter<'_>,
    ) -> Tried {
        let mut chosen = network.with_choices(own_choices(network, found));
        chosen.objective.clear();
        for orders in [Some(Orders::default()), Orders::of(network, extended, found)].into_iter().flatten() {
            let bare = meter.plan(&orders.added_to(&chosen), &OPTIONS, &[]);
            if bare.status == Status::NoPlan && orders.precedences.is_empty() {
                return Tried::Refuted;
            }
            if let Held::Shown(shown) = self.hold_all(network, bare.plans, &orders, meter) {
                return Tried::Shown(shown);
            }
        }
        let open = || Tried::Open("the plans that may violate it were not confirmed".to_owned());
        // Plans that differ only in orders of uses are not listed one by one.
        if !network.uses.is_empty() {
            return open();
        }
        let all = Options { all: true, max_plans: MAX_LISTED, ..OPTIONS };
        let listed = meter.plan(&chosen, &all, &[]);
        let is_complete = listed.status == Status::Plan && listed.plans.len() < MAX_LISTED;
        match self.hold_all(network, listed.plans, &Orders::default(), meter) {
            Held::Shown(shown) => Tried::Shown(shown),
            Held::Kept if is_complete && meter.limit.is_none() => Tried::Refuted,
            Held::Kept | Held::Unknown => open(),
        }
    }

    /// Holds plans against the rule, until one is shown to be as sought.
    fn hold_all(self, network: &Network, plans: Vec<Plan>, orders: &Orders, meter: &mut Meter<'_>) -> Held {
        let mut all = Held::Kept;
        for plan in plans {
            match self.hold(network, &plan_of(network, plan, orders), false, &mut || meter.is_stopped()) {
                Held::Kept => {}
                Held::Unknown => all = Held::Unknown,
                shown @ Held::Shown(_) => return shown,
            }
        }
        all
    }
}

/// The choices of a plan with an instant that are the mission's.
pub(super) fn own_choices(network: &Network, found: &Plan) -> Vec<Choice> {
    let own = found.choices.iter().filter(|choice| choice.decision.index() < network.decisions.len());
    own.copied().collect()
}

/// A plan of the restricted network as one of the mission's.
fn plan_of(network: &Network, mut plan: Plan, orders: &Orders) -> Plan {
    plan.selected_arcs.truncate(network.arcs.len());
    let known: BTreeSet<Ordering> = plan.orderings_added.iter().copied().collect();
    plan.orderings_added.extend(orders.labels.iter().filter(|order| !known.contains(order)));
    let known: BTreeSet<UseOrdering> = plan.uses_ordered.iter().copied().collect();
    plan.uses_ordered.extend(orders.uses.iter().filter(|order| !known.contains(order)));
    // Nobody looked for the best one.
    plan.quality.is_optimal = (!network.objective.is_empty()).then_some(false);
    plan
}

/// What of the orders of a plan with an instant may be so because of the instant.
#[derive(Default)]
struct Orders {
    labels: Vec<Ordering>,
    uses: Vec<UseOrdering>,
    precedences: Vec<Precedence>,
}

impl Orders {
    /// A network in which they hold.
    fn added_to(&self, network: &Network) -> Network {
        let mut network = network.clone();
        for order in &self.precedences {
            let bounds = (order.least, Bound::Infinite);
            network.arcs.push(Arc::bare(order.earlier, order.later, bounds, ArcKind::Constraint));
        }
        network
    }

    /// `None` if there are none, or if times do not fit.
    fn of(network: &Network, extended: &Network, found: &Plan) -> Option<Self> {
        let is_own = |order: &Ordering| {
            order.first.index() < network.labels.len() && order.then.index() < network.labels.len()
        };
        let mut bare = found.clone();
        bare.choices = own_choices(network, found);
        bare.selected_nodes.truncate(network.nodes.len());
        bare.selected_arcs.truncate(network.arcs.len());
        bare.windows.truncate(network.nodes.len());
        bare.causal_links.retain(|link| link.ask.index() < network.labels.len());
        bare.conflict_order.retain(is_own);
        bare.state_order.retain(|order| order.variable.index() < network.variables.len());
        bare.orderings_added.clear();
        bare.uses_ordered.clear();
        let natures = network.natures_events(&bare.selected_arcs);
        let mut without = Entailed::new(network, &bare)?;
        let mut orders = Self::default();
        let mut labels: Vec<Ordering> =
            found.orderings_added.iter().copied().filter(|order| is_own(order)).collect();
        labels.extend(bare.telling_order(network));
        labels.sort_unstable();
        labels.dedup();
        for order in labels {
            let precedence = bare.ordering_precedence(network, &order, &natures);
            if !without.holds(&Precedence { least: Time::ZERO, ..precedence })? {
                orders.labels.push(order);
                orders.precedences.push(precedence);
            }
        }
        if network.uses.len() <= MAX_USES {
            let mut with = Entailed::new(extended, found)?;
            for resource in (0..network.resources.len()).map(ResourceId::from_index) {
                let is_reusable =
                    matches!(network.resources[resource.index()].supply, Supply::Reusable { .. });
                let selected = network.uses.iter().zip(0..).filter(|(used, _)| {
                    used.resource == resource
                        && found.selected_arcs.get(used.arc.index()) == Some(&true)
                        && (!used.amount.is_zero() || used.level.is_some())
                });
                let selected: Vec<UseId> =
                    selected.map(|(_, index): (_, usize)| UseId::from_index(index)).collect();
                for &first in &selected {
                    for &then in selected.iter().filter(|&&then| then != first) {
                        let order = UseOrdering { first, then };
                        let precedence = order.precedence(network);
                        let is_one = precedence.earlier == precedence.later
                            || (!is_reusable
                                && network.uses[first.index()].owner == network.uses[then.index()].owner);
                        if !is_one && with.holds(&precedence)? && !without.holds(&precedence)? {
                            orders.uses.push(order);
                            orders.precedences.push(precedence);
                        }
                    }
                }
            }
        }
        (!orders.precedences.is_empty()).then_some(orders)
    }
}

/// What the constraints of a plan entail.
struct Entailed {
    network: PlanNetwork,
    rows: BTreeMap<NodeId, Vec<i64>>,
}

impl Entailed {
    fn new(network: &Network, plan: &Plan) -> Option<Self> {
        let network = PlanNetwork::new(network, plan).ok()?;
        Some(Self { network, rows: BTreeMap::new() })
    }

    /// Returns whether one event never comes later than another; `None` if times do not fit.
    fn holds(&mut self, precedence: &Precedence) -> Option<bool> {
        let (later, earlier) =
            (self.network.point(precedence.later)?, self.network.point(precedence.earlier)?);
        if !self.rows.contains_key(&precedence.later) {
            let mut row = Vec::new();
            self.network.stn.distances_from(later, &mut row).ok()?;
            self.rows.insert(precedence.later, row);
        }
        let distance = self.rows.get(&precedence.later)?.get(earlier.index()).copied().unwrap_or(INFINITE);
        Some(distance <= 0)
    }
}
