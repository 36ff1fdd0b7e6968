//! Finding and replacing in the text, by plain text or regular expression.

use regex::{Regex, RegexBuilder};
use rmpl::{Edit, Span};

/// What the find bar looks for, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Find {
    /// What is looked for.
    pub query: String,
    /// What replaces it.
    pub replacement: String,
    /// Whether the replacement row is open.
    pub replacing: bool,
    /// Whether the query is a regular expression.
    pub is_regex: bool,
    /// Whether upper and lower case differ.
    pub case_sensitive: bool,
    /// Whether only whole words match.
    pub whole_words: bool,
    /// Whether the query field is to take the focus.
    pub wants_focus: bool,
}

/// What the find bar looks for, ready to search.
#[derive(Clone, Debug)]
pub struct Pattern {
    regex: Regex,
    is_regex: bool,
}

impl Find {
    /// The pattern; `Err` says what is wrong with it, for the person who typed it. An empty query has none.
    pub fn pattern(&self) -> Result<Pattern, String> {
        if self.query.is_empty() {
            return Err(String::new());
        }
        let query = if self.is_regex { self.query.clone() } else { regex::escape(&self.query) };
        let query = if self.whole_words { format!(r"\b(?:{query})\b") } else { query };
        let regex = RegexBuilder::new(&query)
            .case_insensitive(!self.case_sensitive)
            .multi_line(true)
            .size_limit(1 << 20)
            .build()
            .map_err(|error| last_line(&error.to_string()))?;
        Ok(Pattern { regex, is_regex: self.is_regex })
    }
}

impl Pattern {
    /// All matches that are not empty, in textual order.
    pub fn matches<'a>(&'a self, text: &'a str) -> impl Iterator<Item = std::ops::Range<usize>> + 'a {
        self.regex.find_iter(text).map(|found| found.range()).filter(|range| !range.is_empty())
    }

    /// The first match at or after `offset`; after the last one it starts over.
    pub fn find_after(&self, text: &str, offset: usize) -> Option<std::ops::Range<usize>> {
        let behind = self.matches(text).find(|range| range.start >= offset);
        behind.or_else(|| self.matches(text).next())
    }

    /// The last match before `offset`; before the first one it starts over.
    pub fn find_before(&self, text: &str, offset: usize) -> Option<std::ops::Range<usize>> {
        let before = self.matches(text).take_while(|range| range.end <= offset).last();
        before.or_else(|| self.matches(text).last())
    }

    /// Returns what the match on exactly `range` becomes; `None` if there is no match there.
    pub fn replacement(
        &self,
        text: &str,
        range: std::ops::Range<usize>,
        replacement: &str,
    ) -> Option<String> {
        let captures = self.regex.captures_at(text, range.start)?;
        (captures.get(0)?.range() == range).then(|| self.expand(&captures, replacement))
    }

    /// The edits that replace every match.
    pub fn replacements(&self, text: &str, replacement: &str) -> Vec<Edit> {
        self.regex
            .captures_iter(text)
            .filter_map(|captures| {
                let range = captures.get(0)?.range();
                let span = Span::new(range.start as u32, range.end as u32);
                (!range.is_empty()).then(|| Edit { span, text: self.expand(&captures, replacement) })
            })
            .collect()
    }

    /// Regular expressions may refer to their groups by `$1` and `${name}`.
    fn expand(&self, captures: &regex::Captures<'_>, replacement: &str) -> String {
        let mut text = String::new();
        if self.is_regex {
            captures.expand(replacement, &mut text);
        } else {
            text.push_str(replacement);
        }
        text
    }
}

fn last_line(message: &str) -> String {
    let line = message.lines().last().unwrap_or(message);
    line.trim().trim_start_matches("error: ").to_owned()
}
