//! Stepping through the recorded search: which step is looked at, what the search knew there, and where to stop; and
//! two searches of the same mission side by side.

mod counts;
mod exclusion;
pub mod focus;
mod merged;
mod recording;
pub mod wording;

use std::sync::Arc;

use kirk::Search as SearchKind;
use kirk::{Event, ReplayStep, Trace, TreeNodeId};
use link::BothSearches;
use serde::{Deserialize, Serialize};
use snapshot::{Snapshot, Stage};
use tpn::{Network, Plan};

pub use counts::Counts;
pub use exclusion::{Exclusion, exclusions};
pub use focus::Focus;
pub use merged::{MergedTree, Share, ShareCounts};
pub use recording::{Recording, View, WindowChange, recorded};

/// The search as it is looked at. While a step is looked at, all panels show that step instead of the plan.
#[derive(Clone, Debug)]
pub struct SearchState {
    /// The step of each side and what the search knew there; nothing while the plan is shown. Without a comparison there
    /// is only the first side.
    views: [Option<View>; 2],
    /// Which side the other panels show and the keys step.
    side: usize,
    /// Whether both searches are wanted side by side.
    compares: bool,
    /// Whether both sides step together.
    is_linked: bool,
    /// Whether stepping and playing go from one key step to the next.
    only_key: bool,
    /// Both searches, with the network that they searched.
    comparison: Option<(Arc<BothSearches>, Arc<Network>)>,
    /// The revision whose comparison was asked for last.
    asked: Option<u64>,
    /// A step to go to, counted from 1, once there is a recorded search: a link named it.
    wanted_step: Option<usize>,
    /// Whether steps go by themselves.
    pub is_playing: bool,
    /// Where going on by itself, or running, stops.
    pub breakpoints: Breakpoints,
    /// How many steps go by in a second while playing.
    pub steps_per_sec: f64,
    /// Steps that are due, whole ones and the beginning of the next.
    due: f64,
}

/// The kinds of steps at which playing stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Breakpoints {
    /// An alternative is taken.
    pub decision: bool,
    pub failure: bool,
    /// Two conflicting intervals may overlap, or a resource be used too much.
    pub threat: bool,
    pub solution: bool,
}

/// What can be asked of the search's view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchCommand {
    /// So many steps forwards, or backwards if negative.
    Step(i64),
    /// To this step, from 0; beyond the last one, to the last.
    GoTo(usize),
    /// To the first step in a state of the search.
    GoToNode(TreeNodeId),
    /// To the next step (`true`) or the one before at which a breakpoint stops; to the end if there is none.
    Run(bool),
    /// Lets steps go by themselves, or stops.
    TogglePlaying,
    /// Where playing stops.
    SetBreakpoints(Breakpoints),
    /// How many steps go by in a second.
    SetSpeed(f64),
    /// Shows both searches side by side, or the one that planned.
    Compare(bool),
    /// Turns to one of the two that are compared.
    Turn(usize),
    /// Whether both step together.
    Link(bool),
    /// Whether stepping and playing pass over what only prepares a key step ([`focus::is_key`]).
    OnlyKey(bool),
    /// Shows the plan again.
    Close,
}

/// How fast steps can go by: slower is waiting, faster cannot be seen.
const SPEEDS: std::ops::RangeInclusive<f64> = 0.5..=100_000.0;

impl Default for SearchState {
    fn default() -> Self {
        Self {
            views: [None, None],
            side: 0,
            compares: false,
            is_linked: true,
            only_key: true,
            comparison: None,
            asked: None,
            wanted_step: None,
            is_playing: false,
            breakpoints: Breakpoints::default(),
            steps_per_sec: 4.0,
            due: 0.0,
        }
    }
}

impl SearchState {
    /// The step that the panels show, if one is looked at.
    pub fn step(&self) -> Option<&ReplayStep> {
        self.view(self.side).map(|view| view.step.as_ref())
    }

    /// Returns what one side looks at.
    pub fn view(&self, side: usize) -> Option<&View> {
        self.views.get(side)?.as_ref()
    }

