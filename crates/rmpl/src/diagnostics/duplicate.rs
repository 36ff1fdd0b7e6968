//! `E-DUP`: a name is declared twice.

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
    title: "a name is declared twice",
    meaning: "Activities and primitives share their names, because both are called, and so do `var` and `state`;
scenarios, resources, locations, obstacles and vehicles each have names of their own. Within one of these kinds a name has one declaration, and so has each option.
The parameters in one header must differ as well, and one activity sets a variable once. There is one objective, with all goals.
In one body, two occurrences have one name only in different alternatives of a choice. The first declaration counts.",
    example: "primitive Drive()[20,30];
primitive Drive()[25,40];
scenario Day[0,60] = { Drive() }",
    fix: "Rename one of the two, or remove it.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// An option of a control program that is set twice.
pub(crate) fn program_option(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the option `{name}` is set before"))
}

/// A mode to which one prior gives two probabilities.
pub(crate) fn mode_of_prior(mode: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the mode `{mode}` is named before in this prior"))
        .with_hint("give each mode one probability")
}

/// A declaration whose name is taken.
pub(crate) fn declaration(namespace: Namespace, name: &str, span: Span) -> Diagnostic {
    let message = match namespace {
        Namespace::Callable => format!("an activity or primitive `{name}` is declared before this one"),
        Namespace::Variable => format!("the variable `{name}` is declared before"),
        Namespace::Constant => format!("the constant `{name}` is declared before"),
        Namespace::Scenario => format!("a scenario `{name}` is declared before this one"),
        Namespace::Option => format!("the option `{name}` is set before"),
        Namespace::Terrain => "a terrain is declared before this one".to_owned(),
        Namespace::Location => format!("a location `{name}` is declared before this one"),
        Namespace::Obstacle => format!("an obstacle `{name}` is declared before this one"),
        Namespace::Resource => format!("a resource `{name}` is declared before this one"),
        Namespace::Objective => "an objective is declared before this one".to_owned(),
        Namespace::Occurrence => format!("an occurrence `{name}` is named before this one"),
        Namespace::Vehicle => format!("a vehicle `{name}` is declared before this one"),
    };
    Diagnostic::error(CODE, span, message)
        .with_hint("the first declaration counts; rename or remove this one")
}

/// A name that stands twice in one list.
pub(crate) fn in_list(name: &Name, what: &str) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("the {what} `{}` stands here twice", name.text))
}

/// A second occurrence of this name in one body.
pub(crate) fn occurrence(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("another occurrence is named `{}` already", name.text))
        .with_hint(
            "only alternatives of one choice share a name: then it stands for the one that is selected",
        )
}

/// A second effect on a variable.
pub(crate) fn effect(name: &Name) -> Diagnostic {
    Diagnostic::error(CODE, name.span, format!("the activity sets `{}` twice", name.text))
        .with_hint("a variable has one value when the activity ends")
}

/// An effect on the place of a vehicle that the activity moves.
pub(crate) fn movement(name: &Name, vehicle: &str) -> Diagnostic {
    let message = format!("the activity moves `{vehicle}`, which sets `{}` already", name.text);
    Diagnostic::error(CODE, name.span, message)
}
