//! `E-DUP`: duplicate name.

use crate::analysis::Namespace;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::program::Name;
use crate::span::Span;

pub const CODE: Code = Code("E-DUP");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "duplicate name",
    meaning: "Within one kind, a name may be declared only once. Activities and primitives count as one kind, and so do
`var` and `state`. Scenarios, resources, locations, obstacles, vehicles and options are further kinds. The parameters of a
header must also differ, an activity may set a variable only once, and all goals belong in one objective. In one body, two
occurrences may share a name only if they are in different alternatives of a choice. The first declaration takes effect.",
    example: "primitive Drive()[20,30];
primitive Drive()[25,40];
scenario Day[0,60] = { Drive() }",
    fix: "Rename one of the two, or remove it.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// An option of a control program that is set twice.
pub(crate) fn program_option(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the option `{name}` is already set"))
}

/// A second length of a step.
pub(crate) fn step_length(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "the step length is already set").with_hint("remove one of the two")
}

/// A length of a step in a control block whose mission has the option `control_step`.
pub fn step_of_mission(span: Span) -> Diagnostic {
    let message = "the mission already sets the step length: `option control_step`";
    Diagnostic::error(CODE, span, message).with_hint("remove DEFSTEP or the option")
}

/// A mode to which one prior gives two probabilities.
pub(crate) fn mode_of_prior(mode: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the mode `{mode}` is already in this prior"))
        .with_hint("give each mode one probability")
}

/// A declaration whose name is taken.
pub(crate) fn declaration(namespace: Namespace, name: &str, span: Span) -> Diagnostic {
    let message = match namespace {
        Namespace::Callable => format!("activity `{name}` is already declared"),
        Namespace::Variable => format!("variable `{name}` is already declared"),
        Namespace::Constant => format!("constant `{name}` is already declared"),
        Namespace::Scenario => format!("scenario `{name}` is already declared"),
        Namespace::Option => format!("option `{name}` is already set"),
        Namespace::Terrain => "a terrain is already declared".to_owned(),
        Namespace::Location => format!("location `{name}` is already declared"),
        Namespace::Obstacle => format!("obstacle `{name}` is already declared"),
        Namespace::Resource => format!("resource `{name}` is already declared"),
        Namespace::Objective => "an objective is already declared".to_owned(),
        Namespace::Occurrence => format!("occurrence `{name}` is already named"),
        Namespace::Vehicle => format!("vehicle `{name}` is already declared"),
        Namespace::Model => format!("vehicle model `{name}` is already declared"),
        Namespace::Group => format!("group or fleet `{name}` is already declared"),
    };
    Diagnostic::error(CODE, span, message)
        .with_hint("only the first declaration takes effect: rename or remove this one")
}

/// A model with the name of a built-in one.
pub(crate) fn built_in_model(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("`{}` is a built-in model", name.text))
        .with_hint(format!("choose another name; `extends {}` inherits its properties", name.text))
}

/// A resource or a state of a model that an extended model has.
pub(crate) fn inherited_equipment(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("the extended model already has `{}`", name.text))
        .with_hint("choose another name, or remove this one")
}

/// A resource or a state with a name that every vehicle has.
pub(crate) fn reserved_equipment(name: &Name) -> Diagnostic {
    let what = if name.text == "at" { "the place of a vehicle" } else { "the mode of a component" };
    Diagnostic::error(CODE, name.span, format!("`{}` is {what}", name.text)).with_hint("choose another name")
}

/// A property that a model says twice.
pub(crate) fn property(word: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the model already says `{word}`"))
        .with_hint("remove one of the two")
}

/// A name that stands twice in one list.
pub(crate) fn in_list(name: &Name, what: &str) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("duplicate {what} `{}`", name.text))
}

/// A second occurrence of this name in one body.
pub(crate) fn occurrence(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("another occurrence is already named `{}`", name.text))
        .with_hint(
            "occurrences may share a name only in different alternatives of one choice; it then means the selected one",
        )
}

/// A second effect on a variable.
pub(crate) fn effect(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("the activity sets `{}` twice", name.text))
        .with_hint("a variable can have only one value when the activity ends")
}

/// An effect on the place of a vehicle that the activity moves.
pub(crate) fn movement(name: &Name, vehicle: &str) -> Diagnostic {
    let message = format!("the activity moves `{vehicle}`, which already sets `{}`", name.text);
    Diagnostic::error(CODE, name.span, message)
}
