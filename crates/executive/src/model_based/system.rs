//! A control program bound to the plant that it controls.

use std::collections::BTreeSet;
use std::sync::Arc;

use exact::Rational;
use hca::{Automaton, TestId, VariableId as ProgramVariableId, Vocabulary};
use plant::{
    ComponentId, FactoredBelief, Formula, Group, Known, Model, Observation, Planner, Probability, VariableId,
};
use rmpl::control::{
    Argument, Constraint, ConstraintKind, ControlFile, Definition, Expression, ExpressionKind, Name,
    expand_main, nearest, without_places,
};
use rmpl::{Code, Diagnostic, Severity};
use smol_str::SmolStr;

use super::conditions::Asker;
use super::goal::{GoalConfigurations, goal_configurations};

/// What a variable of the program represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding {
    Mode(ComponentId),
    Plant(VariableId),
    /// A variable that only the program sets.
    Program,
}

/// A control program and its plant.
#[derive(Clone, Debug)]
pub struct System {
    pub automaton: Arc<Automaton>,
    pub model: Arc<Model>,
    /// The plant's reactive planner.
    pub planner: Arc<Planner>,
    /// The components of the plant, by what ties them together.
    pub groups: Arc<Vec<Group>>,
    /// From which probability on the program takes a condition for known; `None` if it does so when the condition holds in
    /// the most likely state.
    pub entailment: Option<Probability>,
    /// The seconds that a step takes.
    pub step_secs: Rational,
    /// Over how many steps rewards are expected where the program chooses by them.
    pub horizon: u32,
    bindings: Vec<Binding>,
    /// Per location, the configurations of the plant that satisfy what it asserts.
    goal_configurations: Vec<Option<GoalConfigurations>>,
}

/// A plant with its reactive planner, for all programs that control it.
#[derive(Clone, Debug)]
pub struct ControlledPlant {
    model: Arc<Model>,
    planner: Arc<Planner>,
    groups: Arc<Vec<Group>>,
}

impl ControlledPlant {
    /// Compiles the planner's policies, and groups the components.
    pub fn new(model: Model) -> Self {
        let model = Arc::new(model);
        Self { planner: Arc::new(Planner::new(&model)), groups: Arc::new(plant::groups(&model)), model }
    }

    /// The model of the plant.
    pub fn model(&self) -> &Model {
        &self.model
    }
}

/// What compiling a program and its plant gives.
#[derive(Clone, Debug)]
pub struct SystemCompilation {
    /// Both, bound together; `None` when there are errors.
    pub system: Option<Arc<System>>,
    /// What is wrong with the program's text.
    pub program_diagnostics: Vec<Diagnostic>,
    /// What is wrong with the model's text; empty when the model is in the program's text.
    pub model_diagnostics: Vec<Diagnostic>,
}

impl System {
    /// Compiles a program and the model that it runs on; without a model text, the program's text must hold it.
    pub fn compile(program: &str, model: Option<&str>) -> SystemCompilation {
        let parsed = rmpl::control::parse(program);
        let mut program_diagnostics = parsed.diagnostics.clone();
        let mut model_diagnostics = Vec::new();
        let mut file = parsed.file.clone();
        let plant = match model {
            None => {
                let (plant, found) =
                    if parsed.has_errors() { (None, Vec::new()) } else { plant::compile(&parsed.file) };
                program_diagnostics.extend(found);
                plant
            }
            Some(text) => {
                let parsed = rmpl::control::parse(text);
                let has_errors = parsed.has_errors();
                file.methods = without_places(parsed.file.methods.clone());
                model_diagnostics.extend(parsed.diagnostics);
                let (plant, found) =
                    if has_errors { (None, Vec::new()) } else { plant::compile(&parsed.file) };
                model_diagnostics.extend(found);
                plant
            }
        };
        let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
        let mut system = None;
        if !program_diagnostics.iter().chain(&model_diagnostics).any(is_error) {
            match plant {
                None => {
                    let place = model_diagnostics.is_empty() && model.is_some();
                    let diagnostic = Diagnostic::error(
                        Code("E-UNDEF"),
                        rmpl::Span::default(),
                        "the program needs a plant to control",
                    )
                    .with_hint(
                        "declare components with DEFCLASS and DEFINSTANCE, here or in a separate model",
                    );
                    if place {
                        model_diagnostics.push(diagnostic);
                    } else {
                        program_diagnostics.push(diagnostic);
                    }
                }
                Some(plant) => {
                    let (bound, found) = bind(&file, &ControlledPlant::new(plant));
                    program_diagnostics.extend(found);
                    system = bound;
                }
            }
        }
        program_diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        SystemCompilation { system, program_diagnostics, model_diagnostics }
    }

