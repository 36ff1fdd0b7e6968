//! The control programs of a mission, compiled against their plant.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::Time;
use executive::Disturbance;
use executive::model_based::{ControlledPlant, System};
use plant::{ComponentId, Model};
use review::TimeRange;
use review::distances::Distances;
use rmpl::control::Name as ControlName;
use rmpl::diagnostics::duplicate;
use rmpl::program::{Name, PrimitiveDecl, Program, Runs};
use rmpl::{Code, Diagnostic, Severity, Span};
use smol_str::SmolStr;
use snapshot::Commanded;
use tpn::{Network, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan};

/// The programs of a mission, by the activity that runs each and what it hands over.
#[derive(Clone, Debug, Default)]
pub struct Programs {
    systems: BTreeMap<Runner, Arc<System>>,
    /// How long a step takes, in mission units.
    step: Time,
}

/// An activity and what it hands to its control program.
type Runner = (SmolStr, Vec<SmolStr>);

/// The place of names that no control block has written.
const ELSEWHERE: Span = Span { start: u32::MAX, end: u32::MAX };

impl Programs {
    /// Compiles the programs that the primitives of `program` run, and says what is wrong with them. One that is handed
    /// what the activity is called with is compiled for each call in `network`.
    ///
    /// A control block with mistakes of its own has been reported by the language, and gives no programs here.
    pub fn compile(program: &Program, network: Option<&Network>) -> (Self, Vec<Diagnostic>) {
        let mut programs = Self { systems: BTreeMap::new(), step: program.options.control_step };
        let mut found = Vec::new();
        for extra in program.control.iter().skip(1) {
            let message = "a mission can have only one control block; this one is ignored";
            found.push(Diagnostic::error(Code("E-DUP"), extra.span, message));
        }
        let runners =
            program.primitives.iter().filter_map(|primitive| Some((primitive, primitive.runs.as_deref()?)));
        let mut runners = runners.peekable();
        if runners.peek().is_none() {
            return (programs, found);
        }
        let block = program.control.first();
        let mut parsed = rmpl::control::parse(block.map_or("", |block| block.text.as_str()));
        if parsed.has_errors() {
            return (programs, found);
        }
        let offset = block.map_or(0, |block| block.text_span.start);
        let options = &program.options;
        parsed.file.mission_step_secs =
            options.control_step.checked_mul(options.time_unit.seconds()).map(Time::units);
        if let Some(step) = parsed.file.steps.first().filter(|_| options.has_control_step) {
            found.push(moved(duplicate::step_of_mission(step.span), offset, step.span));
        }
        let (plant, mut of_plant) = plant::compile(&parsed.file);
        let plant = plant.filter(|_| of_plant.iter().all(|found| found.severity != Severity::Error));
        let plant = plant.map(ControlledPlant::new);
        for (primitive, runs) in runners {
            let name = &runs.program;
            let Some(definition) = parsed.file.definitions.iter().find(|it| it.name.text == name.text) else {
                let known = parsed.file.definitions.iter().map(|it| it.name.text.as_str());
                found.push(unknown(name, block.is_some(), rmpl::control::nearest(&name.text, known)));
                continue;
            };
            if definition.parameters.len() != runs.arguments.len() {
                found.push(arity(name, definition.parameters.len(), runs.arguments.len()));
                continue;
            }
            if parsed.file.instances.is_empty() {
                found.push(no_plant(name));
                continue;
            }
            let Some(plant) = &plant else {
                found.extend(of_plant.drain(..).map(|diagnostic| moved(diagnostic, offset, name.span)));
                continue;
            };
            for (runner, arguments, span) in calls(primitive, runs, network) {
                if programs.systems.contains_key(&runner) {
                    continue;
                }
                let main = ControlName { text: name.text.clone(), span: ELSEWHERE };
                let (system, diagnostics) =
                    System::compile_definition(&parsed.file, plant, &main, &arguments);
                for diagnostic in diagnostics {
                    let diagnostic = moved(diagnostic, offset, span);
                    if !found.contains(&diagnostic) {
                        found.push(diagnostic);
                    }
                }
                let Some(system) = system else { continue };
                for argument in
                    arguments.iter().filter(|argument| !is_of_plant(&system.model, &argument.text))
                {
                    let diagnostic = not_of_plant(&system.model, argument, span);
                    if !found.contains(&diagnostic) {
                        found.push(diagnostic);
                    }
                }
                programs.systems.insert(runner, system);
            }
        }
        (programs, found)
    }

