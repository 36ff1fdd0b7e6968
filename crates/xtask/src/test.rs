//! `cargo xtask test`: everything that must hold, or the parts that are asked for.

use std::{
    collections::BTreeSet,
    io::{BufRead as _, BufReader, Read},
    num::NonZero,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::Instant,
};

use anyhow::{Context as _, Result, ensure};
use clap::ValueEnum;
use serde_json::Value;
use xtask::{
    browser::find_or_install_chromium,
    process::{cargo, run, show},
    site::{self, Flavour},
};

use crate::documentation;

/// What to test.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Only these parts; all of them if none is named.
    #[arg(value_enum)]
    parts: Vec<Part>,
}

/// A part that can be tested by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Formatting, lints of everything, documentation with its examples, and dependencies.
    Lints,
    /// The tests of the crates, and those across crates.
    Unit,
    /// The tests of the page in a browser.
    Page,
}

/// The package of the page's tests.
const PAGE_TESTS: &str = "page-tests";

/// What passed and what failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Count {
    passed: u64,
    failed: u64,
}

impl Count {
    fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

/// A program of tests that was built.
struct TestProgram {
    package: String,
    name: String,
    executable: PathBuf,
    /// Where cargo runs it.
    folder: PathBuf,
}

/// What a build found and made.
#[derive(Default)]
struct Build {
    succeeded: bool,
    warnings: BTreeSet<String>,
    programs: Vec<TestProgram>,
}

/// Runs the parts, whatever the checks before found, and ends with the line `N passed, N failed`. A check that is not a
/// test program counts as one failure if it fails, and not at all otherwise. Returns whether nothing failed.
pub(crate) fn run_parts(options: &Options) -> Result<bool> {
    let is_asked = |part| options.parts.is_empty() || options.parts.contains(&part);
    // Nothing is gained by testing for minutes before a missing browser is noticed.
    if is_asked(Part::Page) {
        find_or_install_chromium()?;
    }
    if is_asked(Part::Lints) || is_asked(Part::Page) {
        site::require_wasm_target()?;
    }
    let mut count = Count::default();
    if is_asked(Part::Lints) {
        count.add(timed("formatting", check_formatting));
        count.add(timed("dependencies", check_dependencies));
    }
    let mut warnings = BTreeSet::new();
    if is_asked(Part::Lints) || is_asked(Part::Page) {
        count.add(timed("page built", || {
            let built = build(&mut site::compile_command(Flavour::Development))?;
            warnings.extend(built.warnings);
            ensure!(built.succeeded, "it does not compile");
            site::assemble(Flavour::Development).map(drop)
        }));
    }
    let mut programs = Vec::new();
    count.add(timed("tests built", || {
        let mut command = cargo();
        command.args(["test", "--no-run"]);
        // Other packages would need other features of dependencies, and so other builds of them.
        if is_asked(Part::Lints) || is_asked(Part::Unit) {
            command.args(["--workspace", "--all-targets"]);
        } else {
            command.args(["--package", PAGE_TESTS]);
        }
        let built = build(&mut command)?;
        warnings.extend(built.warnings);
        programs = built.programs;
        ensure!(built.succeeded, "they do not compile");
        Ok(())
    }));
    if is_asked(Part::Lints) {
        count.add(timed("lints", || {
            ensure!(warnings.is_empty(), "{} warnings, shown above", warnings.len());
            Ok(())
        }));
    }
    let (page, unit): (Vec<_>, Vec<_>) =
        programs.into_iter().partition(|program| program.package == PAGE_TESTS);
    thread::scope(|scope| -> Result<()> {
        // One crate's documentation is read after the other, which leaves processors to the tests.
        let documentation =
            is_asked(Part::Lints).then(|| scope.spawn(|| counted("documentation", check_documentation)));
        if is_asked(Part::Unit) {
            count.add(counted("tests of the crates", || run_programs(&unit))?);
        }
        if let Some(documentation) = documentation {
            count.add(documentation.join().expect("checking documentation does not panic")?);
        }
        Ok(())
    })?;
    if is_asked(Part::Page) {
        count.add(counted("tests of the page", || run_programs(&page))?);
    }
    println!("{} passed, {} failed", count.passed, count.failed);
    Ok(count.failed == 0)
}

/// Runs a check, and prints its result and how long it took.
fn timed(name: &str, check: impl FnOnce() -> Result<()>) -> Count {
    let start = Instant::now();
    let outcome = check();
    let seconds = start.elapsed().as_secs_f64();
    match outcome {
        Ok(()) => {
            println!("{name}: good ({seconds:.0} s)");
            Count::default()
        }
        Err(reason) => {
            println!("{name}: FAILED ({seconds:.0} s): {reason:#}");
            Count { passed: 0, failed: 1 }
        }
    }
}

/// Runs tests, and says what came of them and how long they took.
fn counted(name: &str, run: impl FnOnce() -> Result<Count>) -> Result<Count> {
    let start = Instant::now();
    let count = run()?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{name}: {} passed, {} failed ({seconds:.0} s)", count.passed, count.failed);
    Ok(count)
}

fn check_formatting() -> Result<()> {
    run(cargo().args(["fmt", "--all", "--check"]))
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
        "cargo-deny is not installed: licenses, sources and versions are checked by a test, known vulnerabilities are \
         not (`cargo install --locked cargo-deny`)"
    );
    Ok(())
}

