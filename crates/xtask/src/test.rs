//! `cargo xtask test`: everything that must hold, in one go.

use std::{
    io::{BufRead as _, BufReader},
    process::{Command, Stdio},
    time::Instant,
};

use anyhow::{Context as _, Result};
use xtask::{
    browser::find_or_install_chromium,
    process::{cargo, run, show},
    site::{self, Flavour, WASM_TARGET},
};

/// What passed and what failed, over all test programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Count {
    passed: u64,
    failed: u64,
}

/// Runs every check, whatever the ones before found, and ends with the line `N passed, N failed`. A check that is not
/// a test program counts as one failure if it fails, and not at all otherwise. Returns whether nothing failed.
pub(crate) fn run_all() -> Result<bool> {
    // Nothing is gained by testing for minutes before a missing browser is noticed.
    find_or_install_chromium()?;
    site::require_wasm_target()?;
    let mut count = Count::default();
    let checks: [(&str, &dyn Fn() -> Result<()>); 6] = [
        ("formatting", &check_formatting),
        ("lints", &check_lints),
        ("lints of the page's modules", &check_wasm_lints),
        ("documentation", &check_documentation),
        ("dependencies", &check_dependencies),
        ("the page's build", &|| site::build(Flavour::Development).map(drop)),
    ];
    for (name, check) in checks {
        let begun = Instant::now();
        match check() {
            Ok(()) => println!("{name}: good ({:.0} s)", begun.elapsed().as_secs_f64()),
            Err(reason) => {
                count.failed += 1;
                println!("{name}: FAILED: {reason:#}");
            }
        }
    }
    let begun = Instant::now();
    let tests = run_tests()?;
    println!("tests: {:.0} s", begun.elapsed().as_secs_f64());
    count.passed += tests.passed;
    count.failed += tests.failed;
    println!("{} passed, {} failed", count.passed, count.failed);
    Ok(count.failed == 0)
}

fn check_formatting() -> Result<()> {
    run(cargo().args(["fmt", "--all", "--check"]))
}

fn check_lints() -> Result<()> {
    run(cargo().args(["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"]))
}

/// The page's modules are empty but for the page's target.
fn check_wasm_lints() -> Result<()> {
    run(cargo().args([
        "clippy",
        "--package",
        "page",
        "--package",
        "worker",
        "--target",
        WASM_TARGET,
        "--profile",
        Flavour::Development.profile(),
        "--quiet",
        "--",
        "-D",
        "warnings",
    ]))
}

/// The libraries, whose documentation must build without warnings.
const DOCUMENTED: [&str; 28] = [
    "exact",
    "rmpl",
    "stn",
    "stnu",
    "tpn",
    "interchange",
    "controllability",
    "kirk",
    "verify",
    "terrain",
    "motion",
    "hca",
    "plant",
    "executive",
    "snapshot",
    "review",
    "link",
    "mission",
    "display",
    "layout",
    "report",
    "text_editing",
    "workbench",
    "theme",
    "editor",
    "terrain_view",
    "panels",
    "app",
];

/// Links in the documentation lead somewhere, and nothing in it is malformed.
fn check_documentation() -> Result<()> {
    let packages = DOCUMENTED.iter().flat_map(|&name| ["--package", name]);
    run(cargo().args(["doc", "--no-deps", "--quiet"]).args(packages).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Where `cargo-deny` is installed it checks all of `deny.toml`, known vulnerabilities too. The test
/// `every_dependency_keeps_the_rules_of_deny_toml` always checks all but these.
fn check_dependencies() -> Result<()> {
    let is_installed =
        cargo().args(["deny", "--version"]).output().is_ok_and(|answer| answer.status.success());
    if is_installed {
        return run(cargo().args(["deny", "--log-level", "error", "check"]));
    }
    println!(
        "cargo-deny is not installed: licences, sources and versions are checked by a test, known vulnerabilities are \
         not (`cargo install --locked cargo-deny`)"
    );
    Ok(())
}

/// Runs the workspace's tests, those of the page in a browser among them, and counts.
fn run_tests() -> Result<Count> {
    let mut tests = cargo();
    tests.args(["test", "--workspace", "--no-fail-fast"]);
    let (count, succeeded) = run_counting(&mut tests)?;
    if !succeeded && count.failed == 0 {
        // It did not get as far as running them all.
        return Ok(Count { failed: 1, ..count });
    }
    Ok(count)
}

/// Runs a command of cargo's test programs, showing what it says and adding up the results.
fn run_counting(command: &mut Command) -> Result<(Count, bool)> {
    let shown = show(command);
    let mut running =
        command.stdout(Stdio::piped()).spawn().with_context(|| format!("`{shown}` could not be started"))?;
    let mut count = Count::default();
    if let Some(output) = running.stdout.take() {
        for line in BufReader::new(output).lines() {
            let line = line?;
            println!("{line}");
            if let Some(result) = read_result(&line) {
                count.passed += result.passed;
                count.failed += result.failed;
            }
        }
    }
    Ok((count, running.wait()?.success()))
}

/// Reads `test result: ok. 3 passed; 0 failed; …`, the last line of a test program.
fn read_result(line: &str) -> Option<Count> {
    let counts = line.trim().strip_prefix("test result: ")?;
    let number_before = |word: &str| {
        counts.split(['.', ';']).find_map(|part| part.trim().strip_suffix(word)?.trim().parse().ok())
    };
    Some(Count { passed: number_before("passed")?, failed: number_before("failed")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_test_programs_are_read() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.02s";
        assert_eq!(read_result(line), Some(Count { passed: 12, failed: 3 }));
        assert_eq!(read_result("test read_result ... ok"), None);
    }
}
