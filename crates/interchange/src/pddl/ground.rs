//! Every action with objects instead of parameters, if the action can ever happen and may help to reach the goal.

use std::collections::{BTreeMap, BTreeSet};

use exact::Rational;

use super::domain::{Application, Comparison, Effect, Expr, Formula, Metric, Schema, Task, Typed, When};
use super::error::PddlError;
use super::names::OBJECT;

/// How many times an object may replace a parameter.
const MAX_BINDINGS: usize = 2_000_000;

/// How many actions a mission may have.
pub(super) const MAX_ACTIONS: usize = 2_000;

/// An action with more parameters is refused: no author means it.
const MAX_PARAMETERS: usize = 100;
/// How many actions are tested for whether they can ever happen.
const MAX_CANDIDATES: usize = 50_000;

pub(super) type Atom = usize;
pub(super) type Fluent = usize;

/// Atoms and numbers by what they are applied to.
#[derive(Debug, Default)]
pub(super) struct Names {
    ids: BTreeMap<Application, usize>,
    pub(super) all: Vec<Application>,
}

impl Names {
    fn id(&mut self, application: Application) -> usize {
        let next = self.all.len();
        let id = *self.ids.entry(application.clone()).or_insert(next);
        if id == next {
            self.all.push(application);
        }
        id
    }
}

/// A limit of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Need {
    pub(super) fluent: Fluent,
    /// Whether the number is at least the limit; otherwise it is at most the limit.
    pub(super) is_least: bool,
    /// Whether the limit itself is excluded.
    pub(super) is_strict: bool,
    pub(super) limit: Rational,
}

/// Conditions that must all hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Conditions {
    pub(super) literals: BTreeMap<Atom, bool>,
    pub(super) needs: Vec<Need>,
    /// Atoms that the conditions name without depending on them, as in `(imply (static) (atom))`. PDDL keeps changes of these
    /// atoms apart from the action, too.
    pub(super) mentioned: BTreeSet<Atom>,
}

impl Conditions {
    /// Both conditions together; `None` if they contradict each other.
    fn and(mut self, other: Self) -> Option<Self> {
        for (atom, value) in other.literals {
            if *self.literals.entry(atom).or_insert(value) != value {
                return None;
            }
        }
        self.needs.extend(other.needs);
        self.mentioned.extend(other.mentioned);
        Some(self)
    }
}

/// The start or the end of an action.
#[derive(Clone, Debug, Default)]
pub(super) struct Snap {
    pub(super) conditions: Conditions,
    pub(super) sets: BTreeMap<Atom, bool>,
    pub(super) changes: BTreeMap<Fluent, Rational>,
}

/// An action on objects.
#[derive(Clone, Debug)]
pub(super) struct Action {
    /// Its name and its objects.
    pub(super) words: Vec<String>,
    /// The minimum and the maximum duration; `None` for an action that takes no time.
    pub(super) duration: Option<(Rational, Option<Rational>)>,
    pub(super) start: Snap,
    pub(super) throughout: Conditions,
    pub(super) end: Snap,
}

impl Action {
    pub(super) fn conditions(&self) -> [&Conditions; 3] {
        [&self.start.conditions, &self.throughout, &self.end.conditions]
    }

    pub(super) const fn snaps(&self) -> [&Snap; 2] {
        [&self.start, &self.end]
    }

    /// Returns whether the start sets atoms that have to hold throughout.
    pub(super) fn rests_on_start(&self) -> bool {
        self.throughout.literals.keys().any(|atom| self.start.sets.contains_key(atom))
    }
}

/// A linear expression of numbers that change.
#[derive(Clone, Debug, Default)]
pub(super) struct Linear {
    pub(super) constant: Rational,
    pub(super) factors: BTreeMap<Fluent, Rational>,
    /// The factor of the length of the plan.
    pub(super) of_time: Rational,
}

