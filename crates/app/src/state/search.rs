//! Stepping through the recorded search: which step is looked at, what the search knew there, and where to stop.

use std::sync::Arc;

use kirk::{Event, Replay, ReplayStep, Trace, TreeNodeId};
use mission::Snapshot;
use serde::{Deserialize, Serialize};
use tpn::{Network, Plan};

/// The search as it is looked at. While a step is looked at, all panels show that step instead of the plan.
#[derive(Clone, Debug, Default)]
pub struct SearchState {
    /// The step and what the search knew there; nothing while the plan is shown.
    view: Option<View>,
    /// Whether steps go by themselves.
    pub is_playing: bool,
    /// Where going on by itself, or running, stops.
    pub breakpoints: Breakpoints,
    /// Seconds since the last step went by itself.
    elapsed_secs: f64,
}

#[derive(Clone, Debug)]
struct View {
    /// The snapshot whose search this is.
    snapshot: Arc<Snapshot>,
    step: Arc<ReplayStep>,
    /// What is selected at the step, in the form of a plan, for the panels that draw plans.
    plan: Arc<Plan>,
}

/// The kinds of steps at which playing stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Breakpoints {
    /// An alternative is taken.
    pub decision: bool,
    /// A dead end.
    pub failure: bool,
    /// Two conflicting intervals may overlap.
    pub threat: bool,
    /// A plan.
    pub solution: bool,
}

/// What can be asked of the search's view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SearchCommand {
    /// So many steps forwards, or backwards if negative.
    Step(i64),
    /// To this step.
    GoTo(usize),
    /// To the first step in a state of the search.
    GoToNode(TreeNodeId),
    /// To the next step (`true`) or the one before at which a breakpoint stops; to the end if there is none.
    Run(bool),
    /// Lets steps go by themselves, or stops.
    TogglePlaying,
    /// Where playing stops.
    SetBreakpoints(Breakpoints),
    /// Shows the plan again.
    Close,
}

/// Steps a second while playing.
const STEPS_PER_SEC: f64 = 4.0;

impl SearchState {
    /// The step that is looked at, if one is.
    pub fn step(&self) -> Option<&ReplayStep> {
        self.view.as_ref().map(|view| view.step.as_ref())
    }

    /// What the search has selected at the step, in the form of a plan.
    pub fn plan(&self, snapshot: &Arc<Snapshot>) -> Option<&Plan> {
        let view = self.view.as_ref().filter(|view| Arc::ptr_eq(&view.snapshot, snapshot))?;
        Some(&view.plan)
    }

    /// Forgets the step: there is another search, or none.
    pub fn close(&mut self) {
        self.view = None;
        self.is_playing = false;
    }

    /// Does what `command` asks for with the search of `snapshot`.
    pub fn apply(&mut self, command: SearchCommand, snapshot: Option<&Arc<Snapshot>>) {
        let Some((snapshot, trace)) = snapshot.and_then(|it| Some((it, recorded(it)?))) else {
            self.close();
            return;
        };
        let current = self.view.as_ref().map(|view| view.step.step);
        let last = trace.events.len().saturating_sub(1);
        let target = match command {
            SearchCommand::Close => {
                self.close();
                return;
            }
            SearchCommand::SetBreakpoints(breakpoints) => {
                self.breakpoints = breakpoints;
                return;
            }
            SearchCommand::TogglePlaying => {
                self.is_playing = !self.is_playing;
                self.elapsed_secs = 0.0;
                match current {
                    None => 0,
                    Some(step) if step == last && self.is_playing => 0,
                    Some(step) => step,
                }
            }
            SearchCommand::Step(steps) => match current {
                None if steps < 0 => last,
                None => 0,
                Some(step) => step.saturating_add_signed(steps as isize).min(last),
            },
            SearchCommand::GoTo(step) => step.min(last),
            SearchCommand::GoToNode(node) => {
                let entry = trace.events.iter().position(|entry| entry.tree_node == node);
                entry.unwrap_or(current.unwrap_or(0))
            }
            SearchCommand::Run(true) => {
                let from = current.map_or(0, |step| step + 1);
                (from..=last).find(|&step| self.stops_at(trace, step)).unwrap_or(last)
            }
            SearchCommand::Run(false) => {
                let until = current.unwrap_or(last + 1);
                (0..until).rev().find(|&step| self.stops_at(trace, step)).unwrap_or(0)
            }
        };
        self.show(snapshot, target);
    }

    /// Lets `seconds` go by. Answers whether another step is shown.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        if !self.is_playing {
            return false;
        }
        self.elapsed_secs += seconds * rate;
        let Some(view) = self.view.clone() else { return false };
        let Some(trace) = recorded(&view.snapshot) else { return false };
        let steps = (self.elapsed_secs * STEPS_PER_SEC) as usize;
        if steps == 0 {
            return false;
        }
        self.elapsed_secs -= steps as f64 / STEPS_PER_SEC;
        let last = trace.events.len().saturating_sub(1);
        let from = view.step.step;
        let until = (from + steps).min(last);
        let stop = (from + 1..=until).find(|&step| self.stops_at(trace, step));
        self.is_playing = stop.is_none() && until < last;
        self.show(&view.snapshot, stop.unwrap_or(until));
        true
    }

    fn stops_at(&self, trace: &Trace, step: usize) -> bool {
        let Some(entry) = trace.events.get(step) else { return false };
        match entry.event {
            Event::Decide { .. } => self.breakpoints.decision,
            Event::Inconsistent { .. }
            | Event::Unclosable { .. }
            | Event::Unresolvable { .. }
            | Event::Known => self.breakpoints.failure,
            Event::Threat { .. } => self.breakpoints.threat,
            Event::Solution { .. } => self.breakpoints.solution,
            _ => false,
        }
    }

    fn show(&mut self, snapshot: &Arc<Snapshot>, step: usize) {
        let (Some(network), Some(trace)) = (snapshot.network.as_deref(), recorded(snapshot)) else { return };
        let Some(replay) = Replay::new(network, None, trace) else { return };
        let step = replay.at(step);
        let plan = as_plan(network, &step);
        self.view = Some(View { snapshot: Arc::clone(snapshot), step: Arc::new(step), plan: Arc::new(plan) });
    }
}

/// The recorded search of a snapshot, if there is one with at least one step.
pub fn recorded(snapshot: &Snapshot) -> Option<&Trace> {
    let trace = snapshot.planning.as_ref()?.outcome.trace.as_ref()?;
    (!trace.events.is_empty()).then_some(trace)
}

fn as_plan(network: &Network, step: &ReplayStep) -> Plan {
    let mut plan = Plan {
        choices: step.choices.clone(),
        selected_nodes: vec![false; network.nodes.len()],
        selected_arcs: vec![false; network.arcs.len()],
        causal_links: step.links.clone(),
        conflict_order: step.orders.clone(),
        orderings_added: step.orders.clone(),
        windows: step.windows.clone(),
    };
    plan.windows.resize(network.nodes.len(), None);
    for node in &step.nodes {
        if let Some(selected) = plan.selected_nodes.get_mut(node.index()) {
            *selected = true;
        }
    }
    for arc in &step.arcs {
        if let Some(selected) = plan.selected_arcs.get_mut(arc.index()) {
            *selected = true;
        }
    }
    plan
}
