//! Options and priors: what is wrong with them, and what they say in numbers (SPEC 2.1, 2.2).

use exact::Rational;

use crate::diagnostic::Diagnostic;
use crate::diagnostics::{bounds, duplicate, option, probability};

use super::syntax::{ControlFile, FieldKind, Initial, Name};

const ENTAILMENT: &str = "entailment";
const HORIZON: &str = "horizon";
/// The options that a control program may have.
const OPTIONS: [&str; 2] = [ENTAILMENT, HORIZON];

const DEFAULT_HORIZON: u32 = 50;
const MAX_HORIZON: u32 = 10_000;

impl ControlFile {
    /// From which probability on a condition is entailed; `None` if it is entailed by holding in the most likely state.
    pub fn entailment(&self) -> Option<Rational> {
        let option = self.options.iter().find(|option| option.name.text == ENTAILMENT)?;
        threshold(&option.value.text)
    }

    /// Over how many steps CHOOSE-REWARD expects rewards.
    pub fn horizon(&self) -> u32 {
        let option = self.options.iter().find(|option| option.name.text == HORIZON);
        option.and_then(|option| steps(&option.value.text)).unwrap_or(DEFAULT_HORIZON)
    }
}

impl Initial {
    /// The modes that its prior names with their weights, which sum to what a probability of 1 weighs; empty without a
    /// prior, or with one that is wrong.
    pub fn prior(&self) -> Vec<(&str, u64)> {
        let Self::Prior(prior) = self else { return Vec::new() };
        let sums = |(weights, common): &(Vec<u64>, u64)| {
            weights.iter().map(|weight| u128::from(*weight)).sum::<u128>() == u128::from(*common)
        };
        let Some((weights, _)) = weights(&given(prior)).filter(sums) else { return Vec::new() };
        prior.iter().map(|(mode, _)| mode.text.as_str()).zip(weights).collect()
    }
}

fn given(prior: &[(Name, Name)]) -> Vec<&str> {
    prior.iter().map(|(_, given)| given.text.as_str()).collect()
}

/// The weights of probabilities, and their common denominator; `None` if some are wrong or too long.
pub fn weights(given: &[&str]) -> Option<(Vec<u64>, u64)> {
    let parts: Vec<Rational> = given.iter().map(|given| positive(given)).collect::<Option<_>>()?;
    let mut common = 1_u64;
    for part in &parts {
        let denominator = part.denominator().unsigned_abs();
        common = (common / greatest_common_divisor(common, denominator)).checked_mul(denominator)?;
    }
    let weight = |part: &Rational| {
        let scale = common / part.denominator().unsigned_abs();
        part.numerator().unsigned_abs().checked_mul(scale)
    };
    Some((parts.iter().map(weight).collect::<Option<_>>()?, common))
}

const fn greatest_common_divisor(left: u64, right: u64) -> u64 {
    if right == 0 { left } else { greatest_common_divisor(right, left % right) }
}

/// Returns what is wrong with the options and priors of a file.
pub(super) fn check(file: &ControlFile) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    for (at, option) in file.options.iter().enumerate() {
        if !OPTIONS.contains(&option.name.text.as_str()) {
            diagnostics.push(option::unknown_of_program(&option.name.text, option.name.span, &OPTIONS));
        } else if file.options.iter().take(at).any(|earlier| earlier.name.text == option.name.text) {
            diagnostics.push(duplicate::program_option(&option.name.text, option.name.span));
        } else if option.name.text == HORIZON {
            let is_wrong = steps(&option.value.text).is_none();
            diagnostics.extend(
                is_wrong.then(|| bounds::horizon(&option.value.text, MAX_HORIZON, option.value.span)),
            );
        } else if threshold(&option.value.text).is_none() {
            diagnostics.push(probability::not_an_entailment(&option.value.text, option.value.span));
        }
    }
    for instance in &file.instances {
        check_prior(&instance.name, &instance.initial, &mut diagnostics);
    }
    for field in file.classes.iter().flat_map(|class| &class.fields) {
        if let FieldKind::Part { name, initial, .. } = &field.kind {
            check_prior(name, initial, &mut diagnostics);
        }
    }
    diagnostics
}

fn check_prior(component: &Name, initial: &Initial, diagnostics: &mut Vec<Diagnostic>) {
    let Initial::Prior(prior) = initial else { return };
    let before = diagnostics.len();
    for (at, (mode, given)) in prior.iter().enumerate() {
        if prior.iter().take(at).any(|(earlier, _)| earlier.text == mode.text) {
            diagnostics.push(duplicate::mode_of_prior(&mode.text, mode.span));
        }
        if positive(&given.text).is_none() {
            diagnostics.push(probability::outside(&given.text, given.span));
        }
    }
    let (Some((first, _)), Some((_, last))) = (prior.first(), prior.last()) else { return };
    if diagnostics.len() > before {
        return;
    }
    let sum = weights(&self::given(prior)).and_then(|(weights, common)| {
        let sum = weights.iter().map(|weight| i128::from(*weight)).sum();
        Rational::from_wide(sum, i128::from(common))
    });
    if sum != Some(Rational::ONE) {
        let sum = sum.map(|sum| sum.to_string());
        diagnostics.push(probability::sum(&component.text, sum.as_deref(), first.span.cover(last.span)));
    }
}

/// A probability above 0.
pub(super) fn positive(text: &str) -> Option<Rational> {
    text.parse()
        .ok()
        .filter(|value| (Rational::ZERO..=Rational::ONE).contains(value) && *value != Rational::ZERO)
}

/// A number of steps that a horizon may have.
fn steps(text: &str) -> Option<u32> {
    text.parse().ok().filter(|steps| (1..=MAX_HORIZON).contains(steps))
}

/// A probability above one half: two contradicting conditions are never both entailed.
fn threshold(text: &str) -> Option<Rational> {
    let half = Rational::new(1, 2)?;
    positive(text).filter(|value| *value > half)
}
