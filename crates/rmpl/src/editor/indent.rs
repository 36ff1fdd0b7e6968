//! What Enter does: a new line, indented by the structure around it.

use crate::diagnostic::Edit;
use crate::format::INDENT;
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

/// The edit of pressing Enter with `selection` selected, and where the cursor stands afterwards.
///
/// Behind `{` the new line is one level deeper, and a `}` right after the cursor goes to a line of its own. Inside a
/// line comment the comment continues. Otherwise the new line is as deep as its block.
pub fn new_line(parse: &Parse, selection: Span) -> (Edit, u32) {
    let text = parse.text();
    let before = text.get(..selection.start as usize).unwrap_or("");
    let after = text.get(selection.end as usize..).unwrap_or("");
    let line = before.rsplit('\n').next().unwrap_or("");
    let written = line.trim_start();
    let line_indent = &line[..line.len() - written.len()];
    let blanks_before = line.len() - line.trim_end().len();
    // Blanks that would trail the old line or lead the new one go.
    let start = selection.start - blanks_before.min(line.len() - line_indent.len()) as u32;
    let blanks_after = after.len() - after.trim_start_matches([' ', '\t']).len();
    let mut end = selection.end + blanks_after as u32;
    let mut inserted = String::from("\n");
    let mut cursor_behind = 0;
    if written.starts_with("//") && !after.starts_with('\n') && !after.is_empty() {
        inserted.push_str(line_indent);
        inserted.push_str("// ");
    } else {
        let depth = open_braces(parse, start);
        let closes = after.trim_start_matches([' ', '\t']).starts_with('}');
        let opens = text.get(..start as usize).is_some_and(|before| before.ends_with('{'));
        let indent = depth * INDENT;
        if closes && opens {
            inserted.push_str(&" ".repeat(indent));
            let closing = format!("\n{}", " ".repeat(indent.saturating_sub(INDENT)));
            cursor_behind = closing.len();
            inserted.push_str(&closing);
        } else {
            let indent = if closes { indent.saturating_sub(INDENT) } else { indent };
            inserted.push_str(&" ".repeat(indent));
        }
    }
    if after.is_empty() {
        end = selection.end;
    }
    let cursor = start + (inserted.len() - cursor_behind) as u32;
    (Edit { span: Span::new(start, end), text: inserted }, cursor)
}

/// Returns how many braces are open at `offset`, in its declaration.
fn open_braces(parse: &Parse, offset: u32) -> usize {
    // The end of a declaration may still be inside a brace that is not closed yet.
    let root = offset.checked_sub(1).and_then(|before| parse.declaration_at(before));
    let tokens = root.into_iter().flat_map(SyntaxNode::tokens);
    tokens.take_while(|token| token.span.end <= offset).fold(0_usize, |depth, token: SyntaxToken<'_>| {
        match token.kind {
            SyntaxKind::LeftBrace => depth + 1,
            SyntaxKind::RightBrace => depth.saturating_sub(1),
            _ => depth,
        }
    })
}
