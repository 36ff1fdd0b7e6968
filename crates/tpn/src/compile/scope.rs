//! What the names of an expanded body mean: the arguments and bound parameters of the activity instance around it.

use exact::{Bound, Rational, Time};
use rmpl::program::{ArgumentValue, Condition, DurationUnit, Name};
use smol_str::{SmolStr, format_smolstr};

use super::bounds::Values;
use super::constants::Constants;
use super::names::{Fact, substituted};
use crate::network::OccurrenceId;

/// The instance that a statement is expanded in.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    /// The activity or scenario instance.
    pub(super) occurrence: Option<OccurrenceId>,
    arguments: Vec<(SmolStr, ArgumentValue)>,
    bounds: Vec<(SmolStr, Bound)>,
}

impl Scope {
    /// Of an instance whose formals represent `arguments`; formals without an argument represent themselves.
    pub(super) fn new(
        occurrence: Option<OccurrenceId>,
        formals: &[Name],
        arguments: &[ArgumentValue],
    ) -> Self {
        let pairs = formals.iter().zip(arguments).map(|(formal, value)| (formal.text.clone(), value.clone()));
        Self { occurrence, arguments: pairs.collect(), bounds: Vec::new() }
    }

    /// The same where `variable` represents a member of a group.
    pub(super) fn with_member(&self, variable: &SmolStr, member: &SmolStr) -> Self {
        let mut inner = self.clone();
        inner.bounds.retain(|(parameter, _)| parameter != variable);
        inner.arguments.insert(0, (variable.clone(), ArgumentValue::Name(member.clone())));
        inner
    }

    /// Binds a bound parameter.
    pub(super) fn bind(&mut self, parameter: &SmolStr, bound: Bound) {
        self.bounds.push((parameter.clone(), bound));
    }

    /// The argument that a name represents, if it is a formal.
    pub(super) fn argument(&self, name: &str) -> Option<ArgumentValue> {
        self.arguments.iter().find(|(formal, _)| formal == name).map(|(_, value)| value.clone())
    }

    /// The finite bound parameter that a name is, handed on as a number.
    pub(super) fn number_argument(&self, name: &str) -> Option<ArgumentValue> {
        self.number(name)?.finite().map(|number| ArgumentValue::Number(number.units()))
    }

    /// A condition that is handed on, with the instance's own arguments in place of its formals.
    pub(super) fn condition(&self, condition: &Condition) -> Condition {
        let replace = |name: &Name| Name {
            text: substituted(&name.text, &|name| self.argument(name)),
            span: name.span,
        };
        if let Some(ArgumentValue::Condition(handed)) = self.argument(&condition.variable.text)
            && condition.values.is_empty()
            && condition.sees.is_none()
        {
            return Condition { negated: handed.negated != condition.negated, ..handed };
        }
        Condition {
            variable: replace(&condition.variable),
            values: condition.values.iter().map(replace).collect(),
            sees: condition.sees.as_ref().map(replace),
            ..condition.clone()
        }
    }

    /// The number that a name represents: a bound parameter, or a formal whose argument is a number.
    fn number(&self, name: &str) -> Option<Bound> {
        if let Some((_, bound)) = self.bounds.iter().find(|(parameter, _)| parameter == name) {
            return Some(*bound);
        }
        match self.argument(name) {
            Some(ArgumentValue::Number(number)) => Some(Bound::Finite(Time::from_units(number))),
            _ => None,
        }
    }

    /// The name after substitution.
    pub(super) fn name(&self, name: &SmolStr) -> SmolStr {
        match self.argument(name) {
            Some(ArgumentValue::Name(argument)) => argument,
            _ => name.clone(),
        }
    }

    /// A name of two parts, or of one, after substitution.
    pub(super) fn owned_name(&self, name: &SmolStr) -> SmolStr {
        substituted(name, &|name| self.argument(name))
    }

    /// Returns what expressions mean in this instance.
    pub(super) const fn values<'a>(&'a self, constants: &'a Constants<'a>) -> ScopeValues<'a> {
        ScopeValues { scope: self, constants }
    }
}

/// The numbers of an instance: its own names before the program's constants.
pub(super) struct ScopeValues<'a> {
    scope: &'a Scope,
    constants: &'a Constants<'a>,
}

impl Values for ScopeValues<'_> {
    fn number(&self, name: &str) -> Option<Bound> {
        self.scope.number(name).or_else(|| self.constants.number(name))
    }

    fn in_mission_units(&self, unit: DurationUnit) -> Option<Rational> {
        self.constants.in_mission_units(unit)
    }
}

/// An argument as text.
pub(super) fn argument_text(argument: &ArgumentValue) -> SmolStr {
    match argument {
        ArgumentValue::Name(name) => name.clone(),
        ArgumentValue::Number(number) => format_smolstr!("{number}"),
        // Expressions are evaluated before anything is done with them.
        ArgumentValue::Expression(_) => SmolStr::default(),
        ArgumentValue::Condition(condition) => Fact::written(condition).text(),
    }
}
