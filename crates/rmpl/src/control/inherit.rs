//! Classes with what they inherit: C3 linearization, then fields merged (SPEC 2.2).

use std::collections::BTreeMap;

use smol_str::SmolStr;

use super::suggest::nearest;
use super::syntax::{Class, Constraint, ControlFile, Expression, FieldKind, Initial, Name};
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

/// A variable after inheritance.
#[derive(Clone, Debug)]
pub struct MergedVariable {
    /// As the most specific class writes it.
    pub name: Name,
    /// The values that all classes leave it.
    pub values: Vec<SmolStr>,
    /// Whether it can be observed.
    pub observable: bool,
    /// What it shows, if it says so.
    pub shows: Option<Name>,
    /// How probable it is that another value is observed, if it says so.
    pub error: Option<Name>,
}

/// A transition after inheritance.
#[derive(Clone, Debug)]
pub struct MergedTransition<'file> {
    pub from: &'file Name,
    pub to: &'file Name,
    pub guard: &'file Constraint,
    /// For a transition from `*`, the guards of the transitions that take precedence.
    pub unless: Vec<&'file Constraint>,
    pub probability: Option<&'file Name>,
}

/// A fault after inheritance.
#[derive(Clone, Debug)]
pub struct MergedFault<'file> {
    pub from: &'file Name,
    pub to: &'file Name,
    pub probability: &'file Name,
    pub guard: Option<&'file Constraint>,
}

/// A part after inheritance.
#[derive(Clone, Debug)]
pub struct MergedPart<'file> {
    pub name: &'file Name,
    pub class: &'file Name,
    /// Its ports with what they are connected to, in the names of the class that declares it.
    pub ports: &'file [(Name, Name)],
    pub initial: &'file Initial,
    /// Where it is declared.
    pub span: Span,
}

/// A method after inheritance.
#[derive(Clone, Debug)]
pub struct MergedMethod<'file> {
    pub name: &'file Name,
    pub parameters: &'file [Name],
    pub body: &'file Expression,
    /// Where it is declared.
    pub span: Span,
}

/// A class with all its fields.
#[derive(Clone, Debug, Default)]
pub struct MergedClass<'file> {
    /// The names of the class and of all that it extends.
    pub lineage: Vec<SmolStr>,
    /// Its variables, those of the most general class first.
    pub variables: Vec<MergedVariable>,
    pub commands: Vec<MergedVariable>,
    /// Its ports, each with the class of what is there.
    pub ports: Vec<(&'file Name, &'file Name)>,
    pub parts: Vec<MergedPart<'file>>,
    pub methods: Vec<MergedMethod<'file>>,
    /// Each mode with the constraints that all hold in it.
    pub modes: Vec<(&'file Name, Vec<&'file Constraint>)>,
    pub transitions: Vec<MergedTransition<'file>>,
    pub faults: Vec<MergedFault<'file>>,
}

impl MergedClass<'_> {
    /// The class of the port or part of this name.
    pub fn neighbor(&self, name: &str) -> Option<&Name> {
        let port = self.ports.iter().find(|(port, _)| port.text == name).map(|(_, class)| *class);
        port.or_else(|| self.parts.iter().find(|part| part.name.text == name).map(|part| part.class))
    }

    /// The class that a path of ports and parts leads to, such as `valve.driver`.
    pub fn reached<'class>(
        &'class self,
        classes: &'class BTreeMap<SmolStr, Self>,
        path: &str,
    ) -> Option<&'class Self> {
        path.split('.').try_fold(self, |class, step| classes.get(&class.neighbor(step)?.text))
    }

    /// The place of a mode.
    pub fn mode(&self, name: &str) -> Option<usize> {
        self.modes.iter().position(|(mode, _)| mode.text == name)
    }
}

/// All classes by name, and what is wrong with them.
pub fn merge_all(file: &ControlFile) -> (BTreeMap<SmolStr, MergedClass<'_>>, Vec<Diagnostic>) {
    let mut merger = Merger { classes: BTreeMap::new(), diagnostics: Vec::new(), on_circles: Vec::new() };
    for class in &file.classes {
        if merger.classes.insert(class.name.text.as_str(), class).is_some() {
            merger.error(
                "E-DUP",
                class.name.span,
                format!("the class `{}` is already declared", class.name.text),
            );
        }
    }
    let mut merged = BTreeMap::new();
    for class in &file.classes {
        merger.supers_exist(class);
        merger.duplicates(class);
        if let Some(lineage) = merger.linearize(class) {
            merged.insert(class.name.text.clone(), merger.merge(&lineage));
        }
    }
    (merged, merger.diagnostics)
}

struct Merger<'file> {
    classes: BTreeMap<&'file str, &'file Class>,
    diagnostics: Vec<Diagnostic>,
    /// Classes on a cycle that has been reported.
    on_circles: Vec<&'file str>,
}

