//! The run of a control program as a session: it is kept, steps on from where it is, and goes back to where the inputs
//! asked for depart from those it has taken.

use std::sync::Arc;

use executive::model_based::proof::{idle_parts, idle_parts_alone};
use executive::model_based::{Estimator, Options, Run, RunStatus, System};
use hca::Automaton;
use link::control_run::{Input, Moment};
use link::{ControlProgram, ControlRun, ControlStanding};
use link::{Response, Update};
use rmpl::Diagnostic;
use rmpl::spans::Spans as _;
use snapshot::content::Keys;
use snapshot::{ContentKey, Problem, Snapshot, Stage, Timings};

use super::Core;
use crate::control::Control;
use crate::host::CoreHost;
use crate::moments::{control_program, moment_of_run, moments_of_automaton};

/// The run that was asked for last.
pub(super) struct Session {
    control: Control,
    seed: Option<u64>,
    /// Of what is run.
    program: ContentKey,
    /// Of the run: what is run, and the seed.
    key: ContentKey,
    run: Option<RunOfSystem>,
}

/// A run with its moments; the last step is one more than was asked for, to tell what will be commanded.
struct RunOfSystem {
    run: Run,
    inputs: Vec<Input>,
    moments: Vec<Moment>,
}

/// What does nothing in any run is told if it is found within this time.
const WARNING_MILLIS: f64 = 50.0;

/// A long run answers with the steps taken so far after about this long.
const PROGRESS_MILLIS: f64 = 100.0;

impl Core {
    /// A control program has no network and nothing to plan; what is wrong with it is all there is to tell.
    pub(super) fn update_control(&mut self, update: &Update, host: &mut dyn CoreHost) {
        let begun = host.now_millis();
        let text = update.source.text();
        let mut found = self.controls.diagnostics(text).to_vec();
        found.extend(self.idle_parts(text, &mut || host.now_millis() - begun < WARNING_MILLIS));
        found.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        let problems = Problem::all(&found, &update.source);
        let timings = Timings { parse_millis: host.now_millis() - begun, ..Timings::default() };
        let mut snapshot = Snapshot::empty(update.revision, Arc::clone(update.source.text()));
        snapshot.stage = Stage::Complete;
        snapshot.problems = problems.into();
        snapshot.timings = timings;
        host.answer(Response::Snapshot(Arc::new(snapshot)));
    }

    /// Warnings of the parts of a control program that do nothing in any run; none if `go_on` returns false before all is
    /// looked at.
    pub fn idle_parts(&mut self, text: &Arc<str>, go_on: &mut dyn FnMut() -> bool) -> Vec<Diagnostic> {
        let idle = match self.controls.read(text, None) {
            Control::Bound(system) => idle_parts(system, go_on),
            Control::Unbound(automaton) => idle_parts_alone(automaton, go_on),
            Control::Plant(_) | Control::Nothing => None,
        };
        idle.unwrap_or_default()
    }

    /// Runs a control program up to the moment after the inputs that are wanted.
    pub(super) fn run_control(&mut self, wanted: &ControlRun, host: &mut dyn CoreHost) {
        let control = self.controls.read(wanted.source.text(), wanted.plant.as_ref()).clone();
        let session = Session::follow(self.control_run.take(), control, wanted.seed, &mut self.keys);
        self.control_run.insert(session).drive(wanted, host);
    }
}

impl Session {
    /// The session before, if it runs the same; otherwise a new one, which knows what the one before found out about an
    /// equal plant.
    fn follow(before: Option<Self>, control: Control, seed: Option<u64>, keys: &mut Keys) -> Self {
        let Some(before) = before else {
            let (program, key) = (keys.fresh(), keys.fresh());
            let run = RunOfSystem::start(&control, seed, None);
            return Self { control, seed, program, key, run };
        };
        let (program, control) = if is_same(&before.control, &control) {
            (before.program, before.control.clone())
        } else {
            (keys.fresh(), control)
        };
        if before.seed == seed && (program == before.program || is_elsewhere(&before.control, &control)) {
            return Self { control, program, ..before };
        }
        let estimator = before.run.map(|run| run.run.into_estimator());
        let run = RunOfSystem::start(&control, seed, estimator);
        Self { control, seed, program, key: keys.fresh(), run }
    }

    fn drive(&mut self, wanted: &ControlRun, host: &mut dyn CoreHost) {
        let holds_run = wanted.held_run == self.key;
        let mut answers = Answers {
            wanted,
            run: self.key,
            program: self.program,
            // The program travels only once.
            content: (wanted.held_program != self.program).then(|| control_program(&self.control)),
            first: if holds_run { wanted.held as usize } else { 0 },
        };
        match (&mut self.run, &self.control) {
            (Some(run), _) => run.drive(&mut answers, host),
            (None, Control::Unbound(automaton)) => answers.of_automaton(automaton, host),
            (None, _) => answers.send(&[], None, true, host),
        }
    }
}

