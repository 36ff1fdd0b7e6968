//! The check of a plan (SPEC 5.5, 10 to 13): its selection, its constraints, its links, its orders, those within an instant
//! too, its windows, the resources it uses, what it is worth, and that it withstands the environment.

mod constraints;
mod controllability;
mod orders;
mod quality;
mod resources;
mod state;

use std::collections::BTreeMap;

use exact::{Bound, Time};
use rmpl::program::LabelMode;
use tpn::{LabelId, Network, NodeId, Plan, Window};

use crate::distance::Distances;
use crate::entailment::{Entailment, Span};
use crate::instant::InstantOrder;
use crate::labels::{self, interval};
use crate::selection;
use crate::{Rule, Verdict, Violation, node_name, state as lasting};
use constraints::Constraints;
use orders::Stated;

/// Checks `plan` against `network` from the definitions.
///
/// Time is about O((edges + conflicts) · log nodes) after the consistency check, with one row of distances for each
/// conflicting interval that neither the windows nor an added constraint already order. Intervals of state variables and
/// uses of resources that the plan puts in sequence cost a short search each.
///
/// Amounts of resources and costs are the network's: what is counted per metre is part of them once paths are inserted.
/// That an optimal plan is optimal is not checked. Windows are those of the network that reads durations that the
/// environment chooses as ordinary ones.
///
/// ```
/// let parsed = rmpl::parse("scenario Day[0,60] = { Drive()[20,30] }");
/// let (network, _warnings) = tpn::compile(&parsed.program(), &tpn::Top::Scenario(None));
/// let network = network.expect("nothing in it is an error");
/// let stated = |latest: u32| {
///     serde_json::json!({
///         "choices": {}, "activities": ["Drive#1"],
///         "causal_links": [], "conflict_order": [], "orderings_added": [],
///         "windows": { "Drive#1.start": [0, 0], "Drive#1.end": [20, latest] },
///     })
/// };
/// let plan = tpn::plan_json::plan_from_json(&network, &stated(30))?;
/// assert!(verify::check_plan(&network, &plan).valid);
/// let plan = tpn::plan_json::plan_from_json(&network, &stated(31))?;
/// assert_eq!(verify::check_plan(&network, &plan).violations[0].rule, verify::Rule::Window);
/// # Ok::<(), tpn::plan_json::PlanError>(())
/// ```
pub fn check_plan(network: &Network, plan: &Plan) -> Verdict {
    if let Err(verdict) = selection::check_form(network, plan) {
        return verdict;
    }
    let mut violations = Vec::new();
    selection::check_selection(network, plan, &mut violations);
    check_links(network, plan, &mut violations);
    resources::check_use_orderings(network, plan, &mut violations);
    if !violations.is_empty() {
        return Verdict::new(violations);
    }
    let Some(constraints) = Constraints::new(network, plan) else {
        let message = "the bounds are too large, or their denominators too different, to check exactly";
        return Verdict::new(vec![Violation::new(Rule::Form, message)]);
    };
    let distances = match Distances::new(network.nodes.len(), constraints.edges.clone()) {
        Ok(distances) => distances,
        Err(cycle) => return Verdict::new(vec![constraints.describe_cycle(network, &cycle)]),
    };
    let order = match InstantOrder::new(&distances, &constraints.steps) {
        Ok(order) => order,
        Err(circle) => return Verdict::new(vec![constraints.describe_circle(network, &circle)]),
    };
    let checker = Checker {
        network,
        plan,
        scale: constraints.scale,
        gap: constraints.gap,
        entailment: Entailment::new(distances, order, network.start),
    };
    let mut stated = Stated::new(plan);
    checker.check_containment(&mut violations);
    checker.check_conflicts(&mut stated, &mut violations);
    checker.check_states(&mut violations);
    checker.check_departures(&mut violations);
    stated.check_rest(network, plan, &mut violations);
    checker.check_resources(&mut violations);
    checker.check_windows(&mut violations);
    checker.check_quality(&mut violations);
    controllability::check_controllability(network, plan, &constraints, &mut violations);
    Verdict::new(violations)
}

