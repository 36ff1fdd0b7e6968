//! A control program as it runs: its automaton, the plant that it controls, and the steps taken so far.
//!
//! The run is its log: the inputs of all steps. The core keeps the run and takes the steps; what is here are the moments
//! that it answered. Stepping back forgets nothing, and an edit of the text that leaves the names as they are takes the
//! same steps again, in the core; until that is done the moments before are shown.

use std::collections::BTreeMap;
use std::sync::Arc;

use executive::model_based::{StepInput, StepOutcome, run_seed};
use hca::VariableId;
use link::{ControlRun, ControlStanding};
use plant::ComponentId;
use plant::hitting_sets::HittingMove;
use smol_str::SmolStr;
use snapshot::ContentKey;
use text_editing::Document;

use crate::mission_file;
use crate::state::diagnosing::{Diagnosing, StepConflicts};
use crate::state::program_chance::ProgramChanceState;
use crate::state::program_proof::ProgramProofState;

pub use link::ControlProgram as Program;
pub use link::control_run::{Input, Moment, PlantMoment};

/// The program of the text, if it is one, and its run.
#[derive(Debug, Default)]
pub struct AutomatonState {
    /// The revision of the text that is followed.
    revision: u64,
    is_control: bool,
    program: Option<Program>,
    program_key: ContentKey,
    /// Of the run that the moments are of.
    run_key: ContentKey,
    /// The inputs of the steps taken, those that were stepped back over included.
    log: Vec<Input>,
    /// What is to come from outside in the next step; replaces what the log says for it.
    pending: Option<Input>,
    /// How things stand before each step, and after the last.
    moments: Vec<Arc<Moment>>,
    /// So many of the moments, from the first, are what the log leads to.
    fresh: usize,
    /// The moments that the log leads to, as far as they were answered.
    coming: Vec<Arc<Moment>>,
    /// The moment that is looked at.
    at: usize,
    /// The moment that is to be looked at as soon as it is known.
    target: usize,
    /// Counts what the core was asked, so that an answer to something earlier is known.
    asked: u64,
    is_waiting: bool,
    wants_answer: bool,
    /// With it, components fail by chance.
    fault_seed: Option<FaultSeed>,
    /// How likely the program is to reach its end.
    pub chance: ProgramChanceState,
    /// What holds in all runs.
    pub proof: ProgramProofState,
    /// The part that is shown where there is no room for all.
    pub part: ProgramPart,
    /// Why the last step could not be taken.
    pub error: Option<String>,
    /// The conflicts of the step before the current moment.
    conflicts: Option<StepConflicts>,
    /// The hitting-set tree that was started last.
    diagnosing: Option<Diagnosing>,
    /// Whether steps go by themselves.
    pub is_playing: bool,
    elapsed_secs: f64,
}

/// A part of what is shown of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgramPart {
    #[default]
    Automaton,
    /// The plant at the moment that is looked at; without a plant, what is known.
    Plant,
    /// Many runs with chance.
    ManyRuns,
    /// What holds in all runs.
    Proof,
    Steps,
}

impl ProgramPart {
    /// All parts, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::Automaton, Self::Plant, Self::ManyRuns, Self::Proof, Self::Steps];

    /// Returns what it is called by commands.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automaton => "automaton",
            Self::Plant => "plant",
            Self::ManyRuns => "many-runs",
            Self::Proof => "proof",
            Self::Steps => "steps",
        }
    }
}

/// What decides by chance which components fail: with the same, the same ones fail in the same steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultSeed {
    pub seed: u64,
    /// Which of the many runs with that seed, from 0; without it, the seed is that of the run itself.
    pub run: Option<u64>,
}

