//! Files that describe an image which is a file of its own, PDS3 labels and the YAML of ROS maps: which image one names,
//! and both as one file.

use super::pds_label::Label;
use super::{FileFormat, FormatError, ros_map};

/// The name of the file in which the image of a detached label, or of a ROS map, is; `None` if the file is neither.
pub fn image_of_label(label: &[u8]) -> Option<String> {
    if let Some(name) = ros_map::image_name(label) {
        return Some(name);
    }
    if !label.trim_ascii_start().to_ascii_uppercase().starts_with(BEGINNING.trim_ascii_end()) {
        return None;
    }
    let name = Label::parse(label).value("^IMAGE")?.split('"').nth(1)?.trim().to_owned();
    (!name.is_empty()).then_some(name)
}

/// The image with its label before it.
pub fn attach_label(label: &[u8], image: &[u8]) -> Result<Vec<u8>, FormatError> {
    if FileFormat::detect(label) == Some(FileFormat::RosMap) {
        return ros_map::join(label, image);
    }
    // Beyond the file's end there is nothing, however far beyond: then it is too short.
    let start = Label::parse(label).image_start(false)?.min(image.len() as u64);
    let text = String::from_utf8_lossy(label);
    let is_pointer = |line: &&str| {
        line.split_once('=').is_some_and(|(keyword, _)| keyword.trim().eq_ignore_ascii_case("^IMAGE"))
    };
    let lines = text.lines().take_while(|line| line.trim() != "END").filter(|line| !is_pointer(line));
    let lines: Vec<&str> = lines.collect();
    // Behind the first line it stands in no object. The place has as many digits whatever it is, so that it does not move itself.
    let first = lines.iter().position(|line| !line.trim().is_empty()).map_or(0, |first| first + 1);
    let (before, after) = lines.split_at(first);
    let written = |place: u64| {
        format!(
            "{}\r\n^IMAGE = {place:020} <BYTES>\r\n{}\r\nEND\r\n",
            before.join("\r\n"),
            after.join("\r\n")
        )
    };
    let length = written(0).len() as u64;
    let mut whole = written(length + start + 1).into_bytes();
    whole.extend_from_slice(image);
    Ok(whole)
}

const BEGINNING: &[u8] = b"PDS_VERSION_ID";
