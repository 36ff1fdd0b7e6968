//! Rules of the repository, as tests: layering of the crates, licenses, reasons for dependencies, file headers.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;
use xtask::{
    dependencies::Rules,
    process::{cargo, root},
};

/// What each crate builds on: ARCHITECTURE.md's layers. A crate may use whatever these build on in turn.
pub(crate) const LAYERS: &[(&str, &[&str])] = &[
    ("exact", &[]),
    ("markup", &[]),
    ("rmpl", &["exact"]),
    ("stn", &[]),
    ("stnu", &["exact", "markup", "stn"]),
    ("terrain", &[]),
    ("tpn", &["rmpl", "markup"]),
    ("interchange", &["tpn"]),
    ("controllability", &["tpn", "stnu"]),
    ("kirk", &["tpn", "stn", "stnu", "controllability"]),
    ("verify", &["tpn"]),
    ("motion", &["terrain"]),
    ("hca", &["rmpl", "markup"]),
    ("plant", &["hca"]),
    ("executive", &["kirk", "controllability", "motion", "hca", "plant"]),
    ("snapshot", &["executive", "verify"]),
    ("review", &["snapshot"]),
    ("link", &["review"]),
    ("mission", &["link", "interchange"]),
    ("display", &["markup"]),
    ("layout", &["display", "tpn", "hca"]),
    ("report", &["review", "interchange", "layout"]),
    ("text_editing", &["rmpl"]),
    ("markdown", &[]),
    ("workbench", &["link", "report", "text_editing", "markdown"]),
    ("theme", &["display", "markdown"]),
    ("editor", &["text_editing", "theme"]),
    ("terrain_view", &["workbench", "theme"]),
    ("panels", &["workbench", "terrain_view", "editor"]),
    ("app", &["panels", "mission"]),
    ("page", &["app"]),
    ("worker", &["mission"]),
    ("cli", &["mission", "report"]),
    ("xtask", &[]),
];

/// The front end, the command line and `xtask`. All other crates compute the same everywhere: no clocks, no threads, no
/// files, nothing from the operating system.
const HOSTS: [&str; 9] =
    ["theme", "editor", "terrain_view", "panels", "app", "page", "worker", "cli", "xtask"];

fn pure() -> impl Iterator<Item = &'static str> {
    LAYERS.iter().map(|(name, _)| *name).filter(|name| !HOSTS.contains(name))
}

/// What pure crates are built and tested without.
const DRAWING: [&str; 5] = ["egui", "eframe", "egui_tiles", "theme", "wgpu"];

/// What pure crates leave alone.
const IMPURE: [&str; 7] =
    ["std::fs", "std::net", "std::process", "std::thread", "std::time", "Instant::now", "SystemTime"];

fn metadata() -> Value {
    let answer = cargo()
        .args(["metadata", "--format-version", "1", "--all-features"])
        .output()
        .expect("cargo runs, since it runs this test");
    assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
    serde_json::from_slice(&answer.stdout).expect("cargo metadata writes JSON")
}

fn packages(metadata: &Value) -> impl Iterator<Item = &Value> {
    metadata["packages"].as_array().into_iter().flatten()
}

/// The manifests of the workspace, by the folder they lie in.
pub(crate) fn manifests() -> Vec<PathBuf> {
    let mut found = vec![root().join("tests/Cargo.toml")];
    for folder in ["crates", "tests"] {
        for entry in fs::read_dir(root().join(folder)).expect("a folder of packages").flatten() {
            found.push(entry.path().join("Cargo.toml"));
        }
    }
    found.retain(|path| path.is_file());
    found.sort();
    found
}

/// All Rust sources below a folder.
pub(crate) fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn crates_depend_only_on_the_layers_below_them() {
    let layers: BTreeMap<&str, &[&str]> = LAYERS.iter().copied().collect();
    let metadata = metadata();
    let ours: BTreeSet<&str> = packages(&metadata)
        .filter(|package| package["source"].is_null())
        .filter_map(|package| package["name"].as_str())
        .collect();
    for package in packages(&metadata).filter(|package| package["source"].is_null()) {
        let name = package["name"].as_str().expect("packages have names");
        // Packages that only test may use everything.
        if package["manifest_path"].as_str().is_some_and(|path| path.contains("/tests/")) {
            continue;
        }
        assert!(layers.contains_key(name), "the layers do not say where {name} is");
        let below = everything_below(name, &layers);
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let on = dependency["name"].as_str().expect("dependencies have names");
            // Tests may check one layer against another.
            if dependency["kind"] == "dev" || !ours.contains(on) {
                continue;
            }
            assert!(below.contains(on), "{name} must not depend on {on}");
        }
    }
}

#[test]
fn the_page_is_built_without_the_core() {
    let metadata = metadata();
    let mut reached = BTreeSet::from(["page"]);
    let mut waiting = vec!["page"];
    while let Some(name) = waiting.pop() {
        let package =
            packages(&metadata).find(|package| package["name"] == name && package["source"].is_null());
        let dependencies =
            package.into_iter().filter_map(|package| package["dependencies"].as_array()).flatten();
        for dependency in dependencies {
            let is_of_page =
                dependency["kind"].is_null() && dependency["target"] != "cfg(not(target_arch = \"wasm32\"))";
            let on = dependency["name"].as_str().expect("dependencies have names");
            if is_of_page && reached.insert(on) {
                waiting.push(on);
            }
        }
    }
    assert!(reached.contains("link"), "the page asks the core");
    assert!(!reached.contains("mission"), "the core is in the worker alone");
}