impl FaultSeed {
    fn seed_of_run(self) -> u64 {
        self.run.map_or(self.seed, |number| run_seed(self.seed, number))
    }
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
    /// Shows this part where there is no room for all.
    Show(ProgramPart),
    /// In the next step the component comes into this mode, whatever is commanded; `None` takes that back.
    Inject(ComponentId, Option<u8>),
    /// In the last step this was observed instead of what the plant showed; `None` takes that back.
    Observe(plant::VariableId, Option<u8>),
    /// In the next step, the value of a variable of a program without a plant is known to be this, or not known.
    Know(VariableId, Option<u32>),
    /// Starts the hitting-set tree over the conflicts of the last step, again if there is one.
    StartDiagnosis,
    /// Lets a node of that tree become something.
    Diagnose(usize, HittingMove),
    /// Does the next step of that tree, level by level (`false`), or all of them.
    DiagnoseNext(bool),
    /// From the first step on, components fail by chance, or only those that were made to.
    SetFaultSeed(Option<FaultSeed>),
}

/// Steps a second while playing.
const STEPS_PER_SEC: f64 = 1.5;
/// A log does not grow longer than this.
const MAX_STEPS: usize = 400;

impl AutomatonState {
    /// Follows the document if it has changed since.
    pub fn follow(&mut self, document: &Document, is_control: bool) {
        if self.revision == document.revision() {
            return;
        }
        self.chance.give_up();
        self.proof.follow(document.revision());
        let asked = self.asked;
        if !is_control {
            *self = Self { asked, ..Self::default() };
        }
        self.revision = document.revision();
        self.is_control = is_control;
        self.wants_answer = is_control;
    }

    /// Returns whether there is something to ask the core.
    pub(crate) const fn wants_answer(&self) -> bool {
        self.wants_answer
    }

    /// Returns what to ask the core.
    pub(crate) fn request(&mut self, document: &Document) -> ControlRun {
        self.wants_answer = false;
        self.asked += 1;
        self.is_waiting = true;
        self.coming.clear();
        self.coming.extend(self.moments.iter().take(self.fresh).cloned());
        ControlRun {
            token: self.asked,
            revision: self.revision,
            source: document.shared_text().into(),
            plant: Some(mission_file::PLANT.into()),
            seed: self.fault_seed.map(FaultSeed::seed_of_run),
            inputs: self.log.clone(),
            held_program: self.program_key,
            held_run: self.run_key,
            held: self.fresh as u32,
        }
    }

    /// Takes what the core answered.
    pub fn take(&mut self, standing: ControlStanding) {
        if standing.token != self.asked || !self.is_waiting {
            return;
        }
        if let Some(program) = standing.content {
            self.program_key = standing.program;
            // While a text has errors, the steps wait for it to be whole again.
            let is_other =
                self.program.replace(program).zip(self.program.as_ref()).is_some_and(|(before, after)| {
                    !matches!(before, Program::Broken)
                        && !matches!(after, Program::Broken)
                        && !before.has_names_of(after)
                });
            if is_other && !self.log.is_empty() {
                self.forget_steps();
                self.wants_answer = true;
                return;
            }
        }
        self.coming.truncate(standing.first as usize);
        self.coming.extend(standing.moments.into_iter().map(Arc::new));
        if !standing.is_complete {
            return;
        }
        self.is_waiting = false;
        self.run_key = standing.run;
        self.moments = std::mem::take(&mut self.coming);
        self.fresh = self.moments.len();
        self.error = standing.trouble;
        if !matches!(self.program, Some(Program::Plant(_) | Program::Broken) | None) {
            self.log.truncate(self.moments.len().saturating_sub(1));
            self.target = self.target.min(self.log.len());
        }
        self.at = self.target.min(self.moments.len().saturating_sub(1));
        self.is_playing &= self.can_step();
    }

    /// The core stopped over what it was asked.
    pub(crate) const fn give_up(&mut self) {
        self.is_waiting = false;
        self.is_playing = false;
        self.chance.give_up();
        self.proof.give_up();
    }

    /// Returns whether the text is a control program.
    pub const fn is_control(&self) -> bool {
        self.is_control
    }

    /// Whether the core takes steps, and how many moments are known of how many.
    pub fn progress(&self) -> Option<(usize, usize)> {
        self.is_waiting.then_some((self.coming.len(), self.log.len() + 1))
    }

