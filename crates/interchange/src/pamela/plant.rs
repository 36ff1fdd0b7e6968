//! The text of a plant model: classes with modes, whose transitions methods command.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::classes::{Class, Method};
use super::names::{constant, mode_of, name, number};
use super::tree::Tree;
use crate::Translation;

/// The mode of a class that has no modes.
const ONLY_MODE: &str = "ok";

/// The command of a class whose methods change its mode.
const COMMAND: &str = "command";

pub(super) struct Writer<'file> {
    classes: &'file [Class<'file>],
    file: &'file str,
    remarks: Vec<String>,
    left_out: Vec<(u32, String)>,
}

/// A name of a class, by what it is.
enum Meaning<'file> {
    /// A variable, with its values.
    Variable(Vec<String>),
    /// The same as an argument.
    Argument(&'file str),
    Part(&'file Class<'file>, &'file [Tree]),
}

impl<'file> Writer<'file> {
    pub(super) const fn new(classes: &'file [Class<'file>], file: &'file str) -> Self {
        Self { classes, file, remarks: Vec::new(), left_out: Vec::new() }
    }

    pub(super) fn write(mut self) -> Translation {
        let mut text = String::new();
        for class in self.classes.iter().filter(|class| !class.is_enumeration()) {
            text += &self.class(class);
        }
        for class in self.classes.iter().filter(|class| !class.is_enumeration()) {
            let is_made = self.classes.iter().any(|other| {
                other.inherits.contains(&class.name)
                    || other
                        .fields
                        .iter()
                        .any(|field| made(field.value).is_some_and(|(head, _)| head == class.name))
            });
            if !is_made {
                let _ = writeln!(text, "(DEFINSTANCE {0} {0})", name(class.name));
            }
        }
        self.left_out.sort();
        self.left_out.dedup();
        let left_out: Vec<String> =
            self.left_out.iter().map(|(line, what)| format!("{}:{line}: {what}", self.file)).collect();
        let comments = left_out.iter().map(|what| format!("; Not read: {what}\n"));
        let notes = self.remarks.iter().map(|remark| format!("; Note: {remark}\n"));
        let text = comments.chain(notes).collect::<String>() + &text;
        Translation { text: rmpl::control::format(&text), remarks: self.remarks, left_out }
    }

    fn leave_out(&mut self, line: u32, what: String) {
        self.left_out.push((line, what));
    }

    fn remark(&mut self, what: &str) {
        if !self.remarks.iter().any(|known| known == what) {
            self.remarks.push(what.to_owned());
        }
    }

    fn class(&mut self, class: &'file Class<'file>) -> String {
        let mut text = format!("(DEFCLASS {} ()\n", name(class.name));
        let mut connections = Vec::new();
        let mut declared = BTreeSet::new();
        for argument in &class.arguments {
            let values = self.values(class, argument);
            if values.len() > 1 && declared.insert(*argument) {
                let _ = writeln!(text, "(VAR {} {{{}}})", name(argument), values.join(" "));
            }
        }
        for field in &class.fields {
            match self.meaning(class, field.name) {
                Some(Meaning::Part(part, given)) => {
                    let _ = writeln!(text, "(PART {} {})", name(field.name), name(part.name));
                    for (argument, given) in part.arguments.iter().zip(given) {
                        let own = given.word().filter(|word| {
                            let values = self.values(class, word);
                            values.len() > 1 && values == self.values(part, argument)
                        });
                        if let Some(own) = own {
                            connections.push(format!(
                                "({}.{} = {})",
                                name(field.name),
                                name(argument),
                                name(own)
                            ));
                        }
                    }
                }
                Some(Meaning::Variable(values)) if values.len() > 1 && declared.insert(field.name) => {
                    let observable = if field.is_observable { " OBSERVABLE" } else { "" };
                    let _ = writeln!(text, "(VAR {} {{{}}}{observable})", name(field.name), values.join(" "));
                }
                _ => {}
            }
        }
        let commands = self.commands(class);
        if !commands.is_empty() {
            let names: Vec<String> = commands.iter().map(|command| name(&command.0)).collect();
            let _ = writeln!(text, "(COMMAND {COMMAND} {{none {}}})", names.join(" "));
        }
        let modes: Vec<(&str, Option<&Tree>)> =
            if class.modes.is_empty() { vec![(ONLY_MODE, None)] } else { class.modes.clone() };
        if class.modes.len() > 1 {
            self.remark("Pamela names no initial modes: each object starts in the first mode of its class");
        }
        for (mode, condition) in modes {
            let mut all = connections.clone();
            if let Some(condition) = condition.filter(|condition| condition.word() != Some("true")) {
                match self.condition(class, condition) {
                    Ok(condition) => all.push(condition),
                    Err(what) => self.leave_out(condition.line(), format!("the mode `{mode}`: {what}")),
                }
            }
            let _ = writeln!(text, "(MODE {} {})", name(mode), conjunction(&all));
        }
        for (command, from, to, pre) in commands {
            let guard = match pre.map(|pre| self.guard(class, pre, from.as_deref())).transpose() {
                Ok(guard) => guard.flatten(),
                Err(what) => {
                    self.leave_out(
                        pre.map_or(1, Tree::line),
                        format!("the condition of `{command}`: {what}"),
                    );
                    None
                }
            };
            let all: Vec<String> =
                std::iter::once(format!("({COMMAND} = {})", name(&command))).chain(guard).collect();
            let from = from.map_or_else(|| "*".to_owned(), |from| name(&from));
            let _ = writeln!(text, "(TRANSITION {from} {} {})", name(&to), conjunction(&all));
        }
        for (key, options) in &class.transitions {
            text += &self.spontaneous(class, key, options);
        }
        text.truncate(text.trim_end().len());
        text + ")\n"
    }

    /// Returns what changes a mode on command: methods, and transitions that nothing else causes. Each with its name,
    /// the modes that it leaves and enters, and its condition.
    fn commands(
        &mut self,
        class: &'file Class<'file>,
    ) -> Vec<(String, Option<String>, String, Option<&'file Tree>)> {
        let mut commands = Vec::new();
        for method in &class.methods {
            let Some(to) = method.options.get("post").and_then(|post| own_mode(post)) else {
                if method.options.contains_key("post") {
                    self.leave_out(method.line, format!("the effect of `{}`: it is not a mode", method.name));
                }
                continue;
            };
            let pre = method.options.get("pre").copied();
            let from = pre.and_then(own_mode);
            commands.push((method.name.to_owned(), from.map(str::to_owned), to.to_owned(), pre));
            self.say_unused(&method.options);
        }
        for (key, options) in &class.transitions {
            let Some((from, to)) = ends(key, options) else { continue };
            let has_cause = options.contains_key("probability") || is_commanded(class, from, to);
            let pre = options.get("pre").copied();
            let is_plain = pre.is_none_or(|pre| pre.keyword().is_some());
            if !has_cause && is_plain && from != to {
                self.remark("a transition without condition, probability or method happens on a command with its name");
                commands.push((format!("{from}-{to}"), Some(from.to_owned()), to.to_owned(), pre));
            }
        }
        commands.retain(|(_, from, to, _)| {
            let is_mode = |mode: &str| class.modes.iter().any(|(known, _)| *known == mode);
            is_mode(to) && from.as_deref().is_none_or(is_mode)
        });
        commands
    }

    fn say_unused(&mut self, options: &BTreeMap<&'file str, &'file Tree>) {
        if ["bounds", "cost", "reward"].iter().any(|key| options.contains_key(key)) {
            self.remark("a transition takes one step: its bounds, cost and reward are not used");
        }
    }

    /// A transition that a condition or chance causes.
    fn spontaneous(
        &mut self,
        class: &'file Class<'file>,
        key: &'file str,
        options: &BTreeMap<&'file str, &'file Tree>,
    ) -> String {
        let line = options.values().next().map_or(1, |value| value.line());
        let Some((from, to)) = ends(key, options) else {
            self.leave_out(line, format!("the transition `{key}`: expected `:from:to`"));
            return String::new();
        };
        self.say_unused(options);
        let is_mode = |mode: &str| class.modes.iter().any(|(known, _)| *known == mode);
        if !is_mode(to) || (from != "*" && !is_mode(from)) {
            self.leave_out(line, format!("the transition `{key}`: `{}` has no such mode", class.name));
            return String::new();
        }
        let pre = options.get("pre").copied();
        let guard = match pre.map(|pre| self.guard(class, pre, Some(from))).transpose() {
            Ok(guard) => guard.flatten(),
            Err(what) => {
                self.leave_out(line, format!("the transition `{key}`: {what}"));
                return String::new();
            }
        };
        let ends = format!("{} {}", if from == "*" { "*".to_owned() } else { name(from) }, name(to));
        match options.get("probability") {
            _ if from == to => String::new(),
            Some(probability) => {
                let Some(chance) = chance(probability) else {
                    let what = format!("the transition `{key}`: its probability is known only while it runs");
                    self.leave_out(line, what);
                    return String::new();
                };
                format!("(FAULT {ends} {chance} {})\n", guard.unwrap_or_default())
            }
            None if is_commanded(class, from, to) => String::new(),
            None => guard.map_or_else(String::new, |guard| format!("(TRANSITION {ends} {guard})\n")),
        }
    }

    /// A condition beside the own mode that it names, which is `from`.
    fn guard(
        &mut self,
        class: &'file Class<'file>,
        tree: &'file Tree,
        from: Option<&str>,
    ) -> Result<Option<String>, String> {
        if tree.keyword().is_some_and(|mode| Some(mode) == from) || tree.word() == Some("true") {
            return Ok(None);
        }
        match tree.headed() {
            Some(("and", parts)) => {
                let each = parts.iter().map(|part| self.guard(class, part, from));
                let all: Vec<String> = each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
                Ok((!all.is_empty()).then(|| conjunction(&all)))
            }
            _ => self.condition(class, tree).map(Some),
        }
    }

    fn condition(&mut self, class: &'file Class<'file>, tree: &'file Tree) -> Result<String, String> {
        let Some((head, parts)) = tree.headed() else {
            return Err("a condition that is a constant or a mode".to_owned());
        };
        match (head, parts) {
            ("and" | "or", [_, _, ..]) => {
                let each =
                    parts.iter().map(|part| self.condition(class, part)).collect::<Result<Vec<_>, _>>()?;
                Ok(format!("({})", each.join(if head == "and" { " AND " } else { " OR " })))
            }
            ("and" | "or", [only]) => self.condition(class, only),
            ("not", [inner]) => Ok(format!("(NOT {})", self.condition(class, inner)?)),
            ("implies", [first, second]) => {
                let (first, second) = (self.condition(class, first)?, self.condition(class, second)?);
                Ok(format!("((NOT {first}) OR {second})"))
            }
            ("=", [left, right]) => self.equality(class, left, right),
            _ => Err(format!("the condition `({head} …)`")),
        }
    }

    fn equality(
        &mut self,
        class: &'file Class<'file>,
        left: &'file Tree,
        right: &'file Tree,
    ) -> Result<String, String> {
        let path = left.word().filter(|_| constant(left).is_none());
        let path = path.ok_or("an equality that starts with a constant")?;
        let (own, values) = match path.split_once('.') {
            None => match self.meaning(class, path) {
                Some(Meaning::Argument(argument)) => (name(argument), self.values(class, argument)),
                Some(Meaning::Part(part, _)) => {
                    (name(path), part.modes.iter().map(|(mode, _)| name(mode)).collect())
                }
                _ => (name(path), self.values(class, path)),
            },
            Some((part, field)) => match self.meaning(class, part) {
                Some(Meaning::Part(inner, _)) => {
                    (format!("{}.{}", name(part), name(field)), self.values(inner, field))
                }
                _ => (name(path), Vec::new()),
            },
        };
        let value = mode_of(right).map(name).or_else(|| constant(right));
        let value = value.ok_or("an equality of two names")?;
        if !values.contains(&value) || values.len() < 2 {
            return Err(format!("`{path}` has no value but this one"));
        }
        Ok(format!("({own} = {value})"))
    }

    fn meaning(&self, class: &'file Class<'file>, field: &'file str) -> Option<Meaning<'file>> {
        let value = class.fields.iter().find(|known| known.name == field)?.value;
        if let Some((head, given)) = made(value)
            && let Some(part) =
                self.classes.iter().find(|class| class.name == head && !class.is_enumeration())
        {
            return Some(Meaning::Part(part, given));
        }
        let argument = value.and_then(Tree::word).filter(|word| class.arguments.contains(word));
        Some(argument.map_or_else(|| Meaning::Variable(self.values(class, field)), Meaning::Argument))
    }

    /// The values that a name of a class may have: those of the enumeration that it is compared with, or all constants that it is
    /// compared with.
    fn values(&self, class: &'file Class<'file>, of: &'file str) -> Vec<String> {
        self.values_beside(class, of, &mut BTreeSet::new())
    }

    /// The same, without the names of classes that were looked at.
    fn values_beside(
        &self,
        class: &'file Class<'file>,
        of: &'file str,
        seen: &mut BTreeSet<(&'file str, &'file str)>,
    ) -> Vec<String> {
        if !seen.insert((class.name, of)) {
            return Vec::new();
        }
        let mut found = Vec::new();
        let field = class.fields.iter().find(|known| known.name == of);
        if let Some(value) = field.and_then(|field| field.value) {
            self.add_values(value, &mut found);
        }
        // A field that is the argument is compared in its place.
        let aliases = class.fields.iter().filter(|field| field.value.and_then(Tree::word) == Some(of));
        let names: Vec<&str> = std::iter::once(of).chain(aliases.map(|field| field.name)).collect();
        let conditions = class.modes.iter().filter_map(|(_, condition)| *condition);
        let options = class.methods.iter().map(|method: &Method<'_>| &method.options);
        let options = options.chain(class.transitions.iter().map(|(_, options)| options));
        let all = conditions.chain(
            options.flat_map(|options| ["pre", "post"].iter().filter_map(|key| options.get(key).copied())),
        );
        for condition in all {
            self.compared(condition, &names, &mut found);
        }
        if !found.is_empty() {
            return found;
        }
        for field in &class.fields {
            if let Some((head, given)) = made(field.value)
                && let Some(part) = self.classes.iter().find(|class| class.name == head)
            {
                for (argument, given) in part.arguments.iter().zip(given) {
                    if given.word() == Some(of) && found.is_empty() {
                        found = self.values_beside(part, argument, seen);
                    }
                }
            }
        }
        found
    }

    /// Adds the constants that names are compared with in a condition.
    fn compared(&self, tree: &Tree, names: &[&str], found: &mut Vec<String>) {
        match tree.headed() {
            Some(("=", [left, right])) if left.word().is_some_and(|word| names.contains(&word)) => {
                self.add_values(right, found);
            }
            Some((_, parts)) => parts.iter().for_each(|part| self.compared(part, names, found)),
            None => {}
        }
    }

    /// Adds a constant, or all modes of the enumeration that it belongs to.
    fn add_values(&self, tree: &Tree, found: &mut Vec<String>) {
        let enumeration = match tree.headed() {
            Some(("mode-of", [class, _])) => {
                let class =
                    class.word().and_then(|word| self.classes.iter().find(|class| class.name == word));
                class.map_or_else(Vec::new, |class| class.modes.iter().map(|(mode, _)| name(mode)).collect())
            }
            _ => constant(tree).into_iter().collect(),
        };
        for value in enumeration {
            if !found.contains(&value) {
                found.push(value);
            }
        }
    }
}

/// The class that a field makes, and what it gives to it.
fn made(value: Option<&Tree>) -> Option<(&str, &[Tree])> {
    value.and_then(Tree::headed)
}

/// The mode of the own class that a condition names.
fn own_mode(tree: &Tree) -> Option<&str> {
    match tree.headed() {
        Some(("and", parts)) => parts.iter().find_map(own_mode),
        Some(("mode-of", [class, mode])) if class.word() == Some("this") => mode.keyword(),
        Some(_) => None,
        None => tree.keyword(),
    }
}

/// The modes that a transition leaves and enters, as its key `:from:to` or its conditions have them.
fn ends<'file>(
    key: &'file str,
    options: &BTreeMap<&'file str, &'file Tree>,
) -> Option<(&'file str, &'file str)> {
    let (from, to) = key.trim_start_matches(':').split_once(':')?;
    let to = options.get("post").and_then(|post| own_mode(post)).unwrap_or(to);
    Some((from, to))
}

/// Returns whether a method of a class leads from one mode to another.
fn is_commanded(class: &Class<'_>, from: &str, to: &str) -> bool {
    class.methods.iter().any(|method| {
        let mode = |key: &str| method.options.get(key).and_then(|condition| own_mode(condition));
        mode("post") == Some(to) && mode("pre").is_none_or(|mode| mode == from)
    })
}

/// A probability as a decimal: a number, or what a variable (`lvar`) has at the start.
fn chance(tree: &Tree) -> Option<String> {
    match tree.headed() {
        Some(("lvar", [_, start])) => number(start),
        _ => number(tree),
    }
}

/// Conditions joined by AND.
fn conjunction(all: &[String]) -> String {
    match all {
        [] => "true".to_owned(),
        [only] => only.clone(),
        all => format!("({})", all.join(" AND ")),
    }
}
