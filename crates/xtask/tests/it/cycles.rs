//! A rule for the files of each crate: no more than four of them name each other in a circle, since such files can only be
//! read together.
//!
//! A file names another by a path that begins with `crate`, `self`, `super` or a module of its own. A name that a module
//! re-exports is that of the file it comes from. Tests at the ends of files do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use xtask::process::root;

/// How many files may name each other in a circle.
const MAX_FILES: usize = 4;

/// Crates with a larger circle, how many files it has at most, and why it stands.
const EXCEPTIONS: &[(&str, usize, &str)] = &[
    ("kirk", 13, "the parts of a problem and the search over them refer to each other"),
    ("panels", 11, "the parts of a panel share what its first file holds"),
    (
        "rmpl",
        38,
        "productions of the grammar refer to each other, and so do diagnostics and the checks that give them",
    ),
    ("interchange", 7, "the classes, objects and methods of a model in Pamela refer to each other"),
    ("hca", 5, "an automaton has clocks and locks, which refer to its parts, and is stepped by them"),
    ("terrain", 13, "to be parted"),
    ("text_editing", 6, "to be parted"),
    ("workbench", 6, "to be parted"),
];

/// A module, as the names that lead to it from the root of its crate.
type Module = Vec<String>;

/// What the file of a module says of others.
#[derive(Debug, Default)]
struct Source {
    /// The modules that it declares.
    declares: BTreeSet<String>,
    /// The paths that it names.
    paths: Vec<Vec<String>>,
    /// What it re-exports, by the name that it gives it.
    re_exports: BTreeMap<String, Vec<String>>,
    /// All its words, to see whether it uses what it re-exports.
    words: BTreeSet<String>,
}

