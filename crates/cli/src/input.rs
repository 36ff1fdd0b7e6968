//! Reading the files that commands are given; `-` is standard input.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

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
    let joined = rmpl::files::join(name, text, |file| match read_text(&inside(folder, file)?) {
        Ok(text) => Some(text),
        Err(error) => {
            problem.get_or_insert(error);
            None
        }
    });
    problem.map_or(Ok(joined), Err)
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
    if path == Path::new("-") {
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
    serde_json::from_str(&text)
        .with_context(|| format!("{} is not the JSON that was expected", path.display()))
}