/// Every selected Ask has exactly one link, to a selected Tell that supports it.
fn check_links(network: &Network, plan: &Plan, violations: &mut Vec<Violation>) {
    let mut linked: BTreeMap<LabelId, u32> = BTreeMap::new();
    for link in &plan.causal_links {
        let (ask, tell) = (&network.labels[link.ask.index()], &network.labels[link.tell.index()]);
        let names = vec![network.label_name(link.ask), network.label_name(link.tell)];
        *linked.entry(link.ask).or_default() += 1;
        let wrong = if ask.mode != LabelMode::Ask || tell.mode != LabelMode::Tell {
            Some("a causal link must lead from an assertion to a requirement")
        } else if !labels::is_selected(network, plan, link.ask)
            || !labels::is_selected(network, plan, link.tell)
        {
            Some("a causal link joins intervals that the plan does not select")
        } else if !tell.literal.supports(&ask.literal) {
            Some("the assertion does not make the requirement hold")
        } else if lasting::is_own_effect(network, link.tell, link.ask) {
            Some("an activity cannot rely on its own effect")
        } else {
            None
        };
        if let Some(wrong) = wrong {
            let message = format!("{wrong}: {} and {}", names[1], names[0]);
            violations.push(Violation::new(Rule::Support, message).with_intervals(names));
        }
    }
    for label in labels::selected(network, plan) {
        if network.labels[label.index()].mode != LabelMode::Ask {
            continue;
        }
        let name = network.label_name(label);
        let message = match linked.get(&label) {
            None => format!("{name} has no causal link"),
            Some(1) => continue,
            Some(count) => format!("{name} has {count} causal links"),
        };
        violations.push(Violation::new(Rule::Support, message).with_intervals(vec![name]));
    }
}

struct Checker<'plan> {
    network: &'plan Network,
    plan: &'plan Plan,
    scale: i128,
    gap: i128,
    entailment: Entailment,
}

impl Checker<'_> {
    /// A link of a variable that does not last: the assertion contains the requirement in every schedule.
    fn check_containment(&self, violations: &mut Vec<Violation>) {
        for link in &self.plan.causal_links {
            if labels::is_lasting(self.network, link.ask) {
                continue;
            }
            let (ask, tell) = (interval(self.network, link.ask), interval(self.network, link.tell));
            if !self.entailment.is_at_least(tell.start, ask.start, 0)
                || !self.entailment.is_at_least(ask.end, tell.end, 0)
            {
                let names = vec![self.network.label_name(link.ask), self.network.label_name(link.tell)];
                let message = format!("{} is not always inside {}", names[0], names[1]);
                violations.push(Violation::new(Rule::Support, message).with_intervals(names));
            }
        }
    }

    /// Returns whether an interval never ends before it starts.
    fn is_forward(&self, span: Span) -> bool {
        self.entailment.happens_before(span.start, span.end)
    }

    /// Networks of programs have no such intervals; those that are read may.
    fn backward(&self, span: Span) -> Violation {
        let events = vec![node_name(self.network, span.start), node_name(self.network, span.end)];
        let message = format!("an interval that starts at {} may end earlier, at {}", events[0], events[1]);
        Violation::new(Rule::Form, message).with_events(events)
    }

    fn check_windows(&self, violations: &mut Vec<Violation>) {
        for (index, window) in self.plan.windows.iter().enumerate() {
            let node = NodeId::from_index(index);
            let expected = if self.plan.selected_nodes[index] { self.window(index) } else { None };
            // Plans that are read back have windows only where events have names.
            let is_unreported = window.is_none() && self.network.nodes[index].events.is_empty();
            if *window == expected || is_unreported {
                continue;
            }
            let name = node_name(self.network, node);
            let message = format!("the window of {name} is {}, not {}", show(expected), show(*window));
            violations.push(Violation::new(Rule::Window, message).with_events(vec![name]));
        }
    }

    /// The exact window of a node; `None` if nothing bounds it from below or the numbers do not fit.
    fn window(&self, index: usize) -> Option<Window> {
        let time = |scaled: i128| Time::from_wide(scaled, self.scale);
        let earliest = time(self.entailment.earliest[index]?)?;
        let latest = match self.entailment.latest[index] {
            Some(latest) => Bound::Finite(time(latest)?),
            None => Bound::Infinite,
        };
        Some(Window { earliest, latest })
    }
}

fn show(window: Option<Window>) -> String {
    match window {
        Some(window) => format!("[{},{}]", Bound::Finite(window.earliest), window.latest),
        None => "absent".to_owned(),
    }
}
