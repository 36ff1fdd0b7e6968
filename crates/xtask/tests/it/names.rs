//! What documents name is there: paths, items of crates, the crates themselves, and the Rust version.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use regex::Regex;
use xtask::process::root;

use crate::citations::texts;
use crate::repository::{LAYERS, everything_below, sources};

/// The folders of the repository whose files documents name by their whole path.
const FOLDERS: [&str; 9] =
    [".ci/", ".github/", "assets/", "bench/", "crates/", "docs/", "examples/", "tests/", "web/"];

/// The documents about the repository, and not those that are its tests.
fn documents() -> impl Iterator<Item = (PathBuf, String)> {
    texts().into_iter().filter(|(path, _)| {
        path.extension().is_some_and(|extension| extension == "md")
            && !["tests/suite", "tests/conformance", "assets", "CHANGELOG.md"]
                .iter()
                .any(|other| path.starts_with(other))
    })
}

/// Returns what is between backticks in the prose of a Markdown text.
fn code_words(markdown: &str) -> Vec<&str> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in markdown.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            found.extend(line.split('`').skip(1).step_by(2));
        }
    }
    found
}

/// The part of a word that names a path of this repository, up to the first part in capitals, which represents any name.
fn path_of(word: &str) -> Option<String> {
    let is_path =
        word.contains('/') && word.chars().all(|it| it.is_ascii_alphanumeric() || "._-/".contains(it));
    let is_source = Path::new(word).extension().is_some_and(|extension| extension == "rs");
    let is_ours = is_source || FOLDERS.iter().any(|folder| word.starts_with(folder));
    let is_placeholder = |part: &&str| part.len() > 1 && part.chars().all(|it| it.is_ascii_uppercase());
    (is_path && is_ours)
        .then(|| word.split('/').take_while(|part| !is_placeholder(part)).collect::<Vec<_>>().join("/"))
}

/// The folders that a path may be below: of the repository, or of the sources of a crate.
fn bases() -> Vec<PathBuf> {
    let crates = fs::read_dir(root().join("crates")).expect("the crates").flatten().map(|entry| entry.path());
    [root(), root().join("crates"), root().join("tests")]
        .into_iter()
        .chain(crates.flat_map(|path| [path.join("src"), path]))
        .collect()
}

#[test]
fn paths_are_told_from_other_words() {
    assert_eq!(path_of("tests/fuzz/broken/NAME"), Some("tests/fuzz/broken".to_owned()));
    assert_eq!(path_of("syntax/lexer.rs"), Some("syntax/lexer.rs".to_owned()));
    for other in ["40/2", "enroute-mission/1", "mod.rs", "a + b/c", "target/fuzz"] {
        assert_eq!(path_of(other), None, "{other}");
    }
}

#[test]
fn every_path_that_a_document_names_exists() {
    let bases = bases();
    let mut count = 0;
    let mut wrong = Vec::new();
    for (document, text) in documents() {
        for path in code_words(&text).into_iter().filter_map(path_of) {
            count += 1;
            if !bases.iter().any(|base| base.join(&path).exists()) {
                wrong.push(format!("{}: {path}", document.display()));
            }
        }
    }
    assert!(count > 50, "only {count} paths were found");
    assert!(wrong.is_empty(), "there are no such files:\n{}", wrong.join("\n"));
}

#[test]
fn every_item_that_a_document_names_is_in_its_crate() {
    let mut words: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    for (name, _) in LAYERS {
        let folder = root().join("crates").join(name).join("src");
        // A module may be named by its file alone.
        let mut found: BTreeSet<String> = BTreeSet::new();
        for source in sources(&folder) {
            let text = fs::read_to_string(&source).expect("a source");
            found.extend(text.split(|it: char| !it.is_alphanumeric() && it != '_').map(str::to_owned));
        }
        words.insert(name, found);
    }
    let mut count = 0;
    let mut wrong = Vec::new();
    for (document, text) in documents() {
        for word in code_words(&text) {
            let mut parts = word.split("::");
            let Some(known) = parts.next().and_then(|name| words.get(name)) else { continue };
            for part in parts {
                count += 1;
                if !known.contains(part) {
                    wrong.push(format!("{}: {word}", document.display()));
                }
            }
        }
    }
    assert!(count > 10, "only {count} items were found");
    assert!(wrong.is_empty(), "there are no such items:\n{}", wrong.join("\n"));
}

/// What items and files are not called, and what to write instead.
const BANNED_NAMES: [(&str, &str); 6] = [
    (r"^(LEAST|MOST)_", "MIN_, MAX_"),
    (r"^([a-z]+_)?whole(_[a-z]+)?$|^Whole", "complete, full, or what it covers"),
    (r"demanding", "what is searched for"),
    (r"^(quiet|Quiet)", "muted, silent"),
    (r"^([Kk]eeper|Outside)$", "what it exchanges with the host"),
    (r"^(is_)?worked_out$", "evaluated, or calculated"),
];

