//! `E-MODEL`: a vehicle model that no vehicle can be, or a demand that a model cannot meet (SPEC 17).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-MODEL");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "impossible vehicle model",
    meaning: "A property of a `model` has a value that no vehicle can have, such as a body without a length or a slope of
more than 60 degrees. Or a `moves` clause asks for a speed that the model of the vehicle does not reach. Enroute never
changes such a value silently. Lengths are meters, speeds meters per second, and angles degrees, unless a unit follows.",
    example: "model Scout { speed (0.01, 0.8); slope 70 degrees; }
location BASE (0, 0);
vehicle R1 : Scout at BASE;
primitive Look()[1,2] requires R1.at = BASE;
scenario Sol[0,60] = { Look() }",
    fix: "Correct the property, or ask for no more than the model can do.",
    mended: "model Scout { speed (0.01, 0.8); slope 20 degrees; }
location BASE (0, 0);
vehicle R1 : Scout at BASE;
primitive Look()[1,2] requires R1.at = BASE;
scenario Sol[0,60] = { Look() }",
};

/// A property that no vehicle can have.
pub(crate) fn impossible(problem: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, problem)
        .with_hint("correct the value, or remove the property to keep that of the extended model")
}

/// A property of driving for a model that flies.
pub(crate) fn slope_of_flight(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "a model that flies has no slope").with_hint("remove the slope, or `flies`")
}

/// A model of a rover that is to fly.
pub(crate) fn flying_rover(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "a model that flies cannot extend a model that drives")
        .with_hint("extend `Blimp`")
}

/// A `moves` clause that asks for a speed which a vehicle's model does not reach.
pub fn too_fast(wanted: &str, vehicle: &str, model: &str, greatest: &str, span: Span) -> Diagnostic {
    let message =
        format!("`{vehicle}` cannot move at {wanted} m/s: its model `{model}` does at most {greatest} m/s");
    Diagnostic::error(CODE, span, message)
        .with_hint("lower the speed in the `moves` clause, or raise `speed` in the model")
}