    /// Returns whether some program is handed what its activity is called with.
    pub fn depend_on_calls(program: &Program) -> bool {
        program.primitives.iter().any(|primitive| {
            let mut handed = primitive.runs.iter().flat_map(|runs| &runs.arguments);
            handed.any(|argument| formal(primitive, argument).is_some())
        })
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.systems.is_empty()
    }

    /// The program that an activity runs, with its plant.
    pub fn system(&self, occurrence: &Occurrence) -> Option<&Arc<System>> {
        if occurrence.kind != OccurrenceKind::Primitive || self.systems.is_empty() {
            return None;
        }
        let with =
            |arguments: &[SmolStr]| self.systems.get(&(occurrence.activity.clone(), arguments.to_vec()));
        with(&occurrence.arguments).or_else(|| with(&[]))
    }

    /// Returns what they command, and the activities of `network` that run them.
    pub fn commanded(&self, network: &Network) -> Option<Commanded> {
        let plant = Arc::clone(&self.systems.values().next()?.model);
        let runs = |&(_, occurrence): &(usize, &Occurrence)| self.system(occurrence).is_some();
        let by = network.occurrences.iter().enumerate().filter(runs);
        Some(Commanded { plant, by: by.map(|(index, _)| OccurrenceId::from_index(index)).collect() })
    }

    /// Returns how long a step takes, in mission units.
    pub const fn step(&self) -> Time {
        self.step
    }

