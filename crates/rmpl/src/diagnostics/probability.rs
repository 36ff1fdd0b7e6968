//! `E-PROBABILITY`: a probability outside what is allowed. The prefix notation reports it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-PROBABILITY");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "invalid probability",
    meaning: "Each probability of a prior is above 0 and at most 1, and all of one component sum to 1. The option `entailment` of a
control program is above 0.5 and at most 1, so that a condition and its opposite are never both known. The alternatives of
`CHOOSE-PROB` have probabilities above 0 that sum to 1. In a plant model, the faults of a mode that are possible together, and the
outcomes of a guard, sum to at most 1.",
    example: "(DEFOPTION entailment 0.5)
(WHEN-DONEXT (EngineA = Standby) (Camera = Off))",
    fix: "Write a probability in this range, as a decimal or a fraction.",
    mended: "(DEFOPTION entailment 0.95)
(WHEN-DONEXT (EngineA = Standby) (Camera = Off))",
};

/// An option `entailment` that is not a probability above one half.
pub(crate) fn not_an_entailment(text: &str, span: Span) -> Diagnostic {
    let message = format!("`entailment` must be a probability above 0.5 and at most 1, not `{text}`");
    Diagnostic::error(CODE, span, message)
        .with_hint("write a decimal or a fraction, such as `0.95` or `19/20`")
}

/// A part of a prior that is not a probability above zero.
pub(crate) fn outside(text: &str, span: Span) -> Diagnostic {
    let message = format!("the probability of a mode must be above 0 and at most 1, not `{text}`");
    Diagnostic::error(CODE, span, message).with_hint("write a decimal or a fraction, such as `0.1` or `1/3`")
}

/// A prior whose parts do not sum to one; `sum` is `None` if they have too many digits to be summed.
pub(crate) fn sum(component: &str, sum: Option<&str>, span: Span) -> Diagnostic {
    let message = match sum {
        Some(sum) => format!("the probabilities of the modes of `{component}` must sum to 1, not to {sum}"),
        None => format!("the probabilities of the modes of `{component}` have too many digits to be summed"),
    };
    Diagnostic::error(CODE, span, message).with_hint("name every mode in which the component may start")
}

/// A probability of a fault, an outcome or an ERROR that is none.
pub fn of_model(text: &str, span: Span) -> Diagnostic {
    let message = format!("a probability must be above 0 and at most 1, not `{text}`");
    Diagnostic::error(CODE, span, message)
        .with_hint("write a decimal or a fraction, such as `0.01` or `1/100`")
}

/// Faults of a mode that sum to more than one; `place` says where, such as `where V.cmd=open`.
pub fn faults(mode: &str, place: &str, span: Span) -> Diagnostic {
    let message =
        format!("the probabilities of the faults of `{mode}` must sum to at most 1, but exceed 1 {place}");
    Diagnostic::error(CODE, span, message)
}

/// Outcomes of one guard that sum to more than one.
pub fn outcomes(mode: &str, span: Span) -> Diagnostic {
    let message =
        format!("the probabilities of the outcomes of this guard in `{mode}` must sum to at most 1");
    Diagnostic::error(CODE, span, message)
}

/// Probabilities that cannot be calculated with exactly.
pub fn digits(class: &str, span: Span) -> Diagnostic {
    let message = format!("the probabilities of `{class}` have too many digits");
    Diagnostic::error(CODE, span, message)
        .with_hint("write fewer digits, or fractions with equal denominators")
}

/// An alternative of CHOOSE-PROB that can never be drawn, or always is beside others.
pub(crate) fn of_alternative(text: &str, span: Span) -> Diagnostic {
    let message = format!("the probability of an alternative must be above 0 and at most 1, not `{text}`");
    Diagnostic::error(CODE, span, message).with_hint("write a decimal or a fraction, such as `0.1` or `1/3`")
}

/// Alternatives of CHOOSE-PROB that do not sum to one; `sum` is `None` if they have too many digits to be summed.
pub(crate) fn sum_of_alternatives(sum: Option<&str>, span: Span) -> Diagnostic {
    let message = match sum {
        Some(sum) => format!("the probabilities of the alternatives must sum to 1, not to {sum}"),
        None => "the probabilities of the alternatives have too many digits to be summed".to_owned(),
    };
    Diagnostic::error(CODE, span, message)
}
