//! A control program as it runs: its automaton, the plant that it controls, and the steps taken so far.
//!
//! The run is its log: the inputs of all steps. Everything shown follows from them, so stepping back forgets nothing,
//! and an edit of the text that leaves the names as they are takes the same steps again.

use std::collections::BTreeMap;

use executive::model_based::{Options, Run, StepInput, StepRecord, System, run_seed};
use hca::{Automaton, Estimate, Marking, Stepper, TraceStep, VariableId};
use mission::{Control, read_control};
use plant::{Belief, Commands, ComponentId, Model, State};
use smol_str::SmolStr;

use crate::mission_file;
use crate::state::document::Document;
use crate::state::program_chance::ProgramChanceState;

/// The program of the text, if it is one, and its run.
#[derive(Debug, Default)]
pub struct AutomatonState {
    /// The revision of the text that was compiled.
    revision: u64,
    program: Option<Program>,
    /// The inputs of the steps taken, those that were stepped back over included.
    log: Vec<Input>,
    /// What is to come from outside in the next step; replaces what the log says for it.
    pending: Option<Input>,
    /// How things stand before each step of the log, and after the last.
    moments: Vec<Moment>,
    /// The moment that is looked at.
    at: usize,
    /// With it, components fail by chance.
    luck: Option<Luck>,
    /// How likely the program is to reach its end.
    pub chance: ProgramChanceState,
    /// Why the last step could not be taken.
    pub trouble: Option<String>,
    /// Whether steps go by themselves.
    pub is_playing: bool,
    elapsed_secs: f64,
}

/// What the text comes to.
#[derive(Debug)]
pub enum Program {
    /// A program and the plant that it controls.
    Bound(Box<System>),
    /// A program alone: what is known of its variables is typed in.
    Unbound(Box<Automaton>),
    /// A plant without a program.
    Plant(Box<Model>),
    /// A text with errors.
    Broken,
}

/// What comes from outside in one step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// Faults and observations, if there is a plant.
    pub plant: StepInput,
    /// What is known of the program's variables, if there is none.
    pub known: BTreeMap<u32, u32>,
}

/// The luck that components have: with the same, the same ones fail in the same steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Luck {
    /// Seeds chance.
    pub seed: u64,
    /// Which of the many runs with that seed, from 0; without it, the seed is that of the run itself.
    pub run: Option<u64>,
}

impl Luck {
    fn seed_of_run(self) -> u64 {
        self.run.map_or(self.seed, |number| run_seed(self.seed, number))
    }
}

/// How things stand between two steps.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What is marked.
    pub marking: Marking,
    /// The marked locations, goals and labels of the next step.
    pub upcoming: TraceStep,
    /// What the automaton did in the step that led here; nothing at the start.
    pub taken: Option<TraceStep>,
    /// The plant, if there is one.
    pub plant: Option<PlantMoment>,
}

/// How the plant stands between two steps.
#[derive(Clone, Debug)]
pub struct PlantMoment {
    /// What is believed.
    pub belief: Belief,
    /// What is true.
    pub true_state: State,
    /// The step that led here; nothing at the start.
    pub record: Option<StepRecord>,
    /// The commands of the next step; nothing after the end.
    pub next_commands: Option<Commands>,
    /// The goals that the next step does not pursue, with the reasons.
    pub unachievable: Vec<(SmolStr, String)>,
}

/// What can be asked of the automaton's view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AutomatonCommand {
    /// So many steps forwards, or backwards if negative.
    Step(i64),
    /// To the moment after this many steps.
    GoTo(usize),
    /// Lets steps go by themselves, or stops.
    TogglePlaying,
    /// Forgets all steps.
    Reset,
    /// In the next step the component comes into this mode, whatever is commanded; `None` takes that back.
    Inject(ComponentId, Option<u8>),
    /// In the last step this was observed instead of what the plant showed; `None` takes that back.
    Observe(plant::VariableId, Option<u8>),
    /// In the next step, the value of a variable of a program without a plant is known to be this, or not known.
    Know(VariableId, Option<u32>),
    /// From the first step on, components fail by chance, or only those that were made to.
    SetLuck(Option<Luck>),
}

