//! The mission as it is executed in the simulated world: the disturbances made by hand, the run that they lead to, and
//! what of it has happened at the time shown.
//!
//! The script of disturbances is the truth. The core works the whole run out from it, so time can be moved back and
//! forth in it; a disturbance made at the time shown changes nothing before that time.

mod moment;

use std::sync::Arc;

use exact::{Rational, Time};
use executive::{Disturbance, Entry, Script};
use link::{Request, Response, Update};
use nalgebra::Point2;
use serde_json::{Value, json};
use snapshot::{Execution, Snapshot};

use super::terrain::Tool;
use super::{AppState, Effect, PlanSettings, ToastKind, playback};
use crate::host::FileKind;
use crate::workspace::Workspace;

pub use moment::{Moment, Pending};

/// The run that is watched.
#[derive(Debug, Default)]
pub struct ExecutionState {
    script: Script,
    run: Option<Arc<Execution>>,
    trouble: Option<String>,
    asked: Option<(u64, Script)>,
    /// The log of an opened file, until the run that it is compared with is there.
    expected: Option<Vec<Entry>>,
    view: Option<View>,
}

/// The run at one time.
#[derive(Debug)]
struct View {
    base: Arc<Snapshot>,
    run: Arc<Execution>,
    plan: usize,
    happened: usize,
    snapshot: Arc<Snapshot>,
    moment: Moment,
}

/// What can be asked of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum ExecutionCommand {
    /// Something goes otherwise than planned, from the time shown on.
    Disturb(Disturbance),
    /// A condition is withdrawn at the time shown.
    Withdraw(smol_str::SmolStr),
    /// A round obstacle appears at the time shown.
    Appear {
        center_m: Point2<f64>,
        /// Its radius in metres.
        radius_m: f64,
        /// Whether the tool that places it stays in hand.
        again: bool,
    },
    /// A vehicle drives more slowly from the time shown on; at a share of 0 it stands.
    SlowDown {
        vehicle: smol_str::SmolStr,
        /// The share of its traverse's greatest speed that is left, from 0 to 1.
        factor: Rational,
        /// For how long, in mission units.
        duration: Time,
    },
    /// A disturbance, by its place in the script, did not happen.
    TakeBack(usize),
    /// Whether nature chooses so as to break the plan, from the start.
    Oppose(bool),
    /// Everything goes as planned, from the start.
    Reset,
    /// Saves the run as a file.
    Save,
    /// Opens the file of a run, to replay it.
    Open,
}

impl ExecutionState {
    /// What goes otherwise than planned.
    pub fn disturbances(&self) -> &[Disturbance] {
        &self.script.disturbances
    }

    /// The run, which may belong to an older text or script while the next one is worked out.
    pub fn run(&self) -> Option<&Arc<Execution>> {
        self.run.as_ref()
    }

    /// Why there is no run.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }

    /// What has happened at the time shown.
    pub fn moment(&self) -> Option<&Moment> {
        self.view.as_ref().map(|view| &view.moment)
    }

    /// The obstacles that have appeared by `time`, with centres and radii in metres.
    pub fn appeared(&self, time: f64) -> impl Iterator<Item = (Point2<f64>, f64)> + '_ {
        self.disturbances().iter().filter_map(move |disturbance| match *disturbance {
            Disturbance::Obstacle { at, x, y, radius, .. } if has_come(at, time) => {
                Some((Point2::new(x, y), radius))
            }
            _ => None,
        })
    }

    /// Whether nature chooses so as to break the plan.
    pub const fn is_opposed(&self) -> bool {
        self.script.adversary
    }

    /// Whether a newer run than the one shown is being worked out.
    pub fn is_working(&self) -> bool {
        let is_answered = |run: &Arc<Execution>| {
            self.asked
                .as_ref()
                .is_some_and(|(revision, script)| (run.revision, &run.script) == (*revision, script))
        };
        self.asked.is_some() && self.trouble.is_none() && !self.run.as_ref().is_some_and(is_answered)
    }

    /// The run that was asked for does not come.
    pub(super) fn give_up(&mut self) {
        if self.is_working() {
            self.trouble = Some("working the run out was stopped".to_owned());
        }
    }

    /// Forgets everything: another mission was opened.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

impl AppState {
    /// What panels draw: while a mission is executed, the plan followed at the time shown with what has happened;
    /// otherwise [`AppState::shown`].
    pub fn looked_at(&self) -> Option<&Arc<Snapshot>> {
        let view = self.execution.view.as_ref().filter(|_| self.is_executing());
        view.map(|view| &view.snapshot).or_else(|| self.shown())
    }

    /// Whether a run of the mission is shown.
    pub fn is_executing(&self) -> bool {
        let belongs = |run: &Arc<Execution>| {
            self.shown().is_some_and(|shown| shown.revision == run.revision && shown.plan().is_some())
        };
        self.workspace == Workspace::Execute && self.execution.run.as_ref().is_some_and(belongs)
    }

    /// The run of the mission, while it is shown.
    pub fn run_shown(&self) -> Option<&Execution> {
        self.execution.run.as_deref().filter(|_| self.is_executing())
    }

