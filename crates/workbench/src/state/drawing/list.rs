//! Adding to statements that stand in a row, at the same time, or as alternatives, and removing from them.

use rmpl::syntax::{Element, SyntaxKind, SyntaxNode, SyntaxToken};
use rmpl::{Edit, Parse, Span};

use super::site::{Holder, Site, steps};
use crate::state::placing::behind;

/// Which side of another statement one goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Before,
    After,
}

/// Adds statements before or after another one, in time.
pub(super) fn beside(parse: &Parse, site: &Site<'_>, text: &str, side: Side) -> Vec<Edit> {
    let source = parse.text();
    match site.holder {
        Holder::Row(row) => join(source, row, site.node, text, (SyntaxKind::Semicolon, side)),
        Holder::Choose(_) if site.node.kind() == SyntaxKind::Alternative => {
            // Inside the alternative, which has its own row.
            let inside: Vec<SyntaxNode<'_>> = steps(site.node).collect();
            let end = if side == Side::After { inside.last() } else { inside.first() };
            let end = end.copied().unwrap_or(site.node);
            join(source, site.node, end, text, (SyntaxKind::Semicolon, side))
        }
        Holder::Parallel(_) | Holder::Choose(_) | Holder::Alone(_) => {
            let (before, after) = match side {
                Side::After => ("{ ".to_owned(), format!("; {text} }}")),
                Side::Before => (format!("{{ {text}; "), " }".to_owned()),
            };
            around(site.span(), &before, &after)
        }
    }
}

/// Adds statements at the same time as another one.
pub(super) fn parallel(parse: &Parse, site: &Site<'_>, text: &str) -> Vec<Edit> {
    let one = single(text);
    match site.holder {
        Holder::Parallel(holder) => {
            join(parse.text(), holder, site.node, &one, (SyntaxKind::Comma, Side::After))
        }
        Holder::Row(row) if row.kind() == SyntaxKind::Block && steps(row).count() == 1 => {
            vec![insertion(site.span().end, format!(", {one}"))]
        }
        _ => around(site.span(), "{ ", &format!(", {one} }}")),
    }
}

/// Adds statements as another alternative to one.
pub(super) fn alternative(parse: &Parse, site: &Site<'_>, text: &str) -> Vec<Edit> {
    let one = single(text);
    if let Holder::Choose(choose) = site.holder {
        return join(parse.text(), choose, site.node, &one, (SyntaxKind::Comma, Side::After));
    }
    let core = site.node.children().next();
    if let Some(choose) = core.filter(|core| core.kind() == SyntaxKind::Choose)
        && let Some(last) = steps(choose).last()
    {
        return join(parse.text(), choose, last, &one, (SyntaxKind::Comma, Side::After));
    }
    let source = parse.text();
    let inner = outdented(source, site.span());
    let whole = braced("choose ", &[inner, one], ",");
    vec![Edit { span: site.span(), text: indented(&whole, &indent_at(source, site.span().start)) }]
}

/// Adds statements at the end of a block.
pub(super) fn at_end(parse: &Parse, block: &SyntaxNode<'_>, text: &str) -> Vec<Edit> {
    let source = parse.text();
    if let Some(last) = steps(*block).last() {
        return join(source, *block, last, text, (SyntaxKind::Semicolon, Side::After));
    }
    let span = block.span();
    let outer = indent_at(source, span.start);
    let inner = indented(&format!("\n{text}"), &format!("{outer}  "));
    let opened = source.get(span.range()).unwrap_or_default();
    let is_closed = opened.len() > 1 && opened.ends_with('}');
    let end = if is_closed { span.end - 1 } else { span.end };
    vec![Edit { span: Span::new(span.start + 1, end), text: format!("{inner}\n{outer}") }]
}

/// Adds statements in a thread of their own beside all that a block does.
pub(super) fn thread(parse: &Parse, block: &SyntaxNode<'_>, text: &str) -> Vec<Edit> {
    let source = parse.text();
    let all: Vec<SyntaxNode<'_>> = steps(*block).collect();
    let one = single(text);
    match all.as_slice() {
        [] => at_end(parse, block, text),
        [only] if only.kind() == SyntaxKind::Parallel => {
            let last = steps(*only).last().unwrap_or(*only);
            join(source, *only, last, &one, (SyntaxKind::Comma, Side::After))
        }
        [only] => join_behind(source, only.span().end, &one, ','),
        [first, .., last] => {
            let end = separator_behind(*block, *last, SyntaxKind::Semicolon)
                .map_or(last.span().end, |token| token.span.end);
            let span = Span::new(first.span().start, end);
            let outer = indent_at(source, span.start);
            let inner = outdented(source, span);
            let whole = format!("{},\n{one}", braced("", &[inner], ""));
            vec![Edit { span, text: indented(&whole, &outer) }]
        }
    }
}

