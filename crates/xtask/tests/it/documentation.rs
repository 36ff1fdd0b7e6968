//! Rules for doc comments: an item that another crate uses has one, and none is too short to say anything.
//!
//! Sources are read line by line, as rustfmt lays them out. Whether another crate uses an item is approximated: its name
//! is a word of a source of a package that depends on its crate. Fields, variants and what lies in a type or a module
//! need no comment, except functions.

use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::path::Path;

use xtask::process::root;

use crate::repository::{LAYERS, is_test, manifests, sources};

/// Comments that are shorter than this, in characters, have to carry a fact.
const MIN_COMMENT_CHARS: usize = 14;

/// What makes a short comment worth its line, besides digits and code: a unit.
const UNITS: [&str; 8] =
    ["meters", "seconds", "milliseconds", "radians", "points", "pixels", "columns", "rows"];

/// Derives whose types keep all comments: these become the text of `--help` or of `web/enroute.d.ts`.
const PUBLISHED: [&str; 5] = ["Args", "Parser", "Subcommand", "ValueEnum", "TS"];

/// Names that say it all: a constructor, and the code of a diagnostic.
const PLAIN: [&str; 2] = ["new", "CODE"];

/// Something that a doc comment is above, or should be.
#[derive(Debug, PartialEq)]
struct Documented {
    /// The first line of it, without what its indentation is.
    line: String,
    /// The name of a public item that has to be documented where another crate uses it.
    name: Option<String>,
    comment: String,
    /// Whether its comments are published.
    is_published: bool,
}

/// The name of a public item, if the line begins one that needs a comment; in traits all functions are public.
fn public_name(line: &str, is_in_trait: bool) -> Option<String> {
    let indentation = line.len() - line.trim_start().len();
    let mut rest = line.trim_start();
    match rest.strip_prefix("pub ") {
        Some(after) => rest = after,
        None if !is_in_trait => return None,
        None => {}
    }
    let mut is_constant = false;
    while let Some(after) = ["const ", "async ", "unsafe "].iter().find_map(|word| rest.strip_prefix(word)) {
        is_constant |= rest.starts_with("const ");
        rest = after;
    }
    let (kind, after) = rest.split_once(' ')?;
    let is_item = match kind {
        "fn" => true,
        "struct" | "enum" | "trait" | "static" | "type" => indentation == 0,
        _ => false,
    };
    let name = if is_item {
        after
    } else if is_constant && indentation == 0 {
        rest
    } else {
        return None;
    };
    let name = words(name).next()?;
    (!PLAIN.contains(&name)).then(|| name.to_owned())
}

/// Returns what may have a comment in a source, without the tests at its end.
fn documented(text: &str) -> Vec<Documented> {
    let product = text.split("\n#[cfg(test)]\nmod tests {\n").next().unwrap_or_default();
    let mut found = Vec::new();
    let mut comment: Vec<&str> = Vec::new();
    let mut attributes = String::new();
    // The line that ends the trait, or the type whose comments are published, that the present line is in.
    let (mut end_of_trait, mut end_of_published) = (None, None);
    for line in product.lines() {
        let trimmed = line.trim_start();
        let is_in_attribute = attributes.matches('[').count() > attributes.matches(']').count();
        if is_in_attribute || trimmed.starts_with("#[") {
            attributes += trimmed;
            continue;
        }
        if let Some(words) = trimmed.strip_prefix("///") {
            comment.push(words.trim());
            continue;
        }
        if trimmed.starts_with("//") {
            continue;
        }
        let end = format!("{}}}", &line[..line.len() - trimmed.len()]);
        if words(&attributes).any(|word| PUBLISHED.contains(&word)) && line.ends_with('{') {
            end_of_published = Some(end.clone());
        }
        if trimmed.starts_with("pub trait ") && line.ends_with('{') {
            end_of_trait = Some(end);
        }
        let name = public_name(line, end_of_trait.is_some());
        if name.is_some() || !comment.is_empty() {
            let is_published = end_of_published.is_some();
            let comment = comment.join("\n");
            found.push(Documented { line: trimmed.to_owned(), name, comment, is_published });
        }
        comment.clear();
        attributes.clear();
        for end in [&mut end_of_trait, &mut end_of_published] {
            if end.as_deref() == Some(line) {
                *end = None;
            }
        }
    }
    found
}

/// Returns whether a doc comment only fills its line.
fn is_filler(comment: &str) -> bool {
    let has_fact = comment.contains(|it: char| it.is_ascii_digit() || it == '`' || it == '∞');
    let has_unit = words(&comment.to_lowercase()).any(|word| UNITS.contains(&word));
    !comment.is_empty() && comment.chars().count() < MIN_COMMENT_CHARS && !has_fact && !has_unit
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|it: char| !it.is_alphanumeric() && it != '_').filter(|word| !word.is_empty())
}

