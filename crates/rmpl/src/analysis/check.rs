//! What one declaration says wrongly in view of the rest of the file.

use exact::Bound;

use rustc_hash::{FxHashMap, FxHashSet};
use smol_str::SmolStr;

use super::index::{DeclarationKey, Facts, Index, Namespace};
use super::names::{Names, Symbol};
use super::structure;
use super::summary::{Call, Definition, Equipment, Summary, Use, UseKind};
use crate::diagnostic::{Diagnostic, Known, Severity};
use crate::diagnostics::{
    arity, bounds, contingent, controllability, duplicate, fleet, similar, traverse, undefined, unknown_name,
    unused, value,
};
use crate::lower::{Item, OptionDecl, OptionValue};
use crate::program::{Change, VEHICLE_MODELS};
use crate::span::Span;

/// The outcome of checking one declaration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Checked {
    /// Relative diagnostics; of those about the same missing name, only the first of the file is shown.
    pub(crate) diagnostics: Vec<(Option<(Namespace, Symbol)>, Diagnostic)>,
    pub(crate) revision: u32,
    /// The namespaces in which some diagnostic looks for similar names, so that any new name may change it.
    pub(crate) depends_on_names: u16,
}

/// Checks the declaration `key`. `is_sound` says that it has no errors of its own: only then are its oddities reported.
pub(crate) fn check(
    key: DeclarationKey,
    summary: &Summary,
    item: Option<&Item>,
    is_sound: bool,
    names: &Names,
    index: &Index,
) -> Checked {
    let checked = Checked { revision: index.revision(), ..Checked::default() };
    let mut checker = Checker {
        summary,
        names,
        index,
        checked,
        told: FxHashSet::default(),
        nearest: FxHashMap::default(),
        arguments: arguments_by_call(summary),
    };
    for definition in summary.definitions() {
        checker.definition(key, definition);
    }
    checker.own_names();
    for (number, call) in summary.calls.iter().enumerate() {
        checker.call(number as u32, call);
    }
    for literal in &summary.literals {
        checker.literal(literal);
    }
    for used in &summary.uses {
        checker.name_use(used);
    }
    if let Some(Item::Option(option)) = item {
        checker.option(option);
    }
    if let Some(item) = item.filter(|_| is_sound) {
        let meaning = Meaning { names, index };
        let found = structure::structure(item, meaning);
        checker.checked.diagnostics.extend(found.into_iter().map(|diagnostic| (None, diagnostic)));
    }
    // What `or` and `else` copy is written once, and so is what is wrong with it.
    let mut known = Known::default();
    checker.checked.diagnostics.retain(|(_, diagnostic)| known.is_new(diagnostic));
    if !is_sound {
        checker.checked.diagnostics.retain(|(_, diagnostic)| diagnostic.severity == Severity::Error);
    }
    checker.checked.diagnostics.shrink_to_fit();
    checker.checked
}

/// What names mean in this file.
#[derive(Clone, Copy)]
pub(crate) struct Meaning<'a> {
    pub(crate) names: &'a Names,
    pub(crate) index: &'a Index,
}

impl Meaning<'_> {
    /// Returns whether a variable is the state of a component that the plant does not have, which has been reported.
    pub(crate) fn is_unknown_component(&self, variable: Symbol) -> bool {
        let definition = self.index.definition(Namespace::Variable, variable);
        definition.is_some_and(|definition| definition.is_from_plant && definition.values.is_empty())
    }

    /// The domain of a declared variable.
    pub(crate) fn domain(&self, variable: Symbol) -> Option<&[Symbol]> {
        let declared = self.index.definition(Namespace::Variable, variable);
        declared
            .map(|definition| definition.values.as_slice())
            .or_else(|| self.own_state(variable).map(|state| state.values.as_slice()))
    }

    /// The state of a vehicle that `R1.drill` is.
    pub(crate) fn own_state(&self, variable: Symbol) -> Option<&Equipment> {
        self.index.equipment(self.names, variable).filter(|own| own.initial.is_some())
    }

    /// Returns whether a declared variable keeps its value until something changes it.
    pub(crate) fn is_state(&self, variable: Symbol) -> bool {
        let definition = self.index.definition(Namespace::Variable, variable);
        definition.is_some_and(|definition| definition.initial.is_some() || definition.is_from_plant)
            || self.own_state(variable).is_some()
    }

    /// Returns whether `X_V`, with `X` and `V` given, is about `X` (SPEC 1.3).
    pub(crate) fn splits(&self, whole: Symbol, (variable, value): (Symbol, Symbol)) -> bool {
        self.domain(whole).is_none()
            && match self.domain(variable) {
                Some(domain) => domain.contains(&value),
                None => self.index.facts(variable).compared > 0,
            }
    }
}

