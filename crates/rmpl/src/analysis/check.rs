//! What one declaration says wrongly in view of the rest of the file.

use exact::Bound;

use super::index::{DeclarationKey, Facts, Index, Namespace, Told};
use super::names::{Names, Symbol};
use super::structure;
use super::summary::{Call, Definition, Literal, Summary, Use, UseKind};
use crate::diagnostic::{Diagnostic, Known, Severity};
use crate::diagnostics::{
    arity, bounds, duplicate, similar, support, traverse, undefined, unknown_name, unused, value,
};
use crate::lower::Item;
use crate::program::LabelMode;

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
    let mut checker = Checker { summary, names, index, checked };
    if let Some(definition) = &summary.definition {
        checker.definition(key, definition);
    }
    for (number, call) in summary.calls.iter().enumerate() {
        checker.call(number as u32, call);
    }
    for literal in &summary.literals {
        checker.literal(literal);
    }
    for used in &summary.uses {
        checker.name_use(used);
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
    checker.checked
}

/// What names mean in this file.
#[derive(Clone, Copy)]
pub(crate) struct Meaning<'a> {
    pub(crate) names: &'a Names,
    pub(crate) index: &'a Index,
}

impl Meaning<'_> {
    /// The domain of a declared variable.
    pub(crate) fn domain(&self, variable: Symbol) -> Option<&[Symbol]> {
        self.index.definition(Namespace::Variable, variable).map(|definition| definition.values.as_slice())
    }

    /// Whether `X_V`, with `X` and `V` given, is about `X` (SPEC 1.3).
    pub(crate) fn splits(&self, whole: Symbol, (variable, value): (Symbol, Symbol)) -> bool {
        self.domain(whole).is_none()
            && match self.domain(variable) {
                Some(domain) => domain.contains(&value),
                None => self.index.facts(variable).compared > 0,
            }
    }
}

struct Checker<'a> {
    summary: &'a Summary,
    names: &'a Names,
    index: &'a Index,
    checked: Checked,
}

