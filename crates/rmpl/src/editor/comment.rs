//! Turning lines into comments and back.

use crate::diagnostic::Edit;
use crate::span::Span;

/// The edits that comment out all lines that `range` touches, or, if all of them are comments already, take the
/// comment signs away. Blank lines are left alone. In textual order.
pub fn toggle_comment(text: &str, range: Span) -> Vec<Edit> {
    let lines = lines_of(text, range);
    let written: Vec<(u32, &str)> = lines.into_iter().filter(|(_, line)| !line.trim().is_empty()).collect();
    let indent_of = |line: &str| line.len() - line.trim_start().len();
    if written.iter().all(|(_, line)| line.trim_start().starts_with("//")) {
        let uncomment = |(start, line): &(u32, &str)| {
            let at = start + indent_of(line) as u32;
            let length = if line.trim_start().starts_with("// ") { 3 } else { 2 };
            Edit { span: Span::new(at, at + length), text: String::new() }
        };
        return written.iter().map(uncomment).collect();
    }
    // All signs stand in one column, so that the lines keep their relative indentation.
    let column = written.iter().map(|(_, line)| indent_of(line)).min().unwrap_or(0) as u32;
    let insert = |(start, _): &(u32, &str)| {
        let at = start + column;
        Edit { span: Span::new(at, at), text: "// ".to_owned() }
    };
    written.iter().map(insert).collect()
}

/// The lines that `range` touches, each with the offset of its start and without its line end. A range that ends at
/// the start of a line does not touch that line.
fn lines_of(text: &str, range: Span) -> Vec<(u32, &str)> {
    let mut found = Vec::new();
    let mut start = 0_u32;
    for line in text.split('\n') {
        let end = start + line.len() as u32;
        let is_touched = start <= range.end && range.start <= end;
        let is_only_reached = start == range.end && range.start < range.end;
        if is_touched && !is_only_reached {
            found.push((start, line));
        }
        start = end + 1;
    }
    found
}