/// Deletes a statement, with its separator, its line, and all that would be empty without it.
pub(super) fn delete(parse: &Parse, site: &Site<'_>) -> Vec<Edit> {
    let source = parse.text();
    let (holder, separator) = match site.holder {
        Holder::Row(row) => (row, SyntaxKind::Semicolon),
        Holder::Parallel(holder) | Holder::Choose(holder) => (holder, SyntaxKind::Comma),
        Holder::Alone(_) => return delete_outer(parse, site),
    };
    let is_only = steps(holder).count() == 1;
    let is_block = holder.kind() == SyntaxKind::Block;
    let may_be_empty = is_block && (is_body(parse, &holder) || site.outer(parse).is_none());
    if is_only && !may_be_empty {
        return delete_outer(parse, site);
    }
    let after = separator_behind(holder, site.node, separator);
    let before = separator_before(holder, site.node, separator);
    let own = Span::new(site.span().start, after.map_or(site.span().end, |token| token.span.end));
    let mut edits = vec![removal(full_lines(source, own))];
    if let (None, Some(before)) = (after, before) {
        edits.push(removal(before.span));
    }
    edits
}

/// Deletes the statement that would be empty without this one.
fn delete_outer(parse: &Parse, site: &Site<'_>) -> Vec<Edit> {
    site.outer(parse).map_or_else(|| vec![removal(site.span())], |outer| delete(parse, &outer))
}

/// Returns whether a block is the body of a scenario or an activity, which may be empty.
fn is_body(parse: &Parse, block: &SyntaxNode<'_>) -> bool {
    parse.declaration_at(block.span().start).is_some_and(|root| {
        let declared = root.children().filter(|it| it.kind().is_declaration());
        declared.flat_map(SyntaxNode::children).any(|child| child.index() == block.index())
    })
}

