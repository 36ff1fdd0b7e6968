//! The state as it is described, once for all who read it from outside: host pages and tests (DESIGN 4.3), and the
//! questions of lessons.
//!
//! The types here are what is written as JSON, and `web/enroute.d.ts` is made from them by the test in `typescript.rs`.
//! Their documentation is the interface's. [`Description`] works out each section when it is first read; the facts of
//! lessons are read from it.

mod execution;
mod facts;
mod known;
mod lesson;
mod library;
mod program;
mod review;
mod search;
mod terrain;
#[cfg(test)]
mod typescript;

use std::cell::OnceCell;
use std::collections::BTreeMap;

use rmpl::diagnostic::Severity;
use serde::Serialize;
use serde_json::{Value, json};
use snapshot::paths_json::traverses_json;
use snapshot::{Problem, Snapshot};
use tpn::Network;
use tpn::plan_json::plan_to_json;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;
use crate::state::snapshots::Status;

pub use self::execution::{Contradiction, Execution, Pinned, Robustness, RuleProofs};
pub use self::lesson::{Lessons, Manual};
pub use self::library::Library;
pub use self::program::{PlantState, ProgramRun};
pub use self::review::Review;
pub use self::search::Search;
pub use self::terrain::{Terrain, Vehicle};

/// Everything the page shows. All results belong to `shownRevision`, which is `revision` once `status` is not `working`.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct State {
    /// Counts the edits of the text.
    #[cfg_attr(test, ts(type = "number"))]
    pub revision: u64,
    /// The last revision for which there is an answer.
    #[cfg_attr(test, ts(type = "number | null"))]
    pub answered_revision: Option<u64>,
    /// The revision of what is shown.
    #[cfg_attr(test, ts(type = "number | null"))]
    pub shown_revision: Option<u64>,
    #[cfg_attr(
        test,
        ts(
            type = "\"working\" | \"broken\" | \"empty\" | \"program\" | \"plan\" | \"no-plan\" | \"undecided\""
        )
    )]
    pub status: &'static str,
    /// Whether the page shows an answer to an older text.
    pub is_stale: bool,
    /// The name of the open mission.
    pub mission: String,
    /// The missions that the user has.
    pub library: Library,
    pub workspace: &'static str,
    pub active_panel: &'static str,
    /// The panels on screen, by name.
    pub panels: Vec<&'static str>,
    #[cfg_attr(test, ts(type = "\"dark\" | \"light\""))]
    pub theme: &'static str,
    pub diagnostics: Vec<Diagnostic>,
    /// How many of each the network has; `null` while the text does not compile.
    pub tpn: Option<NetworkSize>,
    #[cfg_attr(test, ts(type = "Plan | null"))]
    pub plan: Option<Value>,
    /// No plan is better than this value in the first undecided goal, if the plan is not known to be optimal.
    #[cfg_attr(test, ts(type = "Time | null"))]
    pub bound: Option<Value>,
    /// The verdict of the independent checker on the plan.
    pub verdict: Option<Verdict>,
    /// Why there is no plan.
    pub failure: Option<Failure>,
    /// The lessons.
    pub lesson: Lessons,
    pub manual: Manual,
    pub review: Review,
    /// The comparison of the mission with another one.
    pub compare: Option<Comparison>,
    pub search: Search,
    /// The run of a control program; `null` for a mission.
    pub hca: Option<ProgramRun>,
    pub vehicles: Vec<Vehicle>,
    #[cfg_attr(test, ts(type = "Traverse[] | null"))]
    pub traverses: Option<Value>,
    /// The time shown, in mission units.
    pub time: f64,
    pub end_time: f64,
    pub is_playing: bool,
    /// The range of times that is selected on the timeline.
    pub time_range: Option<[f64; 2]>,
    pub pinned: Option<Pinned>,
    /// The run in the Execute workspace.
    pub execution: Option<Execution>,
    /// The results of Monte Carlo runs; `null` before the first run.
    pub robustness: Option<Robustness>,
    /// The search for counterexamples of the passed items of the review; `null` before the first one.
    pub contradiction: Option<Contradiction>,
    /// Which flight rules hold in every plan; `null` before the first proof.
    pub rule_proofs: Option<RuleProofs>,
    #[cfg_attr(test, ts(type = "{ kind: string; name: string | null; id: unknown } | null"))]
    pub selection: Value,
    pub caret: Caret,
    pub can_undo: bool,
    pub can_redo: bool,
    /// The dialog that is open.
    pub dialog: Option<&'static str>,
    pub terrain: Terrain,
    /// The messages on screen.
    pub toasts: Vec<String>,
    /// What draws the canvas: WebGPU or WebGL2.
    pub renderer: String,
    pub timings: Timings,
}