    /// Returns what is wrong with the faults among `disturbances`, such as a component that the plant does not have.
    pub fn unknown_faults(&self, network: &Network, disturbances: &[Disturbance]) -> Vec<String> {
        let mut unknown = Vec::new();
        for disturbance in disturbances {
            let Disturbance::Fault { activity, component, mode, .. } = disturbance else { continue };
            let occurrence = network.occurrences.iter().find(|occurrence| occurrence.name == *activity);
            let Some(occurrence) = occurrence else { continue };
            match self.system(occurrence) {
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

/// The parameter of a primitive that something handed to its program is, by its place.
fn formal(primitive: &PrimitiveDecl, argument: &Name) -> Option<usize> {
    primitive.formals.iter().position(|formal| formal.text == argument.text)
}

/// The ways in which a primitive is called as far as its control program can tell, each with what that is handed and where
/// the call is written. One that hands over nothing of its own is called in one way.
fn calls(
    primitive: &PrimitiveDecl,
    runs: &Runs,
    network: Option<&Network>,
) -> Vec<(Runner, Vec<ControlName>, Span)> {
    let name = |text: &SmolStr| ControlName { text: text.clone(), span: ELSEWHERE };
    if runs.arguments.iter().all(|argument| formal(primitive, argument).is_none()) {
        let arguments = runs.arguments.iter().map(|argument| name(&argument.text)).collect();
        return vec![((primitive.name.text.clone(), Vec::new()), arguments, runs.program.span)];
    }
    let is_call = |it: &&Occurrence| {
        it.kind == OccurrenceKind::Primitive && it.activity == primitive.name.text && !it.arguments.is_empty()
    };
    let occurrences = network.into_iter().flat_map(|network| &network.occurrences).filter(is_call);
    let call = |occurrence: &Occurrence| {
        let handed = |argument: &Name| match formal(primitive, argument) {
            Some(place) => occurrence.arguments.get(place).map(name),
            None => Some(name(&argument.text)),
        };
        let arguments: Option<Vec<ControlName>> = runs.arguments.iter().map(handed).collect();
        let runner = (primitive.name.text.clone(), occurrence.arguments.clone());
        Some((runner, arguments?, occurrence.span.unwrap_or(runs.program.span)))
    };
    occurrences.filter_map(call).collect()
}

/// The warning of two programs that may want the same components at once.
pub const BUSY: Code = Code("W-PLANT");

/// Warns of activities of `plan` that may run at the same time and whose control programs command the same components: one
/// of them waits for the other.
pub fn overlaps(programs: &Programs, network: &Network, plan: &Plan) -> Vec<Diagnostic> {
    let is_selected =
        |occurrence: &Occurrence| plan.windows.get(occurrence.start.index()).is_some_and(Option::is_some);
    let running: Vec<(&Occurrence, BTreeSet<ComponentId>, &Model)> = (network.occurrences.iter())
        .filter(|it| is_selected(it))
        .filter_map(|it| programs.system(it).map(|system| (it, system.commanded(), &*system.model)))
        .collect();
    let mut pairs: Vec<([&Occurrence; 2], &SmolStr)> = Vec::new();
    for (index, (second, commanded, model)) in running.iter().enumerate() {
        for (first, others, _) in &running[..index] {
            let shared = commanded.intersection(others).next();
            if let Some(component) = shared.and_then(|&shared| model.component(shared)) {
                pairs.push(([first, second], &component.name));
            }
        }
    }
    if pairs.is_empty() {
        return Vec::new();
    }
    let Some(mut distances) = Distances::new(network, plan) else { return Vec::new() };
    let gaps: Vec<(NodeId, NodeId)> =
        pairs.iter().flat_map(|([a, b], _)| [(a.end, b.start), (b.end, a.start)]).collect();
    let gaps = distances.between(&gaps);
    let may_overlap =
        |gaps: &[Option<TimeRange>]| gaps.iter().all(|gap| gap.is_none_or(|gap| gap.least.is_negative()));
    (pairs.iter().zip(gaps.chunks(2)))
        .filter(|(_, gaps)| may_overlap(gaps))
        .filter_map(|(([first, second], component), _)| {
            let message = format!(
                "{} and {} may run at the same time, and both programs command {component}: the one that starts second waits \
                 until the other has ended",
                first.name, second.name
            );
            let hint = "put one after the other, or widen the bounds so that it can wait";
            Some(Diagnostic::warning(BUSY, second.span?, message).with_hint(hint))
        })
        .collect()
}

pub(crate) fn named(model: &Model, component: &str, mode: &str) -> Option<(plant::ComponentId, u8)> {
    let id = model.component_named(component)?;
    Some((id, model.mode_named(id, mode)?))
}

fn unknown(name: &Name, has_block: bool, nearest: Option<&str>) -> Diagnostic {
    let message = format!("unknown control program `{}`", name.text);
    let hint = match (nearest, has_block) {
        (Some(nearest), _) => format!("did you mean `{nearest}`?"),
        (None, true) => format!("define it in the control block: `{} ():: …`", name.text),
        (None, false) => format!("define it in a control block: `control {{ {} ():: … }}`", name.text),
    };
    Diagnostic::error(Code("E-UNDEF"), name.span, message).with_hint(hint)
}

fn no_plant(name: &Name) -> Diagnostic {
    let message = format!("`{}` needs a plant to control", name.text);
    Diagnostic::error(Code("E-UNDEF"), name.span, message)
        .with_hint("declare its components with DEFCLASS and DEFINSTANCE in the control block")
}

fn arity(name: &Name, expected: usize, handed: usize) -> Diagnostic {
    let names = |count: usize| match count {
        0 => "no names".to_owned(),
        1 => "one name".to_owned(),
        count => format!("{count} names"),
    };
    let message = format!("`{}` takes {}, but is given {}", name.text, names(expected), names(handed));
    let diagnostic = Diagnostic::error(Code("E-ARITY"), name.span, message);
    diagnostic
        .with_hint("pass it components of the plant, or parameters of the activity, as in `runs P(EngineA)`")
}

/// Returns whether a name is one of a plant's components, variables, modes or values.
fn is_of_plant(model: &Model, name: &str) -> bool {
    model.component_named(name).is_some()
        || model.variable_named(name).is_some()
        || model.components.iter().flat_map(|component| &component.modes).any(|mode| mode.name == name)
        || model.variables.iter().flat_map(|variable| &variable.values).any(|value| value == name)
}

fn not_of_plant(model: &Model, argument: &ControlName, call: Span) -> Diagnostic {
    let message = format!("the plant has no component `{}` for the program to command", argument.text);
    let known = model.components.iter().map(|component| component.name.as_str());
    let nearest = rmpl::control::nearest(&argument.text, known);
    let diagnostic = Diagnostic::error(Code("E-UNDEF"), call, message);
    match nearest {
        Some(nearest) => diagnostic.with_hint(format!("did you mean `{nearest}`?")),
        None => diagnostic,
    }
}

/// A place in a control block as one of the mission; what no block has written is written where it is called.
fn moved(mut diagnostic: Diagnostic, offset: u32, call: Span) -> Diagnostic {
    let shift = |span: Span| {
        if span == ELSEWHERE { call } else { Span::new(span.start + offset, span.end + offset) }
    };
    diagnostic.span = shift(diagnostic.span);
    for edit in diagnostic.fixes.iter_mut().flat_map(|fix| &mut fix.edits) {
        edit.span = shift(edit.span);
    }
    diagnostic
}
