//! `E-UNDEF` and `W-UNDEF`: a name that is used but not declared (SPEC 1.4).

use crate::analysis::Call;
use exact::Bound;

use crate::diagnostic::{Code, Diagnostic, Fix, Severity};
use crate::explanation::Explanation;
use crate::parser::{insertion, replacement};
use crate::program::{Change, component_of_state};
use crate::span::Span;

/// The code under `option strict = 1;`.
pub const CODE: Code = Code("E-UNDEF");

/// The code otherwise.
pub const WARNING: Code = Code("W-UNDEF");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "an undeclared name that must be declared",
    meaning: "A bound between events names occurrences that `as` names, and an `import` a file of the mission. What an activity sets is a `state` or the place of a vehicle, and what it uses, consumes or produces is a `resource`: their
declarations say what they begin with, so there is no default. Under `option strict = 1;` every activity that is called must be declared as a primitive or defined, and every vehicle
and location that the world mentions must be declared.",
    example: "option strict = 1;
scenario Day[0,60] = { Drive() }",
    fix: "Declare the name, correct it, or leave out the option.",
    mended: "option strict = 1;
primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// What it means, with an example.
pub const WARNING_EXPLANATION: Explanation = Explanation {
    code: WARNING,
    severity: Severity::Warning,
    title: "an undeclared name",
    meaning: "An undeclared activity is taken for a primitive that may last any time, `[0,inf]`. That is what the paper's own listing
needs, but it is also what a misspelled name gets.",
    example: "scenario Day[0,60] = { Drive() }",
    fix: "Declare the primitive with its duration, or correct the name.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// A call of something that the file does not declare. `start` is where the declaration that calls it begins.
pub(crate) fn call(
    name: &str,
    call: &Call,
    nearest: Option<&str>,
    is_strict: bool,
    start: u32,
) -> Diagnostic {
    let message = format!("no activity or primitive `{name}` is declared");
    let mut diagnostic = severity(call.span, message, is_strict);
    if let Some(nearest) = nearest {
        diagnostic = diagnostic.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
            format!("Change to `{nearest}`"),
            call.span,
            nearest,
        ));
    } else if !is_strict {
        diagnostic = diagnostic.with_hint("it is taken for a primitive that may last any time, [0,inf]");
    }
    let parameters: Vec<String> = (1..=call.arguments).map(|at| format!("p{at}")).collect();
    let header = format!("{name}({})", parameters.join(", "));
    let bounds = call.bounds.map_or("[0,inf]".to_owned(), |((lower, upper), _)| match upper {
        Bound::Finite(upper) => format!("[{lower},{upper}]"),
        Bound::Infinite => format!("[{lower},inf]"),
    });
    diagnostic
        .with_fix(insertion(
            format!("Declare primitive `{name}`"),
            start,
            format!("primitive {header}{bounds};\n"),
        ))
        .with_fix(insertion(
            format!("Declare activity `{name}`"),
            start,
            format!("{header}[l,u] = {{\n  delay[l,u]\n}}\n"),
        ))
}

/// A vehicle or a location that the world mentions but does not declare.
pub(crate) fn world(
    what: &str,
    name: &str,
    span: Span,
    nearest: Option<&str>,
    is_strict: bool,
    start: u32,
) -> Diagnostic {
    let diagnostic = severity(span, format!("no {what} `{name}` is declared"), is_strict);
    let diagnostic = change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| diagnostic);
    if what == "location" { diagnostic.with_fix(declare_location(name, start)) } else { diagnostic }
}

/// The fix that declares a location in front of the declaration that mentions it.
pub(crate) fn declare_location(name: &str, start: u32) -> Fix {
    insertion(format!("Declare location `{name}`"), start, format!("location {name} (0, 0);\n"))
}

/// The place of something that is no vehicle.
pub(crate) fn place(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no vehicle `{name}` is declared"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        diagnostic.with_hint("only a vehicle, or a parameter that stands for one, has a place")
    })
}

