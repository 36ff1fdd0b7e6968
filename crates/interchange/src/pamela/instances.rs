//! The objects of a file: one for each class that no field makes, and those that fields make.

use std::collections::BTreeMap;

use super::PamelaError;
use super::classes::{Class, Field, Method};
use super::tree::Tree;

/// A file has at most this many objects.
const MAX_INSTANCES: usize = 5000;

/// An object of a class.
pub(super) struct Instance<'file> {
    /// Names of fields from the outermost object, joined by hyphens; empty for that object.
    pub(super) path: String,
    pub(super) class: usize,
    /// What its arguments and fields are.
    pub(super) names: BTreeMap<&'file str, Reference<'file>>,
}

/// What a name of an object is.
#[derive(Clone, Copy)]
pub(super) enum Reference<'file> {
    Instance(usize),
    /// A value that it has at the start; `None` if nothing says which.
    Value(Option<&'file Tree>),
}

pub(super) struct Instances<'file> {
    pub(super) classes: &'file [Class<'file>],
    pub(super) all: Vec<Instance<'file>>,
    /// The object of a class that no field makes, by its class.
    alone: BTreeMap<usize, usize>,
    /// What is taken to be meant where nothing says it.
    pub(super) remarks: Vec<String>,
}

impl<'file> Instances<'file> {
    pub(super) fn new(classes: &'file [Class<'file>], file: &str) -> Result<Self, PamelaError> {
        let mut instances = Self { classes, all: Vec::new(), alone: BTreeMap::new(), remarks: Vec::new() };
        let is_made = |class: &Class<'_>| {
            let fields = classes.iter().flat_map(|other| &other.fields);
            fields.filter_map(|field| field.value?.headed()).any(|(head, _)| head == class.name)
                || classes.iter().any(|other| other.inherits.contains(&class.name))
        };
        for (at, class) in classes.iter().enumerate() {
            if !is_made(class) && !class.is_enumeration() && !instances.alone.contains_key(&at) {
                instances.standing_alone(at);
            }
            if instances.all.len() >= MAX_INSTANCES {
                let what = format!("the classes make more than {MAX_INSTANCES} objects");
                return Err(PamelaError { file: file.to_owned(), line: 1, what });
            }
        }
        Ok(instances)
    }

    /// The object of a class whose arguments nothing gives: each of them is the object of the class with its name, or of the
    /// only class that has the methods that are called of it.
    fn standing_alone(&mut self, class: usize) -> usize {
        if let Some(known) = self.alone.get(&class) {
            return *known;
        }
        let at = self.make(String::new(), class);
        self.alone.insert(class, at);
        for argument in &self.classes[class].arguments {
            if let Some(other) = self.class_of_argument(class, argument)
                && self.all.len() < MAX_INSTANCES
            {
                let other = self.standing_alone(other);
                self.all[at].names.insert(argument, Reference::Instance(other));
            }
        }
        self.fill(at, 0);
        at
    }

    fn class_of_argument(&mut self, class: usize, argument: &str) -> Option<usize> {
        let classes = self.classes;
        let others = || classes.iter().enumerate().filter(|(at, _)| *at != class);
        if let Some((at, _)) = others().find(|(_, other)| other.name == argument) {
            return Some(at);
        }
        let mut called = Vec::new();
        for body in classes[class].methods.iter().filter_map(|method| method.body) {
            body.words(&mut |word| {
                called.extend(word.strip_prefix(argument).and_then(|it| it.strip_prefix('.')));
            });
        }
        let has = |other: &Class<'_>, name: &str| other.methods.iter().any(|method| method.name == name);
        let mut fitting = others().filter(|(_, other)| called.iter().all(|name| has(other, name)));
        let (at, other) = fitting.next().filter(|_| !called.is_empty() && fitting.next().is_none())?;
        let name = classes[class].name;
        self.remarks
            .push(format!("no field creates a `{name}`: its argument `{argument}` is a `{}`", other.name));
        Some(at)
    }

    fn make(&mut self, path: String, class: usize) -> usize {
        self.all.push(Instance { path, class, names: BTreeMap::new() });
        self.all.len() - 1
    }

    /// Gives an object its fields.
    fn fill(&mut self, at: usize, depth: usize) {
        let class = &self.classes[self.all[at].class];
        for Field { name: field, value, .. } in &class.fields {
            let made = value.and_then(Tree::headed).and_then(|(head, given)| {
                Some((self.classes.iter().position(|class| class.name == head)?, given))
            });
            let reference = match made {
                Some((made, given)) if depth < 20 && self.all.len() < MAX_INSTANCES => {
                    let path = &self.all[at].path;
                    let path = if path.is_empty() { (*field).to_owned() } else { format!("{path}-{field}") };
                    let inner = self.make(path, made);
                    for (argument, given) in self.classes[made].arguments.iter().zip(given) {
                        let reference = given
                            .word()
                            .and_then(|word| self.resolve(at, word))
                            .unwrap_or(Reference::Value(Some(given)));
                        self.all[inner].names.insert(argument, reference);
                    }
                    self.fill(inner, depth + 1);
                    Reference::Instance(inner)
                }
                _ => match value.and_then(Tree::word).and_then(|word| self.resolve(at, word)) {
                    Some(known) => known,
                    None => Reference::Value(*value),
                },
            };
            self.all[at].names.insert(field, reference);
        }
    }

    /// Returns what names joined by points are for an object.
    pub(super) fn resolve(&self, at: usize, path: &str) -> Option<Reference<'file>> {
        let mut names = path.split('.');
        let first = names.next()?;
        let start =
            if first == "this" { Reference::Instance(at) } else { *self.all.get(at)?.names.get(first)? };
        names.try_fold(start, |reference, name| match reference {
            Reference::Instance(at) => self.all.get(at)?.names.get(name).copied(),
            Reference::Value(_) => None,
        })
    }

    pub(super) fn class(&self, at: usize) -> &'file Class<'file> {
        &self.classes[self.all[at].class]
    }

    /// The method that a call means: the object and the number of the method.
    pub(super) fn method(&self, at: usize, path: &str) -> Option<(usize, usize)> {
        let (owner, name) = match path.rsplit_once('.') {
            None => (at, path),
            Some((owner, name)) => match self.resolve(at, owner)? {
                Reference::Instance(owner) => (owner, name),
                Reference::Value(_) => return None,
            },
        };
        Some((owner, self.class(owner).methods.iter().position(|method| method.name == name)?))
    }

    pub(super) fn methods(&self) -> impl Iterator<Item = (usize, usize, &'file Method<'file>)> {
        (0..self.all.len()).flat_map(|at| {
            self.class(at).methods.iter().enumerate().map(move |(number, method)| (at, number, method))
        })
    }
}
