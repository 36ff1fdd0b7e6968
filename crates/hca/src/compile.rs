//! From a control program to its automaton (SPEC 8.2). Linear in the size of the expanded program.

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::Rational;
use rmpl::control::{
    Alternative, Constraint, ConstraintKind, ControlFile, Duration, Expression, ExpressionKind, Guard, Held,
    Name, ParsedControl, expand_main, nearest,
};
use rmpl::diagnostics::bounds;
use rmpl::{Code, Diagnostic, Span};
use smol_str::{SmolStr, format_smolstr};

use crate::automaton::{
    Assertion, Automaton, Choice, ChosenBy, Composite, CompositeId, CompositeKind, Element, Location,
    LocationId, LocationKind, Start, Test, TestId, Transition,
};
use crate::clock::{Clock, ClockId, ClockKind, HeldCondition};
use crate::condition::{Condition, Formula};
use crate::equality::write_out;
use crate::locks::{Lock, LockId, can_hold_together};
use crate::vocabulary::{Variable, VariableId, Vocabulary};

/// What compiling a text gives.
#[derive(Clone, Debug)]
pub struct Compilation {
    /// The text read.
    pub parsed: ParsedControl,
    /// The automaton of its main definition; `None` when there are errors.
    pub automaton: Option<Arc<Automaton>>,
    /// All that is wrong, in textual order.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads and compiles a text.
///
/// ```
/// let text = "(SEQUENCE (Engine = Standby) (Engine = Firing))";
/// let automaton = hca::compile_text(text, &hca::Vocabulary::default()).automaton.expect("no errors");
/// let estimates = ["Off", "Standby", "Firing"].map(|mode| automaton.estimate([("Engine", mode)]));
/// let run = hca::trace(&automaton, &estimates);
/// // The first estimate does not make the first constraint hold, so its location stays marked.
/// let marked: Vec<String> = run.steps.iter().map(|step| step.labels.join(", ")).collect();
/// assert_eq!(marked, ["assert Engine=Standby", "assert Engine=Standby", "assert Engine=Firing", ""]);
/// assert!(run.terminated);
/// ```
pub fn compile_text(text: &str, vocabulary: &Vocabulary) -> Compilation {
    let parsed = rmpl::control::parse(text);
    let mut diagnostics = parsed.diagnostics.clone();
    let mut automaton = None;
    if !parsed.has_errors() {
        let (compiled, found) = compile(&parsed.file, vocabulary);
        automaton = compiled;
        diagnostics.extend(found);
        diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    }
    Compilation { parsed, automaton, diagnostics }
}

/// Compiles the main definition of a file that parsed without errors.
pub fn compile(file: &ControlFile, vocabulary: &Vocabulary) -> (Option<Arc<Automaton>>, Vec<Diagnostic>) {
    let (expanded, mut diagnostics) = expand_main(file);
    let Some(mut program) = expanded else { return (None, diagnostics) };
    diagnostics.extend(write_out(&mut program, vocabulary));
    if !diagnostics.is_empty() {
        return (None, diagnostics);
    }
    let mut compiler = Compiler::new(vocabulary, file.step_secs(), diagnostics);
    compiler.collect(&program);
    let root = compiler.open(CompositeKind::Program, None, None, program.span);
    let element = compiler.expression(&program, root);
    compiler.close(root, vec![element], &[element]);
    let Compiler { mut automaton, transitions, diagnostics, .. } = compiler;
    for (at, transitions) in transitions.into_iter().enumerate() {
        let start = automaton.transitions.len() as u32;
        automaton.transitions.extend(transitions);
        if let Some(location) = automaton.locations.get_mut(at) {
            location.transitions = start..automaton.transitions.len() as u32;
        }
    }
    automaton.watched_by = watched_by(&automaton.composites);
    (diagnostics.is_empty().then(|| Arc::new(automaton)), diagnostics)
}

fn watched_by(composites: &[Composite]) -> Vec<Vec<CompositeId>> {
    let mut found: Vec<Vec<CompositeId>> = Vec::with_capacity(composites.len());
    for composite in composites {
        let mut outer = Vec::new();
        if let Some(parent) = composite.parent {
            outer.extend(found.get(parent.0 as usize).into_iter().flatten().copied());
            let drops = |outer: &Composite| outer.maintenance.is_some() || outer.kind == CompositeKind::Lock;
            if composites.get(parent.0 as usize).is_some_and(drops) {
                outer.push(parent);
            }
        }
        found.push(outer);
    }
    found
}

struct Compiler<'vocabulary> {
    vocabulary: &'vocabulary Vocabulary,
    automaton: Automaton,
    /// Per location; flattened at the end.
    transitions: Vec<Vec<Transition>>,
    /// Tests already compiled, by the text of their guard.
    by_guard: BTreeMap<String, TestId>,
    /// How many seconds a step takes.
    step_secs: Rational,
    /// What the durations of the expression that is compiled are divided by.
    warp: Rational,
    enclosing: Enclosing,
    diagnostics: Vec<Diagnostic>,
}

