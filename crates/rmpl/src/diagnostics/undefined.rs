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
    title: "undeclared name",
    meaning: "These names must be declared: states that an activity sets, resources that it uses, consumes or produces,
occurrences in `constrain` (named with `as`), and files in `import`. With `option strict = 1;`, every activity, vehicle and
location must be declared, too.",
    example: "option strict = 1;
scenario Day[0,60] = { Drive() }",
    fix: "Declare the name, correct it, or remove the option.",
    mended: "option strict = 1;
primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// What it means, with an example.
pub const WARNING_EXPLANATION: Explanation = Explanation {
    code: WARNING,
    severity: Severity::Warning,
    title: "undeclared activity",
    meaning: "The planner treats an undeclared activity as a primitive of any duration, `[0,inf]`. The usual reason is a
misspelled name.",
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
    let message = format!("unknown activity `{name}`");
    let mut diagnostic = severity(call.span, message, is_strict);
    if let Some(nearest) = nearest {
        diagnostic = diagnostic.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
            format!("Change to `{nearest}`"),
            call.span,
            nearest,
        ));
    } else if !is_strict {
        diagnostic = diagnostic.with_hint("assuming a primitive with duration [0,inf]");
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
    let diagnostic = severity(span, format!("unknown {what} `{name}`"), is_strict);
    let diagnostic = change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| diagnostic);
    if what == "location" { diagnostic.with_fix(declare_location(name, start)) } else { diagnostic }
}

/// The fix that declares a location in front of the declaration that mentions it.
pub(crate) fn declare_location(name: &str, start: u32) -> Fix {
    insertion(format!("Declare location `{name}`"), start, format!("location {name} (0, 0);\n"))
}

/// The place of something that is not a vehicle.
pub(crate) fn place(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown vehicle `{name}`"));
    change_to(diagnostic, nearest, span)
        .unwrap_or_else(|diagnostic| diagnostic.with_hint("only a vehicle has `.at`"))
}

/// An effect on a `var`.
pub(crate) fn effect_on_variable(name: &str, span: Span) -> Diagnostic {
    let message = format!("an activity cannot set `{name}`, because it is a `var`");
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
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown state variable `{name}`"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        if component_of_state(name).is_some() {
            return diagnostic
                .with_hint("to read the mode of a component, declare it as a state from the plant")
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
            .with_hint("declare a state that activities set, with its values and the initial one")
            .with_fix(insertion(format!("Add `state {name} …`"), start, declaration))
    })
}

/// The state of a component that the plant does not have.
pub(crate) fn component(name: &str, span: Span, nearest: Option<&str>) -> Diagnostic {
    let component = component_of_state(name).unwrap_or(name);
    let diagnostic = Diagnostic::error(CODE, span, format!("the plant has no component `{component}`"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        diagnostic.with_hint("add a plant model: `control { (DEFCLASS …) (DEFINSTANCE …) }`")
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
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown resource `{name}`"));
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
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown name `{name}`"));
    change_to(diagnostic, nearest, span).unwrap_or_else(|diagnostic| {
        diagnostic.with_hint(format!("name an occurrence in a block, as in `Drive() as {name}`"))
    })
}

/// An import of a file that the mission does not have.
pub(crate) fn file(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the mission has no file `{name}`"))
        .with_hint("paths are relative to the folder of the importing file")
}

/// A file beside the mission's first one that none imports.
pub(crate) fn file_not_imported(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the file `{name}` is never imported"))
        .with_hint(format!("add `import \"{name}\";` to the main file to make it part of the mission"))
}

/// An import of what is not a file of the mission's folder.
pub(crate) fn file_outside(name: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("`{name}` is not in the mission's folder")).with_hint(
        "import only files from the mission's folder and its subfolders, such as `world/rocks.rmpl`",
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
