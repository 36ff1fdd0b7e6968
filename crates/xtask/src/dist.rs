//! Packs the page as files for any web server, small, and working offline once loaded.

use std::{
    fs,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    io::Write as _,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use brotli::enc::BrotliEncoderParams;
use flate2::{Compression, write::GzEncoder};

/// Kinds of files that are worth compressing.
const COMPRESSED: [&str; 8] = ["css", "html", "js", "json", "svg", "ts", "wasm", "webmanifest"];

/// The line of the service worker that names the files, and what `index.html` begins with.
const FILES_LINE: &str = "const FILES = [];";
const VERSION_LINE: &str = "const VERSION = \"development\";";
const PAGE_BEGINS: &str = "<html lang=\"en\"";

/// Makes `dist` hold a built site, with a service worker that keeps a copy of it in the browser.
pub fn pack(site: &Path, dist: &Path) -> Result<()> {
    if dist.exists() {
        fs::remove_dir_all(dist).with_context(|| format!("clearing {}", dist.display()))?;
    }
    let mut files = Vec::new();
    for name in files_under(site, Path::new(""))? {
        let target = dist.join(&name);
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::copy(site.join(&name), &target)?;
        files.push(name);
    }
    let version = version_of(dist, &files)?;
    mark_version(&dist.join("index.html"), &version)?;
    write_service_worker(dist, &files, &version)
}

/// All files of a folder by their paths in it, in alphabetical order.
pub(crate) fn files_under(folder: &Path, inside: &Path) -> Result<Vec<PathBuf>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder.join(inside))? {
        let entry = entry?;
        let name = inside.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            names.extend(files_under(folder, &name)?);
        } else {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// A name for exactly these files.
fn version_of(dist: &Path, files: &[PathBuf]) -> Result<String> {
    let mut hasher = DefaultHasher::new();
    for name in files {
        name.hash(&mut hasher);
        fs::read(dist.join(name))?.hash(&mut hasher);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

/// Makes the page ask for its service worker.
fn mark_version(page: &Path, version: &str) -> Result<()> {
    let text = fs::read_to_string(page)?;
    ensure!(text.contains(PAGE_BEGINS), "index.html no longer contains `{PAGE_BEGINS}`");
    let marked = text.replacen(PAGE_BEGINS, &format!("{PAGE_BEGINS} data-version=\"{version}\""), 1);
    fs::write(page, marked)?;
    Ok(())
}

/// Writes the service worker at the top, since it rules only what lies beside and below it.
fn write_service_worker(dist: &Path, files: &[PathBuf], version: &str) -> Result<()> {
    let nested = dist.join("web/service-worker.js");
    let text = fs::read_to_string(&nested)?;
    for line in [FILES_LINE, VERSION_LINE] {
        ensure!(text.contains(line), "the service worker no longer contains `{line}`");
    }
    let names: Vec<String> = files
        .iter()
        .map(|name| name.to_string_lossy().replace('\\', "/"))
        .filter(|name| !name.ends_with("service-worker.js"))
        .collect();
    let text = text
        .replace(FILES_LINE, &format!("const FILES = {};", serde_json::json!(names)))
        .replace(VERSION_LINE, &format!("const VERSION = \"{version}\";"));
    fs::write(dist.join("service-worker.js"), text)?;
    fs::remove_file(nested)?;
    Ok(())
}

/// Puts `name.br` and `name.gz` beside every file that shrinks by it, for servers that hand them out.
pub fn compress(dist: &Path) -> Result<()> {
    for name in files_under(dist, Path::new(""))? {
        let kind = name.extension().and_then(|kind| kind.to_str()).unwrap_or_default();
        if !COMPRESSED.contains(&kind) {
            continue;
        }
        let file = dist.join(&name);
        let content = fs::read(&file)?;
        for (suffix, smaller) in [("br", brotli(&content, BEST_QUALITY)?), ("gz", gzip(&content)?)] {
            if smaller.len() < content.len() {
                fs::write(dist.join(format!("{}.{suffix}", name.display())), smaller)?;
            }
        }
    }
    Ok(())
}

/// Brotli's best, for what is published.
const BEST_QUALITY: i32 = 11;

/// Compresses as browsers read it, with a quality from 0 to 11.
pub(crate) fn brotli(content: &[u8], quality: i32) -> Result<Vec<u8>> {
    let mut compressed = Vec::new();
    let parameters = BrotliEncoderParams { quality, lgwin: 24, ..BrotliEncoderParams::default() };
    brotli::BrotliCompress(&mut &content[..], &mut compressed, &parameters)?;
    Ok(compressed)
}

fn gzip(content: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(content)?;
    Ok(encoder.finish()?)
}