/// A task without parameters.
#[derive(Debug)]
pub(super) struct Ground {
    pub(super) atoms: Names,
    pub(super) fluents: Names,
    pub(super) initial: BTreeSet<Atom>,
    pub(super) values: BTreeMap<Fluent, Rational>,
    pub(super) actions: Vec<Action>,
    /// What becomes true or false at a time.
    pub(super) timed: Vec<(Rational, Atom, bool)>,
    pub(super) goal: Conditions,
    /// What to minimize.
    pub(super) metric: Option<Linear>,
}

/// The value of a formula with objects instead of parameters.
enum Truth {
    Yes,
    No,
    If(Conditions),
}

type Bindings<'task> = BTreeMap<&'task str, &'task str>;

struct Grounder<'task> {
    task: &'task Task,
    types: BTreeMap<&'task str, BTreeSet<&'task str>>,
    facts: BTreeSet<&'task [String]>,
    values: BTreeMap<&'task [String], Rational>,
    /// Predicates and functions that something changes.
    changing: BTreeSet<&'task str>,
    atoms: Names,
    fluents: Names,
    bindings: usize,
    /// The atoms that conditions have named since this set was last emptied.
    mentioned: BTreeSet<Atom>,
}

/// Replaces parameters by objects.
pub(super) fn ground(task: &Task) -> Result<Ground, PddlError> {
    let mut grounder = Grounder::new(task);
    grounder.check_initial()?;
    let mut actions = Vec::new();
    for schema in &task.schemas {
        grounder.instances(schema, &mut actions)?;
    }
    let goal = task.goal.as_ref().ok_or(PddlError::NoGoal)?;
    let goal = match grounder.truth(goal, &Bindings::new(), true, None, "the goal")? {
        Truth::Yes => Conditions::default(),
        Truth::No => return Err(PddlError::NeverTrue),
        Truth::If(conditions) => conditions,
    };
    let mut timed = Vec::new();
    for (time, application, value) in &task.timed {
        timed.push((*time, grounder.atoms.id(application.clone()), *value));
    }
    let metric = task.metric.as_ref().map(|metric| grounder.metric(metric)).transpose()?;
    let mut initial = BTreeSet::new();
    for fact in &task.facts {
        if grounder.changing.contains(fact[0].as_str()) {
            initial.insert(grounder.atoms.id(fact.clone()));
        }
    }
    let mut values = BTreeMap::new();
    for (fluent, value) in &task.values {
        if grounder.changing.contains(fluent[0].as_str()) {
            values.insert(grounder.fluents.id(fluent.clone()), *value);
        }
    }
    let Grounder { atoms, fluents, .. } = grounder;
    let mut ground = Ground { atoms, fluents, initial, values, actions, timed, goal, metric };
    ground.keep_reachable();
    ground.keep_relevant();
    if ground.actions.len() > MAX_ACTIONS {
        return Err(PddlError::TooMany { what: "actions on objects", most: MAX_ACTIONS });
    }
    Ok(ground)
}

impl<'task> Grounder<'task> {
    fn new(task: &'task Task) -> Self {
        let mut types: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (object, kinds) in &task.objects {
            let known = types.entry(object).or_default();
            let mut open: Vec<&str> = kinds.iter().map(String::as_str).collect();
            while let Some(kind) = open.pop() {
                if known.insert(kind) {
                    open.extend(task.parents.get(kind).into_iter().flatten().map(String::as_str));
                }
            }
            known.insert(OBJECT);
        }
        let mut changing = BTreeSet::new();
        for (_, effect) in task.schemas.iter().flat_map(|schema| &schema.effects) {
            changed(effect, &mut changing);
        }
        changing.extend(task.timed.iter().map(|(_, application, _)| application[0].as_str()));
        Self {
            task,
            types,
            facts: task.facts.iter().map(Vec::as_slice).collect(),
            values: task.values.iter().map(|(fluent, value)| (fluent.as_slice(), *value)).collect(),
            changing,
            atoms: Names::default(),
            fluents: Names::default(),
            bindings: 0,
            mentioned: BTreeSet::new(),
        }
    }

