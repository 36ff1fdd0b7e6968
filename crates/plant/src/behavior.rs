//! Classes that behave like a program: `(BEHAVIOR e)` is written out as modes, transitions and outcomes, and the class is
//! then compiled like one that was written by hand (SPEC 2.2).
//!
//! A mode is a marking of the program, with the time left of its clocks and how long its HELD conditions have lasted. The
//! automaton tells which conditions a step depends on; each combination of answers that values can give leads to a mode.

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::Rational;
use hca::{Automaton, ChosenBy, Position, Stepper, TestId, Unobserved, Vocabulary};
use rmpl::Span;
use rmpl::control::{
    Class, Constraint, ConstraintKind, ControlFile, Definition, Expression, ExpressionKind, Field, FieldKind,
    Initial, MergedClass, Name,
};
use rmpl::diagnostics::size;
use rmpl::{Code, Diagnostic};
use smol_str::{SmolStr, SmolStrBuilder, ToSmolStr as _, format_smolstr};

use crate::assignment::{Found, satisfying};
use crate::formula::Formula;
use crate::value_set::ValueSet;

const MAX_MODES: usize = ValueSet::MOST;
const MAX_TRANSITIONS: usize = 65_536;
/// So many combinations of answers are followed, in all steps of a class.
const MAX_ANSWERS: usize = 4 * MAX_TRANSITIONS;

/// The file with each BEHAVIOR replaced by the modes and transitions that it means, and what is wrong with them.
///
/// `None` where no class has one.
pub(crate) fn written_out(
    file: &ControlFile,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
) -> Option<(ControlFile, Vec<Diagnostic>)> {
    let behaves = |class: &Class| class.fields.iter().any(|it| matches!(it.kind, FieldKind::Behavior(_)));
    if !file.classes.iter().any(behaves) {
        return None;
    }
    let mut diagnostics = mixed(file, classes);
    let mut written = file.clone();
    for (at, class) in file.classes.iter().enumerate() {
        for field in &class.fields {
            let FieldKind::Behavior(body) = &field.kind else { continue };
            match modes_of(file, classes, class, body, field.span) {
                Ok(behavior) => {
                    let fields = &mut written.classes[at].fields;
                    fields.retain(|it| !matches!(it.kind, FieldKind::Behavior(_)));
                    fields.extend(behavior.fields);
                    begin(&mut written, classes, &class.name.text, &behavior.start);
                }
                Err(found) => diagnostics.extend(found),
            }
        }
    }
    Some((written, diagnostics))
}

/// Classes that have a BEHAVIOR and modes or arcs beside it, own or inherited.
fn mixed(file: &ControlFile, classes: &BTreeMap<SmolStr, MergedClass<'_>>) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = Vec::new();
    for merged in file.classes.iter().filter_map(|class| classes.get(&class.name.text)) {
        let lineage =
            merged.lineage.iter().filter_map(|name| file.classes.iter().find(|it| it.name.text == *name));
        let says_modes = |field: &&Field| {
            matches!(
                field.kind,
                FieldKind::Mode { .. }
                    | FieldKind::Transition { .. }
                    | FieldKind::Fault { .. }
                    | FieldKind::Behavior(_)
            )
        };
        let fields: Vec<&Field> = lineage.flat_map(|class| &class.fields).filter(says_modes).collect();
        let behaves = fields.iter().any(|field| matches!(field.kind, FieldKind::Behavior(_)));
        if let [first, _, ..] = fields[..]
            && behaves
            && !found.iter().any(|known| known.span == first.span)
        {
            let message =
                "a class with a BEHAVIOR cannot have or inherit a MODE, TRANSITION, FAULT or other BEHAVIOR";
            let hint = "keep the BEHAVIOR, or write the modes by hand";
            found.push(Diagnostic::error(Code("E-FORM"), first.span, message).with_hint(hint));
        }
    }
    found
}

