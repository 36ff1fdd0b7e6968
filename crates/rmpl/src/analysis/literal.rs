//! What is wrong with a condition or an effect in view of the rest of the file.

use super::check::Checker;
use super::index::{MAX_COMPARED, Namespace, Told};
use super::names::Symbol;
use super::summary::{Literal, Origin, Vehicle};
use crate::diagnostics::{similar, support, undefined, value};
use crate::program::{LabelMode, component_of_state};

impl Checker<'_> {
    pub(super) fn literal(&mut self, literal: &Literal) {
        let is_call =
            literal.is_bare && self.index.facts(literal.variable).definition(Namespace::Callable).is_some();
        if is_call || literal.variable_is_formal {
            return;
        }
        if literal.is_sight && !self.is_place_asked(literal) {
            return;
        }
        if let Some(vehicle) = literal.vehicle {
            self.place_of(literal, vehicle);
            return;
        }
        let (variable, value) = self.resolve(literal);
        if self.meaning().is_unknown_component(variable) {
            return;
        }
        if let Some((owner, part)) = self.text(variable).split_once('.')
            && part != "mode"
            && self.meaning().own_state(variable).is_none()
        {
            let name = self.text(variable);
            let diagnostic = self.unknown_equipment(name, owner, part, "state", literal.variable_span);
            self.push_once(Namespace::Variable, variable, diagnostic);
            return;
        }
        let is_of_component = component_of_state(self.text(variable)).is_some();
        if (literal.origin == Origin::Effect || is_of_component) && !self.meaning().is_state(variable) {
            self.no_state(literal);
            return;
        }
        match self.meaning().domain(variable) {
            Some(domain) => {
                if !self.values_fit(literal, variable, value, domain)
                    || (self.meaning().is_state(variable)
                        && self.is_no_change(literal, variable, value, domain))
                {
                    return;
                }
            }
            None => self.undeclared_variable(literal, variable),
        }
        self.support(literal, variable, value);
    }

    /// Returns whether `in visible(…)` follows the place of a vehicle and is a requirement, which is all that it can
    /// be.
    fn is_place_asked(&mut self, literal: &Literal) -> bool {
        let is_told = literal.mode == LabelMode::Tell && literal.origin == Origin::Written;
        let name = self.text(literal.variable);
        if literal.vehicle.is_none() {
            let is_vehicle = self.index.facts(literal.variable).definition(Namespace::Vehicle).is_some();
            self.push(value::sight_of_no_place(name, literal.variable_span, is_vehicle));
        } else if is_told {
            self.push(value::sight_told(name, literal.span));
        }
        literal.vehicle.is_some() && !is_told
    }

    /// A condition on the place of a vehicle, which is a state variable.
    fn place_of(&mut self, literal: &Literal, vehicle: Vehicle) {
        let definition = self.index.facts(vehicle.name).definition(Namespace::Vehicle);
        if definition.is_none() && !vehicle.is_formal {
            let nearest = self.nearest(vehicle.name, Namespace::Vehicle);
            let diagnostic = undefined::place(self.text(vehicle.name), vehicle.span, nearest.as_deref());
            self.push_once(Namespace::Vehicle, vehicle.name, diagnostic);
            return;
        }
        if self.is_no_change(literal, literal.variable, None, &[]) || vehicle.is_formal || literal.is_sight {
            return;
        }
        self.support(literal, literal.variable, literal.values.first().map(|&(value, _)| value));
    }

    /// An assertion about a state variable, which changes it, names the one value that it gets.
    fn is_no_change(
        &mut self,
        literal: &Literal,
        variable: Symbol,
        value: Option<Symbol>,
        domain: &[Symbol],
    ) -> bool {
        let is_told = literal.mode == LabelMode::Tell && literal.origin == Origin::Written;
        let is_single = !literal.negated && literal.values.len() < 2;
        if !is_told || is_single {
            return false;
        }
        let atom = value.or_else(|| self.names.find("true")).filter(|_| literal.values.is_empty());
        let named =
            |value: &Symbol| atom == Some(*value) || literal.values.iter().any(|(other, _)| other == value);
        let possible = domain.iter().filter(|value| named(value) != literal.negated);
        let values: Vec<&str> = possible.map(|&value| self.text(value)).collect();
        self.push(value::no_single_value(self.text(variable), &values, literal.span));
        true
    }

    /// An effect on what is not a state variable.
    fn no_state(&mut self, literal: &Literal) {
        let name = self.text(literal.variable);
        if self.is_told(Namespace::Variable, literal.variable) {
            return;
        }
        if self.meaning().domain(literal.variable).is_some() {
            self.push(undefined::effect_on_variable(name, literal.variable_span));
            return;
        }
        let nearest = self.nearest(literal.variable, Namespace::Variable);
        let nearest = nearest.filter(|nearest| {
            self.names.find(nearest).is_some_and(|nearest| self.meaning().is_state(nearest))
        });
        let own = literal.values.first().filter(|_| !literal.value_is_formal).map(|&(value, _)| value);
        let told = self.index.facts(literal.variable).told.keys().filter(|told| !told.is_any);
        let told = told.filter_map(|told| told.value);
        let here = self.summary.literals.iter().filter(|other| other.variable == literal.variable);
        let here = here.filter(|other| !other.value_is_formal).flat_map(|other| &other.values);
        let values = own.into_iter().chain(told).chain(here.map(|&(value, _)| value));
        let mut values: Vec<&str> = values.map(|value| self.text(value)).collect();
        values.sort_unstable();
        values.dedup();
        let set = own.map(|value| self.text(value));
        let start = self.summary.start;
        let diagnostic =
            undefined::state(name, literal.variable_span, &values, set, nearest.as_deref(), start);
        self.push_once(Namespace::Variable, literal.variable, diagnostic);
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
                    let nearest = self.names.nearest(value, domain.iter().copied().take(MAX_COMPARED));
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
        let meaning = self.meaning();
        // What keeps a watched value of a state variable away is a requirement.
        let is_state = literal.vehicle.is_some() || meaning.is_state(variable);
        let is_asked = literal.mode == LabelMode::Ask || (is_state && literal.origin == Origin::Watched);
        let is_checkable = is_asked
            && !literal.value_is_formal
            && self.index.scenarios > 0
            && self.index.told_of_formals == 0;
        if !is_checkable {
            return;
        }
        let first = match literal.vehicle {
            Some(vehicle) => {
                let is_moved = self.index.facts(vehicle.name).vehicles > 0 || self.index.moves_of_formals > 0;
                if is_moved {
                    return;
                }
                self.index.definition(Namespace::Vehicle, vehicle.name)
            }
            None => self.index.definition(Namespace::Variable, variable),
        };
        let own = meaning.own_state(variable).and_then(|state| state.initial);
        let initial = first.and_then(|definition| definition.initial).or(own).map(Told::at_first);
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
        // Most conditions are asserted as they are asked; only the others are compared with all that is asserted.
        let as_asked =
            Told { value, negated: literal.negated, is_split: false, is_any: false, is_watched: false };
        if told.contains_key(&as_asked) {
            return;
        }
        let mut changes = told.keys().filter(|told| !(is_state && told.is_watched));
        if !initial.as_ref().is_some_and(supports) && !changes.any(|told| is_about(told) && supports(told)) {
            self.push(support::never(literal, self.text(literal.variable), is_state, self.names));
        }
    }
}

/// Returns whether a variable of this domain that is not `denied` must be `asked`.
fn leaves_only(domain: Option<&[Symbol]>, denied: Option<Symbol>, asked: Option<Symbol>) -> bool {
    let Some(&[one, other]) = domain else { return false };
    (denied, asked) == (Some(one), Some(other)) || (denied, asked) == (Some(other), Some(one))
}