/// The words and signs of a source, without comments, texts and lifetimes.
fn tokens(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if first == '"' {
            let mut is_escaped = false;
            let end = rest.char_indices().skip(1).find(|&(_, it)| {
                let ends = it == '"' && !is_escaped;
                is_escaped = it == '\\' && !is_escaped;
                ends
            });
            end.map_or(rest.len(), |(at, _)| at + 1)
        } else if first == '\'' {
            // A character, or a lifetime.
            let quoted = rest.char_indices().skip(2).take(8).find(|&(_, it)| it == '\'');
            let is_quoted = quoted.is_some_and(|(at, _)| {
                at == 2 || rest[1..].starts_with('\\') || at <= 5 && !rest[1..at].is_ascii()
            });
            if is_quoted { quoted.map_or(1, |(at, _)| at + 1) } else { 1 }
        } else if first.is_alphanumeric() || first == '_' {
            let end = rest.find(|it: char| !it.is_alphanumeric() && it != '_').unwrap_or(rest.len());
            found.push(rest[..end].to_owned());
            end
        } else if rest.starts_with("::") {
            found.push("::".to_owned());
            2
        } else {
            if !first.is_whitespace() {
                found.push(first.to_string());
            }
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    found
}

/// Returns where an item ends that begins at a token: behind its semicolon or its braces.
fn end_of_item(tokens: &[String], from: usize) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate().skip(from) {
        match token.as_str() {
            "{" => depth += 1,
            "}" if depth <= 1 => return at + 1,
            "}" => depth -= 1,
            ";" if depth == 0 => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// The paths of a `use` between its first token and its semicolon, each with the name that it gets.
fn paths_of_use(tokens: &[String]) -> Vec<(Vec<String>, String)> {
    let (mut found, mut prefixes, mut path) = (Vec::new(), Vec::new(), Vec::new());
    let mut alias = None;
    let mut at = 0;
    let mut finish = |path: &mut Vec<String>, alias: &mut Option<String>, prefix: usize| {
        if path.len() > prefix {
            let mut whole = path.clone();
            if whole.last().is_some_and(|last| last == "self") && whole.len() > 1 {
                whole.pop();
            }
            let name = alias.take().or_else(|| whole.last().cloned()).unwrap_or_default();
            found.push((whole, name));
        }
        path.truncate(prefix);
    };
    while let Some(token) = tokens.get(at) {
        match token.as_str() {
            "{" => prefixes.push(path.len()),
            "," | "}" => {
                finish(&mut path, &mut alias, prefixes.last().copied().unwrap_or(0));
                if token == "}" {
                    prefixes.pop();
                    // The prefix itself has been used up.
                    path.truncate(prefixes.last().copied().unwrap_or(0));
                }
            }
            "as" => {
                alias = tokens.get(at + 1).cloned();
                at += 1;
            }
            "::" => {}
            _ => path.push(token.clone()),
        }
        at += 1;
    }
    finish(&mut path, &mut alias, 0);
    found
}

impl Source {
    fn read(text: &str) -> Self {
        let tokens = tokens(text);
        let is = |at: usize, word: &str| tokens.get(at).is_some_and(|token| token == word);
        let is_test =
            |at: usize| ["#", "[", "cfg", "(", "test", ")", "]"].iter().zip(at..).all(|(it, at)| is(at, it));
        let mut source = Self::default();
        let mut at = 0;
        while at < tokens.len() {
            if is_test(at) {
                at = end_of_item(&tokens, at + 7);
            } else if is(at, "mod") && is(at + 2, ";") {
                source.declares.insert(tokens[at + 1].clone());
                at += 3;
            } else if is(at, "use") {
                let end = end_of_use(&tokens, at);
                let is_public = at > 0 && (is(at - 1, "pub") || is(at - 1, ")"));
                for (path, name) in paths_of_use(&tokens[at + 1..end]) {
                    if is_public {
                        source.re_exports.insert(name, path);
                    } else {
                        source.paths.push(path);
                    }
                }
                at = end + 1;
            } else {
                source.words.insert(tokens[at].clone());
                let mut path = vec![tokens[at].clone()];
                while is(at + 1, "::")
                    && tokens.get(at + 2).is_some_and(|next| next.starts_with(|it: char| it.is_alphabetic()))
                {
                    path.push(tokens[at + 2].clone());
                    at += 2;
                }
                if path.len() > 1 {
                    source.paths.push(path);
                }
                at += 1;
            }
        }
        source
    }
}

/// Returns where a `use` ends: at its semicolon.
fn end_of_use(tokens: &[String], from: usize) -> usize {
    tokens.iter().skip(from).position(|token| token == ";").map_or(tokens.len(), |at| from + at)
}

/// The sources of a crate by their modules, from its first file on.
fn read_crate(first: &Path) -> BTreeMap<Module, Source> {
    let mut found = BTreeMap::new();
    let mut waiting = vec![(Module::new(), first.to_owned())];
    while let Some((module, path)) = waiting.pop() {
        let source = Source::read(&fs::read_to_string(&path).expect("a source"));
        let is_first =
            path.file_name().is_some_and(|name| ["lib.rs", "main.rs", "mod.rs"].iter().any(|it| name == *it));
        let folder =
            if is_first { path.parent().expect("a folder").to_owned() } else { path.with_extension("") };
        for name in &source.declares {
            let places = [folder.join(format!("{name}.rs")), folder.join(name).join("mod.rs")];
            if let Some(place) = places.into_iter().find(|place| place.exists()) {
                waiting.push((module.iter().chain([name]).cloned().collect(), place));
            }
        }
        found.insert(module, source);
    }
    found
}

/// A path that a module names, from the root of its crate; `None` if it leads elsewhere.
fn absolute(path: &[String], module: &Module, source: &Source) -> Option<Vec<String>> {
    let supers = path.iter().take_while(|it| *it == "super").count();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some(module.iter().chain(&path[1..]).cloned().collect()),
        "super" => {
            let above = module.len().checked_sub(supers)?;
            Some(module[..above].iter().chain(&path[supers..]).cloned().collect())
        }
        first => source.declares.contains(first).then(|| module.iter().chain(path).cloned().collect()),
    }
}

/// The module whose file holds what an absolute path names.
fn holder(sources: &BTreeMap<Module, Source>, path: &[String], steps: usize) -> Module {
    let mut module = Module::new();
    for (at, name) in path.iter().enumerate() {
        let below: Module = module.iter().chain([name]).cloned().collect();
        if sources.contains_key(&below) {
            module = below;
            continue;
        }
        let source = &sources[&module];
        let target = source.re_exports.get(name).and_then(|target| absolute(target, &module, source));
        return match target {
            Some(target) if steps > 0 => {
                let whole: Vec<String> = target.iter().chain(&path[at + 1..]).cloned().collect();
                holder(sources, &whole, steps - 1)
            }
            _ => module,
        };
    }
    module
}

/// The largest sets of files that name each other in a circle, the largest first.
fn circles(sources: &BTreeMap<Module, Source>) -> Vec<Vec<String>> {
    const MAX_RE_EXPORTS: usize = 8;
    let names = |(module, source): (&Module, &Source)| {
        let used =
            source.re_exports.iter().filter(|(name, _)| source.words.contains(*name)).map(|(_, path)| path);
        let paths = source.paths.iter().chain(used).filter_map(|path| absolute(path, module, source));
        let named = paths.map(|path| holder(sources, &path, MAX_RE_EXPORTS)).filter(|named| named != module);
        (module.clone(), named.collect())
    };
    let named: BTreeMap<Module, BTreeSet<Module>> = sources.iter().map(names).collect();
    let reached = |from: &Module| {
        let (mut reached, mut waiting) = (BTreeSet::new(), vec![from]);
        while let Some(module) = waiting.pop() {
            waiting.extend(named[module].iter().filter(|next| reached.insert((*next).clone())));
        }
        reached
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> =
        named.keys().map(|module| (module, reached(module))).collect();
    let mut found: BTreeSet<Vec<String>> = BTreeSet::new();
    for (module, others) in &reached {
        let circle = others.iter().filter(|other| reached[*other].contains(*module));
        found.insert(circle.map(|module| format!("crate::{}", module.join("::"))).collect());
    }
    let mut found: Vec<Vec<String>> = found.into_iter().filter(|circle| circle.len() > 1).collect();
    found.sort_by_key(|circle| std::cmp::Reverse(circle.len()));
    found
}

#[test]
fn names_are_followed_to_the_files_that_hold_them() {
    let file = |text: &str| Source::read(text);
    let module = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Module>();
    let sources = BTreeMap::from([
        (module(&[]), file("mod a;\nmod b;\npub use a::{Here, inner::There as Renamed};\n")),
        (
            module(&["a"]),
            file("pub mod inner;\nuse crate::b::Other;\n#[cfg(test)]\nmod tests { use crate::Here; }\n"),
        ),
        (
            module(&["a", "inner"]),
            file("use std::fmt;\n/// See `crate::b`.\nconst TEXT: &str = \"crate::b\";\n"),
        ),
        (module(&["b"]), file("fn f<'a>(_: &'a super::Renamed, _: char) { g(':', crate::Here::new()) }\n")),
    ]);
    assert_eq!(holder(&sources, &module(&["Renamed", "new"]), 8), module(&["a", "inner"]));
    assert_eq!(circles(&sources), [["crate::a", "crate::b"]]);
}

#[test]
fn no_more_than_four_files_name_each_other_in_a_circle() {
    let exceptions: BTreeMap<&str, usize> = EXCEPTIONS.iter().map(|&(name, size, _)| (name, size)).collect();
    let mut wrong = Vec::new();
    for entry in fs::read_dir(root().join("crates")).expect("the crates").flatten() {
        let name = entry.file_name().into_string().expect("a name in ASCII");
        let first = ["lib.rs", "main.rs"].map(|file| entry.path().join("src").join(file));
        let Some(first) = first.iter().find(|file| file.exists()) else { continue };
        let circle = circles(&read_crate(first)).into_iter().next().unwrap_or_default();
        match exceptions.get(name.as_str()) {
            Some(&most) if circle.len() > most => {
                wrong.push(format!(
                    "{name}: a circle of {} files, not {most}: {}",
                    circle.len(),
                    circle.join(", ")
                ));
            }
            Some(_) if circle.len() <= MAX_FILES => wrong.push(format!("{name} is no exception any more")),
            None if circle.len() > MAX_FILES => wrong.push(format!("{name}: {}", circle.join(", "))),
            Some(_) | None => {}
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
}
