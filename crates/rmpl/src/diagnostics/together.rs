//! `W-START`: parallel branches conflict at their start (SPEC 3.3).

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::program::{Condition, LabelMode};
use crate::span::Span;

pub const CODE: Code = Code("W-START");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "parallel branches conflict at their start",
    meaning: "Parallel branches start at the same instant. Two of these branches start with conditions that cannot be true
together, so the planner cannot order them.",
    example: "scenario Day[0,60] = { ARM=DIG [5,5], ARM=LIFT [5,5] }",
    fix: "Start one branch with `delay[0,inf]`, so that the planner can delay it.",
    mended: "scenario Day[0,60] = { ARM=DIG [5,5], { delay[0,inf]; ARM=LIFT [5,5] } }",
};

/// Two conditions that hold from the start of two branches; `later` is the second branch.
pub(crate) fn conflict(pair: [(LabelMode, &Condition); 2], later: Span) -> Diagnostic {
    let [one, other] = pair.map(|(mode, condition)| describe(mode, condition));
    let message =
        format!("{other} conflicts with {one}: both start at the same instant, when the branches start");
    let fix = Fix {
        label: "Start this branch with `delay[0,inf]`".to_owned(),
        edits: vec![
            Edit { span: Span::new(later.start, later.start), text: "{ delay[0,inf]; ".to_owned() },
            Edit { span: Span::new(later.end, later.end), text: " }".to_owned() },
        ],
    };
    Diagnostic::warning(CODE, pair[1].1.span, message)
        .with_hint(
            "parallel branches start together; add a delay to one of them so that the planner can order them",
        )
        .with_fix(fix)
}

fn describe(mode: LabelMode, condition: &Condition) -> String {
    let mut text = condition.variable.text.to_string();
    match condition.values.as_slice() {
        [] => {}
        [value] => text = format!("{text}={}", value.text),
        values => {
            let values: Vec<&str> = values.iter().map(|value| value.text.as_str()).collect();
            text = format!("{text} in {{{}}}", values.join(", "));
        }
    }
    if condition.negated {
        text = format!("not({text})");
    }
    match mode {
        LabelMode::Ask => format!("the need for `{text}`"),
        LabelMode::Tell => format!("`{text}`"),
    }
}