    /// Returns what the panels show.
    pub fn shown(&self) -> Option<&View> {
        self.view(self.side)
    }

    /// Returns which side the panels show and the keys step.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Returns whether both searches are wanted side by side.
    pub fn compares(&self) -> bool {
        self.compares
    }

    /// Returns whether both step together.
    pub fn is_linked(&self) -> bool {
        self.is_linked
    }

    /// Returns whether stepping and playing go from one key step to the next.
    pub fn only_key(&self) -> bool {
        self.only_key
    }

    /// Returns what the search has selected at the step, in the form of a plan, if it is a step of the search of
    /// `snapshot`.
    pub fn plan(&self, snapshot: &Snapshot) -> Option<&Arc<Plan>> {
        let view = self.shown()?;
        let network = snapshot.network.as_ref()?;
        Arc::ptr_eq(view.recording.network(), network).then_some(&view.plan)
    }

    /// The recordings that can be stepped through: two if they are compared, otherwise at most one.
    pub fn recordings(&self, snapshot: Option<&Arc<Snapshot>>) -> Vec<Recording> {
        let Some(snapshot) = snapshot else { return Vec::new() };
        if let Some((comparison, network)) = &self.comparison
            && self.compares
        {
            return (0..2).filter_map(|side| Recording::compared(network, comparison, side)).collect();
        }
        Recording::planned(snapshot).into_iter().collect()
    }

    /// Goes to a step, counted from 1, as soon as there is a recorded search.
    pub fn want_step(&mut self, step: usize) {
        self.wanted_step = Some(step);
    }

    /// Forgets the step: there is another search, or none.
    pub fn close(&mut self) {
        self.views = [None, None];
        self.is_playing = false;
    }

    /// Forgets everything that belongs to a mission.
    pub fn forget(&mut self) {
        self.close();
        (self.comparison, self.asked, self.wanted_step) = (None, None, None);
    }

    /// Returns whether the core is to search in both ways for the text of `revision`, which it was not asked before.
    pub(crate) fn wants_comparison(&self, shown: Option<&Arc<Snapshot>>, revision: u64) -> bool {
        self.compares
            && self.comparison.is_none()
            && self.asked != Some(revision)
            && shown.is_some_and(|it| {
                it.revision == revision && it.stage == Stage::Complete && it.planning.is_some()
            })
    }

    /// The core was asked to search the text of `revision` in both ways.
    pub(crate) const fn note_asked(&mut self, revision: u64) {
        self.asked = Some(revision);
    }

    /// Takes both searches of `shown`. The step of the search that planned, which is of `kind`, is kept.
    pub fn take_comparison(
        &mut self,
        comparison: Arc<BothSearches>,
        shown: Option<&Arc<Snapshot>>,
        kind: SearchKind,
    ) {
        let shown = shown.filter(|shown| shown.revision == comparison.revision);
        let Some(network) = shown.and_then(|shown| shown.network.as_ref()) else { return };
        let step = self.step().map(|step| step.step);
        let side = comparison.searches.iter().position(|searched| searched.search == kind);
        self.views = [None, None];
        self.side = side.unwrap_or(0);
        self.comparison = Some((comparison, Arc::clone(network)));
        if let Some(step) = step {
            self.apply(SearchCommand::GoTo(step), shown);
        }
    }

    /// The core has failed: what was asked for will not come.
    pub fn give_comparison_up(&mut self, revision: Option<u64>) {
        if revision.is_some() && self.asked == revision && self.comparison.is_none() {
            self.compares = false;
        }
    }

    /// Adapts when `after` is shown instead of `before`: an equal search keeps its step.
    pub fn follow(&mut self, before: Option<&Arc<Snapshot>>, after: &Arc<Snapshot>) {
        let is_same = before
            .is_some_and(|before| before.network == after.network && recorded(before) == recorded(after));
        if is_same {
            self.move_to(after);
        } else {
            self.close();
            (self.comparison, self.asked) = (None, None);
        }
        if let (Some(step), Some(_)) = (self.wanted_step, recorded(after)) {
            self.wanted_step = None;
            if step > 0 {
                self.apply(SearchCommand::GoTo(step - 1), Some(after));
            }
        }
    }

