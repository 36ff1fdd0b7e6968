//! How large a text or a file may be. What is larger is refused with words before anything is done with it.

/// The longest text of a mission, with all its files, in bytes.
pub const MAX_TEXT_BYTES: usize = 4 << 20;

/// The largest map, or mission with its maps in one file, in bytes.
pub const MAX_FILE_BYTES: usize = 256 << 20;

/// Returns why something of so many bytes is not taken where `most` are; nothing if it is.
pub fn too_large(bytes: usize, most: usize) -> Option<String> {
    let megabytes = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    (bytes > most).then(|| {
        format!("the size is {:.1} MB, and the limit is {:.0} MB", megabytes(bytes), megabytes(most))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_is_told_with_both_sizes() {
        assert_eq!(too_large(MAX_TEXT_BYTES, MAX_TEXT_BYTES), None);
        let told = too_large(65 << 20, MAX_TEXT_BYTES);
        assert_eq!(told.as_deref(), Some("the size is 65.0 MB, and the limit is 4 MB"));
    }
}
