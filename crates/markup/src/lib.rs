//! Texts inside documents of other notations, so that each represents itself: in XML, HTML and SVG, and in Graphviz.
//!
//! Not a library's: those that escape XML (`quick-xml`, `html-escape`, `askama_escape`) leave control characters, which no
//! document may have, not even escaped.

/// A text in the content of an element and in quoted attributes. What XML cannot have becomes a space.
///
/// ```
/// assert_eq!(markup::escaped("A < \"B\"\u{1}"), "A &lt; &quot;B&quot; ");
/// ```
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(character),
            _ if character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            _ => out.push(character),
        }
    }
    out
}

/// Returns whether a character only sets the direction of others: text with such marks can show other numbers than it
/// has.
pub const fn sets_direction(letter: char) -> bool {
    matches!(letter,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    )
}

/// A text as a string of Graphviz, with its quotes.
///
/// ```
/// assert_eq!(markup::graphviz_string("a \"b\""), r#""a \"b\"""#);
/// ```
pub fn graphviz_string(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_is_read_again_or_is_a_space() {
        let rare = ['\u{2028}', '\u{d7ff}', '\u{e000}', '\u{fffd}', '\u{fffe}', '\u{ffff}', '🛰'];
        for character in ('\0'..='\u{2ff}').chain(rare) {
            let text = format!("a{character}b");
            let document = format!("<t a=\"{0}\" b='{0}'>{0}</t>", escaped(&text));
            let read = roxmltree::Document::parse(&document);
            let read = read.unwrap_or_else(|error| panic!("{character:?}: {error}"));
            let is_allowed = character == '\n'
                || character == '\t'
                || !(character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}'));
            let content = if is_allowed { text.as_str() } else { "a b" };
            assert_eq!(read.root_element().text(), Some(content), "{character:?}");
            // In attributes, white space is a space by the rules of XML.
            let value = if character.is_whitespace() && character.is_ascii() { "a b" } else { content };
            for name in ["a", "b"] {
                assert_eq!(read.root_element().attribute(name), Some(value), "{character:?}");
            }
        }
    }

    #[test]
    fn a_string_of_graphviz_ends_where_its_text_does() {
        assert_eq!(graphviz_string("not(A)\\\"\nB"), r#""not(A)\\\"\nB""#);
    }
}