/// Gives components without INIT the start of the behavior, where that is random.
fn begin(
    file: &mut ControlFile,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    class: &SmolStr,
    start: &[(Name, Name)],
) {
    if start.len() < 2 {
        return;
    }
    let is_one = |name: &Name| classes.get(&name.text).is_some_and(|merged| merged.lineage.contains(class));
    let set = |name: &Name, initial: &mut Initial| {
        if *initial == Initial::FirstMode && is_one(name) {
            *initial = Initial::Prior(start.to_vec());
        }
    };
    for instance in &mut file.instances {
        set(&instance.class, &mut instance.initial);
    }
    for field in file.classes.iter_mut().flat_map(|class| &mut class.fields) {
        if let FieldKind::Part { class, initial, .. } = &mut field.kind {
            set(class, initial);
        }
    }
}

/// What a behavior means.
struct Behavior {
    fields: Vec<Field>,
    /// The modes in which it may start, with their probabilities.
    start: Vec<(Name, Name)>,
}

fn modes_of(
    file: &ControlFile,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    class: &Class,
    body: &Expression,
    span: Span,
) -> Result<Behavior, Vec<Diagnostic>> {
    let name = Name { text: SmolStr::new_static("(behavior)"), span: class.name.span };
    let mut definitions = file.definitions.clone();
    definitions.push(Definition { name, parameters: Vec::new(), body: body.clone(), span });
    let program = ControlFile {
        definitions,
        steps: file.steps.clone(),
        mission_step_secs: file.mission_step_secs,
        ..ControlFile::default()
    };
    let (expanded, found) = rmpl::control::expand_main(&program);
    let Some(expanded) = expanded else { return Err(found) };
    let mut refused = Vec::new();
    refuse(&expanded, &mut refused);
    if !refused.is_empty() {
        return Err(refused);
    }
    let (automaton, found) = hca::compile(&program, &Vocabulary::default());
    let Some(automaton) = automaton.filter(|_| found.is_empty()) else { return Err(found) };
    let stepper = Stepper::undecided(&automaton);
    let values = Values::of(&automaton, classes.get(&class.name.text), classes);
    let exploration = Exploration {
        automaton,
        values,
        span,
        places: Vec::new(),
        known: BTreeMap::new(),
        fields: Vec::new(),
        transitions: 0,
        answers: 0,
    };
    exploration.run(stepper).map_err(|diagnostic| vec![diagnostic])
}

/// Adds an error for each form that a plant cannot run.
fn refuse(expression: &Expression, into: &mut Vec<Diagnostic>) {
    let form = match &expression.kind {
        ExpressionKind::Lock { .. } => Some("LOCK"),
        ExpressionKind::Reward(_) => Some("REWARD"),
        ExpressionKind::ChooseReward(_) => Some("CHOOSE-REWARD"),
        _ => None,
    };
    if let Some(form) = form {
        let message = format!("a BEHAVIOR cannot contain {form}");
        into.push(Diagnostic::error(Code("E-FORM"), expression.span, message));
    }
    for part in expression.parts() {
        refuse(part, into);
    }
}

/// Which answers to conditions values can give.
struct Values {
    /// By name, the number of the variable and its values.
    variables: BTreeMap<SmolStr, (u32, Vec<SmolStr>)>,
    full: Vec<ValueSet>,
}

impl Values {
    /// Of all names in the conditions of an automaton; what the class does not know may have other values, too.
    fn of(
        automaton: &Automaton,
        class: Option<&MergedClass<'_>>,
        classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    ) -> Self {
        let mut values = Self { variables: BTreeMap::new(), full: Vec::new() };
        for variable in &automaton.variables {
            let domain = class.and_then(|class| domain_of(class, classes, &variable.name));
            let count = domain.as_ref().map_or(variable.values.len() + 1, Vec::len);
            let domain = domain.unwrap_or_else(|| variable.values.clone());
            values.variables.insert(variable.name.clone(), (values.full.len() as u32, domain));
            values.full.push(ValueSet::first_values(count));
        }
        values
    }

    fn formula(&self, constraint: &Constraint, wanted: bool) -> Formula {
        Formula::of(constraint, wanted, &|variable, value, wanted| self.equality(variable, value, wanted))
    }

