//! What the names in conditions represent: substitution of formals, the `X_V` rule (SPEC 1.3), domains and value sets.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use rmpl::diagnostics::fleet;
use rmpl::program::{ArgumentValue, Condition, Program, Statement, StatementKind};
use rmpl::{Code, Diagnostic, Span};
use smol_str::{SmolStr, format_smolstr};

use super::ground::Ground;
use super::scope::argument_text;
use crate::network::{Literal, ValueId, ValueSet, Variable, VariableId};
use crate::sight::{Hidden, Sight, sight_text};

/// What is named is not there: an activity, a variable, a value or a resource.
pub(super) const E_UNDEF: Code = Code("E-UNDEF");

/// A value is outside its variable's domain.
pub(super) const E_VALUE: Code = Code("E-VALUE");

/// A literal after substitution and the `X_V` rule: `X=V` or the atom `X`, perhaps negated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fact {
    pub(super) variable: SmolStr,
    /// An atom has none; several are the set of which the variable has one.
    pub(super) values: Vec<SmolStr>,
    /// The location that is in sight from all of the values, and from no other.
    pub(super) sees: Option<SmolStr>,
    pub(super) negated: bool,
}

impl Fact {
    /// A condition as it is written, before anything is substituted.
    pub(super) fn written(condition: &Condition) -> Self {
        Self {
            variable: condition.variable.text.clone(),
            values: condition.values.iter().map(|value| value.text.clone()).collect(),
            sees: condition.sees.as_ref().map(|location| location.text.clone()),
            negated: condition.negated,
        }
    }

    /// A variable has a value.
    pub(super) fn is(variable: SmolStr, value: SmolStr) -> Self {
        Self { variable, values: vec![value], sees: None, negated: false }
    }

    /// The fact that holds exactly when this one does not.
    pub(super) fn negation(self) -> Self {
        Self { negated: !self.negated, ..self }
    }

    /// The values; of an atom that it is true.
    fn values(&self) -> impl Iterator<Item = &str> {
        let atom = (self.values.is_empty() && self.sees.is_none()).then_some("true");
        atom.into_iter().chain(self.values.iter().map(SmolStr::as_str))
    }

    /// As the contracts print it (DESIGN 4.1).
    pub(super) fn text(&self) -> SmolStr {
        let positive = match (&self.sees, self.values.as_slice()) {
            (Some(location), _) => sight_text(&self.variable, location),
            (None, []) => self.variable.to_string(),
            (None, [value]) => format!("{}={value}", self.variable),
            (None, values) => format!("{} in {{{}}}", self.variable, values.join(", ")),
        };
        if self.negated { format!("not({positive})").into() } else { positive.into() }
    }
}

/// A name with the argument that it represents; of `v.at` the vehicle before the dot may be one.
pub(super) fn substituted(name: &SmolStr, substitute: &dyn Fn(&str) -> Option<ArgumentValue>) -> SmolStr {
    if let Some(value) = substitute(name) {
        return argument_text(&value);
    }
    match name.split_once('.') {
        Some((owner, part)) => match substitute(owner) {
            Some(value) => format_smolstr!("{}.{part}", argument_text(&value)),
            None => name.clone(),
        },
        None => name.clone(),
    }
}

/// What a file says of variables.
pub(super) struct Vocabulary<'program> {
    domains: BTreeMap<&'program str, Vec<&'program str>>,
    /// Modes of components that the plant lacks, which the language has said.
    without_component: BTreeSet<&'program str>,
    /// Undeclared variables that some literal `X=…` of the file speaks of.
    compared: BTreeSet<&'program str>,
    /// What the variables that keep their values are at first, in textual order: declared states, then where vehicles
    /// stand (SPEC 10.3).
    initial: Vec<(SmolStr, SmolStr, Span)>,
    /// The places that vehicles can be at, by `V.at`.
    places: BTreeMap<SmolStr, Rc<[&'program str]>>,
    /// The models of vehicles.
    models: BTreeMap<&'program str, &'program str>,
    ground: &'program dyn Ground,
    /// From which places vehicles do not see locations, by `V.at` and location, as far as it was asked for.
    hidden: RefCell<BTreeMap<(SmolStr, SmolStr), Vec<Hidden>>>,
}

