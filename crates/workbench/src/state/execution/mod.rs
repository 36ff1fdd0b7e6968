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

use super::playback::{self, Playback};
use super::settings::PlanSettings;
use super::window::Window;
use crate::effect::Effect;
use crate::host::FileKind;
use crate::panel_kind::PanelKind;
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
pub(crate) struct View {
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
        /// Its radius in meters.
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
    /// Whether the environment chooses so as to break the plan, from the start.
    Oppose(bool),
    /// Everything goes as planned, from the start.
    Reset,
    /// Everything goes as in another run, from the start.
    Replay(Box<Script>),
    /// Saves the run as a file.
    Save,
    /// Opens the file of a run, to replay it.
    Open,
}

impl ExecutionState {
    /// Returns what goes otherwise than planned.
    pub fn disturbances(&self) -> &[Disturbance] {
        &self.script.disturbances
    }

    /// The run, which may belong to an older text or script while the next one is worked out.
    pub fn run(&self) -> Option<&Arc<Execution>> {
        self.run.as_ref()
    }

    /// Returns why there is no run.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }

    /// Returns what has happened at the time shown.
    pub fn moment(&self) -> Option<&Moment> {
        self.view.as_ref().map(|view| &view.moment)
    }

    /// The obstacles that have appeared by `time`, with centers and radii in meters.
    pub fn appeared(&self, time: f64) -> impl Iterator<Item = (Point2<f64>, f64)> + '_ {
        self.disturbances().iter().filter_map(move |disturbance| match *disturbance {
            Disturbance::Obstacle { at, x, y, radius, .. } if has_come(at, time) => {
                Some((Point2::new(x, y), radius))
            }
            _ => None,
        })
    }

    /// Returns whether the environment chooses so as to break the plan.
    pub const fn is_opposed(&self) -> bool {
        self.script.adversary
    }

    /// Returns whether the run is a given one, such as a counterexample: its schedule, or what nature chooses in it, is
    /// given.
    pub fn is_replay(&self) -> bool {
        let Script { run_seed, nature, schedule, .. } = &self.script;
        run_seed.is_some() || !nature.is_empty() || !schedule.is_empty()
    }

    /// Returns whether a newer run than the one shown is being worked out.
    pub fn is_working(&self) -> bool {
        let is_answered = |run: &Arc<Execution>| {
            self.asked
                .as_ref()
                .is_some_and(|(revision, script)| (run.revision, &run.script) == (*revision, script))
        };
        self.asked.is_some() && self.trouble.is_none() && !self.run.as_ref().is_some_and(is_answered)
    }

    /// The run that was asked for does not come.
    pub(crate) fn give_up(&mut self) {
        if self.is_working() {
            self.trouble = Some("simulation was stopped".to_owned());
        }
    }

    /// Forgets everything: another mission was opened.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

impl ExecutionState {
    /// The plan that is followed at the time shown, with what has happened.
    pub(crate) fn snapshot(&self) -> Option<&Arc<Snapshot>> {
        self.view.as_ref().map(|view| &view.snapshot)
    }

    /// Returns whether the core was asked to execute the mission as it is planned, with the present disturbances.
    pub(crate) fn is_asked(&self, update: &Update) -> bool {
        self.asked
            .as_ref()
            .is_some_and(|(revision, script)| (*revision, script) == (update.revision, &self.script))
    }

    /// Returns what the core is to execute of the mission as it is planned.
    pub(crate) fn request(&mut self, update: Update) -> Request {
        self.asked = Some((update.revision, self.script.clone()));
        self.trouble = None;
        Request::Execute { update, script: self.script.clone() }
    }

    /// Takes what the core answered about the text of `revision`.
    pub(crate) fn take(&mut self, answer: Response, revision: u64, window: &mut Window) {
        match answer {
            Response::Execution(run) if run.revision == revision && run.script == self.script => {
                if let Some(expected) = self.expected.take() {
                    compare(&expected, &run, window);
                }
                self.run = Some(run);
            }
            Response::NotExecuted { revision: asked, reason } if asked == revision => {
                self.trouble = Some(reason);
                self.run = None;
                self.view = None;
            }
            _ => {}
        }
    }

    /// Works out what the time shown shows of the run, if that has changed.
    pub(crate) fn view_at(&self, base: &Arc<Snapshot>, time: f64) -> Option<View> {
        let run = self.run.clone()?;
        let (plan, executed) = run.plan_at(time)?;
        let happened = executed.times.iter().flatten().filter(|&&at| has_come(at, time)).count();
        let is_same = self.view.as_ref().is_some_and(|view| {
            Arc::ptr_eq(&view.run, &run)
                && Arc::ptr_eq(&view.base, base)
                && (view.plan, view.happened) == (plan, happened)
        });
        if is_same {
            return None;
        }
        let (snapshot, moment) = moment::at(base, executed, time);
        let (base, snapshot) = (Arc::clone(base), Arc::new(snapshot));
        Some(View { base, run, plan, happened, snapshot, moment })
    }

    /// Shows the run at another time.
    pub(crate) fn show(&mut self, view: View) {
        self.view = Some(view);
    }