    /// Keeps steps and comparison for an equal snapshot.
    fn move_to(&mut self, after: &Arc<Snapshot>) {
        if let (Some((_, network)), Some(same)) = (&mut self.comparison, &after.network) {
            *network = Arc::clone(same);
        }
        let recordings = self.recordings(Some(after));
        for (view, recording) in self.views.iter_mut().zip(recordings) {
            *view = view.as_ref().map(|view| view.moved_to(recording));
        }
    }

    /// Does what `command` asks for with the search of `snapshot`.
    pub fn apply(&mut self, command: SearchCommand, snapshot: Option<&Arc<Snapshot>>) {
        match command {
            SearchCommand::Close => self.close(),
            SearchCommand::SetBreakpoints(breakpoints) => self.breakpoints = breakpoints,
            SearchCommand::SetSpeed(speed) if speed.is_finite() => {
                self.steps_per_sec = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
            }
            SearchCommand::SetSpeed(_) => {}
            SearchCommand::OnlyKey(only_key) => self.only_key = only_key,
            SearchCommand::Compare(compares) => self.compare(compares, snapshot),
            SearchCommand::Turn(side) => self.turn(side, snapshot),
            SearchCommand::Link(is_linked) => {
                self.is_linked = is_linked;
                if let (true, Some(step)) = (is_linked, self.step().map(|step| step.step)) {
                    self.go_to(step, snapshot);
                }
            }
            _ => {
                if let Some(target) = self.target(command, snapshot) {
                    self.go_to(target, snapshot);
                }
            }
        }
    }

    fn compare(&mut self, compares: bool, snapshot: Option<&Arc<Snapshot>>) {
        if self.compares == compares {
            return;
        }
        let shown = self.shown().cloned();
        self.compares = compares;
        if compares {
            return;
        }
        // The step of the search that planned stays if it is the one looked at.
        (self.views, self.side) = ([None, None], 0);
        (self.comparison, self.asked) = (None, None);
        let planned = self.recordings(snapshot).into_iter().next();
        if let (Some(view), Some(planned)) = (shown, planned)
            && planned.trace() == view.recording.trace()
        {
            self.go_to(view.step.step, snapshot);
        }
    }

    fn turn(&mut self, side: usize, snapshot: Option<&Arc<Snapshot>>) {
        if side < self.recordings(snapshot).len() {
            self.side = side;
        }
    }

    /// The sides that step when a command steps.
    fn stepping(&self, count: usize) -> std::ops::Range<usize> {
        if count == 2 && self.is_linked { 0..2 } else { self.side.min(count)..(self.side + 1).min(count) }
    }

    /// The step that a command leads to.
    fn target(&mut self, command: SearchCommand, snapshot: Option<&Arc<Snapshot>>) -> Option<usize> {
        let recordings = self.recordings(snapshot);
        let stepping = self.stepping(recordings.len());
        let steps = recordings.get(stepping.clone())?.iter().map(Recording::steps).max()?;
        let last = steps.saturating_sub(1);
        let shown = |side: usize| self.view(side).map(|view| view.step.step);
        let current = stepping.clone().filter_map(shown).max();
        let stops = |step: &usize| {
            recordings[stepping.clone()].iter().any(|it| stops_at(it.trace(), *step, self.breakpoints))
        };
        let target = match command {
            SearchCommand::TogglePlaying => {
                let starts_over = current == Some(last) && !self.is_playing;
                self.is_playing = !self.is_playing;
                self.due = 0.0;
                if starts_over { 0 } else { current.unwrap_or(0) }
            }
            SearchCommand::Step(steps) => {
                let sides = &recordings[stepping];
                let count = usize::try_from(steps.unsigned_abs()).unwrap_or(usize::MAX);
                if steps < 0 {
                    let until = current.unwrap_or(last + 1);
                    self.passing(sides, (0..until).rev(), count).unwrap_or(0)
                } else {
                    let from = current.map_or(0, |step| step + 1);
                    self.passing(sides, from..=last, count).unwrap_or(last)
                }
            }
            SearchCommand::GoTo(step) => step.min(last),
            SearchCommand::GoToNode(node) => {
                let trace = recordings.get(self.side)?.trace();
                trace.events.iter().position(|entry| entry.tree_node == node)?
            }
            SearchCommand::Run(true) => {
                let from = current.map_or(0, |step| step + 1);
                (from..=last).find(stops).unwrap_or(last)
            }
            SearchCommand::Run(false) => {
                let until = current.unwrap_or(last + 1);
                (0..until).rev().find(stops).unwrap_or(0)
            }
            _ => return None,
        };
        Some(target)
    }

