//! The map file beside a mission.

use std::path::Path;

use anyhow::Context as _;
use rmpl::program::World;
use terrain::format::{FileFormat, attach_label, image_of_label};

use crate::input::{folder_of, inside, read_bytes};

/// A larger map file is refused before it is read.
pub const LARGEST_MAP_BYTES: u64 = 512 << 20;

/// Labels are short texts.
const LARGEST_LABEL_BYTES: u64 = 1 << 20;

/// The name and the bytes of the map file that a mission names, if there is such a file beside the mission's.
pub fn map_file(mission: &Path, world: &World) -> anyhow::Result<Option<(String, Vec<u8>)>> {
    let Some(declared) = &world.terrain else { return Ok(None) };
    let name = declared.asset.as_str();
    if terrain::asset_names().any(|known| known == name) {
        return Ok(None);
    }
    // What is elsewhere is not a map of the mission, whatever it is.
    let found = inside(folder_of(mission), name);
    let Some(file) = found.filter(|file| file.is_file()) else { return Ok(None) };
    let bytes = read_bytes(&file, LARGEST_MAP_BYTES).with_context(|| cannot_read(name))?;
    let bytes = with_label(folder_of(mission), &file, bytes).with_context(|| cannot_read(name))?;
    Ok(Some((name.to_owned(), bytes)))
}

/// The bytes of a map file with those of the file that belongs to it: a raw image with the PDS3 label beside it, if
/// there is one, and the description of a ROS map with its image, which is refused outside of `folder`.
pub fn with_label(folder: &Path, map: &Path, bytes: Vec<u8>) -> anyhow::Result<Vec<u8>> {
    match FileFormat::detect(&bytes) {
        Some(FileFormat::RosMap) => with_image(folder, map, bytes),
        Some(_) => Ok(bytes),
        None => with_pds_label(map, bytes),
    }
}

fn with_image(folder: &Path, description: &Path, bytes: Vec<u8>) -> anyhow::Result<Vec<u8>> {
    let Some(name) = image_of_label(&bytes) else { return Ok(bytes) };
    // The image lies where the description is, and `inside` takes what is relative from the mission's folder on.
    let beside = folder_of(description).canonicalize().map(|folder| folder.join(&name)).ok();
    let beside = beside.as_deref().and_then(Path::to_str).and_then(|path| inside(folder, path));
    let image = beside.filter(|file| file.is_file());
    let image = image.with_context(|| format!("its image {name} is not in the folder"))?;
    Ok(attach_label(&bytes, &read_bytes(&image, LARGEST_MAP_BYTES)?)?)
}

fn with_pds_label(image: &Path, bytes: Vec<u8>) -> anyhow::Result<Vec<u8>> {
    for extension in ["lbl", "LBL"] {
        let beside = image.with_extension(extension);
        if !beside.is_file() {
            continue;
        }
        let label = read_bytes(&beside, LARGEST_LABEL_BYTES)?;
        let of_it = |name: &std::ffi::OsStr| {
            image_of_label(&label).is_some_and(|named| name.eq_ignore_ascii_case(named.as_str()))
        };
        if image.file_name().is_some_and(of_it) {
            return Ok(attach_label(&label, &bytes)?);
        }
    }
    Ok(bytes)
}

/// That a terrain is of no use, as the start of a sentence.
pub fn cannot_read(name: &str) -> String {
    format!("couldn't use the terrain \"{name}\"")
}
