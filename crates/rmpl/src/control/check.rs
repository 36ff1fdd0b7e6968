//! Names between definitions: duplicates, unknown forms, calls with the wrong number of arguments, recursion.

use std::collections::BTreeMap;

use crate::call_cycles::call_cycles;
use crate::diagnostic::{Code, Diagnostic, Edit, Fix};

use super::check_timed::{check_held, check_numbers};
use super::read_program::Reader;
use super::suggest::nearest;
use super::syntax::{
    Argument, Constraint, ConstraintKind, ControlFile, Definition, Expression, ExpressionKind, Name,
};

/// Checks the definitions of a text against each other.
pub(super) fn check(file: &ControlFile) -> Vec<Diagnostic> {
    let mut checker = Checker { file, known: BTreeMap::new(), diagnostics: Vec::new() };
    for definition in &file.definitions {
        if checker.known.insert(definition.name.text.as_str(), definition).is_some() {
            let message = format!("`{}` is defined twice", definition.name.text);
            checker.diagnostics.push(Diagnostic::error(Code("E-DUP"), definition.name.span, message));
        }
    }
    for method in &file.methods {
        checker.known.entry(method.name.text.as_str()).or_insert(method);
    }
    for definition in file.definitions.iter().chain(&file.methods) {
        checker.expression(&definition.body, definition);
    }
    checker.recursion();
    // Components of one class share the errors of their methods.
    let mut diagnostics = Vec::with_capacity(checker.diagnostics.len());
    for found in checker.diagnostics {
        found.add_once_to(&mut diagnostics);
    }
    diagnostics
}

struct Checker<'file> {
    file: &'file ControlFile,
    known: BTreeMap<&'file str, &'file Definition>,
    diagnostics: Vec<Diagnostic>,
}

impl<'file> Checker<'file> {
    fn error(&mut self, code: &'static str, name: &Name, message: String, hint: Option<String>) {
        let mut diagnostic = Diagnostic::error(Code(code), name.span, message);
        diagnostic.hint = hint;
        self.diagnostics.push(diagnostic);
    }

    fn expression(&mut self, expression: &'file Expression, within: &'file Definition) {
        let guarded = expression.guard().map(|guard| &guard.constraint);
        for constraint in guarded.into_iter().chain(expression.asserted()) {
            self.constraint(constraint, within);
        }
        let numbers = check_numbers(expression, &|name| is_parameter(name, within));
        self.diagnostics.extend(numbers);
        if let ExpressionKind::Call { name, arguments, bare } = &expression.kind {
            self.call(name, arguments, *bare, within);
        }
        for part in expression.parts() {
            self.expression(part, within);
        }
    }

