//! The changelog and the version of the workspace agree, and the changelog has the form that the writing guide asks for.

use std::fs;

use regex::Regex;
use xtask::process::root;

/// The most words of a line about a change.
const MAX_WORDS: usize = 25;

#[test]
fn the_newest_version_of_the_changelog_is_that_of_the_workspace() {
    let text = fs::read_to_string(root().join("CHANGELOG.md")).expect("a changelog");
    let heading = Regex::new(r"^(\d+)\.(\d+)\.(\d+) – (\d{4}-\d{2}-\d{2})$").expect("a pattern");
    let mut versions: Vec<([u64; 3], String)> = Vec::new();
    for (index, line) in text.lines().filter_map(|line| line.strip_prefix("## ")).enumerate() {
        if index == 0 && line == "Unreleased" {
            continue;
        }
        let parts =
            heading.captures(line).unwrap_or_else(|| panic!("`## {line}`: write a version and a date"));
        let number = [1, 2, 3].map(|part| parts[part].parse().expect("a number"));
        versions.push((number, parts[4].to_owned()));
    }
    let is_newer = |pair: &[([u64; 3], String)]| pair[0].0 > pair[1].0 && pair[0].1 >= pair[1].1;
    assert!(versions.windows(2).all(is_newer), "the newest version comes first: {versions:?}");
    let (newest, _) = versions.first().expect("a released version");
    assert_eq!(newest.map(|part| part.to_string()).join("."), env!("CARGO_PKG_VERSION"));
}

#[test]
fn each_change_is_one_short_line_below_its_kind() {
    let text = fs::read_to_string(root().join("CHANGELOG.md")).expect("a changelog");
    let mut is_below_a_kind = false;
    let mut known = Vec::new();
    for line in text.lines() {
        if line.starts_with("## ") {
            is_below_a_kind = false;
        } else if let Some(kind) = line.strip_prefix("### ") {
            assert!(
                ["Added", "Changed", "Fixed"].contains(&kind),
                "`### {kind}`: write Added, Changed or Fixed"
            );
            is_below_a_kind = true;
        } else if let Some(change) = line.strip_prefix("* ") {
            assert!(is_below_a_kind, "below Added, Changed or Fixed: {line}");
            let words = change.split_whitespace().count();
            assert!(words <= MAX_WORDS, "{words} words, at most {MAX_WORDS}: {line}");
            assert!(!known.contains(&change), "listed twice: {line}");
            known.push(change);
        }
    }
    assert!(known.len() > 50, "only {} changes", known.len());
}
