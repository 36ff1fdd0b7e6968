//! The classes of a file, with what they inherit.

use std::collections::BTreeMap;

use super::PamelaError;
use super::tree::Tree;

/// `(defpclass name [arguments] …)`.
#[derive(Clone, Debug)]
pub(super) struct Class<'file> {
    pub(super) name: &'file str,
    pub(super) arguments: Vec<&'file str>,
    pub(super) inherits: Vec<&'file str>,
    pub(super) fields: Vec<Field<'file>>,
    /// Modes, each with what holds in it.
    pub(super) modes: Vec<(&'file str, Option<&'file Tree>)>,
    pub(super) methods: Vec<Method<'file>>,
    /// Transitions by their keys, such as `:off:on`.
    pub(super) transitions: Vec<(&'file str, Options<'file>)>,
    /// Where propositions are written.
    pub(super) propositions: Option<u32>,
}

impl Class<'_> {
    /// Returns whether it only has names for values, and is not an object.
    pub(super) fn is_enumeration(&self) -> bool {
        self.methods.is_empty() && self.fields.is_empty() && self.transitions.is_empty()
    }
}

/// Values by keywords.
pub(super) type Options<'file> = BTreeMap<&'file str, &'file Tree>;

/// A field of a class.
#[derive(Clone, Debug)]
pub(super) struct Field<'file> {
    pub(super) name: &'file str,
    /// What it is at the start.
    pub(super) value: Option<&'file Tree>,
    pub(super) is_observable: bool,
}

/// `(defpmethod name {options} [arguments] body between…)`.
#[derive(Clone, Debug)]
pub(super) struct Method<'file> {
    pub(super) name: &'file str,
    pub(super) options: Options<'file>,
    pub(super) arguments: Vec<&'file str>,
    /// What it does, unless it is primitive.
    pub(super) body: Option<&'file Tree>,
    pub(super) betweens: Vec<&'file Tree>,
    pub(super) line: u32,
}

/// Classes extend each other at most this deep.
const MAX_DEPTH: usize = 50;

/// Reads the classes of a file.
pub(super) fn read<'file>(trees: &'file [Tree], file: &str) -> Result<Vec<Class<'file>>, PamelaError> {
    let mut classes = Vec::new();
    for tree in trees {
        let error = |tree: &Tree, what: &str| PamelaError {
            file: file.to_owned(),
            line: tree.line(),
            what: what.to_owned(),
        };
        match tree.headed() {
            Some(("defpclass", [name, arguments, options @ ..])) => {
                let (Some(name), Some(arguments)) = (name.word(), words(arguments)) else {
                    return Err(error(tree, "expected `(defpclass name [arguments] …)`"));
                };
                classes.push(
                    class(name, arguments, options).map_err(|(at, what)| error(at.unwrap_or(tree), what))?,
                );
            }
            // It only searches what is known while a plan runs.
            Some(("defproposition", _)) => {}
            _ => {
                return Err(error(tree, "expected `(defpclass name [arguments] …)` or `(defproposition …)`"));
            }
        }
    }
    Ok(classes)
}

type Wrong<'file> = (Option<&'file Tree>, &'static str);

fn class<'file>(
    name: &'file str,
    arguments: Vec<&'file str>,
    options: &'file [Tree],
) -> Result<Class<'file>, Wrong<'file>> {
    let mut class = Class {
        name,
        arguments,
        inherits: Vec::new(),
        fields: Vec::new(),
        modes: Vec::new(),
        methods: Vec::new(),
        transitions: Vec::new(),
        propositions: None,
    };
    for pair in options.chunks(2) {
        let [key, value] = pair else { return Err((pair.first(), "expected a value after this keyword")) };
        let wrong = |what| (Some(value), what);
        match key.keyword() {
            Some("meta") => {}
            Some("inherit") => {
                class.inherits =
                    words(value).ok_or_else(|| wrong("expected the names of classes in `[…]`"))?;
            }
            Some("fields") => {
                let fields = value.entries().ok_or_else(|| wrong("expected fields in `{…}`"))?;
                class.fields = fields.into_iter().map(|(name, value)| field(name, value)).collect();
            }
            Some("modes") => {
                let modes: Option<Vec<(&str, Option<&Tree>)>> = match value {
                    Tree::Map(..) => {
                        value.entries().map(|all| all.into_iter().map(|(key, it)| (key, Some(it))).collect())
                    }
                    _ => words(value).map(|all| all.into_iter().map(|mode| (mode, None)).collect()),
                };
                let modes = modes.ok_or_else(|| wrong("expected modes in `[…]` or `{…}`"))?;
                class.modes =
                    modes.into_iter().map(|(mode, it)| (mode.trim_start_matches(':'), it)).collect();
            }
            Some("methods") => {
                let methods = value.vector().ok_or_else(|| wrong("expected methods in `[…]`"))?;
                class.methods = methods.iter().map(method).collect::<Result<_, _>>()?;
            }
            Some("transitions") => {
                let transitions = value.entries().ok_or_else(|| wrong("expected transitions in `{…}`"))?;
                for (key, options) in transitions {
                    let options = options.entries().ok_or((Some(options), "expected options in `{…}`"))?;
                    class.transitions.push((key, by_keyword(options)));
                }
            }
            Some("propositions") => class.propositions = Some(value.line()),
            _ => return Err((Some(key), "unknown option of a class")),
        }
    }
    Ok(class)
}

