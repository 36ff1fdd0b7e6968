//! Conditions, and the states that they speak of.

use super::{Given, Place, Writer};
use crate::pamela::instances::Reference;
use crate::pamela::names::{constant, mode_of, name, number, value_name};
use crate::pamela::tree::Tree;

impl<'file> Writer<'file> {
    /// A condition in a mission's words.
    pub(super) fn condition(&mut self, tree: &'file Tree, place: Place<'_, 'file>) -> Result<String, String> {
        if let Some(mode) = tree.keyword() {
            return Ok(self.mode(place.instance, mode));
        }
        let (head, parts) = tree.headed().ok_or("a condition that is a constant or a name")?;
        match head {
            "and" | "or" => {
                let parts =
                    parts.iter().map(|part| self.condition(part, place)).collect::<Result<Vec<_>, _>>()?;
                match &*parts {
                    [] => Err(format!("`{head}` without conditions")),
                    [only] => Ok(only.clone()),
                    parts => Ok(format!("({})", parts.join(&format!(" {head} ")))),
                }
            }
            "not" => match parts {
                [inner] => Ok(format!("not {}", self.condition(inner, place)?)),
                _ => Err("`not` takes one condition".to_owned()),
            },
            "implies" => match parts {
                [first, second] => {
                    let (first, second) = (self.condition(first, place)?, self.condition(second, place)?);
                    Ok(format!("(not {first} or {second})"))
                }
                _ => Err("`implies` takes two conditions".to_owned()),
            },
            "=" => match parts {
                [left, right] => self.equality(left, right, place),
                _ => Err("`=` of more than two".to_owned()),
            },
            _ => Err(format!("the condition `({head} …)`")),
        }
    }

    fn equality(
        &mut self,
        left: &'file Tree,
        right: &'file Tree,
        place: Place<'_, 'file>,
    ) -> Result<String, String> {
        // `(= :mode true)`
        if let Some(mode) = left.keyword() {
            let is = self.mode(place.instance, mode);
            return match right.word() {
                Some("true") => Ok(is),
                Some("false") => Ok(format!("not {is}")),
                _ => Err("a mode compared with something else than `true` and `false`".to_owned()),
            };
        }
        let path = left.word().filter(|path| number(left).is_none() && !matches!(*path, "true" | "false"));
        let path = path.ok_or("an equality that starts with a constant")?;
        if let Some(Reference::Instance(object)) = self.instances.resolve(place.instance, path)
            && let Some(mode) = mode_of(right)
        {
            return Ok(self.mode(object, mode));
        }
        let value = self.value(right, place).ok_or("an equality with something that has no value")?;
        if place.method.arguments.contains(&path) {
            return Err(format!("the argument `{path}` as the left side of `=`"));
        }
        let given = by_argument(right, place).unwrap_or_else(|| Given::Written(value.clone()));
        Ok(self.literal(place.instance, path, &value, given))
    }

    /// A field, or a name that no field has, with a value.
    fn literal(&mut self, instance: usize, path: &str, value: &str, given: Given) -> String {
        let (owner, field) =
            path.rsplit_once('.').map_or((None, path), |(owner, field)| (Some(owner), field));
        let object = match owner.map(|owner| self.instances.resolve(instance, owner)) {
            None => Some(instance),
            Some(Some(Reference::Instance(object))) => Some(object),
            Some(_) => None,
        };
        let reference = self.instances.resolve(instance, path);
        let own = match object.filter(|_| reference.is_some()).map(|object| &self.instances.all[object].path)
        {
            Some(before) if !before.is_empty() => name(&format!("{before}-{field}")),
            _ => name(&path.replace('.', "-")),
        };
        let initial = match reference {
            Some(Reference::Value(Some(given))) => constant(given),
            _ => None,
        };
        let state = self.states.entry(own.clone()).or_default();
        state.initial = state.initial.take().or(initial);
        state.values.insert(given);
        format!("{own}={value}")
    }

    /// That an object is in a mode.
    fn mode(&mut self, object: usize, mode: &str) -> String {
        let class = self.instances.class(object);
        let path = &self.instances.all[object].path;
        let own = name(&format!("{}-mode", if path.is_empty() { class.name } else { path }));
        let modes: Vec<String> = class.modes.iter().map(|(mode, _)| value_name(mode)).collect();
        if let Some(first) = modes.first() {
            self.remark("Pamela names no initial modes: each object starts in the first mode of its class");
            let state = self.states.entry(own.clone()).or_default();
            state.initial.get_or_insert_with(|| first.clone());
            state.values.extend(modes.into_iter().map(Given::Written));
        }
        format!("{own}={}", value_name(mode))
    }

    /// The literals that a condition joins by `and`.
    pub(super) fn literals(
        &mut self,
        tree: &'file Tree,
        place: Place<'_, 'file>,
    ) -> Result<Vec<String>, String> {
        match tree.headed() {
            Some(("and", parts)) => {
                let each =
                    parts.iter().map(|part| self.literals(part, place)).collect::<Result<Vec<_>, _>>()?;
                Ok(each.concat())
            }
            _ if tree.word() == Some("true") => Ok(Vec::new()),
            _ => {
                let condition = self.condition(tree, place)?;
                if condition.contains(" or ") || condition.contains(" and ") {
                    return Err("a condition with `or` or `not`".to_owned());
                }
                Ok(vec![condition])
            }
        }
    }

    /// A value as a name: of a constant, an argument of the method, or a field that has one.
    pub(super) fn value(&mut self, tree: &'file Tree, place: Place<'_, 'file>) -> Option<String> {
        if let Some(mode) = mode_of(tree) {
            return Some(value_name(mode));
        }
        match tree.word() {
            Some(word) if place.method.arguments.contains(&word) => Some(name(word)),
            Some(word) if constant(tree).is_none() => match self.instances.resolve(place.instance, word) {
                Some(Reference::Value(Some(given))) => constant(given).or_else(|| Some(name(word))),
                _ => Some(name(&word.replace('.', "-"))),
            },
            _ => constant(tree),
        }
    }
}

/// The argument of a method, if a name is one.
pub(super) fn by_argument(tree: &Tree, place: Place<'_, '_>) -> Option<Given> {
    let word = tree.word()?;
    let number = place.method.arguments.iter().position(|argument| *argument == word)?;
    Some(Given::By(place.key, number))
}