    fn constraint(&mut self, constraint: &'file Constraint, within: &'file Definition) {
        match &constraint.kind {
            ConstraintKind::Not(inner) => self.constraint(inner, within),
            ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
                for part in parts {
                    self.constraint(part, within);
                }
            }
            ConstraintKind::Parameter(name) if !is_parameter(name, within) => {
                let hint = nearest(&name.text, within.parameters.iter().map(|known| known.text.as_str()))
                    .map_or_else(
                        || "write a constraint as `(variable = value)`".into(),
                        |known| format!("did you mean the parameter `{known}`?"),
                    );
                self.error(
                    "E-UNDEF",
                    name,
                    format!("`{}` is neither a constraint nor a parameter", name.text),
                    Some(hint),
                );
            }
            _ => {}
        }
    }

    fn call(
        &mut self,
        name: &'file Name,
        arguments: &'file [Argument],
        bare: bool,
        within: &'file Definition,
    ) {
        for argument in arguments {
            if let Argument::Guard(guard) = argument {
                self.constraint(&guard.constraint, within);
                self.diagnostics.extend(check_held(guard, &|name| is_parameter(name, within)));
            }
        }
        if is_parameter(name, within) {
            if !arguments.is_empty() {
                self.error(
                    "E-ARITY",
                    name,
                    format!("the parameter `{}` takes no arguments", name.text),
                    None,
                );
            }
            return;
        }
        let Some(definition) = self.known.get(name.text.as_str()) else {
            return self.unknown(name, arguments);
        };
        if bare {
            let fix = Fix {
                label: format!("Write `({})`", name.text),
                edits: vec![Edit { span: name.span, text: format!("({})", name.text) }],
            };
            let message = format!("call a definition in parentheses: `({})`", name.text);
            self.diagnostics.push(Diagnostic::error(Code("E-FORM"), name.span, message).with_fix(fix));
            return;
        }
        let wanted = definition.parameters.len();
        if wanted != arguments.len() {
            let plural = if wanted == 1 { "argument" } else { "arguments" };
            let given = match arguments.len() {
                1 => "1 is".to_owned(),
                count => format!("{count} are"),
            };
            let message = format!("`{}` takes {wanted} {plural}, but {given} given", name.text);
            self.error("E-ARITY", name, message, None);
        }
    }

    fn unknown(&mut self, name: &Name, arguments: &[Argument]) {
        // Without components, the plant and its methods may be in another text.
        if name.text.contains('.') && self.file.instances.is_empty() {
            return;
        }
        if let Some(hint) = Reader::keyword_hint(&name.text) {
            return self.error("E-FORM", name, format!("unknown construct `{}`", name.text), Some(hint));
        }
        let hint =
            nearest(&name.text, self.known.keys().copied()).map(|known| format!("did you mean `{known}`?"));
        let has_parts = arguments.iter().any(|argument| !matches!(argument, Argument::Word(_)));
        if has_parts && hint.is_none() {
            let message = format!("`{}` is neither a construct of the language nor a definition", name.text);
            return self.error("E-FORM", name, message, None);
        }
        let hint = match (hint, arguments) {
            (None, [Argument::Word(value)]) => {
                Some(format!("did you mean `({} = {})`?", name.text, value.text))
            }
            (hint, _) => hint,
        };
        self.error("E-UNDEF", name, format!("unknown definition `{}`", name.text), hint);
    }

    /// One diagnostic per cycle of calls, at the call that closes it.
    fn recursion(&mut self) {
        let definitions: Vec<&Definition> = self.file.definitions.iter().chain(&self.file.methods).collect();
        let mut positions = BTreeMap::new();
        for (position, definition) in definitions.iter().enumerate() {
            positions.entry(definition.name.text.as_str()).or_insert(position);
        }
        let calls = definitions.iter().map(|definition| {
            let mut names = Vec::new();
            called(&definition.body, &mut names);
            names.retain(|name| !is_parameter(name, definition));
            names.iter().filter_map(|name| Some((*positions.get(name.text.as_str())?, name.span))).collect()
        });
        for cycle in call_cycles(&calls.collect::<Vec<_>>()) {
            let way: Vec<&str> =
                cycle.members.iter().map(|&member| definitions[member].name.text.as_str()).collect();
            let message = match way[..] {
                [only] => format!("`{only}` calls itself"),
                _ => {
                    format!("these definitions call each other in a cycle: {} → {}", way.join(" → "), way[0])
                }
            };
            self.diagnostics.push(
                Diagnostic::error(Code("E-RECURSION"), cycle.closing_call, message)
                    .with_hint("an automaton must be finite: to repeat, use ALWAYS or WHENEVER-DONEXT"),
            );
        }
    }
}

fn is_parameter(name: &Name, within: &Definition) -> bool {
    within.parameters.iter().any(|parameter| parameter.text == name.text)
}

fn called<'file>(expression: &'file Expression, into: &mut Vec<&'file Name>) {
    if let ExpressionKind::Call { name, .. } = &expression.kind {
        into.push(name);
    }
    for part in expression.parts() {
        called(part, into);
    }
}