    /// Returns what the text comes to; nothing if it is a mission, or not known yet.
    pub const fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    /// Returns how things stand at the moment that is looked at.
    pub fn moment(&self) -> Option<&Moment> {
        self.moments.get(self.at).map(Arc::as_ref)
    }

    /// All moments, those that were stepped back over included.
    pub fn moments(&self) -> &[Arc<Moment>] {
        &self.moments
    }

    /// Returns how many steps were taken before the moment that is looked at.
    pub const fn at(&self) -> usize {
        self.at
    }

    /// The conflicts of the step before the current moment; `None` at the first moment, and without a plant.
    pub fn step_conflicts(&self) -> Option<&StepConflicts> {
        self.conflicts.as_ref()
    }

    /// Returns whether the known conflicts belong to a step other than the one before the current moment.
    pub(crate) fn has_other_conflicts(&self) -> bool {
        match (self.last_step(), &self.conflicts) {
            (Some((model, before, after)), Some(known)) => !known.is_of(model, before, after),
            (step, known) => step.is_some() || known.is_some(),
        }
    }

    /// Finds the conflicts of the step before the current moment.
    pub(crate) fn follow_conflicts(&mut self) {
        let step = self.last_step();
        self.conflicts = step.map(|(model, before, after)| StepConflicts::new(model, before, after));
    }

    /// The step before the current moment: the plant's model, and the moments before and after the step.
    fn last_step(&self) -> Option<(&Arc<plant::Model>, &Arc<Moment>, &Arc<Moment>)> {
        let model = self.program.as_ref()?.model()?;
        Some((model, self.moments.get(self.at.checked_sub(1)?)?, self.moments.get(self.at)?))
    }

    /// The hitting-set tree over these conflicts, if the user has started one.
    pub fn diagnosing(&self) -> Option<&Diagnosing> {
        let root = self.conflicts.as_ref()?.root()?;
        self.diagnosing.as_ref().filter(|known| known.is_about(root))
    }

    fn diagnose(&mut self, change: impl FnOnce(&mut Diagnosing, &plant::Model)) {
        let Some(root) = self.conflicts.as_ref().and_then(StepConflicts::root) else { return };
        let Some(model) = self.program.as_ref().and_then(Program::model) else { return };
        let kept = self.diagnosing.take().filter(|known| known.is_about(root));
        change(self.diagnosing.insert(kept.unwrap_or_else(|| root.clone())), model);
    }

    /// Returns what comes from outside in the step after the moment that is looked at.
    pub fn next_input(&self) -> Input {
        let logged = self.pending.as_ref().or_else(|| self.log.get(self.target));
        logged.cloned().unwrap_or_else(|| self.usual_input())
    }

    /// Returns what came from outside in the step before the moment that is looked at.
    pub fn last_input(&self) -> Option<&Input> {
        self.log.get(self.target.checked_sub(1)?)
    }

    /// With it, components fail by chance.
    pub const fn fault_seed(&self) -> Option<FaultSeed> {
        self.fault_seed
    }

