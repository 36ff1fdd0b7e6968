//! The program text, line by line and highlighted; every line can be led to.

use crate::shown::shown;
use rmpl::Span;
use rmpl::editor::{Highlight, HighlightKind, highlight};

/// The text as a table-free listing: one element per line, `id="line-1"` and so on.
pub(crate) fn listing(source: &str) -> String {
    let parse = rmpl::parse(source);
    let highlights = highlight(&parse, Span::new(0, source.len() as u32));
    let mut out = String::from("<pre class=\"listing\"><code>");
    let mut start = 0;
    for (index, line) in source.split_inclusive('\n').enumerate() {
        let number = index + 1;
        let end = start + line.trim_end_matches(['\r', '\n']).len();
        out.push_str(&format!("<span class=\"line\" id=\"line-{number}\"><b>{number}</b>"));
        write_line(source, start, end, &highlights, &mut out);
        // Inside the line, which is a block: after it, it would be an empty line of its own.
        out.push_str("\n</span>");
        start += line.len();
    }
    out.push_str("</code></pre>\n");
    out
}

fn write_line(source: &str, start: usize, end: usize, highlights: &[Highlight], out: &mut String) {
    let mut at = start;
    let first = highlights.partition_point(|piece| piece.span.end as usize <= start);
    for piece in &highlights[first..] {
        // A comment may reach over several lines: each shows its part.
        let from = (piece.span.start as usize).max(at);
        let until = (piece.span.end as usize).min(end);
        if piece.span.start as usize >= end {
            break;
        }
        let (Some(between), Some(text)) = (source.get(at..from), source.get(from..until)) else { continue };
        out.push_str(&shown(between));
        match class(piece.kind) {
            Some(class) => out.push_str(&format!("<i class=\"{class}\">{}</i>", shown(text))),
            None => out.push_str(&shown(text)),
        }
        at = until;
    }
    out.push_str(&shown(source.get(at..end).unwrap_or("")));
}

const fn class(kind: HighlightKind) -> Option<&'static str> {
    match kind {
        HighlightKind::Comment => Some("comment"),
        HighlightKind::Keyword => Some("keyword"),
        HighlightKind::Activity | HighlightKind::Scenario => Some("activity"),
        HighlightKind::Variable | HighlightKind::Value => Some("condition"),
        HighlightKind::Parameter | HighlightKind::BoundName => Some("parameter"),
        HighlightKind::Location | HighlightKind::Vehicle => Some("place"),
        HighlightKind::Number => Some("number"),
        HighlightKind::String => Some("string"),
        HighlightKind::Unknown => Some("unknown"),
        HighlightKind::Option
        | HighlightKind::Symbol
        | HighlightKind::Operator
        | HighlightKind::Punctuation => None,
    }
}
