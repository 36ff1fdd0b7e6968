//! The texts that users read: string literals of the sources, outside tests, attributes and reasons of panics. A translation
//! would start from their list, and tests check each of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use regex::Regex;

use crate::process::root;

/// Where user-visible texts are looked for, below the root.
pub const FOLDERS: [&str; 8] = [
    "crates/app/src",
    "crates/display/src",
    "crates/editor/src",
    "crates/layout/src",
    "crates/panels/src",
    "crates/terrain_view/src",
    "crates/theme/src",
    "crates/workbench/src",
];

/// Where other texts are that users read: answers of the command line, diagnostics, reports, messages of the planner. These
/// quote code in backticks, and have sentences such as “there is no plan”.
pub const MORE_FOLDERS: [&str; 22] = [
    "crates/cli/src",
    "crates/controllability/src",
    "crates/exact/src",
    "crates/executive/src",
    "crates/hca/src",
    "crates/interchange/src",
    "crates/kirk/src",
    "crates/link/src",
    "crates/mission/src",
    "crates/motion/src",
    "crates/page/src",
    "crates/plant/src",
    "crates/report/src",
    "crates/review/src",
    "crates/rmpl/src",
    "crates/snapshot/src",
    "crates/stn/src",
    "crates/stnu/src",
    "crates/terrain/src",
    "crates/tpn/src",
    "crates/verify/src",
    "crates/worker/src",
];

/// Parts of these folders that are not checked, and why.
const EXCLUDED: [(&str, &str); 7] = [
    ("crates/review/src/cheats.rs", "tests"),
    ("crates/review/src/five_missions.rs", "tests"),
    ("crates/review/src/mutations.rs", "tests"),
    ("crates/rmpl/src/editor/completion", "templates of code"),
    ("crates/tpn/src/families.rs", "names of generated missions, for benchmarks"),
    ("crates/workbench/src/lesson", "messages to authors of lessons, in the terms of the lesson format"),
    ("crates/workbench/src/manual.rs", "headings and addresses of the manual"),
];

/// Calls whose texts no user sees.
const HIDDEN: [&str; 10] = [
    "expect",
    "expect_err",
    "panic",
    "unreachable",
    "assert",
    "assert_eq",
    "assert_ne",
    "debug_assert",
    "debug_assert_eq",
    "debug_assert_ne",
];

/// Where a literal continues on the next line.
static CONTINUATION: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"\\\n\s*").expect("a pattern"));
static PLACEHOLDER: LazyLock<Regex> = LazyLock::new(|| Regex::new(r"\{[^{}]*\}").expect("a pattern"));

/// A string literal of a source.
pub struct Text {
    pub line: usize,
    pub words: String,
    /// The innermost function or macro that it is given to.
    pub callee: String,
}

/// The string literals of a source, without those of tests, attributes and hidden calls.
pub fn texts_of(source: &str) -> Vec<Text> {
    let tokens: TokenStream = source.parse().expect("sources are Rust");
    let mut found = Vec::new();
    collect(tokens, "", &mut found);
    found
}

fn collect(tokens: TokenStream, callee: &str, found: &mut Vec<Text>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    let mut is_test = false;
    // The last name, which is the callee of the group that follows.
    let mut name = String::new();
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token {
            TokenTree::Punct(punct) if punct.as_char() == '#' => {
                // Attributes of what they are in, as `//!` is one.
                if matches!(tokens.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == '!') {
                    at += 1;
                }
                if let Some(TokenTree::Group(group)) = tokens.get(at)
                    && group.delimiter() == Delimiter::Bracket
                {
                    let attribute = group.stream().to_string();
                    is_test |= attribute.replace(' ', "") == "cfg(test)";
                    // The messages of errors are attributes.
                    if attribute.starts_with("error") {
                        collect(group.stream(), "error", found);
                    }
                    at += 1;
                }
            }
            TokenTree::Punct(punct) => {
                if punct.as_char() == ';' {
                    is_test = false;
                }
                if !matches!(punct.as_char(), '!' | ':' | '.') {
                    name.clear();
                }
            }
            TokenTree::Ident(ident) => name = ident.to_string(),
            TokenTree::Group(group) => {
                let is_body = group.delimiter() == Delimiter::Brace;
                let is_hidden = HIDDEN.contains(&name.as_str());
                if !(is_hidden || is_test && is_body) {
                    let is_call = group.delimiter() == Delimiter::Parenthesis && !name.is_empty();
                    let inner = if is_call && name != "format" { name.as_str() } else { callee };
                    collect(group.stream(), if is_body { "" } else { inner }, found);
                }
                is_test &= !is_body;
                name.clear();
            }
            TokenTree::Literal(literal) => {
                let line = literal.span().start().line;
                if let Some(words) = string(&literal.to_string()) {
                    found.push(Text { line, words, callee: callee.to_owned() });
                }
            }
        }
    }
}

/// Returns what a literal says, if it is a string: without quotes and line breaks, each placeholder as `{}`.
fn string(literal: &str) -> Option<String> {
    let literal = literal.trim_start_matches('r').trim_matches('#');
    let inner = literal.strip_prefix('"')?.strip_suffix('"')?;
    let joined = CONTINUATION.replace_all(inner, "");
    let unquoted = joined.replace("\\\"", "\"").replace("\\n", " ").replace("\\u{a0}", " ");
    Some(PLACEHOLDER.replace_all(&unquoted, "{}").into_owned())
}

/// The sources below a folder, with their paths below the root.
fn sources_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources_below(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// Every text below these folders, with its file.
pub fn texts_in(folders: &[&str]) -> Vec<(String, Text)> {
    let root = root();
    let mut paths = Vec::new();
    for folder in folders {
        sources_below(&root.join(folder), &mut paths);
    }
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        let name = path.strip_prefix(&root).expect("below the root").to_string_lossy().replace('\\', "/");
        let is_test = name.contains("/tests/") || name.ends_with("_tests.rs");
        if is_test || EXCLUDED.iter().any(|(part, _)| name.starts_with(part)) {
            continue;
        }
        let source = fs::read_to_string(&path).expect("sources are UTF-8");
        found.extend(texts_of(&source).into_iter().map(|text| (name.clone(), text)));
    }
    found
}

/// Returns a template for translations of the interface in gettext's format: each text once, with its places.
pub fn template() -> String {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in texts_in(&FOLDERS) {
        if is_prose(&text.words) {
            places.entry(text.words).or_default().push(format!("{file}:{}", text.line));
        }
    }
    let head = "msgid \"\"\nmsgstr \"Content-Type: text/plain; charset=UTF-8\\n\"\n";
    let entry = |(words, places): (String, Vec<String>)| {
        let words = words.replace('\n', " ").replace('\\', "\\\\").replace('"', "\\\"");
        format!("\n#: {}\nmsgid \"{words}\"\nmsgstr \"\"\n", places.join(" "))
    };
    places.into_iter().map(entry).fold(head.to_owned(), |template, entry| template + &entry)
}

/// Returns whether a text is read by people: several words, or one that starts with a capital letter. Names of commands, keys
/// of documents and shaders are not.
fn is_prose(words: &str) -> bool {
    let is_word = |word: &str| word.chars().filter(|letter| letter.is_alphabetic()).count() > 1;
    let is_capitalized = || {
        let mut letters = words.chars();
        letters.next().is_some_and(char::is_uppercase)
            && letters.all(|letter| letter.is_lowercase() || letter == '…')
    };
    words.split_whitespace().filter(|word| is_word(word)).count() > 1 || is_capitalized()
}
