//! How much a browser downloads before the page's first frame and before its first plan, and the limits that hold.

use std::{fmt, fs, path::Path};

use anyhow::{Result, ensure};

use crate::dist::files_under;

/// The most that a browser downloads.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Before the first frame, in bytes.
    pub first_frame: u64,
    /// Before the first plan, in bytes: the first frame's download is part of it.
    pub first_plan: u64,
}

/// What `cargo xtask dist` and `cargo xtask size` hold the page to.
pub const LIMITS: Limits = Limits { first_frame: 3_200_000, first_plan: 4_600_000 };

/// When the page needs a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum When {
    /// Before it draws anything.
    FirstFrame,
    /// Before it shows a plan.
    FirstPlan,
    /// When something is opened that needs it, or never.
    Later,
}

/// A file of the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileSize {
    /// Its path in the page's folder.
    pub name: String,
    /// When it is needed.
    pub when: When,
    pub bytes: u64,
    /// Its bytes as a server hands it out that compresses with Brotli.
    pub compressed: u64,
}

/// What a browser downloads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Download {
    /// The files, by when they are needed and then by size, the largest first.
    pub files: Vec<FileSize>,
}

impl Download {
    /// Looks at a folder that `dist::compress` has gone through.
    pub fn of(dist: &Path) -> Result<Self> {
        let mut files = Vec::new();
        for name in files_under(dist, Path::new(""))? {
            if name.extension().is_some_and(|suffix| suffix == "br" || suffix == "gz") {
                continue;
            }
            let name = name.to_string_lossy().replace('\\', "/");
            let bytes = fs::metadata(dist.join(&name))?.len();
            let compressed = fs::metadata(dist.join(format!("{name}.br"))).map_or(bytes, |data| data.len());
            files.push(FileSize { when: when(&name), name, bytes, compressed });
        }
        files.sort_by_key(|file| (file.when, std::cmp::Reverse(file.compressed)));
        Ok(Self { files })
    }

    /// The compressed bytes that are needed until then.
    pub fn until(&self, when: When) -> u64 {
        self.files.iter().filter(|file| file.when <= when).map(|file| file.compressed).sum()
    }

    /// Fails where the download is larger than the limits, naming both.
    pub fn check(&self, limits: Limits) -> Result<()> {
        for (what, found, limit) in [
            ("first frame", self.until(When::FirstFrame), limits.first_frame),
            ("first plan", self.until(When::FirstPlan), limits.first_plan),
        ] {
            ensure!(
                found <= limit,
                "the download before the {what} has {found} bytes, and the limit is {limit}: `cargo xtask size` shows \
                 what it consists of"
            );
        }
        Ok(())
    }
}

impl fmt::Display for Download {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "{:>10} {:>10}  file", "bytes", "brotli")?;
        let mut last = None;
        for file in &self.files {
            if last.replace(file.when) != Some(file.when) {
                writeln!(
                    out,
                    "{}",
                    match file.when {
                        When::FirstFrame => "before the first frame",
                        When::FirstPlan => "and before the first plan",
                        When::Later => "later",
                    }
                )?;
            }
            writeln!(out, "{:>10} {:>10}  {}", file.bytes, file.compressed, file.name)?;
        }
        let megabytes = |when| self.until(when) as f64 / 1e6;
        let (frame, plan) = (megabytes(When::FirstFrame), megabytes(When::FirstPlan));
        writeln!(
            out,
            "download (Brotli): {frame:.3} MB before the first frame, {plan:.3} MB before the first plan"
        )
    }
}

/// When the page needs the file of this name.
fn when(name: &str) -> When {
    match name {
        "wasm/worker.js" | "wasm/worker_bg.wasm" | "web/core-worker.js" => When::FirstPlan,
        "index.html" | "wasm/page.js" | "wasm/page_bg.wasm" | "web/icon.svg" | "web/page.css" => {
            When::FirstFrame
        }
        "web/manifest.webmanifest" => When::FirstFrame,
        // The page's modules import each other.
        _ if name.starts_with("web/") && Path::new(name).extension().is_some_and(|it| it == "js") => {
            When::FirstFrame
        }
        _ => When::Later,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_download_over_a_limit_is_refused_and_one_at_the_limits_is_not() {
        let file = |name: &str, compressed| FileSize {
            name: name.to_owned(),
            when: when(name),
            bytes: 2 * compressed,
            compressed,
        };
        let download = Download {
            files: vec![
                file("wasm/page_bg.wasm", 90),
                file("web/start.js", 10),
                file("wasm/worker_bg.wasm", 50),
                file("documentation.json", 1000),
            ],
        };
        assert!(download.check(Limits { first_frame: 100, first_plan: 150 }).is_ok());
        for (first_frame, first_plan, told) in [(99, 150, "100 bytes"), (100, 149, "150 bytes")] {
            let refusal = download.check(Limits { first_frame, first_plan }).expect_err("it is too large");
            assert!(refusal.to_string().contains(told), "{refusal}");
        }
    }
}