    fn equality(&self, variable: &str, value: &str, wanted: bool) -> Formula {
        let Some((symbol, values)) = self.variables.get(variable) else {
            return Formula::Constant(!wanted);
        };
        let full = self.full.get(*symbol as usize).copied().unwrap_or_default();
        match values.iter().position(|known| known == value) {
            Some(at) => {
                let set = ValueSet::one(at.min(ValueSet::MOST - 1) as u8);
                Formula::Member { symbol: *symbol, set: if wanted { set } else { full & !set } }
            }
            // For two variables, and for errors that are reported later, both answers are possible.
            None => Formula::Constant(true),
        }
    }
}

/// The values of a name in a class; `None` for what it does not know, and for modes that are not known yet.
fn domain_of(
    class: &MergedClass<'_>,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    name: &str,
) -> Option<Vec<SmolStr>> {
    let field = |class: &MergedClass<'_>, name: &str| {
        let all = class.variables.iter().chain(&class.commands);
        all.into_iter().find(|known| known.name.text == name).map(|known| known.values.clone())
    };
    field(class, name).or_else(|| {
        let (path, name) = name.rsplit_once('.')?;
        field(class.reached(classes, path)?, name)
    })
}

/// A mode that the exploration has reached.
struct Place {
    name: SmolStr,
    stepper: Stepper,
    /// What it asserts, in the text's order.
    asserted: Vec<Constraint>,
}

/// Where a step leads: modes with their probabilities.
type Outcomes = Vec<(Rational, usize)>;

struct Exploration {
    automaton: Arc<Automaton>,
    values: Values,
    /// Where the behavior is written.
    span: Span,
    places: Vec<Place>,
    known: BTreeMap<Position, usize>,
    fields: Vec<Field>,
    transitions: usize,
    /// How many combinations of answers have been followed.
    answers: usize,
}

impl Exploration {
    fn run(mut self, stepper: Stepper) -> Result<Behavior, Diagnostic> {
        let start = self.settled(stepper)?;
        let mut at = 0;
        while at < self.places.len() {
            self.leave(at)?;
            at += 1;
        }
        let modes = self.places.iter().map(|place| {
            let constraint = self.joined(place.asserted.clone());
            FieldKind::Mode { name: self.name(place.name.clone()), constraint }
        });
        let modes: Vec<FieldKind> = modes.collect();
        let mut fields: Vec<Field> = modes.into_iter().map(|kind| Field { kind, span: self.span }).collect();
        fields.append(&mut self.fields);
        let start = start.iter().map(|(probability, place)| {
            (self.name(self.places[*place].name.clone()), self.name(probability.to_smolstr()))
        });
        Ok(Behavior { start: start.collect(), fields })
    }

    fn name(&self, text: SmolStr) -> Name {
        Name { text, span: self.span }
    }

    fn joined(&self, mut parts: Vec<Constraint>) -> Constraint {
        match parts.len() {
            0 => Constraint { kind: ConstraintKind::True, span: self.span },
            1 => parts.swap_remove(0),
            _ => Constraint { kind: ConstraintKind::And(parts), span: self.span },
        }
    }

    /// The modes of a stepper after its open choices, with their probabilities.
    fn settled(&mut self, stepper: Stepper) -> Result<Outcomes, Diagnostic> {
        let mut outcomes: Outcomes = Vec::new();
        let mut waiting = vec![(Rational::ONE, stepper)];
        while let Some((probability, stepper)) = waiting.pop() {
            let Some(choice) = stepper.open_choice() else {
                let place = self.place(stepper)?;
                match outcomes.iter_mut().find(|(_, known)| *known == place) {
                    Some((known, _)) => {
                        *known = known.checked_add(probability).ok_or_else(|| size::digits(self.span))?;
                    }
                    None => outcomes.push((probability, place)),
                }
                continue;
            };
            // Of CHOOSE-REWARD there is none in a behavior.
            let ChosenBy::Chance(weights) = choice.by.clone() else { continue };
            let total = weights.iter().map(|weight| i128::from(*weight)).sum();
            // The first alternative is looked at first.
            for (alternative, weight) in weights.iter().enumerate().rev() {
                let part = Rational::from_wide(i128::from(*weight), total);
                let part = part.and_then(|part| part.checked_mul(probability));
                let mut chosen = stepper.clone();
                chosen.choose(alternative);
                waiting.push((part.ok_or_else(|| size::digits(self.span))?, chosen));
            }
        }
        Ok(outcomes)
    }