    /// Whether what is so at first is about objects.
    fn check_initial(&self) -> Result<(), PddlError> {
        let timed = self.task.timed.iter().map(|(_, application, _)| application);
        let values = self.task.values.iter().map(|(fluent, _)| fluent);
        let terms = self.task.facts.iter().chain(timed).chain(values).flat_map(|it| &it[1..]);
        for term in terms {
            self.object(term, &Bindings::new(), ":init")?;
        }
        Ok(())
    }

    /// The objects that may replace a parameter of these types.
    fn objects_of(&self, kinds: &[String]) -> Vec<&'task str> {
        let is_one = |object: &str| {
            let types = self.types.get(object);
            types.is_some_and(|types| kinds.iter().any(|kind| types.contains(kind.as_str())))
        };
        let objects = self.task.objects.iter().map(|(object, _)| object.as_str());
        let mut seen = BTreeSet::new();
        objects.filter(|object| is_one(object) && seen.insert(*object)).collect()
    }

    /// All actions of a schema whose conditions on what never changes hold.
    fn instances(&mut self, schema: &'task Schema, actions: &mut Vec<Action>) -> Result<(), PddlError> {
        if schema.parameters.len() > MAX_PARAMETERS {
            return Err(PddlError::TooMany { what: "parameters of an action", most: MAX_PARAMETERS });
        }
        let mut names = BTreeSet::new();
        if !schema.parameters.iter().all(|(name, _)| names.insert(name)) {
            let place = format!("{} in line {}", schema.name, schema.line);
            return Err(PddlError::Said { place, what: "a parameter of the same name as another one" });
        }
        let choices: Vec<Vec<&str>> =
            schema.parameters.iter().map(|(_, kinds)| self.objects_of(kinds)).collect();
        // A condition on what never changes is tested as soon as the last of its parameters has its object.
        let mut early: Vec<Vec<&Formula>> = vec![Vec::new(); schema.parameters.len()];
        for (_, formula) in &schema.conditions {
            for part in conjuncts(formula) {
                let Some(terms) = self.fixed_terms(part) else { continue };
                let last = schema.parameters.iter().rposition(|(name, _)| terms.contains(&name.as_str()));
                if let Some(last) = last {
                    early[last].push(part);
                }
            }
        }
        self.bind(schema, &choices, &early, &mut Vec::new(), actions)
    }

    fn bind(
        &mut self,
        schema: &'task Schema,
        choices: &[Vec<&'task str>],
        early: &[Vec<&'task Formula>],
        bound: &mut Vec<&'task str>,
        actions: &mut Vec<Action>,
    ) -> Result<(), PddlError> {
        let names = schema.parameters.iter().map(|(name, _)| name.as_str());
        let bindings: Bindings<'_> = names.zip(bound.iter().copied()).collect();
        if let Some(at) = bound.len().checked_sub(1) {
            for formula in &early[at] {
                if matches!(self.truth(formula, &bindings, true, None, &schema.name)?, Truth::No) {
                    return Ok(());
                }
            }
        }
        let Some(objects) = choices.get(bound.len()) else {
            actions.extend(self.action(schema, &bindings, bound)?);
            if actions.len() > MAX_CANDIDATES {
                return Err(PddlError::TooMany { what: "actions on objects", most: MAX_CANDIDATES });
            }
            return Ok(());
        };
        for object in objects {
            self.count_bindings(1)?;
            bound.push(object);
            self.bind(schema, choices, early, bound, actions)?;
            bound.pop();
        }
        Ok(())
    }

    /// Counts further bindings, before they are made.
    fn count_bindings(&mut self, more: usize) -> Result<(), PddlError> {
        self.bindings = self.bindings.saturating_add(more);
        if self.bindings > MAX_BINDINGS {
            return Err(PddlError::TooMany { what: "bindings of parameters", most: MAX_BINDINGS });
        }
        Ok(())
    }

    /// One action; `None` where it can never happen.
    fn action(
        &mut self,
        schema: &'task Schema,
        bindings: &Bindings<'task>,
        objects: &[&str],
    ) -> Result<Option<Action>, PddlError> {
        let words: Vec<String> =
            std::iter::once(schema.name.as_str()).chain(objects.iter().copied()).map(str::to_owned).collect();
        let place = format!("({}) in line {}", words.join(" "), schema.line);
        let mut duration = None;
        if let Some(limits) = &schema.duration {
            let (mut least, mut greatest) = (Rational::default(), None);
            for (comparison, limit) in limits {
                let Some(limit) = self.linear(limit, bindings, None, &place)? else { return Ok(None) };
                if !limit.factors.is_empty() {
                    return Err(PddlError::Said {
                        place,
                        what: "a duration that depends on a number that changes",
                    });
                }
                let limit = limit.constant;
                match comparison {
                    Comparison::Less | Comparison::Greater => {
                        return Err(PddlError::Said { place, what: "a duration with a strict limit" });
                    }
                    Comparison::AtMost => greatest = Some(greatest.map_or(limit, |known| limit.min(known))),
                    Comparison::AtLeast => least = least.max(limit),
                    Comparison::Equal => {
                        least = least.max(limit);
                        greatest = Some(greatest.map_or(limit, |known| limit.min(known)));
                    }
                }
            }
            if greatest.is_some_and(|greatest| greatest < least) {
                return Ok(None);
            }
            duration = Some((least, greatest));
        }
        let fixed = duration.and_then(|(least, greatest)| greatest.filter(|greatest| *greatest == least));
        let mut conditions: [Conditions; 3] = Default::default();
        for (when, formula) in &schema.conditions {
            self.mentioned.clear();
            let truth = self.truth(formula, bindings, true, fixed, &place)?;
            conditions[*when as usize].mentioned.append(&mut self.mentioned);
            match truth {
                Truth::Yes => {}
                Truth::No => return Ok(None),
                Truth::If(more) => {
                    let known = std::mem::take(&mut conditions[*when as usize]);
                    let Some(both) = known.and(more) else { return Ok(None) };
                    conditions[*when as usize] = both;
                }
            }
        }
        for known in &mut conditions {
            let Conditions { literals, mentioned, .. } = known;
            mentioned.retain(|atom| !literals.contains_key(atom));
        }
        let [at_start, throughout, at_end] = conditions;
        let mut start = Snap { conditions: at_start, ..Snap::default() };
        let mut end = Snap { conditions: at_end, ..Snap::default() };
        for (when, effect) in &schema.effects {
            let snap = if *when == When::End { &mut end } else { &mut start };
            if !self.effect(effect, bindings, fixed, &place, snap)? {
                return Ok(None);
            }
        }
        Ok(Some(Action { words, duration, start, throughout, end }))
    }

    /// Adds an effect. Returns whether all of its numbers are known.
    fn effect(
        &mut self,
        effect: &'task Effect,
        bindings: &Bindings<'task>,
        duration: Option<Rational>,
        place: &str,
        snap: &mut Snap,
    ) -> Result<bool, PddlError> {
        match effect {
            Effect::Set(application, value) => {
                let atom = self.put(application, bindings, place)?;
                let atom = self.atoms.id(atom);
                // An atom that one instant makes both true and false is true afterwards.
                let set = snap.sets.entry(atom).or_insert(*value);
                *set |= *value;
            }
            Effect::Grow(fluent, amount) | Effect::Shrink(fluent, amount) => {
                let Some(amount) = self.linear(amount, bindings, duration, place)? else { return Ok(false) };
                if !amount.factors.is_empty() {
                    return Err(PddlError::Said {
                        place: place.to_owned(),
                        what: "an effect whose amount depends on a number that changes",
                    });
                }
                let amount = amount.constant;
                let amount =
                    if matches!(effect, Effect::Shrink(..)) { amount.checked_neg() } else { Some(amount) };
                let fluent = self.put(fluent, bindings, place)?;
                let change = snap.changes.entry(self.fluents.id(fluent)).or_default();
                *change = amount.and_then(|amount| change.checked_add(amount)).ok_or(PddlError::Number)?;
            }
            Effect::Each(names, effects) => {
                for bindings in self.each(names, bindings)? {
                    for effect in effects {
                        if !self.effect(effect, &bindings, duration, place, snap)? {
                            return Ok(false);
                        }
                    }
                }
            }
        }
        Ok(true)
    }

    /// All bindings with objects for further names.
    fn each(
        &mut self,
        names: &'task Typed,
        bindings: &Bindings<'task>,
    ) -> Result<Vec<Bindings<'task>>, PddlError> {
        let mut all = vec![bindings.clone()];
        for (name, kinds) in names {
            let objects = self.objects_of(kinds);
            let with = |bindings: &Bindings<'task>, object: &'task str| {
                let mut bindings = bindings.clone();
                bindings.insert(name, object);
                bindings
            };
            self.count_bindings(all.len().saturating_mul(objects.len()))?;
            all =
                all.iter().flat_map(|known| objects.iter().map(move |object| with(known, object))).collect();
        }
        Ok(all)
    }

    /// An application with objects instead of parameters.
    fn put(
        &self,
        application: &'task [String],
        bindings: &Bindings<'task>,
        place: &str,
    ) -> Result<Application, PddlError> {
        let mut words = vec![application[0].clone()];
        for term in &application[1..] {
            words.push(self.object(term, bindings, place)?.to_owned());
        }
        Ok(words)
    }

    fn object<'name>(
        &self,
        term: &'name str,
        bindings: &Bindings<'name>,
        place: &str,
    ) -> Result<&'name str, PddlError> {
        let object = bindings.get(term).copied().unwrap_or(term);
        if self.types.contains_key(object) {
            Ok(object)
        } else {
            Err(PddlError::Unknown { place: place.to_owned(), name: object.to_owned() })
        }
    }

    /// The terms of a condition on what never changes.
    fn fixed_terms(&self, formula: &'task Formula) -> Option<Vec<&'task str>> {
        match formula {
            Formula::Atom(application) if !self.changing.contains(application[0].as_str()) => {
                Some(application[1..].iter().map(String::as_str).collect())
            }
            Formula::Same(left, right) => Some(vec![left, right]),
            Formula::Not(inner) => self.fixed_terms(inner),
            _ => None,
        }
    }

    fn truth(
        &mut self,
        formula: &'task Formula,
        bindings: &Bindings<'task>,
        is_asserted: bool,
        duration: Option<Rational>,
        place: &str,
    ) -> Result<Truth, PddlError> {
        let known = |truth: bool| if truth == is_asserted { Truth::Yes } else { Truth::No };
        let parts: Vec<Truth> = match formula {
            Formula::Atom(application) => {
                let atom = self.put(application, bindings, place)?;
                if !self.changing.contains(atom[0].as_str()) {
                    return Ok(known(self.facts.contains(atom.as_slice())));
                }
                let atom = self.atoms.id(atom);
                self.mentioned.insert(atom);
                let literals = BTreeMap::from([(atom, is_asserted)]);
                return Ok(Truth::If(Conditions { literals, ..Conditions::default() }));
            }
            Formula::Same(left, right) => {
                return Ok(known(
                    self.object(left, bindings, place)? == self.object(right, bindings, place)?,
                ));
            }
            Formula::Compare(comparison, left, right) => {
                let left = self.linear(left, bindings, duration, place)?;
                let right = self.linear(right, bindings, duration, place)?;
                let (Some(left), Some(right)) = (left, right) else { return Ok(Truth::No) };
                return compare(*comparison, &left, &right, is_asserted, place);
            }
            Formula::Not(inner) => return self.truth(inner, bindings, !is_asserted, duration, place),
            Formula::And(parts) | Formula::Or(parts) => {
                let mut found = Vec::new();
                for part in parts {
                    found.push(self.truth(part, bindings, is_asserted, duration, place)?);
                }
                found
            }
            Formula::Each(names, inner) | Formula::Any(names, inner) => {
                let mut found = Vec::new();
                for bindings in self.each(names, bindings)? {
                    found.push(self.truth(inner, &bindings, is_asserted, duration, place)?);
                }
                found
            }
        };
        let is_conjunction = matches!(formula, Formula::And(_) | Formula::Each(..)) == is_asserted;
        if is_conjunction {
            let mut all = Conditions::default();
            for part in parts {
                match part {
                    Truth::Yes => {}
                    Truth::No => return Ok(Truth::No),
                    Truth::If(more) => match all.and(more) {
                        Some(both) => all = both,
                        None => return Ok(Truth::No),
                    },
                }
            }
            return Ok(if all == Conditions::default() { Truth::Yes } else { Truth::If(all) });
        }
        let mut open = None;
        for part in parts {
            match part {
                Truth::Yes => return Ok(Truth::Yes),
                Truth::No => {}
                Truth::If(condition) if open.is_none() => open = Some(condition),
                Truth::If(_) => {
                    let what = "`or` (or `exists`, `imply`) between conditions that change";
                    return Err(PddlError::Said { place: place.to_owned(), what });
                }
            }
        }
        Ok(open.map_or(Truth::No, Truth::If))
    }

    /// An expression as a linear one; `None` where a number has no value.
    fn linear(
        &mut self,
        expr: &'task Expr,
        bindings: &Bindings<'task>,
        duration: Option<Rational>,
        place: &str,
    ) -> Result<Option<Linear>, PddlError> {
        let said = |what| PddlError::Said { place: place.to_owned(), what };
        let constant = |constant| Some(Linear { constant, ..Linear::default() });
        Ok(match expr {
            Expr::Number(number) => constant(*number),
            Expr::Duration => match duration {
                Some(duration) => constant(duration),
                None => return Err(said("`?duration` where the duration is not fixed")),
            },
            Expr::TotalTime => Some(Linear { of_time: Rational::ONE, ..Linear::default() }),
            Expr::Fluent(fluent) => {
                let fluent = self.put(fluent, bindings, place)?;
                if self.changing.contains(fluent[0].as_str()) {
                    let factors = BTreeMap::from([(self.fluents.id(fluent), Rational::ONE)]);
                    Some(Linear { factors, ..Linear::default() })
                } else {
                    self.values.get(fluent.as_slice()).copied().and_then(constant)
                }
            }
            Expr::Sum(parts) => {
                let mut sum = Linear::default();
                for part in parts {
                    let Some(part) = self.linear(part, bindings, duration, place)? else { return Ok(None) };
                    sum = sum.plus(&part, Rational::ONE)?;
                }
                Some(sum)
            }
            Expr::Difference(left, right) => {
                let left = self.linear(left, bindings, duration, place)?;
                let right = self.linear(right, bindings, duration, place)?;
                let (Some(left), Some(right)) = (left, right) else { return Ok(None) };
                Some(left.plus(&right, Rational::from_integer(-1))?)
            }
            Expr::Product(parts) => {
                let mut product = Linear { constant: Rational::ONE, ..Linear::default() };
                for part in parts {
                    let Some(part) = self.linear(part, bindings, duration, place)? else { return Ok(None) };
                    product = match (product.is_constant(), part.is_constant()) {
                        (true, _) => Linear::default().plus(&part, product.constant)?,
                        (_, true) => Linear::default().plus(&product, part.constant)?,
                        _ => return Err(said("a product of numbers that change")),
                    };
                }
                Some(product)
            }
            Expr::Quotient(left, right) => {
                let left = self.linear(left, bindings, duration, place)?;
                let right = self.linear(right, bindings, duration, place)?;
                let (Some(left), Some(right)) = (left, right) else { return Ok(None) };
                if !right.is_constant() {
                    return Err(said("a quotient by a number that changes"));
                }
                let Some(factor) = Rational::ONE.checked_div(right.constant) else { return Ok(None) };
                Some(Linear::default().plus(&left, factor)?)
            }
        })
    }

    /// Returns what to minimize.
    fn metric(&mut self, metric: &'task Metric) -> Result<Linear, PddlError> {
        let place = format!("the metric `{}`", metric.text);
        let measure = self.linear(&metric.measure, &Bindings::new(), None, &place)?;
        let what = "a number without a value at first";
        let measure = measure.ok_or(PddlError::Said { place, what })?;
        let sign = Rational::from_integer(if metric.is_maximized { -1 } else { 1 });
        Linear::default().plus(&measure, sign)
    }
}

