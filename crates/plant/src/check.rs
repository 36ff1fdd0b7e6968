//! What is wrong with the classes and components of a text (SPEC 2.2).

use std::collections::BTreeMap;

use rmpl::control::{Constraint, ConstraintKind, ControlFile, Instance, Name, nearest};
use rmpl::{Code, Diagnostic, Span, diagnostics};
use smol_str::SmolStr;

use crate::probability;
use rmpl::control::{MergedClass, MergedFault, MergedVariable};

/// Value sets are words of 64 bits.
const MAX_VALUES: usize = 64;

/// Adds what is wrong with the classes and components of a file that parsed without errors.
pub(crate) fn check(
    file: &ControlFile,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut checker = Checker { file, classes, diagnostics };
    for class in &file.classes {
        checker.check_class(&class.name.text);
    }
    checker.check_instances();
}

/// What a name in a constraint of a class stands for.
struct Meaning {
    values: Vec<SmolStr>,
    is_command: bool,
}

struct Checker<'check, 'file> {
    file: &'file ControlFile,
    classes: &'check BTreeMap<SmolStr, MergedClass<'file>>,
    diagnostics: &'check mut Vec<Diagnostic>,
}

impl Checker<'_, '_> {
    fn error(&mut self, code: &'static str, span: Span, message: impl Into<String>, hint: Option<String>) {
        // An inherited field is met again in every class that extends its own.
        if self.diagnostics.iter().any(|known| known.span == span && known.code == Code(code)) {
            return;
        }
        let mut diagnostic = Diagnostic::error(Code(code), span, message);
        diagnostic.hint = hint;
        self.diagnostics.push(diagnostic);
    }

    fn check_class(&mut self, name: &SmolStr) {
        let Some(class) = self.classes.get(name) else { return };
        for variable in class.variables.iter().chain(&class.commands) {
            if variable.values.len() > MAX_VALUES {
                let message = format!(
                    "`{}` has {} values, but at most {MAX_VALUES} are allowed",
                    variable.name.text,
                    variable.values.len()
                );
                self.error("E-VALUE", variable.name.span, message, None);
            }
            if let Some(error) = &variable.error {
                self.check_probability(error);
                if variable.values.len() < 2 {
                    let message = format!(
                        "`{}` has only one value, so that no other can be observed",
                        variable.name.text
                    );
                    self.error("E-VALUE", error.span, message, Some("remove ERROR, or add a value".into()));
                }
            }
            if let Some(shows) = &variable.shows
                && !variable.values.contains(&shows.text)
            {
                let message = format!("`{}` cannot be `{}`", variable.name.text, shows.text);
                self.error(
                    "E-VALUE",
                    shows.span,
                    message,
                    did_you_mean(&shows.text, variable.values.iter().map(SmolStr::as_str)),
                );
            }
        }
        for (port, target) in &class.ports {
            if !self.file.classes.iter().any(|known| known.name.text == target.text) {
                let known = self.file.classes.iter().map(|known| known.name.text.as_str());
                let hint = did_you_mean(&target.text, known);
                self.error("E-UNDEF", target.span, format!("the port `{}` needs a class", port.text), hint);
            }
        }
        if class.modes.len() > MAX_VALUES {
            let span = class.modes[MAX_VALUES].0.span;
            self.error("E-VALUE", span, format!("a class can have at most {MAX_VALUES} modes"), None);
        }
        for (_, constraints) in &class.modes {
            for constraint in constraints {
                self.check_constraint(class, constraint, false);
            }
        }
        for transition in &class.transitions {
            self.check_mode(class, name, transition.from);
            self.check_mode(class, name, transition.to);
            self.check_constraint(class, transition.guard, true);
            if let Some(given) = transition.probability {
                self.check_probability(given);
            }
        }
        self.check_faults(class, name);
    }

    fn check_mode(&mut self, class: &MergedClass<'_>, class_name: &str, mode: &Name) {
        if class.mode(&mode.text).is_none() {
            let hint = did_you_mean(&mode.text, class.modes.iter().map(|(known, _)| known.text.as_str()));
            self.error("E-UNDEF", mode.span, format!("`{class_name}` has no mode `{}`", mode.text), hint);
        }
    }

