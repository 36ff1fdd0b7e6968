//! Reading the files that commands are given; `-` is standard input.

use std::collections::BTreeSet;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use anyhow::Context as _;
use same_file::Handle;

/// The files that were read, so that none of them is written over.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Returns whether a file was read, by this name or another one: links lead to the same file.
pub fn was_read(path: &Path) -> bool {
    // Opening a pipe waits for its other end, so only plain files are opened.
    let handle = |path: &Path| if path.is_file() { Handle::from_path(path).ok() } else { None };
    let Some(file) = handle(path) else { return false };
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    let mut read = read.iter().map(|read| if is_stdin(read) { Handle::stdin().ok() } else { handle(read) });
    read.any(|read| read.as_ref() == Some(&file))
}

fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// No program text is this long; a larger file is a mistake, and is refused before it is read.
const LONGEST_TEXT_BYTES: u64 = 64 << 20;

/// The text of `path`, which must be UTF-8.
pub fn read_text(path: &Path) -> anyhow::Result<String> {
    let bytes = read_bytes(path, LONGEST_TEXT_BYTES)?;
    // What editors of another system put before a text says nothing.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).map(<[u8]>::to_vec).unwrap_or(bytes);
    String::from_utf8(bytes).map_err(|error| {
        anyhow::anyhow!(
            "{} is not UTF-8 text: the first bad byte is at offset {}",
            path.display(),
            error.utf8_error().valid_up_to()
        )
    })
}

/// The text of the mission in `path`, which has been read, joined with the texts of the files that it imports. They must be in
/// the folder of `path` or below it. A file elsewhere is not imported, even if a symbolic link leads to it.
pub fn mission_of(path: &Path, text: &str) -> anyhow::Result<String> {
    let Some(name) = path.file_name().and_then(|name| name.to_str()).filter(|name| *name != "-") else {
        return Ok(rmpl::files::join("", text, |_| None));
    };
    let folder = folder_of(path);
    let mut problem = None;
    let joined = rmpl::files::join(name, text, |file| match read_import(&inside(folder, file)?) {
        Ok(text) => Some(text),
        Err(error) => {
            problem.get_or_insert(error);
            None
        }
    });
    if rmpl::files::Files::of(&joined).all().len() > MAX_IMPORTS {
        let imports = rmpl::parse(&joined).program().imports;
        let names: BTreeSet<&str> = imports.iter().map(|import| import.file.as_str()).collect();
        anyhow::ensure!(
            names.len() <= MAX_IMPORTS,
            "{} imports {} files; a mission has at most {MAX_IMPORTS}",
            path.display(),
            names.len()
        );
    }
    problem.map_or(Ok(joined), Err)
}

/// As many imported files are joined to a mission; the front end would call the next ones missing.
const MAX_IMPORTS: usize = 1_000;

fn read_import(path: &Path) -> anyhow::Result<String> {
    // A pipe may have nothing to say for ever.
    anyhow::ensure!(path.is_file(), "cannot import {}: it is not a regular file", path.display());
    read_text(path)
}

/// The text of a control program or a plant model in `path`; `instead` says what a mission is for.
pub fn read_control(path: &Path, instead: &str) -> anyhow::Result<String> {
    let text = read_text(path)?;
    if !rmpl::control::is_control_text(&text) {
        let program = rmpl::parse(&text).program();
        let is_mission = !(program.scenarios.is_empty() && program.activities.is_empty());
        anyhow::ensure!(!is_mission, "{} is a mission; {instead}", path.display());
    }
    Ok(text)
}

/// The folder of a mission's first file.
pub fn folder_of(mission: &Path) -> &Path {
    mission.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path of `file`, if it is in `folder` or in a folder in there: links that lead out, `..` and paths from the root do
/// not.
pub fn inside(folder: &Path, file: &str) -> Option<PathBuf> {
    let found = folder.join(file).canonicalize().ok()?;
    found.starts_with(folder.canonicalize().ok()?).then_some(found)
}

/// The bytes of `path`, refused when there are more than `most`.
pub fn read_bytes(path: &Path, most: u64) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    READ.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
    if is_stdin(path) {
        std::io::stdin().take(most + 1).read_to_end(&mut bytes).context("cannot read standard input")?;
    } else {
        std::fs::File::open(path)
            .and_then(|file| file.take(most + 1).read_to_end(&mut bytes))
            .with_context(|| format!("cannot read {}", path.display()))?;
    }
    anyhow::ensure!(bytes.len() as u64 <= most, "{} is larger than {} MiB", path.display(), most >> 20);
    Ok(bytes)
}

/// A JSON document read from `path`.
pub fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> anyhow::Result<T> {
    let text = read_text(path)?;
    serde_json::from_str(&text).with_context(|| format!("{}: invalid JSON", path.display()))
}