impl Linear {
    fn is_constant(&self) -> bool {
        self.factors.is_empty() && self.of_time.is_zero()
    }

    /// The sum with `factor` times another one.
    fn plus(mut self, other: &Self, factor: Rational) -> Result<Self, PddlError> {
        let add = |sum: Rational, more: Rational| {
            more.checked_mul(factor).and_then(|more| sum.checked_add(more)).ok_or(PddlError::Number)
        };
        self.constant = add(self.constant, other.constant)?;
        self.of_time = add(self.of_time, other.of_time)?;
        for (fluent, more) in &other.factors {
            let sum = add(self.factors.get(fluent).copied().unwrap_or_default(), *more)?;
            self.factors.insert(*fluent, sum);
        }
        self.factors.retain(|_, factor| !factor.is_zero());
        Ok(self)
    }
}

/// Adds the predicates and functions that an effect changes.
fn changed<'task>(effect: &'task Effect, changing: &mut BTreeSet<&'task str>) {
    match effect {
        Effect::Set(application, _) | Effect::Grow(application, _) | Effect::Shrink(application, _) => {
            changing.insert(&application[0]);
        }
        Effect::Each(_, effects) => effects.iter().for_each(|effect| changed(effect, changing)),
    }
}

/// The parts of a conjunction.
fn conjuncts(formula: &Formula) -> Vec<&Formula> {
    match formula {
        Formula::And(parts) => parts.iter().flat_map(conjuncts).collect(),
        other => vec![other],
    }
}