    /// What the planning core is to execute, if it was not asked already.
    pub(crate) fn run_to_ask_for(&mut self) -> Option<Request> {
        let update = self.update_shown().filter(|_| self.workspace == Workspace::Execute)?;
        let wanted = (update.revision, self.execution.script.clone());
        if self.execution.asked.as_ref() == Some(&wanted) {
            return None;
        }
        let script = wanted.1.clone();
        self.execution.asked = Some(wanted);
        self.execution.trouble = None;
        Some(Request::Execute { update, script })
    }

    /// The present text as the core was asked to plan it, once it has a plan.
    pub(crate) fn update_shown(&self) -> Option<Update> {
        self.update_planned().filter(|_| self.shown().is_some_and(|shown| shown.plan().is_some()))
    }

    /// The present text as it was planned, whether or not there is a plan; nothing while that is not shown.
    pub(crate) fn update_planned(&self) -> Option<Update> {
        let shown = self.shown()?;
        let revision = self.document.revision();
        if shown.revision != revision {
            return None;
        }
        let PlanSettings { goal, search, seed, trace } = self.settings.plan.clone();
        Some(Update { revision, source: Arc::clone(&shown.source).into(), goal, search, seed, trace })
    }

    pub(super) fn take_run(&mut self, answer: Response) {
        match answer {
            Response::Execution(run) if self.is_wanted(&run) => {
                if let Some(expected) = self.execution.expected.take() {
                    self.compare(&expected, &run);
                }
                self.execution.run = Some(run);
                self.follow_run();
                self.fit_time();
            }
            Response::NotExecuted { revision, reason } if revision == self.document.revision() => {
                self.execution.trouble = Some(reason);
                self.execution.run = None;
                self.execution.view = None;
            }
            _ => {}
        }
    }

    fn is_wanted(&self, run: &Execution) -> bool {
        run.revision == self.document.revision() && run.script == self.execution.script
    }

    /// Says whether a replay is the same as what was saved.
    fn compare(&mut self, expected: &[Entry], run: &Execution) {
        let differing = expected.iter().zip(&run.log).position(|(one, other)| one != other);
        let first = differing
            .or_else(|| (expected.len() != run.log.len()).then(|| expected.len().min(run.log.len())));
        match first {
            None => {
                let text = format!("Replayed exactly: all {} entries agree", expected.len());
                self.toasts.add(ToastKind::Done, text);
            }
            Some(at) => {
                let text = format!("The replay differs from the saved log at entry {}", at + 1);
                self.toasts.add(ToastKind::Failed, text);
            }
        }
    }

    /// Works out what the time shown shows of the run, if that has changed.
    pub(crate) fn follow_run(&mut self) {
        if !self.is_executing() {
            return;
        }
        let Some((run, base)) = self.execution.run.clone().zip(self.shown().cloned()) else { return };
        let time = self.playback.time;
        let Some((plan, executed)) = run.plan_at(time) else { return };
        let happened = executed.times.iter().flatten().filter(|&&at| has_come(at, time)).count();
        let is_same = self.execution.view.as_ref().is_some_and(|view| {
            Arc::ptr_eq(&view.run, &run)
                && Arc::ptr_eq(&view.base, &base)
                && (view.plan, view.happened) == (plan, happened)
        });
        if is_same {
            return;
        }
        let (snapshot, moment) = moment::at(&base, executed, time);
        self.execution.view = Some(View { base, run, plan, happened, snapshot: Arc::new(snapshot), moment });
    }

    /// Lets time end where the run does, or where the plan does when none is watched.
    pub(super) fn fit_time(&mut self) {
        let end = match &self.execution.run {
            Some(run) if self.is_executing() => Some(playback::number(run.end())),
            _ => None,
        };
        if let Some(end) = end {
            self.playback.end = end;
            self.playback.time = self.playback.time.min(end);
        } else if let Some(plan) = self.shown().cloned().as_ref().and_then(|shown| shown.plan()) {
            self.playback.fit(plan);
        }
    }

    pub(super) fn apply_to_run(&mut self, command: ExecutionCommand) {
        match command {
            ExecutionCommand::Disturb(disturbance) => {
                let now = self.settle_time();
                if disturbance.since().is_some_and(|since| since < now) {
                    self.toasts
                        .add(ToastKind::Failed, "What has happened stays: nothing goes otherwise before now");
                    return;
                }
                self.disturb(disturbance);
            }
            ExecutionCommand::Withdraw(condition) => {
                let at = self.settle_time();
                self.disturb(Disturbance::Withdrawn { condition, at });
            }
            ExecutionCommand::Appear { center_m, radius_m, again } => {
                if !again {
                    self.terrain.tool = Tool::Look;
                }
                if !self.is_executing() {
                    self.toasts.add(ToastKind::Failed, "Obstacles appear only in a mission that is executed");
                    return;
                }
                let at = self.settle_time();
                let to_tenth = |metres: f64| (metres * 10.0).round() / 10.0;
                let (x, y) = (to_tenth(center_m.x), to_tenth(center_m.y));
                let radius = to_tenth(radius_m).max(0.1);
                self.disturb(Disturbance::Obstacle { at, x, y, radius, low: false });
            }
            ExecutionCommand::SlowDown { vehicle, factor, duration } => {
                let from = self.settle_time();
                let until = from.checked_add(duration).unwrap_or(from);
                self.disturb(Disturbance::VehicleSlow { vehicle, factor, from, until });
            }
            ExecutionCommand::TakeBack(index) => {
                if index < self.execution.script.disturbances.len() {
                    self.execution.script.disturbances.remove(index);
                }
            }
            ExecutionCommand::Oppose(is_opposed) => self.execution.script.adversary = is_opposed,
            ExecutionCommand::Reset => {
                self.execution.script = Script::default();
                self.execution.expected = None;
                self.playback.is_playing = false;
                self.playback.seek(0.0);
            }
            ExecutionCommand::Save => self.save_run(),
            ExecutionCommand::Open => self.effects.push(Effect::OpenFile(FileKind::Json)),
        }
    }