impl<'a> Checker<'a> {
    const fn meaning(&self) -> Meaning<'a> {
        Meaning { names: self.names, index: self.index }
    }

    fn push(&mut self, diagnostic: Diagnostic) {
        self.checked.diagnostics.push((None, diagnostic));
    }

    fn push_once(&mut self, namespace: Namespace, name: Symbol, diagnostic: Diagnostic) {
        self.checked.diagnostics.push((Some((namespace, name)), diagnostic));
    }

    fn text(&self, symbol: Symbol) -> &'a str {
        self.names.text(symbol)
    }

    fn nearest(&mut self, written: Symbol, namespace: Namespace) -> Option<smol_str::SmolStr> {
        self.checked.depends_on_names |= namespace.bit();
        self.names.nearest(written, self.index.defined(namespace).iter().copied())
    }

    fn definition(&mut self, key: DeclarationKey, definition: &Definition) {
        let facts = self.index.facts(definition.name);
        let rivals = facts.definitions.iter().filter(|(namespace, _)| *namespace == definition.namespace);
        if rivals.count() > 1 && self.index.first_key(definition.namespace, definition.name) != Some(key) {
            let name = self.text(definition.name);
            self.push(duplicate::declaration(definition.namespace, name, definition.span));
            return;
        }
        if self.index.scenarios > 0 && is_unused(definition.namespace, facts) {
            let what = match definition.namespace {
                Namespace::Callable if definition.is_activity => "activity",
                Namespace::Callable => "primitive",
                Namespace::Variable => "variable",
                Namespace::Constant => "constant",
                _ => "location",
            };
            self.push(unused::unused(what, self.text(definition.name), definition.span));
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
        if let (Some((written, span)), Some(declared)) = (call.bounds, definition.bounds) {
            let lower = written.0.max(declared.0);
            let upper = written.1.min(declared.1);
            if Bound::Finite(lower) > upper {
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
        let diagnostic = undefined::call(self.text(call.name), call, nearest.as_deref(), is_strict);
        if nearest.is_some() {
            self.push(diagnostic);
        } else {
            self.push_once(Namespace::Callable, call.name, diagnostic);
        }
    }

    fn traverse(&mut self, number: u32, call: &Call) {
        let arguments: Vec<Use> =
            self.summary.uses.iter().filter(|used| used.kind == UseKind::Argument(number)).copied().collect();
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
            UseKind::Argument(_) | UseKind::HeaderBound => return,
            UseKind::Number => {
                self.number(used);
                return;
            }
            UseKind::Start => (Namespace::Location, "location"),
            UseKind::Vehicle => (Namespace::Vehicle, "vehicle"),
        };
        if self.index.facts(used.name).definition(namespace).is_none() {
            let nearest = self.nearest(used.name, namespace);
            let is_strict = self.index.is_strict();
            let diagnostic =
                undefined::world(what, self.text(used.name), used.span, nearest.as_deref(), is_strict);
            self.push_once(namespace, used.name, diagnostic);
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

    fn literal(&mut self, literal: &Literal) {
        let is_call =
            literal.is_bare && self.index.facts(literal.variable).definition(Namespace::Callable).is_some();
        if is_call || literal.variable_is_formal {
            return;
        }
        let (variable, value) = self.resolve(literal);
        match self.meaning().domain(variable) {
            Some(domain) => {
                if !self.values_fit(literal, variable, value, domain) {
                    return;
                }
            }
            None => self.undeclared_variable(literal, variable),
        }
        self.support(literal, variable, value);
    }

    /// The variable and value of a literal; an atom has no value.
    fn resolve(&self, literal: &Literal) -> (Symbol, Option<Symbol>) {
        match (literal.values.first(), literal.split) {
            (Some(&(value, _)), _) => (literal.variable, Some(value)),
            (None, Some((variable, value))) if self.meaning().splits(literal.variable, (variable, value)) => {
                (variable, Some(value))
            }
            _ => (literal.variable, None),
        }
    }

    fn values_fit(
        &mut self,
        literal: &Literal,
        variable: Symbol,
        value: Option<Symbol>,
        domain: &[Symbol],
    ) -> bool {
        if literal.value_is_formal {
            return true;
        }
        let is_value = |value: Symbol| domain.contains(&value);
        let wrong = literal.values.iter().find(|(value, _)| !is_value(*value));
        let fits = match value {
            Some(value) => wrong.is_none() && is_value(value),
            None => self.names.find("true").is_some_and(is_value),
        };
        if !fits {
            let values: Vec<&str> = domain.iter().map(|&value| self.text(value)).collect();
            let name = self.text(variable);
            let diagnostic = match wrong {
                Some(&(value, span)) => {
                    let nearest = self.names.nearest(value, domain.iter().copied());
                    value::outside_domain(name, self.text(value), span, &values, nearest.as_deref())
                }
                None => value::no_value(name, literal.variable_span, &values),
            };
            self.push(diagnostic);
        }
        fits
    }

    /// An undeclared name that looks like a declared variable.
    fn undeclared_variable(&mut self, literal: &Literal, variable: Symbol) {
        let written = self.text(literal.variable);
        if let Some((stem, value)) = literal.split.filter(|_| literal.values.is_empty()) {
            if let Some(domain) = self.meaning().domain(stem) {
                let values: Vec<&str> = domain.iter().map(|&value| self.text(value)).collect();
                self.push(similar::value(written, self.text(stem), &values, literal.variable_span));
                return;
            }
            if let Some(nearest) = self.nearest(stem, Namespace::Variable) {
                let mended = format!("{nearest}_{}", self.text(value));
                self.push(similar::variable(written, &mended, literal.variable_span));
                return;
            }
        }
        if literal.is_bare
            && let Some(nearest) = self.nearest(variable, Namespace::Callable)
        {
            self.push(similar::callable(written, &nearest, literal.variable_span));
            return;
        }
        if let Some(nearest) = self.nearest(variable, Namespace::Variable) {
            self.push(similar::variable(written, &nearest, literal.variable_span));
        }
    }

    /// An Ask that no Tell of the file can support.
    fn support(&mut self, literal: &Literal, variable: Symbol, value: Option<Symbol>) {
        let is_checkable = literal.mode == LabelMode::Ask
            && !literal.value_is_formal
            && self.index.scenarios > 0
            && self.index.told_of_formals == 0;
        if !is_checkable {
            return;
        }
        let meaning = self.meaning();
        let domain = meaning.domain(variable);
        let is_about = |told: &Told| {
            !told.is_split
                || told.value.is_some_and(|value| match domain {
                    Some(domain) => domain.contains(&value),
                    None => self.index.facts(variable).compared > 0,
                })
        };
        let supports = |told: &Told| {
            let among = |told: &Told| literal.values.iter().any(|&(value, _)| told.value == Some(value));
            told.is_any
                || (literal.values.len() > 1 && told.negated == literal.negated && among(told))
                || match (told.negated, literal.negated) {
                    (false, false) | (true, true) => told.value == value,
                    (false, true) => told.value != value,
                    (true, false) => leaves_only(domain, told.value, value),
                }
        };
        let told = &self.index.facts(variable).told;
        if !told.iter().any(|told| is_about(told) && supports(told)) {
            self.push(support::never(literal, self.text(literal.variable), self.names));
        }
    }
}

/// Whether a variable of this domain that is not `denied` must be `asked`.
fn leaves_only(domain: Option<&[Symbol]>, denied: Option<Symbol>, asked: Option<Symbol>) -> bool {
    let Some(&[one, other]) = domain else { return false };
    (denied, asked) == (Some(one), Some(other)) || (denied, asked) == (Some(other), Some(one))
}

const fn is_unused(namespace: Namespace, facts: &Facts) -> bool {
    match namespace {
        Namespace::Callable => facts.calls == 0,
        Namespace::Variable => facts.literals == 0 && facts.arguments == 0,
        Namespace::Constant => facts.arguments + facts.numbers == 0,
        Namespace::Location => facts.arguments == 0 && facts.starts == 0,
        _ => false,
    }
}