/// A statement's text as it would stand at the start of a line.
pub(super) fn outdented(source: &str, span: Span) -> String {
    let indent = indent_at(source, span.start);
    let text = source.get(span.range()).unwrap_or_default();
    let lines = text.split('\n').enumerate();
    let lines = lines.map(|(line, text)| match line {
        0 => text,
        _ => text.strip_prefix(indent.as_str()).unwrap_or_else(|| text.trim_start()),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// A text whose lines but the first get an indentation.
pub(super) fn indented(text: &str, indent: &str) -> String {
    text.split('\n').collect::<Vec<_>>().join(&format!("\n{indent}"))
}

/// The blanks that the line of a place begins with.
pub(super) fn indent_at(source: &str, at: u32) -> String {
    let line = line_start(source, at as usize);
    let rest = source.get(line..).unwrap_or_default();
    rest.chars().take_while(|sign| *sign == ' ' || *sign == '\t').collect()
}

/// Statements in braces, each in lines of its own.
pub(super) fn braced(word: &str, parts: &[String], separator: &str) -> String {
    let inner: Vec<String> = parts.iter().map(|part| format!("  {}", indented(part, "  "))).collect();
    format!("{word}{{\n{}\n}}", inner.join(&format!("{separator}\n")))
}

/// Several statements as one.
fn single(text: &str) -> String {
    let block = rmpl::parse(&format!("scenario S = {{ {text} }}"));
    let count = super::site::scenario_block(&block).map_or(0, |block| {
        steps(block).map(|step| if step.kind() == SyntaxKind::Parallel { 2 } else { 1 }).sum::<usize>()
    });
    match count {
        0 | 1 => text.to_owned(),
        _ if text.contains('\n') => braced("", &[text.to_owned()], ""),
        _ => format!("{{ {text} }}"),
    }
}

/// Adds text beside one of several that are separated.
fn join(
    source: &str,
    holder: SyntaxNode<'_>,
    node: SyntaxNode<'_>,
    text: &str,
    (kind, side): (SyntaxKind, Side),
) -> Vec<Edit> {
    let sign = if kind == SyntaxKind::Comma { ',' } else { ';' };
    let span = node.span();
    if side == Side::Before {
        let end = separator_behind(holder, node, kind).map_or(span.end, |separator| separator.span.end);
        let (gap, text) = gap_and_text(source, Span::new(span.start, end), text);
        return vec![insertion(span.start, format!("{text}{sign}{gap}"))];
    }
    match separator_behind(holder, node, kind) {
        Some(separator) => {
            let at = behind(source, separator.span.end);
            let (gap, text) = gap_and_text(source, Span::new(span.start, separator.span.end), text);
            // If the last one had a separator, the new last one has it too.
            vec![insertion(at, format!("{gap}{text}{sign}"))]
        }
        None => join_behind_line(source, span, text, sign),
    }
}

fn join_behind_line(source: &str, span: Span, text: &str, sign: char) -> Vec<Edit> {
    let at = behind(source, span.end);
    let (gap, text) = gap_and_text(source, span, text);
    if at == span.end {
        return vec![insertion(at, format!("{sign}{gap}{text}"))];
    }
    // A comment after the last one stays with it.
    vec![insertion(span.end, sign.to_string()), insertion(at, format!("{gap}{text}"))]
}

fn join_behind(source: &str, end: u32, text: &str, sign: char) -> Vec<Edit> {
    let indent = indent_at(source, end);
    vec![insertion(end, format!("{sign}\n{indent}{}", indented(text, &indent)))]
}

/// The gap between two statements, and the text of the new one. If the other statement and its separator fill their lines,
/// the new one gets a line of its own.
fn gap_and_text(source: &str, other: Span, text: &str) -> (String, String) {
    let rest = source.get(other.end as usize..).unwrap_or_default().split('\n').next().unwrap_or_default();
    let ends_line = rest.trim().is_empty() || rest.trim_start().starts_with("//");
    if !begins_line(source, other.start) || !ends_line {
        return (" ".to_owned(), text.replace('\n', " "));
    }
    let indent = indent_at(source, other.start);
    (format!("\n{indent}"), indented(text, &indent))
}

fn separator_behind<'a>(
    holder: SyntaxNode<'a>,
    node: SyntaxNode<'a>,
    kind: SyntaxKind,
) -> Option<SyntaxToken<'a>> {
    let mut is_behind = false;
    for element in holder.elements() {
        match element {
            Element::Node(child) if child.index() == node.index() => is_behind = true,
            Element::Node(_) if is_behind => return None,
            Element::Token(token) if is_behind && token.kind == kind => return Some(token),
            _ => {}
        }
    }
    None
}

fn separator_before<'a>(
    holder: SyntaxNode<'a>,
    node: SyntaxNode<'a>,
    kind: SyntaxKind,
) -> Option<SyntaxToken<'a>> {
    let mut last = None;
    for element in holder.elements() {
        match element {
            Element::Node(child) if child.index() == node.index() => return last,
            Element::Token(token) if token.kind == kind => last = Some(token),
            _ => {}
        }
    }
    None
}

fn begins_line(source: &str, at: u32) -> bool {
    let line = line_start(source, at as usize);
    source.get(line..at as usize).is_some_and(|before| before.trim().is_empty())
}

fn line_start(source: &str, at: usize) -> usize {
    source.get(..at).and_then(|before| before.rfind('\n')).map_or(0, |end| end + 1)
}

/// A span with the rest of its lines, if nothing else is in them; otherwise with the blanks after it.
fn full_lines(source: &str, span: Span) -> Span {
    let rest = source.get(span.end as usize..).unwrap_or_default();
    let line = rest.split('\n').next().unwrap_or_default();
    let is_alone = line.trim().is_empty() || line.trim_start().starts_with("//");
    if begins_line(source, span.start) && is_alone && rest.contains('\n') {
        let start = line_start(source, span.start as usize) as u32;
        return Span::new(start, span.end + line.len() as u32 + 1);
    }
    let blanks = line.len() - line.trim_start().len();
    Span::new(span.start, span.end + blanks as u32)
}

fn around(span: Span, before: &str, after: &str) -> Vec<Edit> {
    vec![insertion(span.start, before.to_owned()), insertion(span.end, after.to_owned())]
}

pub(super) fn insertion(at: u32, text: String) -> Edit {
    Edit { span: Span::new(at, at), text }
}

fn removal(span: Span) -> Edit {
    Edit { span, text: String::new() }
}
