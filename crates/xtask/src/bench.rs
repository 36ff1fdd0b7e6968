//! `cargo xtask bench`: the benchmark tables of all crates, one after the other so that none disturbs another.

use std::{fs, path::Path};

use anyhow::{Context as _, Result, bail};
use xtask::process::{cargo, root, run};

/// What to measure.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Also measures other programs that solve the same problems, where they are installed.
    #[arg(long)]
    peers: bool,
    /// Only the tables of these crates, or only these tables.
    only: Vec<String>,
}

/// One benchmark program.
struct Table {
    package: String,
    name: String,
}

/// Runs the tables.
pub(crate) fn run_all(options: &Options) -> Result<()> {
    let tables: Vec<Table> = find_tables(&root().join("crates"))?
        .into_iter()
        .filter(|table| {
            options.only.is_empty()
                || options.only.contains(&table.package)
                || options.only.contains(&table.name)
        })
        .collect();
    if tables.is_empty() {
        bail!("there is no such table");
    }
    for Table { package, name } in tables {
        println!("\n{package}: {name}");
        let mut command = cargo();
        command.args(["bench", "--quiet", "--package", &package, "--bench", &name]);
        if options.peers {
            command.args(["--", "--peers"]);
        }
        run(&mut command)?;
    }
    Ok(())
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
