//! Which brackets belong together.

/// How far to look for the other bracket, in bytes: no block that fits a screen is longer.
const REACH_BYTES: usize = 100_000;

/// The bracket at or before `offset` and its partner, as byte offsets; `None` without a bracket or a partner.
///
/// Brackets in comments do not count.
pub(crate) fn matching(text: &str, offset: usize) -> Option<(usize, usize)> {
    let bytes = text.as_bytes();
    let is_bracket = |at: usize| bytes.get(at).is_some_and(|byte| b"()[]{}".contains(byte));
    let at = [Some(offset), offset.checked_sub(1)].into_iter().flatten().find(|&at| is_bracket(at))?;
    let open_or_close = *bytes.get(at)?;
    let (partner, forwards) = match open_or_close {
        b'(' => (b')', true),
        b'[' => (b']', true),
        b'{' => (b'}', true),
        b')' => (b'(', false),
        b']' => (b'[', false),
        _ => (b'{', false),
    };
    let mut depth = 0_usize;
    let mut visit = |found: usize| {
        let byte = bytes[found];
        if byte == open_or_close && !is_comment(text, found) {
            depth += 1;
        } else if byte == partner && !is_comment(text, found) {
            depth -= 1;
            return depth == 0;
        }
        false
    };
    let end = (at + REACH_BYTES).min(bytes.len());
    let start = at.saturating_sub(REACH_BYTES);
    let found = if forwards {
        (at..end).find(|&found| visit(found))
    } else {
        (start..=at).rev().find(|&found| visit(found))
    };
    found.map(|found| (at, found))
}

/// Returns whether `offset` is behind a line comment's start in its line.
fn is_comment(text: &str, offset: usize) -> bool {
    let line_start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    text[line_start..offset].contains("//")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bracket_finds_its_partner_from_either_side() {
        let text = "A()[l,u] = { choose { B() } }";
        assert_eq!(matching(text, 11), Some((11, 28)));
        assert_eq!(matching(text, 29), Some((28, 11)));
        assert_eq!(matching(text, 3), Some((3, 7)));
    }

    #[test]
    fn brackets_in_comments_and_lone_brackets_have_no_partner() {
        assert_eq!(matching("{ // }\n", 0), None);
        assert_eq!(matching("a ) b", 2), None);
        assert_eq!(matching("abc", 1), None);
    }
}
