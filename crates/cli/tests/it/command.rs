//! The command, run in the repository's folder, and what goes in and comes out.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

pub(crate) fn enroute(arguments: &[&str]) -> Output {
    enroute_in(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")), arguments)
}

/// The command, run in another folder.
pub(crate) fn enroute_in(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_enroute"));
    command.current_dir(folder).args(arguments).output().expect("the command runs")
}

/// A new empty folder. Tests that run at once name different ones.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Returns what the command said beside its answer.
pub(crate) fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn answer(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

/// A file with this text, for the command to read.
pub(crate) fn file(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("the folder can be written to");
    path.to_str().expect("a path in UTF-8").to_owned()
}