#[test]
fn items_and_modules_have_the_field_s_names() {
    let item = r"\b(?:fn|mod|struct|enum|trait|type|const|static)\s+([A-Za-z_][A-Za-z0-9_]*)";
    let item = Regex::new(item).expect("a pattern");
    let banned = BANNED_NAMES.map(|(name, instead)| (Regex::new(name).expect("a pattern"), instead));
    let (mut wrong, mut count) = (Vec::new(), 0);
    for source in ["crates", "tests"].into_iter().flat_map(|folder| sources(&root().join(folder))) {
        let text = fs::read_to_string(&source).expect("sources are UTF-8");
        for found in item.captures_iter(&text) {
            count += 1;
            let name = &found[1];
            let bad = banned.iter().filter(|(pattern, _)| pattern.is_match(name));
            wrong.extend(bad.map(|(_, instead)| format!("{}: {name} (say {instead})", source.display())));
        }
    }
    assert!(count > 10_000, "only {count} items");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn manifest() -> toml::Table {
    let text = fs::read_to_string(root().join("Cargo.toml")).expect("the manifest of the workspace");
    text.parse().expect("a manifest is TOML")
}

#[test]
fn every_crate_is_in_every_list_of_crates() {
    let folders: BTreeSet<String> = fs::read_dir(root().join("crates"))
        .expect("the crates")
        .flatten()
        .filter(|entry| entry.path().join("Cargo.toml").is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    let layers: BTreeSet<String> = LAYERS.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(layers, folders, "the layers in {}", file!());

    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the architecture");
    let layers: BTreeMap<&str, &[&str]> = LAYERS.iter().copied().collect();
    let mut described = BTreeSet::new();
    for row in text.lines().filter(|line| line.starts_with("| `")) {
        let columns: Vec<&str> = row.trim_matches('|').split('|').collect();
        let [names, _, on] = columns[..] else { continue };
        let names = code_words(names);
        described.extend(names.iter().map(|&name| name.to_owned()));
        if on.trim() == "all above" {
            continue;
        }
        // What the row names, and what that builds on, is what the crate may use.
        let on = code_words(on);
        let with_below = |on: &[&str]| -> BTreeSet<String> {
            let below = on.iter().flat_map(|&on| everything_below(on, &layers).into_iter().chain([on]));
            below.map(str::to_owned).collect()
        };
        let allowed: Vec<&str> = names.iter().flat_map(|name| layers[name]).copied().collect();
        assert_eq!(with_below(&on), with_below(&allowed), "ARCHITECTURE.md, {names:?}");
    }
    assert_eq!(described, folders, "the crates in ARCHITECTURE.md");

    let manifest = manifest();
    for (name, dependency) in manifest["workspace"]["dependencies"].as_table().expect("dependencies") {
        if let Some(path) = dependency.get("path").and_then(toml::Value::as_str) {
            assert!(root().join(path).join("Cargo.toml").is_file(), "Cargo.toml: there is no {path}");
            assert_eq!(path.starts_with("crates/"), folders.contains(name), "Cargo.toml: {path}");
        }
    }
    // Other workspaces may name the crates as well; a profile for a crate that is gone builds nothing.
    let lock = fs::read_to_string(root().join("Cargo.lock")).expect("the lock file");
    for (profile, settings) in manifest["profile"].as_table().expect("profiles") {
        let packages = settings.get("package").and_then(toml::Value::as_table);
        for name in packages.into_iter().flat_map(toml::Table::keys).filter(|name| *name != "*") {
            assert!(
                lock.contains(&format!("\nname = \"{name}\"\n")),
                "profile {profile}: there is no {name}"
            );
        }
    }
}

#[test]
fn every_place_names_the_same_rust_version() {
    let manifest = manifest();
    let version = manifest["workspace"]["package"]["rust-version"].as_str().expect("a version");
    for (document, named) in [
        ("README.md", format!("({version} or later")),
        ("CONTRIBUTING.md", format!("({version} or later")),
        (".github/workflows/ci.yml", format!("rust: [\"{version}\"")),
        ("bench/peers/Cargo.toml", format!("rust-version = \"{version}\"")),
    ] {
        let text = fs::read_to_string(root().join(document)).expect("a document");
        assert!(text.contains(&named), "{document} does not name Rust {version}");
    }
}

#[test]
fn every_panel_is_in_each_place_that_its_recipe_names() {
    let recipes = fs::read_to_string(root().join("CONTRIBUTING.md")).expect("the recipes");
    let (_, recipe) = recipes.split_once("\n### A panel\n").expect("a recipe for a panel");
    let recipe = recipe.split("\n### ").next().unwrap_or_default();
    let places: Vec<String> = code_words(recipe)
        .into_iter()
        .filter_map(path_of)
        .filter(|path| root().join(path).is_file())
        .collect();
    assert_eq!(places.len(), 3, "{places:?}");
    let read = |place: &String| fs::read_to_string(root().join(place)).expect("a source");
    // The table of kinds: `Kind: "name", "title", …;`.
    let table = read(&places[0]);
    let kinds: Vec<&str> = table
        .lines()
        .filter_map(|line| line.trim().split_once(": \""))
        .map(|(kind, _)| kind)
        .filter(|kind| kind.chars().all(char::is_alphanumeric))
        .collect();
    assert!(kinds.len() > 10 && kinds.contains(&"Timeline"), "{kinds:?}");
    for place in &places {
        let text = read(place);
        let words: BTreeSet<&str> = text.split(|it: char| !it.is_alphanumeric()).collect();
        for kind in &kinds {
            assert!(words.contains(kind), "{place} does not name the panel {kind}");
        }
    }
}