pub(super) struct Checker<'a> {
    pub(super) summary: &'a Summary,
    pub(super) names: &'a Names,
    pub(super) index: &'a Index,
    checked: Checked,
    /// What need not be said again.
    told: FxHashSet<(Namespace, Symbol)>,
    /// Similar names that were looked for.
    nearest: FxHashMap<(Namespace, Symbol), Option<SmolStr>>,
    /// The names handed to each call, by its number.
    arguments: FxHashMap<u32, Vec<Use>>,
}

/// So many different names that are declared nowhere have similar ones suggested, in one declaration.
const MAX_SUGGESTED: usize = 1000;

fn arguments_by_call(summary: &Summary) -> FxHashMap<u32, Vec<Use>> {
    let mut arguments: FxHashMap<u32, Vec<Use>> = FxHashMap::default();
    for used in &summary.uses {
        if let UseKind::Argument(call) = used.kind {
            arguments.entry(call).or_default().push(*used);
        }
    }
    arguments
}

impl<'a> Checker<'a> {
    pub(super) const fn meaning(&self) -> Meaning<'a> {
        Meaning { names: self.names, index: self.index }
    }

    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        self.checked.diagnostics.push((None, diagnostic));
    }

    pub(super) fn push_once(&mut self, namespace: Namespace, name: Symbol, diagnostic: Diagnostic) {
        if self.told.insert((namespace, name)) {
            self.checked.diagnostics.push((Some((namespace, name)), diagnostic));
        }
    }

    /// Returns whether the one thing that is said of a name has been said in this declaration.
    pub(super) fn is_told(&self, namespace: Namespace, name: Symbol) -> bool {
        self.told.contains(&(namespace, name))
    }

    pub(super) fn text(&self, symbol: Symbol) -> &'a str {
        self.names.text(symbol)
    }

    pub(super) fn nearest(&mut self, written: Symbol, namespace: Namespace) -> Option<SmolStr> {
        self.checked.depends_on_names |= namespace.bit();
        if let Some(known) = self.nearest.get(&(namespace, written)) {
            return known.clone();
        }
        if self.nearest.len() >= MAX_SUGGESTED {
            return None;
        }
        let found = self.index.nearest(self.names, written, namespace);
        self.nearest.insert((namespace, written), found.clone());
        found
    }

    fn definition(&mut self, key: DeclarationKey, definition: &Definition) {
        if self.index.first_key(definition.namespace, definition.name) != Some(key) {
            let name = self.text(definition.name);
            self.push(duplicate::declaration(definition.namespace, name, definition.span));
            return;
        }
        if definition.is_from_plant && !self.index.has_component(definition.name) {
            self.no_component(definition);
            return;
        }
        let facts = self.index.facts(definition.name);
        // A parameter may represent its component.
        if definition.is_from_plant && self.index.literals_of_formals > 0 {
            return;
        }
        if self.index.scenarios > 0 && is_unused(definition.namespace, facts) {
            let what = match definition.namespace {
                Namespace::Callable if definition.is_activity => "activity",
                Namespace::Callable => "primitive",
                Namespace::Variable => "variable",
                Namespace::Constant => "constant",
                Namespace::Resource => "resource",
                _ => "location",
            };
            self.push(unused::unused(what, self.text(definition.name), definition.span));
        }
    }

    /// Names that one declaration declares twice.
    fn own_names(&mut self) {
        let mut known = FxHashSet::default();
        for definition in self.summary.definitions() {
            if !known.insert((definition.namespace, definition.name)) {
                let name = self.text(definition.name);
                self.push(duplicate::declaration(definition.namespace, name, definition.span));
            }
        }
    }

    /// The state of a component that the plant does not have.
    fn no_component(&mut self, definition: &Definition) {
        let nearest = self.names.nearest(definition.name, self.index.components());
        let name = self.text(definition.name);
        self.push(undefined::component(name, definition.span, nearest.as_deref()));
    }

    fn option(&mut self, option: &OptionDecl) {
        let is_ignored = option.name.text == "controllability"
            && matches!(&option.value, OptionValue::Name(value) if value == "none");
        if is_ignored && self.index.has_contingents() {
            self.push(controllability::ignored(option.value_span));
        }
    }

    fn call(&mut self, number: u32, call: &Call) {
        let Some(definition) = self.index.definition(Namespace::Callable, call.name) else {
            if !call.is_bare {
                self.undeclared_call(call);
            }
            return;
        };
        if definition.arity != call.arguments {
            self.push(arity::mismatch(self.text(call.name), definition.arity, call));
        }
        if let Some(span) = call.contingent.filter(|_| definition.is_activity) {
            self.push(contingent::activity(self.text(call.name), span));
        } else if let (Some((written, span)), Some(declared)) = (call.bounds, definition.bounds) {
            let lower = written.0.max(declared.0);
            let upper = written.1.min(declared.1);
            if call.contingent.is_some() {
                if (lower, upper) != written {
                    self.push(bounds::outside(self.text(call.name), written, declared, span));
                }
            } else if Bound::Finite(lower) > upper && !definition.is_contingent {
                self.push(bounds::disjoint(self.text(call.name), written, declared, span));
            }
        }
        if definition.moves {
            self.traverse(number, call);
        }
    }

    fn undeclared_call(&mut self, call: &Call) {
        let nearest = self.nearest(call.name, Namespace::Callable);
        let is_strict = self.index.is_strict();
        let diagnostic =
            undefined::call(self.text(call.name), call, nearest.as_deref(), is_strict, self.summary.start);
        if nearest.is_some() {
            self.push(diagnostic);
        } else {
            self.push_once(Namespace::Callable, call.name, diagnostic);
        }
    }

    fn traverse(&mut self, number: u32, call: &Call) {
        let arguments = self.arguments.remove(&number).unwrap_or_default();
        let is_location = |used: &Use| self.index.facts(used.name).definition(Namespace::Location).is_some();
        let is_vehicle = |used: &Use| self.index.facts(used.name).definition(Namespace::Vehicle).is_some();
        let known = arguments.iter().filter(|used| is_location(used)).count();
        for used in arguments.iter().filter(|used| !is_location(used) && !is_vehicle(used)) {
            if let Some(nearest) = self.nearest(used.name, Namespace::Location) {
                self.push(similar::location(self.text(used.name), &nearest, used.span));
                return;
            }
        }
        if known == 0 && !call.has_formal_argument {
            self.push(traverse::no_location(self.text(call.name), call.with_arguments));
        }
    }

    fn name_use(&mut self, used: &Use) {
        let (namespace, what) = match used.kind {
            // What members are, and whether they are of one kind, all groups together decide.
            UseKind::Argument(_) | UseKind::HeaderBound | UseKind::Member | UseKind::Level => return,
            UseKind::Number => {
                self.number(used);
                return;
            }
            UseKind::Place => {
                self.place(used);
                return;
            }
            UseKind::ClosedTo => {
                self.closed_to(used);
                return;
            }
            UseKind::Resource(change) => {
                self.resource(used, change);
                return;
            }
            UseKind::Occurrence => {
                self.occurrence(used);
                return;
            }
            UseKind::Model => {
                self.model(used);
                return;
            }
            UseKind::Group => {
                self.group(used);
                return;
            }
            UseKind::Start => (Namespace::Location, "location"),
            UseKind::Vehicle => (Namespace::Vehicle, "vehicle"),
        };
        if self.index.facts(used.name).definition(namespace).is_none() {
            let nearest = self.nearest(used.name, namespace);
            let is_strict = self.index.is_strict();
            let diagnostic = undefined::world(
                what,
                self.text(used.name),
                used.span,
                nearest.as_deref(),
                is_strict,
                self.summary.start,
            );
            self.push_once(namespace, used.name, diagnostic);
        }
    }

    /// The place of a vehicle is one of the locations.
    fn place(&mut self, used: &Use) {
        if self.index.facts(used.name).definition(Namespace::Location).is_none() {
            let nearest = self.nearest(used.name, Namespace::Location);
            let name = self.text(used.name);
            let diagnostic = value::no_location(name, used.span, nearest.as_deref());
            let declare = || undefined::declare_location(name, self.summary.start);
            let is_new = nearest.is_none();
            let diagnostic = if is_new { diagnostic.with_fix(declare()) } else { diagnostic };
            self.push(diagnostic);
        }
    }

    /// A keep-out area is closed to vehicles, vehicle models, and activities that move vehicles.
    fn closed_to(&mut self, used: &Use) {
        let name = self.text(used.name);
        let facts = self.index.facts(used.name);
        let moves = || self.index.definition(Namespace::Callable, used.name).is_some_and(|it| it.moves);
        let is_model = VEHICLE_MODELS.contains(&name) || facts.definition(Namespace::Model).is_some();
        if is_model || facts.definition(Namespace::Vehicle).is_some() || moves() {
            return;
        }
        let is_activity = facts.definition(Namespace::Callable).is_some();
        let nearest = self.nearest(used.name, Namespace::Vehicle).filter(|_| !is_activity);
        let diagnostic = value::closed_to(name, used.span, is_activity, nearest.as_deref());
        self.push(diagnostic);
    }

    /// The model of a vehicle, or the one that a model extends.
    fn model(&mut self, used: &Use) {
        let name = self.text(used.name);
        let is_declared = self.index.facts(used.name).definition(Namespace::Model).is_some();
        if !is_declared && !VEHICLE_MODELS.contains(&name) {
            let nearest = self.nearest(used.name, Namespace::Model);
            self.push(value::model(name, used.span, nearest.as_deref(), &VEHICLE_MODELS));
        }
    }

    /// What `any` or `each` ranges over.
    fn group(&mut self, used: &Use) {
        if self.index.facts(used.name).definition(Namespace::Group).is_none() {
            let nearest = self.nearest(used.name, Namespace::Group);
            self.push(fleet::unknown_group(self.text(used.name), used.span, nearest.as_deref()));
        }
    }

    /// A resource of a vehicle, `R1.battery`.
    fn own_resource(&mut self, used: &Use, owner: &str, part: &str) {
        if self.index.equipment(self.names, used.name).is_some_and(|own| own.initial.is_none()) {
            return;
        }
        let name = self.text(used.name);
        let diagnostic = self.unknown_equipment(name, owner, part, "resource", used.span);
        self.push_once(Namespace::Resource, used.name, diagnostic);
    }

    /// A resource or a state that a vehicle does not have, or whose vehicle is not declared.
    pub(super) fn unknown_equipment(
        &mut self,
        name: &str,
        owner: &str,
        part: &str,
        what: &str,
        span: Span,
    ) -> Diagnostic {
        let symbol = self.names.find(owner);
        let vehicle = symbol.and_then(|owner| self.index.definition(Namespace::Vehicle, owner));
        let Some(vehicle) = vehicle else {
            let nearest = symbol.and_then(|owner| self.nearest(owner, Namespace::Vehicle));
            let owner_span = Span::new(span.start, span.end - (name.len() - owner.len()) as u32);
            return undefined::place(owner, owner_span, nearest.as_deref());
        };
        let model = vehicle.model.map_or("NAME", |model| self.text(model));
        fleet::unknown_equipment(owner, part, model, what, span)
    }

    fn resource(&mut self, used: &Use, change: Change) {
        if let Some((owner, part)) = self.text(used.name).split_once('.') {
            self.own_resource(used, owner, part);
            return;
        }
        if self.index.facts(used.name).definition(Namespace::Resource).is_none() {
            let nearest = self.nearest(used.name, Namespace::Resource);
            let (name, start) = (self.text(used.name), self.summary.start);
            let diagnostic = undefined::resource(name, used.span, change, nearest.as_deref(), start);
            self.push_once(Namespace::Resource, used.name, diagnostic);
        }
    }

    /// What a bound between events names is named somewhere.
    fn occurrence(&mut self, used: &Use) {
        if self.index.facts(used.name).occurrences == 0 {
            let nearest = self.nearest(used.name, Namespace::Occurrence);
            self.push(undefined::occurrence(self.text(used.name), used.span, nearest.as_deref()));
        }
    }

    /// A name in an expression that no parameter explains.
    fn number(&mut self, used: &Use) {
        if self.index.facts(used.name).definition(Namespace::Constant).is_some() {
            return;
        }
        let nearest = self.nearest(used.name, Namespace::Constant);
        let name = self.text(used.name);
        self.push(unknown_name::unknown(name, used.span, &self.summary.numbers, nearest.as_deref()));
    }
}

const fn is_unused(namespace: Namespace, facts: &Facts) -> bool {
    match namespace {
        Namespace::Callable => facts.calls == 0,
        Namespace::Variable => facts.literals == 0 && facts.arguments == 0,
        Namespace::Constant => facts.arguments + facts.numbers == 0,
        Namespace::Location => facts.arguments + facts.starts + facts.places == 0,
        Namespace::Resource => facts.resources + facts.arguments == 0,
        _ => false,
    }
}