/// Steps a second while playing.
const STEPS_PER_SEC: f64 = 1.5;
/// A log does not grow longer than this: every look at it takes its steps again.
const MOST_STEPS: usize = 400;

impl AutomatonState {
    /// Reads the document if it has changed since.
    pub fn follow(&mut self, document: &Document, is_control: bool) {
        if self.revision == document.revision() {
            return;
        }
        self.revision = document.revision();
        self.chance.give_up();
        if !is_control {
            *self = Self { revision: self.revision, ..Self::default() };
            return;
        }
        let before = self.program.take();
        let program = match read_control(document.text(), Some(mission_file::PLANT)).0 {
            Control::Bound(system) => Program::Bound(system),
            Control::Unbound(automaton) => Program::Unbound(automaton),
            Control::Plant(model) => Program::Plant(model),
            Control::Nothing => Program::Broken,
        };
        // While a text has errors, the steps wait for it to be whole again.
        let is_same = before.as_ref().is_none_or(|before| {
            matches!(before, Program::Broken)
                || matches!(program, Program::Broken)
                || before.names() == program.names()
        });
        if !is_same {
            self.forget();
        }
        self.program = Some(program);
        self.replay();
    }

    /// What the text comes to; nothing if it is a mission.
    pub const fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    /// How things stand at the moment that is looked at.
    pub fn moment(&self) -> Option<&Moment> {
        self.moments.get(self.at)
    }

    /// All moments, those that were stepped back over included.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// How many steps were taken before the moment that is looked at.
    pub const fn at(&self) -> usize {
        self.at
    }

    /// What comes from outside in the step after the moment that is looked at.
    pub fn next_input(&self) -> Input {
        let logged = self.pending.as_ref().or_else(|| self.log.get(self.at));
        logged.cloned().unwrap_or_else(|| self.usual_input())
    }

    /// What came from outside in the step before the moment that is looked at.
    pub fn last_input(&self) -> Option<&Input> {
        self.log.get(self.at.checked_sub(1)?)
    }

    /// With it, components fail by chance.
    pub const fn luck(&self) -> Option<Luck> {
        self.luck
    }

    /// The modes that components were made to come into, by step from 1 and by component.
    pub fn injected(&self) -> BTreeMap<u32, BTreeMap<SmolStr, SmolStr>> {
        let Some(model) = self.program.as_ref().and_then(Program::model) else { return BTreeMap::new() };
        let pending = self.pending.as_ref().map(|input| (self.at, input));
        let logged = self.log.iter().enumerate().take(if pending.is_some() { self.at } else { usize::MAX });
        let mut injected: BTreeMap<u32, BTreeMap<SmolStr, SmolStr>> = BTreeMap::new();
        for (at, input) in logged.chain(pending) {
            for (&id, &mode) in &input.plant.injected {
                let Some(component) = model.component(id) else { continue };
                let modes = injected.entry(at as u32 + 1).or_default();
                modes.insert(component.name.clone(), model.mode_name(id, mode).into());
            }
        }
        injected
    }

    /// Starts anew with this luck, and with these modes to come into by step and component.
    pub fn show_run(&mut self, luck: Luck, injected: &BTreeMap<u32, BTreeMap<SmolStr, SmolStr>>) {
        self.forget();
        self.luck = Some(luck);
        if let Some(model) = self.program.as_ref().and_then(Program::model) {
            let last = injected.keys().last().copied().unwrap_or(0);
            for step in 1..=last {
                let mut input = Input::default();
                for (component, mode) in injected.get(&step).into_iter().flatten() {
                    if let Ok((component, mode)) = model.component_mode(component, mode) {
                        input.plant.injected.insert(component, mode);
                    }
                }
                self.log.push(input);
            }
        }
        self.replay();
    }

    /// Forgets all steps: another text was opened.
    pub fn forget(&mut self) {
        self.luck = None;
        self.log.clear();
        self.moments.clear();
        self.pending = None;
        self.at = 0;
        self.trouble = None;
        self.is_playing = false;
    }

