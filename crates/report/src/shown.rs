//! Text as a report shows it: what people read there is what the mission says.

use markup::escaped;

/// Text for HTML, with a sign for each mark that changes the direction of what follows. With such marks a comment could show
/// other numbers than the planner reads.
pub(crate) fn shown(text: &str) -> String {
    if text.is_ascii() {
        return escaped(text);
    }
    let seen: String =
        text.chars().map(|letter| if markup::sets_direction(letter) { '\u{fffd}' } else { letter }).collect();
    escaped(&seen)
}

/// A sentence for HTML: what is between two backticks is code.
pub(crate) fn sentence(text: &str) -> String {
    let shown = shown(text);
    let parts: Vec<&str> = shown.split('`').collect();
    // A backtick without a second one is as it is written.
    if parts.len().is_multiple_of(2) {
        return shown;
    }
    let part = |(at, part): (usize, &&str)| match at % 2 {
        0 => (*part).to_owned(),
        _ => format!("<code>{part}</code>"),
    };
    parts.iter().enumerate().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_in_a_sentence_is_marked() {
        for (text, html) in [
            ("the bounds of `Drive`", "the bounds of <code>Drive</code>"),
            ("`a < b` and `c`", "<code>a &lt; b</code> and <code>c</code>"),
            ("one ` alone", "one ` alone"),
            ("none", "none"),
        ] {
            assert_eq!(sentence(text), html);
        }
    }

    #[test]
    fn marks_of_direction_are_shown_and_letters_of_any_script_are_as_they_are() {
        for mark in ["\u{202e}", "\u{2067}", "\u{200f}"] {
            assert_eq!(shown(&format!("[0,{mark}02]<")), "[0,\u{fffd}02]&lt;");
        }
        for plain in ["Ада", "עברית", "👨\u{200d}👩", "ä"] {
            assert_eq!(shown(plain), plain);
        }
    }
}