    /// Compiles the definition called `main` of a file to control `plant`, with what its parameters represent. Spans are
    /// those of the file, and of what is wrong with a name that is handed over, that name's own.
    pub fn compile_definition(
        file: &ControlFile,
        plant: &ControlledPlant,
        main: &Name,
        arguments: &[Name],
    ) -> (Option<Arc<Self>>, Vec<Diagnostic>) {
        let mut file = file.clone();
        let Some(at) = file.definitions.iter().position(|definition| definition.name.text == main.text)
        else {
            return (None, Vec::new());
        };
        // The last definition is the one that runs.
        if arguments.is_empty() {
            let definition = file.definitions.remove(at);
            file.definitions.push(definition);
        } else {
            file.definitions.push(call(main, arguments));
        }
        bind(&file, plant)
    }

    /// Returns what the plant has to make true for a condition of the automaton to hold, where the program's own
    /// variables have these values.
    pub(super) fn condition(&self, test: TestId, settings: Vec<(ProgramVariableId, u32)>) -> Formula {
        let asker =
            Asker { automaton: &self.automaton, model: &self.model, bindings: &self.bindings, settings };
        self.automaton.guard(test).map_or(Formula::Constant(true), |guard| asker.condition(&guard.constraint))
    }

    /// The components that the program commands: those that its goals speak of, and those that these rest on.
    pub fn commanded(&self) -> BTreeSet<ComponentId> {
        let goals = self.goal_configurations.iter().flatten();
        self.planner.commanded_for(goals.flat_map(GoalConfigurations::components))
    }

    /// The groups of components that a condition speaks of.
    pub(super) fn groups_of(&self, condition: &Formula) -> Vec<usize> {
        let (belief, observation) =
            (FactoredBelief::certain(&self.groups, &self.model.initial_state()), Observation::default());
        Known { groups: &self.groups, belief: &belief, observation: &observation }.groups_of(condition)
    }

    /// The groups of components that the program speaks of or commands.
    pub(super) fn groups_used(&self) -> BTreeSet<usize> {
        let commanded = self.commanded();
        let is_spoken_of = |binding: Binding| self.bindings.contains(&binding);
        let is_used = |group: &Group| {
            group.components.iter().any(|id| commanded.contains(id) || is_spoken_of(Binding::Mode(*id)))
                || group.variables.iter().any(|id| is_spoken_of(Binding::Plant(*id)))
        };
        self.groups.iter().enumerate().filter(|(_, group)| is_used(group)).map(|(at, _)| at).collect()
    }

    /// The configurations of the plant that satisfy what a location asserts, if it asserts anything.
    pub(super) fn goal_configurations(&self, location: hca::LocationId) -> Option<&GoalConfigurations> {
        self.goal_configurations.get(location.0 as usize)?.as_ref()
    }
}

/// A definition that calls another one.
fn call(main: &Name, arguments: &[Name]) -> Definition {
    let arguments = arguments.iter().cloned().map(Argument::Word).collect();
    let kind = ExpressionKind::Call { name: main.clone(), arguments, bare: false };
    // No definition that is written has this name.
    let name = Name { text: SmolStr::new_static("(call)"), span: main.span };
    Definition { name, parameters: Vec::new(), body: Expression { kind, span: main.span }, span: main.span }
}