    /// Lets `seconds` go by. Returns whether another step is shown.
    pub fn advance(&mut self, seconds: f64, snapshot: Option<&Arc<Snapshot>>) -> bool {
        if !self.is_playing {
            return false;
        }
        self.due += seconds * self.steps_per_sec;
        let steps = self.due as usize;
        if steps == 0 {
            return false;
        }
        self.due -= steps as f64;
        let recordings = self.recordings(snapshot);
        let stepping = self.stepping(recordings.len());
        let sides = recordings.get(stepping.clone()).unwrap_or_default();
        let Some(last) = sides.iter().map(|it| it.steps().saturating_sub(1)).max() else {
            self.is_playing = false;
            return false;
        };
        let from = stepping.filter_map(|side| self.view(side).map(|view| view.step.step)).max().unwrap_or(0);
        let until = self.passing(sides, from + 1..=last, steps).unwrap_or(last);
        let stops = |step: &usize| sides.iter().any(|it| stops_at(it.trace(), *step, self.breakpoints));
        let stop = (from + 1..=until).find(stops);
        self.is_playing = stop.is_none() && until < last;
        self.go_to(stop.unwrap_or(until), snapshot);
        true
    }

    /// The step that the `count`th step leads to over those of `way`, or the last one of them that can be stepped to.
    fn passing(&self, sides: &[Recording], way: impl Iterator<Item = usize>, count: usize) -> Option<usize> {
        let is_stop = |step: &usize| {
            let is_key = |it: &Recording| {
                it.trace().events.get(*step).is_some_and(|entry| focus::is_key(&entry.event))
            };
            !self.only_key || sides.iter().any(is_key)
        };
        way.filter(is_stop).take(count.max(1)).last()
    }

    /// Shows a step on the sides that step; a side with fewer steps shows its last.
    fn go_to(&mut self, step: usize, snapshot: Option<&Arc<Snapshot>>) {
        let recordings = self.recordings(snapshot);
        for side in self.stepping(recordings.len()) {
            let step = step.min(recordings[side].steps().saturating_sub(1));
            if self
                .view(side)
                .is_none_or(|view| view.step.step != step || !view.recording.is(&recordings[side]))
            {
                self.views[side] = View::at(&recordings[side], step, self.view(side));
            }
        }
    }
}

/// Returns whether playing and running stop at a step.
fn stops_at(trace: &Trace, step: usize, breakpoints: Breakpoints) -> bool {
    let Some(entry) = trace.events.get(step) else { return false };
    match entry.event {
        Event::Decide { .. } => breakpoints.decision,
        Event::TryLink { .. }
        | Event::TryOrder { .. }
        | Event::TryUseOrder { .. }
        | Event::TryStart { .. }
            if trace.is_conflict_driven() =>
        {
            breakpoints.decision
        }
        Event::Threat { .. } | Event::Overload { .. } | Event::OutOfRange { .. } => breakpoints.threat,
        Event::Solution { .. } => breakpoints.solution,
        _ => breakpoints.failure && focus::is_failure(&entry.event),
    }
}
