//! Equality of two variables in a program, written out over the values that they share (SPEC 2.2).

use rmpl::Code;
use rmpl::Diagnostic;
use rmpl::control::{Constraint, ConstraintKind, Expression, Name};
use smol_str::SmolStr;

use crate::vocabulary::Vocabulary;

/// Replaces `(x = y)`, where y is no value of x but another variable of its domain, by what it means.
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
            // A definition that is called twice has one mistake.
            if !found.iter().any(|known| known.span == value.span) {
                found.push(different(variable, value));
            }
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

fn different(variable: &Name, other: &Name) -> Diagnostic {
    let message = format!("`{}` and `{}` have different domains", variable.text, other.text);
    Diagnostic::error(Code("E-VALUE"), other.span, message)
        .with_hint("two variables can be equal if they have the same values")
}
