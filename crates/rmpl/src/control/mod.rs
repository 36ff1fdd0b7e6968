//! Control programs and plant models in prefix notation (SPEC 2): from text to typed trees and back.
//!
//! Parsing never fails: every stage returns a result and diagnostics. Automata and plants are other crates' business.

mod check;
mod check_timed;
mod components;
mod detect;
mod display;
mod duration;
mod expand;
mod format;
mod highlight;
mod inherit;
mod keyword;
mod lexer;
mod methods;
mod probabilities;
mod read_constraint;
mod read_model;
mod read_program;
mod read_timed;
mod spans;
mod suggest;
mod syntax;
mod tree;
mod visit;

pub use components::{ComponentModes, MAX_COMPONENTS, PlantComponent, PlantComponents, component_modes};
pub use detect::is_control_text;
pub use duration::{Duration, DurationError};
pub use expand::expand_main;
pub use format::format;
pub use highlight::{Highlight, HighlightKind, highlight};
pub use inherit::{
    MergedClass, MergedFault, MergedMethod, MergedPart, MergedTransition, MergedVariable, merge_all,
};
pub use keyword::{EXPRESSION_KEYWORDS, MODEL_KEYWORDS};
pub use lexer::{Token, TokenKind, lex};
pub use methods::without_places;
pub use probabilities::weights as probability_weights;
pub use suggest::nearest;
pub use syntax::{
    Alternative, Argument, Class, Constraint, ConstraintKind, ControlFile, Definition, Expression,
    ExpressionKind, Field, FieldKind, Guard, Held, Initial, Instance, Name, ProgramOption,
};
pub use tree::{List, Node, Tree};

use crate::diagnostic::Diagnostic;

/// What parsing a text gives: the tokens (whose texts joined are the text), the typed tree, and what is wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParsedControl {
    /// All tokens, blanks and comments included.
    pub tokens: Vec<Token>,
    /// Matched parentheses over the tokens.
    pub tree: Tree,
    /// What the text says.
    pub file: ControlFile,
    /// What is wrong with it, in textual order.
    pub diagnostics: Vec<Diagnostic>,
}

impl ParsedControl {
    /// Returns whether any diagnostic is an error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == crate::Severity::Error)
    }
}

/// Reads a control program, a plant model, or both in one text (SPEC 2). Linear in the length of the text.
pub fn parse(text: &str) -> ParsedControl {
    let tokens = lex(text);
    let (tree, mut diagnostics) = tree::build(text, &tokens);
    let (mut file, found) = read_program::read(text, &tree);
    file.methods = methods_of(&file);
    diagnostics.extend(found);
    diagnostics.extend(check::check(&file));
    diagnostics.extend(check_timed::check_steps(&file));
    diagnostics.extend(probabilities::check(&file));
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
    ParsedControl { tokens, tree, file, diagnostics: crate::diagnostic::listed(diagnostics) }
}

/// The methods of all components of a file.
fn methods_of(file: &ControlFile) -> Vec<Definition> {
    let fields = file.classes.iter().flat_map(|class| &class.fields);
    if !fields.into_iter().any(|field| matches!(field.kind, FieldKind::Method { .. })) {
        return Vec::new();
    }
    let (classes, _) = merge_all(file);
    methods::definitions(&PlantComponents::new(file, &classes), &classes)
}

#[cfg(test)]
mod tests;
