//! Brackets and quotes that come in pairs: what closes is written with what opens, typed over, and deleted with it.

use rmpl::{Edit, Span};

use crate::{Caret, Document, EditKind, is_name_character};

const PAIRS: [(&str, &str); 4] = [("(", ")"), ("[", "]"), ("{", "}"), ("\"", "\"")];

/// Types `text` at the caret if that concerns a pair. Returns whether it did.
pub(crate) fn insert(document: &mut Document, text: &str) -> bool {
    if type_over(document, text) {
        return true;
    }
    let Some(&(open, close)) = PAIRS.iter().find(|(open, _)| *open == text) else { return false };
    let caret = document.caret();
    let range = caret.range();
    if !caret.is_empty() {
        let edits = [(range.start, open), (range.end, close)]
            .map(|(at, text)| Edit { span: Span::new(at as u32, at as u32), text: text.to_owned() });
        let moved = Caret::selecting(caret.anchor + open.len(), caret.head + open.len());
        document.edit(&edits, EditKind::Single, Some(moved));
        return true;
    }
    let (before, after) = document.text().split_at(range.start);
    let has_room = after.chars().next().is_none_or(|c| c.is_whitespace() || ")]},;".contains(c));
    // Behind a name a quote ends a text; within a comment nothing is paired.
    let is_name_before = before.chars().next_back().is_some_and(|c| is_name_character(c) || c == '"');
    let line = &before[before.rfind('\n').map_or(0, |at| at + 1)..];
    if !has_room
        || open == "\"" && is_name_before
        || line.contains("//")
        || is_owed(document, range.start, open, close)
    {
        return false;
    }
    let edit =
        Edit { span: Span::new(range.start as u32, range.start as u32), text: format!("{open}{close}") };
    document.edit(&[edit], EditKind::Typing, Some(Caret::at(range.start + open.len())));
    document.closers.push(range.start + open.len());
    true
}

/// Returns whether what closes is there already, and only what opens is missing: of brackets in the whole text, of
/// quotes in the line.
fn is_owed(document: &Document, at: usize, open: &str, close: &str) -> bool {
    if open == close {
        let line = document.line_text(document.line_at(at));
        return line.matches(open).count() % 2 == 1;
    }
    let text = document.text();
    text.matches(close).count() > text.matches(open).count()
}

/// Goes over what closes if that was written with what opens and only blanks lie between: those of a line that holds
/// nothing else are taken away.
fn type_over(document: &mut Document, text: &str) -> bool {
    let head = document.caret().head;
    if !document.caret().is_empty() || !PAIRS.iter().any(|(_, close)| *close == text) {
        return false;
    }
    let ours = |at: &usize| {
        let between = document.text().get(head..*at);
        between.is_some_and(|it| it.trim().is_empty()) && document.text()[*at..].starts_with(text)
    };
    let Some(closer) = document.closers.iter().copied().filter(ours).min() else { return false };
    document.closers.retain(|&at| at != closer);
    let between = document.text()[head..closer].to_owned();
    let line = document.line_range(document.line_at(head));
    let is_blank_before = document.text()[line.start..head].trim().is_empty();
    match between.rfind('\n') {
        Some(last) if is_blank_before => {
            let end = head + last + 1;
            let edit = Edit { span: Span::new(line.start as u32, end as u32), text: String::new() };
            let caret = Caret::at(closer - (end - line.start) + text.len());
            document.edit(&[edit], EditKind::Single, Some(caret));
        }
        // On a line with something, what closes belongs to the end of the block: it is typed.
        Some(_) => return false,
        None => document.set_caret(Caret::at(closer + text.len())),
    }
    true
}

/// Deletes both sides of an empty pair around the caret. Returns whether there was one.
pub(crate) fn delete_empty(document: &mut Document) -> bool {
    let head = document.caret().head;
    let (before, after) = document.text().split_at(head);
    let is_pair = |(open, close): &(&str, &str)| before.ends_with(open) && after.starts_with(close);
    let is_ours = document.caret().is_empty() && document.closers.contains(&head);
    if !is_ours || !PAIRS.iter().any(is_pair) {
        return false;
    }
    let span = Span::new(head as u32 - 1, head as u32 + 1);
    document.edit(&[Edit { span, text: String::new() }], EditKind::Deleting, Some(Caret::at(head - 1)));
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, TextCommand};

    /// Returns what typing leaves, with a bar where the caret is.
    fn typed(start: &str, keys: &str) -> String {
        let mut document = Document::new(&start.replace('|', ""));
        document.set_caret(Caret::at(start.find('|').unwrap_or(start.len())));
        for key in keys.chars() {
            match key {
                '\n' => TextCommand::NewLine.apply(&mut document),
                '<' => TextCommand::Delete(Motion::Left).apply(&mut document),
                key => TextCommand::Insert(key.to_string()).apply(&mut document),
            }
        }
        let mut text = document.text().to_owned();
        text.insert(document.caret().head, '|');
        text
    }

    #[test]
    fn what_opens_is_closed_and_what_closes_is_typed_over() {
        assert_eq!(typed("", "Drive("), "Drive(|)");
        assert_eq!(typed("", "Drive(A)"), "Drive(A)|");
        assert_eq!(typed("", "f([{"), "f([{|}])");
        assert_eq!(typed("", "f([1,2])"), "f([1,2])|");
        assert_eq!(typed("terrain ", "\"tai\""), "terrain \"tai\"|");
    }

    #[test]
    fn nothing_is_closed_where_text_follows_or_in_a_comment() {
        assert_eq!(typed("|Drive", "("), "(|Drive");
        assert_eq!(typed("// see ", "("), "// see (|");
        assert_eq!(typed("a", "\""), "a\"|");
        assert_eq!(typed("(|)", ")"), "()|)", "only what was written with it is typed over");
    }

    #[test]
    fn what_opens_is_typed_alone_where_what_closes_waits_for_it() {
        assert_eq!(typed("choose {|\n  A()\n}", "<{"), "choose {|\n  A()\n}");
        assert_eq!(typed("f(a|)", "<<(a"), "f(a|)");
        assert_eq!(typed("terrain |tai\"", "\""), "terrain \"|tai\"");
    }

    #[test]
    fn an_empty_pair_is_deleted_as_a_whole() {
        assert_eq!(typed("", "Drive(<"), "Drive|");
        assert_eq!(typed("", "Drive(A<<"), "Drive|");
        assert_eq!(typed("(|)", "<"), "|)", "one that was there before is not");
    }

    #[test]
    fn a_block_typed_as_ever_comes_out_as_typed() {
        assert_eq!(typed("", "S = {\nA();\nB()\n}"), "S = {\n  A();\n  B()\n}|");
        assert_eq!(typed("", "{\n{\nA()\n}\n}"), "{\n  {\n    A()\n  }\n}|");
    }

    #[test]
    fn a_selection_is_surrounded_and_stays_selected() {
        let mut document = Document::new("A(); B()");
        document.set_caret(Caret::selecting(0, 8));
        for key in ["{", "("] {
            TextCommand::Insert(key.to_owned()).apply(&mut document);
        }
        assert_eq!(document.text(), "{(A(); B())}");
        assert_eq!(document.selected_text(), "A(); B()");
    }
}