/// An error, a warning or a note about a place of the text.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Diagnostic {
    pub code: String,
    #[cfg_attr(test, ts(type = "\"error\" | \"warning\" | \"note\""))]
    pub severity: Severity,
    pub message: String,
    pub span: Span,
    pub hint: Option<String>,
    /// The labels of its quick fixes.
    pub fixes: Vec<String>,
}

/// A place of the text: `start` and `end` in bytes, `line` and `column` from 1.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Span {
    pub start: u32,
    pub end: u32,
    pub line: u32,
    pub column: u32,
}

/// Where the cursor is (`head`) and where its selection starts (`anchor`), in bytes.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Caret {
    pub anchor: usize,
    pub head: usize,
}

/// How large a network is.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct NetworkSize {
    pub nodes: usize,
    pub arcs: usize,
    pub decisions: usize,
    pub occurrences: usize,
}

/// The verdict of the independent checker on a plan.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Verdict {
    pub valid: bool,
    pub violations: Vec<String>,
}

/// Why there is no plan.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Failure {
    pub reasons: Vec<Reason>,
    /// The labeled intervals that take part.
    pub conditions: Vec<String>,
    /// What would make a plan possible.
    pub relaxations: Vec<String>,
}

/// One minimal conflict: the choices that it holds for, and what is wrong then.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Reason {
    pub choices: BTreeMap<String, u32>,
    pub kind: &'static str,
    pub message: String,
}

/// The comparison of the mission with another one.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Comparison {
    pub with: String,
    pub planned: bool,
}

/// Milliseconds by stage, for the revision shown.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Timings {
    pub parse: f64,
    pub compile: f64,
    pub plan: f64,
    pub layout: f64,
    pub total: f64,
    /// The app's own code in the last frame.
    pub frame: f64,
    /// The whole time of the previous frame on the page's thread.
    pub frame_with_shell: Option<f64>,
    /// The app's code in the frame that first shows the answer to the present text; `null` until then.
    pub answer_frame: Option<f64>,
    /// When that frame was ready, on the clock of `performance.now()`; `null` until then.
    pub shown_at: Option<f64>,
}

/// The state, to be described: each section is worked out when it is first read.
pub struct Description<'a> {
    state: &'a AppState,
    search: OnceCell<Search>,
    program: OnceCell<Option<ProgramRun>>,
    terrain: OnceCell<Terrain>,
    execution: OnceCell<Option<Execution>>,
    failure: OnceCell<Option<Failure>>,
}

impl<'a> Description<'a> {
    /// Describes a state.
    pub const fn of(state: &'a AppState) -> Self {
        Self {
            state,
            search: OnceCell::new(),
            program: OnceCell::new(),
            terrain: OnceCell::new(),
            execution: OnceCell::new(),
            failure: OnceCell::new(),
        }
    }

    fn search(&self) -> &Search {
        self.search.get_or_init(|| search::search(self.state))
    }

    fn program(&self) -> Option<&ProgramRun> {
        let run = || program::program_run(&self.state.automaton, self.state.document.revision());
        self.program.get_or_init(run).as_ref()
    }

    fn terrain(&self) -> &Terrain {
        self.terrain.get_or_init(|| terrain::terrain(self.state))
    }

    fn execution(&self) -> Option<&Execution> {
        self.execution.get_or_init(|| execution::execution(self.state)).as_ref()
    }

    fn failure(&self) -> Option<&Failure> {
        self.failure.get_or_init(|| failure(self.state)).as_ref()
    }
}

