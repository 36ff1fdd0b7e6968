//! The control programs of a mission: compiled against their plant, and run when an activity that names one is started.
//!
//! All programs of a mission control one plant. It stays as a program leaves it, and so does what is believed of it, so
//! that a later program goes on from there. A plant takes commands of one program at a time.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use exact::{Bound, Overflow, Time};
use executive::model_based::{Estimation, Estimator, Options, Run, StepInput, StepRecord, System};
use executive::{ActivityExecution, ActivityExecutor, Disturbance, Ends, Entry, Happening};
use plant::{Belief, Model, Random, State};
use rmpl::program::{Name, Program};
use rmpl::{Code, Diagnostic};
use smol_str::SmolStr;
use tpn::{Network, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan};

use crate::review::TimeRange;
use crate::review::distances::Distances;

/// The programs of a mission, by the activity that runs each.
#[derive(Clone, Debug, Default)]
pub struct Programs {
    systems: BTreeMap<SmolStr, Arc<System>>,
    /// How long a step takes, in mission units.
    step: Time,
}

/// A program is given up after this many steps, even if its activity may last forever.
const MAX_STEPS: i64 = 1000;

impl Programs {
    /// Compiles the programs that the primitives of `program` run, and says what is wrong with them.
    ///
    /// A control block with mistakes of its own has been reported by the language, and gives no programs here.
    pub fn compile(program: &Program) -> (Self, Vec<Diagnostic>) {
        let mut programs = Self { systems: BTreeMap::new(), step: program.options.control_step };
        let mut found = Vec::new();
        for extra in program.control.iter().skip(1) {
            let message = "a mission has one control block; this one is not read";
            found.push(Diagnostic::error(Code("E-DUP"), extra.span, message));
        }
        let runners =
            program.primitives.iter().filter_map(|primitive| Some((primitive, primitive.runs.as_ref()?)));
        let mut runners = runners.peekable();
        if runners.peek().is_none() {
            return (programs, found);
        }
        let block = program.control.first();
        let parsed = rmpl::control::parse(block.map_or("", |block| block.text.as_str()));
        if parsed.has_errors() {
            return (programs, found);
        }
        let offset = block.map_or(0, |block| block.text_span.start);
        for (primitive, name) in runners {
            let Some(definition) = parsed.file.definitions.iter().find(|it| it.name.text == name.text) else {
                let known = parsed.file.definitions.iter().map(|it| it.name.text.as_str());
                found.push(unknown(name, block.is_some(), rmpl::control::nearest(&name.text, known)));
                continue;
            };
            if !definition.parameters.is_empty() {
                let message = format!("`{}` has parameters and cannot be run by itself", name.text);
                found.push(Diagnostic::error(Code("E-ARITY"), name.span, message));
                continue;
            }
            if parsed.file.instances.is_empty() {
                found.push(no_plant(name));
                continue;
            }
            let (system, diagnostics) = System::compile_definition(&parsed.file, &name.text);
            for diagnostic in diagnostics {
                let diagnostic = moved(diagnostic, offset);
                if !found.contains(&diagnostic) {
                    found.push(diagnostic);
                }
            }
            if let Some(system) = system {
                programs.systems.insert(primitive.name.text.clone(), system);
            }
        }
        (programs, found)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.systems.is_empty()
    }

    /// The program that an activity runs, with its plant.
    pub fn system(&self, activity: &str) -> Option<&Arc<System>> {
        self.systems.get(activity)
    }

    /// How long a step takes, in mission units.
    pub const fn step(&self) -> Time {
        self.step
    }

    /// What is wrong with the faults among `disturbances`, such as a component that the plant does not have.
    pub fn unknown_faults(&self, network: &Network, disturbances: &[Disturbance]) -> Vec<String> {
        let mut unknown = Vec::new();
        for disturbance in disturbances {
            let Disturbance::Fault { activity, component, mode, .. } = disturbance else { continue };
            let occurrence = network.occurrences.iter().find(|occurrence| occurrence.name == *activity);
            let Some(occurrence) = occurrence else { continue };
            match self.system(&occurrence.activity) {
                None => unknown.push(format!("control program of {activity}")),
                Some(system) if named(&system.model, component, mode).is_none() => {
                    unknown.push(format!("{component}={mode}"));
                }
                Some(_) => {}
            }
        }
        unknown
    }
}

/// The warning of two programs that may want the plant at once.
pub const BUSY: Code = Code("W-PLANT");