fn compare(
    comparison: Comparison,
    left: &Linear,
    right: &Linear,
    is_asserted: bool,
    place: &str,
) -> Result<Truth, PddlError> {
    let said = |what| PddlError::Said { place: place.to_owned(), what };
    let difference = left.clone().plus(right, Rational::from_integer(-1))?;
    let comparison = match (comparison, is_asserted) {
        (comparison, true) => comparison,
        (Comparison::Less, false) => Comparison::AtLeast,
        (Comparison::AtMost, false) => Comparison::Greater,
        (Comparison::AtLeast, false) => Comparison::Less,
        (Comparison::Greater, false) => Comparison::AtMost,
        (Comparison::Equal, false) if !difference.is_constant() => {
            return Err(said("an inequality (`not =`) of a number that changes"));
        }
        (Comparison::Equal, false) => {
            return Ok(if difference.constant.is_zero() { Truth::No } else { Truth::Yes });
        }
    };
    let zero = Rational::default();
    let mut factors = difference.factors.iter();
    let (fluent, factor) = match (factors.next(), factors.next()) {
        _ if !difference.of_time.is_zero() => return Err(said("a condition on the length of the plan")),
        (None, _) => {
            let constant = difference.constant;
            let holds = match comparison {
                Comparison::Less => constant < zero,
                Comparison::AtMost => constant <= zero,
                Comparison::Equal => constant == zero,
                Comparison::AtLeast => constant >= zero,
                Comparison::Greater => constant > zero,
            };
            return Ok(if holds { Truth::Yes } else { Truth::No });
        }
        (Some((fluent, factor)), None) => (*fluent, *factor),
        _ => return Err(said("a comparison of two numbers that change")),
    };
    let comparison = if factor.is_negative() { comparison.mirrored() } else { comparison };
    let limit =
        difference.constant.checked_neg().and_then(|it| it.checked_div(factor)).ok_or(PddlError::Number)?;
    let need = |is_least, is_strict| Need { fluent, is_least, is_strict, limit };
    let needs = match comparison {
        Comparison::Less => vec![need(false, true)],
        Comparison::AtMost => vec![need(false, false)],
        Comparison::Equal => vec![need(true, false), need(false, false)],
        Comparison::AtLeast => vec![need(true, false)],
        Comparison::Greater => vec![need(true, true)],
    };
    Ok(Truth::If(Conditions { needs, ..Conditions::default() }))
}