/// Has cargo compile our crates by clippy, which is the compiler with more lints: one build gives the lints and what is
/// run. No one edits between these builds, so nothing is kept for the next edit, or for a debugger.
fn linting(command: &mut Command) -> &mut Command {
    command
        .env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver")
        .env("CARGO_INCREMENTAL", "0")
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
}

/// Builds, showing and collecting warnings, which cargo repeats for what it need not compile again.
fn build(command: &mut Command) -> Result<Build> {
    let shown = show(command);
    let mut running = linting(command)
        .args(["--quiet", "--message-format", "json"])
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("`{shown}` could not be started"))?;
    let output = running.stdout.take().context("no output to read")?;
    let mut built = read_build(output)?;
    built.succeeded = running.wait()?.success();
    Ok(built)
}

fn read_build(messages: impl Read) -> Result<Build> {
    let mut built = Build::default();
    for line in BufReader::new(messages).lines() {
        let line = line?;
        let Ok(message) = serde_json::from_str::<Value>(&line) else { continue };
        if let Some(rendered) = message["message"]["rendered"].as_str() {
            let is_new = built.warnings.insert(rendered.to_owned());
            if is_new {
                eprint!("{rendered}");
            }
        }
        if message["profile"]["test"] == true
            && let Some(program) = read_program(&message)
        {
            built.programs.push(program);
        }
    }
    Ok(built)
}

fn read_program(artifact: &Value) -> Option<TestProgram> {
    let folder = Path::new(artifact["manifest_path"].as_str()?).parent()?;
    // Benchmarks are built for their lints; measuring is not testing.
    if artifact["target"]["kind"].as_array()?.contains(&"bench".into()) {
        return None;
    }
    // `path+file:///…/folder#name@version`, or without the name where the folder has it.
    let id = artifact["package_id"].as_str()?.rsplit_once('#')?;
    let package = match id.1.split_once('@') {
        Some((name, _)) => name.to_owned(),
        None => folder.file_name()?.to_str()?.to_owned(),
    };
    Some(TestProgram {
        package,
        name: artifact["target"]["name"].as_str()?.to_owned(),
        executable: artifact["executable"].as_str()?.into(),
        folder: folder.to_path_buf(),
    })
}

/// Runs test programs, as many at once as there are processors: a program that waits, or has one long test left, keeps none
/// idle.
fn run_programs(programs: &[TestProgram]) -> Result<Count> {
    ensure!(!programs.is_empty(), "there are no tests");
    let next = AtomicUsize::new(0);
    let run_next = || -> Result<Count> {
        let mut count = Count::default();
        while let Some(program) = programs.get(next.fetch_add(1, Ordering::Relaxed)) {
            count.add(run_program(program, programs.len() == 1)?);
        }
        Ok(count)
    };
    let count = thread::available_parallelism().map_or(1, NonZero::get).min(programs.len());
    thread::scope(|scope| {
        let running: Vec<_> = (0..count).map(|_| scope.spawn(run_next)).collect();
        let mut all = Count::default();
        for worker in running {
            all.add(worker.join().expect("running a program does not panic")?);
        }
        Ok(all)
    })
}

