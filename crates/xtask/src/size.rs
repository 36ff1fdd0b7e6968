//! `cargo xtask size`: what the page's download consists of, by file and by crate.

use std::fs;

use anyhow::{Context as _, Result};
use xtask::{
    download::{Download, FileSize, LIMITS},
    process::root,
    site,
    wasm_parts::Parts,
};

/// What to look at.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Takes the page that `cargo xtask dist` wrote last, instead of building it.
    #[arg(long)]
    built: bool,
    /// Lists the functions of this crate, and which functions of other crates call them.
    #[arg(long = "crate", value_name = "NAME")]
    of_crate: Option<String>,
}

/// Prints the tables; fails when the download is over the limits.
pub(crate) fn run(options: &Options) -> Result<()> {
    if !options.built {
        crate::pack_release()?;
    }
    let download = Download::of(&root().join("dist"))?;
    for module in site::MODULES {
        let compiled = site::compiled(site::Flavour::Release, module);
        let code = fs::read(&compiled)
            .with_context(|| format!("{} is not there: `cargo xtask dist` builds it", compiled.display()))?;
        let parts = Parts::read(&code).with_context(|| compiled.display().to_string())?;
        if let Some(name) = &options.of_crate {
            print_functions(module, name, &parts);
        } else {
            let name = format!("wasm/{module}_bg.wasm");
            let served =
                download.files.iter().find(|file| file.name == name).context("dist/ has no such module")?;
            print_parts(served, &parts)?;
        }
    }
    if options.of_crate.is_none() {
        print!("{download}");
    }
    download.check(LIMITS)
}

/// What a module consists of.
fn print_parts(served: &FileSize, parts: &Parts) -> Result<()> {
    println!("{}: {} bytes, {} with Brotli", served.name, served.bytes, served.compressed);
    println!("{:>10} {:>10}  code by crate, and data; Brotli is an estimate", "bytes", "brotli");
    for (name, bytes, share) in parts.shares(served.compressed)? {
        println!("{bytes:>10} {share:>10.0}  {name}");
    }
    for (file, bytes) in parts.held_files(&root())? {
        println!("{bytes:>10} in data:    {}", file.display());
    }
    println!();
    Ok(())
}

/// The functions of a crate, and who needs them.
fn print_functions(module: &str, name: &str, parts: &Parts) {
    let functions = parts.functions_of(name);
    let bytes: usize = functions.iter().map(|(function, _)| function.bytes).sum();
    println!("{module}: {} functions of `{name}`, {bytes} bytes", functions.len());
    for (function, callers) in functions {
        println!("{:>10}  {}", function.bytes, function.name);
        for caller in callers {
            println!("{:>14}by {}", "", caller.name);
        }
    }
}