    /// Does what `command` asks for.
    pub fn apply(&mut self, command: AutomatonCommand) {
        match command {
            AutomatonCommand::Step(steps) => {
                for _ in 0..steps.unsigned_abs().min(MOST_STEPS as u64) {
                    if steps > 0 { self.step() } else { self.go_to(self.at.saturating_sub(1)) }
                }
            }
            AutomatonCommand::GoTo(moment) => {
                self.go_to(moment.min(self.moments.len().saturating_sub(1)));
                while self.at < moment && self.can_step() {
                    self.step();
                }
            }
            AutomatonCommand::TogglePlaying => {
                if !self.is_playing && !self.can_step() {
                    self.go_to(0);
                }
                self.is_playing = !self.is_playing && self.can_step();
                self.elapsed_secs = 0.0;
            }
            AutomatonCommand::Reset => {
                let luck = self.luck;
                self.forget();
                self.luck = luck;
                self.replay();
            }
            AutomatonCommand::SetLuck(luck) => {
                self.luck = luck;
                self.replay();
            }
            AutomatonCommand::Inject(component, mode) => {
                let mut input = self.next_input();
                match mode {
                    Some(mode) => input.plant.injected.insert(component, mode),
                    None => input.plant.injected.remove(&component),
                };
                self.change_next(input);
            }
            AutomatonCommand::Know(variable, value) => {
                let mut input = self.next_input();
                match value {
                    Some(value) => input.known.insert(variable.0, value),
                    None => input.known.remove(&variable.0),
                };
                self.change_next(input);
            }
            AutomatonCommand::Observe(variable, value) => {
                let Some(at) = self.at.checked_sub(1) else { return };
                let Some(input) = self.log.get_mut(at) else { return };
                match value {
                    Some(value) => input.plant.observed.insert(variable, value),
                    None => input.plant.observed.remove(&variable),
                };
                self.log.truncate(self.at);
                self.pending = None;
                self.replay();
            }
        }
    }

    /// Lets `seconds` go by. Answers whether another moment is shown.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        if !self.is_playing {
            return false;
        }
        self.elapsed_secs += seconds * rate;
        if self.elapsed_secs * STEPS_PER_SEC < 1.0 {
            return false;
        }
        self.elapsed_secs = 0.0;
        self.step();
        self.is_playing = self.can_step();
        true
    }

    /// Whether the program has not ended at the moment that is looked at.
    pub fn can_step(&self) -> bool {
        self.moment().is_some_and(|moment| !moment.marking.is_empty()) && self.at < MOST_STEPS
    }

    fn step(&mut self) {
        if !self.can_step() {
            return;
        }
        let is_logged = self.pending.is_none() && self.at < self.log.len();
        if !is_logged {
            let input = self.next_input();
            self.log.truncate(self.at);
            self.log.push(input);
            self.pending = None;
            self.replay();
        }
        if self.at + 1 < self.moments.len() {
            self.at += 1;
        }
    }

    fn go_to(&mut self, moment: usize) {
        if moment != self.at {
            self.pending = None;
            self.at = moment;
        }
    }

    fn change_next(&mut self, input: Input) {
        self.log.truncate(self.at);
        self.pending = Some(input);
        self.replay();
    }

    /// What is known stays known; a fault happens once.
    fn usual_input(&self) -> Input {
        let known = self.last_input().map(|input| input.known.clone()).unwrap_or_default();
        Input { known, ..Input::default() }
    }

    /// Works out all moments from the log.
    fn replay(&mut self) {
        self.trouble = None;
        self.moments = match &self.program {
            Some(Program::Bound(system)) => {
                let (moments, trouble) = moments_of_system(system, &self.log, self.luck);
                self.trouble = trouble;
                moments
            }
            Some(Program::Unbound(automaton)) => moments_of_automaton(automaton, &self.log),
            // The log is kept for when the text is whole again.
            Some(Program::Plant(_) | Program::Broken) | None => return self.moments.clear(),
        };
        self.log.truncate(self.moments.len().saturating_sub(1));
        self.at = self.at.min(self.log.len());
    }
}