fn read(source: &Path) -> String {
    fs::read_to_string(source).expect("a source")
}

#[test]
fn comments_are_read_with_what_they_are_above() {
    let text = "/// A.\n#[derive(Args)]\npub struct Choice {\n    /// B.\n    pub field: u8,\n}\n\npub trait Host {\n    \
                /// C.\n    fn now(&self);\n    fn later(&self);\n}\n\nimpl Host {\n    pub const fn name(self) {}\n    \
                pub const ONE: u8 = 1;\n    fn own() {}\n}\n\npub(crate) fn inner() {}\n\npub const LIMIT: u8 = 1;\n\n\
                #[cfg(test)]\nmod tests {\n    pub fn tested() {}\n}\n";
    let found = documented(text);
    let found: Vec<(Option<&str>, &str, bool)> =
        found.iter().map(|it| (it.name.as_deref(), it.comment.as_str(), it.is_published)).collect();
    let expected = [
        (Some("Choice"), "A.", true),
        (None, "B.", true),
        (Some("Host"), "", false),
        (Some("now"), "C.", false),
        (Some("later"), "", false),
        (Some("name"), "", false),
        (Some("LIMIT"), "", false),
    ];
    assert_eq!(found, expected);
}

#[test]
fn short_comments_are_filler_unless_they_carry_a_fact() {
    for filler in ["When.", "Its name.", "The network."] {
        assert!(is_filler(filler), "{filler}");
    }
    for kept in ["", "In seconds.", "From 1.", "`a + b`", "Meters east.", "The whole network."] {
        assert!(!is_filler(kept), "{kept}");
    }
}

#[test]
fn no_comment_only_fills_its_line() {
    let mut count = 0;
    let mut filler = Vec::new();
    for source in ["crates", "tests"].iter().flat_map(|folder| sources(&root().join(folder))) {
        for item in documented(&read(&source)).into_iter().filter(|item| !item.is_published) {
            count += 1;
            if is_filler(&item.comment) {
                filler.push(format!("{}: {}: {}", source.display(), item.line, item.comment));
            }
        }
    }
    assert!(count > 5000, "only {count} comments were found");
    assert!(filler.is_empty(), "comments that say no more than the name:\n{}", filler.join("\n"));
}

#[test]
fn what_a_function_tells_is_what_it_returns() {
    let mut bare = Vec::new();
    for source in ["crates", "tests"].iter().flat_map(|folder| sources(&root().join(folder))) {
        let items = documented(&read(&source)).into_iter();
        for item in
            items.filter(|item| item.comment.starts_with("Whether ") && item.line.ends_with("-> bool {"))
        {
            bare.push(format!("{}: {}: {}", source.display(), item.line, item.comment));
        }
    }
    assert!(bare.is_empty(), "write \"Returns whether …\":\n{}", bare.join("\n"));
}

#[test]
fn what_another_crate_uses_has_a_comment() {
    // What each package depends on, and the words of its sources.
    let packages: Vec<(BTreeSet<String>, HashSet<String>)> = manifests()
        .iter()
        .map(|manifest| {
            let text = read(manifest);
            let names =
                text.lines().filter_map(|line| line.split_once([' ', '.', '='])).map(|(name, _)| name);
            let folder = manifest.parent().expect("a manifest lies in a folder");
            let mut found = HashSet::new();
            for source in sources(folder) {
                let text = read(&source);
                found.extend(
                    words(&text).filter(|word| !found.contains(*word)).map(str::to_owned).collect::<Vec<_>>(),
                );
            }
            (names.map(str::to_owned).collect(), found)
        })
        .collect();
    let mut count = 0;
    let mut missing = Vec::new();
    for (name, _) in LAYERS {
        let users: Vec<&HashSet<String>> =
            packages.iter().filter(|(on, _)| on.contains(*name)).map(|(_, words)| words).collect();
        for source in sources(&root().join("crates").join(name).join("src")) {
            if is_test(&source) {
                continue;
            }
            for item in documented(&read(&source)) {
                if item.name.is_some_and(|name| users.iter().any(|words| words.contains(&name))) {
                    count += 1;
                    if item.comment.is_empty() {
                        missing.push(format!("{}: {}", source.display(), item.line));
                    }
                }
            }
        }
    }
    assert!(count > 1000, "only {count} items were found that another crate uses");
    assert!(
        missing.is_empty(),
        "other crates use these, and no comment says what they are:\n{}",
        missing.join("\n")
    );
}
