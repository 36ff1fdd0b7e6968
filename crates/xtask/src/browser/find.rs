//! Finds Chromium, or installs it where that needs no questions.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, bail};

use crate::process::{find_program, run};

/// What Chromium and its kin are called on various systems.
const NAMES: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];

/// Where Chrome lies on systems that do not put it in the search path.
const PLACES: [&str; 2] = [
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
];

/// The program to run: `ENROUTE_BROWSER` if set, else the first known name in the search path, else the Debian package
/// installed on the spot when this is root on Debian. Fails with the command to run otherwise.
pub fn find_or_install_chromium() -> Result<PathBuf> {
    if let Some(chosen) = env::var_os("ENROUTE_BROWSER") {
        return Ok(chosen.into());
    }
    if let Some(found) = find_chromium() {
        return Ok(found);
    }
    let by_hand = "apt-get install --yes --no-install-recommends chromium";
    if is_root() && is_debian() {
        run(Command::new("apt-get").arg("update"))?;
        run(Command::new("apt-get")
            .args(["install", "--yes", "--no-install-recommends", "chromium"])
            .env("DEBIAN_FRONTEND", "noninteractive"))?;
        return find_chromium().context("the package chromium is installed, but brought no program");
    }
    if is_debian() {
        bail!("the page's tests need Chromium; run `sudo {by_hand}`");
    }
    bail!(
        "the page's tests need Chromium or Chrome in PATH: install it with your system's packages \
         (on Debian: `{by_hand}`), or set ENROUTE_BROWSER to the program"
    );
}

/// Returns whether this process runs as root.
pub fn is_root() -> bool {
    // The owner of a process's folder under /proc is the user it runs as.
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        fs::metadata("/proc/self").is_ok_and(|data| data.uid() == 0)
    }
    #[cfg(not(unix))]
    false
}

fn find_chromium() -> Option<PathBuf> {
    find_program(&NAMES).or_else(|| PLACES.map(PathBuf::from).into_iter().find(|path| path.is_file()))
}

fn is_debian() -> bool {
    Path::new("/etc/debian_version").exists() && find_program(&["apt-get"]).is_some()
}