impl Program {
    /// The automaton, if there is one.
    pub fn automaton(&self) -> Option<&Automaton> {
        match self {
            Self::Bound(system) => Some(&system.automaton),
            Self::Unbound(automaton) => Some(automaton),
            Self::Plant(_) | Self::Broken => None,
        }
    }

    /// The plant, if there is one.
    pub fn model(&self) -> Option<&Model> {
        match self {
            Self::Bound(system) => Some(&system.model),
            Self::Plant(model) => Some(model),
            Self::Unbound(_) | Self::Broken => None,
        }
    }

    /// What the inputs of steps refer to by number.
    fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(model) = self.model() {
            names.extend(model.components.iter().map(|it| format!("{} {:?}", it.name, mode_names(it))));
            names.extend(model.variables.iter().map(|it| format!("{} {:?}", it.name, it.values)));
        } else if let Some(automaton) = self.automaton() {
            names.extend(automaton.variables.iter().map(|it| format!("{} {:?}", it.name, it.values)));
        }
        names
    }
}

fn mode_names(component: &plant::Component) -> Vec<&str> {
    component.modes.iter().map(|mode| mode.name.as_str()).collect()
}

fn moments_of_system(system: &System, log: &[Input], luck: Option<Luck>) -> (Vec<Moment>, Option<String>) {
    let seed = luck.map(Luck::seed_of_run);
    let mut run = Run::new(system, Options { seed, ..Options::default() });
    let mut moments = vec![moment_of_run(&run)];
    let mut trouble = None;
    // One step more than was taken tells what will be commanded.
    let beyond = Input::default();
    for input in log.iter().chain([&beyond]) {
        if run.is_done() {
            break;
        }
        if let Err(error) = run.step(&input.plant) {
            trouble = Some(error.to_string());
            break;
        }
        moments.push(moment_of_run(&run));
    }
    for at in 1..moments.len() {
        let Some((before, after)) = moments.get_mut(at - 1..=at).and_then(|pair| pair.split_first_mut())
        else {
            break;
        };
        let record = after.first().and_then(|after| after.plant.as_ref()?.record.as_ref());
        if let (Some(plant), Some(record)) = (&mut before.plant, record) {
            plant.next_commands = Some(record.commands.clone());
            plant.unachievable.clone_from(&record.unachievable);
        }
    }
    moments.truncate(log.len() + 1);
    (moments, trouble)
}

fn moment_of_run(run: &Run<'_>) -> Moment {
    let record = run.records().last().cloned();
    Moment {
        marking: run.marking().clone(),
        upcoming: run.upcoming(),
        taken: record.as_ref().map(|record| record.trace.clone()),
        plant: Some(PlantMoment {
            belief: run.belief().clone(),
            true_state: run.true_state().clone(),
            record,
            next_commands: None,
            unachievable: Vec::new(),
        }),
    }
}