impl<'program> Vocabulary<'program> {
    /// Reads declarations and literals in one pass.
    pub(super) fn new(program: &'program Program, ground: &'program dyn Ground) -> Self {
        let mut domains = BTreeMap::new();
        let mut without_component = BTreeSet::new();
        for declared in &program.variables {
            if declared.is_from_plant && declared.values.is_empty() {
                without_component.insert(declared.name.text.as_str());
                continue;
            }
            let values = declared.values.iter().map(|value| value.text.as_str()).collect();
            domains.entry(declared.name.text.as_str()).or_insert(values);
        }
        let mut initial: Vec<(SmolStr, SmolStr, Span)> = Vec::new();
        for declared in &program.variables {
            if let Some(value) = &declared.initial {
                initial.push((declared.name.text.clone(), value.text.clone(), declared.name.span));
            }
        }
        // One list for all vehicles: each may have as many places as there are.
        let locations: Rc<[&str]> =
            program.world.locations.iter().map(|location| location.name.text.as_str()).collect();
        let known: BTreeSet<&str> = locations.iter().copied().collect();
        let mut places = BTreeMap::new();
        for vehicle in &program.world.vehicles {
            let variable = format_smolstr!("{}.at", vehicle.name.text);
            let start = vehicle.start.text.as_str();
            let domain = if known.contains(start) {
                Rc::clone(&locations)
            } else {
                locations.iter().copied().chain([start]).collect()
            };
            initial.push((variable.clone(), vehicle.start.text.clone(), vehicle.name.span));
            places.entry(variable).or_insert(domain);
        }
        let mut compared = BTreeSet::new();
        for primitive in &program.primitives {
            let required = primitive.requires.iter().map(|required| &required.condition);
            compared.extend(required.filter(|it| !it.values.is_empty()).map(|it| it.variable.text.as_str()));
        }
        let bodies = program.activities.iter().map(|activity| &activity.body);
        for body in bodies.chain(program.scenarios.iter().map(|scenario| &scenario.body)) {
            for_each_condition(body, &mut |condition| {
                if !condition.values.is_empty() {
                    compared.insert(condition.variable.text.as_str());
                }
            });
        }
        let hidden = RefCell::default();
        let vehicles = program.world.vehicles.iter();
        let models = vehicles.map(|it| (it.name.text.as_str(), it.model.text.as_str())).collect();
        Self { domains, without_component, compared, initial, places, models, ground, hidden }
    }

    /// Returns whether a variable keeps its value until something changes it (SPEC 10).
    pub(super) fn is_lasting(&self, variable: &str) -> bool {
        self.initial.iter().any(|(name, _, _)| name == variable)
    }