/// Runs a test program where cargo would run it, alone or beside others.
fn run_program(program: &TestProgram, is_alone: bool) -> Result<Count> {
    let mut command = Command::new(&program.executable);
    command.current_dir(&program.folder).env("CARGO_MANIFEST_DIR", &program.folder);
    if let Some(cargo) = std::env::var_os("CARGO") {
        command.env("CARGO", cargo);
    }
    run_counting(&format!("{}: {}", program.package, program.name), is_alone, linting(&mut command))
}

/// Links in the documentation lead somewhere, nothing in it is malformed, and its examples do what they say.
fn check_documentation() -> Result<Count> {
    let mut command = cargo();
    command.args(["test", "--quiet", "--doc", "--workspace", "--no-fail-fast"]);
    run_counting("documentation", false, linting(documentation::by_us(&mut command)?))
}

/// Runs a command of test programs and adds up the results. Shows what it says under a title: line by line if it runs alone,
/// else in one piece when it has ended. One that does not get as far as running them all counts as a failure.
fn run_counting(title: &str, is_alone: bool, command: &mut Command) -> Result<Count> {
    let shown = show(command);
    let mut running =
        command.stdout(Stdio::piped()).spawn().with_context(|| format!("`{shown}` could not be started"))?;
    let mut count = Count::default();
    let mut report = String::new();
    let mut say = |line: &str| {
        if is_alone {
            println!("{line}");
        } else {
            report.push_str(line);
            report.push('\n');
        }
    };
    say("");
    say(title);
    if let Some(output) = running.stdout.take() {
        for line in BufReader::new(output).lines() {
            let line = line?;
            say(&line);
            if let Some(result) = read_result(&line) {
                count.add(result);
            }
        }
    }
    if !running.wait()?.success() && count.failed == 0 {
        say(&format!("`{shown}` failed"));
        count.failed = 1;
    }
    print!("{report}");
    Ok(count)
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
    use std::fs;

    use xtask::process::root;

    use super::*;

    /// The words of a list such as `part: [lints, unit]` in the workflow of the public host.
    fn matrix_of_workflow(name: &str) -> Vec<String> {
        let workflow =
            fs::read_to_string(root().join(".github/workflows/ci.yml")).expect("there is a workflow");
        let list = workflow
            .lines()
            .find_map(|line| line.trim().strip_prefix(name)?.strip_prefix(": [")?.strip_suffix(']'))
            .unwrap_or_else(|| panic!("the workflow has no list `{name}`"));
        list.split(',').map(|word| word.trim().trim_matches('"').to_owned()).collect()
    }

    #[test]
    fn the_workflow_tests_every_part_on_the_declared_rust_and_on_the_latest() {
        let parts: Vec<String> = Part::value_variants()
            .iter()
            .map(|part| part.to_possible_value().expect("no part is hidden").get_name().to_owned())
            .collect();
        assert_eq!(matrix_of_workflow("part"), parts);
        assert_eq!(matrix_of_workflow("rust"), [env!("CARGO_PKG_RUST_VERSION"), "stable"]);
    }

    #[test]
    fn results_of_test_programs_are_read() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.02s";
        assert_eq!(read_result(line), Some(Count { passed: 12, failed: 3 }));
        assert_eq!(read_result("test read_result ... ok"), None);
    }

    #[test]
    fn a_build_tells_its_warnings_once_and_the_programs_that_are_tests() {
        let artifact = |test: bool, kind: &str, id: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","package_id":"path+file:///r/tests/page#{id}","manifest_path":"/r/tests/page/Cargo.toml","target":{{"kind":["{kind}"],"name":"it"}},"profile":{{"test":{test}}},"executable":"/t/it-1"}}"#
            )
        };
        let warning =
            r#"{"reason":"compiler-message","message":{"level":"warning","rendered":"warning: unused\n"}}"#;
        let messages = [
            warning.to_owned(),
            warning.to_owned(),
            artifact(false, "lib", "0.1.0"),
            artifact(true, "bench", "0.1.0"),
            artifact(true, "test", "0.1.0"),
            artifact(true, "test", "page-tests@0.1.0"),
        ];
        let built = read_build(messages.join("\n").as_bytes()).expect("readable");
        assert_eq!(built.warnings.len(), 1);
        let packages: Vec<&str> = built.programs.iter().map(|program| program.package.as_str()).collect();
        assert_eq!(packages, ["page", "page-tests"]);
        assert_eq!(built.programs[0].folder, Path::new("/r/tests/page"));
    }
}
