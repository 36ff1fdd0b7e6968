//! axe-core, which looks for what is inaccessible in a page: its script, fetched when it is first wanted.

use std::{fs, process::Command};

use crate::process;

/// The version that is asked for.
const VERSION: &str = "4.10.3";

/// The script, or why there is none: it comes from the package registry by `npm`, and is kept in `target/`.
pub fn axe_script() -> Result<String, String> {
    let folder = process::root().join("target").join(format!("axe-core-{VERSION}"));
    let script = folder.join("node_modules/axe-core/axe.min.js");
    if !script.exists() {
        fs::create_dir_all(&folder).map_err(|reason| reason.to_string())?;
        let outcome = Command::new("npm")
            .args(["install", "--ignore-scripts", "--no-audit", "--no-fund", "--silent", "--prefix"])
            .arg(&folder)
            .arg(format!("axe-core@{VERSION}"))
            .output()
            .map_err(|reason| format!("npm cannot be started: {reason}"))?;
        if !outcome.status.success() {
            return Err(format!("npm: {}", String::from_utf8_lossy(&outcome.stderr).trim()));
        }
    }
    fs::read_to_string(&script).map_err(|reason| format!("{}: {reason}", script.display()))
}