/// A field: `{:initial value :observable true}`, or the value itself.
fn field<'file>(name: &'file str, value: &'file Tree) -> Field<'file> {
    let Some(entries) = value.entries() else {
        return Field { name, value: Some(value), is_observable: false };
    };
    let options = by_keyword(entries);
    let is_observable = options.get("observable").is_some_and(|it| it.word() == Some("true"));
    Field { name, value: options.get("initial").copied(), is_observable }
}

fn by_keyword<'file>(entries: Vec<(&'file str, &'file Tree)>) -> Options<'file> {
    entries.into_iter().map(|(key, value)| (key.trim_start_matches(':'), value)).collect()
}

fn method(tree: &Tree) -> Result<Method<'_>, Wrong<'_>> {
    let wrong = (Some(tree), "expected `(defpmethod name {options} [arguments] body)`");
    let Some(("defpmethod", [name, rest @ ..])) = tree.headed() else { return Err(wrong) };
    let (options, rest) = match rest {
        [options @ Tree::Map(..), rest @ ..] => (options.entries().ok_or(wrong)?, rest),
        rest => (Vec::new(), rest),
    };
    let [arguments, rest @ ..] = rest else { return Err(wrong) };
    let options = by_keyword(options);
    let is_between = |tree: &&Tree| tree.headed().is_some_and(|(head, _)| head.starts_with("between"));
    let is_primitive = options.get("primitive").is_some_and(|value| value.word() == Some("true"));
    Ok(Method {
        name: name.word().ok_or(wrong)?,
        options,
        arguments: words(arguments).ok_or(wrong)?,
        body: rest.first().filter(|body| !is_primitive && !is_between(body)),
        betweens: rest.iter().filter(is_between).collect(),
        line: tree.line(),
    })
}

fn words(tree: &Tree) -> Option<Vec<&str>> {
    tree.vector()?.iter().map(Tree::word).collect()
}

/// The classes by name, each with what it inherits: what stands nearer counts.
pub(super) fn merged<'file>(classes: &[Class<'file>]) -> Vec<Class<'file>> {
    let by_name: BTreeMap<&str, &Class<'file>> = classes.iter().map(|class| (class.name, class)).collect();
    classes
        .iter()
        .map(|class| {
            let mut whole = class.clone();
            let mut waiting: Vec<(&str, usize)> =
                class.inherits.iter().rev().map(|name| (*name, 1)).collect();
            let mut seen = vec![class.name];
            while let Some((name, depth)) = waiting.pop() {
                let Some(parent) = by_name.get(name) else { continue };
                if seen.contains(&name) || depth > MAX_DEPTH {
                    continue;
                }
                seen.push(name);
                waiting.extend(parent.inherits.iter().rev().map(|name| (*name, depth + 1)));
                for field in &parent.fields {
                    if !whole.fields.iter().any(|known| known.name == field.name) {
                        whole.fields.push(field.clone());
                    }
                }
                for mode in &parent.modes {
                    if !whole.modes.iter().any(|known| known.0 == mode.0) {
                        whole.modes.push(*mode);
                    }
                }
                for method in &parent.methods {
                    let is_same = |known: &&Method<'file>| {
                        known.name == method.name && known.arguments.len() == method.arguments.len()
                    };
                    if !whole.methods.iter().any(|known| is_same(&known)) {
                        whole.methods.push(method.clone());
                    }
                }
                for transition in &parent.transitions {
                    if !whole.transitions.iter().any(|known| known.0 == transition.0) {
                        whole.transitions.push(transition.clone());
                    }
                }
                whole.propositions = whole.propositions.or(parent.propositions);
            }
            whole
        })
        .collect()
}
