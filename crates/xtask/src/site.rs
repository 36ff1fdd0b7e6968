//! Builds the page as a folder of files that any web server can serve.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

use crate::process::{cargo, find_program, root, run, target_dir};

/// The target that pages run.
const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// The wasm modules: the front end, and the planning core for the web worker.
pub const MODULES: [&str; 2] = ["page", "worker"];

/// How the page is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flavour {
    /// Quick to rebuild; what `serve` and the tests use.
    Development,
    /// Small; what is published.
    Release,
}

impl Flavour {
    /// The cargo profile of this flavour.
    pub fn profile(self) -> &'static str {
        match self {
            Self::Development => "wasm-dev",
            Self::Release => "wasm-release",
        }
    }

    /// Returns where the site of this flavour is assembled.
    pub fn folder(self) -> PathBuf {
        target_dir().join("site").join(match self {
            Self::Development => "development",
            Self::Release => "release",
        })
    }
}

/// Compiles both modules, writes their JavaScript sides and assembles the site; returns its folder.
pub fn build(flavour: Flavour) -> Result<PathBuf> {
    require_wasm_target()?;
    run(&mut compile_command(flavour))?;
    assemble(flavour)
}

/// The command that compiles both modules.
pub fn compile_command(flavour: Flavour) -> Command {
    let mut compile = cargo();
    compile.args(["build", "--target", WASM_TARGET, "--profile", flavour.profile()]);
    for module in MODULES {
        compile.args(["--package", module]);
    }
    compile
}

/// A module as cargo built it, with the names of its functions.
pub fn compiled(flavour: Flavour, module: &str) -> PathBuf {
    target_dir().join(WASM_TARGET).join(flavour.profile()).join(format!("{module}.wasm"))
}

/// Puts the compiled modules, their bindings and the files of `web/` together; returns the site's folder.
pub fn assemble(flavour: Flavour) -> Result<PathBuf> {
    let site = flavour.folder();
    for module in MODULES {
        write_bindings(flavour, &compiled(flavour, module), &site.join("wasm"))
            .with_context(|| format!("the bindings of `{module}` could not be written"))?;
    }
    copy_folder(&root().join("web"), &site.join("web"))?;
    copy_if_changed(&root().join("index.html"), &site.join("index.html"))?;
    Ok(site)
}

/// Writes a module and its JavaScript side, unless they are newer than what cargo built. What is published goes without
/// the names of its functions, which are a tenth of what is loaded.
fn write_bindings(flavour: Flavour, module: &Path, folder: &Path) -> Result<()> {
    let name = module.file_stem().and_then(|stem| stem.to_str()).context("a module without a name")?;
    let written = folder.join(format!("{name}_bg.wasm"));
    if is_newer(&written, module) {
        return Ok(());
    }
    let mut bindgen = Bindgen::new();
    bindgen
        .input_path(module)
        .out_name(name)
        .typescript(true)
        .remove_name_section(flavour == Flavour::Release)
        // Without the default path, `init()` without arguments throws.
        .omit_default_module_path(false);
    bindgen.web(true)?;
    bindgen.generate(folder)
}

fn is_newer(made: &Path, source: &Path) -> bool {
    let changed = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    match (changed(made), changed(source)) {
        (Some(made), Some(source)) => made > source,
        _ => false,
    }
}

/// Makes `to` hold exactly the files of `from`.
fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    if to.exists() {
        fs::remove_dir_all(to).with_context(|| format!("clearing {}", to.display()))?;
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| format!("reading {}", from.display()))? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), &target)?;
        }
    }
    Ok(())
}

fn copy_if_changed(from: &Path, to: &Path) -> Result<()> {
    let content = fs::read(from).with_context(|| format!("reading {}", from.display()))?;
    if fs::read(to).is_ok_and(|present| present == content) {
        return Ok(());
    }
    fs::write(to, content).with_context(|| format!("writing {}", to.display()))
}

/// Makes sure that the compiler can build for the page, installing the target where rustup can.
pub fn require_wasm_target() -> Result<()> {
    if has_wasm_target() {
        return Ok(());
    }
    let by_hand = format!("rustup target add {WASM_TARGET}");
    let Some(rustup) = find_program(&["rustup"]) else {
        bail!(
            "this Rust cannot build for {WASM_TARGET}, and there is no rustup to add it with.\n\
             Install rustup from https://rustup.rs and run `{by_hand}`, or install your \
             distribution's package of Rust's standard library for {WASM_TARGET}."
        );
    };
    run(Command::new(rustup).args(["target", "add", WASM_TARGET]))
        .with_context(|| format!("the target could not be added; try `{by_hand}` yourself"))?;
    if !has_wasm_target() {
        bail!(
            "rustup added {WASM_TARGET}, but the Rust in use still lacks it; is a second Rust first in PATH?"
        );
    }
    Ok(())
}

fn has_wasm_target() -> bool {
    Command::new("rustc")
        .args(["--print", "target-libdir", "--target", WASM_TARGET])
        .current_dir(root())
        .output()
        .is_ok_and(|answer| {
            answer.status.success() && Path::new(String::from_utf8_lossy(&answer.stdout).trim()).is_dir()
        })
}