impl<'file> Merger<'file> {
    fn error(&mut self, code: &'static str, span: Span, message: String) -> &mut Diagnostic {
        self.diagnostics.push(Diagnostic::error(Code(code), span, message));
        let last = self.diagnostics.len() - 1;
        &mut self.diagnostics[last]
    }

    fn supers_exist(&mut self, class: &'file Class) {
        for parent in &class.supers {
            if !self.classes.contains_key(parent.text.as_str()) {
                let hint = nearest(&parent.text, self.classes.keys().copied())
                    .map(|known| format!("did you mean `{known}`?"));
                self.error("E-UNDEF", parent.span, format!("unknown class `{}`", parent.text)).hint = hint;
            }
        }
    }

    fn duplicates(&mut self, class: &'file Class) {
        let mut names: Vec<(&str, &str)> = Vec::new();
        for field in &class.fields {
            let (kind, name) = match &field.kind {
                FieldKind::Variable { name, .. }
                | FieldKind::Command { name, .. }
                | FieldKind::Port { name, .. }
                | FieldKind::Part { name, .. } => ("name", name),
                FieldKind::Method { name, .. } => ("method", name),
                FieldKind::Mode { name, .. } => ("mode", name),
                FieldKind::Transition { .. } | FieldKind::Fault { .. } | FieldKind::Behavior(_) => continue,
            };
            if names.contains(&(kind, name.text.as_str())) {
                self.error(
                    "E-DUP",
                    name.span,
                    format!("`{}` declares `{}` twice", class.name.text, name.text),
                );
            }
            names.push((kind, name.text.as_str()));
        }
    }

