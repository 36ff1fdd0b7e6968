//! `W-START`: parallel branches that conflict because they start together (SPEC 3.3).

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::program::{Condition, LabelMode};
use crate::span::Span;

pub const CODE: Code = Code("W-START");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "parallel branches that conflict because they start together",
    meaning: "Parallel branches start at the same instant. Here two of them begin with conditions that cannot hold together, so no plan
can order them.",
    example: "scenario Day[0,60] = { ARM=DIG [5,5], ARM=LIFT [5,5] }",
    fix: "Begin one branch with `delay[0,inf]`: then planning may start it later.",
    mended: "scenario Day[0,60] = { ARM=DIG [5,5], { delay[0,inf]; ARM=LIFT [5,5] } }",
};

/// Two conditions that hold from the start of two branches; `later` is the second branch.
pub(crate) fn conflict(pair: [(LabelMode, &Condition); 2], later: Span) -> Diagnostic {
    let [one, other] = pair.map(|(mode, condition)| describe(mode, condition));
    let message =
        format!("{other} conflicts with {one}: both begin when the branches start, at the same instant");
    let fix = Fix {
        label: "Start this branch with `delay[0,inf]`".to_owned(),
        edits: vec![
            Edit { span: Span::new(later.start, later.start), text: "{ delay[0,inf]; ".to_owned() },
            Edit { span: Span::new(later.end, later.end), text: " }".to_owned() },
        ],
    };
    Diagnostic::warning(CODE, pair[1].1.span, message)
        .with_hint("parallel branches start together; with a delay in front, planning may order them")
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
