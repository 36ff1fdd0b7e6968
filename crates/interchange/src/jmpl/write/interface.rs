//! What is observed and commanded, and in which modes components start.

use std::collections::{BTreeMap, BTreeSet};

use super::{Key, Writer};
use crate::jmpl::error::JmplError;
use crate::jmpl::evaluate::Kind;
use crate::jmpl::syntax::{Attribute, Class, Enum};

/// Names of the value that commands nothing.
const IDLE_NAMES: [&str; 5] = ["noCommand", "nocommand", "noCmd", "none", "idle"];
/// A model has at most this many components.
const MAX_COMPONENTS: usize = 20_000;
impl<'file> Writer<'file> {
    /// Finds what is observed and commanded.
    pub(super) fn find_interface(&mut self) -> Result<(), JmplError> {
        if self.harness.has_interface {
            let components = self.components()?;
            let harness = self.harness;
            self.observed = self.keys_of(&harness.observed, &components, "observed");
            self.commanded = self.keys_of(&harness.commanded, &components, "a command");
        } else {
            self.evaluator.remark(
                "no file says what is observed (.hrn): all attributes are OBSERVABLE that are not private or commands"
                    .to_owned(),
            );
            for root in &self.roots {
                for class in self.evaluator.names.lineage(root) {
                    for attribute in &class.attributes {
                        let kind = self.evaluator.names.kind(class, attribute);
                        if matches!(kind, Some(Kind::Enum(domain)) if idle(domain).is_some())
                            && self.asks_or_leads(class, attribute)
                        {
                            self.commanded.extend(self.evaluator.names.key(root, &attribute.name));
                        }
                    }
                }
            }
        }
        // What only transitions ask for can be nothing but a command.
        let only_asked = self.asked.iter().filter(|key| !self.constrained.contains(*key));
        self.commanded.extend(only_asked.copied().collect::<Vec<_>>());
        Ok(())
    }

    /// Returns whether a transition asks for an attribute, or a module connects it with its parts.
    fn asks_or_leads(&self, class: &'file Class, attribute: &Attribute) -> bool {
        let key = self.names().key(class, &attribute.name);
        let is_module = self.names().modes(class).is_none();
        key.is_some_and(|key| self.asked.contains(&key)) || is_module
    }

    /// The paths of all components, with their classes.
    pub(super) fn components(&self) -> Result<BTreeMap<String, &'file Class>, JmplError> {
        let mut components = BTreeMap::new();
        let mut waiting: Vec<(String, &Class)> =
            self.roots.iter().map(|class| (self.root_name(class), *class)).collect();
        while let Some((path, class)) = waiting.pop() {
            for declaring in self.names().lineage(class) {
                for attribute in &declaring.attributes {
                    if let Some(Kind::Class(part)) = self.names().kind(declaring, attribute) {
                        waiting.push((format!("{path}.{}", attribute.name), part));
                    }
                }
            }
            components.insert(path, class);
            if components.len() + waiting.len() > MAX_COMPONENTS {
                return Err(JmplError::TooMany { what: "components", most: MAX_COMPONENTS });
            }
        }
        Ok(components)
    }

    /// The attributes that paths of a harness lead to.
    fn keys_of(
        &mut self,
        paths: &'file [String],
        components: &BTreeMap<String, &'file Class>,
        what: &str,
    ) -> BTreeSet<Key<'file>> {
        let mut found: BTreeMap<Key<'file>, BTreeSet<&str>> = BTreeMap::new();
        for path in paths {
            let attribute = path.rsplit_once('.').and_then(|(component, attribute)| {
                let class = *components.get(component)?;
                let key = self.evaluator.names.key(class, attribute)?;
                let is_enum = !self.evaluator.names.is_state(class, attribute);
                is_enum.then_some(key)
            });
            match attribute {
                Some(key) => {
                    found.entry(key).or_default().insert(path);
                }
                None => self.evaluator.remark(format!(
                    "the harness says that `{path}` is {what}, but no attribute has this path"
                )),
            }
        }
        for (key, paths) in &found {
            let has = |class: &&&'file Class| self.evaluator.names.key(class, key.1) == Some(*key);
            let all = components.values().filter(has).count();
            if paths.len() < all {
                let remark = format!(
                    "the harness lists `{}` as {what} for {} of {all} components; Enroute treats it as {what} for all",
                    key.1,
                    paths.len()
                );
                self.evaluator.remark(remark);
            }
        }
        found.into_keys().collect()
    }

    /// Finds the modes in which components start.
    pub(super) fn find_starts(&mut self) {
        for class in self.needed.clone() {
            let Some((owner, modes)) = self.names().modes(class) else { continue };
            let is_fault =
                |mode: &&String| owner.arcs.iter().any(|arc| arc.is_failure && arc.to.contains(mode));
            let first = modes.values.iter().find(|mode| !is_fault(mode)).or_else(|| modes.values.first());
            self.starts.extend(first.map(|first| (&*class.name, first.clone())));
        }
        if self.harness.initial.is_empty() {
            if !self.starts.is_empty() {
                self.evaluator.remark(
                    "no .ini file gives initial modes: each component starts in the first mode that no failure leads to"
                        .to_owned(),
                );
            }
            return;
        }
        let Ok(components) = self.components() else { return };
        let mut per_class: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut per_part: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
        let harness = self.harness;
        for (path, value) in &harness.initial {
            let state = path.rsplit_once('.').and_then(|(component, variable)| {
                let class = *components.get(component)?;
                let (_, modes) = self.evaluator.names.modes(class)?;
                let is_mode = self.evaluator.names.is_state(class, variable) && modes.values.contains(value);
                is_mode.then_some((component, class))
            });
            let Some((component, class)) = state else {
                self.evaluator
                    .remark(format!("the initial value `{path} = {value}` is not a mode; it is not used"));
                continue;
            };
            per_class.entry(&class.name).or_default().insert(value);
            if let Some((owner, part)) = component.rsplit_once('.')
                && let Some((owner, _)) =
                    components.get(owner).and_then(|owner| self.names().key(owner, part))
            {
                per_part.entry((owner, part)).or_default().insert(value);
            }
        }
        for (class, modes) in per_class {
            if let Some(mode) = modes.first() {
                let class = self.evaluator.names.classes.get(class).map(|class| &*class.name);
                self.starts.extend(class.map(|class| (class, (*mode).to_owned())));
            }
        }
        for ((owner, part), modes) in per_part {
            let Some(class) = self.evaluator.names.classes.get(owner).copied() else { continue };
            let Some(mode) = modes.first() else { continue };
            if modes.len() > 1 {
                let what = format!(
                    "the components `{part}` of `{owner}` start in different modes; they start in `{mode}`"
                );
                self.evaluator.leave_out(class.place, what);
            }
            self.part_starts.insert((&class.name, part.to_owned()), (*mode).to_owned());
        }
    }

    pub(super) fn root_name(&self, class: &Class) -> String {
        match self.harness.root() {
            Some(root) if self.roots.len() == 1 => root.to_owned(),
            _ => class.name.clone(),
        }
    }
}

/// The value of a type that commands nothing.
pub(super) fn idle(domain: &Enum) -> Option<&str> {
    IDLE_NAMES.into_iter().find(|idle| domain.values.iter().any(|value| value == idle))
}