    /// The time shown as an exact one, to which the clock is set: rounded up, so that nothing shown is in the future.
    fn settle_time(&mut self) -> Time {
        let time = exact_time(self.playback.time);
        self.playback.seek(playback::number(time));
        time
    }

    fn disturb(&mut self, disturbance: Disturbance) {
        let is_replaced = |known: &Disturbance| {
            known.occurrence() == disturbance.occurrence()
                // There can be any number of these, and the earlier ones are the past.
                && !matches!(
                    known,
                    Disturbance::Obstacle { .. }
                        | Disturbance::VehicleSlow { .. }
                        | Disturbance::Fault { .. }
                        | Disturbance::State { .. }
                        | Disturbance::Level { .. }
                )
                && std::mem::discriminant(known) == std::mem::discriminant(&disturbance)
        };
        self.execution.script.disturbances.retain(|known| !is_replaced(known));
        self.execution.script.disturbances.push(disturbance);
    }

    fn save_run(&mut self) {
        let Some(run) = &self.execution.run else { return };
        let document = json!({
            "format": "enroute-simulate/1",
            "mission": self.mission.as_str(),
            "seed": self.settings.plan.seed,
            "status": run.ending,
            "disturbances": run.script.disturbances,
            "log": run.log,
        });
        let bytes = serde_json::to_vec_pretty(&document).unwrap_or_default();
        self.effects.push(Effect::SaveFile { name: format!("{}-run.json", self.mission), bytes });
    }

    /// Takes the file of a run, to replay it; false if it is none.
    pub(crate) fn open_run(&mut self, document: &Value) -> bool {
        let Ok(script) = serde_json::from_value::<Script>(document.clone()) else { return false };
        let log = document.get("log").cloned().and_then(|log| serde_json::from_value(log).ok());
        if let Some(seed) = document.get("seed").and_then(Value::as_u64) {
            self.settings.plan.seed = seed;
        }
        self.workspace = Workspace::Execute;
        self.show_panel(crate::PanelKind::Execution);
        self.execution.script = script;
        // Even a run that is shown already is compared with the log.
        self.execution.asked = None;
        self.execution.expected = log;
        self.playback.seek(0.0);
        true
    }
}

/// A time of the clock as an exact time, not before it.
pub fn exact_time(time: f64) -> Time {
    Time::from_f64_up(time - 1e-9, 1000).unwrap_or_default()
}

/// Whether `at` is not after the time shown.
pub fn has_come(at: Time, time: f64) -> bool {
    playback::number(at) <= time + 1e-9
}

/// A disturbance in words.
pub fn disturbance_text(disturbance: &Disturbance) -> String {
    let time = crate::time_text::short;
    match disturbance {
        Disturbance::Duration { activity, duration } => format!("{activity} takes {}", time(*duration)),
        Disturbance::Slow { activity, factor } => {
            format!("{activity} drives at {factor} of its speed")
        }
        Disturbance::Fault { activity, step, component, mode } => {
            format!("{component} comes into {mode} in step {step} of {activity}")
        }
        Disturbance::Obstacle { at, x, y, radius, low } => {
            format!(
                "an obstacle{} with a radius of {radius:.1} m stands at ({x:.1}, {y:.1}) from {}",
                if *low { " near the ground" } else { "" },
                time(*at)
            )
        }
        Disturbance::VehicleSlow { vehicle, factor, from, until } if factor.is_zero() => {
            format!("{vehicle} stands from {} to {}", time(*from), time(*until))
        }
        Disturbance::VehicleSlow { vehicle, factor, from, until } => {
            let (from, until) = (time(*from), time(*until));
            format!("{vehicle} drives at {factor} of its speed from {from} to {until}")
        }
        Disturbance::State { variable, value, at } => format!("{variable} becomes {value} at {}", time(*at)),
        Disturbance::Level { resource, level, at } => {
            format!("{resource} is at {} at {}", level.readable(), time(*at))
        }
        Disturbance::Withdrawn { condition, at } => format!("{condition} is withdrawn at {}", time(*at)),
        Disturbance::Late { condition, at } => format!("{condition} comes at {} at the earliest", time(*at)),
    }
}