/// Returns whether two texts come to the same program and plant, in the same places.
fn is_same(one: &Control, other: &Control) -> bool {
    match (one, other) {
        (Control::Bound(one), Control::Bound(other)) => {
            let is_equal = one.automaton == other.automaton && one.model == other.model;
            Arc::ptr_eq(one, other) || is_equal && one.entailment == other.entailment
        }
        (Control::Unbound(one), Control::Unbound(other)) => Arc::ptr_eq(one, other) || one == other,
        (Control::Plant(one), Control::Plant(other)) => Arc::ptr_eq(one, other) || one == other,
        (Control::Nothing, Control::Nothing) => true,
        _ => false,
    }
}

/// Returns whether two texts come to the same program and plant, in other places.
fn is_elsewhere(one: &Control, other: &Control) -> bool {
    match (one, other) {
        (Control::Bound(one), Control::Bound(other)) => {
            one.automaton.without_places() == other.automaton.without_places()
                && one.model.without_places() == other.model.without_places()
                && one.entailment == other.entailment
        }
        (Control::Unbound(one), Control::Unbound(other)) => one.without_places() == other.without_places(),
        _ => false,
    }
}

impl RunOfSystem {
    fn start(control: &Control, seed: Option<u64>, estimator: Option<Estimator>) -> Option<Self> {
        let Control::Bound(system) = control else { return None };
        let options = Options { seed, ..Options::default() };
        let run = Run::with_estimator(system, options, estimator_for(system, estimator));
        let moments = vec![moment_of_run(&run)];
        Some(Self { run, inputs: Vec::new(), moments })
    }

    fn drive(&mut self, answers: &mut Answers<'_>, host: &mut dyn CoreHost) {
        let wanted = &answers.wanted.inputs;
        let beyond = Input::default();
        let common = (wanted.iter().chain([&beyond]).zip(&self.inputs))
            .take_while(|(wanted, taken)| wanted.plant == taken.plant)
            .count();
        self.go_back(common);
        let mut answered_millis = host.now_millis();
        let mut trouble = None;
        for input in wanted.iter().chain([&beyond]).skip(common) {
            if self.run.status() == RunStatus::Deadlock {
                trouble =
                    Some(format!("These locks wait for each other: {}.", self.run.deadlock().join(", ")));
            }
            if self.run.status() != RunStatus::Running {
                break;
            }
            if let Err(error) = self.step(input) {
                trouble = Some(error.to_string());
                break;
            }
            // What was done stays done: a later request continues from here.
            if host.is_superseded() {
                return;
            }
            if host.now_millis() - answered_millis > PROGRESS_MILLIS {
                // The last moment does not know yet what will be commanded.
                answers.send(&self.moments[..self.moments.len() - 1], None, false, host);
                answered_millis = host.now_millis();
            }
        }
        let count = self.moments.len().min(wanted.len() + 1);
        answers.send(&self.moments[..count], trouble, true, host);
    }

    /// To the moment after `steps` steps, if the run is further on.
    fn go_back(&mut self, steps: usize) {
        while self.run.records().len() > steps && self.run.step_back() {}
        self.inputs.truncate(steps);
        self.moments.truncate(steps + 1);
    }

    fn step(&mut self, input: &Input) -> Result<(), plant::EstimateError> {
        let record = self.run.step(&input.plant)?;
        if let Some(before) = self.moments.last_mut().and_then(|moment| moment.plant.as_mut()) {
            before.next_commands = Some(record.commands.clone());
            before.unachievable.clone_from(&record.unachievable);
        }
        self.inputs.push(input.clone());
        self.moments.push(moment_of_run(&self.run));
        Ok(())
    }
}

/// Returns what an earlier run found out serves for an equal plant.
fn estimator_for(system: &Arc<System>, estimator: Option<Estimator>) -> Estimator {
    let is_equal =
        |estimator: &Estimator| estimator.planner().model().without_places() == system.model.without_places();
    estimator.filter(is_equal).unwrap_or_else(|| Estimator::new(system, None))
}

/// What was answered of a request so far.
struct Answers<'a> {
    wanted: &'a ControlRun,
    run: ContentKey,
    program: ContentKey,
    content: Option<ControlProgram>,
    /// The first moment that the asker does not hold.
    first: usize,
}

impl Answers<'_> {
    fn send(
        &mut self,
        moments: &[Moment],
        trouble: Option<String>,
        is_complete: bool,
        host: &mut dyn CoreHost,
    ) {
        let first = self.first.min(moments.len());
        self.first = moments.len();
        host.answer(Response::ControlRun(Box::new(ControlStanding {
            token: self.wanted.token,
            run: self.run,
            program: self.program,
            content: self.content.take(),
            first: first as u32,
            moments: moments[first..].to_vec(),
            wanted: self.wanted.inputs.len() as u32 + 1,
            is_complete,
            trouble,
        })));
    }

    fn of_automaton(&mut self, automaton: &Arc<Automaton>, host: &mut dyn CoreHost) {
        let moments = moments_of_automaton(automaton, &self.wanted.inputs);
        self.send(&moments, None, true, host);
    }
}
