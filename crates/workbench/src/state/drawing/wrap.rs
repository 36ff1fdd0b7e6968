//! Constructs around statements, bounds after them, and bounds between them.

use rmpl::program::Program;
use rmpl::syntax::{SyntaxKind, SyntaxNode};
use rmpl::{Edit, Parse, Span};

use super::Drawn;
use super::list::{braced, indent_at, indented, insertion, outdented};
use super::site::{Holder, Site, steps};
use crate::state::placing::Names;

/// A construct that is put around a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wrapping {
    /// `choose`, so that alternatives can be added.
    Choose,
    /// `optional`
    Optional,
    /// `unordered`, together with what comes next.
    Unordered,
    /// `do … maintaining` this condition
    Maintaining(String),
}

/// At most this many conditions are listed.
const MAX_CONDITIONS: usize = 24;

/// The conditions that can be maintained: each value of each variable.
pub fn conditions(program: &Program) -> Vec<String> {
    let of_variable = |variable: &rmpl::program::VariableDecl| -> Vec<String> {
        variable.values.iter().map(|value| format!("{}={}", variable.name.text, value.text)).collect()
    };
    program.variables.iter().flat_map(of_variable).take(MAX_CONDITIONS).collect()
}

pub(super) fn wrap(parse: &Parse, site: &Site<'_>, wrapping: &Wrapping) -> Result<Vec<Edit>, String> {
    let source = parse.text();
    let span = site.span();
    let text = outdented(source, span);
    let is_several = site.node.kind() == SyntaxKind::Alternative && steps(site.node).count() > 1;
    let unit = if is_several { format!("{{ {text} }}") } else { text };
    let (span, whole) = match wrapping {
        Wrapping::Choose => (span, braced("choose ", &[unit], "")),
        Wrapping::Optional => (span, format!("optional {unit}")),
        Wrapping::Maintaining(condition) => {
            let is_open =
                matches!(core(site.node).map(SyntaxNode::kind), Some(SyntaxKind::Do | SyntaxKind::If));
            let unit = if is_open { format!("{{ {unit} }}") } else { unit };
            (span, format!("do {unit} maintaining {condition}"))
        }
        Wrapping::Unordered => {
            let next = site.neighbor(true).filter(|_| matches!(site.holder, Holder::Row(_)));
            let next = next.ok_or("No statement follows in the sequence")?;
            let span = Span::new(span.start, next.span().end);
            (span, braced("unordered ", &[outdented(source, span)], ""))
        }
    };
    Ok(vec![Edit { span, text: indented(&whole, &indent_at(source, span.start)) }])
}

/// Takes away the innermost construct: that of the statement, or else the one that the statement is alone in.
pub(super) fn unwrap(parse: &Parse, site: &Site<'_>) -> Result<Vec<Edit>, String> {
    let own = unwrapped(parse.text(), site.node);
    let outer = || site.outer(parse).and_then(|outer| unwrapped(parse.text(), outer.node));
    let edit = own.or_else(outer).ok_or("No surrounding construct to remove")?;
    Ok(vec![edit])
}

/// Returns what is left of a statement without its outermost construct.
fn unwrapped(source: &str, statement: SyntaxNode<'_>) -> Option<Edit> {
    let node = core(statement)?;
    let only = |holder: SyntaxNode<'_>| {
        let mut all = steps(holder);
        all.next().filter(|_| all.next().is_none()).map(SyntaxNode::span)
    };
    let inner = match node.kind() {
        SyntaxKind::Optional | SyntaxKind::Free | SyntaxKind::Do => {
            node.child(SyntaxKind::Statement).map(SyntaxNode::span)
        }
        SyntaxKind::Unordered => node.child(SyntaxKind::Block).map(SyntaxNode::span),
        SyntaxKind::Choose | SyntaxKind::Block => only(node),
        _ => None,
    }?;
    let behind = source.get(node.span().end as usize..statement.span().end as usize).unwrap_or_default();
    let text = outdented(source, inner);
    let text = match (behind.is_empty(), node.kind()) {
        (true, SyntaxKind::Choose) if text.contains(';') => format!("{{ {text} }}"),
        (true, _) => text,
        // Bounds and the name of the whole stay those of what is left.
        (false, _) => format!("{{ {text} }}{behind}"),
    };
    let text = indented(&text, &indent_at(source, statement.span().start));
    Some(Edit { span: statement.span(), text })
}

/// Gives a statement bounds, for the author to type over.
pub(super) fn bound(site: &Site<'_>, bounds: &str) -> Drawn {
    let statement = statement_in(site.node);
    let written = statement.child(SyntaxKind::Bounds);
    let after_core = core(statement).map_or(statement.span().end, |core| core.span().end);
    let span = written.map_or(Span::new(after_core, after_core), SyntaxNode::span);
    let inside = Span::new(span.start + 1, span.start + (bounds.len() as u32).saturating_sub(1));
    Drawn {
        edits: vec![Edit { span, text: bounds.to_owned() }],
        typed_over: vec![inside],
        ..Drawn::default()
    }
}

/// Lets a statement start only once another one has ended: both get names, which a constraint is about.
pub(super) fn connect(parse: &Parse, from: Span, to: Span) -> Result<Drawn, String> {
    let (from, to) = (Site::of(parse, from)?, Site::of(parse, to)?);
    if from.span() == to.span() {
        return Err("Select another activity to start after".to_owned());
    }
    let mut names = Names::of(parse.text());
    let mut edits = Vec::new();
    let mut name_of = |site: &Site<'_>| {
        let statement = statement_in(site.node);
        let written = statement.child(SyntaxKind::Naming).and_then(|naming| naming.tokens().last());
        if let Some(written) = written {
            return written.text.to_owned();
        }
        let called = statement.tokens().find(|token| token.kind == SyntaxKind::Name);
        let stem: String =
            called.map_or("Step", |token| token.text).chars().filter(|it| *it != '-').collect();
        let name = names.fresh(&stem).to_string();
        edits.push(insertion(statement.span().end, format!(" as {name}")));
        name
    };
    let (from_name, to_name) = (name_of(&from), name_of(&to));
    let declaration = format!("constrain {from_name}.end to {to_name}.start [0,inf];");
    let root = parse.declaration_at(to.span().start).ok_or("Select an activity inside the scenario")?;
    edits.push(insertion(root.span().end, format!("\n{declaration}")));
    Ok(Drawn::of(edits))
}

/// The statement itself, or the one in an alternative.
fn statement_in(node: SyntaxNode<'_>) -> SyntaxNode<'_> {
    if node.kind() == SyntaxKind::Alternative { steps(node).next().unwrap_or(node) } else { node }
}

/// Returns what a statement is, without its bounds and its name.
fn core(node: SyntaxNode<'_>) -> Option<SyntaxNode<'_>> {
    statement_in(node).children().next()
}