    /// The number of a stepper's mode.
    fn place(&mut self, stepper: Stepper) -> Result<usize, Diagnostic> {
        let position = stepper.position();
        if let Some(known) = self.known.get(&position) {
            return Ok(*known);
        }
        if self.places.len() == MAX_MODES {
            return Err(size::modes(MAX_MODES, self.span));
        }
        let mut asserted: Vec<Constraint> = Vec::new();
        for location in stepper.marking().iter().filter_map(|id| self.automaton.location(id)) {
            let test = location.assertion.as_ref().and_then(|it| self.automaton.guard(it.test));
            let Some(constraint) = test.map(|guard| &guard.constraint) else { continue };
            let text = constraint.to_string();
            let is_known = |known: &Constraint| known.to_string() == text;
            if constraint.kind != ConstraintKind::True && !asserted.iter().any(is_known) {
                asserted.push(constraint.clone());
            }
        }
        asserted.sort_by_key(|constraint| constraint.span);
        let mut name = SmolStrBuilder::new();
        for (at, constraint) in asserted.iter().enumerate() {
            name.push_str(if at > 0 { "&" } else { "" });
            name.push_str(&constraint.to_smolstr());
        }
        let name = match (asserted.is_empty(), stepper.is_done()) {
            (false, _) => name.finish(),
            (true, true) => SmolStr::new_static("ended"),
            (true, false) => SmolStr::new_static("idle"),
        };
        let is_like = |place: &&Place| {
            place.name == name || place.name.strip_prefix(name.as_str()).is_some_and(|it| it.starts_with('#'))
        };
        let equal = self.places.iter().filter(is_like).count();
        let name = if equal > 0 { format_smolstr!("{name}#{}", equal + 1) } else { name };
        let number = self.places.len();
        self.known.insert(position, number);
        self.places.push(Place { name, stepper, asserted });
        Ok(number)
    }

    /// Adds the transitions that leave a mode.
    fn leave(&mut self, at: usize) -> Result<(), Diagnostic> {
        let place = &self.places[at];
        if place.stepper.is_done() {
            return Ok(());
        }
        // By its text, what a step depends on, in the text's order.
        let mut asked: Vec<(TestId, Constraint)> = Vec::new();
        for test in place.stepper.asked() {
            let Some(guard) = self.automaton.guard(test) else { continue };
            let text = guard.constraint.to_string();
            let is_constant = matches!(guard.constraint.kind, ConstraintKind::True | ConstraintKind::False);
            let is_known = asked.iter().map(|(_, known)| known).chain(&place.asserted);
            if !is_constant && !is_known.into_iter().any(|known| known.to_string() == text) {
                asked.push((test, guard.constraint.clone()));
            }
        }
        asked.sort_by_key(|(_, constraint)| constraint.span);
        let asked: Vec<Constraint> = asked.into_iter().map(|(_, constraint)| constraint).collect();
        let mut held: Vec<Formula> =
            place.asserted.iter().map(|constraint| self.values.formula(constraint, true)).collect();
        let tree = self.tree(at, &asked, &mut Vec::new(), &mut held)?;
        let mut arcs = Vec::new();
        if let Some(tree) = &tree {
            tree.arcs(&mut Vec::new(), &mut arcs);
        }
        for (answers, outcomes) in arcs {
            self.add_arcs(at, &asked, &answers, outcomes)?;
        }
        Ok(())
    }

