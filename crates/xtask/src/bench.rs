//! `cargo xtask bench`: the benchmark tables of all crates, one after the other so that none disturbs another; with
//! `--peers` the tables of `bench/peers`, which run the same problems through other programs too.

use std::{fs, path::Path};

use anyhow::{Context as _, Result, bail};
use xtask::process::{cargo, root, run, target_dir};

/// What to measure.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Runs the same problems through ours and through other programs that solve them, instead of ours alone. Sets up
    /// what it needs below the target folder; what is not there is a line in the table.
    #[arg(long, conflicts_with = "tables")]
    peers: bool,
    /// With `--peers`, only this comparison: planner, families, stn, layout, paths, language or automata. May be given again.
    #[arg(long, requires = "peers")]
    only: Vec<String>,
    /// With `--peers`, fewer and smaller problems, to see that everything runs.
    #[arg(long, requires = "peers")]
    quick: bool,
    /// Measures the page as it is built for development, which is ready sooner.
    #[arg(long)]
    development: bool,
    /// Measures the page as it was last built.
    #[arg(long)]
    no_build: bool,
    /// Only the tables of these crates, or only these tables.
    tables: Vec<String>,
}

/// One benchmark program.
struct Table {
    package: String,
    name: String,
}

/// Runs the tables.
pub(crate) fn run_all(options: &Options) -> Result<()> {
    if options.peers {
        return run_peers(options);
    }
    let tables: Vec<Table> = find_tables(&root().join("crates"))?
        .into_iter()
        .filter(|table| {
            options.tables.is_empty()
                || options.tables.contains(&table.package)
                || options.tables.contains(&table.name)
        })
        .collect();
    if tables.is_empty() {
        bail!("there is no such table");
    }
    for Table { package, name } in tables {
        println!("\n{package}: {name}");
        let mut command = cargo();
        command.args(["bench", "--quiet", "--package", &package, "--bench", &name]);
        command.arg("--");
        command.args(options.development.then_some("--development"));
        command.args(options.no_build.then_some("--no-build"));
        run(&mut command)?;
    }
    Ok(())
}

/// Builds and runs `bench/peers`, a workspace of its own so that no one else has to build the peers.
fn run_peers(options: &Options) -> Result<()> {
    let folder = target_dir().join("peers");
    let mut command = cargo();
    command.args([
        "run",
        "--quiet",
        "--release",
        "--manifest-path",
        "bench/peers/Cargo.toml",
        "--target-dir",
    ]);
    command.arg(&folder).args(["--", "--work"]).arg(&folder);
    for subject in &options.only {
        command.args(["--only", subject]);
    }
    if options.quick {
        command.arg("--quick");
    }
    run(&mut command)
}

/// The programs in the `benches` folders of the crates, in alphabetical order.
fn find_tables(crates: &Path) -> Result<Vec<Table>> {
    let mut tables = Vec::new();
    for package in names_in(crates)? {
        let benches = crates.join(&package).join("benches");
        if !benches.is_dir() {
            continue;
        }
        for file in names_in(&benches)? {
            if let Some(name) = file.strip_suffix(".rs") {
                tables.push(Table { package: package.clone(), name: name.to_owned() });
            }
        }
    }
    Ok(tables)
}

fn names_in(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("reading {}", folder.display()))? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