impl Ground {
    /// Leaves out actions that can never happen, and conditions that always hold.
    ///
    /// What can ever be true, or false, is found with actions that only add to it: a relaxed reachability analysis, as in
    /// planners that search forward (Hoffmann and Nebel 2001).
    fn keep_reachable(&mut self) {
        let mut values: Vec<[bool; 2]> =
            (0..self.atoms.all.len()).map(|atom| self.initial.contains(&atom)).map(|it| [!it, it]).collect();
        for (_, atom, value) in &self.timed {
            values[*atom][usize::from(*value)] = true;
        }
        let mut waiting: Vec<Action> = std::mem::take(&mut self.actions);
        loop {
            let can_happen = |action: &Action| {
                let literals = action.conditions().into_iter().flat_map(|it| &it.literals);
                // Its own start may make true what it requires later.
                literals.into_iter().all(|(atom, value)| {
                    values[*atom][usize::from(*value)] || action.start.sets.get(atom) == Some(value)
                })
            };
            let (found, rest): (Vec<_>, Vec<_>) = waiting.into_iter().partition(can_happen);
            waiting = rest;
            if found.is_empty() {
                break;
            }
            for (atom, value) in found.iter().flat_map(Action::snaps).flat_map(|snap| &snap.sets) {
                values[*atom][usize::from(*value)] = true;
            }
            self.actions.extend(found);
        }
        self.actions.sort_by(|a, b| a.words.cmp(&b.words));
        // An atom counts as changing even if an action only sets the value that it always has: PDDL still keeps that action
        // apart from those that need the atom.
        let set: BTreeSet<Atom> =
            self.actions.iter().flat_map(Action::snaps).flat_map(|snap| snap.sets.keys().copied()).collect();
        let changes = |atom: &Atom| values[*atom] == [true, true] || set.contains(atom);
        for action in &mut self.actions {
            for snap in [&mut action.start, &mut action.end] {
                snap.conditions.literals.retain(|atom, _| changes(atom));
                snap.changes.retain(|_, change| !change.is_zero());
            }
            action.throughout.literals.retain(|atom, _| changes(atom));
        }
        self.goal.literals.retain(|atom, value| !values[*atom][usize::from(*value)] || changes(atom));
        self.timed.retain(|(_, atom, _)| changes(atom));
    }

