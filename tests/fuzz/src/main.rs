//! A long run: `cargo xtask fuzz`.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line talks to its user")]

use std::fs::{self, File};
use std::io::{Seek as _, SeekFrom, Write as _};
use std::panic::{set_hook, take_hook};
use std::path::{Path, PathBuf};
use std::process::{ExitCode, exit};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use clap::Parser;
use fuzz::attack::attack;
use fuzz::readers::{READERS, Reader, by_name};

/// Gives mutated inputs to every reader of other people's data, and prints the results.
#[derive(Parser)]
#[command(name = "cargo xtask fuzz", bin_name = "cargo xtask fuzz")]
struct Arguments {
    /// How many inputs each reader gets; those that plan or run what they read get a part of it.
    #[arg(long, default_value_t = 10_000)]
    executions: u64,
    /// Only these readers; all without it.
    #[arg(long)]
    reader: Vec<String>,
    /// Gives one reader this file only, and says where it panics.
    #[arg(long, requires = "reader")]
    input: Option<PathBuf>,
    /// Decides how inputs are changed: the same seed gives the same inputs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// An input that takes longer, in seconds, is one that hangs: the run ends.
    #[arg(long, default_value_t = 20)]
    most_secs: u64,
}

/// Since when the reader is at an input.
static AT: Mutex<Option<Instant>> = Mutex::new(None);

fn main() -> Result<ExitCode> {
    let arguments = Arguments::parse();
    let readers: Vec<&Reader> = match arguments.reader.as_slice() {
        [] => READERS.iter().collect(),
        names => {
            let named = |name: &String| by_name(name).with_context(|| format!("there is no reader `{name}`"));
            names.iter().map(named).collect::<Result<_>>()?
        }
    };
    if let (Some(input), Some(reader)) = (&arguments.input, readers.first()) {
        (reader.exercise)(&fs::read(input)?);
        println!("{} holds", reader.name);
        return Ok(ExitCode::SUCCESS);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/fuzz");
    fs::create_dir_all(&folder)?;
    watch_for_hangs(Duration::from_secs(arguments.most_secs));
    println!(
        "{:20} {:>11} {:>9} {:>9} {:>9} {:>7} {:>11} {:>8}",
        "reader", "executions", "read", "seconds", "outcomes", "panics", "slowest ms", "peak MB"
    );
    let (mut executions, mut panics, begun) = (0, 0, Instant::now());
    for reader in readers {
        let [done, broke] = run(reader, &arguments, &folder)?;
        executions += done;
        panics += broke;
    }
    println!(
        "{:20} {executions:>11} {:>9} {:>9.1} {:>9} {panics:>7}",
        "all",
        "",
        begun.elapsed().as_secs_f64(),
        ""
    );
    Ok(if panics == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Attacks one reader. Each input is written down before it is exercised, for what ends the whole program.
fn run(reader: &Reader, arguments: &Arguments, folder: &Path) -> Result<[u64; 2]> {
    let at = folder.join(format!("{}.input", reader.name));
    let mut file = File::create(&at)?;
    let mut failed = Ok(());
    forget_peak_memory();
    let hook = take_hook();
    set_hook(Box::new(|_| {}));
    let executions = arguments.executions.div_ceil(reader.cost);
    let tally = attack(reader, executions, arguments.seed, &mut |input| {
        let written = file.seek(SeekFrom::Start(0)).and_then(|_| file.write_all(input));
        if let Err(reason) = written.and_then(|()| file.set_len(input.len() as u64)) {
            failed = Err(reason);
        }
        if let Ok(mut at) = AT.lock() {
            *at = Some(Instant::now());
        }
    });
    set_hook(hook);
    if let Ok(mut at) = AT.lock() {
        *at = None;
    }
    failed.with_context(|| format!("{} cannot be written", at.display()))?;
    fs::remove_file(&at)?;
    println!(
        "{:20} {:>11} {:>9} {:>9.1} {:>9} {:>7} {:>11.1} {:>8}",
        reader.name,
        tally.executions,
        tally.read,
        tally.took.as_secs_f64(),
        tally.outcomes,
        tally.breaking.len(),
        tally.slowest.0.as_secs_f64() * 1e3,
        peak_memory_mb().map_or("?".to_owned(), |peak| peak.to_string()),
    );
    fs::write(folder.join(format!("{}.slowest", reader.name)), &tally.slowest.1)?;
    for breaking in &tally.breaking {
        let path: PathBuf = folder.join(format!("{}-{}", reader.name, breaking.number));
        fs::write(&path, &breaking.input)?;
        eprintln!("  panics: {}", path.display());
    }
    if tally.executions == 0 {
        bail!("{} has no seeds", reader.name);
    }
    Ok([tally.executions, tally.breaking.len() as u64])
}

/// Ends the run when an input takes too long; it lies in `target/fuzz` then, as it does when the program is aborted.
fn watch_for_hangs(most: Duration) {
    thread::spawn(move || {
        loop {
            thread::sleep(Duration::from_secs(1));
            let at = AT.lock().ok().and_then(|at| *at);
            if at.is_some_and(|since| since.elapsed() > most) {
                eprintln!("an input takes more than {} s: see target/fuzz/*.input", most.as_secs());
                exit(2);
            }
        }
    });
}

/// The most memory that the program has had since it was last asked to forget, where the system tells (Linux).
fn peak_memory_mb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? / 1024)
}

fn forget_peak_memory() {
    // Where the system cannot forget, the peak is that of the whole run so far.
    let _ = fs::write("/proc/self/clear_refs", "5");
}