    fn add_arcs(
        &mut self,
        from: usize,
        asked: &[Constraint],
        answers: &[(usize, bool)],
        outcomes: &[(Rational, usize)],
    ) -> Result<(), Diagnostic> {
        let literal = |(at, answer): &(usize, bool)| {
            let constraint = asked.get(*at)?.clone();
            let span = constraint.span;
            Some(if *answer {
                constraint
            } else {
                Constraint { kind: ConstraintKind::Not(Box::new(constraint)), span }
            })
        };
        let guard = self.joined(answers.iter().filter_map(literal).collect());
        for (probability, to) in outcomes.iter().filter(|(_, to)| *to != from) {
            self.transitions += 1;
            if self.transitions > MAX_TRANSITIONS {
                return Err(size::transitions(MAX_TRANSITIONS, self.span));
            }
            let is_certain = *probability == Rational::ONE;
            let kind = FieldKind::Transition {
                from: Some(self.name(self.places[from].name.clone())),
                to: self.name(self.places[*to].name.clone()),
                guard: guard.clone(),
                probability: (!is_certain).then(|| self.name(probability.to_smolstr())),
            };
            self.fields.push(Field { kind, span: self.span });
        }
        Ok(())
    }

    /// Returns where a step leads by the answers to what it depends on; `None` where no values give these answers.
    fn tree(
        &mut self,
        at: usize,
        asked: &[Constraint],
        answers: &mut Vec<bool>,
        held: &mut Vec<Formula>,
    ) -> Result<Option<Tree>, Diagnostic> {
        if satisfying(&held.iter().collect::<Vec<_>>(), &mut self.values.full.clone()) == Found::Nothing {
            return Ok(None);
        }
        let Some(next) = asked.get(answers.len()) else {
            self.answers += 1;
            if self.answers > MAX_ANSWERS {
                return Err(size::answers(MAX_ANSWERS, self.span));
            }
            return Ok(Some(Tree::Leaf(self.stepped(at, asked, answers)?)));
        };
        let mut branches = Vec::with_capacity(2);
        for answer in [true, false] {
            held.push(self.values.formula(next, answer));
            answers.push(answer);
            branches.push(self.tree(at, asked, answers, held)?);
            answers.pop();
            held.pop();
        }
        let (no, yes) = (branches.pop().flatten(), branches.pop().flatten());
        Ok(match (yes, no) {
            (Some(yes), Some(no)) if yes == no => Some(yes),
            (Some(yes), Some(no)) => Some(Tree::Asks(answers.len(), Box::new(yes), Box::new(no))),
            (one, other) => one.or(other),
        })
    }

    fn stepped(&mut self, at: usize, asked: &[Constraint], answers: &[bool]) -> Result<Outcomes, Diagnostic> {
        let place = &self.places[at];
        let mut stepper = place.stepper.clone();
        let is_entailed = |test: TestId| {
            let Some(constraint) = self.automaton.guard(test).map(|guard| &guard.constraint) else {
                return false;
            };
            let text = constraint.to_string();
            if constraint.kind == ConstraintKind::True
                || place.asserted.iter().any(|known| known.to_string() == text)
            {
                return true;
            }
            let number = asked.iter().position(|known| known.to_string() == text);
            number.and_then(|number| answers.get(number)).is_some_and(|answer| *answer)
        };
        stepper.step_told(&is_entailed, &mut Unobserved);
        self.settled(stepper)
    }
}

/// Where a step leads, by answers.
#[derive(PartialEq)]
enum Tree {
    Leaf(Outcomes),
    /// The number of the condition, and what comes with and without it.
    Asks(usize, Box<Tree>, Box<Tree>),
}

impl Tree {
    /// The answers that lead to each leaf.
    fn arcs<'tree>(
        &'tree self,
        answers: &mut Vec<(usize, bool)>,
        into: &mut Vec<(Vec<(usize, bool)>, &'tree Outcomes)>,
    ) {
        match self {
            Self::Leaf(outcomes) => into.push((answers.clone(), outcomes)),
            Self::Asks(number, yes, no) => {
                for (answer, branch) in [(true, yes), (false, no)] {
                    answers.push((*number, answer));
                    branch.arcs(answers, into);
                    answers.pop();
                }
            }
        }
    }
}
