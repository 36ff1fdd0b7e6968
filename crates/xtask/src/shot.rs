//! `cargo xtask shot`: a picture of the built page, as a user would see it.

use std::{fs, path::PathBuf};

use anyhow::{Context as _, Result, anyhow};
use xtask::{
    browser::{Browser, Graphics},
    server::SiteServer,
    site::{self, Flavour},
};

/// What to take a picture of.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// The size of the page in pixels.
    #[arg(long, default_value = "1280x800", value_parser = parse_size)]
    size: (u32, u32),
    /// The PNG file to write.
    #[arg(long)]
    out: PathBuf,
    /// What is after `#` in the address, such as `mission=enroute`.
    #[arg(long, default_value = "")]
    hash: String,
    /// Files to drop on the page before the scripts run, such as maps.
    #[arg(long)]
    drop: Vec<PathBuf>,
    /// JavaScript to run before the picture is taken, in order; promises are awaited, values are printed.
    #[arg(long)]
    eval: Vec<String>,
    /// JavaScript conditions to wait for after those, such as `enroute.state().plan`.
    #[arg(long)]
    until: Vec<String>,
    /// Points to click before the picture is taken, in order, after the scripts and conditions.
    #[arg(long, value_parser = parse_point)]
    click: Vec<(f64, f64)>,
    /// Draws with WebGPU instead of WebGL2.
    #[arg(long)]
    webgpu: bool,
    /// Takes the page as it was last built.
    #[arg(long)]
    no_build: bool,
    /// The release build.
    #[arg(long)]
    release: bool,
}

/// Builds, opens the page, does what was asked and writes the picture.
pub(crate) fn run(options: &Options) -> Result<()> {
    let flavour = if options.release { Flavour::Release } else { Flavour::Development };
    let folder = if options.no_build { flavour.folder() } else { site::build(flavour)? };
    let server = SiteServer::start(&folder, 0, false)?;
    let browser = Browser::start(if options.webgpu { Graphics::WebGpu } else { Graphics::WebGl2 }, 1.0)?;
    let (width, height) = options.size;
    let tab = browser.open_context()?.open_tab(width, height)?;
    tab.go_to(&format!("{}#{}", server.url(), options.hash.trim_start_matches('#')))?;
    tab.wait_until_ready()?;
    for file in &options.drop {
        let bytes = fs::read(file).with_context(|| format!("reading {}", file.display()))?;
        tab.drop_file(&file.file_name().unwrap_or_default().to_string_lossy(), &bytes)?;
    }
    for script in &options.eval {
        println!("{}", tab.evaluate(script)?);
    }
    for condition in &options.until {
        tab.wait_until(condition)?;
    }
    for &(x, y) in &options.click {
        tab.click(x, y)?;
    }
    tab.next_frame()?;
    fs::write(&options.out, tab.screenshot_png()?)
        .with_context(|| format!("writing {}", options.out.display()))?;
    for message in tab.messages() {
        eprintln!("page: {message}");
    }
    Ok(())
}

fn parse_size(text: &str) -> Result<(u32, u32)> {
    let (width, height) = split_pair(text, 'x')?;
    Ok((width.parse()?, height.parse()?))
}

fn parse_point(text: &str) -> Result<(f64, f64)> {
    let (x, y) = split_pair(text, ',')?;
    Ok((x.parse()?, y.parse()?))
}

fn split_pair(text: &str, between: char) -> Result<(&str, &str)> {
    text.split_once(between).ok_or_else(|| anyhow!("two numbers with `{between}` between them, not `{text}`"))
}
