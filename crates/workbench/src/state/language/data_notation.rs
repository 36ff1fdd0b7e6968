//! The colors of JSON and EDN, the notations in which other tools write networks.

use rmpl::Span;

use super::SyntaxRole;

/// Returns what the pieces of a line or more are, in textual order. `range` may begin anywhere: a string never
/// continues over the end of a line, and what `range` cuts is read from the beginning of its line.
pub(super) fn roles(text: &str, range: Span) -> Vec<(Span, SyntaxRole)> {
    let bytes = text.as_bytes();
    let end = (range.end as usize).min(bytes.len());
    // Lines may be as long as the file; then what stands far before is not looked at.
    let furthest = text.floor_char_boundary((range.start as usize).saturating_sub(MAX_LOOKBACK_BYTES));
    let line = text.get(furthest..range.start as usize).and_then(|before| before.rfind('\n'));
    let mut at = line.map_or(furthest, |line| furthest + line + 1);
    let mut found = Vec::new();
    while at < end {
        let start = at;
        let role = match bytes[at] {
            b'"' => {
                at = end_of_string(bytes, at);
                let rest = text[at..].trim_start_matches([' ', '\t', '\r', '\n']);
                if rest.starts_with(':') { SyntaxRole::Variable } else { SyntaxRole::String }
            }
            b';' => {
                at = text[at..].find('\n').map_or(bytes.len(), |length| at + length);
                SyntaxRole::Comment
            }
            b'{' | b'}' | b'[' | b']' | b'(' | b')' | b',' => {
                at += 1;
                SyntaxRole::Punctuation
            }
            b':' if !bytes.get(at + 1).is_some_and(|next| is_of_word(*next)) => {
                at += 1;
                SyntaxRole::Punctuation
            }
            first if is_of_word(first) => {
                at += bytes[at..].iter().take_while(|byte| is_of_word(**byte)).count();
                match (first, &text[start..at]) {
                    (b':', _) => SyntaxRole::Variable,
                    (_, "true" | "false" | "null" | "nil") => SyntaxRole::Keyword,
                    (b'-' | b'0'..=b'9', _) => SyntaxRole::Number,
                    _ => SyntaxRole::Value,
                }
            }
            _ => {
                at += 1;
                continue;
            }
        };
        if at > range.start as usize {
            found.push((Span::new(start as u32, at as u32), role));
        }
    }
    found
}

/// How far before a place its line's beginning is looked for.
const MAX_LOOKBACK_BYTES: usize = 20_000;

/// Behind the closing quote, or the end of the line where there is none.
fn end_of_string(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => return at + 1,
            b'\n' => return at,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

const fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric()
        || byte >= 0x80
        || matches!(byte, b':' | b'-' | b'+' | b'.' | b'_' | b'/' | b'*' | b'?' | b'!')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str, from: usize) -> Vec<(&str, SyntaxRole)> {
        let range = Span::new(from as u32, text.len() as u32);
        roles(text, range).into_iter().map(|(span, role)| (&text[span.range()], role)).collect()
    }

    #[test]
    fn keys_texts_and_numbers_of_both_notations_have_colors_of_their_own() {
        use SyntaxRole::{Comment, Keyword, Number, Punctuation, String, Value, Variable};
        assert_eq!(
            told(r#"{"uid": "a\"b", "value": [1.5e3, null]}"#, 0),
            [
                ("{", Punctuation),
                ("\"uid\"", Variable),
                (":", Punctuation),
                (r#""a\"b""#, String),
                (",", Punctuation),
                ("\"value\"", Variable),
                (":", Punctuation),
                ("[", Punctuation),
                ("1.5e3", Number),
                (",", Punctuation),
                ("null", Keyword),
                ("]", Punctuation),
                ("}", Punctuation)
            ]
        );
        assert_eq!(
            told("; made by hand\n{:uid act-1 :cost -2 }", 0),
            [
                ("; made by hand", Comment),
                ("{", Punctuation),
                (":uid", Variable),
                ("act-1", Value),
                (":cost", Variable),
                ("-2", Number),
                ("}", Punctuation)
            ]
        );
    }

    #[test]
    fn any_text_and_any_place_in_it_has_an_answer() {
        for text in ["\"", "\"\\", "{\"é\": \"∞\n:", ":::", "\\\"\u{feff}"] {
            for from in (0..=text.len()).filter(|&at| text.is_char_boundary(at)) {
                let found = told(text, from);
                assert!(found.iter().all(|(piece, _)| !piece.is_empty()), "{text:?}");
            }
        }
    }
}