/// What is around the expression that is compiled.
#[derive(Default)]
struct Enclosing {
    /// What locks around it lock.
    locked: Vec<Constraint>,
    /// How many forms around it may end it: TIMEOUT, WITHIN and DO-WATCHING.
    bounds: usize,
}

impl<'vocabulary> Compiler<'vocabulary> {
    fn new(vocabulary: &'vocabulary Vocabulary, step_secs: Rational, diagnostics: Vec<Diagnostic>) -> Self {
        let automaton = Automaton {
            variables: Vec::new(),
            by_name: BTreeMap::new(),
            tests: Vec::new(),
            locations: Vec::new(),
            composites: Vec::new(),
            transitions: Vec::new(),
            clocks: Vec::new(),
            held: Vec::new(),
            locks: Vec::new(),
            choices: Vec::new(),
            starts: Vec::new(),
            watched_by: Vec::new(),
        };
        Self {
            vocabulary,
            automaton,
            transitions: Vec::new(),
            by_guard: BTreeMap::new(),
            step_secs,
            warp: Rational::ONE,
            enclosing: Enclosing::default(),
            diagnostics,
        }
    }

    /// Finds all variables and values first, so that every value set is as wide as its domain.
    fn collect(&mut self, expression: &Expression) {
        let mut constraints: Vec<&Constraint> = Vec::new();
        constraints_of(expression, &mut constraints);
        for constraint in constraints {
            self.collect_constraint(constraint);
        }
    }