/// Warns of activities of `plan` whose control programs may run at the same time: all programs of a mission command one
/// plant, one at a time.
pub fn overlaps(program: &Program, network: &Network, plan: &Plan) -> Vec<Diagnostic> {
    let runs = |activity: &SmolStr| {
        program.primitives.iter().any(|it| it.name.text == *activity && it.runs.is_some())
    };
    let is_selected =
        |occurrence: &Occurrence| plan.windows.get(occurrence.start.index()).is_some_and(Option::is_some);
    let running: Vec<&Occurrence> = (network.occurrences.iter())
        .filter(|it| it.kind == OccurrenceKind::Primitive && runs(&it.activity) && is_selected(it))
        .collect();
    let pairs: Vec<[&Occurrence; 2]> = (running.iter().enumerate())
        .flat_map(|(index, &second)| running[..index].iter().map(move |&first| [first, second]))
        .collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let Some(mut distances) = Distances::new(network, plan) else { return Vec::new() };
    let gaps: Vec<(NodeId, NodeId)> =
        pairs.iter().flat_map(|[a, b]| [(a.end, b.start), (b.end, a.start)]).collect();
    let gaps = distances.between(&gaps);
    let may_overlap =
        |gaps: &[Option<TimeRange>]| gaps.iter().all(|gap| gap.is_none_or(|gap| gap.least.is_negative()));
    (pairs.iter().zip(gaps.chunks(2)))
        .filter(|(_, gaps)| may_overlap(gaps))
        .filter_map(|([first, second], _)| {
            let message = format!(
                "{} and {} may run at the same time, but their programs command one plant: the one that starts second \
                 would find it taken, and the mission would be stopped",
                first.name, second.name
            );
            let hint = "put one after the other, or run one program that does both";
            Some(Diagnostic::warning(BUSY, second.span?, message).with_hint(hint))
        })
        .collect()
}

fn named(model: &Model, component: &str, mode: &str) -> Option<(plant::ComponentId, u8)> {
    let id = model.component_named(component)?;
    Some((id, model.mode_named(id, mode)?))
}

fn unknown(name: &Name, has_block: bool, nearest: Option<&str>) -> Diagnostic {
    let message = format!("no control program `{}` is defined", name.text);
    let hint = match (nearest, has_block) {
        (Some(nearest), _) => format!("did you mean `{nearest}`?"),
        (None, true) => format!("define it in the control block: `{} ():: …`", name.text),
        (None, false) => format!("define it in a control block: `control {{ {} ():: … }}`", name.text),
    };
    Diagnostic::error(Code("E-UNDEF"), name.span, message).with_hint(hint)
}

fn no_plant(name: &Name) -> Diagnostic {
    let message = format!("there is no plant for `{}` to control", name.text);
    Diagnostic::error(Code("E-UNDEF"), name.span, message)
        .with_hint("declare its components by DEFCLASS and DEFINSTANCE in the control block")
}

fn moved(mut diagnostic: Diagnostic, offset: u32) -> Diagnostic {
    let shift = |span: rmpl::Span| rmpl::Span::new(span.start + offset, span.end + offset);
    diagnostic.span = shift(diagnostic.span);
    for edit in diagnostic.fixes.iter_mut().flat_map(|fix| &mut fix.edits) {
        edit.span = shift(edit.span);
    }
    diagnostic
}

/// Runs control programs when the executive starts their activities; leaves all other activities to another executor.
pub struct ProgramPerformer<'run> {
    programs: &'run Programs,
    disturbances: &'run [Disturbance],
    /// Lets components fail by chance.
    chance: Option<Random>,
    others: &'run mut dyn ActivityExecutor,
    /// The plant as the last program left it, and what was believed of it.
    plant: Option<(State, Belief)>,
    /// The plant after each step of the last program, and when that was over.
    history: Vec<(Time, State, Belief)>,
    /// Which activity controls the plant, and until when; no time if it never stops.
    control: Option<(SmolStr, Option<Time>)>,
}

impl<'run> ProgramPerformer<'run> {
    /// With a seed, components fail by chance; without, only those fail that `disturbances` name.
    pub fn new(
        programs: &'run Programs,
        disturbances: &'run [Disturbance],
        seed: Option<u64>,
        others: &'run mut dyn ActivityExecutor,
    ) -> Self {
        Self {
            programs,
            disturbances,
            chance: seed.map(Random::new),
            others,
            plant: None,
            history: Vec::new(),
            control: None,
        }
    }

