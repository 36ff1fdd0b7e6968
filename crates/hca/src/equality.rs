//! Equality of two variables in a program, written out over the values that they share (SPEC 2.2).

use rmpl::Diagnostic;
use rmpl::control::{Constraint, ConstraintKind, Expression, Name};
use rmpl::diagnostics::value::different_domains;
use smol_str::SmolStr;

use crate::vocabulary::Vocabulary;

/// Replaces each `(x = y)`, where y is another variable and not a value of x, by an `OR` over the shared values.
///
/// Returns an error for each two variables with different domains.
pub(crate) fn write_out(program: &mut Expression, vocabulary: &Vocabulary) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = Vec::new();
    program.change_constraints(&mut |constraint| {
        let ConstraintKind::Equals { variable, value } = &constraint.kind else { return };
        let Some(values) = vocabulary.domains.get(&variable.text) else { return };
        let Some(others) = vocabulary.domains.get(&value.text).filter(|_| !values.contains(&value.text))
        else {
            return;
        };
        if !has_all(values, others) || !has_all(others, values) {
            // A definition that is called twice has one error.
            different_domains(&variable.text, &value.text, value.span).add_once_to(&mut found);
            return;
        }
        let equals = |name: &Name, with: &SmolStr| Constraint {
            kind: ConstraintKind::Equals {
                variable: name.clone(),
                value: Name { text: with.clone(), span: value.span },
            },
            span: constraint.span,
        };
        let both = |with: &SmolStr| Constraint {
            kind: ConstraintKind::And(vec![equals(variable, with), equals(value, with)]),
            span: constraint.span,
        };
        constraint.kind = ConstraintKind::Or(values.iter().map(both).collect());
    });
    found
}

fn has_all(values: &[SmolStr], wanted: &[SmolStr]) -> bool {
    wanted.iter().all(|value| values.contains(value))
}