    /// Returns what holds at the start of everything, and where that is declared.
    pub(super) fn initial_values(&self) -> impl Iterator<Item = (Fact, Span)> + '_ {
        self.initial.iter().map(|(variable, value, span)| (Fact::is(variable.clone(), value.clone()), *span))
    }

    fn domain(&self, variable: &str) -> Option<&[&'program str]> {
        let declared = self.domains.get(variable).map(Vec::as_slice);
        declared.or_else(|| self.places.get(variable).map(|places| &**places))
    }

    /// Returns what `condition` says where `substitute` gives the arguments of formals.
    pub(super) fn fact(
        &self,
        condition: &Condition,
        substitute: &dyn Fn(&str) -> Option<ArgumentValue>,
    ) -> Result<Fact, Diagnostic> {
        let text = |name: &SmolStr| substituted(name, substitute);
        let negated = condition.negated;
        let written = match substitute(&condition.variable.text) {
            // A parameter that represents a whole condition, whose own names mean something at the call.
            Some(ArgumentValue::Condition(handed))
                if condition.values.is_empty() && condition.sees.is_none() =>
            {
                let fact = Fact::written(&handed);
                Fact { negated: fact.negated != negated, ..fact }
            }
            _ => Fact {
                variable: text(&condition.variable.text),
                values: condition.values.iter().map(|value| text(&value.text)).collect(),
                sees: condition.sees.as_ref().map(|location| text(&location.text)),
                negated,
            },
        };
        let is_atom = written.values.is_empty() && written.sees.is_none();
        let fact = match self.split(&written.variable).filter(|_| is_atom) {
            Some((variable, value)) => {
                Fact { negated: written.negated, ..Fact::is(variable.into(), value.into()) }
            }
            None => written,
        };
        self.check(&fact, condition)?;
        self.with_places(fact, condition)
    }

    /// Returns what is to see a location, with the places from which it does.
    fn with_places(&self, fact: Fact, condition: &Condition) -> Result<Fact, Diagnostic> {
        let Some(location) = &fact.sees else { return Ok(fact) };
        let span = condition.sees.as_ref().map_or(condition.span, |location| location.span);
        let Some(domain) = self.places.get(&fact.variable) else {
            let message = format!(
                "`{}` cannot be in `visible(…)`: only the place of a vehicle can, as in `V.at`",
                fact.variable
            );
            return Err(Diagnostic::error(E_VALUE, condition.variable.span, message).with_hint(
                "`V.at in visible(L)` is true while the vehicle V is at a location from which it sees L",
            ));
        };
        if !domain.contains(&location.as_str()) {
            let message = format!("unknown location `{location}`");
            return Err(Diagnostic::error(E_VALUE, span, message)
                .with_hint("`visible(L)` needs a location or a parameter"));
        }
        let mut known = self.hidden.borrow_mut();
        let hidden = known.entry((fact.variable.clone(), location.clone())).or_insert_with(|| {
            let vehicle = fact.variable.strip_suffix(".at").unwrap_or_default();
            self.ground.hidden(vehicle, location)
        });
        let is_seen = |place: &&&str| hidden.iter().all(|it| it.place != **place);
        let values = domain.iter().filter(is_seen).map(|&place| place.into()).collect();
        Ok(Fact { values, ..fact })
    }

    /// Returns what was worked out of what vehicles see, as far as `facts` ask for it, with the variables of the
    /// network.
    pub(super) fn sights(&self, facts: &[Fact], variables: &[Variable]) -> Vec<Sight> {
        let asked: BTreeSet<(&SmolStr, &SmolStr)> =
            facts.iter().filter_map(|fact| Some((&fact.variable, fact.sees.as_ref()?))).collect();
        let known = self.hidden.borrow();
        let sights = asked.into_iter().filter_map(|(variable, location)| {
            let hidden = known.get(&(variable.clone(), location.clone()))?.clone();
            let at = variables.iter().position(|it| it.name == *variable)?;
            Some(Sight { variable: VariableId::from_index(at), location: location.clone(), hidden })
        });
        sights.collect()
    }

    /// The `X_V` rule.
    fn split<'name>(&self, name: &'name str) -> Option<(&'name str, &'name str)> {
        if self.domains.contains_key(name) {
            return None;
        }
        let (variable, value) = name.rsplit_once('_')?;
        let is_value = match self.domains.get(variable) {
            Some(domain) => domain.contains(&value),
            None => self.compared.contains(variable) && !value.is_empty(),
        };
        is_value.then_some((variable, value))
    }

    fn check(&self, fact: &Fact, condition: &Condition) -> Result<(), Diagnostic> {
        let Some(domain) = self.domain(fact.variable.as_str()) else {
            return match fact.variable.split_once('.') {
                None => Ok(()),
                Some((_, "mode")) if self.without_component.contains(fact.variable.as_str()) => Ok(()),
                // What is written is looked up by the language, what a parameter represents is known here.
                Some((_, "mode")) if fact.variable == condition.variable.text => Ok(()),
                Some((_, "mode")) => {
                    let message = format!("unknown state variable `{}`", fact.variable);
                    let hint = format!("declare it: `state {} from plant;`", fact.variable);
                    Err(Diagnostic::error(E_UNDEF, condition.variable.span, message).with_hint(hint))
                }
                Some((owner, part)) if self.places.contains_key(&format_smolstr!("{owner}.at")) => {
                    let model = self.models.get(owner).copied().unwrap_or_default();
                    let span = condition.variable.span;
                    Err(fleet::unknown_equipment(owner, part, model, "state", span))
                }
                Some((owner, _)) => {
                    let message = format!("unknown vehicle `{owner}`");
                    Err(Diagnostic::error(E_UNDEF, condition.variable.span, message)
                        .with_hint("`V.at` needs a declaration `vehicle V : MODEL at PLACE;`"))
                }
            };
        };
        let wrong = fact.values().position(|value| !domain.contains(&value));
        let Some(wrong) = wrong else { return Ok(()) };
        let span = condition.values.get(wrong).map_or(condition.span, |value| value.span);
        let message = match fact.values.get(wrong) {
            Some(value) => format!("`{value}` is not a value of `{}`", fact.variable),
            None => format!("expected a value for the variable `{}`", fact.variable),
        };
        let hint = format!("`{}` is one of {}", fact.variable, domain.join(", "));
        Err(Diagnostic::error(E_VALUE, span, message).with_hint(hint))
    }

    /// Gives every variable that `facts` speak of an id, in order of first mention, and every fact its literal.
    pub(super) fn literals(&self, facts: &[Fact]) -> (Vec<Variable>, Vec<Literal>) {
        let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
        let mut tables: Vec<Table> = Vec::new();
        for fact in facts {
            let at = *ids.entry(&fact.variable).or_insert_with(|| {
                let is_lasting = self.is_lasting(&fact.variable);
                tables.push(Table::new(&fact.variable, self.domain(fact.variable.as_str()), is_lasting));
                tables.len() - 1
            });
            tables[at].mention(fact);
        }
        for table in &mut tables {
            table.close_if_boolean();
        }
        let literals = facts
            .iter()
            .map(|fact| {
                let at = ids[fact.variable.as_str()];
                Literal { variable: VariableId::from_index(at), values: tables[at].set(fact) }
            })
            .collect();
        (tables.into_iter().map(|table| table.variable).collect(), literals)
    }
}