    /// Does what a command asks for, at the time shown, in the mission of this name planned with this seed.
    pub(crate) fn apply(
        &mut self,
        command: ExecutionCommand,
        (mission, seed): (&str, u64),
        playback: &mut Playback,
        window: &mut Window,
    ) {
        match command {
            ExecutionCommand::Disturb(disturbance) => {
                let now = settle_time(playback);
                if disturbance.since().is_some_and(|since| since < now) {
                    window.failed("Past events can't change. Choose a time after the current time.");
                    return;
                }
                self.disturb(disturbance);
            }
            ExecutionCommand::Withdraw(condition) => {
                let at = settle_time(playback);
                self.disturb(Disturbance::Withdrawn { condition, at });
            }
            ExecutionCommand::Appear { center_m, radius_m, .. } => {
                let at = settle_time(playback);
                let to_tenth = |meters: f64| (meters * 10.0).round() / 10.0;
                let (x, y) = (to_tenth(center_m.x), to_tenth(center_m.y));
                let radius = to_tenth(radius_m).max(0.1);
                self.disturb(Disturbance::Obstacle { at, x, y, radius, low: false });
            }
            ExecutionCommand::SlowDown { vehicle, factor, duration } => {
                let from = settle_time(playback);
                let until = from.checked_add(duration).unwrap_or(from);
                self.disturb(Disturbance::VehicleSlow { vehicle, factor, from, until });
            }
            ExecutionCommand::TakeBack(index) => {
                if index < self.script.disturbances.len() {
                    self.script.disturbances.remove(index);
                }
            }
            ExecutionCommand::Oppose(is_opposed) => self.script.adversary = is_opposed,
            ExecutionCommand::Reset => self.restart(Script::default(), playback),
            ExecutionCommand::Replay(script) => self.restart(*script, playback),
            ExecutionCommand::Save => self.save(mission, seed, window),
            ExecutionCommand::Open => window.ask(Effect::OpenFile(FileKind::Json)),
        }
    }

    fn restart(&mut self, script: Script, playback: &mut Playback) {
        self.script = script;
        self.expected = None;
        playback.is_playing = false;
        playback.seek(0.0);
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
        self.script.disturbances.retain(|known| !is_replaced(known));
        self.script.disturbances.push(disturbance);
    }

    fn save(&self, mission: &str, seed: u64, window: &mut Window) {
        let Some(run) = &self.run else { return };
        let mut document = json!({
            "format": "enroute-simulate/1",
            "mission": mission,
            "seed": seed,
            "status": run.ending,
            "log": run.log,
        });
        if let (Some(document), Value::Object(script)) = (document.as_object_mut(), json!(run.script)) {
            document.extend(script);
        }
        let bytes = serde_json::to_vec_pretty(&document).unwrap_or_default();
        window.save_file(format!("{mission}-run.json"), bytes);
    }

    /// Takes the file of a run, to replay it; false if it is none.
    pub(crate) fn open_file(
        &mut self,
        document: &Value,
        plan: &mut PlanSettings,
        playback: &mut Playback,
        window: &mut Window,
    ) -> bool {
        let Ok(script) = serde_json::from_value::<Script>(document.clone()) else { return false };
        let log = document.get("log").cloned().and_then(|log| serde_json::from_value(log).ok());
        if let Some(seed) = document.get("seed").and_then(Value::as_u64) {
            plan.seed = seed;
        }
        window.workspace = Workspace::Execute;
        window.show(PanelKind::Execution);
        self.script = script;
        // Even a run that is shown already is compared with the log.
        self.asked = None;
        self.expected = log;
        playback.seek(0.0);
        true
    }
}

/// Says whether a replay is the same as what was saved.
fn compare(expected: &[Entry], run: &Execution, window: &mut Window) {
    let differing = expected.iter().zip(&run.log).position(|(one, other)| one != other);
    let first =
        differing.or_else(|| (expected.len() != run.log.len()).then(|| expected.len().min(run.log.len())));
    match first {
        None => {
            let text = format!("Replay matches: all {} log entries agree", expected.len());
            window.done(text);
        }
        Some(at) => {
            let text = format!("Replay differs from the saved log at entry {}", at + 1);
            window.failed(text);
        }
    }
}

/// The time shown as an exact one, to which the clock is set: rounded up, so that nothing shown is in the future.
fn settle_time(playback: &mut Playback) -> Time {
    let time = exact_time(playback.time);
    playback.seek(playback::number(time));
    time
}

/// A time of the clock as an exact time, not before it.
pub fn exact_time(time: f64) -> Time {
    Time::from_f64_up(time - 1e-9, 1000).unwrap_or_default()
}

/// Returns whether `at` is not after the time shown.
pub fn has_come(at: Time, time: f64) -> bool {
    playback::number(at) <= time + 1e-9
}

/// A disturbance in words.
pub fn disturbance_text(disturbance: &Disturbance) -> String {
    let time = crate::time_text::short;
    match disturbance {
        Disturbance::Duration { activity, duration } => format!("{activity} takes {}", time(*duration)),
        Disturbance::Slow { activity, factor } => {
            format!("{activity} drives at {factor} times its speed")
        }
        Disturbance::Fault { activity, step, component, mode } => {
            format!("{component} enters {mode} in step {step} of {activity}")
        }
        Disturbance::Obstacle { at, x, y, radius, low } => {
            format!(
                "obstacle{} of radius {radius:.1} m at ({x:.1}, {y:.1}) from {}",
                if *low { " near the ground" } else { "" },
                time(*at)
            )
        }
        Disturbance::VehicleSlow { vehicle, factor, from, until } if factor.is_zero() => {
            format!("{vehicle} stops from {} to {}", time(*from), time(*until))
        }
        Disturbance::VehicleSlow { vehicle, factor, from, until } => {
            let (from, until) = (time(*from), time(*until));
            format!("{vehicle} drives at {factor} times its speed from {from} to {until}")
        }
        Disturbance::State { variable, value, at } => format!("{variable} becomes {value} at {}", time(*at)),
        Disturbance::Level { resource, level, at } => {
            format!("{resource} is set to {} at {}", level.readable(), time(*at))
        }
        Disturbance::Withdrawn { condition, at } => format!("{condition} ends at {}", time(*at)),
        Disturbance::Late { condition, at } => format!("{condition} starts at {} at the earliest", time(*at)),
    }
}
