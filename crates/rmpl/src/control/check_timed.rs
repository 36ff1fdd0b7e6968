//! The numbers of forms in time: durations, factors, probabilities and rewards (SPEC 8.5).

use exact::Rational;

use crate::diagnostic::{Code, Diagnostic};
use crate::diagnostics::{bounds, duplicate, probability};

use super::duration::{Duration, DurationError, units};
use super::probabilities::{positive, weights};
use super::suggest::nearest;
use super::syntax::{ControlFile, Expression, ExpressionKind, Guard, Name};

/// Returns what is wrong with the lengths of a step that a text names.
pub(super) fn check_steps(file: &ControlFile) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = Vec::new();
    for (at, step) in file.steps.iter().enumerate() {
        if at > 0 {
            found.push(duplicate::step_length(step.span));
        } else if let Some(diagnostic) = duration(step) {
            found.push(diagnostic);
        } else if Duration::read(&step.text).is_ok_and(|length| length.seconds().is_none()) {
            let message = format!("the length of a step needs a unit, but `{}` has none", step.text);
            let hint = format!("write one of {} after the number, as in `100ms`", units().join(", "));
            found.push(Diagnostic::error(Code("E-SYNTAX"), step.span, message).with_hint(hint));
        }
    }
    found
}

/// Returns what is wrong with the numbers that an expression names itself; those that `is_open` says represent others
/// are left out.
pub(super) fn check_numbers(expression: &Expression, is_open: &dyn Fn(&Name) -> bool) -> Vec<Diagnostic> {
    let durations = expression.durations().into_iter().filter(|name| !is_open(name));
    let mut found: Vec<Diagnostic> = durations.filter_map(duration).collect();
    match &expression.kind {
        ExpressionKind::Warp { factor, .. } if !is_open(factor) => match factor.text.parse::<Rational>() {
            Ok(value) if value > Rational::ZERO => {}
            Ok(_) => found.push(bounds::factor(&factor.text, factor.span)),
            Err(_) if factor.text.parse() == Ok(exact::Bound::Infinite) => {
                found.push(bounds::factor(&factor.text, factor.span));
            }
            Err(_) => found.push(no_number("WARP", factor)),
        },
        ExpressionKind::Reward(reward) if !is_open(reward) && reward.text.parse::<Rational>().is_err() => {
            found.push(no_number("REWARD", reward));
        }
        ExpressionKind::ChooseReward(alternatives) => {
            let rewards = alternatives.iter().map(|alternative| &alternative.weight);
            let wrong = rewards.filter(|reward| !is_open(reward) && reward.text.parse::<Rational>().is_err());
            found.extend(wrong.map(|reward| no_number("CHOOSE-REWARD", reward)));
        }
        ExpressionKind::ChooseProb(alternatives) => {
            let given: Vec<&Name> = alternatives.iter().map(|alternative| &alternative.weight).collect();
            let wrong = given.iter().filter(|one| !is_open(one) && positive(&one.text).is_none());
            let before = found.len();
            found.extend(wrong.map(|one| probability::of_alternative(&one.text, one.span)));
            if found.len() == before && !given.iter().any(|one| is_open(one)) {
                found.extend(sum(&given));
            }
        }
        _ => {}
    }
    found
}

/// Returns what is wrong with the duration of a guard that is handed to a definition.
pub(super) fn check_held(guard: &Guard, is_open: &dyn Fn(&Name) -> bool) -> Option<Diagnostic> {
    let held = guard.held.as_ref().filter(|held| !is_open(&held.duration))?;
    duration(&held.duration)
}

fn sum(given: &[&Name]) -> Option<Diagnostic> {
    let (first, last) = (given.first()?, given.last()?);
    let texts: Vec<&str> = given.iter().map(|one| one.text.as_str()).collect();
    let sum = weights(&texts).and_then(|(weights, common)| {
        let sum = weights.iter().map(|weight| i128::from(*weight)).sum();
        Rational::from_wide(sum, i128::from(common))
    });
    (sum != Some(Rational::ONE)).then(|| {
        let sum = sum.map(|sum| sum.to_string());
        probability::sum_of_alternatives(sum.as_deref(), first.span.cover(last.span))
    })
}

fn duration(name: &Name) -> Option<Diagnostic> {
    let error = Duration::read(&name.text).err()?;
    Some(match error {
        DurationError::Bounds => bounds::duration(&name.text, name.span),
        DurationError::TooLarge => bounds::too_long(name.span),
        DurationError::Unit => {
            let word = name.text.trim_start_matches(|c: char| !c.is_alphabetic());
            let known = units();
            let hint = nearest(word, known.iter().copied()).map_or_else(
                || format!("use one of {}", known.join(", ")),
                |unit| format!("did you mean `{unit}`?"),
            );
            Diagnostic::error(Code("E-SYNTAX"), name.span, format!("unknown unit of time `{word}`"))
                .with_hint(hint)
        }
        DurationError::Form => {
            let message = format!("expected a duration, found `{}`", name.text);
            Diagnostic::error(Code("E-SYNTAX"), name.span, message)
                .with_hint("write a number with a unit, such as `5s` or `100ms`, or a number of steps")
        }
    })
}

fn no_number(form: &str, name: &Name) -> Diagnostic {
    let message = format!("{form} takes a number, not `{}`", name.text);
    Diagnostic::error(Code("E-SYNTAX"), name.span, message)
        .with_hint("write a decimal or a fraction, such as `2.5` or `5/2`")
}