#[test]
fn pure_crates_are_built_without_anything_that_draws() {
    let metadata = metadata();
    let ours: BTreeMap<&str, &Value> = packages(&metadata)
        .filter(|package| package["source"].is_null())
        .filter_map(|package| Some((package["name"].as_str()?, package)))
        .collect();
    for name in pure() {
        for dependency in ours[name]["dependencies"].as_array().into_iter().flatten() {
            let on = dependency["name"].as_str().expect("dependencies have names");
            assert!(!DRAWING.contains(&on), "{name} must not depend on {on}");
        }
    }
}

/// Returns what a crate builds on, directly or not.
pub(crate) fn everything_below<'a>(
    name: &'a str,
    layers: &BTreeMap<&'a str, &'a [&'a str]>,
) -> BTreeSet<&'a str> {
    let direct = layers.get(name).copied().unwrap_or_default();
    direct.iter().flat_map(|&below| everything_below(below, layers).into_iter().chain([below])).collect()
}

#[test]
fn the_checker_shares_no_code_with_the_planner() {
    let manifest = fs::read_to_string(root().join("crates/verify/Cargo.toml")).expect("the crate verify");
    for planner in ["kirk", "stn", "controllability"] {
        assert!(
            !manifest.lines().any(|line| line.starts_with(planner)),
            "verify must not depend on {planner}"
        );
    }
}

#[test]
fn every_dependency_keeps_the_rules_of_deny_toml() {
    let text = fs::read_to_string(root().join("deny.toml")).expect("deny.toml");
    let rules = Rules::read(&text).expect("rules that are checked");
    assert_eq!(rules.check(&metadata()), Vec::<String>::new());
}

#[test]
fn every_outside_dependency_has_its_reason_beside_it() {
    let ours: BTreeSet<&str> = LAYERS.iter().map(|(name, _)| *name).collect();
    let mut missing = Vec::new();
    for manifest in manifests() {
        let text = fs::read_to_string(&manifest).expect("a manifest");
        let mut in_dependencies = false;
        let mut before = "";
        for line in text.lines() {
            if line.starts_with('[') {
                in_dependencies = line.contains("dependencies");
            } else if in_dependencies && line.starts_with(|first: char| first.is_ascii_lowercase()) {
                let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
                let has_reason = before.starts_with('#') || line.contains('#');
                if !ours.contains(name) && !has_reason {
                    missing.push(format!("{}: {name}", manifest.display()));
                }
            }
            before = line;
        }
    }
    assert!(missing.is_empty(), "no reason given for:\n{}", missing.join("\n"));
}

#[test]
fn every_source_says_what_it_is() {
    let mut silent = Vec::new();
    for source in sources(&root().join("crates")).into_iter().chain(sources(&root().join("tests"))) {
        let text = fs::read_to_string(&source).expect("a source");
        if !text.starts_with("//!") {
            silent.push(source.display().to_string());
        }
    }
    assert!(silent.is_empty(), "no `//!` at the top of:\n{}", silent.join("\n"));
}

#[test]
fn a_library_that_is_not_built_for_tests_has_none() {
    let metadata = metadata();
    let packages = packages(&metadata).filter(|package| package["source"].is_null());
    let targets = packages.flat_map(|package| package["targets"].as_array().into_iter().flatten());
    let mut found = Vec::new();
    for library in targets.filter(|target| target["kind"][0] == "lib" && target["test"] == false) {
        let folder = Path::new(library["src_path"].as_str().expect("a path")).parent().expect("a folder");
        found.extend(sources(folder).into_iter().filter(|source| {
            let text = fs::read_to_string(source).expect("a source");
            text.lines().any(|line| line.trim_start().starts_with("#[test]") || line.contains("cfg(test)"))
        }));
    }
    assert!(found.is_empty(), "tests that never run: {found:?}");
}

/// Returns whether a module is compiled for tests only: the module above it says so.
pub(crate) fn is_test(source: &Path) -> bool {
    let (Some(folder), Some(name)) = (source.parent(), source.file_stem()) else { return false };
    let declaration = format!("#[cfg(test)]\nmod {};", name.display());
    ["mod.rs", "lib.rs"]
        .iter()
        .filter_map(|file| fs::read_to_string(folder.join(file)).ok())
        .any(|above| above.contains(&declaration))
}

#[test]
fn pure_crates_leave_the_machine_alone() {
    let mut found = Vec::new();
    for name in pure() {
        for source in sources(&root().join("crates").join(name).join("src")) {
            if is_test(&source) {
                continue;
            }
            let text = fs::read_to_string(&source).expect("a source");
            let code: String = text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
                .collect::<Vec<_>>()
                .join("\n");
            for impure in IMPURE {
                if code.contains(impure) {
                    found.push(format!("{}: {impure}", source.display()));
                }
            }
        }
    }
    assert!(found.is_empty(), "pure crates use the machine:\n{}", found.join("\n"));
}
