//! The shelf of a native window: a folder with a file for each key.

use std::{fs, io, path::Path};

use workbench::host::{ShelfContent, ShelfNews, ShelfRequest, StorageError};

use super::{file_name, keep, key_of, no_folder};

/// All that lies in the folder, but the content of maps.
pub(super) fn content(folder: Option<&Path>) -> Result<ShelfContent, StorageError> {
    let folder = folder.ok_or_else(no_folder)?;
    let mut content = Vec::new();
    for key in keys_in(folder).into_iter().filter(|key| !key.starts_with("map/")) {
        let bytes = fs::read(folder.join(file_name(&key)));
        content.push((key, bytes.map_err(|reason| unavailable(&reason))?));
    }
    content.sort();
    Ok(content)
}

/// Does what is asked, and says what came of it where that is asked for.
pub(super) fn answer(folder: Option<&Path>, request: ShelfRequest) -> Option<ShelfNews> {
    let file = |key: &str| folder.map(|folder| folder.join(file_name(key))).ok_or_else(no_folder);
    match request {
        ShelfRequest::Write { key, bytes, token } => {
            let outcome = file(&key).and_then(|file| keep(&file, &bytes));
            Some(ShelfNews::Written { key, token, outcome })
        }
        ShelfRequest::Read { key } => {
            let outcome = file(&key).and_then(|file| match fs::read(file) {
                Ok(bytes) => Ok(Some(bytes)),
                Err(reason) if reason.kind() == io::ErrorKind::NotFound => Ok(None),
                Err(reason) => Err(unavailable(&reason)),
            });
            Some(ShelfNews::Read { key, outcome })
        }
        ShelfRequest::Remove { key } => {
            if let Ok(file) = file(&key) {
                // What is not there is removed already.
                let _ = fs::remove_file(file);
            }
            None
        }
    }
}

/// The keys of the files in a folder.
pub(super) fn keys_in(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    let files = files.filter(|entry| entry.path().is_file());
    files.filter_map(|entry| key_of(&entry.file_name().to_string_lossy())).collect()
}

fn unavailable(reason: &io::Error) -> StorageError {
    StorageError::Unavailable { reason: reason.to_string() }
}