/// An effect on a `var`.
pub(crate) fn effect_on_variable(name: &str, span: Span) -> Diagnostic {
    let message =
        format!("`{name}` is a `var`, which holds only where it is asserted: an activity cannot set it");
    Diagnostic::error(CODE, span, message).with_hint(format!("declare it as `state {name} : {{…}} = …;`"))
}

/// An effect on an undeclared variable. `values` are those that the file knows, `set` is the one that is set here, and
/// `start` is where the declaration begins.
pub(crate) fn state(
    name: &str,
    span: Span,
    values: &[&str],
    set: Option<&str>,
    nearest: Option<&str>,
    start: u32,
) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no state variable `{name}` is declared"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        if component_of_state(name).is_some() {
            return diagnostic
                .with_hint("the mode of a component is a state that is read from the plant")
                .with_fix(insertion(
                    format!("Add `state {name} from plant`"),
                    start,
                    format!("state {name} from plant;\n"),
                ));
        }
        let values = if values.is_empty() { &["NONE"] } else { values };
        let first = values.iter().find(|value| Some(**value) != set).or(values.first()).unwrap_or(&"NONE");
        let declaration = format!("state {name} : {{{}}} = {first};\n", values.join(", "));
        diagnostic
            .with_hint("what an activity sets lasts: its declaration says which values it has, and the first")
            .with_fix(insertion(format!("Add `state {name} …`"), start, declaration))
    })
}

/// The state of a component that the plant does not have.
pub(crate) fn component(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let component = component_of_state(name).unwrap_or(name);
    let diagnostic = Diagnostic::error(CODE, span, format!("the plant has no component `{component}`"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        diagnostic.with_hint("a control block models the plant: `control { (DEFCLASS …) (DEFINSTANCE …) }`")
    })
}

/// An undeclared resource.
pub(crate) fn resource(
    name: &str,
    span: Span,
    change: Change,
    nearest: Option<&str>,
    start: u32,
) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no resource `{name}` is declared"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        let declaration = match change {
            Change::Uses => format!("resource {name};\n"),
            Change::Consumes => format!("resource {name} 0..100 = 100;\n"),
            Change::Produces => format!("resource {name} 0..100 = 0;\n"),
        };
        let label = format!("Add `{}`", declaration.trim());
        diagnostic.with_fix(insertion(label, start, declaration))
    })
}

/// A bound between events of something that nothing is called.
pub(crate) fn occurrence(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("nothing is named `{name}`"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        diagnostic.with_hint(format!("name what you mean where it stands in a block: `Drive() as {name}`"))
    })
}

/// An import of a file that the mission does not have.
pub(crate) fn file(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the mission has no file `{name}`"))
        .with_hint("files are found from the folder of the file that imports them")
}

/// A file beside the mission's first one that none imports.
pub(crate) fn file_not_imported(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("nothing imports the file `{name}`"))
        .with_hint(format!("`import \"{name}\";` in the main text makes it part of the mission"))
}

/// An import of what is no file of the mission's folder.
pub(crate) fn file_outside(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("`{name}` is no file in the mission's folder")).with_hint(
        "a mission imports only files of its own folder and of those in it, by names such as `world/rocks.rmpl`",
    )
}

/// With the nearest name, if there is one, as a question and a fix.
fn change_to(diagnostic: Diagnostic, nearest: Option<&str>, span: Span) -> Result<Diagnostic, Diagnostic> {
    let Some(nearest) = nearest else { return Err(diagnostic) };
    Ok(diagnostic.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
        format!("Change to `{nearest}`"),
        span,
        nearest,
    )))
}

fn severity(span: Span, message: String, is_strict: bool) -> Diagnostic {
    if is_strict {
        Diagnostic::error(CODE, span, message)
    } else {
        Diagnostic::warning(WARNING, span, message)
    }
}
