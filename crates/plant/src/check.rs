//! What is wrong with the classes and components of a text (SPEC 2.2).

use std::collections::BTreeMap;

use rmpl::control::{
    Constraint, ConstraintKind, ControlFile, Initial, MAX_COMPONENTS, Name, PlantComponents, nearest,
};
use rmpl::{Code, Diagnostic, Span, diagnostics};
use smol_str::SmolStr;

use crate::probability;
use crate::value_set::ValueSet;
use rmpl::control::{MergedClass, MergedFault, MergedVariable};

const MAX_VALUES: usize = ValueSet::MOST;

/// Adds what is wrong with the classes and components of a file that parsed without errors.
pub(crate) fn check(
    file: &ControlFile,
    classes: &BTreeMap<SmolStr, MergedClass<'_>>,
    components: &PlantComponents<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut checker = Checker { file, classes, diagnostics };
    for class in &file.classes {
        checker.check_class(&class.name.text);
        checker.check_parts(&class.name.text);
    }
    let mut nested = Vec::new();
    for class in &file.classes {
        checker.check_nesting(&class.name.text, &mut Vec::new(), &mut nested);
    }
    checker.check_instances(components);
    checker.check_components(components);
}

/// What a name in a constraint of a class represents.
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
        let mut diagnostic = Diagnostic::error(Code(code), span, message);
        diagnostic.hint = hint;
        // An inherited field is checked again in every class that extends its own.
        diagnostic.add_once_to(self.diagnostics);
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

    /// Returns what `name` means in a constraint of `class`.
    fn meaning(&self, class: &MergedClass<'_>, name: &str) -> Option<Meaning> {
        let of = |variables: &[MergedVariable], name: &str, is_command| {
            let found = variables.iter().find(|known| known.name.text == name)?;
            Some(Meaning { values: found.values.clone(), is_command })
        };
        let fields = |class: &MergedClass<'_>, name: &str| {
            of(&class.variables, name, false).or_else(|| of(&class.commands, name, true))
        };
        fields(class, name)
            .or_else(|| {
                let reached = class.reached(self.classes, name)?;
                let modes = reached.modes.iter().map(|(mode, _)| mode.text.clone()).collect();
                Some(Meaning { values: modes, is_command: false })
            })
            .or_else(|| {
                let (path, field) = name.rsplit_once('.')?;
                fields(class.reached(self.classes, path)?, field)
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
                    // A port or part of an unknown class has been reported.
                    let first = variable.text.split('.').next().unwrap_or("");
                    if class.neighbor(first).is_some_and(|target| !self.classes.contains_key(&target.text)) {
                        return;
                    }
                    let names =
                        class.variables.iter().chain(&class.commands).map(|known| known.name.text.as_str());
                    let hint = did_you_mean(
                        &variable.text,
                        names
                            .chain(class.ports.iter().map(|(port, _)| port.text.as_str()))
                            .chain(class.parts.iter().map(|part| part.name.text.as_str())),
                    );
                    let message =
                        format!("`{class_name}` has no variable, command, port or part `{}`", variable.text);
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
            let found = diagnostics::value::different_domains(&left.0.text, &right.0.text, right.0.span);
            found.add_once_to(self.diagnostics);
        }
    }

    fn refuse_command(&mut self, command: &Name) {
        let message = format!("a mode cannot constrain the command `{}`", command.text);
        let hint = "use commands only in the guards of transitions".to_owned();
        self.error("E-CONSTRAINT", command.span, message, Some(hint));
    }

    fn check_instances(&mut self, components: &PlantComponents<'_>) {
        let file = self.file;
        let names = components.all().iter().map(|known| known.name.as_str()).collect();
        let class_of = |name: &str| components.named(name).map(|component| component.class.text.clone());
        let surroundings = Surroundings { names, class_of: &class_of };
        for (at, instance) in file.instances.iter().enumerate() {
            if file.instances.iter().take(at).any(|earlier| earlier.name.text == instance.name.text) {
                self.error(
                    "E-DUP",
                    instance.name.span,
                    format!("the component `{}` is already declared", instance.name.text),
                    None,
                );
            }
            self.check_component(
                &instance.name,
                &instance.class,
                &instance.ports,
                &instance.initial,
                &surroundings,
            );
        }
    }

    /// Checks the parts of a class, with the components that it does not have yet in its own names.
    fn check_parts(&mut self, name: &SmolStr) {
        let classes = self.classes;
        let Some(class) = classes.get(name) else { return };
        for part in &class.parts {
            let own = class.ports.iter().map(|(port, _)| port.text.as_str());
            let parts = class.parts.iter().map(|part| part.name.text.as_str());
            let class_of = |path: &str| {
                if path == "self" {
                    return Some(name.clone());
                }
                let path = path.strip_prefix("self.").unwrap_or(path);
                let mut found = name.clone();
                for step in path.split('.') {
                    found = classes.get(&found)?.neighbor(step)?.text.clone();
                }
                Some(found)
            };
            let names = own.chain(parts).chain(["self"]).collect();
            self.check_component(
                part.name,
                part.class,
                part.ports,
                part.initial,
                &Surroundings { names, class_of: &class_of },
            );
        }
    }

    /// One diagnostic per part that closes a cycle of classes inside each other.
    fn check_nesting(&mut self, name: &SmolStr, path: &mut Vec<SmolStr>, nested: &mut Vec<SmolStr>) {
        let classes = self.classes;
        let Some(class) = classes.get(name).filter(|_| !nested.contains(name)) else { return };
        path.push(name.clone());
        for part in &class.parts {
            if path.contains(&part.class.text) {
                let message =
                    format!("a class cannot be inside itself: `{}` is a part of `{name}`", part.class.text);
                let hint = "to refer to another component of the class, use a PORT".to_owned();
                self.error("E-RECURSION", part.class.span, message, Some(hint));
                nested.extend(path.iter().cloned());
            } else {
                self.check_nesting(&part.class.text, path, nested);
            }
        }
        path.pop();
    }

    /// Checks what only all components with their parts show.
    fn check_components(&mut self, components: &PlantComponents<'_>) {
        if let Some(last) = components.all().get(MAX_COMPONENTS) {
            let message = format!("the plant has more than {MAX_COMPONENTS} components with their parts");
            self.error("E-RECURSION", last.class.span, message, None);
        }
        for component in components.all() {
            let first = components.named(&component.name);
            // Two instances with one name are reported at the name.
            let is_reported = || {
                let instances = self.file.instances.iter();
                instances.filter(|instance| instance.name.text == component.name).count() > 1
            };
            if first.is_some_and(|first| !std::ptr::eq(first, component)) && !is_reported() {
                let message = format!("the component `{}` is already declared", component.name);
                self.error("E-DUP", component.span, message, None);
            }
        }
    }

    fn check_component(
        &mut self,
        name: &Name,
        class_name: &Name,
        ports: &[(Name, Name)],
        initial: &Initial,
        surroundings: &Surroundings<'_>,
    ) {
        if !self.file.classes.iter().any(|class| class.name.text == class_name.text) {
            let known = self.file.classes.iter().map(|class| class.name.text.as_str());
            let hint = did_you_mean(&class_name.text, known);
            let message = format!("unknown class `{}`", class_name.text);
            self.error("E-UNDEF", class_name.span, message, hint);
        }
        let classes = self.classes;
        let Some(class) = classes.get(&class_name.text) else { return };
        if class.modes.is_empty() {
            let message = format!("the class `{}` needs at least one mode", class_name.text);
            let hint = "add one, such as `(MODE Present true)`".to_owned();
            self.error("E-FORM", class_name.span, message, Some(hint));
        }
        for mode in initial.modes() {
            self.check_mode(class, &class_name.text, mode);
        }
        for (at, (port, component)) in ports.iter().enumerate() {
            let Some((_, wanted)) = class.ports.iter().find(|(known, _)| known.text == port.text) else {
                let hint = did_you_mean(&port.text, class.ports.iter().map(|(known, _)| known.text.as_str()));
                let message = format!("`{}` has no port `{}`", class_name.text, port.text);
                self.error("E-UNDEF", port.span, message, hint);
                continue;
            };
            if ports.iter().take(at).any(|(earlier, _)| earlier.text == port.text) {
                let message = format!("the port `{}` is already connected", port.text);
                self.error("E-DUP", port.span, message, None);
            }
            let Some(other) = (surroundings.class_of)(&component.text) else {
                let hint = did_you_mean(&component.text, surroundings.names.iter().copied());
                let message = format!("unknown component `{}`", component.text);
                self.error("E-UNDEF", component.span, message, hint);
                continue;
            };
            if !classes.get(&other).is_none_or(|class| class.lineage.contains(&wanted.text)) {
                let message = format!(
                    "the port `{}` takes a {}, but `{}` is a {other}",
                    port.text, wanted.text, component.text
                );
                self.error("E-VALUE", component.span, message, None);
            }
        }
        for (port, wanted) in &class.ports {
            if !ports.iter().any(|(known, _)| known.text == port.text) {
                let message = format!("the port `{}` of `{}` is not connected", port.text, name.text);
                let hint = format!("connect a {}: `({} …)`", wanted.text, port.text);
                self.error("E-ARITY", name.span, message, Some(hint));
            }
        }
    }
}

/// What a component may be connected to.
struct Surroundings<'check> {
    names: Vec<&'check str>,
    class_of: &'check dyn Fn(&str) -> Option<SmolStr>,
}

fn did_you_mean<'name>(word: &str, known: impl IntoIterator<Item = &'name str> + Clone) -> Option<String> {
    let all: Vec<&str> = known.clone().into_iter().collect();
    nearest(word, known)
        .map(|known| format!("did you mean `{known}`?"))
        .or_else(|| (!all.is_empty() && all.len() <= 12).then(|| format!("use one of {}", all.join(", "))))
}
