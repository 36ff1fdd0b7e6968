//! What the names of an expanded body mean: the arguments and bound parameters of the activity instance around it.

use exact::{Bound, Time};
use rmpl::program::{Argument, ArgumentValue, Name};
use smol_str::{SmolStr, format_smolstr};

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
    /// Of an instance whose formals stand for `arguments`; formals without an argument stand for themselves.
    pub(super) fn new(
        occurrence: Option<OccurrenceId>,
        formals: &[Name],
        arguments: &[ArgumentValue],
    ) -> Self {
        let pairs = formals.iter().zip(arguments).map(|(formal, value)| (formal.text.clone(), value.clone()));
        Self { occurrence, arguments: pairs.collect(), bounds: Vec::new() }
    }

    /// Binds a bound parameter.
    pub(super) fn bind(&mut self, parameter: &SmolStr, bound: Bound) {
        self.bounds.push((parameter.clone(), bound));
    }

    /// The argument that a name stands for, if it is a formal.
    pub(super) fn argument(&self, name: &str) -> Option<ArgumentValue> {
        self.arguments.iter().find(|(formal, _)| formal == name).map(|(_, value)| value.clone())
    }

    /// The bound that a name stands for: a bound parameter, or a formal whose argument is a number.
    pub(super) fn bound(&self, name: &str) -> Option<Bound> {
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

    /// The arguments of a call after substitution.
    pub(super) fn arguments(&self, arguments: &[Argument]) -> Vec<ArgumentValue> {
        let substituted = arguments.iter().map(|argument| match &argument.value {
            ArgumentValue::Name(name) => self.argument(name).unwrap_or_else(|| argument.value.clone()),
            ArgumentValue::Number(_) => argument.value.clone(),
        });
        substituted.collect()
    }
}

/// An argument as text.
pub(super) fn argument_text(argument: &ArgumentValue) -> SmolStr {
    match argument {
        ArgumentValue::Name(name) => name.clone(),
        ArgumentValue::Number(number) => format_smolstr!("{number}"),
    }
}
