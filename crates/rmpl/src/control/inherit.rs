//! Classes with what they inherit: C3 linearisation, then fields merged (SPEC 2.2).

use std::collections::BTreeMap;

use smol_str::SmolStr;

use super::suggest::nearest;
use super::syntax::{Class, Constraint, ControlFile, FieldKind, Initial, Instance, Name};
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
}

/// A class with all its fields.
#[derive(Clone, Debug, Default)]
pub struct MergedClass<'file> {
    /// The names of the class and of all that it extends.
    pub lineage: Vec<SmolStr>,
    /// Its variables, those of the most general class first.
    pub variables: Vec<MergedVariable>,
    pub commands: Vec<MergedVariable>,
    /// Its ports, each with the class of what stands there.
    pub ports: Vec<(&'file Name, &'file Name)>,
    /// Each mode with the constraints that all hold in it.
    pub modes: Vec<(&'file Name, Vec<&'file Constraint>)>,
    /// From, to and guard.
    pub transitions: Vec<(&'file Name, &'file Name, &'file Constraint)>,
    /// From, to and probability.
    pub faults: Vec<(&'file Name, &'file Name, &'file Name)>,
}

impl MergedClass<'_> {
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

/// A component of a plant, with what it can be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComponentModes {
    /// The component.
    pub name: SmolStr,
    /// Its modes, in the order of its class.
    pub modes: Vec<SmolStr>,
    /// The mode that it begins in; of a prior the most likely one, and of those that are equally likely the first.
    pub initial: SmolStr,
}

/// The components of a plant whose classes have modes, in textual order.
pub fn component_modes(file: &ControlFile) -> Vec<ComponentModes> {
    let (classes, _) = merge_all(file);
    let of = |instance: &Instance| {
        let class = classes.get(&instance.class.text)?;
        let modes: Vec<SmolStr> = class.modes.iter().map(|(mode, _)| mode.text.clone()).collect();
        let initial = likeliest(instance, &modes)?;
        Some(ComponentModes { name: instance.name.text.clone(), modes, initial })
    };
    file.instances.iter().filter_map(of).collect()
}

/// The most likely first mode of a component, of equally likely ones the first; `modes` are those of its class.
fn likeliest(instance: &Instance, modes: &[SmolStr]) -> Option<SmolStr> {
    let named = match &instance.initial {
        Initial::Mode(mode) => modes.iter().find(|known| **known == mode.text),
        Initial::FirstMode | Initial::AnyMode => None,
        Initial::Prior(_) => {
            let prior = instance.prior();
            let weight =
                |mode: &SmolStr| prior.iter().find(|(known, _)| known == mode).map(|(_, weight)| *weight);
            // Of several greatest ones the last is taken.
            modes.iter().rev().filter(|mode| weight(mode).is_some()).max_by_key(|mode| weight(mode))
        }
    };
    named.or_else(|| modes.first()).cloned()
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
                | FieldKind::Port { name, .. } => ("name", name),
                FieldKind::Mode { name, .. } => ("mode", name),
                FieldKind::Transition { .. } | FieldKind::Fault { .. } => continue,
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
                    FieldKind::Variable { name, values, observable, shows } => {
                        let new = variable(name, values, *observable, shows.clone());
                        self.join(&mut merged.variables, new);
                    }
                    FieldKind::Command { name, values } => {
                        self.join(&mut merged.commands, variable(name, values, false, None));
                    }
                    FieldKind::Port { name, class } => {
                        merged.ports.retain(|(known, _)| known.text != name.text);
                        merged.ports.push((name, class));
                    }
                    FieldKind::Mode { name, constraint } => {
                        match merged.modes.iter_mut().find(|(known, _)| known.text == name.text) {
                            Some((_, constraints)) => constraints.push(constraint),
                            None => merged.modes.push((name, vec![constraint])),
                        }
                    }
                    FieldKind::Transition { .. } | FieldKind::Fault { .. } => overridden = true,
                }
            }
            if overridden {
                Self::arcs(class, &mut merged);
            }
        }
        merged
    }

    /// A more specific class replaces all arcs between the same two modes.
    fn arcs(class: &'file Class, merged: &mut MergedClass<'file>) {
        let mut transitions = Vec::new();
        let mut faults = Vec::new();
        for field in &class.fields {
            match &field.kind {
                FieldKind::Transition { from, to, guard } => transitions.push((from, to, guard)),
                FieldKind::Fault { from, to, probability } => faults.push((from, to, probability)),
                _ => {}
            }
        }
        let same = |left: (&Name, &Name), right: (&Name, &Name)| {
            left.0.text == right.0.text && left.1.text == right.1.text
        };
        merged.transitions.retain(|old| !transitions.iter().any(|new| same((old.0, old.1), (new.0, new.1))));
        merged.faults.retain(|old| !faults.iter().any(|new| same((old.0, old.1), (new.0, new.1))));
        merged.transitions.extend(transitions);
        merged.faults.extend(faults);
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

fn variable(name: &Name, values: &[Name], observable: bool, shows: Option<Name>) -> MergedVariable {
    let values = values.iter().map(|value| value.text.clone()).collect();
    MergedVariable { name: name.clone(), values, observable, shows }
}