impl State {
    /// All that is described of a state.
    pub fn of(state: &AppState) -> Self {
        let latest = state.snapshots.latest();
        let shown = state.looked_at();
        let network = shown.and_then(|shown| shown.network.as_deref());
        let planning = shown.and_then(|shown| shown.planning.as_deref());
        let plan = network.zip(shown.and_then(|shown| shown.plan()));
        let caret = state.document.caret();
        Self {
            revision: state.document.revision(),
            answered_revision: latest.map(|latest| latest.revision),
            shown_revision: shown.map(|shown| shown.revision),
            status: if state.is_improving() { "working" } else { status_name(state.status()) },
            is_stale: state.snapshots.is_stale(state.document.revision()),
            mission: state.mission.to_string(),
            library: library::library(state),
            workspace: state.window.workspace.name(),
            active_panel: state.window.active_panel.name(),
            panels: state.window.panels_on_screen.iter().map(|panel| panel.name()).collect(),
            theme: if state.is_dark() { "dark" } else { "light" },
            diagnostics: state.snapshots.problems().iter().map(diagnostic).collect(),
            tpn: network.map(network_size),
            plan: plan.map(|(network, plan)| plan_to_json(network, plan)),
            bound: planning.and_then(|planning| planning.outcome.bound).map(|bound| json!(bound)),
            verdict: planning.and_then(|planning| planning.verdict.as_ref()).map(verdict),
            failure: failure(state),
            lesson: lesson::lessons(state),
            manual: lesson::manual(state),
            review: review::review(state),
            compare: state
                .compare
                .reference()
                .map(|side| Comparison { with: side.name.clone(), planned: side.is_planned }),
            search: search::search(state),
            hca: program::program_run(&state.automaton, state.document.revision()),
            vehicles: shown.map(|shown| terrain::vehicles(state, shown)).unwrap_or_default(),
            traverses: shown
                .zip(network)
                .map(|(shown, network)| traverses_json(&shown.traverses, network, &shown.program.world)),
            time: state.playback.time,
            end_time: state.playback.end,
            is_playing: state.playback.is_playing,
            time_range: state.time_range,
            pinned: shown.and_then(|shown| execution::pinned(state, shown)),
            execution: execution::execution(state),
            robustness: execution::robustness(state),
            contradiction: execution::contradiction(state),
            rule_proofs: execution::rule_proofs(state),
            selection: state.selection.to_json(network),
            caret: Caret { anchor: caret.anchor, head: caret.head },
            can_undo: state.document.can_undo(),
            can_redo: state.document.can_redo(),
            dialog: state.window.dialog.as_ref().map(crate::dialog::Dialog::name),
            terrain: terrain::terrain(state),
            toasts: state.window.toasts.shown().iter().map(|toast| toast.text.clone()).collect(),
            renderer: state.frame.renderer.clone(),
            timings: timings(state, shown),
        }
    }
}

fn network_size(network: &Network) -> NetworkSize {
    NetworkSize {
        nodes: network.nodes.len(),
        arcs: network.arcs.len(),
        decisions: network.decisions.len(),
        occurrences: network.occurrences.len(),
    }
}

fn verdict(verdict: &verify::Verdict) -> Verdict {
    Verdict {
        valid: verdict.valid,
        violations: verdict.violations.iter().map(|it| it.message.clone()).collect(),
    }
}

fn diagnostic(problem: &Problem) -> Diagnostic {
    Diagnostic {
        code: problem.code.to_string(),
        severity: problem.severity,
        message: problem.message.clone(),
        span: Span {
            start: problem.span.start,
            end: problem.span.end,
            line: problem.line,
            column: problem.column,
        },
        hint: problem.hint.as_ref().map(ToString::to_string),
        fixes: problem.fixes.iter().map(|fix| fix.label.clone()).collect(),
    }
}

fn failure(state: &AppState) -> Option<Failure> {
    let snapshot = state.looked_at()?;
    let (network, planning) = (snapshot.network.as_deref()?, snapshot.planning.as_deref()?);
    let failure = planning.outcome.failure.as_ref()?;
    let reasons = failure.reasons.iter().map(|reason| Reason {
        choices: reason
            .choices
            .iter()
            .map(|choice| (Network::decision_name(choice.decision), choice.alternative))
            .collect(),
        kind: reason.kind.name(),
        message: reason.message.clone(),
    });
    let conditions =
        failure.reasons.iter().flat_map(|reason| &reason.conflict).filter_map(|member| match member {
            kirk::Member::Condition(label) => Some(network.label_name(*label)),
            kirk::Member::Use(used) => Some(network.use_name(*used)),
            kirk::Member::Bound(_) => None,
        });
    Some(Failure {
        reasons: reasons.collect(),
        conditions: conditions.collect(),
        relaxations: planning.ways_out().into_iter().map(str::to_owned).collect(),
    })
}

fn timings(state: &AppState, shown: Option<&std::sync::Arc<Snapshot>>) -> Timings {
    let timings = shown.map(|shown| shown.timings).unwrap_or_default();
    let layout = state.frame.layout_millis;
    let revision = state.document.revision();
    let answer = state.frame.answer.filter(|answer| answer.revision == revision);
    Timings {
        parse: timings.parse_millis,
        compile: timings.compile_millis,
        plan: timings.plan_millis,
        layout,
        total: timings.parse_millis + timings.compile_millis + timings.plan_millis + layout,
        frame: state.frame.cpu_millis,
        frame_with_shell: state.frame.total_millis,
        answer_frame: answer.map(|answer| answer.cpu_millis),
        shown_at: answer.map(|answer| answer.done_secs * 1000.0),
    }
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Working => "working",
        Status::Broken => "broken",
        Status::Empty => "empty",
        Status::Program => "program",
        Status::Plan => "plan",
        Status::NoPlan => "no-plan",
        Status::Undecided => "undecided",
    }
}