    fn check_faults(&mut self, class: &MergedClass<'_>, class_name: &str) {
        for (at, fault) in class.faults.iter().enumerate() {
            self.check_mode(class, class_name, fault.from);
            self.check_mode(class, class_name, fault.to);
            if let Some(guard) = fault.guard {
                self.check_constraint(class, guard, true);
            }
            let guard = |fault: &MergedFault<'_>| fault.guard.map(ToString::to_string);
            let is_same = |earlier: &MergedFault<'_>| {
                earlier.from.text == fault.from.text
                    && earlier.to.text == fault.to.text
                    && guard(earlier) == guard(fault)
            };
            if class.faults.iter().take(at).any(is_same) {
                let message = format!(
                    "the fault from `{}` to `{}` is already declared",
                    fault.from.text, fault.to.text
                );
                self.error("E-DUP", fault.probability.span, message, None);
            }
            self.check_probability(fault.probability);
        }
    }

    fn check_probability(&mut self, given: &Name) {
        let parsed = probability::parse(&given.text).filter(|(part, whole)| *part > 0 && part <= whole);
        if parsed.is_none() && !self.diagnostics.iter().any(|known| known.span == given.span) {
            self.diagnostics.push(diagnostics::probability::of_model(&given.text, given.span));
        }
    }

    /// What `name` means in a constraint of `class`.
    fn meaning(&self, class: &MergedClass<'_>, name: &str) -> Option<Meaning> {
        let of = |variables: &[MergedVariable], name: &str, is_command| {
            let found = variables.iter().find(|known| known.name.text == name)?;
            Some(Meaning { values: found.values.clone(), is_command })
        };
        let fields = |class: &MergedClass<'_>, name: &str| {
            of(&class.variables, name, false).or_else(|| of(&class.commands, name, true))
        };
        let at_port = |port: &str| {
            let (_, target) = class.ports.iter().find(|(known, _)| known.text == port)?;
            self.classes.get(&target.text)
        };
        fields(class, name)
            .or_else(|| {
                let modes = at_port(name)?.modes.iter().map(|(mode, _)| mode.text.clone()).collect();
                Some(Meaning { values: modes, is_command: false })
            })
            .or_else(|| {
                let (port, field) = name.split_once('.')?;
                fields(at_port(port)?, field)
            })
    }

    fn check_constraint(&mut self, class: &MergedClass<'_>, constraint: &Constraint, is_guard: bool) {
        match &constraint.kind {
            ConstraintKind::Not(inner) => self.check_constraint(class, inner, is_guard),
            ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
                for part in parts {
                    self.check_constraint(class, part, is_guard);
                }
            }
            ConstraintKind::Parameter(name) => {
                let hint = Some("write a constraint as `(variable = value)`".into());
                self.error("E-CONSTRAINT", name.span, format!("`{}` is not a constraint", name.text), hint);
            }
            ConstraintKind::Equals { variable, value } => {
                let class_name = class.lineage.first().cloned().unwrap_or_default();
                let Some(meaning) = self.meaning(class, &variable.text) else {
                    // A port to an unknown class has been reported.
                    let port = variable.text.split('.').next().unwrap_or("");
                    if class
                        .ports
                        .iter()
                        .any(|(known, target)| known.text == port && !self.classes.contains_key(&target.text))
                    {
                        return;
                    }
                    let names =
                        class.variables.iter().chain(&class.commands).map(|known| known.name.text.as_str());
                    let hint = did_you_mean(
                        &variable.text,
                        names.chain(class.ports.iter().map(|(port, _)| port.text.as_str())),
                    );
                    let message =
                        format!("`{class_name}` has no variable, command or port `{}`", variable.text);
                    self.error("E-UNDEF", variable.span, message, hint);
                    return;
                };
                if meaning.is_command && !is_guard {
                    self.refuse_command(variable);
                    return;
                }
                if meaning.values.contains(&value.text) {
                    return;
                }
                if let Some(other) = self.meaning(class, &value.text) {
                    self.check_equality((variable, &meaning), (value, &other), is_guard);
                } else {
                    let hint = did_you_mean(&value.text, meaning.values.iter().map(SmolStr::as_str));
                    self.error(
                        "E-VALUE",
                        value.span,
                        format!("`{}` cannot be `{}`", variable.text, value.text),
                        hint,
                    );
                }
            }
            _ => {}
        }
    }

    /// Two variables that are to be equal have one domain.
    fn check_equality(&mut self, left: (&Name, &Meaning), right: (&Name, &Meaning), is_guard: bool) {
        if right.1.is_command && !is_guard {
            self.refuse_command(right.0);
            return;
        }
        let is_within =
            |one: &Meaning, other: &Meaning| one.values.iter().all(|it| other.values.contains(it));
        if !is_within(left.1, right.1) || !is_within(right.1, left.1) {
            let message = format!("`{}` and `{}` have different domains", left.0.text, right.0.text);
            let hint = "two variables can be equal if they have the same values".to_owned();
            self.error("E-VALUE", right.0.span, message, Some(hint));
        }
    }

    fn refuse_command(&mut self, command: &Name) {
        let message = format!("a mode cannot constrain the command `{}`", command.text);
        let hint = "use commands only in the guards of transitions".to_owned();
        self.error("E-CONSTRAINT", command.span, message, Some(hint));
    }

    fn check_instances(&mut self) {
        let file = self.file;
        for (at, instance) in file.instances.iter().enumerate() {
            if file.instances.iter().take(at).any(|earlier| earlier.name.text == instance.name.text) {
                self.error(
                    "E-DUP",
                    instance.name.span,
                    format!("the component `{}` is already declared", instance.name.text),
                    None,
                );
            }
            if !file.classes.iter().any(|class| class.name.text == instance.class.text) {
                let hint = did_you_mean(
                    &instance.class.text,
                    file.classes.iter().map(|class| class.name.text.as_str()),
                );
                self.error(
                    "E-UNDEF",
                    instance.class.span,
                    format!("unknown class `{}`", instance.class.text),
                    hint,
                );
            }
            let Some(class) = self.classes.get(&instance.class.text) else { continue };
            if class.modes.is_empty() {
                let message = format!("the class `{}` needs at least one mode", instance.class.text);
                self.error(
                    "E-FORM",
                    instance.class.span,
                    message,
                    Some("add one, such as `(MODE Present true)`".into()),
                );
            }
            for initial in instance.initial.modes() {
                self.check_mode(class, &instance.class.text, initial);
            }
            self.check_ports(instance, class);
        }
    }

    fn check_ports(&mut self, instance: &Instance, class: &MergedClass<'_>) {
        for (at, (port, component)) in instance.ports.iter().enumerate() {
            let Some((_, wanted)) = class.ports.iter().find(|(known, _)| known.text == port.text) else {
                let hint = did_you_mean(&port.text, class.ports.iter().map(|(known, _)| known.text.as_str()));
                self.error(
                    "E-UNDEF",
                    port.span,
                    format!("`{}` has no port `{}`", instance.class.text, port.text),
                    hint,
                );
                continue;
            };
            if instance.ports.iter().take(at).any(|(earlier, _)| earlier.text == port.text) {
                self.error(
                    "E-DUP",
                    port.span,
                    format!("the port `{}` is already connected", port.text),
                    None,
                );
            }
            let Some(other) = self.file.instances.iter().find(|known| known.name.text == component.text)
            else {
                let known = self.file.instances.iter().map(|known| known.name.text.as_str());
                let hint = did_you_mean(&component.text, known);
                self.error(
                    "E-UNDEF",
                    component.span,
                    format!("unknown component `{}`", component.text),
                    hint,
                );
                continue;
            };
            let fits =
                self.classes.get(&other.class.text).is_none_or(|class| class.lineage.contains(&wanted.text));
            if !fits {
                let message = format!(
                    "the port `{}` takes a {}, but `{}` is a {}",
                    port.text, wanted.text, component.text, other.class.text
                );
                self.error("E-VALUE", component.span, message, None);
            }
        }
        for (port, wanted) in &class.ports {
            if !instance.ports.iter().any(|(known, _)| known.text == port.text) {
                let message =
                    format!("the port `{}` of `{}` is not connected", port.text, instance.name.text);
                self.error(
                    "E-ARITY",
                    instance.name.span,
                    message,
                    Some(format!("connect a {}: `({} …)`", wanted.text, port.text)),
                );
            }
        }
    }
}

fn did_you_mean<'name>(word: &str, known: impl IntoIterator<Item = &'name str> + Clone) -> Option<String> {
    let all: Vec<&str> = known.clone().into_iter().collect();
    nearest(word, known)
        .map(|known| format!("did you mean `{known}`?"))
        .or_else(|| (!all.is_empty() && all.len() <= 12).then(|| format!("use one of {}", all.join(", "))))
}