    fn collect_constraint(&mut self, constraint: &Constraint) {
        match &constraint.kind {
            ConstraintKind::Not(inner) => self.collect_constraint(inner),
            ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
                for part in parts {
                    self.collect_constraint(part);
                }
            }
            ConstraintKind::Equals { variable, value } => self.collect_equality(variable, value),
            _ => {}
        }
    }

    fn collect_equality(&mut self, name: &Name, value: &Name) {
        let Automaton { variables, by_name, .. } = &mut self.automaton;
        let VariableId(at) = *by_name.entry(name.text.clone()).or_insert_with(|| {
            let domain = self.vocabulary.domains.get(&name.text);
            variables.push(Variable {
                name: name.text.clone(),
                values: domain.cloned().unwrap_or_default(),
                closed: domain.is_some(),
                is_program_variable: self.vocabulary.program_variables.contains(&name.text),
            });
            VariableId(variables.len() as u32 - 1)
        });
        let Some(variable) = self.automaton.variables.get_mut(at as usize) else { return };
        if variable.values.contains(&value.text) {
            return;
        }
        if !variable.closed {
            variable.values.push(value.text.clone());
            return;
        }
        let message = format!("`{}` cannot be `{}`", name.text, value.text);
        let hint = nearest(&value.text, variable.values.iter().map(SmolStr::as_str)).map_or_else(
            || format!("use one of {}", variable.values.join(", ")),
            |known| format!("did you mean `{known}`?"),
        );
        if !self.diagnostics.iter().any(|known| known.span == value.span) {
            self.diagnostics.push(Diagnostic::error(Code("E-VALUE"), value.span, message).with_hint(hint));
        }
    }

    fn formula(&self, constraint: &Constraint) -> Formula {
        match &constraint.kind {
            ConstraintKind::True => Formula::Constant(true),
            ConstraintKind::Not(inner) => self.formula(inner).negated(),
            ConstraintKind::And(parts) => Formula::And(parts.iter().map(|part| self.formula(part)).collect()),
            ConstraintKind::Or(parts) => Formula::Or(parts.iter().map(|part| self.formula(part)).collect()),
            ConstraintKind::Equals { variable, value } => {
                let Some(VariableId(at)) = self.automaton.variable(&variable.text) else {
                    return Formula::Constant(false);
                };
                let Some(data) = self.automaton.variables.get(at as usize) else {
                    return Formula::Constant(false);
                };
                let number = data.values.iter().position(|known| *known == value.text);
                Formula::Member(at, (0..data.value_count() as usize).map(|at| Some(at) == number).collect())
            }
            ConstraintKind::False | ConstraintKind::Parameter(_) | ConstraintKind::Unreadable => {
                Formula::Constant(false)
            }
        }
    }

    fn test(&mut self, guard: &Guard) -> TestId {
        let key = guard.to_string();
        if let Some(known) = self.by_guard.get(&key) {
            return *known;
        }
        let held = guard.held.as_ref().map(|held| self.held(guard, held));
        let condition = Condition::new(self.formula(&guard.constraint));
        let id = TestId(self.automaton.tests.len() as u32);
        self.automaton.tests.push(Test { guard: guard.clone(), held, condition });
        self.by_guard.insert(key, id);
        id
    }

    /// Returns what has to have lasted for a guard with HELD, whose duration is that of its place.
    fn held(&mut self, guard: &Guard, held: &Held) -> u32 {
        let test = self.test(&Guard { non_entailed: false, held: None, ..guard.clone() });
        let steps = Duration::read(&held.duration.text).ok();
        let steps = steps.and_then(|duration| duration.steps(self.step_secs)).unwrap_or(u64::MAX);
        let condition = HeldCondition { test, non_entailed: held.non_entailed, steps };
        let known = self.automaton.held.iter().position(|known| *known == condition);
        known.unwrap_or_else(|| {
            self.automaton.held.push(condition);
            self.automaton.held.len() - 1
        }) as u32
    }

    /// A guard with its duration as it is where WARP has shortened it.
    fn warped(&mut self, guard: &Guard) -> Guard {
        let mut guard = guard.clone();
        if let Some(held) = &mut guard.held
            && let Some((duration, _)) = self.counted(&held.duration)
        {
            held.duration.text = duration.written();
        }
        guard
    }

    /// A duration, shortened by WARP, with its steps; `None` if they cannot be counted.
    fn counted(&mut self, written: &Name) -> Option<(Duration, u64)> {
        let duration = Duration::read(&written.text).ok().and_then(|given| given.shortened(self.warp));
        let counted = duration.and_then(|duration| Some((duration, duration.steps(self.step_secs)?)));
        if counted.is_none() && self.diagnostics.iter().all(|known| known.span != written.span) {
            self.diagnostics.push(bounds::too_long(written.span));
        }
        counted
    }

    /// Returns how a duration is called where WARP has shortened it, with its steps.
    fn duration(&mut self, written: &Name) -> (SmolStr, u64) {
        match self.counted(written) {
            Some((duration, steps)) => (format_smolstr!("{duration}"), steps),
            None => (written.text.clone(), u64::MAX),
        }
    }

    fn clock(&mut self, kind: ClockKind, label: SmolStr, steps: u64, owner: Element) -> ClockId {
        self.automaton.clocks.push(Clock { kind, label, steps, owner });
        ClockId(self.automaton.clocks.len() as u32 - 1)
    }

    fn location_clock(
        &mut self,
        location: LocationId,
        kind: ClockKind,
        label: SmolStr,
        steps: u64,
    ) -> ClockId {
        let clock = self.clock(kind, label, steps, Element::Location(location));
        if let Some(data) = self.automaton.locations.get_mut(location.0 as usize) {
            data.clock = Some(clock);
        }
        clock
    }

    fn start_of(&self, element: Element) -> Start {
        match element {
            Element::Location(location) => {
                let clock = self.automaton.location(location).and_then(|data| data.clock);
                let clocks = clock.into_iter().collect();
                Start { locations: vec![location], clocks, ..Start::default() }
            }
            Element::Composite(composite) => {
                self.automaton.starts.get(composite.0 as usize).cloned().unwrap_or_default()
            }
        }
    }

    fn opposite(&mut self, guard: &Guard) -> TestId {
        self.test(&Guard { non_entailed: !guard.non_entailed, ..guard.clone() })
    }

    fn open(
        &mut self,
        kind: CompositeKind,
        parent: Option<CompositeId>,
        maintenance: Option<TestId>,
        span: Span,
    ) -> CompositeId {
        let id = CompositeId(self.automaton.composites.len() as u32);
        let first = self.automaton.locations.len() as u32;
        self.automaton.composites.push(Composite {
            kind,
            parent,
            children: Vec::new(),
            start: Vec::new(),
            clock: None,
            maintenance,
            locations: first..first,
            span,
        });
        self.automaton.starts.push(Start::default());
        id
    }

    fn close(&mut self, id: CompositeId, children: Vec<Element>, started: &[Element]) -> Element {
        let start: Vec<LocationId> =
            started.iter().flat_map(|element| self.automaton.start_of(element).to_vec()).collect();
        let end = self.automaton.locations.len() as u32;
        let mut begun = Start::default();
        for element in started {
            begun.extend(&self.start_of(*element));
        }
        if let Some(known) = self.automaton.starts.get_mut(id.0 as usize) {
            *known = begun;
        }
        if let Some(composite) = self.automaton.composites.get_mut(id.0 as usize) {
            composite.children = children;
            composite.start = start;
            composite.locations.end = end;
        }
        Element::Composite(id)
    }

    fn location(
        &mut self,
        kind: LocationKind,
        label: SmolStr,
        parent: CompositeId,
        span: Span,
    ) -> LocationId {
        let id = LocationId(self.automaton.locations.len() as u32);
        self.automaton.locations.push(Location {
            kind,
            label,
            assertion: None,
            clock: None,
            reward: None,
            transitions: 0..0,
            parent,
            span,
        });
        self.transitions.push(Vec::new());
        id
    }

    fn transition(&mut self, source: LocationId, guard: Option<TestId>, target: Element) {
        if let Some(transitions) = self.transitions.get_mut(source.0 as usize) {
            transitions.push(Transition { source, guard, target });
        }
    }

    fn expression(&mut self, expression: &Expression, parent: CompositeId) -> Element {
        let span = expression.span;
        match &expression.kind {
            ExpressionKind::Assert(constraint) => Element::Location(self.assertion(constraint, parent, span)),
            ExpressionKind::Parallel(parts) => {
                let id = self.open(CompositeKind::Parallel, Some(parent), None, span);
                let children: Vec<Element> = parts.iter().map(|part| self.expression(part, id)).collect();
                self.close(id, children.clone(), &children)
            }
            ExpressionKind::Sequence(parts) => {
                let id = self.open(CompositeKind::Sequence, Some(parent), None, span);
                let children: Vec<Element> = parts.iter().map(|part| self.expression(part, id)).collect();
                let first: Vec<Element> = children.iter().take(1).copied().collect();
                self.close(id, children, &first)
            }
            ExpressionKind::DoWatching { guard, body } => {
                let guard = self.warped(guard);
                let maintenance = self.opposite(&guard);
                let id = self.open(CompositeKind::DoWatching, Some(parent), Some(maintenance), span);
                self.enclosing.bounds += 1;
                let child = self.expression(body, id);
                self.enclosing.bounds -= 1;
                self.close(id, vec![child], &[child])
            }
            ExpressionKind::Always(body) => {
                let id = self.open(CompositeKind::Guarded, Some(parent), None, span);
                let location = self.location(LocationKind::Always, SmolStr::new_static("always"), id, span);
                let own = Element::Location(location);
                let body = self.expression(body, id);
                self.transition(location, None, own);
                self.transition(location, None, body);
                self.close(id, vec![own, body], &[own, body])
            }
            ExpressionKind::IfThenNext { guard, then, otherwise } => {
                self.guarded(LocationKind::If, guard, then, otherwise.as_deref(), parent, span)
            }
            ExpressionKind::UnlessThenNext { guard, body } => {
                self.guarded(LocationKind::Unless, guard, body, None, parent, span)
            }
            ExpressionKind::WhenDoNext { guard, body } => {
                self.guarded(LocationKind::When, guard, body, None, parent, span)
            }
            ExpressionKind::WheneverDoNext { guard, body } => {
                self.guarded(LocationKind::Whenever, guard, body, None, parent, span)
            }
            ExpressionKind::Wait(duration) => {
                let (text, steps) = self.duration(duration);
                let location =
                    self.location(LocationKind::Wait, format_smolstr!("wait {text}"), parent, span);
                self.location_clock(location, ClockKind::Wait, format_smolstr!("WAIT {text}"), steps);
                Element::Location(location)
            }
            ExpressionKind::Timeout { duration, body, otherwise } => {
                let (text, steps) = self.duration(duration);
                let label = format_smolstr!("TIMEOUT {text}");
                self.timeout(label, steps, (body, None), otherwise.as_deref(), parent, span)
            }
            ExpressionKind::Within { least, most, body, otherwise } => {
                self.within((least, most), body, otherwise.as_deref(), parent, span)
            }
            ExpressionKind::At { time, body } => self.at(time, body, parent, span),
            ExpressionKind::Every { period, body } => self.every(period, body, parent, span),
            ExpressionKind::Warp { factor, body } => {
                let before = self.warp;
                let factor_value: Option<Rational> = factor.text.parse().ok();
                match factor_value.and_then(|factor| before.checked_mul(factor)) {
                    Some(product) => self.warp = product,
                    None => self.diagnostics.push(bounds::too_long(factor.span)),
                }
                let element = self.expression(body, parent);
                self.warp = before;
                element
            }
            ExpressionKind::Lock { constraint, body } => self.lock(constraint, body, parent, span),
            ExpressionKind::ChooseProb(alternatives) => {
                let given: Vec<&str> = weights_of(alternatives).collect();
                let weights = rmpl::control::probability_weights(&given);
                let weights = weights.map_or(Vec::new(), |(weights, _)| weights);
                self.choice(alternatives, ChosenBy::Chance(weights), parent, span)
            }
            ExpressionKind::ChooseReward(alternatives) => {
                let rewards = weights_of(alternatives).map(|reward| reward.parse().unwrap_or(Rational::ZERO));
                self.choice(alternatives, ChosenBy::Reward(rewards.collect()), parent, span)
            }
            ExpressionKind::Reward(reward) => {
                let label = format_smolstr!("reward {}", reward.text);
                let location = self.location(LocationKind::Reward, label, parent, span);
                if let Some(data) = self.automaton.locations.get_mut(location.0 as usize) {
                    data.reward = reward.text.parse().ok();
                }
                Element::Location(location)
            }
            // Neither is left in an expanded program without errors; doing nothing is the safe reading.
            ExpressionKind::Call { .. } | ExpressionKind::Unreadable => {
                let constraint = Constraint { kind: ConstraintKind::True, span };
                Element::Location(self.assertion(&constraint, parent, span))
            }
        }
    }

    /// `(TIMEOUT d e f)`; with a least duration, `e` and that run in parallel.
    fn timeout(
        &mut self,
        label: SmolStr,
        steps: u64,
        (body, least): (&Expression, Option<&Name>),
        otherwise: Option<&Expression>,
        parent: CompositeId,
        span: Span,
    ) -> Element {
        let id = self.open(CompositeKind::Timeout, Some(parent), None, span);
        let clock = self.clock(ClockKind::Timeout, label, steps, Element::Composite(id));
        if let Some(data) = self.automaton.composites.get_mut(id.0 as usize) {
            data.clock = Some(clock);
        }
        self.enclosing.bounds += 1;
        let first = match least {
            None => self.expression(body, id),
            Some(least) => {
                let both = self.open(CompositeKind::Parallel, Some(id), None, span);
                let body = self.expression(body, both);
                let wait = Expression { kind: ExpressionKind::Wait(least.clone()), span: least.span };
                let wait = self.expression(&wait, both);
                self.close(both, vec![body, wait], &[body, wait])
            }
        };
        self.enclosing.bounds -= 1;
        let otherwise = otherwise.map(|otherwise| self.expression(otherwise, id));
        let element = self.close(id, std::iter::once(first).chain(otherwise).collect(), &[first]);
        if let Some(start) = self.automaton.starts.get_mut(id.0 as usize) {
            start.clocks.push(clock);
        }
        element
    }

    fn lock(
        &mut self,
        constraint: &Constraint,
        body: &Expression,
        parent: CompositeId,
        span: Span,
    ) -> Element {
        let contradicts = |outer: &&Constraint| {
            !can_hold_together(&[(&self.automaton, *outer), (&self.automaton, constraint)])
        };
        if let Some(outer) = self.enclosing.locked.iter().find(contradicts) {
            let message =
                format!("this lock can never be granted: it contradicts {outer}, which is locked around it");
            self.diagnostics.push(
                Diagnostic::error(Code("E-CONSTRAINT"), constraint.span, message)
                    .with_hint("move it out of the other lock, or lock something else"),
            );
        }
        let id = self.open(CompositeKind::Lock, Some(parent), None, span);
        let waiting = self.location(LocationKind::Lock, format_smolstr!("lock {constraint}"), id, span);
        let assertion = self.assertion(constraint, id, constraint.span);
        let test = self.test(&Guard {
            non_entailed: false,
            held: None,
            constraint: constraint.clone(),
            span: constraint.span,
        });
        let own = Element::Location(waiting);
        let number = self.automaton.locks.len();
        self.automaton.locks.push(Lock {
            composite: id,
            label: format_smolstr!("LOCK {constraint}"),
            test,
            waiting,
            assertion,
            body: own,
            is_bounded: self.enclosing.bounds > 0,
        });
        self.enclosing.locked.push(constraint.clone());
        let body = self.expression(body, id);
        self.enclosing.locked.pop();
        if let Some(lock) = self.automaton.locks.get_mut(number) {
            lock.body = body;
        }
        let element = self.close(id, vec![own, Element::Location(assertion), body], &[own]);
        if let Some(start) = self.automaton.starts.get_mut(id.0 as usize) {
            *start = Start { locks: vec![LockId(number as u32)], ..Start::default() };
        }
        element
    }

    fn choice(
        &mut self,
        alternatives: &[Alternative],
        by: ChosenBy,
        parent: CompositeId,
        span: Span,
    ) -> Element {
        let id = self.open(CompositeKind::Choice, Some(parent), None, span);
        let children: Vec<Element> =
            alternatives.iter().map(|alternative| self.expression(&alternative.body, id)).collect();
        let element = self.close(id, children.clone(), &children);
        if let Some(start) = self.automaton.starts.get_mut(id.0 as usize) {
            *start = Start { choices: vec![id], ..Start::default() };
        }
        self.automaton.choices.push(Choice { composite: id, by });
        element
    }

    fn within(
        &mut self,
        (least, most): (&Name, &Name),
        body: &Expression,
        otherwise: Option<&Expression>,
        parent: CompositeId,
        span: Span,
    ) -> Element {
        let steps = |written: &Name| Duration::read(&written.text).ok()?.in_steps(self.step_secs);
        if let (Some(lower), Some(upper)) = (steps(least), steps(most))
            && lower > upper
        {
            self.diagnostics.push(bounds::within(&least.text, &most.text, least.span.cover(most.span)));
        }
        let (lower, _) = self.duration(least);
        let (upper, steps) = self.duration(most);
        let label = format_smolstr!("WITHIN {lower} to {upper}");
        self.timeout(label, steps, (body, Some(least)), otherwise, parent, span)
    }

    fn at(&mut self, time: &Name, body: &Expression, parent: CompositeId, span: Span) -> Element {
        let (text, steps) = self.duration(time);
        let id = self.open(CompositeKind::Guarded, Some(parent), None, span);
        let location = self.location(LocationKind::At, format_smolstr!("at {text}"), id, span);
        self.location_clock(location, ClockKind::At, format_smolstr!("AT {text}"), steps);
        let own = Element::Location(location);
        let body = self.expression(body, id);
        self.transition(location, None, body);
        let element = self.close(id, vec![own, body], &[own]);
        if let Some(start) = self.automaton.starts.get_mut(id.0 as usize) {
            *start = Start { timed: vec![id], ..Start::default() };
        }
        element
    }

    fn every(&mut self, period: &Name, body: &Expression, parent: CompositeId, span: Span) -> Element {
        let (text, steps) = self.duration(period);
        let id = self.open(CompositeKind::Guarded, Some(parent), None, span);
        let location = self.location(LocationKind::Every, format_smolstr!("every {text}"), id, span);
        self.location_clock(location, ClockKind::Every, format_smolstr!("EVERY {text}"), steps);
        let own = Element::Location(location);
        let body = self.expression(body, id);
        self.transition(location, None, own);
        self.transition(location, None, body);
        self.close(id, vec![own, body], &[own, body])
    }

    fn guarded(
        &mut self,
        kind: LocationKind,
        guard: &Guard,
        body: &Expression,
        otherwise: Option<&Expression>,
        parent: CompositeId,
        span: Span,
    ) -> Element {
        let guard = &self.warped(guard);
        let id = self.open(CompositeKind::Guarded, Some(parent), None, span);
        let word = match kind {
            LocationKind::If => "if",
            LocationKind::Unless => "unless",
            LocationKind::Whenever => "whenever",
            _ => "when",
        };
        let location = self.location(kind, format_smolstr!("{word} {guard}"), id, span);
        let own = Element::Location(location);
        let mut children = vec![own];
        let body = self.expression(body, id);
        children.push(body);
        let holds = self.test(guard);
        let fails = self.opposite(guard);
        match kind {
            LocationKind::Unless => self.transition(location, Some(fails), body),
            _ => self.transition(location, Some(holds), body),
        }
        match kind {
            LocationKind::When => self.transition(location, Some(fails), own),
            LocationKind::Whenever => self.transition(location, None, own),
            _ => {}
        }
        if let Some(otherwise) = otherwise {
            let otherwise = self.expression(otherwise, id);
            children.push(otherwise);
            self.transition(location, Some(fails), otherwise);
        }
        self.close(id, children, &[own])
    }

    fn assertion(&mut self, constraint: &Constraint, parent: CompositeId, span: Span) -> LocationId {
        let location =
            self.location(LocationKind::Assert, format_smolstr!("assert {constraint}"), parent, span);
        let test =
            self.test(&Guard { non_entailed: false, held: None, constraint: constraint.clone(), span });
        let mut goals = Vec::new();
        let mut settings = Vec::new();
        self.goals(constraint, &mut goals, &mut settings);
        if let Some(data) = self.automaton.locations.get_mut(location.0 as usize) {
            data.assertion = Some(Assertion { test, goals, program_settings: settings });
        }
        location
    }

    fn goals(
        &self,
        constraint: &Constraint,
        goals: &mut Vec<SmolStr>,
        settings: &mut Vec<(VariableId, u32)>,
    ) {
        match &constraint.kind {
            ConstraintKind::True => {}
            ConstraintKind::And(parts) => parts.iter().for_each(|part| self.goals(part, goals, settings)),
            ConstraintKind::Equals { variable, value } => {
                goals.push(format_smolstr!("{constraint}"));
                let Some(id) = self.automaton.variable(&variable.text) else { return };
                let data =
                    self.automaton.variables.get(id.0 as usize).filter(|data| data.is_program_variable);
                if let Some(number) = data.and_then(|data| data.value_number(&value.text)) {
                    settings.push((id, number));
                }
            }
            _ => goals.push(format_smolstr!("{constraint}")),
        }
    }
}

/// The probabilities or rewards of alternatives.
fn weights_of(alternatives: &[Alternative]) -> impl Iterator<Item = &str> {
    alternatives.iter().map(|alternative| alternative.weight.text.as_str())
}

fn constraints_of<'tree>(expression: &'tree Expression, into: &mut Vec<&'tree Constraint>) {
    let guarded = expression.guard().map(|guard| &guard.constraint);
    into.extend(guarded.into_iter().chain(expression.asserted()));
    for part in expression.parts() {
        constraints_of(part, into);
    }
}