/// A variable while its values are being collected.
struct Table {
    variable: Variable,
    values: BTreeMap<SmolStr, ValueId>,
    has_atom: bool,
}

impl Table {
    fn new(name: &SmolStr, domain: Option<&[&str]>, is_lasting: bool) -> Self {
        let variable =
            Variable { name: name.clone(), values: Vec::new(), closed: domain.is_some(), is_lasting };
        let mut table = Self { variable, values: BTreeMap::new(), has_atom: false };
        for value in domain.into_iter().flatten() {
            table.add(value);
        }
        table
    }

    fn add(&mut self, value: &str) {
        if !self.values.contains_key(value) {
            self.values.insert(value.into(), ValueId::from_index(self.variable.values.len()));
            self.variable.values.push(value.into());
        }
    }

    fn mention(&mut self, fact: &Fact) {
        self.has_atom |= fact.values.is_empty();
        fact.values().for_each(|value| self.add(value));
    }

    /// An atom that is never compared with another value is Boolean: its domain is `false`, `true`.
    fn close_if_boolean(&mut self) {
        let two_valued = self.variable.values.iter().all(|value| value == "true" || value == "false");
        if !self.variable.closed && self.has_atom && two_valued {
            self.add("false");
            self.variable.closed = true;
        }
    }

    fn set(&self, fact: &Fact) -> ValueSet {
        let mut values: Vec<ValueId> = fact.values().map(|value| self.values[value]).collect();
        values.sort_unstable();
        values.dedup();
        match (fact.negated, self.variable.closed) {
            (false, _) => ValueSet::In(values),
            (true, false) => ValueSet::NotIn(values),
            (true, true) => {
                let all = (0..self.variable.values.len()).map(ValueId::from_index);
                ValueSet::In(all.filter(|other| values.binary_search(other).is_err()).collect())
            }
        }
    }
}

fn for_each_condition<'program>(statement: &'program Statement, visit: &mut dyn FnMut(&'program Condition)) {
    statement.for_each(&mut |statement| match &statement.kind {
        StatementKind::Maintaining(_, condition)
        | StatementKind::Watching(_, condition)
        | StatementKind::Telling(_, condition)
        | StatementKind::IfThennext(condition, _)
        | StatementKind::Condition(_, condition) => visit(condition),
        StatementKind::Call(_, arguments) => {
            for argument in arguments {
                if let ArgumentValue::Condition(condition) = &argument.value {
                    visit(condition);
                }
            }
        }
        _ => {}
    });
}