    /// Leaves out actions that help neither the goal nor an action that does.
    fn keep_relevant(&mut self) {
        let (mut wanted, mut numbers) = (BTreeSet::new(), BTreeSet::new());
        let mut open = vec![self.goal.clone()];
        // What lowers the metric is worth doing for itself.
        let factors = self.metric.as_ref().map(|metric| metric.factors.clone()).unwrap_or_default();
        let is_worth_it = |action: &Action| {
            let mut changes = action.snaps().into_iter().flat_map(|snap| &snap.changes);
            changes.any(|(fluent, change)| {
                factors
                    .get(fluent)
                    .is_some_and(|factor| factor.is_negative() != change.is_negative() && !change.is_zero())
            })
        };
        let mut waiting = std::mem::take(&mut self.actions);
        while !open.is_empty() {
            for conditions in open.drain(..) {
                wanted.extend(conditions.literals);
                numbers.extend(conditions.needs.into_iter().map(|need| need.fluent));
            }
            let helps = |action: &Action| {
                is_worth_it(action)
                    || action.snaps().into_iter().any(|snap| {
                        snap.sets.iter().any(|(atom, value)| wanted.contains(&(*atom, *value)))
                            || snap.changes.keys().any(|fluent| numbers.contains(fluent))
                    })
            };
            let (found, rest): (Vec<_>, Vec<_>) = waiting.into_iter().partition(helps);
            waiting = rest;
            open.extend(found.iter().flat_map(Action::conditions).cloned());
            self.actions.extend(found);
        }
        self.actions.sort_by(|a, b| a.words.cmp(&b.words));
    }
}