fn moments_of_automaton(automaton: &Automaton, log: &[Input]) -> Vec<Moment> {
    let mut stepper = Stepper::new(automaton);
    let moment = |stepper: &Stepper<'_>, step: u32, taken: Option<TraceStep>| Moment {
        marking: stepper.marking().clone(),
        upcoming: TraceStep::at(stepper, step),
        taken,
        plant: None,
    };
    let mut moments = vec![moment(&stepper, 1, None)];
    for (input, step) in log.iter().zip(1..) {
        if stepper.is_done() {
            break;
        }
        let mut estimate = Estimate::unknown(automaton.variables.len());
        for (&variable, &value) in &input.known {
            estimate.set(VariableId(variable), Some(value));
        }
        let mut taken = TraceStep::at(&stepper, step);
        stepper.step_observed(&[estimate], &mut taken);
        moments.push(moment(&stepper, step + 1, Some(taken)));
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(text: &str) -> AutomatonState {
        let document = Document::new(text);
        let mut state = AutomatonState::default();
        state.follow(&document, true);
        state
    }

    fn orbit_insertion() -> AutomatonState {
        opened(mission_file::example("orbit-insertion").expect("it is an example").source)
    }

    fn marked(state: &AutomatonState) -> Vec<String> {
        let automaton = state.program().and_then(Program::automaton).expect("the program compiles");
        let moment = state.moment().expect("there is a moment");
        let mut names: Vec<String> = moment.marking.iter().map(|id| automaton.location_name(id)).collect();
        names.sort();
        names
    }

    /// SPEC 8.4, nominal.
    #[test]
    fn orbit_insertion_goes_as_specified() {
        let mut state = orbit_insertion();
        let expected: [&[&str]; 5] =
            [&["a1", "a2", "a3", "w1", "w2"], &["a1", "a2", "w1", "w2"], &["a4", "w2"], &["a4", "w2"], &[]];
        for (step, expected) in expected.iter().enumerate() {
            assert_eq!(marked(&state), *expected, "before step {}", step + 1);
            state.apply(AutomatonCommand::Step(1));
        }
        assert!(!state.can_step());
        assert_eq!(state.at(), 4, "an ended program takes no more steps");
    }

    /// SPEC 9.3: a failure at step 3 is diagnosed at step 4, and engine B takes over.
    #[test]
    fn an_injected_fault_is_found_and_stepping_back_keeps_it() {
        let mut state = orbit_insertion();
        state.apply(AutomatonCommand::GoTo(2));
        let model = state.program().and_then(Program::model).expect("there is a plant");
        let engine = model.component_named("EngineA").expect("engine A");
        let failed = model.mode_named(engine, "Failed").expect("it can fail");
        state.apply(AutomatonCommand::Inject(engine, Some(failed)));
        state.apply(AutomatonCommand::Step(2));
        assert_eq!(marked(&state), ["a5"]);
        state.apply(AutomatonCommand::Step(-2));
        assert_eq!(marked(&state), ["a4", "w2"]);
        state.apply(AutomatonCommand::Step(4));
        assert_eq!(marked(&state), Vec::<String>::new(), "it fails again, and engine B fires");
        assert_eq!(state.at(), 6);
    }

    #[test]
    fn an_edited_observation_changes_the_diagnosis() {
        let mut state = orbit_insertion();
        state.apply(AutomatonCommand::GoTo(4));
        assert_eq!(marked(&state), Vec::<String>::new());
        let model = state.program().and_then(Program::model).expect("there is a plant");
        let thrust = model.variable_named("EngineA.thrust").expect("thrust is observed");
        let engine = model.component_named("EngineA").expect("engine A");
        let failed = model.mode_named(engine, "Failed").expect("it can fail");
        state.apply(AutomatonCommand::Observe(thrust, Some(0)));
        let plant = state.moment().and_then(|moment| moment.plant.as_ref()).expect("there is a plant");
        assert_eq!(plant.belief.most_likely().mode(engine), failed);
        assert!(plant.record.as_ref().is_some_and(|record| !record.conflicts.is_empty()));
        assert_eq!(marked(&state), ["a5"]);
    }

    #[test]
    fn without_a_plant_the_known_values_are_typed_in() {
        let mut state = opened("Main ():: (WHEN-DONEXT (start = on) (shutter = open))");
        assert!(matches!(state.program(), Some(Program::Unbound(_))));
        state.apply(AutomatonCommand::Step(1));
        assert_eq!(marked(&state), ["w1"]);
        let automaton = state.program().and_then(Program::automaton).expect("it compiles");
        let start = automaton.variable("start").expect("it is asked for");
        state.apply(AutomatonCommand::Know(start, Some(0)));
        state.apply(AutomatonCommand::Step(1));
        assert_eq!(marked(&state), ["a1"]);
    }

    #[test]
    fn an_edit_that_keeps_the_names_keeps_the_steps() {
        let mut document =
            Document::new(mission_file::example("orbit-insertion").expect("an example").source);
        let mut state = AutomatonState::default();
        state.follow(&document, true);
        state.apply(AutomatonCommand::Step(3));
        document.replace_all(&format!("; A note.\n{}", document.text()));
        state.follow(&document, true);
        assert_eq!((state.at(), marked(&state)), (3, vec!["a4".to_owned(), "w2".to_owned()]));
        document.replace_all("Main ():: (WHEN-DONEXT (lamp = off) (lamp = on))");
        state.follow(&document, true);
        assert_eq!(state.at(), 0);
    }
}