    fn run(
        &mut self,
        system: &Arc<System>,
        network: &Network,
        id: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow> {
        let occurrence = &network.occurrences[id.index()];
        let name = occurrence.name.clone();
        if let Some((other, until)) = &self.control
            && until.is_none_or(|until| until > start)
        {
            let until = until.map_or_else(String::new, |until| format!(" until {}", until.readable()));
            let reason = format!("the program of {other} commands the plant{until}");
            return Ok(ActivityExecution { ends: Ends::Never(reason), ..ActivityExecution::default() });
        }
        let step = self.programs.step;
        let upper = occurrence.arc.and_then(|arc| network.arcs.get(arc.index()));
        let most_steps = match upper.map(|arc| arc.upper) {
            // One step more than there is time for shows whether it would have ended later.
            Some(Bound::Finite(upper)) => {
                let steps = upper.checked_ratio(step).ok_or(Overflow)?.floor();
                steps.saturating_add(1).clamp(1, MAX_STEPS)
            }
            _ => MAX_STEPS,
        };
        let options = Options { seed: self.chance.as_mut().map(Random::next_bits), ..Options::default() };
        let estimator = Estimator::new(Arc::clone(&system.planner), Estimation::for_model(&system.model));
        let mut run = match self.plant.take() {
            Some((state, belief)) => Run::resumed(system, options, estimator, state, belief),
            None => Run::with_estimator(system, options, estimator),
        };
        let mut entries = Vec::new();
        let mut history = vec![(start, run.true_state().clone(), run.belief().clone())];
        let mut trouble = None;
        let mut steps = 0;
        while !run.is_done() && steps < most_steps {
            steps += 1;
            let input = self.faults(&system.model, &name, steps);
            match run.step(&input) {
                Ok(record) => {
                    let happening = Happening::Progress { name: name.clone(), text: text(system, record) };
                    let time = step.checked_mul(steps).and_then(|after| start.checked_add(after));
                    let time = time.ok_or(Overflow)?;
                    entries.push(Entry { time, happening });
                    history.push((time, run.true_state().clone(), run.belief().clone()));
                }
                Err(error) => {
                    trouble = Some(format!("step {steps} of the program cannot be taken: {error}"));
                    break;
                }
            }
        }
        let ends = match trouble {
            Some(trouble) => Ends::Never(trouble),
            None if run.is_done() => Ends::After(step.checked_mul(steps).ok_or(Overflow)?),
            None => Ends::Never(format!("its program did not reach its end in {steps} steps")),
        };
        self.plant = Some((run.true_state().clone(), run.belief().clone()));
        let until = match &ends {
            Ends::After(duration) => Some(start.checked_add(*duration).ok_or(Overflow)?),
            _ => None,
        };
        self.history = history;
        self.control = Some((name, until));
        Ok(ActivityExecution { ends, entries, ..ActivityExecution::default() })
    }

    /// Programs of activities that are given up command nothing any more; the plant is as they had brought it by then.
    fn stop_programs(&mut self, network: &Network, of: &[OccurrenceId], now: Time) {
        let is_given_up = |name: &SmolStr| of.iter().any(|id| network.occurrences[id.index()].name == *name);
        if self
            .control
            .as_ref()
            .is_none_or(|(name, until)| !is_given_up(name) || until.is_some_and(|until| until <= now))
        {
            return;
        }
        let by_then = self.history.iter().rfind(|(at, ..)| *at <= now);
        if let Some((_, state, belief)) = by_then {
            self.plant = Some((state.clone(), belief.clone()));
        }
        self.control = None;
    }

    /// The faults of one step.
    fn faults(&self, model: &Model, activity: &SmolStr, step: i64) -> StepInput {
        let mut input = StepInput::default();
        for disturbance in self.disturbances {
            if let Disturbance::Fault { activity: at, step: when, component, mode } = disturbance
                && at == activity
                && i64::from(*when) == step
                && let Some((component, mode)) = named(model, component, mode)
            {
                input.injected.insert(component, mode);
            }
        }
        input
    }
}

impl ActivityExecutor for ProgramPerformer<'_> {
    fn start(
        &mut self,
        network: &Network,
        occurrence: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow> {
        let activity = network.occurrences.get(occurrence.index()).map_or("", |it| it.activity.as_str());
        match self.programs.system(activity).cloned() {
            Some(system) => self.run(&system, network, occurrence, start),
            None => self.others.start(network, occurrence, start),
        }
    }

    fn whereabouts(&self, network: &Network, of: &[OccurrenceId], now: Time) -> Vec<(u32, [f64; 2])> {
        self.others.whereabouts(network, of, now)
    }

    fn abandon(&mut self, network: &Network, of: &[OccurrenceId], now: Time) {
        self.others.abandon(network, of, now);
        self.stop_programs(network, of, now);
    }

    fn granularity(&self) -> Time {
        let others = self.others.granularity();
        if self.programs.is_empty() {
            return others;
        }
        // A part too small to be kept is found out when the plan is made ready.
        self.programs.step.common_part(others).unwrap_or(others)
    }
}

/// What a step did, in words: commands, then what is estimated to have changed.
fn text(system: &System, record: &StepRecord) -> String {
    let model = &system.model;
    let commands: Vec<String> =
        model.command_names(&record.commands).iter().map(|(name, value)| format!("{name}.{value}")).collect();
    let commands = if commands.is_empty() { "no command".to_owned() } else { commands.join(", ") };
    let mut text = format!("step {}: {commands}", record.trace.step);
    for (&component, &mode) in &record.input.injected {
        let name = model.component(component).map_or("?", |component| component.name.as_str());
        let _ = write!(text, "; {name} comes into {}", model.mode_name(component, mode));
    }
    let found: Vec<String> = record.conflicts.iter().map(|conflict| conflict.describe(model)).collect();
    if !found.is_empty() {
        let _ = write!(text, "; {}", found.join("; "));
    }
    text
}