    /// The modes that components were made to come into, by step from 1 and by component.
    pub fn injected(&self) -> BTreeMap<u32, BTreeMap<SmolStr, SmolStr>> {
        let Some(model) = self.program.as_ref().and_then(Program::model) else { return BTreeMap::new() };
        let pending = self.pending.as_ref().map(|input| (self.target, input));
        let logged =
            self.log.iter().enumerate().take(if pending.is_some() { self.target } else { usize::MAX });
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

    /// Starts again with this fault seed, and with these modes to come into by step and component.
    pub fn show_run(&mut self, seed: FaultSeed, injected: &BTreeMap<u32, BTreeMap<SmolStr, SmolStr>>) {
        self.forget_steps();
        self.fault_seed = Some(seed);
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
        self.wants_answer = true;
    }

    /// Starts again without chance, with what comes from outside in each step, and looks at the moment after the last.
    pub(crate) fn show_steps(&mut self, inputs: Vec<StepInput>) {
        self.forget_steps();
        self.fault_seed = None;
        self.log.extend(inputs.into_iter().map(|plant| Input { plant, ..Input::default() }));
        self.target = self.log.len();
        self.wants_answer = true;
    }

    /// Forgets everything: another text was opened.
    pub fn forget(&mut self) {
        self.forget_steps();
        self.fault_seed = None;
        self.program = None;
        self.program_key = ContentKey::default();
        self.moments.clear();
        self.fresh = 0;
        self.at = 0;
    }

    /// The first moment stays: no step leads to it.
    fn forget_steps(&mut self) {
        self.log.clear();
        self.pending = None;
        self.fresh = self.fresh.min(1);
        self.moments.truncate(1);
        self.at = 0;
        self.target = 0;
        self.error = None;
        self.is_playing = false;
    }

    /// Does what `command` asks for.
    pub fn apply(&mut self, command: AutomatonCommand) {
        match command {
            AutomatonCommand::Step(steps) => {
                for _ in 0..steps.unsigned_abs().min(MAX_STEPS as u64) {
                    if steps > 0 { self.step() } else { self.go_to(self.target.saturating_sub(1)) }
                }
            }
            AutomatonCommand::GoTo(moment) => {
                self.go_to(moment.min(self.log.len()));
                while self.target < moment && self.can_step() {
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
            AutomatonCommand::Reset => self.forget_steps(),
            AutomatonCommand::Show(part) => self.part = part,
            AutomatonCommand::SetFaultSeed(seed) => {
                self.fault_seed = seed;
                self.wants_answer = true;
            }
            AutomatonCommand::StartDiagnosis => {
                self.diagnosing = self.conflicts.as_ref().and_then(StepConflicts::root).cloned();
            }
            AutomatonCommand::Diagnose(node, step) => {
                self.diagnose(|tree, model| tree.apply(model, node, step));
            }
            AutomatonCommand::DiagnoseNext(all) => self.diagnose(|tree, model| {
                // A tree that is too large stays open.
                for _ in 0..if all { plant::hitting_sets::MAX_NODES } else { 1 } {
                    tree.apply_next(model);
                }
            }),
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
                let Some(at) = self.target.checked_sub(1) else { return };
                let Some(input) = self.log.get_mut(at) else { return };
                match value {
                    Some(value) => input.plant.observed.insert(variable, value),
                    None => input.plant.observed.remove(&variable),
                };
                self.log.truncate(self.target);
                self.pending = None;
                self.fresh = self.fresh.min(self.target);
                self.wants_answer = true;
            }
        }
    }

    /// Lets `seconds` go by. Returns whether another moment is shown, or asked for.
    pub fn advance(&mut self, seconds: f64, rate: f64) -> bool {
        if !self.is_playing {
            return false;
        }
        self.elapsed_secs += seconds * rate;
        if self.elapsed_secs * STEPS_PER_SEC < 1.0 || self.is_waiting || self.wants_answer {
            return false;
        }
        self.elapsed_secs = 0.0;
        self.step();
        self.is_playing = self.wants_answer || self.can_step();
        true
    }

    /// Returns whether the program has not ended at the moment that is looked at, as far as that is known.
    pub fn can_step(&self) -> bool {
        let goes_on = match self.moments.get(self.target) {
            Some(moment) if self.target < self.fresh => {
                let plant = moment.plant.as_ref();
                let record = plant.and_then(|plant| plant.record.as_ref());
                let is_explained = record.is_none_or(|record| record.outcome == StepOutcome::Explained);
                !moment.marking.is_empty() && is_explained
            }
            // The core takes no more steps than there are.
            _ => self.is_waiting || self.wants_answer,
        };
        goes_on && self.target < MAX_STEPS
    }

    fn step(&mut self) {
        if !self.can_step() {
            return;
        }
        let is_logged = self.pending.is_none() && self.target < self.log.len();
        if !is_logged {
            let input = self.next_input();
            self.log.truncate(self.target);
            self.log.push(input);
            self.pending = None;
            self.fresh = self.fresh.min(self.target + 1);
            self.wants_answer = true;
        }
        self.target += 1;
        if self.target < self.fresh {
            self.at = self.target;
        }
    }

    fn go_to(&mut self, moment: usize) {
        if moment != self.target {
            self.pending = None;
            self.target = moment;
        }
        if moment < self.fresh {
            self.at = moment;
        }
    }

    fn change_next(&mut self, input: Input) {
        self.log.truncate(self.target);
        self.pending = Some(input);
        // What was to come afterwards will not.
        self.fresh = self.fresh.min(self.target + 1);
        self.moments.truncate(self.target + 1);
        self.error = None;
    }

    /// Returns what is known stays known; a fault happens once.
    fn usual_input(&self) -> Input {
        let known = self.last_input().map(|input| input.known.clone()).unwrap_or_default();
        Input { known, ..Input::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state, with its document and the core that takes its steps.
    struct Opened {
        document: Document,
        state: AutomatonState,
        core: mission::Core,
    }

    impl Opened {
        fn apply(&mut self, command: AutomatonCommand) {
            self.state.apply(command);
            self.answer();
        }

        fn follow(&mut self) {
            self.state.follow(&self.document, true);
            self.answer();
        }

        /// Answers what is asked, as long as something is.
        fn answer(&mut self) {
            while self.state.wants_answer() {
                let wanted = self.state.request(&self.document);
                let mut answers = Answers::default();
                self.core.handle(link::Request::RunControl(wanted), &mut answers);
                for standing in answers.0 {
                    self.state.take(standing);
                }
            }
        }
    }

    impl std::ops::Deref for Opened {
        type Target = AutomatonState;

        fn deref(&self) -> &AutomatonState {
            &self.state
        }
    }

    #[derive(Default)]
    struct Answers(Vec<ControlStanding>);

    impl mission::CoreHost for Answers {
        fn now_millis(&self) -> f64 {
            0.0
        }

        fn is_superseded(&mut self) -> bool {
            false
        }

        fn answer(&mut self, response: link::Response) {
            if let link::Response::ControlRun(standing) = response {
                self.0.push(*standing);
            }
        }
    }

    fn opened(text: &str) -> Opened {
        let document = Document::new(text);
        let mut opened =
            Opened { document, state: AutomatonState::default(), core: mission::Core::default() };
        opened.follow();
        opened
    }

    fn orbit_insertion() -> Opened {
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
        let mut state = orbit_insertion();
        state.apply(AutomatonCommand::Step(3));
        let text = format!("; A note.\n{}", state.document.text());
        state.document.replace_all(&text);
        state.follow();
        assert_eq!((state.at(), marked(&state)), (3, vec!["a4".to_owned(), "w2".to_owned()]));
        state.document.replace_all("Main ():: (WHEN-DONEXT (lamp = off) (lamp = on))");
        state.follow();
        assert_eq!(state.at(), 0);
    }

    #[test]
    fn what_was_known_is_shown_until_the_core_has_answered() {
        let mut state = orbit_insertion();
        state.apply(AutomatonCommand::Step(2));
        let before = marked(&state);
        state.state.apply(AutomatonCommand::Step(1));
        assert_eq!((state.at(), marked(&state)), (2, before), "the step is asked for");
        state.answer();
        assert_eq!(state.at(), 3);
    }

    #[test]
    fn an_answer_to_what_was_asked_before_is_not_taken() {
        let mut state = orbit_insertion();
        state.state.apply(AutomatonCommand::Step(1));
        let earlier = state.state.request(&state.document);
        state.state.apply(AutomatonCommand::Step(1));
        let later = state.state.request(&state.document);
        let mut answers = Answers::default();
        state.core.handle(link::Request::RunControl(earlier), &mut answers);
        state.core.handle(link::Request::RunControl(later), &mut answers);
        let [first, second] = <[_; 2]>::try_from(answers.0).expect("each is answered once");
        state.state.take(first);
        assert_eq!(state.at(), 0);
        state.state.take(second);
        assert_eq!(state.at(), 2);
    }
}
