//! `cargo xtask serve`: builds the page, serves it, and keeps it in step with the sources.

use std::{
    fs, io,
    path::Path,
    thread,
    time::{Duration, SystemTime},
};

use anyhow::Result;
use xtask::{
    process::root,
    server::SiteServer,
    site::{self, Flavour},
};

/// How often the sources are looked at.
const LOOK_EVERY: Duration = Duration::from_millis(700);

/// What the page is made from.
const SOURCES: [&str; 5] = ["Cargo.toml", "assets", "crates", "index.html", "web"];

/// How to serve.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Serves the small, slowly built page that `dist` publishes.
    #[arg(long)]
    release: bool,
    /// The port; the next free one is taken if it is in use.
    #[arg(long, default_value_t = 8080)]
    port: u16,
    /// Builds once, and leaves the page alone when sources change.
    #[arg(long)]
    no_watch: bool,
}

/// Builds and serves until interrupted.
pub(crate) fn run(options: &Options) -> Result<()> {
    let flavour = if options.release { Flavour::Release } else { Flavour::Development };
    let mut built = newest_source();
    let folder = site::build(flavour)?;
    let server = SiteServer::start(&folder, options.port, !options.no_watch)?;
    println!("{}", server.url());
    loop {
        thread::sleep(LOOK_EVERY);
        let newest = newest_source();
        if options.no_watch || newest <= built {
            continue;
        }
        built = newest;
        match site::build(flavour) {
            Ok(_) => server.announce_build(),
            Err(reason) => eprintln!("{reason:#}"),
        }
    }
}

/// When the latest change of any source was made.
fn newest_source() -> SystemTime {
    SOURCES
        .iter()
        .filter_map(|source| newest_under(&root().join(source)).ok())
        .max()
        .unwrap_or(SystemTime::UNIX_EPOCH)
}

fn newest_under(path: &Path) -> io::Result<SystemTime> {
    let data = fs::metadata(path)?;
    let mut newest = data.modified()?;
    if data.is_dir() {
        for entry in fs::read_dir(path)? {
            newest = newest.max(newest_under(&entry?.path())?);
        }
    }
    Ok(newest)
}
