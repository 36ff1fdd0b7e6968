//! The formatter of mission texts: one layout for all, keeping every token and every comment.
//!
//! Only blanks and line ends change. A block is on one line if its author wrote it so and it fits; otherwise each
//! step has a line. Declarations with syntax errors are left as they are.

mod layout;
mod spacing;

use crate::parse::Parse;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

use layout::{Layout, layout};
use spacing::has_space_between;

/// The longest line that a block may stand on, in characters.
pub(crate) const LINE_WIDTH: usize = 100;

/// The indentation of one level, in spaces.
pub(crate) const INDENT: usize = 2;

/// The text in the house layout. Formatting twice gives the same as formatting once, and the meaning stays: the
/// formatted text has the same tokens, comments and trees. Linear in the length of the text.
pub fn format(text: &str) -> String {
    let parsed = Parse::trees(text.into());
    let formatted = print(&parsed);
    // Line starts steer the recovery from mistakes; where moving one would change a tree, the text is left alone.
    if formatted == text || is_same(&parsed, &Parse::trees(formatted.as_str().into())) {
        formatted
    } else {
        text.to_owned()
    }
}

fn print(parsed: &Parse) -> String {
    let mut printer = Printer { out: String::with_capacity(parsed.text().len()), ..Printer::default() };
    for (root, follows_grammar) in parsed.declarations_by_syntax() {
        let is_sound = follows_grammar
            && root.children().all(|child| child.kind() != SyntaxKind::Garbage)
            && root.tokens().all(|token| token.kind != SyntaxKind::Unknown);
        if is_sound {
            printer.declaration(root);
        } else {
            printer.as_written(root);
        }
    }
    let end = printer.out.trim_end().len();
    printer.out.truncate(end);
    if !printer.out.is_empty() {
        printer.out.push('\n');
    }
    printer.out
}

/// Returns whether both texts have the same tokens, comments and trees.
fn is_same(one: &Parse, other: &Parse) -> bool {
    one.declarations()
        .map(shape)
        .filter(is_something)
        .eq(other.declarations().map(shape).filter(is_something))
}

type Shape<'a> = (Vec<(SyntaxKind, usize)>, Vec<(SyntaxKind, &'a str)>);

fn is_something((_, tokens): &Shape<'_>) -> bool {
    !tokens.is_empty()
}

/// The nodes of a tree, each with its number of tokens, and the tokens; blanks left out.
fn shape(root: SyntaxNode<'_>) -> Shape<'_> {
    let counts = |token: &SyntaxToken<'_>| !token.kind.is_trivia();
    let nodes = root.descendants().map(|node| (node.kind(), node.tokens().filter(counts).count())).collect();
    let tokens = root
        .tokens()
        .filter(|token| token.kind != SyntaxKind::Whitespace)
        .map(|token| (token.kind, token.text.trim_end()))
        .collect();
    (nodes, tokens)
}

#[derive(Default)]
struct Printer {
    out: String,
    /// The indentation of the line being written.
    indent: usize,
    /// A line comment was written: the line must end before anything else.
    must_end_line: bool,
}

impl Printer {
    fn declaration(&mut self, root: SyntaxNode<'_>) {
        let layout = layout(root);
        let tokens: Vec<SyntaxToken<'_>> = root.tokens().collect();
        let mut previous: Option<usize> = None;
        let mut lines_before = 0;
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            if token.kind == SyntaxKind::Whitespace {
                lines_before += token.text.matches('\n').count();
                at += 1;
                continue;
            }
            if token.kind.is_comment() {
                self.comment(*token, lines_before, next_break(&layout, &tokens, at), previous.is_none());
            } else {
                self.token(
                    *token,
                    at,
                    previous.and_then(|at| tokens.get(at)).copied(),
                    &layout,
                    lines_before,
                );
                previous = Some(at);
            }
            lines_before = 0;
            at += 1;
        }
    }

    fn token(
        &mut self,
        token: SyntaxToken<'_>,
        at: usize,
        previous: Option<SyntaxToken<'_>>,
        layout: &Layout,
        lines_before: usize,
    ) {
        if let Some(indent) = layout.break_before(at) {
            let wants_blank =
                lines_before > 1 && token.kind != SyntaxKind::RightBrace && !self.after_opening();
            self.new_line(indent, wants_blank);
        } else if self.must_end_line {
            let indent = self.indent + INDENT;
            self.out.push('\n');
            self.out.extend(std::iter::repeat_n(' ', indent));
        } else if self.ends_with_comment() {
            self.out.push(' ');
        } else if let Some(previous) = previous
            && has_space_between(previous, token, layout.place(at))
        {
            self.out.push(' ');
        }
        self.must_end_line = false;
        self.out.push_str(token.text);
    }

    fn comment(
        &mut self,
        token: SyntaxToken<'_>,
        lines_before: usize,
        next_break: Option<usize>,
        is_leading: bool,
    ) {
        let own_line = lines_before > 0 || self.out.is_empty();
        if own_line || self.must_end_line {
            let indent = next_break.unwrap_or(if is_leading { 0 } else { self.indent + INDENT });
            let keep = self.indent;
            self.new_line(indent, lines_before > 1 && !self.after_opening());
            if next_break.is_none() {
                self.indent = keep;
            }
        } else {
            self.out.push(' ');
        }
        self.out.push_str(token.text.trim_end());
        self.must_end_line = token.kind == SyntaxKind::LineComment;
    }

    /// Ends the line, if one has started, and begins another.
    fn new_line(&mut self, indent: usize, wants_blank: bool) {
        if !self.out.is_empty() {
            self.out.push('\n');
            if wants_blank {
                self.out.push('\n');
            }
        }
        self.out.extend(std::iter::repeat_n(' ', indent));
        self.indent = indent;
        self.must_end_line = false;
    }

    fn after_opening(&self) -> bool {
        self.out.ends_with('{')
    }

    fn ends_with_comment(&self) -> bool {
        self.out.ends_with("*/")
    }

    /// A declaration with mistakes, untouched but for the blank lines before it.
    fn as_written(&mut self, root: SyntaxNode<'_>) {
        let text = root.text();
        let body = text.trim_start();
        let before = &text[..text.len() - body.len()];
        if !self.out.is_empty() {
            let lines = before.matches('\n').count();
            if lines == 0 && !self.must_end_line {
                self.out.push_str(before);
            } else {
                self.out.push_str(if lines > 1 { "\n\n" } else { "\n" });
                self.out.push_str(before.rsplit('\n').next().unwrap_or(""));
            }
        }
        self.out.push_str(body.trim_end());
        self.must_end_line = false;
    }
}

/// The indentation of the step or closing brace that follows the comment at `at`: comments stand at their step.
fn next_break(layout: &Layout, tokens: &[SyntaxToken<'_>], at: usize) -> Option<usize> {
    let next =
        (at..tokens.len()).find(|&index| tokens.get(index).is_some_and(|token| !token.kind.is_trivia()));
    let Some(next) = next else { return Some(0) };
    let indent = layout.break_before(next)?;
    let closes = tokens.get(next).is_some_and(|token| token.kind == SyntaxKind::RightBrace);
    Some(if closes { indent + INDENT } else { indent })
}
