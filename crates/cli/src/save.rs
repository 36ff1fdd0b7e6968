//! Writing files: a file keeps its old text until the new one is complete, and no file that was read is written over.

use std::fs::{File, Metadata, OpenOptions};
use std::io::Write as _;
use std::path::Path;

use anyhow::{Context as _, ensure};

use crate::input::was_read;

/// Writes an output.
pub fn save(path: &Path, text: &str) -> anyhow::Result<()> {
    refuse_input(path)?;
    replace(path, text)
}

/// Fails if an output is a file that was read, under whatever name. Commands ask before they plan, too.
pub fn refuse_input(path: &Path) -> anyhow::Result<()> {
    let path_name = path.display();
    ensure!(!was_read(path), "{path_name} is an input of this call; choose another file for the output");
    Ok(())
}

/// Replaces a file, or makes it: the text goes to a new file in the same folder, which takes the place of the old one once
/// it is on the disk.
pub fn replace(path: &Path, text: &str) -> anyhow::Result<()> {
    // A link stays a link: what it leads to is replaced.
    let file = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let before = file.metadata().ok();
    let written = match &before {
        // A device or a pipe keeps nothing that could be lost.
        Some(before) if !before.is_file() => std::fs::write(&file, text),
        _ => replace_file(&file, before.as_ref(), text),
    };
    written.with_context(|| format!("cannot write {}", path.display()))
}

fn replace_file(file: &Path, before: Option<&Metadata>, text: &str) -> std::io::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if before.is_some() {
        // What may not be written may not be replaced, either.
        OpenOptions::new().write(true).open(file)?;
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".enroute-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut new = builder.tempfile_in(folder)?;
    new.write_all(text.as_bytes())?;
    if let Some(before) = before {
        new.as_file().set_permissions(before.permissions())?;
    }
    new.as_file().sync_all()?;
    new.persist(file)?;
    // The new name is on the disk once the folder is. Some file systems cannot do that, and need not.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}
