//! The conformance cases: where they are, how they are read, and which of them describe what is not built yet.

use std::path::{Path, PathBuf};

use serde_json::Value;

/// Cases whose features are specified and not built yet, by id, each with what is missing. A case that is listed must
/// not pass, so that the list shrinks with every feature that is built.
pub const NOT_BUILT: [(&str, &str); 0] = [];

/// Cases of the suite that are not copied yet, by the stems of their files: they ask for what is not built.
pub const NOT_COPIED: [&str; 10] = [
    // Levels and what the environment chooses, not tried yet.
    "l01_drain_tightened",
    "l03_overflow",
    "l04_overflow_saturating",
    "l05_charge_between",
    "l10_jump_and_slope",
    "n01_weather",
    "n03_too_early",
    "n05_safe_alternative",
    "n08_wait_or_act",
    "n11_nested_nature",
];

/// Returns what is missing for a case to pass, if anything is.
pub fn not_built(case: &Value) -> Option<&'static str> {
    NOT_BUILT.iter().find(|(id, _)| case["id"] == *id).map(|&(_, missing)| missing)
}

/// Compares what came of a case with the list of what is not built: a case passes unless it is listed.
pub fn expect_as_listed(case: &Value, outcome: Result<(), String>) {
    let id = &case["id"];
    match (not_built(case), outcome) {
        (None, Err(problem)) => panic!("{id}: {problem}"),
        (Some(missing), Ok(())) => {
            panic!("{id} passes, though {missing} is listed as not built: take it off the list NOT_BUILT")
        }
        (None, Ok(())) | (Some(_), Err(_)) => {}
    }
}

/// Returns where the cases lie.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance")
}

/// The text of a file.
pub fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()))
}

/// All cases, by file name.
pub fn all() -> Vec<(String, Value)> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder())
        .expect("the cases are there")
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.sort();
    (files.iter())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .map(|path| (path.display().to_string(), serde_json::from_str(&read(path)).expect("a case is JSON")))
        .collect()
}

/// The cases of a kind, by file name. There is at least one, so that a test over none cannot pass.
pub fn cases(kind: &str) -> Vec<(String, Value)> {
    let mut cases = all();
    cases.retain(|(_, case)| case["kind"] == kind);
    assert!(!cases.is_empty(), "there is no case of kind {kind}");
    cases
}

/// The program of a case.
pub fn program(case: &Value) -> String {
    read(&folder().join(case["program"].as_str().expect("a case names its program")))
}
