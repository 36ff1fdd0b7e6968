//! The text of the plant model: which attributes are variables, commands and parts, and a class for each class.

mod interface;
mod probability;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use interface::idle;
use probability::{RANKS, decimal};

use super::error::JmplError;
use super::evaluate::{Evaluator, Kind, MAX_PARTS, Names};
use super::formula::{Formula, name};
use super::harness::Harness;
use super::syntax::{Arc, Attribute, Class, Enum, File, Place};
use crate::Translation;

/// The mode of a class that has no state vector.
const ONLY_MODE: &str = "ok";

/// The end of the name of a class that holds a command for constraints.
const LINE: &str = "-line";

/// The value of a command that no type has a name for.
const IDLE: &str = "none";

/// An attribute by the class that first declares it.
type Key<'file> = (&'file str, &'file str);

pub(super) struct Writer<'file> {
    files: &'file [&'file str],
    harness: &'file Harness,
    evaluator: Evaluator<'file>,
    /// The first so many files were asked for; the others are the library.
    asked_files: usize,
    /// Files of the library that are not JMPL.
    unread: Vec<String>,
    /// Classes that get a component.
    roots: Vec<&'file Class>,
    /// Classes that are written.
    needed: Vec<&'file Class>,
    /// Per class what its statements state.
    constraints: BTreeMap<&'file str, Formula<'file>>,
    /// Attributes that constraints speak of.
    constrained: BTreeSet<Key<'file>>,
    /// Attributes that transitions of their own class ask for.
    asked: BTreeSet<Key<'file>>,
    /// Attributes that transitions of other classes ask for.
    asked_from_afar: BTreeSet<Key<'file>>,
    commanded: BTreeSet<Key<'file>>,
    observed: BTreeSet<Key<'file>>,
    /// Types of which commands are held for constraints.
    lines: BTreeMap<&'file str, &'file Enum>,
    /// Per class the mode in which its components start.
    starts: BTreeMap<&'file str, String>,
    /// Per class and part a mode in which the part starts instead.
    part_starts: BTreeMap<(&'file str, String), String>,
}