    /// The class and its ancestors, most specific first; `None` (with one diagnostic per culprit) if there is none.
    fn linearize(&mut self, class: &'file Class) -> Option<Vec<&'file Class>> {
        let mut path = Vec::new();
        match self.c3(class, &mut path) {
            Ok(lineage) => Some(lineage),
            Err(culprit) => {
                let is_reported = path.iter().any(|name| self.on_circles.contains(name));
                if culprit.name.text == class.name.text && !is_reported {
                    let name = &class.name.text;
                    let (code, message) = if path.is_empty() {
                        (
                            "E-FORM",
                            format!(
                                "the classes that `{name}` extends have contradictory inheritance orders"
                            ),
                        )
                    } else {
                        ("E-RECURSION", format!("`{name}` extends itself"))
                    };
                    self.on_circles.extend(path);
                    self.error(code, class.name.span, message);
                }
                None
            }
        }
    }

    fn c3(&self, class: &'file Class, path: &mut Vec<&'file str>) -> Result<Vec<&'file Class>, &'file Class> {
        if path.contains(&class.name.text.as_str()) {
            return Err(class);
        }
        path.push(class.name.text.as_str());
        let parents: Vec<&Class> = class
            .supers
            .iter()
            .filter_map(|parent| self.classes.get(parent.text.as_str()).copied())
            .collect();
        let mut lists: Vec<Vec<&Class>> = Vec::new();
        for parent in &parents {
            lists.push(self.c3(parent, path)?);
        }
        path.pop();
        lists.push(parents);
        let mut lineage = vec![class];
        loop {
            lists.retain(|list| !list.is_empty());
            if lists.is_empty() {
                return Ok(lineage);
            }
            let later = |candidate: &Class| {
                lists
                    .iter()
                    .any(|list| list.iter().skip(1).any(|other| other.name.text == candidate.name.text))
            };
            let Some(next) =
                lists.iter().filter_map(|list| list.first().copied()).find(|first| !later(first))
            else {
                return Err(class);
            };
            lineage.push(next);
            for list in &mut lists {
                list.retain(|other| other.name.text != next.name.text);
            }
        }
    }

    /// Joins the fields, from the most general class to the most specific.
    fn merge(&mut self, lineage: &[&'file Class]) -> MergedClass<'file> {
        let mut merged = MergedClass {
            lineage: lineage.iter().map(|class| class.name.text.clone()).collect(),
            ..MergedClass::default()
        };
        for class in lineage.iter().rev() {
            let mut overridden = false;
            for field in &class.fields {
                match &field.kind {
                    FieldKind::Variable { name, values, observable, shows, error } => {
                        let new = MergedVariable {
                            observable: *observable,
                            shows: shows.clone(),
                            error: error.clone(),
                            ..variable(name, values)
                        };
                        self.join(&mut merged.variables, new);
                    }
                    FieldKind::Command { name, values } => {
                        self.join(&mut merged.commands, variable(name, values));
                    }
                    FieldKind::Port { name, class } => {
                        merged.ports.retain(|(known, _)| known.text != name.text);
                        merged.ports.push((name, class));
                    }
                    FieldKind::Part { name, class, ports, initial } => {
                        let part = MergedPart { name, class, ports, initial, span: field.span };
                        match merged.parts.iter_mut().find(|known| known.name.text == name.text) {
                            Some(known) => *known = part,
                            None => merged.parts.push(part),
                        }
                    }
                    FieldKind::Method { name, parameters, body } => {
                        let method = MergedMethod { name, parameters, body, span: field.span };
                        match merged.methods.iter_mut().find(|known| known.name.text == name.text) {
                            Some(known) => *known = method,
                            None => merged.methods.push(method),
                        }
                    }
                    FieldKind::Mode { name, constraint } => {
                        match merged.modes.iter_mut().find(|(known, _)| known.text == name.text) {
                            Some((_, constraints)) => constraints.push(constraint),
                            None => merged.modes.push((name, vec![constraint])),
                        }
                    }
                    FieldKind::Transition { .. } | FieldKind::Fault { .. } => overridden = true,
                    // A behavior is written out as modes and transitions first, and then classes are merged again.
                    FieldKind::Behavior(_) => {}
                }
            }
            if overridden {
                self.arcs(class, &mut merged);
            }
        }
        merged
    }

    /// A more specific class replaces all arcs between the same two modes.
    fn arcs(&self, class: &'file Class, merged: &mut MergedClass<'file>) {
        let transitions = self.transitions(class);
        let faults = self.faults(class);
        let same = |left: (&Name, &Name), right: (&Name, &Name)| {
            left.0.text == right.0.text && left.1.text == right.1.text
        };
        merged
            .transitions
            .retain(|old| !transitions.iter().any(|new| same((old.from, old.to), (new.from, new.to))));
        merged.faults.retain(|old| !faults.iter().any(|new| same((old.from, old.to), (new.from, new.to))));
        merged.transitions.extend(transitions);
        merged.faults.extend(faults);
    }

    /// The transitions that a class writes. One from `*` gives way to those that name the mode, where their guards hold.
    fn transitions(&self, class: &'file Class) -> Vec<MergedTransition<'file>> {
        let mut transitions = Vec::new();
        for field in &class.fields {
            let FieldKind::Transition { from, to, guard, probability } = &field.kind else { continue };
            let probability = probability.as_ref();
            if let Some(from) = from {
                transitions.push(MergedTransition { from, to, guard, unless: Vec::new(), probability });
                continue;
            }
            for from in self.modes(class).into_iter().filter(|mode| mode.text != to.text) {
                let named = class.fields.iter().filter_map(|field| match &field.kind {
                    FieldKind::Transition { from: Some(named), guard, .. } if named.text == from.text => {
                        Some(guard)
                    }
                    _ => None,
                });
                transitions.push(MergedTransition { from, to, guard, unless: named.collect(), probability });
            }
        }
        transitions
    }

    /// The faults that a class writes. One from `*` gives way to those that name both modes.
    fn faults(&self, class: &'file Class) -> Vec<MergedFault<'file>> {
        let is_named = |mode: &Name, target: &Name| {
            class.fields.iter().any(|field| match &field.kind {
                FieldKind::Fault { from: Some(from), to, .. } => {
                    from.text == mode.text && to.text == target.text
                }
                _ => false,
            })
        };
        let mut faults = Vec::new();
        for field in &class.fields {
            let FieldKind::Fault { from, to, probability, guard } = &field.kind else { continue };
            let origins = match from {
                Some(from) => vec![from],
                None => self
                    .modes(class)
                    .into_iter()
                    .filter(|mode| mode.text != to.text && !is_named(mode, to))
                    .collect(),
            };
            let guard = guard.as_ref();
            faults.extend(origins.into_iter().map(|from| MergedFault { from, to, probability, guard }));
        }
        faults
    }

    /// The modes of a class, own and inherited, in the order of its merged form.
    fn modes(&self, class: &'file Class) -> Vec<&'file Name> {
        let lineage = self.c3(class, &mut Vec::new()).unwrap_or_default();
        let mut modes: Vec<&Name> = Vec::new();
        for field in lineage.iter().rev().flat_map(|class| &class.fields) {
            if let FieldKind::Mode { name, .. } = &field.kind
                && !modes.iter().any(|known| known.text == name.text)
            {
                modes.push(name);
            }
        }
        modes
    }

    fn join(&mut self, known: &mut Vec<MergedVariable>, new: MergedVariable) {
        let Some(old) = known.iter_mut().find(|old| old.name.text == new.name.text) else {
            known.push(new);
            return;
        };
        let values: Vec<SmolStr> =
            new.values.iter().filter(|value| old.values.contains(value)).cloned().collect();
        old.observable |= new.observable;
        old.shows = new.shows.or(old.shows.take());
        old.error = new.error.or(old.error.take());
        old.name = new.name;
        if values.is_empty() {
            let (span, name) = (old.name.span, old.name.text.clone());
            if !self.diagnostics.iter().any(|known| known.span == span) {
                self.error(
                    "E-VALUE",
                    span,
                    format!(
                        "`{name}` has no possible value: the classes that declare it have no value in common"
                    ),
                );
            }
        } else {
            old.values = values;
        }
    }
}

fn variable(name: &Name, values: &[Name]) -> MergedVariable {
    let values = values.iter().map(|value| value.text.clone()).collect();
    MergedVariable { name: name.clone(), values, observable: false, shows: None, error: None }
}
