//! What a statement will compile to, known before it is compiled: a single arc, one instance, a decision first.

use rmpl::program::{ArgumentValue, Condition, LabelMode, MembersForm, Name, Statement, StatementKind};

use super::expander::Expander;
use super::scope::Scope;

impl Expander<'_> {
    /// Returns whether the piece will be a single arc that can carry a label itself.
    pub(super) fn is_single_arc(&self, statement: &Statement, scope: &Scope) -> bool {
        match &statement.kind {
            StatementKind::Delay => true,
            StatementKind::Condition(mode, condition) => self
                .called_formal(*mode, condition, scope)
                .is_none_or(|name| !self.activities.contains_key(scope.name(&name.text).as_str())),
            StatementKind::Call(name, _) => !self.activities.contains_key(scope.name(&name.text).as_str()),
            StatementKind::Sequence(items) => match items.as_slice() {
                [only] => statement.bounds.is_none() && self.is_single_arc(only, scope),
                _ => false,
            },
            StatementKind::Maintaining(body, _)
            | StatementKind::Watching(body, _)
            | StatementKind::Telling(body, _)
            | StatementKind::Named(body, _)
            | StatementKind::Using(body, ..) => statement.bounds.is_none() && self.is_single_arc(body, scope),
            StatementKind::Parallel(_)
            | StatementKind::Unordered(_)
            | StatementKind::Choose(_)
            | StatementKind::IfThennext(..)
            | StatementKind::Members(_)
            | StatementKind::Repeat(..) => false,
        }
    }

    /// Returns whether the piece will be one instance of a defined activity, whose name the interval can carry.
    pub(super) fn is_instance(&self, statement: &Statement, scope: &Scope) -> bool {
        match &statement.kind {
            StatementKind::Call(name, _) => self.activities.contains_key(scope.name(&name.text).as_str()),
            StatementKind::Condition(mode, condition) => self
                .called_formal(*mode, condition, scope)
                .is_some_and(|name| self.activities.contains_key(scope.name(&name.text).as_str())),
            StatementKind::Sequence(items) => match items.as_slice() {
                [only] => statement.bounds.is_none() && self.is_instance(only, scope),
                _ => false,
            },
            StatementKind::Named(body, _) => statement.bounds.is_none() && self.is_instance(body, scope),
            _ => false,
        }
    }

    /// A bare name that is a formal and represents an activity is a call of it (SPEC 1.3, 1.4).
    pub(super) fn called_formal(
        &self,
        mode: LabelMode,
        condition: &Condition,
        scope: &Scope,
    ) -> Option<Name> {
        if mode != LabelMode::Tell || condition.negated || !condition.values.is_empty() {
            return None;
        }
        let Some(ArgumentValue::Name(callee)) = scope.argument(&condition.variable.text) else { return None };
        let takes_none = match (self.activities.get(callee.as_str()), self.primitives.get(callee.as_str())) {
            (Some(activity), _) => activity.formals.is_empty(),
            (None, Some(primitive)) => primitive.formals.is_empty(),
            (None, None) => false,
        };
        takes_none.then(|| condition.variable.clone())
    }
}

/// Returns whether the first node of the piece will be a decision; `is_bounded_outside` when its bounds are already
/// dealt with.
pub(super) fn starts_with_decision(statement: &Statement, is_bounded_outside: bool) -> bool {
    if statement.bounds.is_some() && !is_bounded_outside {
        return false;
    }
    match &statement.kind {
        StatementKind::Choose(alternatives) => !alternatives.is_empty(),
        StatementKind::Sequence(items) => {
            items.first().is_some_and(|first| starts_with_decision(first, false))
        }
        StatementKind::Members(members) => match members.form {
            MembersForm::Any => true,
            MembersForm::Sequence => starts_with_decision(&members.body, false),
            MembersForm::Parallel | MembersForm::Unordered => false,
        },
        // If there are no copies at all, the nodes around nothing do no harm.
        StatementKind::Repeat(_, body) | StatementKind::Named(body, _) => starts_with_decision(body, false),
        _ => false,
    }
}