impl<'file> Writer<'file> {
    pub(super) fn new(
        files: &'file [&'file str],
        parsed: &'file [File],
        asked: usize,
        harness: &'file Harness,
        unread: Vec<String>,
    ) -> Self {
        let evaluator = Evaluator::new(Names::new(parsed));
        let own: Vec<&Class> = parsed.iter().take(asked).flat_map(|file| &file.classes).collect();
        let is_used = |class: &Class| {
            let attributes = own.iter().filter(|other| other.name != class.name);
            attributes
                .clone()
                .flat_map(|other| &other.attributes)
                .any(|attribute| attribute.kind == class.name)
                || attributes.clone().any(|other| other.parent.as_deref() == Some(&*class.name))
        };
        let roots: Vec<&Class> = own.iter().copied().filter(|class| !is_used(class)).collect();
        let mut writer = Self {
            files,
            harness,
            evaluator,
            asked_files: asked,
            unread,
            roots,
            needed: Vec::new(),
            constraints: BTreeMap::new(),
            constrained: BTreeSet::new(),
            asked: BTreeSet::new(),
            asked_from_afar: BTreeSet::new(),
            commanded: BTreeSet::new(),
            observed: BTreeSet::new(),
            lines: BTreeMap::new(),
            starts: BTreeMap::new(),
            part_starts: BTreeMap::new(),
        };
        for class in own {
            writer.need(class);
        }
        writer
    }

    const fn names(&self) -> &Names<'file> {
        &self.evaluator.names
    }

    /// Notes that a class is written, and those that it needs.
    fn need(&mut self, class: &'file Class) {
        let mut waiting = vec![class];
        while let Some(class) = waiting.pop() {
            let is_declared = self.names().classes.get(&*class.name);
            if !is_declared.is_some_and(|declared| std::ptr::eq(*declared, class))
                || self.needed.iter().any(|known| known.name == class.name)
            {
                continue;
            }
            self.needed.push(class);
            let names = self.names();
            let parts =
                class.attributes.iter().rev().filter_map(|attribute| match names.kind(class, attribute)? {
                    Kind::Class(part) => Some(part),
                    Kind::Enum(_) => None,
                });
            let parent = names.lineage(class).get(1).copied();
            waiting.extend(parts.chain(parent));
        }
    }

    pub(super) fn write(mut self) -> Result<Translation, JmplError> {
        for (class, place) in self.evaluator.names.again.clone() {
            // A library may have classes that the model replaces.
            if place.file < self.asked_files && self.needed.iter().any(|known| known.name == class) {
                self.evaluator
                    .leave_out(place, format!("class `{class}` is declared again; the first one is used"));
            }
        }
        for class in self.needed.clone() {
            let constraint = self.evaluator.constraint(class, &class.statements);
            constraint.symbols(&mut |symbol| {
                if !symbol.is_mode {
                    self.constrained.extend(self.evaluator.names.key(class, &symbol.path));
                }
            });
            self.constraints.insert(&class.name, constraint);
        }
        let mut guards = BTreeMap::new();
        for class in self.needed.clone() {
            let arcs = class.arcs.iter().filter_map(|arc| Some((arc, self.guard(class, arc)?)));
            guards.insert(&*class.name, arcs.collect::<Vec<_>>());
        }
        if self.evaluator.is_too_large() {
            return Err(JmplError::TooMany { what: "parts of constraints", most: MAX_PARTS });
        }
        self.find_interface()?;
        self.find_starts();
        let mut text = String::new();
        let needed = self.needed.clone();
        for class in &needed {
            text += &self.class(class, &guards);
        }
        for (kind, domain) in &self.lines {
            text += &line_class(kind, domain);
        }
        for class in self.roots.clone() {
            text += &self.instance(class);
        }
        let place = |place: &Place| format!("{}:{}", self.files.get(place.file).unwrap_or(&"?"), place.line);
        let mut left_out = self.evaluator.left_out;
        left_out.sort();
        let mut left_out: Vec<String> =
            left_out.iter().map(|(at, what)| format!("{}: {what}", place(at))).collect();
        if left_out.iter().any(|what| what.contains("unknown type") || what.contains("unknown class")) {
            left_out.extend(self.unread);
        }
        let comments = left_out
            .iter()
            .map(|what| format!("; Not read: {what}\n"))
            .chain(self.evaluator.remarks.iter().map(|remark| format!("; Note: {remark}\n")));
        let text = comments.collect::<String>() + &text;
        Ok(Translation { text: rmpl::control::format(&text), remarks: self.evaluator.remarks, left_out })
    }

    /// The guard of an arc, with what it speaks of noted; `None` if the arc is left out.
    fn guard(&mut self, class: &'file Class, arc: &'file Arc) -> Option<Formula<'file>> {
        match self.evaluator.guard(class, &arc.body) {
            Ok(guard) => {
                guard.symbols(&mut |symbol| {
                    let key = self.evaluator.names.key(class, &symbol.path);
                    let is_own = !symbol.path.contains('.');
                    let asked = if is_own { &mut self.asked } else { &mut self.asked_from_afar };
                    asked.extend(key.filter(|_| !symbol.is_mode));
                });
                Some(guard)
            }
            Err(what) => {
                let kind = if arc.is_failure { "failure" } else { "transition" };
                self.evaluator.leave_out(arc.place, format!("this {kind}: {what}"));
                None
            }
        }
    }

    /// Returns whether components of a class, or parts of them, have modes.
    fn has_state(&self, class: &'file Class) -> bool {
        let mut visited: BTreeSet<&str> = BTreeSet::new();
        let mut waiting = vec![class];
        while let Some(class) = waiting.pop() {
            if self.names().modes(class).is_some() {
                return true;
            }
            if visited.insert(&class.name) {
                for declaring in self.names().lineage(class) {
                    let kinds = declaring.attributes.iter().map(|it| self.names().kind(declaring, it));
                    waiting.extend(kinds.filter_map(|kind| match kind? {
                        Kind::Class(part) => Some(part),
                        Kind::Enum(_) => None,
                    }));
                }
            }
        }
        false
    }

    fn instance(&self, class: &'file Class) -> String {
        if !self.has_state(class) {
            return String::new();
        }
        format!("(DEFINSTANCE {} {})\n", name(&self.root_name(class)), name(&class.name))
    }

    /// The text of a class.
    fn class(
        &mut self,
        class: &'file Class,
        guards: &BTreeMap<&'file str, Vec<(&'file Arc, Formula<'file>)>>,
    ) -> String {
        if let Some(parent) = &class.parent
            && !self.names().classes.contains_key(&**parent)
        {
            self.evaluator
                .leave_out(class.place, format!("unknown class `{parent}`, which `{}` extends", class.name));
        }
        let lineage = self.names().lineage(class);
        let state = self.state(class);
        let parent = lineage.get(1).copied();
        // Modes of what a class extends are its own modes, too.
        let inherited = parent
            .filter(|parent| self.state(parent).map(|(class, _)| class) == state.map(|(class, _)| class));
        let merged: Vec<&Class> =
            if inherited.is_some() { vec![class] } else { lineage.iter().rev().copied().collect() };
        let mut text = format!("(DEFCLASS {} (", name(&class.name));
        text += &inherited.map(|parent| name(&parent.name)).unwrap_or_default();
        text += ")\n";
        let mut declared: BTreeSet<&str> = BTreeSet::new();
        for part in &merged {
            for attribute in &part.attributes {
                let is_inherited =
                    inherited.is_some_and(|parent| self.names().attribute(parent, &attribute.name).is_some());
                if !is_inherited
                    && !self.names().is_state(class, &attribute.name)
                    && declared.insert(&attribute.name)
                {
                    text += &self.attribute(part, attribute);
                }
            }
        }
        let modes: Vec<&str> = match state {
            Some((_, modes)) => modes.values.iter().map(String::as_str).collect(),
            None => vec![ONLY_MODE],
        };
        let mut ordered = modes.clone();
        let start = self.starts.get(&*class.name);
        ordered.sort_by_key(|mode| start.is_some_and(|start| start != mode));
        let constraint: Vec<Formula<'_>> =
            merged.iter().filter_map(|part| self.constraints.get(&*part.name).cloned()).collect();
        let constraint = Formula::All(constraint);
        let mut possible = Vec::new();
        for mode in &ordered {
            let holds = constraint.in_mode(mode).simplified();
            if holds == Formula::Constant(false) {
                let what =
                    format!("the mode `{mode}` of `{}`: its constraint contradicts itself", class.name);
                self.evaluator.leave_out(class.place, what);
                continue;
            }
            possible.push(*mode);
            if inherited.is_some() && holds == Formula::Constant(true) {
                continue;
            }
            let _ = writeln!(text, "(MODE {} {holds})", name(mode));
        }
        for part in &merged {
            for (arc, guard) in guards.get(&*part.name).into_iter().flatten() {
                let is_left_out = |mode: &String| modes.contains(&&**mode) && !possible.contains(&&**mode);
                if !arc.from.iter().chain(&arc.to).any(is_left_out) {
                    text += &self.arc(class, &possible, arc, guard);
                }
            }
        }
        text.truncate(text.trim_end().len());
        text + ")\n"
    }

    /// The class and the type of a state vector, by the class that declares it.
    fn state(&self, class: &'file Class) -> Option<(*const Class, &'file Enum)> {
        self.names().modes(class).map(|(owner, modes)| (std::ptr::from_ref(owner), modes))
    }

    fn attribute(&mut self, class: &'file Class, attribute: &'file Attribute) -> String {
        let own = name(&attribute.name);
        match self.names().kind(class, attribute) {
            Some(Kind::Enum(domain)) if domain.values.is_empty() => {
                let what =
                    format!("the attribute `{}`: its type `{}` has no values", attribute.name, domain.name);
                self.evaluator.leave_out(attribute.place, what);
                String::new()
            }
            Some(Kind::Enum(domain)) => self.variable(class, attribute, &own, domain),
            Some(Kind::Class(part)) => {
                let start = self.part_starts.get(&(&*class.name, attribute.name.clone()));
                let start = start.filter(|start| self.starts.get(&*part.name) != Some(start));
                let start = start.map_or_else(String::new, |mode| format!(" INIT {}", name(mode)));
                format!("(PART {own} {}{start})\n", name(&part.name))
            }
            None => {
                let what = format!("the attribute `{}`: unknown type `{}`", attribute.name, attribute.kind);
                self.evaluator.leave_out(attribute.place, what);
                String::new()
            }
        }
    }

    /// The text of an attribute that has values: a variable, a command, or a part that holds a command.
    fn variable(
        &mut self,
        class: &'file Class,
        attribute: &Attribute,
        own: &str,
        domain: &'file Enum,
    ) -> String {
        let key = self.names().key(class, &attribute.name);
        let has = |keys: &BTreeSet<Key<'file>>| key.is_some_and(|key| keys.contains(&key));
        let is_command = has(&self.commanded);
        if is_command && !has(&self.constrained) && !has(&self.asked_from_afar) {
            return format!("(COMMAND {own} {{{}}})\n", command_values(domain));
        }
        if is_command {
            self.lines.insert(&domain.name, domain);
            self.evaluator.remark(format!(
                "constraints mention the command `{}` of `{}`: it arrives one step after it is given",
                attribute.name, class.name
            ));
            return format!("(PART {own} {}{LINE})\n", name(&domain.name));
        }
        let is_observed =
            if self.harness.has_interface { has(&self.observed) } else { !attribute.is_private };
        let values = domain.values.iter().map(|value| name(value)).collect::<Vec<_>>().join(" ");
        format!("(VAR {own} {{{values}}}{})\n", if is_observed { " OBSERVABLE" } else { "" })
    }

    fn arc(
        &mut self,
        class: &'file Class,
        modes: &[&str],
        arc: &'file Arc,
        guard: &Formula<'file>,
    ) -> String {
        let kind = if arc.is_failure { "failure" } else { "transition" };
        let ([from], [to]) = (&*arc.from, &*arc.to) else {
            let what = format!("this {kind}: a state vector of several variables");
            self.evaluator.leave_out(arc.place, what);
            return String::new();
        };
        let unknown = [from, to].into_iter().find(|mode| !modes.contains(&mode.as_str()) && **mode != "*");
        if let Some(mode) = unknown.or_else(|| Some(to).filter(|to| **to == "*")) {
            let what = match mode.as_str() {
                "*" | "+" | "." => format!("this {kind}: `{mode}` is not supported here"),
                _ => format!("this {kind}: `{}` has no mode `{mode}`", class.name),
            };
            self.evaluator.leave_out(arc.place, what);
            return String::new();
        }
        let mut weight = String::new();
        if arc.is_failure {
            let Some(probability) = self.probability(arc) else { return String::new() };
            weight = probability;
        } else if arc.weight.is_some() {
            self.evaluator.remark("costs of transitions are not used".to_owned());
        }
        // What a guard says of the component's own mode is decided where the arc begins.
        let starts: Vec<&str> = if from == "*" && guard.speaks_of_own_mode() {
            modes.iter().copied().filter(|mode| mode != to).collect()
        } else {
            vec![from]
        };
        let mut text = String::new();
        for start in starts {
            let guard = guard.in_mode(start).simplified();
            let from = if start == "*" { start.to_owned() } else { name(start) };
            let to = name(to);
            let _ = match (arc.is_failure, &guard) {
                (_, Formula::Constant(false)) => Ok(()),
                (true, Formula::Constant(true)) => writeln!(text, "(FAULT {from} {to} {weight})"),
                (true, _) => writeln!(text, "(FAULT {from} {to} {weight} {guard})"),
                (false, _) => writeln!(text, "(TRANSITION {from} {to} {guard})"),
            };
        }
        if text.is_empty() {
            self.evaluator.leave_out(arc.place, format!("this {kind}: its condition can never hold"));
        }
        text
    }

    fn probability(&mut self, arc: &'file Arc) -> Option<String> {
        let given = arc.weight.as_deref().unwrap_or("rare");
        if arc.weight.is_none() {
            self.evaluator.remark("a failure without a probability is read as `rare`".to_owned());
        }
        let rank = RANKS.iter().find(|(rank, _)| *rank == given);
        let number = match (self.names().number(given), rank) {
            (Some(number), _) => number,
            (None, Some((_, number))) => {
                self.evaluator.remark(format!(
                    "no file defines the probability `{given}`: Enroute uses {number}, from Livingstone's ranks"
                ));
                number
            }
            (None, None) => given,
        };
        let decimal = decimal(number);
        if decimal.is_none() {
            let what = format!("this failure: `{given}` is not a probability above 0 and at most 1");
            self.evaluator.leave_out(arc.place, what);
        }
        decimal
    }
}

/// The values of a command, the idle one first.
fn command_values(domain: &Enum) -> String {
    let idle = idle(domain).unwrap_or(IDLE);
    let others = domain.values.iter().filter(|value| *value != idle).map(|value| name(value));
    std::iter::once(name(idle)).chain(others).collect::<Vec<_>>().join(" ")
}

/// A class whose mode is the last command, so that constraints can speak of it. Without an idle value in the type, a command
/// lasts until the next one.
fn line_class(kind: &str, domain: &Enum) -> String {
    let idle_value = idle(domain);
    let mut text =
        format!("(DEFCLASS {}{LINE} () (COMMAND cmd {{{}}})\n", name(kind), command_values(domain));
    let mut values: Vec<&str> = domain.values.iter().map(String::as_str).collect();
    values.sort_by_key(|value| Some(*value) != idle_value);
    for value in &values {
        let _ = writeln!(text, "(MODE {} true)", name(value));
    }
    for value in &values {
        let _ = writeln!(text, "(TRANSITION * {0} (cmd = {0}))", name(value));
    }
    text.truncate(text.trim_end().len());
    text + ")\n"
}
