//! PDS3 labels in files of their own: which image one describes, and both as one file, as if the label had been written
//! before its image.

use super::FormatError;
use super::pds::Label;

/// The name of the file in which the image of a detached label is; `None` if the file is none.
pub fn image_of_label(label: &[u8]) -> Option<String> {
    if !label.trim_ascii_start().to_ascii_uppercase().starts_with(BEGINNING.trim_ascii_end()) {
        return None;
    }
    let name = Label::parse(label).value("^IMAGE")?.split('"').nth(1)?.trim().to_owned();
    (!name.is_empty()).then_some(name)
}

/// The image with its label before it.
pub fn attach_label(label: &[u8], image: &[u8]) -> Result<Vec<u8>, FormatError> {
    let start = Label::parse(label).image_start(false)?;
    let text = String::from_utf8_lossy(label);
    let is_pointer = |line: &&str| {
        line.split_once('=').is_some_and(|(keyword, _)| keyword.trim().eq_ignore_ascii_case("^IMAGE"))
    };
    let lines = text.lines().take_while(|line| line.trim() != "END").filter(|line| !is_pointer(line));
    let lines: Vec<&str> = lines.collect();
    // The place has as many digits whatever it is, so that it does not move itself.
    let written = |place: u64| format!("{}\r\n^IMAGE = {place:020} <BYTES>\r\nEND\r\n", lines.join("\r\n"));
    let length = written(0).len() as u64;
    let mut whole = written(length + start + 1).into_bytes();
    whole.extend_from_slice(image);
    Ok(whole)
}

const BEGINNING: &[u8] = b"PDS_VERSION_ID";