fn bind(file: &ControlFile, plant: &ControlledPlant) -> (Option<Arc<System>>, Vec<Diagnostic>) {
    let ControlledPlant { model, planner, groups } = plant;
    let (expanded, diagnostics) = expand_main(file);
    let Some(program) = expanded else { return (None, diagnostics) };
    let mut uses = Uses::default();
    uses.expression(&program);
    let mut vocabulary = Vocabulary::default();
    for component in &model.components {
        let modes = component.modes.iter().map(|mode| mode.name.clone()).collect();
        vocabulary.domains.insert(component.name.clone(), modes);
    }
    for variable in &model.variables {
        vocabulary.domains.insert(variable.name.clone(), variable.values.clone());
    }
    let known: BTreeSet<SmolStr> = vocabulary.domains.keys().cloned().collect();
    let asserted: BTreeSet<SmolStr> = uses.asserted.iter().map(|name| name.text.clone()).collect();
    let tested: BTreeSet<SmolStr> = uses.tested.iter().map(|name| name.text.clone()).collect();
    let mut diagnostics = Vec::new();
    let mut reported = BTreeSet::new();
    for name in uses.asserted.iter().chain(&uses.tested).filter(|name| !known.contains(&name.text)) {
        let is_own = asserted.contains(&name.text) && tested.contains(&name.text);
        if is_own {
            vocabulary.program_variables.insert(name.text.clone());
        } else if reported.insert(name.text.clone()) {
            diagnostics.push(undefined(name, &known, asserted.contains(&name.text)));
        }
    }
    let (automaton, found) = hca::compile(file, &vocabulary);
    diagnostics.extend(found);
    let Some(automaton) = automaton.filter(|_| diagnostics.is_empty()) else { return (None, diagnostics) };
    let binding = |name: &str| {
        let mode = model.component_named(name).map(Binding::Mode);
        mode.or_else(|| model.variable_named(name).map(Binding::Plant)).unwrap_or(Binding::Program)
    };
    let bindings = automaton.variables.iter().map(|variable| binding(&variable.name)).collect();
    let goal_configurations = automaton
        .locations
        .iter()
        .map(|location| {
            let assertion = location.assertion.as_ref()?;
            Some(goal_configurations(planner, &automaton.guard(assertion.test)?.constraint))
        })
        .collect();
    let (model, planner, groups) = (Arc::clone(model), Arc::clone(planner), Arc::clone(groups));
    let entailment =
        file.entailment().map(|given| Probability::new(given.numerator().into(), given.denominator().into()));
    let (step_secs, horizon) = (file.step_secs(), file.horizon());
    let system = System {
        automaton,
        model,
        planner,
        groups,
        entailment,
        step_secs,
        horizon,
        bindings,
        goal_configurations,
    };
    (Some(Arc::new(system)), diagnostics)
}

fn undefined(name: &Name, known: &BTreeSet<SmolStr>, is_asserted: bool) -> Diagnostic {
    let message = format!("the plant has no component or variable `{}`", name.text);
    let hint = nearest(&name.text, known.iter().map(SmolStr::as_str)).map_or_else(
        || {
            let missing = if is_asserted {
                "asserted, but never used in a guard"
            } else {
                "used in a guard, but never asserted"
            };
            format!("a variable that the plant does not have must be both asserted and used in a guard; this one is {missing}")
        },
        |meant| format!("did you mean `{meant}`?"),
    );
    Diagnostic::error(Code("E-UNDEF"), name.span, message).with_hint(hint)
}

/// The variables that a program asserts, and those that it asks for.
#[derive(Default)]
struct Uses {
    asserted: Vec<Name>,
    tested: Vec<Name>,
}

impl Uses {
    fn expression(&mut self, expression: &Expression) {
        if let Some(constraint) = expression.asserted() {
            names(constraint, &mut self.asserted);
        }
        if let Some(guard) = expression.guard() {
            names(&guard.constraint, &mut self.tested);
        }
        for part in expression.parts() {
            self.expression(part);
        }
    }
}

fn names(constraint: &Constraint, into: &mut Vec<Name>) {
    match &constraint.kind {
        ConstraintKind::Equals { variable, .. } => into.push(variable.clone()),
        ConstraintKind::Not(inner) => names(inner, into),
        ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
            for part in parts {
                names(part, into);
            }
        }
        _ => {}
    }
}
