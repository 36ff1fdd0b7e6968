//! Names of the notation for what a network calls otherwise.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

/// Words that mean something where a name could stand.
const WORDS: &str = " choose do maintaining watching if thennext else var primitive scenario option delay not tell ask inf \
    state resource import const constrain repeat unordered free optional as using and or in control objective terrain \
    location obstacle vehicle contingent requires sets uses consumes produces costs rewards moves runs aborts to at start end ";

/// The names that are given, each to one thing.
#[derive(Default)]
pub(super) struct Names {
    given: BTreeMap<(&'static str, SmolStr), String>,
    taken: BTreeSet<String>,
    /// What was renamed: the new name and what the network says.
    pub(super) renamed: Vec<(String, SmolStr)>,
}

impl Names {
    /// The name for what the network calls `text`; things of different kinds never share one.
    pub(super) fn of(&mut self, kind: &'static str, text: &str) -> String {
        let key = (kind, SmolStr::new(text));
        if let Some(given) = self.given.get(&key) {
            return given.clone();
        }
        let called = text.split('\u{1f}').next().unwrap_or(text);
        let name = self.free(&valid(called));
        if name != called {
            self.renamed.push((name.clone(), called.into()));
        }
        self.given.insert(key, name.clone());
        name
    }

    /// A name like this one that nothing has yet.
    pub(super) fn free(&mut self, like: &str) -> String {
        let mut name = like.to_owned();
        let mut count = 1;
        while !self.taken.insert(name.clone()) {
            count += 1;
            name = format!("{like}-{count}");
        }
        name
    }
}

/// A name of the notation that is as near to `text` as can be.
pub(super) fn valid(text: &str) -> String {
    let is_letter = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let characters: Vec<char> = text.chars().collect();
    let mut name = String::new();
    for (index, &character) in characters.iter().enumerate() {
        let joins = character == '-'
            && index > 0
            && is_letter(characters[index - 1])
            && characters.get(index + 1).is_some_and(|&next| is_letter(next));
        name.push(if is_letter(character) || joins { character } else { '_' });
    }
    if !name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
        name.insert(0, '_');
    }
    if WORDS.contains(&format!(" {name} ")) { format!("{name}_") } else { name }
}
